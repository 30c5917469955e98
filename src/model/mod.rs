//! The checked mechanism.
mod complaint;
mod description;
pub use complaint::*;
pub use description::*;
