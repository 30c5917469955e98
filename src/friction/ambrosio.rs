//! Coulomb friction, modified by Ambrósio.
//! ```text
//! F_T = −c_f c_d F_N v_T/|v_T|                              (paper, eq. 10)
//! c_d = 0                          |v_T| ≤ v0
//!       (|v_T| − v0)/(v1 − v0)     v0 ≤ |v_T| ≤ v1          (paper, eq. 11)
//!       1                          v1 ≤ |v_T|
//! ```
//! | symbol | unit | meaning                                       |
//! |--------|------|-----------------------------------------------|
//! | c_f    | –    | friction coefficient                          |
//! | v0, v1 | m/s  | edges of the ramp                             |
//! | v_T    | m/s  | slip of the journal on the bearing            |
//!
//! The resultant of F_N and F_T is F_N √(1 + (c_f c_d)²), at the friction angle from the line of
//! centres (eq. 12, 13). Below v0 there is no friction at all, so nothing ever sticks. F_T has a
//! kink at each edge: an integration of high order must restart there, and therefore the law is
//! evaluated by region, each of which goes on smoothly beyond its edges.

use super::pieces::Pieces;
use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, Sloped};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "ambrosio",
    title: "Coulomb friction with a ramp: none below v0, full above v1",
    source: "Ambrósio 2003, in Virtual Nonlinear Multibody Systems, 57–81; the paper's eq. 10 and 11",
    example: r#"[joints.A.clearance]
friction = { law = "ambrosio", coefficient = 0.1, v0 = 1e-3, v1 = 1e-2 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("v0", Takes::Number(Range::NotNegative), "m/s", "slip below which there is no friction"),
        Key::new("v1", Takes::Number(Range::Positive), "m/s", "slip above which friction is full"),
    ],
    also: Some(rises),
};

/// The ramp has a width.
fn rises(values: &Values) -> Vec<(&'static str, String)> {
    let both = values.decimal("v0").zip(values.decimal("v1"));
    let wrong = both.filter(|(v0, v1)| v1.to_f64() <= v0.to_f64());
    let complaint = |(v0, v1)| ("v1", format!("must be greater than v0, {v0} (m/s), is {v1}"));
    wrong.map(complaint).into_iter().collect()
}

/// Which piece of the law is in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SlipRegion {
    /// v_T ≤ −v1: full friction, slip backward.
    Backward,
    /// −v1 ≤ v_T ≤ −v0.
    RampBackward,
    /// |v_T| ≤ v0: no friction.
    Still,
    /// v0 ≤ v_T ≤ v1.
    RampForward,
    /// v1 ≤ v_T: full friction, slip forward.
    Forward,
}

use SlipRegion::{Backward, Forward, RampBackward, RampForward, Still};

/// The regions in the order of v_T, which is that of the branches.
const ORDER: [SlipRegion; 5] = [Backward, RampBackward, Still, RampForward, Forward];

impl From<Branch> for SlipRegion {
    #[inline(always)]
    fn from(Branch(number): Branch) -> Self {
        ORDER[usize::from(number)]
    }
}

#[cfg(test)]
impl From<SlipRegion> for Branch {
    fn from(region: SlipRegion) -> Self {
        Branch(region as u8)
    }
}

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Ambrosio<S> {
    coefficient: S,
    v0: S,
    v1: S,
    inverse_width: S,
    pieces: Pieces<S, 4>,
}

/// The numbers of the law, whatever the arithmetic of the run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// c_f.
    pub coefficient: f64,
    /// Lower edge of the ramp (m/s).
    pub v0: f64,
    /// Upper edge (m/s).
    pub v1: f64,
}

/// A share c_d less than this may be that of no slip beyond v0: regions overlap.
const NO_SHARE: f64 = 1e-4;

impl Ramp {
    /// How far (m/s) a slip is from the nearest that has this ratio F_T/F_N by the law; zero where
    /// it has it itself, or more than there can be.
    pub fn off(&self, slip: f64, ratio: f64) -> f64 {
        if self.coefficient == 0.0 {
            return 0.0;
        }
        let Ramp { v0, v1, .. } = *self;
        let share = -ratio / self.coefficient;
        // the slip in the direction against which the friction acts
        let along = slip * share.signum();
        match share.abs() {
            share if share < NO_SHARE => (slip.abs() - v0 - NO_SHARE * (v1 - v0)).max(0.0),
            share if share < 1.0 - NO_SHARE => (along - v0 - share * (v1 - v0)).abs(),
            _ => (v1 - NO_SHARE * (v1 - v0) - along).max(0.0),
        }
    }
}

