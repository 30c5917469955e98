//! One isolated impact of a law of the family, without dimensions.
//!
//! A mass m that strikes at the speed v with no other force on it moves by
//! ```text
//! m u du/(1 + a u/v) = −K δⁿ dδ
//! δⁿ⁺¹ = (n + 1) m v²/K [G(1) − G(u/v)],   G(x) = x/a − ln(1 + a x)/a²
//! ```
//! so that everything about it is a number times (m v²/K)^(1/(n + 1)) or the same over v.

use super::rebound;

/// Nodes of the quadrature on each side of its middle.
const NODES: i32 = 120;

/// What an impact does, over what an elastic one with the same stiffness, mass and speed does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Rebound over speed: the restitution achieved.
    pub rebound: f64,
    /// Largest penetration over that of the elastic impact.
    pub depth: f64,
    /// Duration over that of the elastic impact.
    pub duration: f64,
}

impl Impact {
    /// That of a damping weight a and an exponent n.
    pub fn new(a: f64, n: f64) -> Self {
        let deepest = |a: f64| ((n + 1.0) * fall(a, 0.0)).powf(1.0 / (n + 1.0));
        Impact {
            rebound: rebound(a),
            depth: deepest(a) / deepest(0.0),
            duration: duration(a, n) / duration(0.0, n),
        }
    }
}

/// The loop of an impact with a damping weight a and an exponent n: penetration and force, each over
/// the largest of the elastic impact with the same stiffness, mass and speed, at so many moments from
/// begin to end. Its area is what the impact dissipates.
pub fn force_loop(a: f64, n: f64, moments: usize) -> Vec<[f64; 2]> {
    let (from, middle) = (-rebound(a), 0.5 * (1.0 - rebound(a)));
    let elastic = (0.5 * (n + 1.0)).powf(1.0 / (n + 1.0));
    let at = |k: usize| {
        // close together at both ends, where the depth grows as a root
        let along = (std::f64::consts::PI * k as f64 / (moments - 1) as f64).cos();
        let u = middle + (1.0 - middle) * along;
        let fallen = if k == 0 || k + 1 == moments { 0.0 } else { fall(a, u.max(from)).max(0.0) };
        let depth = ((n + 1.0) * fallen).powf(1.0 / (n + 1.0)) / elastic;
        [depth, depth.powf(n) * (1.0 + a * u)]
    };
    (0..moments).map(at).collect()
}

/// G(1) − G(x).
fn fall(a: f64, x: f64) -> f64 {
    if a < 1e-5 {
        // the series; the equation has few places there
        return 0.5 * (1.0 - x * x) - a / 3.0 * (1.0 - x * x * x);
    }
    (1.0 - x) / a - (a.ln_1p() - (a * x).ln_1p()) / (a * a)
}

/// Duration over (m v²/K)^(1/(n + 1))/v: the integral of dx/(dⁿ (1 + a x)) from rebound to impact,
/// where d is the depth; its ends are singular, and it is done by a double exponential rule (Takahasi,
/// Mori 1974, Publ. RIMS 9:721–741).
fn duration(a: f64, n: f64) -> f64 {
    let (from, to) = (-rebound(a), 1.0);
    let half = 0.5 * (to - from);
    let step = 6.0 / f64::from(NODES);
    let term = |k: i32| {
        let s = f64::from(k) * step;
        let lean = std::f64::consts::FRAC_PI_2 * s.sinh();
        let weight = std::f64::consts::FRAC_PI_2 * s.cosh() / lean.cosh().powi(2);
        // distance from the nearer end, which the point itself would lose
        let gap = 2.0 * half / (1.0 + (2.0 * lean.abs()).exp());
        let x = if s < 0.0 { from + gap } else { to - gap };
        let fallen = if s < 0.0 { near_end(a, from, gap) } else { near_end(a, to, -gap) };
        let depth = ((n + 1.0) * fallen).powf(1.0 / (n + 1.0));
        if gap > 0.0 && depth > 0.0 { weight / (depth.powf(n) * (1.0 + a * x)) } else { 0.0 }
    };
    half * step * (-NODES..=NODES).map(term).sum::<f64>()
}

/// G(1) − G(end + gap), where it is zero at the end; near it by the slope, G′ = x/(1 + a x).
fn near_end(a: f64, end: f64, gap: f64) -> f64 {
    if gap.abs() > 1e-3 {
        return fall(a, end + gap);
    }
    let factor = 1.0 + a * end;
    // G″ = 1/(1 + a x)², G‴ = −2 a/(1 + a x)³
    -gap * (end / factor + gap * (0.5 / factor.powi(2) - gap * a / (3.0 * factor.powi(3))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Damping;

    #[test]
    fn an_elastic_impact_takes_2_943275_times_depth_over_speed() {
        let depth = (2.5_f64 * 0.5).powf(0.4);
        assert!((duration(0.0, 1.5) / depth - 2.943_275).abs() < 1e-6);
        // a linear spring: half a period
        assert!((duration(0.0, 1.0) - std::f64::consts::PI).abs() < 1e-9);
    }

    #[test]
    fn the_area_of_a_loop_is_the_energy_that_is_lost() {
        for law in [Damping::Hertz, Damping::LankaraniNikravesh, Damping::Flores, Damping::HuGuo] {
            let a: f64 = law.weight(0.6);
            let moments = force_loop(a, 1.5, 4001);
            let work =
                |pair: &[[f64; 2]]| 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0]);
            let area: f64 = moments.windows(2).map(work).sum();
            // over K δⁿ⁺¹ of the elastic impact, whose energy is that over n + 1
            let lost = (1.0 - rebound(a).powi(2)) / 2.5;
            assert!((area - lost).abs() < 1e-5, "{}: {area} of {lost}", law.about().word);
            let deepest = moments.iter().map(|moment| moment[0]).fold(0.0, f64::max);
            assert!((deepest - Impact::new(a, 1.5).depth).abs() < 1e-5);
        }
    }

    #[test]
    fn depth_and_duration_are_those_of_an_integrated_impact() {
        for law in [Damping::LankaraniNikravesh, Damping::Flores, Damping::Exact] {
            let a: f64 = law.weight(0.7);
            let (mut x, mut u, mut t, h) = (0.0_f64, 1.0_f64, 0.0, 1e-5);
            let mut deepest = 0.0_f64;
            let pull = |x: f64, u: f64| -x.max(0.0).powf(1.5) * (1.0 + a * u);
            while x >= 0.0 {
                // classical Runge–Kutta
                let [k1, l1] = [u, pull(x, u)];
                let [k2, l2] = [u + 0.5 * h * l1, pull(x + 0.5 * h * k1, u + 0.5 * h * l1)];
                let [k3, l3] = [u + 0.5 * h * l2, pull(x + 0.5 * h * k2, u + 0.5 * h * l2)];
                let [k4, l4] = [u + h * l3, pull(x + h * k3, u + h * l3)];
                x += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
                u += h / 6.0 * (l1 + 2.0 * (l2 + l3) + l4);
                t += h;
                deepest = deepest.max(x);
            }
            t += x / u.abs();
            let impact = Impact::new(a, 1.5);
            assert!((impact.rebound + u).abs() < 1e-6, "{} {u}", impact.rebound);
            assert!((impact.depth * 1.25_f64.powf(0.4) - deepest).abs() < 1e-8);
            assert!((impact.duration * duration(0.0, 1.5) - t).abs() < 1e-6);
        }
    }
}
