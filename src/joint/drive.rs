//! Drives: what an ideal joint leaves free is a function of time.
//! ```text
//! Φ = θ_j − θ_i − f(t) = 0   (rad)        on a revolute joint
//! Φ = u · d − f(t)     = 0   (m)          on a prismatic joint, with its travel u · d
//! ```
//! A multiplier λ (N m, N) is what the drive puts on body `i`; body `j` gets −λ. Where a drive
//! prescribes a body completely the constraint is eliminated with the body, and the torque comes
//! from inverse dynamics.

use super::{Block, Prismatic};
use crate::course::Course;
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::Scalar;

/// A drive of an angle: two bodies and the course of the angle (rad) of the second relative to the
/// first.
#[derive(Debug, Clone)]
pub struct AngleDrive<S> {
    /// Index of the first body.
    pub i: usize,
    /// Index of the second body.
    pub j: usize,
    /// The angle.
    pub course: Course<S>,
}

/// A drive of a travel: the slide, and the course of its travel (m).
#[derive(Debug, Clone)]
pub struct Travel<S> {
    /// What it drives.
    pub slide: Prismatic<S>,
    /// The travel.
    pub course: Course<S>,
}

impl<S: Scalar> AngleDrive<S> {
    /// Φ (rad).
    pub fn position_error(&self, time: S, poses: &[Pose<S>]) -> S {
        poses[self.j].angle - poses[self.i].angle - self.course.at(time)[0]
    }

    /// Φ̇ (rad/s).
    pub fn velocity_error(&self, time: S, motions: &[Motion<S>]) -> S {
        motions[self.j].angular - motions[self.i].angular - self.course.at(time)[1]
    }

    /// Φ̈ (rad/s²).
    #[inline(always)]
    pub fn acceleration_error(&self, time: S, accelerations: &[Motion<S>]) -> S {
        let relative = accelerations[self.j].angular - accelerations[self.i].angular;
        if self.course.accelerates() { relative - self.course.at(time)[2] } else { relative }
    }

    /// Φ_q.
    pub fn jacobian(&self) -> [Block<S>; 2] {
        let (one, zero) = (S::one(), S::zero());
        [[zero, zero, -one], [zero, zero, one]]
    }

    /// −Φ_qᵀ λ on bodies `i` and `j`.
    pub fn wrenches(&self, lambda: S) -> [Wrench<S>; 2] {
        let torque = |moment| Wrench { force: Vector::zero(), moment };
        [torque(lambda), torque(-lambda)]
    }
}
