//! Hertz normal force, elastic.
//! ```text
//! F_N = K δⁿ,   a = 0
//! ```
//! Returns all of the impact energy; the limit c_e = 1 of every law of the family.

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "hertz",
    formula: "a = 0",
    source: "Hertz 1881, J. reine angew. Math. 92:156–171",
    valid: "Elastic: returns all of the energy.",
    restitution: false,
};

/// The damping weight: none.
pub fn weight<S: Scalar>(_: S) -> S {
    S::zero()
}
