//! LuGre friction: bristles that bend, with damping, static friction and viscous friction.
//! ```text
//! F_T = −F_N (σ0 z + σ1 ż + σ2 v_T)
//! ż   = v_T (1 − σ0 z s/g),   s = v_T/|v_T|,   g = μ_d + (μ_s − μ_d) exp[−(v_T/v_s)²]
//! ```
//! | symbol   | unit | meaning                                                |
//! |----------|------|--------------------------------------------------------|
//! | z        | m    | mean deflection of the bristles                        |
//! | σ0       | 1/m  | stiffness of the bristles over the normal force        |
//! | σ1, σ2   | s/m  | their damping, and viscous friction, likewise          |
//! | μ_d, μ_s | –    | coefficients of sliding and of rest                    |
//! | v_s      | m/s  | Stribeck's velocity                                    |
//!
//! (C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, A new model for control of systems with
//! friction, IEEE Trans. Automat. Control 40(3):419–425, 1995, doi 10.1109/9.376053, written by the
//! ratio F_T/F_N; checked against two public codes.)
//!
//! ż has a kink at v_T = 0, which is the edge between two branches. Bristles are straight when a
//! contact begins; where the normal law pulls they bend as before, and hold nothing. Under a load
//! that swings below full friction the law creeps. With σ1 large beside μ_s/v_s it may drive the slip
//! for a moment.

use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, MOST_INNER, Sloped};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "lugre",
    title: "bristles with damping, static and viscous friction; a joint may rest on them",
    source: "Canudas de Wit, Olsson, Åström, Lischinsky 1995, IEEE Trans. Automat. Control 40(3):419–425, doi 10.1109/9.376053",
    example: r#"[joints.A.clearance]
friction = { law = "lugre", coefficient = 0.1, static = 0.15, stiffness = 1e4, damping = 10.0, stribeck = 1e-2 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("static", Takes::Number(Range::NotNegative), "", "coefficient μ_s of rest, not less than `coefficient`"),
        Key::new("stiffness", Takes::Number(Range::Positive), "1/m", "stiffness σ0 of the bristles over the normal force"),
        Key::new("damping", Takes::Number(Range::NotNegative), "s/m", "damping σ1 of the bristles over the normal force").or("0.0"),
        Key::new("viscous", Takes::Number(Range::NotNegative), "s/m", "viscous friction σ2 over the normal force").or("0.0"),
        Key::new("stribeck", Takes::Number(Range::Positive), "m/s", "Stribeck's velocity v_s"),
    ],
    also: Some(super::rest_holds),
};

const BACKWARD: Branch = Branch(0);
const FORWARD: Branch = Branch(1);

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct LuGre<S> {
    coefficient: S,
    more: S,
    stiffness: S,
    damping: S,
    viscous: S,
    stribeck: S,
    hysteresis: S,
}

impl<S: Scalar> LuGre<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let coefficient: S = values.number("coefficient");
        let stribeck = values.number("stribeck");
        LuGre {
            coefficient,
            more: values.number::<S>("static") - coefficient,
            stiffness: values.number("stiffness"),
            damping: values.number("damping"),
            viscous: values.number("viscous"),
            stribeck,
            hysteresis: ends.hysteresis * stribeck,
        }
    }

    /// ż and its slopes.
    #[inline(always)]
    fn bend(&self, branch: Branch, slip: S, z: S) -> Sloped<S> {
        let x = slip / self.stribeck;
        let rest = self.more * (-(x * x)).exp();
        let g = self.coefficient + rest;
        let g_slope = -(x + x) * rest / self.stribeck;
        let signed = if branch == FORWARD { self.stiffness } else { -self.stiffness } / g;
        let share = signed * z;
        Sloped::by_deflection(slip * (S::one() - share), S::one() - share + slip * share * g_slope / g, -slip * signed)
    }
}

impl<S: Scalar> FrictionLaw<S> for LuGre<S> {
    #[inline(always)]
    fn ratio(&self, branch: Branch, slip: S, [z, _]: Inner<S>) -> Sloped<S> {
        let bend = self.bend(branch, slip, z);
        Sloped::by_deflection(-(self.stiffness * z + self.damping * bend.value + self.viscous * slip), -(self.damping * bend.d_slip + self.viscous), -(self.stiffness + self.damping * bend.d_inner[0]))
    }

    /// Branches overlap by the hysteresis, where the slip's acceleration decides.
    fn branch(&self, slip: S, acceleration: S) -> Branch {
        let towards = if slip.abs() > self.hysteresis { slip } else { acceleration };
        if towards > S::zero() { FORWARD } else { BACKWARD }
    }

