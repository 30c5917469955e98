//! Events and contacts, matched one to one.
//!
//! An event of the reference is matched with the nearest of the same kind in the same clearance,
//! but none farther away than half the distance to the reference's next such event on either side:
//! so no event can be taken for its neighbour.

use super::Error;
use crate::record::ResultFile;
use crate::run::{Contact, Event, EventKind};

/// Widest window of a match, over the time compared.
const WIDEST: f64 = 0.05;

/// Kinds of event, with the names they have in result files.
pub const KINDS: [(EventKind, &str); 4] = [
    (EventKind::ContactBegins, "contact_begins"),
    (EventKind::ContactEnds, "contact_ends"),
    (EventKind::FrictionKink, "friction_kink"),
    (EventKind::Tension, "tension_begins_or_ends"),
];

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

/// Events of one kind in one clearance.
#[derive(Debug, Clone, PartialEq)]
pub struct EventRow {
    /// Index of the clearance.
    pub clearance: usize,
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
    /// Index of the clearance.
    pub clearance: usize,
    /// Kind, by its name in result files.
    pub kind: &'static str,
    /// Whether the first file has it.
    pub in_theirs: bool,
}

/// The events of two results up to a time.
#[derive(Debug, Clone, PartialEq)]
pub struct EventComparison {
    /// By clearance and kind; rows without events in either are left out.
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
        let rows = rows(&theirs.events()?, &reference.events()?, theirs.clearances().len(), until);
        let contacts = contacts(&theirs.contacts()?, &reference.contacts()?, &rows);
        Ok(EventComparison { rows, contacts })
    }

    /// The first event that only one of them has.
    pub fn first_unmatched(&self) -> Option<Unmatched> {
        let unmatched = self.rows.iter().flat_map(|row| {
            let of = move |time: &f64, in_theirs| {
                let EventRow { clearance, kind, .. } = *row;
                Unmatched { time: *time, clearance, kind, in_theirs }
            };
            let theirs = row.only_theirs.iter().map(move |time| of(time, true));
            theirs.chain(row.only_reference.iter().map(move |time| of(time, false)))
        });
        unmatched.min_by(|a, b| a.time.total_cmp(&b.time))
    }
}

fn rows(theirs: &[Event], reference: &[Event], clearances: usize, until: f64) -> Vec<EventRow> {
    let mut rows = Vec::new();
    for clearance in 0..clearances {
        for (kind, name) in KINDS {
            let of = |events: &[Event]| -> Vec<Event> {
                let wanted = |e: &&Event| e.clearance == clearance && e.kind == kind;
                events.iter().filter(wanted).copied().collect()
            };
            let (theirs, reference) = (of(theirs), of(reference));
            let row = row(clearance, name, &theirs, &reference, until);
            if !(row.pairs.is_empty()
                && row.only_theirs.is_empty()
                && row.only_reference.is_empty())
            {
                rows.push(row);
            }
        }
    }
    rows
}

/// Matches events of one kind in one clearance.
fn row(
    clearance: usize,
    kind: &'static str,
    theirs: &[Event],
    reference: &[Event],
    until: f64,
) -> EventRow {
    let mut row = EventRow {
        clearance,
        kind,
        pairs: Vec::new(),
        only_theirs: Vec::new(),
        only_reference: Vec::new(),
    };
    let mut taken = vec![false; theirs.len()];
    for (k, event) in reference.iter().enumerate() {
        let window = window(reference, k, WIDEST * until);
        let first = theirs.partition_point(|other| other.time < event.time - window);
        let near = (first..theirs.len())
            .take_while(|other| theirs[*other].time <= event.time + window)
            .filter(|other| !taken[*other]);
        let distance = |other: &usize| (theirs[*other].time - event.time).abs();
        match near.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
            Some(index) => {
                taken[index] = true;
                let Event { time, rate, .. } = theirs[index];
                if event.time <= until {
                    let faster = rate - event.rate;
                    row.pairs.push(Pair { time: event.time, theirs: time, faster });
                }
            }
            None if event.time <= until => row.only_reference.push(event.time),
            None => {}
        }
    }
    let left = theirs.iter().zip(&taken).filter(|(event, taken)| !**taken && event.time <= until);
    row.only_theirs = left.map(|(event, _)| event.time).collect();
    row
}

