//! Dahl's friction: bristles that bend as the surfaces slip, up to the deflection of full friction.
//! ```text
//! F_T = −F_N σ0 z
//! ż   = v_T (1 − σ0 z s/c_f),  s = v_T/|v_T|
//! ```
//! | symbol | unit | meaning                                                          |
//! |--------|------|------------------------------------------------------------------|
//! | z      | m    | mean deflection of the bristles, positive after slip forward     |
//! | σ0     | 1/m  | stiffness of the bristles over the normal force                  |
//! | c_f    | –    | friction coefficient: \|F_T\| ≤ c_f F_N, as \|z\| ≤ c_f/σ0       |
//! | v_T    | m/s  | slip of the journal on the bearing                               |
//!
//! This is P. R. Dahl's law with exponent 1 (A solid friction model, The Aerospace Corporation,
//! TOR-0158(3107-18)-1, 1968; Solid friction damping of mechanical vibrations, AIAA Journal 14
//! (1976) 1675–1682, doi 10.2514/3.61511), dF/dx = σ (1 − F s/F_C), with F_C = c_f F_N and
//! σ = σ0 F_N: written by the ratio F_T/F_N it wants no normal force, and none that vanishes does
//! harm.
//!
//! The friction depends on the way slipped alone, not on the speed. Over a way x in one direction,
//! from z = 0,
//! ```text
//! z = c_f/σ0 (1 − e^(−σ0 x/c_f))
//! ```
//! so that what holds is elastic at first: a joint may rest on its bristles. There is no higher
//! friction of rest. Under a load that swings below full friction the law creeps, which real
//! surfaces do not.
//!
//! ż has a kink at v_T = 0, which is the edge between two branches, one a sign s. Bristles are
//! straight when a contact begins. Where the normal law pulls they bend as before, and hold nothing.
//! All work of the friction counts as dissipated: with a normal force that changes no bristle holds
//! an energy of its own, and what is dissipated may fall while bristles spring back.

use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, MOST_INNER, Sloped};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "dahl",
    title: "bristles that bend over the way slipped; a joint may rest on them",
    source: "Dahl 1968, The Aerospace Corporation, TOR-0158(3107-18)-1; 1976, AIAA J. 14(12):1675–1682, doi 10.2514/3.61511",
    example: r#"[joints.A.clearance]
friction = { law = "dahl", coefficient = 0.1, stiffness = 1e4 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("stiffness", Takes::Number(Range::Positive), "1/m", "stiffness σ0 of the bristles over the normal force"),
    ],
    also: None,
};

const BACKWARD: Branch = Branch(0);
const FORWARD: Branch = Branch(1);

/// A slip that is of order one (m/s). The law itself knows of no speed.
const SLIP_SCALE: f64 = 1e-3;

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Dahl<S> {
    coefficient: S,
    stiffness: S,
    /// σ0/c_f (1/m).
    inverse_reach: S,
    hysteresis: S,
}

impl<S: Scalar> Dahl<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let hysteresis = ends.hysteresis.to_f64();
        Dahl::with(values.number("coefficient"), values.number("stiffness"), hysteresis)
    }

    /// Friction with coefficient c_f and stiffness σ0 (1/m), both positive.
    ///
    /// A branch is left this much `hysteresis`, over a millimetre a second, beyond a slip of zero:
    /// a joint at rest must not change its branch with each rounding error. Branch and neighbour
    /// differ there by as little, for a time as short, so the trajectory is changed by its square.
    fn with(coefficient: S, stiffness: S, hysteresis: f64) -> Self {
        let hysteresis = S::from_f64(hysteresis * SLIP_SCALE);
        Dahl { coefficient, stiffness, inverse_reach: stiffness / coefficient, hysteresis }
    }
}

impl<S: Scalar> FrictionLaw<S> for Dahl<S> {
    #[inline(always)]
    fn ratio(&self, _: Branch, _: S, [z, _]: Inner<S>) -> Sloped<S> {
        Sloped::by_deflection(-self.stiffness * z, S::zero(), -self.stiffness)
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
        S::from_f64(SLIP_SCALE)
    }

    fn inner_scales(&self) -> Vec<f64> {
        vec![(self.coefficient / self.stiffness).to_f64()]
    }