impl<S: Scalar> Ambrosio<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let number = |key| values.number(key);
        let hysteresis = ends.hysteresis.to_f64();
        Ambrosio::with(number("coefficient"), number("v0"), number("v1"), hysteresis)
    }

    /// Friction with coefficient c_f and ramp from v0 to v1 (m/s), 0 ≤ v0 < v1; edges are left
    /// `hysteresis` · v1 beyond themselves.
    fn with(coefficient: S, v0: S, v1: S, hysteresis: f64) -> Self {
        let pieces = Pieces::new([-v1, -v0, v0, v1], S::from_f64(hysteresis) * v1);
        Ambrosio { coefficient, v0, v1, inverse_width: S::one() / (v1 - v0), pieces }
    }

    /// Tangential force per normal force, F_T/F_N, and its derivative by the slip (s/m).
    #[inline(always)]
    fn of_slip(&self, region: SlipRegion, slip: S) -> (S, S) {
        let slope = -self.coefficient * self.inverse_width;
        match region {
            Backward => (self.coefficient, S::zero()),
            RampBackward => (slope * (slip + self.v0), slope),
            Still => (S::zero(), S::zero()),
            RampForward => (slope * (slip - self.v0), slope),
            Forward => (-self.coefficient, S::zero()),
        }
    }
}

impl<S: Scalar> FrictionLaw<S> for Ambrosio<S> {
    #[inline(always)]
    fn ratio(&self, branch: Branch, slip: S, _: Inner<S>) -> Sloped<S> {
        let (value, d_slip) = self.of_slip(branch.into(), slip);
        Sloped::by_slip(value, d_slip)
    }

    fn branch(&self, slip: S, acceleration: S) -> Branch {
        self.pieces.branch(slip, acceleration)
    }

    fn edges(&self, branch: Branch) -> (S, S) {
        self.pieces.edges(branch)
    }

    fn beyond(&self, branch: Branch, upward: bool, slip: S) -> Branch {
        self.pieces.beyond(branch, upward, slip)
    }

    /// Upper end v1 of the ramp.
    fn slip_scale(&self) -> S {
        self.v1
    }

    fn ramp(&self) -> Option<Ramp> {
        let [coefficient, v0, v1] = [self.coefficient, self.v0, self.v1].map(S::to_f64);
        Some(Ramp { coefficient, v0, v1 })
    }

