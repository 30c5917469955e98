//! One isolated impact of a law of the family.
//!
//! A mass m that strikes at the speed v with no other force on it moves by
//! ```text
//! m u du/(1 + a u/v) = −F_e(δ) dδ
//! ∫₀^δ F_e dδ = m v² [G(1) − G(u/v)],   G(x) = x/a − ln(1 + a x)/a²
//! ```
//! so that what it does is known without a run: its rebound by a root, its depth and greatest force
//! from the stored energy, its duration by a quadrature.

use super::elastic::{Elastic, ElasticLaw};
use super::{Loss, NormalLaw, rebound, viscous_impact};

/// Nodes of the quadrature on each side of its middle.
const NODES: i32 = 120;

/// What one impact does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Rebound over speed: the restitution achieved.
    pub rebound: f64,
    /// Largest penetration (m).
    pub depth: f64,
    /// Largest force (N).
    pub force: f64,
    /// Duration (s).
    pub duration: f64,
}

impl Impact {
    /// That of a mass (kg) at a speed (m/s).
    pub fn of(law: &NormalLaw<f64>, mass: f64, speed: f64) -> Self {
        let a = match &law.loss {
            Loss::Weight(a) => *a,
            Loss::Viscous(viscous) => return viscous_impact::impact(law, viscous, mass, speed),
        };
        let strike = Strike { elastic: law.elastic(), a, mass, speed };
        let rebound = rebound(a);
        Impact {
            rebound,
            depth: strike.depth(0.0),
            force: strike.greatest_force(),
            duration: strike.duration(-rebound, 1.0),
        }
    }
}

/// The loop of an impact: penetration (m) and force (N) at so many moments from begin to end. Its area
/// is what the impact dissipates.
pub fn force_loop(law: &NormalLaw<f64>, mass: f64, speed: f64, moments: usize) -> Vec<[f64; 2]> {
    let Some(a) = law.damping_weight() else {
        return viscous_impact::force_loop(law, mass, speed, moments);
    };
    let strike = Strike { elastic: law.elastic(), a, mass, speed };
    let rebound = rebound(a);
    let (from, middle) = (-rebound, 0.5 * (1.0 - rebound));
    let at = |k: usize| {
        // close together at both ends, where the depth grows as a root
        let along = (std::f64::consts::PI * k as f64 / (moments - 1) as f64).cos();
        let x = middle + (1.0 - middle) * along;
        match k == 0 || k + 1 == moments {
            true => [0.0; 2],
            false => [strike.depth(x.max(from)), strike.force(x.max(from))],
        }
    };
    (0..moments).map(at).collect()
}

/// The depth (m) at which an elastic law holds a force (N).
pub fn depth_under(elastic: &Elastic<f64>, force: f64) -> f64 {
    inverse(elastic, force, |depth| elastic.force(depth))
}

/// A mass (kg) that strikes at a speed (m/s).
struct Strike<'a> {
    elastic: &'a Elastic<f64>,
    /// Damping weight.
    a: f64,
    mass: f64,
    speed: f64,
}

impl Strike<'_> {
    /// Depth (m) where the energy G(1) − G(x), over m v², has gone into the contact.
    fn depth_after(&self, fallen: f64) -> f64 {
        let (elastic, energy) = (self.elastic, self.mass * self.speed * self.speed * fallen);
        inverse(elastic, energy, |depth| (elastic.energy(depth), elastic.force(depth).0))
    }

    /// Depth (m) at the rate x v.
    fn depth(&self, x: f64) -> f64 {
        self.depth_after(fall(self.a, 1.0, x - 1.0))
    }

    /// Force (N) at the rate x v.
    fn force(&self, x: f64) -> f64 {
        self.elastic.force(self.depth(x)).0 * (1.0 + self.a * x)
    }

    /// The largest force (N), by golden sections.
    fn greatest_force(&self) -> f64 {
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut left, mut right) = (0.0, 1.0);
        while right - left > 1e-9 {
            let width = golden * (right - left);
            let (low, high) = (right - width, left + width);
            if self.force(low) < self.force(high) { left = low } else { right = high }
        }
        self.force(0.5 * (left + right))
    }

    /// Time (s) from the rate `to` v down to `from` v: ∫ m v dx/(F_e (1 + a x)), whose integrand is
    /// infinite at ends of the contact, by tanh–sinh quadrature.
    fn duration(&self, from: f64, to: f64) -> f64 {
        let a = self.a;
        let half = 0.5 * (to - from);
        let step = 6.0 / f64::from(NODES);
        let term = |k: i32| {
            let s = f64::from(k) * step;
            let lean = std::f64::consts::FRAC_PI_2 * s.sinh();
            let weight = std::f64::consts::FRAC_PI_2 * s.cosh() / lean.cosh().powi(2);
            // distance from the nearer end, which the point itself would lose
            let gap = 2.0 * half / (1.0 + (2.0 * lean.abs()).exp());
            let x = if s < 0.0 { from + gap } else { to - gap };
            let fallen = if s < 0.0 { fall(a, from, gap) } else { fall(a, to, -gap) };
            let force = self.elastic.force(self.depth_after(fallen)).0;
            if gap > 0.0 && force > 0.0 { weight / (force * (1.0 + a * x)) } else { 0.0 }
        };
        self.mass * self.speed * half * step * (-NODES..=NODES).map(term).sum::<f64>()
    }
}

