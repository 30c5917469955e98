//! The loop over segments.
mod recorder;
pub use recorder::*;
