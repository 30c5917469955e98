//! Ideal joints and drives, one file a joint.
//!
//! Each states itself at three levels: position error Φ, Jacobian Φ_q, acceleration bias γ. In
//! all of them body `i` is the first and `j` the second, and a multiplier is what the joint puts
//! on body `i`; body `j` gets its opposite.

mod drive;
mod revolute;

pub use drive::SpeedDrive;
pub use revolute::Revolute;

use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::Scalar;

/// The coefficients of one constraint row at ẋ, ẏ, θ̇ of one body.
pub type Block<S> = [S; 3];

/// The bodies of a joint and the places of its points on them.
#[derive(Debug, Clone, Copy)]
pub struct Pair<S> {
    /// Index of the first body; 0 is the ground.
    pub i: usize,
    /// Index of the second body.
    pub j: usize,
    /// The first point, in the frame of body `i` (m).
    pub s_i: Vector<S>,
    /// The second point, in the frame of body `j` (m).
    pub s_j: Vector<S>,
}

/// A constraint between two bodies; its rows stand in the order of its position error.
#[derive(Debug, Clone, Copy)]
pub enum Constraint<S> {
    /// Two points stay together.
    Revolute(Revolute<S>),
    /// A relative angle is a function of time.
    Drive(SpeedDrive<S>),
}

impl<S: Scalar> Constraint<S> {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        match self {
            Constraint::Revolute(_) => 2,
            Constraint::Drive(_) => 1,
        }
    }

    /// The two bodies, `i` and `j`.
    pub fn bodies(&self) -> [usize; 2] {
        match self {
            Constraint::Revolute(joint) => [joint.pair.i, joint.pair.j],
            Constraint::Drive(drive) => [drive.i, drive.j],
        }
    }

    /// A_i s_i and A_j s_j: from the mass centres to the points (m), fixed frame; what the
    /// functions below want of the poses.
    #[inline(always)]
    pub fn arms(&self, poses: &[Pose<S>]) -> [Vector<S>; 2] {
        match self {
            Constraint::Revolute(joint) => joint.arms(poses),
            Constraint::Drive(_) => [Vector::zero(); 2],
        }
    }

    /// Φ (m, rad) of each row.
    pub fn position_error(&self, time: S, poses: &[Pose<S>], error: &mut [S]) {
        match self {
            Constraint::Revolute(joint) => {
                let gap = joint.position_error(poses);
                (error[0], error[1]) = (gap.x, gap.y);
            }
            Constraint::Drive(drive) => error[0] = drive.position_error(time, poses),
        }
    }

    /// Φ̇ (m/s, rad/s) of each row.
    pub fn velocity_error(&self, poses: &[Pose<S>], motions: &[Motion<S>], error: &mut [S]) {
        match self {
            Constraint::Revolute(joint) => {
                let rate = joint.velocity_error(poses, motions);
                (error[0], error[1]) = (rate.x, rate.y);
            }
            Constraint::Drive(drive) => error[0] = drive.velocity_error(motions),
        }
    }

    /// Φ̈ (m/s², rad/s²) of each row for given accelerations; −γ where those of the moving bodies
    /// are zero.
    #[inline(always)]
    pub fn acceleration_error(
        &self,
        arms: &[Vector<S>; 2],
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
        error: &mut [S],
    ) {
        match self {
            Constraint::Revolute(joint) => {
                let a = joint.acceleration_error(arms, motions, accelerations);
                (error[0], error[1]) = (a.x, a.y);
            }
            Constraint::Drive(drive) => error[0] = drive.acceleration_error(accelerations),
        }
    }

    /// Φ_q of one row: its blocks for bodies `i` and `j`. The coefficients at ẋ and ẏ are constants,
    /// on which the layout of a mechanism relies.
    #[inline(always)]
    pub fn jacobian(&self, row: usize, arms: &[Vector<S>; 2]) -> [Block<S>; 2] {
        match self {
            Constraint::Revolute(_) => Revolute::jacobian(row, arms),
            Constraint::Drive(drive) => drive.jacobian(),
        }
    }

    /// −Φ_qᵀ λ: what the multipliers put on bodies `i` and `j`.
    #[inline(always)]
    pub fn wrenches(&self, arms: &[Vector<S>; 2], lambda: &[S]) -> [Wrench<S>; 2] {
        match self {
            Constraint::Revolute(_) => Revolute::wrenches(arms, Vector::new(lambda[0], lambda[1])),
            Constraint::Drive(drive) => drive.wrenches(lambda[0]),
        }
    }

    /// ∂(Φ_qᵀ λ)/∂q: its only entries, at (θ_i, θ_i) and (θ_j, θ_j).
    pub fn d_wrenches(&self, poses: &[Pose<S>], lambda: &[S]) -> [S; 2] {
        match self {
            Constraint::Revolute(joint) => {
                joint.d_wrenches(poses, Vector::new(lambda[0], lambda[1]))
            }
            Constraint::Drive(_) => [S::zero(); 2],
        }
    }

    /// ∂Φ̈/∂(θ, θ̇) of one row, for bodies `i` and `j`: its only entries.
    pub fn d_acceleration(
        &self,
        row: usize,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
    ) -> [[S; 2]; 2] {
        match self {
            Constraint::Revolute(joint) => joint.d_acceleration(row, poses, motions, accelerations),
            Constraint::Drive(_) => [[S::zero(); 2]; 2],
        }
    }
}
