//! Hertz normal force, elastic.
//! ```text
//! F_N = K δⁿ,   a = 0
//! ```
//! Returns all of the impact energy; the limit c_e = 1 of every law of the family.

use crate::scalar::Scalar;

/// The damping weight: none.
pub fn damping_weight<S: Scalar>() -> S {
    S::zero()
}