    #[inline(always)]
    fn inner_rates(&self, branch: Branch, slip: S, [z, _]: Inner<S>) -> [Sloped<S>; MOST_INNER] {
        let signed = if branch == FORWARD { self.inverse_reach } else { -self.inverse_reach };
        let d_slip = S::one() - signed * z;
        [Sloped::by_deflection(slip * d_slip, d_slip, -signed * slip), Sloped::none()]
    }

    fn limit(&self) -> S {
        self.coefficient
    }
}

#[cfg(test)]
mod tests {
    use super::super::bristle;
    use super::*;
    use crate::scalar::Dual64;
    use proptest::prelude::*;

    const REACH: f64 = 0.1 / 2e4;

    fn law<S: Scalar>() -> Dahl<S> {
        Dahl::with(S::ratio(1, 10), S::ratio(20_000, 1), 1e-7)
    }

    proptest! {
        #[test]
        fn slopes_are_those_of_dual_numbers(slip in -2.0..2.0f64, share in -1.0..1.0f64) {
            let z = share * REACH;
            for branch in [BACKWARD, FORWARD] {
                let (ratio, rate) =
                    (bristle(&law::<f64>(), (branch, slip, z))[0], bristle(&law::<f64>(), (branch, slip, z))[1]);
                let dual = |slip: Dual64, z: Dual64| {
                    let law = law::<Dual64>();
                    [bristle(&law, (branch, slip, z))[0], bristle(&law, (branch, slip, z))[1]].map(|f| f.value.eps)
                };
                let by_slip = dual(Dual64::new(slip, 1.0), Dual64::from_re(z));
                let by_inner = dual(Dual64::from_re(slip), Dual64::new(z, 1.0));
                for (slopes, exact) in [
                    ([ratio.d_slip, rate.d_slip], by_slip),
                    ([ratio.d_inner[0], rate.d_inner[0]], by_inner),
                ] {
                    for (slope, exact) in slopes.into_iter().zip(exact) {
                        prop_assert!((slope - exact).abs() <= 1e-14 * (1.0 + exact.abs()));
                    }
                }
            }
        }

        /// Whatever the slip does, no more than full friction.
        #[test]
        fn bristles_never_bend_further_than_full_friction(slip in -2.0..2.0f64) {
            let branch = law::<f64>().branch(slip, 0.0);
            let full = if slip > 0.0 { REACH } else { -REACH };
            prop_assert!(bristle(&law::<f64>(), (branch, slip, full))[1].value.abs() <= 1e-15);
            let beyond = bristle(&law::<f64>(), (branch, slip, 1.5 * full))[1].value;
            prop_assert!(beyond * full <= 0.0);
            let ratio = bristle(&law::<f64>(), (branch, slip, full))[0].value;
            prop_assert!((ratio.abs() - 0.1).abs() < 1e-15 && ratio * slip <= 0.0);
        }

        #[test]
        fn a_branch_just_entered_is_not_left_again_at_once(off in -1e-12..1e-12f64) {
            let law = law::<f64>();
            for (branch, upward) in [(BACKWARD, true), (FORWARD, false)] {
                let (lower, upper) = law.edges(branch);
                let met = if upward { upper } else { lower } + off;
                let next = law.beyond(branch, upward, met);
                let (lower, upper) = law.edges(next);
                prop_assert!(next != branch && lower < met && met < upper);
            }
        }
    }

    #[test]
    fn both_branches_agree_where_nothing_slips() {
        let law = law::<f64>();
        for z in [-REACH, -0.3 * REACH, 0.0, REACH] {
            assert_eq!(bristle(&law, (FORWARD, 0.0, z))[0], bristle(&law, (BACKWARD, 0.0, z))[0]);
            assert_eq!(bristle(&law, (FORWARD, 0.0, z))[1].value, 0.0);
            assert_eq!(bristle(&law, (BACKWARD, 0.0, z))[1].value, 0.0);
        }
    }

    #[test]
    fn a_slip_of_nothing_belongs_where_its_acceleration_leads() {
        let law = law::<f64>();
        for slip in [-1e-12, 0.0, 1e-12] {
            assert_eq!(law.branch(slip, 3.0), FORWARD);
            assert_eq!(law.branch(slip, -3.0), BACKWARD);
        }
        assert_eq!(law.branch(1e-3, -3.0), FORWARD);
        assert_eq!(law.branch(-1e-3, 3.0), BACKWARD);
    }
}
