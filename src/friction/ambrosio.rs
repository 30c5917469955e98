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

use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Which piece of the law is in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum SlipRegion {
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

/// The regions in the order of v_T.
const ORDER: [SlipRegion; 5] = [Backward, RampBackward, Still, RampForward, Forward];

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Ambrosio<S> {
    coefficient: S,
    v0: S,
    v1: S,
    inverse_width: S,
    hysteresis: S,
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
    /// Its numbers as doubles.
    pub fn ramp(&self) -> Ramp {
        Ramp { coefficient: self.coefficient.to_f64(), v0: self.v0.to_f64(), v1: self.v1.to_f64() }
    }

    /// Friction with coefficient c_f and ramp from v0 to v1 (m/s), 0 ≤ v0 < v1.
    ///
    /// A slip that decays onto an edge of the ramp from above must not cross it again and again
    /// on rounding errors: on the way down an edge lies lower by `hysteresis` · v1. Region
    /// and neighbour differ there by the order of `hysteresis`, for a time of the same order, so
    /// the trajectory is changed by its square.
    pub fn new(coefficient: S, v0: S, v1: S, hysteresis: f64) -> Self {
        let hysteresis = S::from_f64(hysteresis) * v1;
        Ambrosio { coefficient, v0, v1, inverse_width: S::one() / (v1 - v0), hysteresis }
    }

    /// Upper end v1 of the ramp (m/s), the scale of slip.
    pub fn v1(&self) -> S {
        self.v1
    }

    /// Tangential force per normal force, F_T/F_N, and its derivative by the slip (s/m).
    #[inline(always)]
    pub fn ratio(&self, region: SlipRegion, slip: S) -> (S, S) {
        let slope = -self.coefficient * self.inverse_width;
        match region {
            Backward => (self.coefficient, S::zero()),
            RampBackward => (slope * (slip + self.v0), slope),
            Still => (S::zero(), S::zero()),
            RampForward => (slope * (slip - self.v0), slope),
            Forward => (-self.coefficient, S::zero()),
        }
    }

    /// The region of a slip (m/s) about whose past nothing is known. Neighbours overlap by the
    /// hysteresis; there it is the one that the slip's acceleration (m/s²) leads into, for an
    /// event function that is zero at a restart never passes zero.
    pub fn region(&self, slip: S, acceleration: S) -> SlipRegion {
        let holds = |region: &SlipRegion| {
            let (lower, upper) = self.edges(*region);
            lower <= slip && slip <= upper && !self.is_empty(*region)
        };
        let (first, last) = (
            ORDER.into_iter().find(holds).unwrap_or(RampForward),
            ORDER.into_iter().rfind(holds).unwrap_or(RampForward),
        );
        // without an acceleration, the one on this side of zero
        let upward = match acceleration == S::zero() {
            true => slip < S::zero(),
            false => acceleration > S::zero(),
        };
        if upward { last } else { first }
    }

    /// Whether a region holds no more than one slip.
    fn is_empty(&self, region: SlipRegion) -> bool {
        region == Still && self.v0 == S::zero()
    }

    /// The slips (m/s) at which a region is left, below and above; infinite where it has no edge.
    pub fn edges(&self, region: SlipRegion) -> (S, S) {
        let far = S::from_f64(f64::INFINITY);
        let h = self.hysteresis;
        match region {
            Backward => (-far, -self.v1 + h),
            RampBackward => (-self.v1, -self.v0 + h),
            Still => (-self.v0, self.v0),
            RampForward => (self.v0 - h, self.v1),
            Forward => (self.v1 - h, far),
        }
    }

    /// The region after `region` was left at `slip` (m/s) through its upper or its lower edge, or
    /// one further that way. Never back: an edge that was met counts as passed, on whichever side
    /// of it the errors of the slip have left it.
    pub fn beyond(&self, region: SlipRegion, upward: bool, slip: S) -> SlipRegion {
        let mut index = ORDER.iter().position(|r| *r == region).unwrap_or(2);
        if upward {
            index = (index + 1).min(ORDER.len() - 1);
            while index + 1 < ORDER.len()
                && (self.is_empty(ORDER[index]) || slip > self.edges(ORDER[index]).1)
            {
                index += 1;
            }
        } else {
            index = index.saturating_sub(1);
            while index > 0 && (self.is_empty(ORDER[index]) || slip < self.edges(ORDER[index]).0) {
                index -= 1;
            }
        }
        ORDER[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn law() -> Ambrosio<f64> {
        Ambrosio::new(0.1, 1e-3, 1e-2, 1e-6)
    }

    proptest! {
        #[test]
        fn force_opposes_slip_and_never_exceeds_coulomb(slip in -0.05..0.05f64) {
            let (ratio, _) = law().ratio(law().region(slip, 0.0), slip);
            prop_assert!(ratio * slip <= 0.0 && ratio.abs() <= 0.1 * (1.0 + 1e-12));
        }

        #[test]
        fn opposite_slip_has_opposite_friction(slip in -0.05..0.05f64) {
            let at = |slip| law().ratio(law().region(slip, 0.0), slip);
            prop_assert_eq!(at(slip).0, -at(-slip).0);
            prop_assert_eq!(at(slip).1, at(-slip).1);
        }

        #[test]
        fn a_region_just_entered_is_not_left_again_at_once(slip in -0.05..0.05f64) {
            for (at, region) in ORDER.into_iter().enumerate() {
                let (lower, upper) = law().edges(region);
                if at < 4 && slip >= upper {
                    let (lower, upper) = law().edges(law().beyond(region, true, slip));
                    prop_assert!(lower <= slip && slip <= upper);
                }
                if at > 0 && slip <= lower {
                    let (lower, upper) = law().edges(law().beyond(region, false, slip));
                    prop_assert!(lower <= slip && slip <= upper);
                }
            }
        }

        #[test]
        fn an_edge_that_was_met_is_passed_whatever_the_errors_of_the_slip(
            off in -1e-6..1e-6f64, at in 0usize..4,
        ) {
            let met = law().edges(ORDER[at]).1 + off;
            prop_assert!(law().beyond(ORDER[at], true, met) != ORDER[at]);
            let met = law().edges(ORDER[at + 1]).0 + off;
            prop_assert!(law().beyond(ORDER[at + 1], false, met) != ORDER[at + 1]);
        }
    }

    #[test]
    fn a_slip_that_has_not_the_friction_of_its_law_is_off() {
        let ramp = law().ramp();
        for slip in [-0.5, -1e-2, -5e-3, -1e-3, -1e-4, 0.0, 2e-4, 3e-3, 1e-2, 0.2] {
            let (ratio, _) = law().ratio(law().region(slip, 0.0), slip);
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
        let ramp = Ambrosio::new(0.1, 0.0, 1e-2, 1e-6);
        for slip in [-1e-18, 0.0, 1e-18] {
            assert_eq!(ramp.region(slip, -3.0), RampBackward);
            assert_eq!(ramp.region(slip, 3.0), RampForward);
            assert_ne!(ramp.region(slip, 0.0), Still);
        }
    }

    #[test]
    fn an_edge_hit_exactly_counts_as_passed() {
        assert_eq!(law().beyond(Still, true, 1e-3), RampForward);
        assert_eq!(law().beyond(RampForward, true, 1e-2), Forward);
        let (lower, _) = law().edges(Forward);
        assert_eq!(law().beyond(Forward, false, lower), RampForward);
    }

    #[test]
    fn the_law_is_continuous_at_its_edges() {
        for (edge, below, above) in [
            (-1e-2, Backward, RampBackward),
            (-1e-3, RampBackward, Still),
            (1e-3, Still, RampForward),
            (1e-2, RampForward, Forward),
        ] {
            let jump = law().ratio(below, edge).0 - law().ratio(above, edge).0;
            assert!(jump.abs() < 1e-15, "{edge}: {jump:e}");
        }
    }

    #[test]
    fn a_ramp_through_zero_has_no_still_region() {
        let law = Ambrosio::new(0.1, 0.0, 1e-2, 1e-6);
        for off in [-1e-8, 0.0, 1e-8] {
            assert_eq!(law.beyond(RampForward, false, off), RampBackward);
            assert_eq!(law.beyond(RampBackward, true, off), RampForward);
        }
        assert_eq!(law.ratio(RampForward, 1e-4), law.ratio(RampBackward, 1e-4));
    }
}
