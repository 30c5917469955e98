//! Brown and McPhee's friction: smooth, with a peak of static friction.
//! ```text
//! F_T = −F_N [ μ_d tanh(4 x) + (μ_s − μ_d) x/(x²/4 + 3/4)² ],   x = v_T/v_t
//! ```
//! | symbol   | unit | meaning                                  |
//! |----------|------|------------------------------------------|
//! | μ_d, μ_s | –    | coefficients of sliding and of rest      |
//! | v_t      | m/s  | slip of the peak, where friction is μ_s  |
//!
//! Smooth, without edges; its term of viscous friction is left out. It holds no load at rest: a joint
//! under one creeps, at up to v_t. (P. Brown, J. McPhee, A continuous velocity-based friction model
//! for dynamics and control with physically meaningful parameters, J. Comput. Nonlinear Dyn.
//! 11(5):054502, 2016, doi 10.1115/1.4033658; checked against a public code.)

use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, Sloped, WHOLE, endless};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "brown-mcphee",
    title: "smooth friction with a peak of static friction",
    source: "Brown, McPhee 2016, J. Comput. Nonlinear Dyn. 11(5):054502, doi 10.1115/1.4033658",
    example: r#"[joints.A.clearance]
friction = { law = "brown-mcphee", coefficient = 0.1, static = 0.15, transition = 1e-3 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("static", Takes::Number(Range::NotNegative), "", "coefficient μ_s of rest, not less than `coefficient`"),
        Key::new("transition", Takes::Number(Range::Positive), "m/s", "slip v_t of the peak"),
    ],
    also: Some(super::rest_holds),
};

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct BrownMcPhee<S> {
    coefficient: S,
    more: S,
    transition: S,
}

impl<S: Scalar> BrownMcPhee<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        let coefficient = values.number("coefficient");
        let more = values.number::<S>("static") - coefficient;
        BrownMcPhee { coefficient, more, transition: values.number("transition") }
    }
}

impl<S: Scalar> FrictionLaw<S> for BrownMcPhee<S> {
    #[inline(always)]
    fn ratio(&self, _: Branch, slip: S, _: Inner<S>) -> Sloped<S> {
        let n = S::from_f64;
        let x = slip / self.transition;
        let share = (n(4.0) * x).tanh();
        let bowl = n(0.25) * x * x + n(0.75);
        let peak = x / (bowl * bowl);
        let peak_slope = (bowl - x * x) / (bowl * bowl * bowl);
        let slope = n(4.0) * self.coefficient * (S::one() - share * share) + self.more * peak_slope;
        Sloped::by_slip(-self.coefficient * share - self.more * peak, -slope / self.transition)
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

    /// At the peak, to a thousandth.
    fn limit(&self) -> S {
        (self.coefficient + self.more) * S::from_f64(1.001)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual64;
    use proptest::prelude::*;

    fn law<S: Scalar>() -> BrownMcPhee<S> {
        let [coefficient, more, transition] = [(1, 10), (1, 20), (1, 100)].map(|(p, q)| S::ratio(p, q));
        BrownMcPhee { coefficient, more, transition }
    }

    #[test]
    fn the_peak_is_that_of_rest_and_far_from_it_friction_is_that_of_sliding() {
        let at = |slip| -law::<f64>().ratio(WHOLE, slip, [0.0; 2]).value;
        assert!((at(0.01) - 0.15).abs() < 1e-3 * 0.1, "{}", at(0.01));
        assert!((at(1.0) - 0.1).abs() < 1e-4 && at(0.0) == 0.0);
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
