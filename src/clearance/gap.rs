//! Where the journal is in its bearing, and how it moves there.
//! ```text
//! e = (r_j + A_j s_j) − (r_i + A_i s_i),  e = |e|     (paper, eq. 3)
//! δ = e − c                                            (paper, eq. 2)
//! n = e/|e|,  t = n turned by +90°
//! δ̇ = n·ė,   v_T = t·ė + R_j θ̇_j − R_b θ̇_i
//! ```
//! Rates are those of the journal relative to the bearing; v_T is the slip of the journal's
//! contact point (at R_j n) on the bearing's (at R_b n).

use super::Clearance;
use crate::plane::{Motion, Pose, Vector};
use crate::scalar::Scalar;

/// The journal seen from the bearing.
#[derive(Debug, Clone, Copy)]
pub struct Gap<S> {
    /// From the mass centre of body `i` to the bearing centre (m).
    pub arm_i: Vector<S>,
    /// From the mass centre of body `j` to the journal centre (m).
    pub arm_j: Vector<S>,
    /// Journal centre minus bearing centre (m).
    pub offset: Vector<S>,
    /// Its rate (m/s).
    pub offset_rate: Vector<S>,
    /// Distance of the centres e (m).
    pub eccentricity: S,
    /// Penetration δ (m), negative in flight.
    pub depth: S,
}

/// Rates along and across the line of centres; defined only where the centres do not coincide.
#[derive(Debug, Clone, Copy)]
pub struct GapRates<S> {
    /// Unit vector n from bearing centre to journal centre.
    pub normal: Vector<S>,
    /// Unit vector t.
    pub tangent: Vector<S>,
    /// One over the eccentricity (1/m).
    pub inverse_eccentricity: S,
    /// Penetration rate δ̇ (m/s).
    pub rate: S,
    /// Rate of the offset along t (m/s): of the centres, not of the surfaces.
    pub sweep: S,
    /// Slip v_T (m/s).
    pub slip: S,
}

/// Changes of the gap with one coordinate or velocity of a body.
#[derive(Debug, Clone, Copy)]
pub struct GapSlopes<S> {
    /// Of the penetration δ.
    pub depth: S,
    /// Of the penetration rate δ̇.
    pub rate: S,
    /// Of the slip v_T.
    pub slip: S,
    /// Of the direction of the line of centres (rad).
    pub direction: S,
}

impl<S: Scalar> Clearance<S> {
    /// The journal in its bearing, from poses and motions by body. An offset that is carried takes
    /// the place of the difference of positions.
    #[inline(always)]
    pub fn gap(
        &self,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        carried: Option<Vector<S>>,
    ) -> Gap<S> {
        let (i, j) = (self.pair.i, self.pair.j);
        let arm_i = poses[i].rotate(self.pair.s_i);
        let arm_j = poses[j].rotate(self.pair.s_j);
        let offset = match carried {
            Some(offset) => offset,
            None => poses[j].position + arm_j - poses[i].position - arm_i,
        };
        let offset_rate = motions[j].at(arm_j) - motions[i].at(arm_i);
        let eccentricity = offset.norm();
        Gap { arm_i, arm_j, offset, offset_rate, eccentricity, depth: eccentricity - self.radial }
    }

    /// Rates along and across the line of centres; undefined at zero eccentricity.
    #[inline(always)]
    pub fn rates(&self, gap: &Gap<S>, motions: &[Motion<S>]) -> GapRates<S> {
        let inverse_eccentricity = S::one() / gap.eccentricity;
        let normal = gap.offset * inverse_eccentricity;
        let tangent = normal.turned();
        let sweep = tangent.dot(gap.offset_rate);
        let roll = self.journal_radius * motions[self.pair.j].angular
            - self.bearing_radius * motions[self.pair.i].angular;
        GapRates {
            normal,
            tangent,
            inverse_eccentricity,
            rate: normal.dot(gap.offset_rate),
            sweep,
            slip: sweep + roll,
        }
    }

    /// ë (m/s²), from the accelerations by body.
    #[inline(always)]
    pub fn offset_second_rate(
        &self,
        gap: &Gap<S>,
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
    ) -> Vector<S> {
        let of = |body: usize, arm: Vector<S>| {
            let rate = motions[body].angular;
            accelerations[body].at(arm) - arm * (rate * rate)
        };
        of(self.pair.j, gap.arm_j) - of(self.pair.i, gap.arm_i)
    }

    /// δ̈ and v̇_T (m/s²), from the accelerations by body.
    pub fn second_rates(
        &self,
        gap: &Gap<S>,
        rates: &GapRates<S>,
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
    ) -> (S, S) {
        let (i, j) = (self.pair.i, self.pair.j);
        let relative = self.offset_second_rate(gap, motions, accelerations);
        let turning = rates.sweep * rates.inverse_eccentricity;
        let depth = rates.normal.dot(relative) + rates.sweep * turning;
        let slip = rates.tangent.dot(relative) - rates.rate * turning
            + self.journal_radius * accelerations[j].angular
            - self.bearing_radius * accelerations[i].angular;
        (depth, slip)
    }

    /// Changes of the gap with coordinate (`0, 1, 2`: x, y, θ) of the journal's or the bearing's
    /// body.
    pub fn coordinate_slopes(
        &self,
        gap: &Gap<S>,
        rates: &GapRates<S>,
        motions: &[Motion<S>],
        of_journal: bool,
        coordinate: usize,
    ) -> GapSlopes<S> {
        let (arm, body, sign) = self.side(gap, of_journal);
        let (offset, offset_rate) = match coordinate {
            0 => (Vector::new(sign, S::zero()), Vector::zero()),
            1 => (Vector::new(S::zero(), sign), Vector::zero()),
            _ => (arm.turned() * sign, arm * (-sign * motions[body].angular)),
        };
        let direction = rates.tangent.dot(offset) * rates.inverse_eccentricity;
        GapSlopes {
            depth: rates.normal.dot(offset),
            rate: direction * rates.sweep + rates.normal.dot(offset_rate),
            slip: -direction * rates.rate + rates.tangent.dot(offset_rate),
            direction,
        }
    }

    /// Changes of the gap with velocity (`0, 1, 2`: ẋ, ẏ, θ̇) of the journal's or the bearing's
    /// body.
    pub fn velocity_slopes(
        &self,
        gap: &Gap<S>,
        rates: &GapRates<S>,
        of_journal: bool,
        velocity: usize,
    ) -> GapSlopes<S> {
        let (arm, _, sign) = self.side(gap, of_journal);
        let radius = if of_journal { self.journal_radius } else { self.bearing_radius };
        let (offset_rate, roll) = match velocity {
            0 => (Vector::new(sign, S::zero()), S::zero()),
            1 => (Vector::new(S::zero(), sign), S::zero()),
            _ => (arm.turned() * sign, radius * sign),
        };
        GapSlopes {
            depth: S::zero(),
            rate: rates.normal.dot(offset_rate),
            slip: rates.tangent.dot(offset_rate) + roll,
            direction: S::zero(),
        }
    }

    /// Arm, body and sign of one side of the joint.
    fn side(&self, gap: &Gap<S>, of_journal: bool) -> (Vector<S>, usize, S) {
        match of_journal {
            true => (gap.arm_j, self.pair.j, S::one()),
            false => (gap.arm_i, self.pair.i, -S::one()),
        }
    }
}
