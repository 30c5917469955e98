//! Bengisu and Akay's friction: a parabola up to the friction of rest, and an exponential from there
//! down to that of sliding.
//! ```text
//! F_T = −μ_s F_N [1 − (|v_T| − v_0)²/v_0²] sgn v_T                     |v_T| ≤ v_0
//!       −F_N [μ_d + (μ_s − μ_d) exp(−ξ (|v_T| − v_0))] sgn v_T         |v_T| ≥ v_0
//! ```
//! | symbol   | unit | meaning                                  |
//! |----------|------|------------------------------------------|
//! | μ_d, μ_s | –    | coefficients of sliding and of rest      |
//! | v_0      | m/s  | slip of the peak                         |
//! | ξ        | s/m  | how fast friction falls beyond it        |
//!
//! Kinks at v_0, and a weak one at zero: events at each. It holds no load at rest: a joint under one
//! creeps, at up to v_0. (M. T. Bengisu, A. Akay, Stability of friction-induced vibrations in
//! multi-degree-of-freedom systems, J. Sound Vib. 171(4):557–570, 1994, doi 10.1006/jsvi.1994.1140;
//! the formula was not seen in print; its continuity was checked.)

use super::pieces::Pieces;
use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, Sloped};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "bengisu-akay",
    title: "friction with a peak of static friction at the end of a parabola",
    source: "Bengisu, Akay 1994, J. Sound Vib. 171(4):557–570, doi 10.1006/jsvi.1994.1140",
    example: r#"[joints.A.clearance]
friction = { law = "bengisu-akay", coefficient = 0.1, static = 0.15, transition = 1e-3, decay = 50.0 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("static", Takes::Number(Range::NotNegative), "", "coefficient μ_s of rest, not less than `coefficient`"),
        Key::new("transition", Takes::Number(Range::Positive), "m/s", "slip v_0 of the peak"),
        Key::new("decay", Takes::Number(Range::Positive), "s/m", "ξ: beyond the peak friction falls to that of sliding over a slip of 1/ξ"),
    ],
    also: Some(super::rest_holds),
};

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct BengisuAkay<S> {
    coefficient: S,
    rest: S,
    transition: S,
    decay: S,
    /// Fast backward, slow backward, slow forward, fast forward.
    pieces: Pieces<S, 3>,
}

impl<S: Scalar> BengisuAkay<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let number = |key| values.number(key);
        let numbers = ["coefficient", "static", "transition", "decay"].map(number);
        BengisuAkay::with(numbers, ends.hysteresis)
    }

    fn with([coefficient, rest, transition, decay]: [S; 4], hysteresis: S) -> Self {
        let pieces = Pieces::new([-transition, S::zero(), transition], hysteresis * transition);
        BengisuAkay { coefficient, rest, transition, decay, pieces }
    }
}

impl<S: Scalar> FrictionLaw<S> for BengisuAkay<S> {
    #[inline(always)]
    fn ratio(&self, Branch(piece): Branch, slip: S, _: Inner<S>) -> Sloped<S> {
        let forward = if piece < 2 { -S::one() } else { S::one() };
        // the slip beyond the peak
        let more = slip * forward - self.transition;
        let (share, slope) = match piece {
            0 | 3 => {
                let left = (self.rest - self.coefficient) * (-self.decay * more).exp();
                (self.coefficient + left, -self.decay * left)
            }
            _ => {
                let x = more / self.transition;
                let two = S::from_f64(2.0);
                (self.rest * (S::one() - x * x), -two * self.rest * x / self.transition)
            }
        };
        Sloped::by_slip(-forward * share, -slope)
    }

    fn branch(&self, slip: S, acceleration: S) -> Branch {
        self.pieces.branch(slip, acceleration)
    }

    #[inline(always)]
    fn edges(&self, branch: Branch) -> (S, S) {
        self.pieces.edges(branch)
    }

    fn beyond(&self, branch: Branch, upward: bool, slip: S) -> Branch {
        self.pieces.beyond(branch, upward, slip)
    }

    fn slip_scale(&self) -> S {
        self.transition
    }

    fn limit(&self) -> S {
        self.rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual64;
    use proptest::prelude::*;

    fn law<S: Scalar>() -> BengisuAkay<S> {
        let numbers = [(1, 10), (3, 20), (1, 100), (50, 1)].map(|(p, q)| S::ratio(p, q));
        BengisuAkay::with(numbers, S::from_f64(1e-9))
    }

    #[test]
    fn the_peak_is_that_of_rest_and_far_from_it_friction_is_that_of_sliding() {
        let at = |piece, slip| -law::<f64>().ratio(Branch(piece), slip, [0.0; 2]).value;
        assert_eq!((at(2, 0.01), at(3, 0.01), at(2, 0.0), at(1, 0.0)), (0.15, 0.15, 0.0, 0.0));
        assert!((at(3, 1.0) - 0.1).abs() < 1e-15);
        assert!((at(3, 0.03) - (0.1 + 0.05 * (-1.0f64).exp())).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn slopes_are_those_of_dual_numbers_and_friction_opposes_slip(slip in -0.05..0.05f64) {
            let branch = law::<f64>().branch(slip, 0.0);
            let slope = law::<Dual64>().ratio(branch, Dual64::new(slip, 1.0), [Dual64::from_f64(0.0); 2]);
            let found = law::<f64>().ratio(branch, slip, [0.0; 2]);
            prop_assert!((found.d_slip - slope.value.eps).abs() <= 1e-13 * (1.0 + found.d_slip.abs()));
            prop_assert!(found.value * slip <= 0.0);
            prop_assert!(found.value.abs() <= law::<f64>().limit() * (1.0 + 1e-12));
        }
    }
}
