//! Contacts as they happen: their begin and end, true peaks, dissipated energy.

use super::recorder::{Contact, Peak};
use crate::mechanism::ContactRates;
use crate::scalar::{Scalar, bits};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// A contact that has begun and not ended.
#[derive(Debug, Clone)]
pub(super) struct Touching<S> {
    /// Number of the contact, counted from the run's begin.
    pub number: u64,
    /// Rates at the end of the last step.
    pub last: ContactRates<S>,
    /// Energy dissipated in this clearance before the contact began (J).
    pub dissipated_before: S,
    /// Whether the law has pulled.
    pub pulled: bool,
    /// Lowest force since the last maximum (N).
    low: f64,
    /// A maximum that may yet be overtaken by a higher one.
    candidate: Option<Peak>,
}

/// What is kept of an open contact at a checkpoint.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(bound(serialize = "S: Scalar", deserialize = "S: Scalar"))]
pub(super) struct Held<S> {
    number: u64,
    #[serde(with = "bits")]
    dissipated_before: S,
    pulled: bool,
    #[serde(with = "bits")]
    low: f64,
    candidate: Option<Peak>,
}

impl<S: Scalar> Touching<S> {
    /// What is kept of it.
    pub fn hold(&self) -> Held<S> {
        let Touching { number, last: _, dissipated_before, pulled, low, candidate } = *self;
        Held { number, dissipated_before, pulled, low, candidate }
    }

    /// The contact that was held, with the rates that it has now.
    pub fn take_up(held: &Held<S>, last: ContactRates<S>) -> Self {
        let Held { number, dissipated_before, pulled, low, candidate } = *held;
        Touching { number, last, dissipated_before, pulled, low, candidate }
    }

    pub fn new(number: u64, rates: ContactRates<S>, dissipated_before: S) -> Self {
        let force = rates.force;
        Touching {
            number,
            last: rates,
            dissipated_before,
            pulled: force < S::zero(),
            low: force.to_f64(),
            candidate: None,
        }
    }

    /// Takes note of a maximum of the force. Maxima that do not stand out from their neighbours
    /// by more than `noise` (N) are what the tolerance makes of a steady force.
    pub fn maximum(&mut self, peak: Peak) {
        if self.candidate.is_none_or(|candidate| peak.force > candidate.force) {
            self.candidate = Some(peak);
        }
    }

    /// Takes note of the force (N) at the end of a step: beside a maximum it may be the higher by what
    /// the tolerance leaves, up to `noise` (N), and is the maximum then.
    pub fn beside(&mut self, time: f64, force: f64, noise: f64) {
        let raised = |peak: &Peak| force > peak.force && force - peak.force <= noise;
        self.candidate = self.candidate.map(|peak| match raised(&peak) {
            true => Peak { time, force, ..peak },
            false => peak,
        });
    }

    /// Follows the force (N); returns a maximum that now stands out on both sides.
    pub fn follow(&mut self, force: f64, noise: f64) -> Option<Peak> {
        let fallen = self.candidate.filter(|peak| peak.force - force > noise);
        let outstanding = fallen.filter(|peak| peak.force - self.low > noise);
        if fallen.is_some() {
            self.candidate = None;
            self.low = force;
        }
        self.low = self.low.min(force);
        outstanding
    }

    /// Time of the maximum that is not settled yet (s).
    pub fn open_since(&self) -> Option<f64> {
        self.candidate.map(|peak| peak.time)
    }

    /// The maximum that was not settled when the contact or the run ended.
    pub fn unsettled(self, noise: f64) -> Option<Peak> {
        self.candidate.filter(|peak| peak.force - self.low > noise)
    }
}

/// Contacts in the order of their begins, kept until all before them have ended.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Contacts {
    queue: VecDeque<(Contact, bool)>,
    first: u64,
}

impl Contacts {
    /// Opens a contact; returns its number.
    pub fn open(&mut self, contact: Contact) -> u64 {
        self.queue.push_back((contact, false));
        self.first + self.queue.len() as u64 - 1
    }

    /// An open contact.
    pub fn get(&mut self, number: u64) -> Option<&mut Contact> {
        let place = usize::try_from(number.checked_sub(self.first)?).ok()?;
        self.queue.get_mut(place).map(|(contact, _)| contact)
    }

    /// Closes a contact.
    pub fn close(&mut self, number: u64) {
        let place = number.checked_sub(self.first).and_then(|place| usize::try_from(place).ok());
        if let Some(entry) = place.and_then(|place| self.queue.get_mut(place)) {
            entry.1 = true;
        }
    }

    /// The next contact that is complete, in the order of begins; at the run's end any contact.
    pub fn next(&mut self, ended: bool) -> Option<Contact> {
        if !ended && !self.queue.front()?.1 {
            return None;
        }
        self.first += 1;
        self.queue.pop_front().map(|(contact, _)| contact)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touching() -> Touching<f64> {
        let rates = ContactRates { depth: 0.0, rate: 1.0, force: 0.0, force_rate: 0.0, slope: 0.0 };
        Touching::new(0, rates, 0.0)
    }

    fn peak(force: f64) -> Peak {
        Peak { time: 1.0, clearance: 0, force }
    }

    #[test]
    fn a_maximum_counts_once_the_force_has_fallen() {
        let mut touching = touching();
        touching.maximum(peak(10.0));
        assert_eq!(touching.follow(9.999, 0.01), None);
        assert_eq!(touching.follow(9.0, 0.01), Some(peak(10.0)));
        assert_eq!(touching.follow(8.0, 0.01), None);
    }

    #[test]
    fn the_end_of_a_step_beside_a_maximum_may_be_the_higher() {
        let mut touching = touching();
        touching.maximum(peak(10.0));
        touching.beside(1.5, 9.999, 0.01);
        assert_eq!(touching.candidate, Some(peak(10.0)));
        touching.beside(1.5, 10.001, 0.01);
        assert_eq!(touching.candidate, Some(Peak { time: 1.5, ..peak(10.001) }));
        touching.beside(2.0, 11.0, 0.01);
        assert_eq!(touching.candidate, Some(Peak { time: 1.5, ..peak(10.001) }));
    }

    #[test]
    fn ripples_of_a_steady_force_are_no_maxima() {
        let mut touching = touching();
        touching.low = 10.0;
        for ripple in [10.001, 10.002, 10.001] {
            touching.maximum(peak(ripple));
            assert_eq!(touching.follow(10.0, 0.01), None);
        }
    }

    #[test]
    fn contacts_leave_in_the_order_of_their_begins() {
        let contact = |begin| Contact {
            clearance: 0,
            begin,
            end: f64::NAN,
            impact_rate: 1.0,
            peak_penetration: 0.0,
            peak_penetration_time: begin,
            peak_force: 0.0,
            peak_time: begin,
            dissipated: 0.0,
        };
        let mut contacts = Contacts::default();
        let long = contacts.open(contact(1.0));
        let short = contacts.open(contact(2.0));
        contacts.close(short);
        assert_eq!(contacts.next(false).map(|c| c.begin), None);
        contacts.close(long);
        assert_eq!(contacts.next(false).map(|c| c.begin), Some(1.0));
        assert_eq!(contacts.next(false).map(|c| c.begin), Some(2.0));
    }
}
