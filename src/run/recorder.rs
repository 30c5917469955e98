//! What a run tells whoever keeps it.

use crate::mechanism::{Measure, Measures, Observation};
use crate::model::Owner;
use crate::scalar::bits;
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::ops::ControlFlow;

/// Kinds of event; the number is that of result files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum EventKind {
    /// A contact begins.
    #[default]
    ContactBegins = 0,
    /// A contact ends.
    ContactEnds = 1,
    /// The slip passes an edge of the friction law.
    FrictionKink = 2,
    /// The contact law begins to pull, or ends it.
    Tension = 3,
    /// A derivative of what is prescribed jumps.
    CourseChanges = 6,
    /// The mechanism comes to a singular position.
    Singular = 7,
}

/// What an event does to the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// Its owner goes over to another mode, and the engine begins anew.
    SwitchesMode,
    /// The engine begins anew from the same state.
    BeginsAnew,
    /// The engine begins anew behind it where the way is clear; the run ends there where it is not.
    PassesOrStops,
}

impl EventKind {
    /// All, in the order of their numbers.
    pub const ALL: [EventKind; 6] = [
        EventKind::ContactBegins,
        EventKind::ContactEnds,
        EventKind::FrictionKink,
        EventKind::Tension,
        EventKind::CourseChanges,
        EventKind::Singular,
    ];

    /// Their numbers and names in result files and tables, in that order.
    pub const WORDS: [(i8, &'static str); EventKind::ALL.len()] = {
        let mut words = [(0, ""); EventKind::ALL.len()];
        let mut place = 0;
        while place < words.len() {
            let kind = EventKind::ALL[place];
            words[place] = (kind as i8, kind.word());
            place += 1;
        }
        words
    };

    /// That of a number in result files, if there is one.
    pub fn of_number(number: i8) -> Option<EventKind> {
        EventKind::ALL.into_iter().find(|kind| *kind as i8 == number)
    }

    /// Its name in result files and tables.
    pub const fn word(self) -> &'static str {
        match self {
            EventKind::ContactBegins => "contact_begins",
            EventKind::ContactEnds => "contact_ends",
            EventKind::FrictionKink => "friction_kink",
            EventKind::Tension => "tension_begins_or_ends",
            EventKind::CourseChanges => "course_changes",
            EventKind::Singular => "singular_position",
        }
    }

    /// What happens, in a sentence.
    pub const fn sentence(self) -> &'static str {
        match self {
            EventKind::ContactBegins => "a contact begins",
            EventKind::ContactEnds => "a contact ends",
            EventKind::FrictionKink => "the slip passes an edge of friction",
            EventKind::Tension => "tension begins or ends",
            EventKind::CourseChanges => "a derivative of what is prescribed jumps",
            EventKind::Singular => "the mechanism comes to a singular position",
        }
    }

    /// What it does to the run.
    pub const fn effect(self) -> Effect {
        match self {
            EventKind::ContactBegins
            | EventKind::ContactEnds
            | EventKind::FrictionKink
            | EventKind::Tension => Effect::SwitchesMode,
            EventKind::CourseChanges => Effect::BeginsAnew,
            EventKind::Singular => Effect::PassesOrStops,
        }
    }
}

/// One event.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Event {
    /// Time (s).
    pub time: f64,
    /// What it belongs to.
    pub owner: Owner,
    /// What happened.
    pub kind: EventKind,
    /// Penetration rate (m/s); the slip velocity (m/s) at a friction kink; 0 where a course changes; at a
    /// singular position the share that its owner's constraints do not depend on the others, 0 where the
    /// run went on through it.
    pub rate: f64,
}

/// One contact, from its begin to its end, or to the end of the run while it is open. Penetration
/// and force are true extrema.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Contact {
    /// Index of the clearance.
    pub clearance: usize,
    /// Begin (s).
    #[serde(with = "bits")]
    pub begin: f64,
    /// End (s); NaN while open.
    #[serde(with = "bits")]
    pub end: f64,
    /// Penetration rate at the begin (m/s), before a slow approach is raised.
    #[serde(with = "bits")]
    pub impact_rate: f64,
    /// Largest penetration (m).
    #[serde(with = "bits")]
    pub peak_penetration: f64,
    /// Time of the largest penetration (s).
    #[serde(with = "bits")]
    pub peak_penetration_time: f64,
    /// Largest normal force (N).
    #[serde(with = "bits")]
    pub peak_force: f64,
    /// Time of the largest normal force (s).
    #[serde(with = "bits")]
    pub peak_time: f64,
    /// Dissipated by damping and friction (J).
    #[serde(with = "bits")]
    pub dissipated: f64,
}

/// A local maximum of a normal force.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Peak {
    /// Time (s).
    #[serde(with = "bits")]
    pub time: f64,
    /// Index of the clearance.
    pub clearance: usize,
    /// Normal force (N).
    #[serde(with = "bits")]
    pub force: f64,
}

/// A value, and when it was (s).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Extremum {
    /// The value.
    #[serde(with = "bits")]
    pub value: f64,
    /// Its time (s).
    #[serde(with = "bits")]
    pub time: f64,
}

/// True extremes of all measures over one revolution of the first drive; over the whole run where
/// no drive turns.
#[derive(Debug, Clone, PartialEq)]
pub struct Revolution {
    /// Begin (s).
    pub begin: f64,
    /// End (s): of the revolution or of the run.
    pub end: f64,
    /// What stands where in the lists.
    pub measures: Measures,
    /// The largest of each measure.
    pub largest: Vec<Extremum>,
    /// The smallest of each measure that has a sign.
    pub smallest: Vec<Extremum>,
}

impl Revolution {
    /// The largest values of a measure, by body, joint, clearance or drive.
    pub fn largest(&self, measure: Measure) -> impl Iterator<Item = Extremum> {
        self.measures.places(measure).map(|place| self.largest[place])
    }

    /// The smallest values of a measure that has a sign; none of one that has not.
    pub fn smallest(&self, measure: Measure) -> impl Iterator<Item = Extremum> {
        self.measures.places(measure).filter_map(|place| self.smallest.get(place).copied())
    }
}

/// A checkpoint of a run, for whoever keeps it.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// Its number, from 1.
    pub number: u64,
    /// Its time (s).
    pub time: f64,
    /// All that the run goes on from, in one line of text.
    pub text: String,
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

    /// Whether it keeps the extremes of revolutions: if not, the run spares itself the search.
    fn keeps_revolutions(&self) -> bool {
        false
    }

    /// The extremes of a revolution that is over, or that the run ended in.
    fn revolution(&mut self, revolution: &Revolution) -> Result<(), Self::Error> {
        let _ = revolution;
        Ok(())
    }

    /// A checkpoint: what was told so far is to be kept for good. Says whether the run is to go on.
    fn checkpoint(&mut self, kept: &Kept) -> Result<ControlFlow<()>, Self::Error> {
        let _ = kept;
        Ok(ControlFlow::Continue(()))
    }
}
