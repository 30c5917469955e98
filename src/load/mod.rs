//! Gravity and whatever else acts on bodies, one file a load.

mod gravity;

pub use gravity::Gravity;

use crate::plane::{Pose, Wrench};
use crate::scalar::Scalar;

/// A load.
#[derive(Debug, Clone, Copy)]
pub enum Load<S> {
    /// A uniform field.
    Gravity(Gravity<S>),
}

impl<S: Scalar> Load<S> {
    /// Adds what the load puts on each body (N, N m); `masses` (kg) and `wrenches` are by body.
    #[inline(always)]
    pub fn apply(&self, masses: &[S], wrenches: &mut [Wrench<S>]) {
        match self {
            Load::Gravity(gravity) => gravity.apply(masses, wrenches),
        }
    }

    /// Potential energy (J).
    pub fn potential_energy(&self, masses: &[S], poses: &[Pose<S>]) -> S {
        match self {
            Load::Gravity(gravity) => gravity.potential_energy(masses, poses),
        }
    }
}
