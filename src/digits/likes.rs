//! Which events of two trajectories are the same.
//!
//! An event of the reference has its like in the nearest of the same kind in the same clearance,
//! but none farther away than half the distance to the reference's next such event on either side,
//! so that no event can be taken for its neighbour, nor than a hundredth of the time looked at.
//! Each has one like at most.

use crate::model::Owner;
use crate::run::{Event, EventKind};

/// Farthest that an event may be from its like, over the time looked at.
const WIDEST: f64 = 0.01;
/// Whether something happens in the last instants is a matter of rounding: so long are these, over
/// the time looked at.
const LAST_INSTANTS: f64 = 1e-9;
/// And in units of the farthest that an event was from its like.
const FARTHEST: f64 = 10.0;

/// Which events of two trajectories are the same, up to a time. Indices are those of the two lists.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Likes {
    /// For each event of the reference its like among theirs, beyond the time looked at too.
    pub of_reference: Vec<Option<usize>>,
    /// Events of the reference up to there that have no like.
    pub only_reference: Vec<usize>,
    /// Events of theirs up to there that are the like of none.
    pub only_theirs: Vec<usize>,
}

/// An event that one of two trajectories has and the other has not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parting {
    /// The event.
    pub event: Event,
    /// Whether it is the reference that has it.
    pub in_reference: bool,
    /// The nearest of its kind in the same clearance that the other has.
    pub nearest: Option<Event>,
}

/// Matches the events of two trajectories, both in the order of time. Only events up to `until` (s)
/// count, but those behind may be likes.
pub fn events(theirs: &[Event], reference: &[Event], until: f64) -> Likes {
    let mut likes = Likes { of_reference: vec![None; reference.len()], ..Likes::default() };
    let mut taken = vec![false; theirs.len()];
    let mut known: Vec<(EventKind, Owner)> = reference.iter().map(sort_of).collect();
    known.sort_unstable();
    known.dedup();
    for sort in known {
        let of_sort = |events: &[Event]| -> Vec<usize> {
            (0..events.len()).filter(|k| sort_of(&events[*k]) == sort).collect()
        };
        let (ours, others) = (of_sort(reference), of_sort(theirs));
        let times = |events: &[Event], which: &[usize]| -> Vec<f64> {
            which.iter().map(|k| events[*k].time).collect()
        };
        let found = one_to_one(&times(theirs, &others), &times(reference, &ours), until);
        for (k, like) in ours.iter().zip(found) {
            likes.of_reference[*k] = like.map(|like| others[like]);
            like.into_iter().for_each(|like| taken[others[like]] = true);
        }
    }
    let farthest = (likes.of_reference.iter().zip(reference))
        .filter_map(|(like, event)| Some((theirs[(*like)?].time - event.time).abs()))
        .fold(0.0, f64::max);
    let margin = (FARTHEST * farthest).max(LAST_INSTANTS * until);
    // what happens in the last instants of one may happen just behind the end of the other
    let counts = |event: &Event, other: &[Event]| {
        let goes_on = other.last().is_some_and(|last| last.time > until);
        event.time <= if goes_on { until } else { until - margin }
    };
    let lone = |k: &usize| likes.of_reference[*k].is_none() && counts(&reference[*k], theirs);
    likes.only_reference = (0..reference.len()).filter(lone).collect();
    let lone = |k: &usize| !taken[*k] && counts(&theirs[*k], reference);
    likes.only_theirs = (0..theirs.len()).filter(lone).collect();
    likes
}

/// For each time of a reference (s) the index of its like among theirs, both lists sorted; `until`
/// is the time looked at.
pub fn one_to_one(theirs: &[f64], reference: &[f64], until: f64) -> Vec<Option<usize>> {
    let mut taken = vec![false; theirs.len()];
    let mut like = |k: usize| {
        let (time, window) = (reference[k], window(reference, k, WIDEST * until));
        let first = theirs.partition_point(|other| *other < time - window);
        let near = (first..theirs.len())
            .take_while(|other| theirs[*other] <= time + window)
            .filter(|other| !taken[*other]);
        let distance = |other: &usize| (theirs[*other] - time).abs();
        let like = near.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        like.into_iter().for_each(|like| taken[like] = true);
        like
    };
    (0..reference.len()).map(&mut like).collect()
}

/// Half the distance to the next time on either side, at most `widest` (s). Events at one time
/// still have a window, in which only their like at that very time fits.
fn window(times: &[f64], k: usize, widest: f64) -> f64 {
    let gap = |a: usize, b: usize| times[b] - times[a];
    let before = if k > 0 { gap(k - 1, k) } else { f64::INFINITY };
    let after = if k + 1 < times.len() { gap(k, k + 1) } else { f64::INFINITY };
    (0.5 * before.min(after)).min(widest).max(f64::EPSILON * times[k])
}

