//! Where the journal is in its bearing, or a corner or a pin before its wall, and how it moves there.
//! ```text
//! e = (r_j + A_j s_j) − (r_i + A_i s_i),  e = |e|     (paper, eq. 3)
//! δ = e − c                                            (paper, eq. 2)
//! n = e/|e|,  t = n turned by +90°
//! δ̇ = n·ė,   v_T = t·ė + R_j θ̇_j − R_b θ̇_i
//! ```
//! Rates are those of the journal relative to the bearing; v_T is the slip of the journal's
//! contact point (at R_j n) on the bearing's (at R_b n).
//!
//! A straight wall turns with body `i` (Flores, Ambrósio, Claro, Lankarani, Translational joints with
//! clearance in rigid multibody systems, J. Comput. Nonlinear Dyn. 3, 2008, 011007):
//! ```text
//! e = n·(r_j + A_j s_j − r_i − A_i s_i) − h,   n = A_i n_i,   δ = e − c
//! δ̇ = n·w,   v_T = t·w + R (θ̇_j − θ̇_i),   w = ṙ_j + ω_j × A_j s_j − ṙ_i − ω_i × (r_j + A_j s_j − r_i)
//! ```
//! with the distance h of the point's nominal place from the line through `s_i`, and the radius R of
//! a pin; e is summed of the way of the block's middle and of what its tilt makes of that. Both bodies are touched where the point is, so that w is what parts the surfaces.

use super::{Clearance, Wall};
use crate::plane::{Motion, Pose, Vector};
use crate::scalar::Scalar;

/// The journal seen from the bearing, or a point seen from its wall.
#[derive(Debug, Clone, Copy)]
pub struct Gap<S> {
    /// From the mass centre of body `i` to the bearing centre, or to the point before the wall (m).
    pub arm_i: Vector<S>,
    /// From the mass centre of body `j` to the journal centre, or to the point (m).
    pub arm_j: Vector<S>,
    /// Journal centre minus bearing centre, or e n of a wall (m).
    pub offset: Vector<S>,
    /// How fast the second body moves past the first there (m/s); the rate of the offset in a bearing.
    pub offset_rate: Vector<S>,
    /// Distance of the centres, or distance towards the wall, with its sign: e (m).
    pub eccentricity: S,
    /// Penetration δ (m), negative in flight.
    pub depth: S,
    /// The normal of a wall; zero in a bearing, where it is that of the offset.
    pub wall: Vector<S>,
}

