//! Stribeck's friction: from that of rest down to that of sliding along a bell, with viscous
//! friction, smoothed by a hyperbolic tangent.
//! ```text
//! F_T = −F_N { [μ_d + (μ_s − μ_d) exp(−(v_T/v_s)²)] tanh(v_T/v_d) + f_v v_T }
//! ```
//! | symbol   | unit | meaning                                  |
//! |----------|------|------------------------------------------|
//! | μ_d, μ_s | –    | coefficients of sliding and of rest      |
//! | v_s      | m/s  | Stribeck's velocity                      |
//! | v_d      | m/s  | slip of the transition                   |
//! | f_v      | s/m  | viscous friction over the normal force   |
//!
//! Smooth, without edges. With v_d far below v_s its peak is nearly μ_s; with μ_s = μ_d it is tanh
//! friction and viscous friction. It holds no load at rest: a joint under one creeps, at up to v_d.
//! (N. Makris, M. C. Constantinou, Analysis of motion resisted by friction, Mech. Struct. Mach.
//! 19(4):477–500, 1991, doi 10.1080/08905459108905153; the attribution was not checked. Checked
//! against a public code, whose jump at zero is the tangent here.)

use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, Sloped, WHOLE, endless};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "stribeck",
    title: "friction that falls from that of rest along a bell, and viscous friction",
    source: "Makris, Constantinou 1991, Mech. Struct. Mach. 19(4):477–500, doi 10.1080/08905459108905153",
    example: r#"[joints.A.clearance]
friction = { law = "stribeck", coefficient = 0.1, static = 0.15, stribeck = 1e-2, transition = 1e-3 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("static", Takes::Number(Range::NotNegative), "", "coefficient μ_s of rest, not less than `coefficient`"),
        Key::new("stribeck", Takes::Number(Range::Positive), "m/s", "Stribeck's velocity v_s"),
        Key::new("transition", Takes::Number(Range::Positive), "m/s", "slip v_d of the transition through zero"),
        Key::new("viscous", Takes::Number(Range::NotNegative), "s/m", "viscous friction f_v over the normal force").or("0.0"),
    ],
    also: Some(super::rest_holds),
};

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Stribeck<S> {
    coefficient: S,
    more: S,
    stribeck: S,
    transition: S,
    viscous: S,
}

impl<S: Scalar> Stribeck<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        let coefficient: S = values.number("coefficient");
        Stribeck {
            coefficient,
            more: values.number::<S>("static") - coefficient,
            stribeck: values.number("stribeck"),
            transition: values.number("transition"),
            viscous: values.number("viscous"),
        }
    }
}

impl<S: Scalar> FrictionLaw<S> for Stribeck<S> {
    #[inline(always)]
    fn ratio(&self, _: Branch, slip: S, _: Inner<S>) -> Sloped<S> {
        let x = slip / self.stribeck;
        let bell = self.more * (-(x * x)).exp();
        let share = (slip / self.transition).tanh();
        let share_slope = (S::one() - share * share) / self.transition;
        let full = self.coefficient + bell;
        let fall = -S::from_f64(2.0) * x * bell / self.stribeck;
        Sloped::by_slip(-full * share - self.viscous * slip, -full * share_slope - fall * share - self.viscous)
    }

    fn branch(&self, _: S, _: S) -> Branch {
        WHOLE
    }

    fn edges(&self, _: Branch) -> (S, S) {
        endless()
    }

    fn beyond(&self, _: Branch, _: bool, _: S) -> Branch {
        WHOLE
    }

    fn slip_scale(&self) -> S {
        self.transition.min(self.stribeck)
    }

    /// Viscous friction has none.
    fn limit(&self) -> S {
        match self.viscous == S::zero() {
            true => self.coefficient + self.more,
            false => S::from_f64(f64::INFINITY),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual64;
    use proptest::prelude::*;

    fn law<S: Scalar>(viscous: S) -> Stribeck<S> {
        let [coefficient, more, stribeck, transition] =
            [(1, 10), (1, 20), (1, 100), (1, 10_000)].map(|(p, q)| S::ratio(p, q));
        Stribeck { coefficient, more, stribeck, transition, viscous }
    }

    #[test]
    fn friction_falls_from_that_of_rest_to_that_of_sliding_and_grows_from_there() {
        let at = |viscous, slip| -law::<f64>(viscous).ratio(WHOLE, slip, [0.0; 2]).value;
        assert!((at(0.0, 1e-3) - 0.15).abs() < 1e-3 && (at(0.0, 0.1) - 0.1).abs() < 1e-12);
        assert!((at(0.0, 0.01) - (0.1 + 0.05 * (-1.0f64).exp())).abs() < 1e-12);
        assert!((at(0.5, 0.1) - 0.15).abs() < 1e-12 && at(0.5, 0.0) == 0.0);
    }

    proptest! {
        #[test]
        fn slopes_are_those_of_dual_numbers(slip in -0.1..0.1f64, viscous in 0.0..1.0f64) {
            let dual = law(Dual64::from_f64(viscous));
            let slope = dual.ratio(WHOLE, Dual64::new(slip, 1.0), [Dual64::from_f64(0.0); 2]);
            let found = law(viscous).ratio(WHOLE, slip, [0.0; 2]);
            prop_assert!((found.d_slip - slope.value.eps).abs() <= 1e-12 * (1.0 + found.d_slip.abs()));
            prop_assert!(found.value * slip <= 0.0);
            prop_assert!(law(0.0).ratio(WHOLE, slip, [0.0; 2]).value.abs() <= law(0.0).limit());
        }
    }
}
