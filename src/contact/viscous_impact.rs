//! One isolated impact of a law of viscous damping, over the angle of `viscous`'s header.
//! ```text
//! d ln ρ/dθ = −C cos² θ/(1 + C sin θ cos θ)
//! dθ/dt = F_e/(m ρ sin θ) (1 + C sin θ cos θ)
//! ```
//! Both are integrated over the variable of the tanh–sinh quadrature, in which nothing is singular at
//! the ends, by Runge and Kutta's method of fourth order and a step of Richardson's.

use super::elastic::ElasticLaw;
use super::viscous::{Viscous, rebound_of};
use super::{Impact, NormalLaw, Penetration};
use std::f64::consts::{FRAC_PI_2, PI};

/// Half the range of the variable.
const REACH: f64 = 3.6;
/// Steps of the coarser integration.
const STEPS: usize = 3000;

/// What an impact of a mass (kg) at a speed (m/s) does.
pub(super) fn impact(
    law: &NormalLaw<f64>,
    viscous: &Viscous<f64>,
    mass: f64,
    speed: f64,
) -> Impact {
    let passage = Passage { law, mass, speed };
    let (stiffness, _) = law.elastic().power().unwrap_or((f64::NAN, 1.0));
    let ratio = viscous.damping_ratio(stiffness, mass);
    let [coarse, fine] = [STEPS, 2 * STEPS].map(|steps| passage.integrate(steps));
    // of fourth order
    let better = |of: fn(&Passed) -> f64| of(&fine) + (of(&fine) - of(&coarse)) / 15.0;
    let comes_back = fine.log_rebound.is_finite();
    let found = if comes_back { better(|passed| passed.log_rebound).exp() } else { 0.0 };
    Impact {
        rebound: ratio.map_or(found, rebound_of),
        depth: passage.depth(better(|passed| passed.log_middle).exp()),
        force: fine.force,
        duration: if comes_back { better(|passed| passed.duration) } else { f64::INFINITY },
    }
}

/// Penetration (m) and force (N) at so many moments of an impact.
pub(super) fn force_loop(
    law: &NormalLaw<f64>,
    mass: f64,
    speed: f64,
    moments: usize,
) -> Vec<[f64; 2]> {
    let passage = Passage { law, mass, speed };
    let mut points = Vec::with_capacity(moments);
    let every = (STEPS / moments).max(1);
    passage.follow(STEPS, |step, point| {
        if step % every == 0 {
            points.push(point);
        }
    });
    points
}

/// What came of an integration.
struct Passed {
    log_rebound: f64,
    log_middle: f64,
    duration: f64,
    force: f64,
}

/// A mass (kg) that strikes at a speed (m/s).
struct Passage<'a> {
    law: &'a NormalLaw<f64>,
    mass: f64,
    speed: f64,
}

impl Passage<'_> {
    /// Depth (m) at which the root √(2 E/m) of the stored energy is w v.
    fn depth(&self, w: f64) -> f64 {
        let (k, n) = self.law.elastic().power().unwrap_or((f64::NAN, 1.0));
        let w = w * self.speed;
        (0.5 * (n + 1.0) * self.mass * w * w / k).powf(1.0 / (n + 1.0))
    }

    /// Sine, cosine and slope of the angle at a place s.
    fn angle(s: f64) -> (f64, f64, f64) {
        let lean = FRAC_PI_2 * s.sinh();
        // from the nearer end
        let gap = PI / (1.0 + (2.0 * lean.abs()).exp());
        let slope = 0.5 * PI * FRAC_PI_2 * s.cosh() / lean.cosh().powi(2);
        let sign = if s < 0.0 { 1.0 } else { -1.0 };
        (gap.sin(), sign * gap.cos(), slope)
    }

    /// Slopes of ln ρ and of the time (s) over s, and depth (m) and force (N) there.
    fn slopes(&self, s: f64, log: f64) -> ([f64; 2], [f64; 2]) {
        let (sin, cos, slope) = Self::angle(s);
        let radius = log.exp();
        let (w, rate) = (radius * sin, radius * cos * self.speed);
        let depth = self.depth(w);
        let p = Penetration { depth, rate, inverse_impact_rate: 1.0 / self.speed };
        let force = self.law.force(p);
        let c = force.d_rate * w * self.speed / force.elastic;
        // a mass that creeps back turns no further
        let turned = Some(1.0 + c * sin * cos).filter(|turned| *turned > 0.0).unwrap_or(f64::NAN);
        let pace = force.elastic / (self.mass * w * self.speed) * turned;
        ([-c * cos * cos / turned * slope, slope / pace], [depth, force.value])
    }

    /// Goes through an impact in so many steps; `see` is told depth and force at each.
    fn follow(&self, steps: usize, mut see: impl FnMut(usize, [f64; 2])) -> [[f64; 2]; 2] {
        let h = 2.0 * REACH / steps as f64;
        let (mut log, mut time, mut middle) = (0.0, 0.0, 0.0);
        for step in 0..steps {
            if 2 * step == steps {
                middle = log;
            }
            let s = h * step as f64 - REACH;
            let (k1, point) = self.slopes(s, log);
            see(step, point);
            let k2 = self.slopes(s + 0.5 * h, log + 0.5 * h * k1[0]).0;
            let k3 = self.slopes(s + 0.5 * h, log + 0.5 * h * k2[0]).0;
            let k4 = self.slopes(s + h, log + h * k3[0]).0;
            let rise = |i: usize| h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
            log += rise(0);
            time += rise(1);
        }
        see(steps, self.slopes(REACH, log).1);
        [[log, middle], [time, 0.0]]
    }

    fn integrate(&self, steps: usize) -> Passed {
        let mut forces = Vec::with_capacity(steps + 1);
        let [[log_rebound, log_middle], [duration, _]] =
            self.follow(steps, |_, [_, force]| forces.push(force));
        let best = (0..=steps).max_by(|a, b| forces[*a].total_cmp(&forces[*b])).unwrap_or(0);
        let force = match best {
            0 | 1 => forces[best],
            _ if best + 2 > steps => forces[best],
            _ => summit(std::array::from_fn(|k| forces[best + k - 2])),
        };
        Passed { log_rebound, log_middle, duration, force }
    }
}

