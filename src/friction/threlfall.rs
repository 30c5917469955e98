//! Threlfall's friction: Coulomb's, reached along an exponential.
//! ```text
//! F_T = −c_f F_N (1 − exp(−3 |v_T|/v_r)) sgn v_T     |v_T| ≤ v_r
//!       −0.95 c_f F_N sgn v_T                        |v_T| ≥ v_r
//! ```
//! | symbol | unit | meaning                                   |
//! |--------|------|-------------------------------------------|
//! | c_f    | –    | friction coefficient                      |
//! | v_r    | m/s  | slip from which on friction is constant   |
//!
//! As printed, friction falls by 2e-4 of itself at v_r, for 1 − e⁻³ is 0.9502, and is never all of
//! Coulomb's. It has kinks at v_r and a weak one at zero, and events at each. It holds no load at
//! rest: a joint under one creeps. (D. C. Threlfall, The inclusion of Coulomb friction in mechanisms
//! programs with particular reference to DRAM, Mech. Mach. Theory 13(4):475–483, 1978,
//! doi 10.1016/0094-114X(78)90020-4; checked against a public code.)

use super::pieces::Pieces;
use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, Sloped};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "threlfall",
    title: "Coulomb friction, reached along an exponential",
    source: "Threlfall 1978, Mech. Mach. Theory 13(4):475–483, doi 10.1016/0094-114X(78)90020-4",
    example: r#"[joints.A.clearance]
friction = { law = "threlfall", coefficient = 0.1, transition = 1e-3 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("transition", Takes::Number(Range::Positive), "m/s", "slip v_r from which on friction is constant, 95 % of full"),
    ],
    also: None,
};

/// Share of Coulomb's friction beyond v_r, as printed.
const BEYOND: f64 = 0.95;

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Threlfall<S> {
    coefficient: S,
    transition: S,
    /// Fast backward, slow backward, slow forward, fast forward.
    pieces: Pieces<S, 3>,
}

impl<S: Scalar> Threlfall<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let transition: S = values.number("transition");
        Threlfall {
            coefficient: values.number("coefficient"),
            transition,
            pieces: Pieces::new([-transition, S::zero(), transition], ends.hysteresis * transition),
        }
    }
}

impl<S: Scalar> FrictionLaw<S> for Threlfall<S> {
    #[inline(always)]
    fn ratio(&self, Branch(piece): Branch, slip: S, _: Inner<S>) -> Sloped<S> {
        let forward = if piece < 2 { -S::one() } else { S::one() };
        let (share, slope) = match piece {
            0 | 3 => (S::from_f64(BEYOND), S::zero()),
            _ => {
                let rate = S::from_f64(3.0) / self.transition;
                let left = (-rate * slip * forward).exp();
                (S::one() - left, rate * left)
            }
        };
        Sloped::by_slip(-self.coefficient * forward * share, -self.coefficient * slope)
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
        self.coefficient
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual64;
    use proptest::prelude::*;

    fn law<S: Scalar>() -> Threlfall<S> {
        let transition = S::ratio(1, 100);
        let pieces =
            Pieces::new([-transition, S::zero(), transition], S::from_f64(1e-9) * transition);
        Threlfall { coefficient: S::ratio(1, 10), transition, pieces }
    }

    #[test]
    fn friction_is_that_of_the_print() {
        let at = |slip: f64| law::<f64>().ratio(law::<f64>().branch(slip, 1.0), slip, [0.0; 2]).value;
        assert!((at(0.005) + 0.1 * (1.0 - (-1.5f64).exp())).abs() < 1e-16);
        assert_eq!((at(0.02), at(-0.02), at(0.0)), (-0.095, 0.095, 0.0));
    }

    proptest! {
        #[test]
        fn slopes_are_those_of_dual_numbers_and_friction_opposes_slip(slip in -0.03..0.03f64) {
            let branch = law::<f64>().branch(slip, 0.0);
            let slope = law::<Dual64>().ratio(branch, Dual64::new(slip, 1.0), [Dual64::from_f64(0.0); 2]);
            let found = law::<f64>().ratio(branch, slip, [0.0; 2]);
            prop_assert!((found.d_slip - slope.value.eps).abs() <= 1e-13 * (1.0 + found.d_slip.abs()));
            prop_assert!(found.value * slip <= 0.0);
            prop_assert!(found.value.abs() <= law::<f64>().limit());
            let (lower, upper) = law::<f64>().edges(branch);
            prop_assert!(lower <= slip && slip <= upper);
        }
    }
}
