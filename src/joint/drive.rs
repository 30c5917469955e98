//! Drive of constant speed: the angle of body `j` relative to body `i` is a function of time.
//! ```text
//! Φ = θ_j − θ_i − (φ0 + Ω t) = 0   (rad),   γ = 0,   Ω = 2π/60 · speed_rpm
//! ```
//! A multiplier λ (N m) is the torque on body `i`; the drive's torque on body `j` is −λ. Where the
//! drive prescribes a body completely the constraint is eliminated with the body, and the torque
//! comes from inverse dynamics.

use super::Block;
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::{Decimal, F256, Scalar};

/// The drive: two bodies, an angle and a rate.
#[derive(Debug, Clone, Copy)]
pub struct SpeedDrive<S> {
    /// Index of the first body.
    pub i: usize,
    /// Index of the second body.
    pub j: usize,
    angle: S,
    rate: S,
    rate_tail: f64,
}

impl<S: Scalar> SpeedDrive<S> {
    /// A drive at `speed_rpm` (revolutions a minute) that stands at `angle` (rad) at t = 0.
    pub fn new(i: usize, j: usize, speed_rpm: &Decimal, angle: &Decimal) -> Self {
        let rate = speed_rpm.value::<S>() * (S::pi() / S::from_f64(30.0));
        let exact = speed_rpm.value::<F256>() * F256::pi() / F256::from(30);
        let rate_tail = (exact - F256::from(rate.to_f64())).to_f64();
        SpeedDrive { i, j, angle: angle.value(), rate, rate_tail }
    }

    /// Relative angular rate Ω (rad/s).
    #[inline(always)]
    pub fn rate(&self) -> S {
        self.rate
    }

    /// Relative angle (rad), not wrapped.
    pub fn angle(&self, time: S) -> S {
        self.angle + self.rate * time
    }

    /// Relative angle (rad) less whole revolutions, to the last place of the arithmetic however
    /// long the run.
    #[inline(always)]
    pub fn wrapped_angle(&self, time: S) -> S {
        self.angle + S::phase(self.rate, self.rate_tail, time)
    }

    /// Φ (rad).
    pub fn position_error(&self, time: S, poses: &[Pose<S>]) -> S {
        poses[self.j].angle - poses[self.i].angle - self.angle(time)
    }

    /// Φ̇ (rad/s).
    pub fn velocity_error(&self, motions: &[Motion<S>]) -> S {
        motions[self.j].angular - motions[self.i].angular - self.rate
    }

    /// Φ̈ (rad/s²).
    pub fn acceleration_error(&self, accelerations: &[Motion<S>]) -> S {
        accelerations[self.j].angular - accelerations[self.i].angular
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
