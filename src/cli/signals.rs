//! Signals that ask the program to stop.
//!
//! SIGINT (Ctrl-C), SIGTERM, SIGHUP (a connection that was dropped) and SIGXCPU (the processor time
//! that was granted is over) are one and the same request; one that was ignored when the program
//! began, as `nohup` has it, stays ignored. SIGXFSZ is none: the write that was too long fails, and
//! that is told.

use super::Failure;
use crate::{halt, record};
use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM, SIGXCPU, SIGXFSZ};
use signal_hook::{flag, iterator, low_level};
use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

const REQUESTS: [i32; 4] = [SIGINT, SIGTERM, SIGHUP, SIGXCPU];

/// Watches for requests to stop. Whoever polls stops within a step; a second signal changes
/// nothing, so that it cannot cost what is being saved (`timeout` sends two).
pub(super) struct Signals(());

impl Signals {
    pub fn new() -> io::Result<Self> {
        let received = halt::flag();
        for signal in requests() {
            flag::register_usize(signal, Arc::clone(&received), signal as usize)?;
        }
        Ok(Signals(()))
    }

    /// Exit code of the signal that came, if one did.
    pub fn exit_code(&self) -> Option<u8> {
        exit_code()
    }

    /// Whether to go on.
    pub fn flow(&self) -> ControlFlow<()> {
        match halt::is_asked() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// An error of the simulation, or of the signal that ended it.
    pub fn failure(&self, error: impl std::error::Error + 'static) -> Failure {
        Failure::with(self.exit_code().unwrap_or(4), error)
    }
}

/// Exit code of the signal that asked to stop, if one did.
pub(super) fn exit_code() -> Option<u8> {
    u8::try_from(128 + halt::signal()?).ok()
}

/// The signals that were not ignored when the program began.
fn requests() -> impl Iterator<Item = i32> {
    let ignored = ignored();
    REQUESTS.into_iter().filter(move |signal| ignored >> (signal - 1) & 1 == 0)
}

/// The signals that are ignored, a bit each, the lowest for signal 1; none where the system does not
/// tell (proc(5), `SigIgn`).
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    line.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// Has a write beyond the largest size that a file may have fail, where it would end the program.
pub(super) fn let_long_writes_fail() {
    // without a handler things are as they were
    let _ = flag::register(SIGXFSZ, Arc::default());
}

/// Has the program end with exit code 4 where it would be aborted: memory that is asked for and not
/// there. What is missing stands on stderr by then.
pub(super) fn end_clearly_without_memory() {
    let always = Arc::new(AtomicBool::new(true));
    let _ = flag::register_conditional_shutdown(SIGABRT, 4, always);
}

/// For commands that keep nothing of what they have not finished: ends them at once, without
/// a trace.
pub(super) fn end_at_once() -> Result<(), Failure> {
    let mut signals = iterator::Signals::new(requests()).map_err(Failure::output)?;
    std::thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            record::abandon_drafts();
            low_level::exit(128 + signal);
        }
    });
    Ok(())
}
