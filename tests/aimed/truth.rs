//! What is known of a mechanism without integrating its equations as freeplay does.

use freeplay::run::EventKind;
use freeplay::scalar::F256;

/// Bodies (x, y, θ and their rates), clearance vectors, normal forces where they are known.
#[derive(Clone, Default)]
pub struct State {
    pub bodies: Vec<[F256; 6]>,
    pub offsets: Vec<[F256; 2]>,
    pub normals: Vec<Option<F256>>,
    /// What is as true, where the rough start does not tell the two apart.
    pub or: Option<Box<State>>,
}

/// An event that must come.
#[derive(Clone, Copy, Debug)]
pub struct Event {
    pub time: F256,
    pub kind: EventKind,
    pub clearance: usize,
}

/// A case, and what is true of it.
pub struct Aimed {
    pub family: &'static str,
    /// The case without `[solver]`.
    pub text: String,
    /// The state at a time, where it is known.
    pub at: Box<dyn Fn(F256) -> Option<State> + Send>,
    /// All events until `known`, where they are unambiguous.
    pub events: Option<Vec<Event>>,
    /// Until when events are known (s).
    pub known: F256,
    /// Largest normal force of contacts that end, in the order of their ends, by clearance.
    pub peaks: Vec<(usize, F256)>,
}