/// The largest value of the polynomial through five, of which the middle one is largest.
fn summit([a, b, c, d, e]: [f64; 5]) -> f64 {
    let first = (a - 8.0 * b + 8.0 * d - e) / 12.0;
    let second = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / 12.0;
    let third = (-a + 2.0 * b - 2.0 * d + e) / 2.0;
    let fourth = a - 4.0 * b + 6.0 * c - 4.0 * d + e;
    let slope = |x: f64| first + x * (second + x * (third / 2.0 + x * fourth / 6.0));
    let mut x = 0.0;
    for _ in 0..5 {
        x -= slope(x) / second;
    }
    c + x * (first + x * (second / 2.0 + x * (third / 6.0 + x * fourth / 24.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::elastic::{Elastic, Power};
    use crate::contact::viscous::{Ends, KINDS};
    use crate::parameter::{Value, Values};
    use crate::scalar::Decimal;

    const STIFFNESS: f64 = 1e10;
    const MASS: f64 = 0.05;

    fn law(word: &str, damping: &str, exponent: f64) -> NormalLaw<f64> {
        let kind = KINDS.iter().find(|kind| kind.word == word).unwrap();
        let number = |text: &str| Value::Number(Decimal::new(text).unwrap());
        let mut values = Values::new(kind);
        for key in kind.keys {
            let value = match key.name {
                "mass" => number("0.05"),
                _ => number(damping),
            };
            values = values.with(key.name, value);
        }
        let viscous = Viscous::new(&values, &Ends { stiffness: STIFFNESS }).unwrap();
        assert_eq!(viscous.exponent(), exponent);
        NormalLaw::viscous(Elastic::Power(Power::with(STIFFNESS, exponent)), viscous)
    }

    /// The integration's own rebound, where a closed form would come before it.
    fn integrated(law: &NormalLaw<f64>, speed: f64) -> f64 {
        let passage = Passage { law, mass: MASS, speed };
        let [coarse, fine] = [STEPS, 2 * STEPS].map(|steps| passage.integrate(steps).log_rebound);
        (fine + (fine - coarse) / 15.0).exp()
    }

    #[test]
    fn a_spring_with_a_damper_swings_as_its_closed_form_says() {
        for (damping, ratio) in [("2236.067977499789696", 0.05_f64), ("26832.815729997476", 0.6)] {
            let law = law("kelvin-voigt", damping, 1.0);
            let impact = Impact::of(&law, MASS, 0.7);
            let omega = (STIFFNESS / MASS).sqrt();
            let left = (1.0 - ratio * ratio).sqrt();
            let rebound = (-PI * ratio / left).exp();
            assert!((impact.rebound / rebound - 1.0).abs() < 1e-13);
            assert!((integrated(&law, 0.7) / rebound - 1.0).abs() < 1e-11);
            assert!((impact.duration * omega * left / PI - 1.0).abs() < 1e-10);
            let quarter = (left / ratio).atan();
            let depth = 0.7 / omega * (-ratio / left * quarter).exp();
            assert!((impact.depth / depth - 1.0).abs() < 1e-11);
            // K x + c v = K v/ω e^(−ζ φ/√…) sin(φ + ψ)/…: at t = 0 it is c v
            let jump = 2.0 * ratio * (STIFFNESS * MASS).sqrt() * 0.7;
            assert!(impact.force >= jump * (1.0 - 1e-9));
            assert_eq!(ratio > 0.5, (impact.force / jump - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn tsuji_s_impacts_rebound_at_the_restitution_whatever_the_speed() {
        for restitution in [0.9, 0.5, 0.2] {
            let law = law("tsuji", &restitution.to_string(), 1.5);
            for speed in [0.01, 3.0] {
                let rebound = Impact::of(&law, MASS, speed).rebound;
                assert!((rebound / restitution - 1.0).abs() < 1e-13, "{rebound}");
                let found = integrated(&law, speed);
                assert!((found / restitution - 1.0).abs() < 1e-10, "{found} of {restitution}");
            }
        }
    }

    #[test]
    fn viscoelastic_spheres_lose_with_the_fifth_root_of_the_speed() {
        // 1 − e = 1.15344 (3 A/2) … v^(1/5): ratios of small losses alone are looked at
        let law = law("kuwabara-kono", "10.0", 1.5);
        let lost = |speed: f64| 1.0 - Impact::of(&law, MASS, speed).rebound;
        let ratio = lost(1e-2) / lost(1e-2 / 32.0);
        assert!((ratio - 2.0).abs() < 1e-3, "{ratio}");
    }

    #[test]
    fn an_undamped_law_of_these_is_elastic() {
        let impact = Impact::of(&law("kuwabara-kono", "0.0", 1.5), MASS, 1.0);
        let elastic = NormalLaw::new(Elastic::Power(Power::with(STIFFNESS, 1.5)), 0.0);
        let elastic = Impact::of(&elastic, MASS, 1.0);
        for (x, y) in [
            (impact.rebound, elastic.rebound),
            (impact.depth, elastic.depth),
            (impact.force, elastic.force),
            (impact.duration, elastic.duration),
        ] {
            assert!((x / y - 1.0).abs() < 1e-9, "{impact:?} {elastic:?}");
        }
    }
}
