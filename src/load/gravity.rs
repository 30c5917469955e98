//! Gravity: a uniform field.
//! ```text
//! F = m g,   V = −m g·(r − r₀)
//! ```

use crate::plane::{Pose, Vector, Wrench};
use crate::scalar::Scalar;

/// The field.
#[derive(Debug, Clone, Copy)]
pub struct Gravity<S> {
    /// Acceleration of free fall g (m/s²), fixed frame.
    pub acceleration: Vector<S>,
    /// Where potential energy is zero (m).
    pub datum: Vector<S>,
}

impl<S: Scalar> Gravity<S> {
    /// Adds the weight of each body (N).
    #[inline(always)]
    pub fn apply(&self, masses: &[S], wrenches: &mut [Wrench<S>]) {
        for (wrench, mass) in wrenches.iter_mut().zip(masses) {
            wrench.force += self.acceleration * *mass;
        }
    }

    /// Potential energy (J), zero at the datum.
    pub fn potential_energy(&self, masses: &[S], poses: &[Pose<S>]) -> S {
        let weigh = |(mass, pose): (&S, &Pose<S>)| {
            *mass * self.acceleration.dot(pose.position - self.datum)
        };
        -masses.iter().zip(poses).map(weigh).fold(S::zero(), |sum, v| sum + v)
    }
}
