//! Recorders of all types as one, so that loops and engines are compiled once, not for each.

use super::{Contact, Event, Kept, Peak, Recorder, Revolution};
use crate::mechanism::Observation;
use std::ops::ControlFlow;

/// A recorder of whatever type.
pub type AnyRecorder<'a> = dyn Recorder<Error = NotKept> + 'a;

/// A recorder could not keep something; what it said stands in [`Erased::failure`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("what was to be kept could not be")]
pub struct NotKept;

/// A recorder whose errors stay here.
pub struct Erased<'a, R: Recorder> {
    recorder: &'a mut R,
    /// What the recorder could not keep something for.
    pub failure: Option<R::Error>,
}

impl<'a, R: Recorder> Erased<'a, R> {
    /// One that has not failed.
    pub fn new(recorder: &'a mut R) -> Self {
        Erased { recorder, failure: None }
    }

    fn keep<T>(&mut self, told: impl FnOnce(&mut R) -> Result<T, R::Error>) -> Result<T, NotKept> {
        told(self.recorder).map_err(|failure| {
            self.failure = Some(failure);
            NotKept
        })
    }
}

impl<R: Recorder> Recorder for Erased<'_, R> {
    type Error = NotKept;

    fn sample(&mut self, observation: &Observation) -> Result<(), NotKept> {
        self.keep(|recorder| recorder.sample(observation))
    }

    fn event(&mut self, event: Event) -> Result<(), NotKept> {
        self.keep(|recorder| recorder.event(event))
    }

    fn contact(&mut self, contact: Contact) -> Result<(), NotKept> {
        self.keep(|recorder| recorder.contact(contact))
    }

    fn peak(&mut self, peak: Peak) -> Result<(), NotKept> {
        self.keep(|recorder| recorder.peak(peak))
    }

    fn keeps_revolutions(&self) -> bool {
        self.recorder.keeps_revolutions()
    }

    fn revolution(&mut self, revolution: &Revolution) -> Result<(), NotKept> {
        self.keep(|recorder| recorder.revolution(revolution))
    }

    fn checkpoint(&mut self, kept: &Kept) -> Result<ControlFlow<()>, NotKept> {
        self.keep(|recorder| recorder.checkpoint(kept))
    }
}
