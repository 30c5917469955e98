//! Events and contacts, matched one to one by the rule of [`digits`](crate::digits).

use super::Error;
use crate::digits::{self, Likes};
use crate::model::Owner;
use crate::record::ResultFile;
use crate::run::{Contact, Event, EventKind};
use std::collections::BTreeSet;

/// An event that both have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Its time in the reference (s).
    pub time: f64,
    /// Its time in the other (s).
    pub theirs: f64,
    /// How much larger its rate is in the other (m/s).
    pub faster: f64,
}

impl Pair {
    /// How much later it is in the other (s).
    pub fn later(&self) -> f64 {
        self.theirs - self.time
    }
}

/// Events of one kind and one owner.
#[derive(Debug, Clone, PartialEq)]
pub struct EventRow {
    /// What they belong to.
    pub owner: Owner,
    /// Kind, by its name in result files.
    pub kind: &'static str,
    /// Events that both have, in the order of the reference.
    pub pairs: Vec<Pair>,
    /// Times (s) of those that only the first file has.
    pub only_theirs: Vec<f64>,
    /// Times (s) of those that only the reference has.
    pub only_reference: Vec<f64>,
}

/// A contact that both have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPair {
    /// Index of the clearance.
    pub clearance: usize,
    /// Its begin in the reference (s).
    pub begin: f64,
    /// How much later it ends in the other (s); `None` while open in either.
    pub ends_later: Option<f64>,
    /// Largest force in the other over that in the reference, less one.
    pub peak_force: f64,
    /// How much later its largest force is in the other (s).
    pub peak_later: f64,
}

/// An event that one file has and the other has not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unmatched {
    /// Time (s).
    pub time: f64,
    /// What it belongs to.
    pub owner: Owner,
    /// Kind, by its name in result files.
    pub kind: &'static str,
    /// Whether the first file has it.
    pub in_theirs: bool,
}

/// The events of two results up to a time.
#[derive(Debug, Clone, PartialEq)]
pub struct EventComparison {
    /// By owner and kind; rows without events in either are left out.
    pub rows: Vec<EventRow>,
    /// Contacts that both have.
    pub contacts: Vec<ContactPair>,
}

impl EventComparison {
    /// Matches the events of two results up to a time (s).
    ///
    /// # Errors
    /// What reading meets.
    pub fn new(
        theirs: &ResultFile,
        reference: &ResultFile,
        until: f64,
    ) -> Result<EventComparison, Error> {
        let (theirs_events, reference_events) = (theirs.events()?, reference.events()?);
        let rows = rows(&theirs_events, &reference_events, until);
        let contacts = contacts(&theirs.contacts()?, &reference.contacts()?, &rows);
        Ok(EventComparison { rows, contacts })
    }

    /// The first event that only one of them has.
    pub fn first_unmatched(&self) -> Option<Unmatched> {
        let unmatched = self.rows.iter().flat_map(|row| {
            let of = move |time: &f64, in_theirs| {
                let EventRow { owner, kind, .. } = *row;
                Unmatched { time: *time, owner, kind, in_theirs }
            };
            let theirs = row.only_theirs.iter().map(move |time| of(time, true));
            theirs.chain(row.only_reference.iter().map(move |time| of(time, false)))
        });
        unmatched.min_by(|a, b| a.time.total_cmp(&b.time))
    }
}

/// Events up to a time (s), by owner and kind.
fn rows(theirs: &[Event], reference: &[Event], until: f64) -> Vec<EventRow> {
    let likes = digits::events(theirs, reference, until);
    let sorts = theirs.iter().chain(reference).map(|event| (event.owner, event.kind));
    let rows = sorts.collect::<BTreeSet<(Owner, EventKind)>>().into_iter().map(|(owner, kind)| {
        let is = |event: &Event| event.owner == owner && event.kind == kind;
        row(&likes, theirs, reference, until, is, (owner, kind.word()))
    });
    let holds = |row: &EventRow| {
        !(row.pairs.is_empty() && row.only_theirs.is_empty() && row.only_reference.is_empty())
    };
    rows.filter(holds).collect()
}

