//! Whether this process has been asked to stop.
//!
//! A signal is the whole process's, and so is this: whatever takes long asks it, however deep inside
//! a step it stands. A mechanism that is to be evaluated after that gives
//! [`Halted`], and whoever wanted to know gives up.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

static SIGNAL: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);

/// The process was asked to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Halted;

/// Where a handler puts the number of the signal that asks to stop.
pub fn flag() -> Arc<AtomicUsize> {
    Arc::clone(&SIGNAL)
}

/// The signal that has asked, if one has.
pub fn signal() -> Option<usize> {
    Some(SIGNAL.load(Ordering::Relaxed)).filter(|signal| *signal != 0)
}

/// Whether to stop.
#[inline]
pub fn is_asked() -> bool {
    SIGNAL.load(Ordering::Relaxed) != 0
}
