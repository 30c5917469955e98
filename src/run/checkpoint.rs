//! Checkpoints: times at which a run begins anew by definition, from nothing but what is kept there.
//!
//! At a checkpoint the run is taken apart and put together again, by another engine and with another
//! mechanism, from [`Checkpoint`] alone: so a run that is taken up later, by another process, goes on
//! as it would have. Whatever is not kept is as it is at a start: the engine's memory and first steps,
//! the window of adaptive sampling, the stations of the search for extremes.

use super::extremes::Records;
use super::recorder::Peak;
use super::touching::{Contacts, Held};
use super::{Progress, RulingCounts};
use crate::clearance::Mode;
use crate::dae::{Snapshot, System};
use crate::mechanism::Mechanism;
use crate::scalar::{Decimal, F256, Scalar, bits};
use serde::{Deserialize, Serialize};

/// All that a run goes on from.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(bound(serialize = "S: Scalar", deserialize = "S: Scalar"), deny_unknown_fields)]
pub struct Checkpoint<S> {
    /// Number of the checkpoint, from 1; the run sets it.
    pub(super) number: u64,
    /// State, on the constraints.
    pub(super) state: Snapshot<S>,
    /// Mode of each clearance.
    pub(super) modes: Vec<Mode<S>>,
    /// Number of the next sample of the schedule.
    pub(super) next_sample: u64,
    /// Time of the last sample that adaptive sampling took (s).
    #[serde(with = "bits")]
    pub(super) sampled_until: f64,
    /// Open contacts, by clearance.
    pub(super) touching: Vec<Option<Held<S>>>,
    /// Contacts that wait for others to end.
    pub(super) contacts: Contacts,
    /// Peaks that are not settled.
    pub(super) peaks: Vec<Peak>,
    /// Extremes of the present revolution, where they are kept.
    pub(super) extremes: Option<Records>,
    /// Largest energy seen (J).
    #[serde(with = "bits")]
    pub(super) energy: f64,
    pub(super) progress: Progress,
    pub(super) segment: u64,
    pub(super) rulings: RulingCounts,
    /// What the engines counted since the run began, in the order of their counts.
    pub(super) work: Vec<u64>,
}

/// What a checkpoint is made of cannot be read, or is none of this mechanism's.
#[derive(Debug, thiserror::Error)]
pub enum NotACheckpoint {
    /// It is no text of a checkpoint.
    #[error("what is kept of the run cannot be read")]
    Unreadable(#[from] serde_json::Error),
    /// It is that of another mechanism.
    #[error("what is kept of the run is of another mechanism: {what} differ in number")]
    Other {
        /// What is more or less than it should be.
        what: &'static str,
    },
}

impl<S: Scalar> Checkpoint<S> {
    /// Its place among the checkpoints of a run, from 1.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Its time (s).
    pub fn time(&self) -> S {
        self.state.time
    }

    /// The state, on the constraints.
    pub fn state(&self) -> &Snapshot<S> {
        &self.state
    }

    /// All numbers that the motion goes on from: coordinates and velocities, behind them inner states and
    /// the impact rates that contacts remember.
    pub(crate) fn carried_mut(&mut self) -> Vec<&mut S> {
        let Snapshot { q, v, z, .. } = &mut self.state;
        let rates = self.modes.iter_mut().flat_map(|mode| match mode {
            Mode::Flight => None,
            Mode::Contact(contact) => {
                Some([&mut contact.impact_rate, &mut contact.inverse_impact_rate])
            }
        });
        q.iter_mut().chain(v).chain(z).chain(rates.flatten()).collect()
    }

    /// What the engines counted since the run began.
    pub fn work(&self) -> &[u64] {
        &self.work
    }

    /// The checkpoint with its number, and what engines counted.
    pub(crate) fn with(self, number: u64, work: Vec<u64>) -> Self {
        Checkpoint { number, work, ..self }
    }

    /// At a state, with nothing else to be kept.
    pub(super) fn bare(state: Snapshot<S>, next_sample: u64, progress: Progress) -> Self {
        Checkpoint {
            number: 0,
            state,
            modes: Vec::new(),
            next_sample,
            sampled_until: f64::NEG_INFINITY,
            touching: Vec::new(),
            contacts: Contacts::default(),
            peaks: Vec::new(),
            extremes: None,
            energy: 0.0,
            progress,
            segment: 1,
            rulings: RulingCounts::default(),
            work: Vec::new(),
        }
    }

    /// All of it in one line.
    pub fn to_text(&self) -> String {
        // every map has keys that are text, and every number is written by its bits
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Reads back what [`to_text`](Checkpoint::to_text) gave of a run of this mechanism.
    ///
    /// # Errors
    /// The text is none, or that of another mechanism.
    pub fn from_text(text: &str, mechanism: &Mechanism<S>) -> Result<Self, NotACheckpoint> {
        let kept: Checkpoint<S> = serde_json::from_str(text)?;
        let (start, measures) = (mechanism.start(), mechanism.measures());
        let extremes = kept.extremes.as_ref();
        let clearances = mechanism.modes().len();
        let differs = [
            ("coordinates", kept.state.q.len() != start.q.len()),
            ("velocities", kept.state.v.len() != start.v.len()),
            ("inner states", kept.state.z.len() != start.z.len()),
            ("integrals", kept.state.integrals.len() != mechanism.integrals()),
            ("clearances", kept.modes.len() != clearances || kept.touching.len() != clearances),
            ("extremes", extremes.is_some_and(|records| !records.fit(&measures))),
        ];
        match differs.into_iter().find(|(_, differ)| *differ) {
            Some((what, _)) => Err(NotACheckpoint::Other { what }),
            None => Ok(kept),
        }
    }
}

/// A part of a run, from one checkpoint to the next.
#[derive(Debug)]
pub struct Stretch<'a, S> {
    /// Where it begins; `None` for the start.
    pub from: Option<&'a Checkpoint<S>>,
    /// The checkpoint that it leads to (s); `None` for the end of the run.
    pub until: Option<S>,
}

impl<S> Stretch<'_, S> {
    /// A run without checkpoints.
    pub const WHOLE: Self = Stretch { from: None, until: None };
}

/// What a stretch has come to.
#[derive(Debug)]
pub enum Reached<S> {
    /// The end of the run.
    End(RulingCounts),
    /// A checkpoint.
    Checkpoint(Box<Checkpoint<S>>),
}

/// When a run is to begin anew: at the multiples of an interval, up to the duration.
#[derive(Debug, Clone, Copy)]
pub struct Checkpoints {
    interval: F256,
    count: u64,
}

impl Checkpoints {
    /// Every `interval` (s) of a run of `duration` (s), both positive.
    pub fn new(duration: &Decimal, interval: &Decimal) -> Self {
        let interval = interval.value();
        let (count, _) = super::schedule::multiples(duration.value(), interval);
        Checkpoints { interval, count }
    }

    /// Time of checkpoint `number` (s), from 1; `None` of one beyond the duration.
    pub fn time<S: Scalar>(&self, number: u64) -> Option<S> {
        let time = || S::from_octuple(F256::from(number) * self.interval);
        (number <= self.count).then(time)
    }
}