    fn limit(&self) -> S {
        self.coefficient
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn law() -> Ambrosio<f64> {
        Ambrosio::with(0.1, 1e-3, 1e-2, 1e-6)
    }

    impl Ambrosio<f64> {
        fn region(&self, slip: f64, acceleration: f64) -> SlipRegion {
            self.branch(slip, acceleration).into()
        }

        fn edges_of(&self, region: SlipRegion) -> (f64, f64) {
            self.edges(region.into())
        }

        fn region_beyond(&self, region: SlipRegion, upward: bool, slip: f64) -> SlipRegion {
            self.beyond(region.into(), upward, slip).into()
        }
    }

    proptest! {
        #[test]
        fn force_opposes_slip_and_never_exceeds_coulomb(slip in -0.05..0.05f64) {
            let (ratio, _) = law().of_slip(law().region(slip, 0.0), slip);
            prop_assert!(ratio * slip <= 0.0 && ratio.abs() <= 0.1 * (1.0 + 1e-12));
        }

        #[test]
        fn opposite_slip_has_opposite_friction(slip in -0.05..0.05f64) {
            let at = |slip| law().of_slip(law().region(slip, 0.0), slip);
            prop_assert_eq!(at(slip).0, -at(-slip).0);
            prop_assert_eq!(at(slip).1, at(-slip).1);
        }

        #[test]
        fn a_region_just_entered_is_not_left_again_at_once(slip in -0.05..0.05f64) {
            for (at, region) in ORDER.into_iter().enumerate() {
                let (lower, upper) = law().edges_of(region);
                if at < 4 && slip >= upper {
                    let (lower, upper) = law().edges_of(law().region_beyond(region, true, slip));
                    prop_assert!(lower <= slip && slip <= upper);
                }
                if at > 0 && slip <= lower {
                    let (lower, upper) = law().edges_of(law().region_beyond(region, false, slip));
                    prop_assert!(lower <= slip && slip <= upper);
                }
            }
        }

        #[test]
        fn an_edge_that_was_met_is_passed_whatever_the_errors_of_the_slip(
            off in -1e-6..1e-6f64, at in 0usize..4,
        ) {
            let met = law().edges_of(ORDER[at]).1 + off;
            prop_assert!(law().region_beyond(ORDER[at], true, met) != ORDER[at]);
            let met = law().edges_of(ORDER[at + 1]).0 + off;
            prop_assert!(law().region_beyond(ORDER[at + 1], false, met) != ORDER[at + 1]);
        }
    }

    #[test]
    fn a_slip_that_has_not_the_friction_of_its_law_is_off() {
        let ramp = law().ramp().unwrap();
        for slip in [-0.5, -1e-2, -5e-3, -1e-3, -1e-4, 0.0, 2e-4, 3e-3, 1e-2, 0.2] {
            let (ratio, _) = law().of_slip(law().region(slip, 0.0), slip);
            assert!(ramp.off(slip, ratio) < 1e-15, "{slip}: {}", ramp.off(slip, ratio));
        }
        // full friction backward at a slip forward, none at a fast one, half of it where all is due
        for (slip, ratio, off) in [(0.05, 0.1, 0.06), (0.05, 0.0, 0.049), (0.05, -0.05, 0.0445)] {
            assert!((ramp.off(slip, ratio) - off).abs() < 1e-5, "{slip}, {ratio}");
        }
        assert_eq!(Ramp { coefficient: 0.0, ..ramp }.off(0.05, 0.0), 0.0);
    }

    #[test]
    fn a_slip_on_an_edge_belongs_where_its_acceleration_leads() {
        for (slip, below, above) in [
            (-1e-2, Backward, RampBackward),
            (-1e-3, RampBackward, Still),
            (1e-3, Still, RampForward),
            (1e-2, RampForward, Forward),
        ] {
            assert_eq!(law().region(slip, -3.0), below, "{slip}");
            assert_eq!(law().region(slip, 3.0), above, "{slip}");
        }
        let ramp = Ambrosio::with(0.1, 0.0, 1e-2, 1e-6);
        for slip in [-1e-18, 0.0, 1e-18] {
            assert_eq!(ramp.region(slip, -3.0), RampBackward);
            assert_eq!(ramp.region(slip, 3.0), RampForward);
            assert_ne!(ramp.region(slip, 0.0), Still);
        }
    }

    #[test]
    fn an_edge_hit_exactly_counts_as_passed() {
        assert_eq!(law().region_beyond(Still, true, 1e-3), RampForward);
        assert_eq!(law().region_beyond(RampForward, true, 1e-2), Forward);
        let (lower, _) = law().edges_of(Forward);
        assert_eq!(law().region_beyond(Forward, false, lower), RampForward);
    }

    #[test]
    fn the_law_is_continuous_at_its_edges() {
        for (edge, below, above) in [
            (-1e-2, Backward, RampBackward),
            (-1e-3, RampBackward, Still),
            (1e-3, Still, RampForward),
            (1e-2, RampForward, Forward),
        ] {
            let jump = law().of_slip(below, edge).0 - law().of_slip(above, edge).0;
            assert!(jump.abs() < 1e-15, "{edge}: {jump:e}");
        }
    }

    #[test]
    fn a_ramp_through_zero_has_no_still_region() {
        let law = Ambrosio::with(0.1, 0.0, 1e-2, 1e-6);
        for off in [-1e-8, 0.0, 1e-8] {
            assert_eq!(law.region_beyond(RampForward, false, off), RampBackward);
            assert_eq!(law.region_beyond(RampBackward, true, off), RampForward);
        }
        assert_eq!(law.of_slip(RampForward, 1e-4), law.of_slip(RampBackward, 1e-4));
    }
}
