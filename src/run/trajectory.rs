//! A recorder that keeps everything in memory.

use super::recorder::{Contact, Event, Peak, Recorder, Revolution};
use crate::mechanism::Observation;
use std::convert::Infallible;

/// What a run told, in memory.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trajectory {
    /// Samples, in the order of time.
    pub samples: Vec<Observation>,
    /// Events, in the order of time.
    pub events: Vec<Event>,
    /// Contacts, in the order of their begins.
    pub contacts: Vec<Contact>,
    /// Peaks of normal forces, in the order of time.
    pub peaks: Vec<Peak>,
    /// Extremes of revolutions, in the order of time.
    pub revolutions: Vec<Revolution>,
}

impl Recorder for Trajectory {
    type Error = Infallible;

    fn sample(&mut self, observation: &Observation) -> Result<(), Infallible> {
        self.samples.push(observation.clone());
        Ok(())
    }

    fn event(&mut self, event: Event) -> Result<(), Infallible> {
        self.events.push(event);
        Ok(())
    }

    fn contact(&mut self, contact: Contact) -> Result<(), Infallible> {
        self.contacts.push(contact);
        Ok(())
    }

    fn peak(&mut self, peak: Peak) -> Result<(), Infallible> {
        self.peaks.push(peak);
        Ok(())
    }

    fn keeps_revolutions(&self) -> bool {
        true
    }

    fn revolution(&mut self, revolution: &Revolution) -> Result<(), Infallible> {
        self.revolutions.push(revolution.clone());
        Ok(())
    }
}