/// Half the distance to the next event on either side, at most `widest` (s). Events at one time
/// still have a window, in which only their like at that very time fits.
fn window(events: &[Event], k: usize, widest: f64) -> f64 {
    let gap = |a: usize, b: usize| events[b].time - events[a].time;
    let before = if k > 0 { gap(k - 1, k) } else { f64::INFINITY };
    let after = if k + 1 < events.len() { gap(k, k + 1) } else { f64::INFINITY };
    (0.5 * before.min(after)).min(widest).max(f64::EPSILON * events[k].time)
}

/// Contacts whose begins were matched.
fn contacts(theirs: &[Contact], reference: &[Contact], rows: &[EventRow]) -> Vec<ContactPair> {
    let find = |contacts: &[Contact], clearance: usize, begin: f64| {
        let is = |contact: &&Contact| contact.clearance == clearance && contact.begin == begin;
        contacts.iter().find(is).copied()
    };
    let begins = rows.iter().filter(|row| row.kind == "contact_begins");
    let pairs = begins.flat_map(|row| row.pairs.iter().map(move |pair| (row.clearance, pair)));
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
        times.iter().map(|time| Event { time: *time, clearance: 0, kind, rate: *time }).collect()
    }

    fn row_of(theirs: &[f64], reference: &[f64]) -> EventRow {
        row(0, "contact_begins", &events(theirs), &events(reference), 10.0)
    }

    fn pairs(row: &EventRow) -> Vec<(f64, f64)> {
        row.pairs.iter().map(|pair| (pair.time, pair.theirs)).collect()
    }

    #[test]
    fn events_that_moved_a_little_are_matched_in_order() {
        let row = row_of(&[1.1, 1.9, 3.2], &[1.0, 2.0, 3.0]);
        assert_eq!(pairs(&row), [(1.0, 1.1), (2.0, 1.9), (3.0, 3.2)]);
        assert!(row.only_theirs.is_empty() && row.only_reference.is_empty());
        assert!((row.pairs[0].faster - 0.1).abs() < 1e-15);
    }

    #[test]
    fn events_that_one_of_them_lacks_are_told_and_shift_no_others() {
        let row = row_of(&[1.0, 2.0, 2.4, 3.0, 5.0], &[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(pairs(&row), [(1.0, 1.0), (2.0, 2.0), (3.0, 3.0), (5.0, 5.0)]);
        assert_eq!((row.only_theirs, row.only_reference), (vec![2.4], vec![4.0]));
    }

    #[test]
    fn an_event_farther_away_than_half_the_distance_to_its_neighbour_is_another_one() {
        let row = row_of(&[1.06], &[1.0, 1.1]);
        assert_eq!(pairs(&row), [(1.1, 1.06)]);
        assert_eq!(row.only_reference, [1.0]);
    }

    #[test]
    fn an_event_alone_is_not_matched_across_the_whole_run() {
        let row = row_of(&[9.0], &[1.0]);
        assert_eq!((row.only_theirs, row.only_reference), (vec![9.0], vec![1.0]));
    }

    #[test]
    fn events_behind_the_end_are_left_out_but_match() {
        // the reference has its last event just behind the end, the other just before
        let row = row_of(&[9.99, 12.0], &[10.01]);
        assert!(row.pairs.is_empty() && row.only_theirs.is_empty());
    }

    #[test]
    fn the_first_event_that_only_one_has_is_found_across_clearances() {
        let mut other = events(&[1.0, 4.0]);
        other.push(Event { clearance: 1, ..other[1] });
        other[2].time = 2.0;
        let comparison =
            EventComparison { rows: rows(&other, &events(&[1.0, 3.0]), 2, 10.0), contacts: vec![] };
        let first = comparison.first_unmatched().unwrap();
        assert_eq!((first.time, first.clearance, first.in_theirs), (2.0, 1, true));
    }
}
