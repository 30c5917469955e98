//! Coulomb friction, smoothed by a hyperbolic tangent.
//! ```text
//! F_T = −c_f F_N tanh(v_T/v_d)
//! ```
//! | symbol | unit | meaning                          |
//! |--------|------|----------------------------------|
//! | c_f    | –    | friction coefficient             |
//! | v_d    | m/s  | slip of the transition           |
//!
//! Smooth, without edges. It holds no load at rest: a joint under one creeps, at up to v_d. (In wide
//! use; checked against a public code.)

use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, Sloped, WHOLE, endless};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "tanh",
    title: "Coulomb friction, smoothed by a hyperbolic tangent",
    example: r#"[joints.A.clearance]
friction = { law = "tanh", coefficient = 0.1, transition = 1e-3 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("transition", Takes::Number(Range::Positive), "m/s", "slip v_d of the transition: friction is 76 % of full there"),
    ],
    ..Kind::PLAIN
};

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Tanh<S> {
    coefficient: S,
    transition: S,
}

impl<S: Scalar> Tanh<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        let number = |key| values.number(key);
        Tanh { coefficient: number("coefficient"), transition: number("transition") }
    }
}

impl<S: Scalar> FrictionLaw<S> for Tanh<S> {
    #[inline(always)]
    fn ratio(&self, _: Branch, slip: S, _: Inner<S>) -> Sloped<S> {
        let share = (slip / self.transition).tanh();
        let slope = (S::one() - share * share) / self.transition;
        Sloped::by_slip(-self.coefficient * share, -self.coefficient * slope)
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
        self.transition
    }

    fn limit(&self) -> S {
        self.coefficient
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual64;
    use proptest::prelude::*;

    fn law<S: Scalar>() -> Tanh<S> {
        Tanh { coefficient: S::ratio(1, 10), transition: S::ratio(1, 100) }
    }

    proptest! {
        #[test]
        fn slopes_are_those_of_dual_numbers(slip in -2.0..2.0f64) {
            let slope = law::<Dual64>().ratio(WHOLE, Dual64::new(slip, 1.0), [Dual64::from_f64(0.0); 2]);
            let found = law::<f64>().ratio(WHOLE, slip, [0.0; 2]);
            prop_assert!((found.d_slip - slope.value.eps).abs() <= 1e-13 * (1.0 + found.d_slip.abs()));
            prop_assert!(found.value * slip <= 0.0);
            prop_assert!(found.value.abs() <= law::<f64>().limit() * (1.0 + 1e-12));
        }
    }
}
