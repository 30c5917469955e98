//! The checked mechanism.
mod check;
mod complaint;
mod description;
pub use check::check;
pub use complaint::*;
pub use description::*;