/// Rates along and across the normal; defined only where there is one ([`Clearance::is_centred`]).
#[derive(Debug, Clone, Copy)]
pub struct GapRates<S> {
    /// Unit vector n from bearing centre to journal centre, or out of the guide through its wall.
    pub normal: Vector<S>,
    /// Unit vector t.
    pub tangent: Vector<S>,
    /// One over the eccentricity in a bearing (1/m): what an offset along t turns the normal by. Zero
    /// before a wall.
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
    /// Of the direction of the normal (rad).
    pub direction: S,
    /// Of the arms of bodies `i` and `j` (m).
    pub arms: [Vector<S>; 2],
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
        if let Some(wall) = &self.wall {
            return self.before(wall, [arm_i, arm_j], poses, motions, carried);
        }
        let offset = match carried {
            Some(offset) => offset,
            None => poses[j].position + arm_j - poses[i].position - arm_i,
        };
        let offset_rate = motions[j].at(arm_j) - motions[i].at(arm_i);
        let eccentricity = offset.norm();
        let depth = eccentricity - self.radial;
        Gap { arm_i, arm_j, offset, offset_rate, eccentricity, depth, wall: Vector::zero() }
    }

    /// The same before a wall.
    fn before(
        &self,
        wall: &Wall<S>,
        [base, arm_j]: [Vector<S>; 2],
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        carried: Option<Vector<S>>,
    ) -> Gap<S> {
        let (i, j) = (self.pair.i, self.pair.j);
        let normal = poses[i].rotate(wall.normal);
        let arm_i = poses[j].position + arm_j - poses[i].position;
        let eccentricity = match carried {
            Some(carried) => carried.y,
            None => {
                let middle = poses[j].position + poses[j].rotate(wall.middle);
                let off = normal.dot(middle - poses[i].position - base);
                off + self.tilted(wall, normal, poses[j].rotate(wall.own_normal))
            }
        };
        Gap {
            arm_i,
            arm_j,
            offset: normal * eccentricity,
            offset_rate: motions[j].at(arm_j) - motions[i].at(arm_i),
            eccentricity,
            depth: eccentricity - self.radial,
            wall: normal,
        }
    }

    /// How far a tilt brings the point of a block towards its wall (m): x sin φ − h (1 − cos φ), without
    /// the difference.
    fn tilted(&self, wall: &Wall<S>, normal: Vector<S>, own: Vector<S>) -> S {
        if wall.nominal == S::zero() {
            return S::zero();
        }
        let (sin, cos) = (normal.cross(own), normal.dot(own));
        let shorter = match cos > S::zero() {
            true => sin * sin / (S::one() + cos),
            false => S::one() - cos,
        };
        wall.along * sin - wall.nominal * shorter
    }

    /// What an engine may carry beside the coordinates, of which it is a small difference (m): the offset
    /// in the fixed frame, or (0, e) before a wall.
    pub fn carried(&self, gap: &Gap<S>) -> Vector<S> {
        match self.wall {
            None => gap.offset,
            Some(_) => Vector::new(S::zero(), gap.eccentricity),
        }
    }

    /// Its rate (m/s).
    #[inline(always)]
    pub fn carried_rate(&self, gap: &Gap<S>) -> Vector<S> {
        match self.wall {
            None => gap.offset_rate,
            Some(_) => Vector::new(S::zero(), gap.wall.dot(gap.offset_rate)),
        }
    }

    /// Whether the centres coincide, where a bearing has no normal.
    pub fn is_centred(&self, gap: &Gap<S>) -> bool {
        self.wall.is_none() && gap.eccentricity == S::zero()
    }

    /// Rates along and across the normal; undefined where there is none.
    #[inline(always)]
    pub fn rates(&self, gap: &Gap<S>, motions: &[Motion<S>]) -> GapRates<S> {
        let (normal, inverse_eccentricity) = match self.wall {
            None => {
                let inverse = S::one() / gap.eccentricity;
                (gap.offset * inverse, inverse)
            }
            Some(_) => (gap.wall, S::zero()),
        };
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

    /// ë in a bearing (m/s²), from the accelerations by body.
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
        let turning = match self.wall {
            None => rates.sweep * rates.inverse_eccentricity,
            // the wall turns, and takes the point's place on it along (Coriolis)
            Some(_) => S::from_f64(2.0) * motions[i].angular,
        };
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
        if self.wall.is_some() {
            return self.slopes_before_wall(gap, rates, motions, of_journal, coordinate);
        }
        let (arm, body, sign) = self.side(gap, of_journal);
        let (offset, offset_rate) = match coordinate {
            0 => (Vector::new(sign, S::zero()), Vector::zero()),
            1 => (Vector::new(S::zero(), sign), Vector::zero()),
            _ => (arm.turned() * sign, arm * (-sign * motions[body].angular)),
        };
        let direction = rates.tangent.dot(offset) * rates.inverse_eccentricity;
        let mut arms = [Vector::zero(); 2];
        if coordinate == 2 {
            arms[usize::from(of_journal)] = arm.turned();
        }
        GapSlopes {
            depth: rates.normal.dot(offset),
            rate: direction * rates.sweep + rates.normal.dot(offset_rate),
            slip: -direction * rates.rate + rates.tangent.dot(offset_rate),
            direction,
            arms,
        }
    }

    /// The same before a wall: the point is one of body `j`, and the arm of body `i` goes to where that
    /// is.
    fn slopes_before_wall(
        &self,
        gap: &Gap<S>,
        rates: &GapRates<S>,
        motions: &[Motion<S>],
        of_journal: bool,
        coordinate: usize,
    ) -> GapSlopes<S> {
        let (arm, _, sign) = self.side(gap, of_journal);
        let [turn_i, turn_j] = [self.pair.i, self.pair.j].map(|body| motions[body].angular);
        let (none, along) = (Vector::zero(), |axis| match axis {
            0 => Vector::new(sign, S::zero()),
            _ => Vector::new(S::zero(), sign),
        });
        // of the point as body i sees it, of w, of both arms
        let (moved, past, direction, arms) = match (coordinate, of_journal) {
            (0 | 1, _) => {
                let moved = along(coordinate);
                (moved, moved.turned() * -turn_i, S::zero(), [moved, none])
            }
            (_, true) => {
                let moved = arm.turned();
                (moved, arm * (turn_i - turn_j), S::zero(), [moved, moved])
            }
            (_, false) => (-arm.turned(), none, S::one(), [none; 2]),
        };
        GapSlopes {
            depth: rates.normal.dot(moved),
            rate: direction * rates.sweep + rates.normal.dot(past),
            slip: -direction * rates.rate + rates.tangent.dot(past),
            direction,
            arms,
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
            arms: [Vector::zero(); 2],
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
