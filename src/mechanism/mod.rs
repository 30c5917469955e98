//! The checked mechanism as a system of equations.
mod observation;
pub use observation::*;