/// The depth (m) at which a rising function of it, told with its slope, has a value: Newton's iteration
/// for its logarithm, which goes nearly straight over that of the depth.
fn inverse(elastic: &Elastic<f64>, value: f64, of: impl Fn(f64) -> (f64, f64)) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let deepest = elastic.deepest();
    let mut depth = f64::min(1e-6, 0.5 * deepest);
    for _ in 0..100 {
        let (found, slope) = of(depth);
        let step = (value / found).ln() * found / (depth * slope);
        let next = f64::min(depth * step.clamp(-50.0, 50.0).exp(), deepest);
        if next == depth || step.abs() < 1e-16 {
            break;
        }
        depth = next;
    }
    depth
}

/// G(end) − G(end + gap), without a loss of digits anywhere:
/// ```text
/// G(x + h) − G(x) = x g + g² φ(a g),   g = h/(1 + a x),   φ(y) = (y − ln(1 + y))/y²
/// ```
fn fall(a: f64, end: f64, gap: f64) -> f64 {
    let g = gap / (1.0 + a * end);
    -g * (end + g * curvature(a * g))
}

/// φ(y) = (y − ln(1 + y))/y².
fn curvature(y: f64) -> f64 {
    if y.abs() > 0.1 {
        return (y - y.ln_1p()) / (y * y);
    }
    // ½ − y/3 + y²/4 − …
    (2..20).rev().fold(0.0, |sum, k| 1.0 / f64::from(k) - y * sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Damping;
    use crate::contact::elastic::Power;

    /// A mass of 1 kg at 1 m/s against K = 1.
    fn unit_law(damping_weight: f64, exponent: f64) -> NormalLaw<f64> {
        NormalLaw::new(Elastic::Power(Power::with(1.0, exponent)), damping_weight)
    }

    fn impact(damping_weight: f64, exponent: f64) -> Impact {
        Impact::of(&unit_law(damping_weight, exponent), 1.0, 1.0)
    }

    #[test]
    fn an_elastic_impact_takes_2_943275_times_depth_over_speed() {
        let found = impact(0.0, 1.5);
        assert!((found.depth - 1.25_f64.powf(0.4)).abs() < 1e-15);
        assert!((found.force - 1.25_f64.powf(0.6)).abs() < 1e-15);
        assert!((found.duration / found.depth - 2.943_275_184_324_7).abs() < 1e-11);
        // a linear spring: half a period
        assert!((impact(0.0, 1.0).duration - std::f64::consts::PI).abs() < 1e-11);
    }

    #[test]
    fn the_first_integral_keeps_its_digits() {
        for a in [1e-9, 1e-3, 0.4, 3.0] {
            let g = |x: f64| x / a - (a * x).ln_1p() / (a * a);
            for (end, gap) in [(1.0, -0.5), (-0.25, 0.1), (1.0, -1.2)] {
                // of the plain form so many digits are left
                let left = 4e-16 * (1.0 / a + 1.0 / (a * a));
                assert!(
                    (fall(a, end, gap) - g(end) + g(end + gap)).abs() <= left,
                    "{a} {end} {gap}"
                );
            }
            // G' = x/(1 + a x)
            let near = fall(a, 1.0, -1e-12);
            assert!((near * (1.0 + a) / 1e-12 - 1.0).abs() < 1e-11, "{near}");
        }
    }

    #[test]
    fn the_area_of_a_loop_is_the_energy_that_is_lost() {
        for law in [Damping::Hertz, Damping::LankaraniNikravesh, Damping::Flores, Damping::HuGuo] {
            let a: f64 = law.weight(0.6);
            let moments = force_loop(&unit_law(a, 1.5), 1.0, 1.0, 4001);
            let work =
                |pair: &[[f64; 2]]| 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0]);
            let area: f64 = moments.windows(2).map(work).sum();
            let lost = 0.5 * (1.0 - rebound(a).powi(2));
            assert!((area - lost).abs() < 1e-5, "{}: {area} of {lost}", law.about().word);
            let deepest = moments.iter().map(|moment| moment[0]).fold(0.0, f64::max);
            assert!((deepest - impact(a, 1.5).depth).abs() < 1e-5);
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
            let impact = impact(a, 1.5);
            assert!((impact.rebound + u).abs() < 1e-6, "{} {u}", impact.rebound);
            assert!((impact.depth - deepest).abs() < 1e-8);
            assert!((impact.duration - t).abs() < 1e-6);
        }
    }
}
