//! What a run tells whoever keeps it.

use crate::mechanism::Observation;
use std::error::Error;

/// Kinds of event; the number is that of result files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// A contact begins.
    ContactBegins = 0,
    /// A contact ends.
    ContactEnds = 1,
    /// The slip passes an edge of the friction law's ramp.
    FrictionKink = 2,
    /// The contact law begins to pull, or ends it.
    Tension = 3,
}

/// One event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Time (s).
    pub time: f64,
    /// Index of the clearance.
    pub clearance: usize,
    /// What happened.
    pub kind: EventKind,
    /// Penetration rate (m/s), or the slip velocity (m/s) at a friction kink.
    pub rate: f64,
}

/// One contact, from its begin to its end. Penetration and force are true extrema.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Index of the clearance.
    pub clearance: usize,
    /// Begin (s).
    pub begin: f64,
    /// End (s); NaN while open.
    pub end: f64,
    /// Penetration rate at the begin (m/s), before a slow approach is raised.
    pub impact_rate: f64,
    /// Largest penetration (m).
    pub peak_penetration: f64,
    /// Largest normal force (N).
    pub peak_force: f64,
    /// Time of the largest normal force (s).
    pub peak_time: f64,
    /// Dissipated by damping and friction (J).
    pub dissipated: f64,
}

/// A local maximum of a normal force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Time (s).
    pub time: f64,
    /// Index of the clearance.
    pub clearance: usize,
    /// Normal force (N).
    pub force: f64,
}

/// Keeps what a run tells. Samples come in the order of time; a contact comes when it ends, or,
/// still open, when the run does.
pub trait Recorder {
    /// What can go wrong in keeping.
    type Error: Error + Send + Sync + 'static;

    /// The mechanism at a sample time.
    fn sample(&mut self, observation: &Observation) -> Result<(), Self::Error>;

    /// An event.
    fn event(&mut self, event: Event) -> Result<(), Self::Error>;

    /// A contact.
    fn contact(&mut self, contact: Contact) -> Result<(), Self::Error>;

    /// A peak of a normal force.
    fn peak(&mut self, peak: Peak) -> Result<(), Self::Error>;
}
