//! Ideal revolute joint: two points, one on each body, stay together.
//! ```text
//! Φ  = (r_j + A_j s_j) − (r_i + A_i s_i)                                   = 0   (m)
//! Φ̈  = a_j + A_j s_j^⊥ θ̈_j − A_j s_j θ̇_j² − (the same of i)                = 0   (m/s²)
//! Φ_q q̈ = γ,  γ = A_j s_j θ̇_j² − A_i s_i θ̇_i²
//! ```
//! A multiplier λ (N) is the force the joint puts on body `i`, in the fixed frame; body `j` gets
//! −λ (paper, eq. 14, 15).

use super::{BETWEEN, Block, Blocks, Ends, Holonomic, MOST_BODIES, MOST_ROWS, Pair, between};
use crate::parameter::{Kind, Values};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys; what a clearance takes stands with the clearances.
pub const KIND: Kind = Kind {
    word: "revolute",
    title: "two points stay together, or, with a clearance, nearly so",
    example: r#"[joints.A0]
kind = "revolute"
between = ["ground.A0", "crank.A0"]"#,
    keys: &[BETWEEN],
    ..Kind::PLAIN
};

/// The joint: the two points.
#[derive(Debug, Clone, Copy)]
pub struct Revolute<S> {
    /// Bodies and points.
    pub pair: Pair<S>,
}

impl<S: Scalar> Holonomic<S> for Revolute<S> {
    const ROWS: usize = 2;

    fn new(_: &Values, ends: &Ends<S>) -> Self {
        Revolute { pair: ends.pair }
    }

    #[inline(always)]
    fn error<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        let gap = between(&self.pair, poses);
        [gap.x, gap.y, T::zero()]
    }
}

impl<S: Scalar> Revolute<S> {
    /// A_i s_i and A_j s_j: from the mass centres to the points (m), fixed frame.
    #[inline(always)]
    pub fn arms(&self, poses: &[Pose<S>]) -> [Vector<S>; 2] {
        [poses[self.pair.i].rotate(self.pair.s_i), poses[self.pair.j].rotate(self.pair.s_j)]
    }

    /// Φ (m).
    pub fn position_error(&self, poses: &[Pose<S>]) -> Vector<S> {
        let [arm_i, arm_j] = self.arms(poses);
        poses[self.pair.j].position + arm_j - poses[self.pair.i].position - arm_i
    }

    /// Φ̇ (m/s).
    pub fn velocity_error(&self, poses: &[Pose<S>], motions: &[Motion<S>]) -> Vector<S> {
        let [arm_i, arm_j] = self.arms(poses);
        motions[self.pair.j].at(arm_j) - motions[self.pair.i].at(arm_i)
    }

    /// Φ̈ (m/s²).
    #[inline(always)]
    pub fn acceleration_error(
        &self,
        arms: &[Vector<S>; 2],
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
    ) -> Vector<S> {
        let [arm_i, arm_j] = *arms;
        let of = |body: usize, arm: Vector<S>| {
            let rate = motions[body].angular;
            accelerations[body].at(arm) - arm * (rate * rate)
        };
        of(self.pair.j, arm_j) - of(self.pair.i, arm_i)
    }

    /// Φ_q of one row.
    #[inline(always)]
    pub fn jacobian(row: usize, arms: &[Vector<S>; 2]) -> Blocks<S> {
        let [arm_i, arm_j] = *arms;
        let (one, zero) = (S::one(), S::zero());
        let none: Block<S> = [zero; 3];
        match row {
            0 => [[-one, zero, arm_i.y], [one, zero, -arm_j.y], none],
            _ => [[zero, -one, -arm_i.x], [zero, one, arm_j.x], none],
        }
    }

    /// −Φ_qᵀ λ on bodies `i` and `j`.
    #[inline(always)]
    pub fn wrenches(arms: &[Vector<S>; 2], lambda: Vector<S>) -> [Wrench<S>; 2] {
        let [arm_i, arm_j] = *arms;
        [Wrench::at(arm_i, lambda), Wrench::at(arm_j, -lambda)]
    }

    /// ∂(Φ_qᵀ λ)_θ/∂θ of bodies `i` and `j`.
    pub fn d_wrenches(&self, poses: &[Pose<S>], lambda: Vector<S>) -> [S; 2] {
        let [arm_i, arm_j] = self.arms(poses);
        [arm_i.dot(lambda), -arm_j.dot(lambda)]
    }

    /// ∂Φ̈/∂(θ, θ̇) of one row, for bodies `i` and `j`.
    pub fn d_acceleration(
        &self,
        row: usize,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
    ) -> [[S; 2]; 2] {
        let [arm_i, arm_j] = self.arms(poses);
        let of = |body: usize, arm: Vector<S>, sign: S| {
            let (rate, acceleration) = (motions[body].angular, accelerations[body].angular);
            let by_angle = -arm * acceleration - arm.turned() * (rate * rate);
            let by_rate = -arm * (rate + rate);
            match row {
                0 => [sign * by_angle.x, sign * by_rate.x],
                _ => [sign * by_angle.y, sign * by_rate.y],
            }
        };
        [of(self.pair.i, arm_i, -S::one()), of(self.pair.j, arm_j, S::one())]
    }
}