/// Kind and owner.
fn sort_of(event: &Event) -> (EventKind, Owner) {
    (event.kind, event.owner)
}

impl Likes {
    /// The first event that only one of the two has. The lists are those that were matched.
    pub fn parting(&self, theirs: &[Event], reference: &[Event]) -> Option<Parting> {
        let first = |list: &[Event], which: &[usize]| which.first().map(|k| list[*k]);
        let lone = [
            (first(reference, &self.only_reference), true),
            (first(theirs, &self.only_theirs), false),
        ];
        let lone =
            lone.into_iter().filter_map(|(event, in_reference)| Some((event?, in_reference)));
        let (event, in_reference) = lone.min_by(|(a, _), (b, _)| a.time.total_cmp(&b.time))?;
        let other = if in_reference { theirs } else { reference };
        let same = other.iter().filter(|other| sort_of(other) == sort_of(&event));
        let distance = |other: &&Event| (other.time - event.time).abs();
        let nearest = same.min_by(|a, b| distance(a).total_cmp(&distance(b))).copied();
        Some(Parting { event, in_reference, nearest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::EventKind::{ContactBegins, ContactEnds};

    const END: f64 = 100.0;

    /// Contacts of clearance 0 that begin and end at these times in turn.
    fn contacts(times: &[f64]) -> Vec<Event> {
        let event = |(k, time): (usize, &f64)| {
            let kind = if k % 2 == 0 { ContactBegins } else { ContactEnds };
            Event { time: *time, owner: Owner::default(), kind, rate: 1.0 }
        };
        times.iter().enumerate().map(event).collect()
    }

    fn likes(theirs: &[f64], reference: &[f64]) -> Likes {
        events(&contacts(theirs), &contacts(reference), END)
    }

    #[test]
    fn events_that_moved_a_little_are_matched_in_order() {
        assert_eq!(
            one_to_one(&[1.1, 1.9, 3.2], &[1.0, 2.0, 3.0], END),
            [Some(0), Some(1), Some(2)]
        );
    }

    #[test]
    fn events_that_one_of_them_lacks_shift_no_others() {
        let found = one_to_one(&[1.0, 2.0, 2.4, 3.0, 5.0], &[1.0, 2.0, 3.0, 4.0, 5.0], END);
        assert_eq!(found, [Some(0), Some(1), Some(3), None, Some(4)]);
    }

    #[test]
    fn an_event_farther_away_than_half_the_distance_to_its_neighbour_is_another_one() {
        assert_eq!(one_to_one(&[1.06], &[1.0, 1.1], END), [None, Some(0)]);
    }

    #[test]
    fn an_event_alone_is_not_matched_across_the_run() {
        let (theirs, reference) = (contacts(&[42.0, 43.0]), contacts(&[40.5, 41.5]));
        let likes = events(&theirs, &reference, END);
        assert_eq!(likes.of_reference, [None, None]);
        let parting = likes.parting(&theirs, &reference).unwrap();
        assert_eq!((parting.event.time, parting.in_reference), (40.5, true));
        assert_eq!(parting.nearest.map(|event| event.time), Some(42.0));
    }

    #[test]
    fn a_contact_that_only_one_has_is_where_they_part() {
        let likes = likes(&[10.0, 20.0], &[10.0, 20.0, 50.0, 60.0]);
        assert_eq!((likes.only_reference, likes.only_theirs), (vec![2, 3], vec![]));
    }

    #[test]
    fn contacts_in_another_clearance_are_no_likes() {
        let mut theirs = contacts(&[10.0, 20.0]);
        theirs.iter_mut().for_each(|event| event.owner = Owner::Clearance(1));
        let likes = events(&theirs, &contacts(&[10.0, 20.0]), END);
        assert_eq!((likes.only_reference, likes.only_theirs), (vec![0, 1], vec![0, 1]));
    }

    #[test]
    fn events_behind_the_end_are_left_out_but_match() {
        let (theirs, reference) = (contacts(&[99.99, 100.2]), contacts(&[100.01, 100.3]));
        let likes = events(&theirs, &reference, END);
        assert_eq!(likes.of_reference, [Some(0), Some(1)]);
        let behind = events(&contacts(&[100.2]), &[], END);
        assert!(behind.only_theirs.is_empty());
    }

    #[test]
    fn what_may_happen_just_behind_the_others_end_is_no_difference() {
        // events are up to 0.01 late, so that the last may be behind the end
        let found = likes(&[10.01, 20.0], &[10.0, 20.0, 99.95]);
        assert!(found.only_reference.is_empty(), "{found:?}");
        let found = likes(&[10.01, 20.0], &[10.0, 20.0, 99.8]);
        assert_eq!(found.only_reference, [2]);
    }
}
