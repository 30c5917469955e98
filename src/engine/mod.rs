//! Engines: what carries a system from one event to the next.

pub mod explicit;
pub mod guard;
pub mod ida;

#[cfg(test)]
pub(crate) mod testing;
