//! Signals that ask the program to stop.

use super::Failure;
use signal_hook::consts::{SIGINT, SIGTERM};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Watches for Ctrl-C and termination. Whoever polls stops within a step; a second signal changes
/// nothing, so that it cannot cost what is being saved (`timeout` sends two).
pub(super) struct Signals {
    received: Arc<AtomicUsize>,
}

impl Signals {
    pub fn new() -> std::io::Result<Self> {
        let received = Arc::new(AtomicUsize::new(0));
        for signal in [SIGINT, SIGTERM] {
            signal_hook::flag::register_usize(signal, Arc::clone(&received), signal as usize)?;
        }
        Ok(Signals { received })
    }

    /// Exit code of the signal that came, if one did.
    pub fn exit_code(&self) -> Option<u8> {
        let signal = self.received.load(Ordering::Relaxed);
        u8::try_from(128 + signal).ok().filter(|_| signal != 0)
    }

    /// Whether to go on.
    pub fn flow(&self) -> ControlFlow<()> {
        match self.exit_code() {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        }
    }

    /// An error of the simulation, or of the signal that ended it.
    pub fn failure(&self, error: impl std::error::Error + 'static) -> Failure {
        Failure::with(self.exit_code().unwrap_or(4), error)
    }
}
