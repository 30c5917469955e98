//! Linear solves in any arithmetic, of the sizes and the patterns that mechanisms have.
//!
//! nalgebra's decompositions want a number type with far more functions than
//! [`Scalar`](crate::scalar::Scalar) has.

mod cascade;
mod dense;
mod nearest;
mod null;
mod symmetric;

pub use cascade::{Cascade, Row};
pub use dense::{determinant_sign, solve_square};
pub use nearest::nearest;
pub use null::{null_space, pivots};
pub use symmetric::Symmetric;

/// No solution: the pivot of this row is nothing but rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Singular {
    /// Row at which it was seen.
    pub row: usize,
}