/// The events of one kind and one owner, told by `is`.
fn row(
    likes: &Likes,
    theirs: &[Event],
    reference: &[Event],
    until: f64,
    is: impl Fn(&Event) -> bool,
    (owner, kind): (Owner, &'static str),
) -> EventRow {
    let times = |events: &[Event], which: &[usize]| -> Vec<f64> {
        which.iter().map(|k| events[*k]).filter(&is).map(|event| event.time).collect()
    };
    let pairs = reference.iter().zip(&likes.of_reference).filter_map(|(event, like)| {
        let other = theirs[(*like)?];
        let counts = is(event) && event.time <= until;
        counts.then_some(Pair {
            time: event.time,
            theirs: other.time,
            faster: other.rate - event.rate,
        })
    });
    EventRow {
        owner,
        kind,
        pairs: pairs.collect(),
        only_theirs: times(theirs, &likes.only_theirs),
        only_reference: times(reference, &likes.only_reference),
    }
}

/// Contacts whose begins were matched.
fn contacts(theirs: &[Contact], reference: &[Contact], rows: &[EventRow]) -> Vec<ContactPair> {
    let find = |contacts: &[Contact], clearance: usize, begin: f64| {
        let is = |contact: &&Contact| contact.clearance == clearance && contact.begin == begin;
        contacts.iter().find(is).copied()
    };
    let begins = rows.iter().filter(|row| row.kind == "contact_begins");
    let pairs = begins.filter_map(|row| Some((row.owner.clearance()?, &row.pairs)));
    let pairs =
        pairs.flat_map(|(clearance, pairs)| pairs.iter().map(move |pair| (clearance, pair)));
    let mut contacts: Vec<ContactPair> = pairs
        .filter_map(|(clearance, pair)| {
            let ours = find(reference, clearance, pair.time)?;
            let other = find(theirs, clearance, pair.theirs)?;
            let ends_later = other.end - ours.end;
            Some(ContactPair {
                clearance,
                begin: ours.begin,
                ends_later: (!ends_later.is_nan()).then_some(ends_later),
                peak_force: other.peak_force / ours.peak_force - 1.0,
                peak_later: other.peak_time - ours.peak_time,
            })
        })
        .collect();
    contacts.sort_by(|a, b| a.begin.total_cmp(&b.begin));
    contacts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn events(times: &[f64]) -> Vec<Event> {
        let kind = EventKind::ContactBegins;
        times
            .iter()
            .map(|time| Event { time: *time, owner: Owner::default(), kind, rate: *time })
            .collect()
    }

    #[test]
    fn pairs_tell_times_and_rates_and_what_is_alone_is_told_beside_them() {
        let rows = rows(&events(&[1.0, 2.01, 2.4]), &events(&[1.0, 2.0, 4.0]), 10.0);
        let [row] = &rows[..] else { panic!("{rows:?}") };
        assert_eq!((row.owner, row.kind), (Owner::Clearance(0), "contact_begins"));
        assert_eq!(row.pairs[1].theirs, 2.01);
        assert!((row.pairs[1].later() - 0.01).abs() < 1e-15);
        assert!((row.pairs[1].faster - 0.01).abs() < 1e-15);
        assert_eq!((&row.only_theirs[..], &row.only_reference[..]), (&[2.4][..], &[4.0][..]));
    }

    #[test]
    fn the_first_event_that_only_one_has_is_found_across_owners() {
        let mut other = events(&[1.0, 4.0]);
        other.push(Event { owner: Owner::Clearance(1), ..other[1] });
        other[2].time = 2.0;
        let comparison =
            EventComparison { rows: rows(&other, &events(&[1.0, 3.0]), 10.0), contacts: vec![] };
        let first = comparison.first_unmatched().unwrap();
        assert_eq!((first.time, first.owner, first.in_theirs), (2.0, Owner::Clearance(1), true));
    }
}