    fn edges(&self, branch: Branch) -> (S, S) {
        let far = S::from_f64(f64::INFINITY);
        match branch {
            BACKWARD => (-far, self.hysteresis),
            _ => (-self.hysteresis, far),
        }
    }

    fn beyond(&self, _: Branch, upward: bool, _: S) -> Branch {
        if upward { FORWARD } else { BACKWARD }
    }

    fn slip_scale(&self) -> S {
        self.stribeck
    }

    fn inner_scales(&self) -> Vec<f64> {
        vec![(self.coefficient / self.stiffness).to_f64()]
    }

    #[inline(always)]
    fn inner_rates(&self, branch: Branch, slip: S, [z, _]: Inner<S>) -> [Sloped<S>; MOST_INNER] {
        [self.bend(branch, slip, z), Sloped::none()]
    }

    /// None: damping and viscous friction grow with the slip.
    fn limit(&self) -> S {
        S::from_f64(f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::super::bristle;
    use super::*;
    use crate::scalar::Dual64;
    use proptest::prelude::*;

    fn law<S: Scalar>() -> LuGre<S> {
        LuGre {
            coefficient: S::one(),
            more: S::ratio(1, 2),
            stiffness: S::from_f64(5000.0),
            damping: S::from_f64(50.0),
            viscous: S::ratio(2, 5),
            stribeck: S::ratio(1, 100),
            hysteresis: S::from_f64(1e-9),
        }
    }

    proptest! {
        #[test]
        fn slopes_are_those_of_dual_numbers(slip in -0.1..0.1f64, z in -3e-4..3e-4f64) {
            for branch in [BACKWARD, FORWARD] {
                let both = |slip: Dual64, z: Dual64| {
                    let law = law::<Dual64>();
                    [bristle(&law, (branch, slip, z))[0], bristle(&law, (branch, slip, z))[1]].map(|f| f.value.eps)
                };
                let by_slip = both(Dual64::new(slip, 1.0), Dual64::from_re(z));
                let by_inner = both(Dual64::from_re(slip), Dual64::new(z, 1.0));
                let (ratio, rate) =
                    (bristle(&law::<f64>(), (branch, slip, z))[0], bristle(&law::<f64>(), (branch, slip, z))[1]);
                for (slope, exact) in [
                    (ratio.d_slip, by_slip[0]),
                    (rate.d_slip, by_slip[1]),
                    (ratio.d_inner[0], by_inner[0]),
                    (rate.d_inner[0], by_inner[1]),
                ] {
                    prop_assert!((slope - exact).abs() <= 1e-12 * (1.0 + exact.abs()), "{slope} {exact}");
                }
            }
        }
    }

    /// A block of 1 kg on a surface that presses with 1 N, pulled by a spring of 50 N/m whose end goes
    /// at 0.02 m/s: it sticks and slips. Held against a solution in 40 digits.
    #[test]
    fn a_block_that_is_pulled_sticks_and_slips_as_it_must() {
        let known = include_str!("../../tests/data/problems/lugre.csv");
        let rows = known.lines().skip(2).map(|line| {
            let values: Vec<f64> = line.split(',').map(|value| value.parse().unwrap()).collect();
            [values[0], values[1], values[2], values[3]]
        });
        let law = law::<f64>();
        let rate = |t: f64, [x, v, z]: [f64; 3]| {
            let branch = if v > 0.0 { FORWARD } else { BACKWARD };
            let friction = bristle(&law, (branch, v, z))[0].value;
            [v, 50.0 * (0.02 * t - x) + friction, bristle(&law, (branch, v, z))[1].value]
        };
        let add = |y: [f64; 3], k: [f64; 3], h: f64| [y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2]];
        let (mut t, mut y, mut compared) = (0.0, [0.0; 3], 0);
        for [time, x, v, z] in rows.take(60) {
            let steps = ((time - t) / 2e-5_f64).ceil().max(1.0);
            let h = (time - t) / steps;
            for _ in 0..steps as usize {
                // classical Runge–Kutta
                let k1 = rate(t, y);
                let k2 = rate(t + 0.5 * h, add(y, k1, 0.5 * h));
                let k3 = rate(t + 0.5 * h, add(y, k2, 0.5 * h));
                let k4 = rate(t + h, add(y, k3, h));
                for c in 0..3 {
                    y[c] += h / 6.0 * (k1[c] + 2.0 * (k2[c] + k3[c]) + k4[c]);
                }
                t += h;
            }
            t = time;
            for (found, known, size) in [(y[0], x, 1e-3), (y[1], v, 1e-2), (y[2], z, 1e-4)] {
                assert!((found - known).abs() < 1e-7 * size, "at {time}: {found} {known}");
            }
            compared += 1;
        }
        assert!(compared > 40);
    }
}
