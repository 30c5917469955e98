//! A damping law of one's own.
//! ```text
//! a = 1 − e
//! ```

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "straight",
    formula: "a = 1 − e",
    source: "nobody",
    valid: "An example.",
    restitution: true,
};

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    S::one() - e
}
