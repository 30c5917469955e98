//! Which events of the truth a run has, and where the two part.

use crate::run::{Event, Trajectory};

/// What a run has of an event of the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Time of the run's event less that of the reference (s); `None` if the run has none.
    pub late: Option<f64>,
}

/// The first event that one of the two has and the other has not, or has elsewhere in the order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parting {
    /// The reference's event there; `None` if it has no more.
    pub reference: Option<Event>,
    /// The run's event there.
    pub run: Option<Event>,
}

impl Parting {
    /// Time of the parting (s).
    pub fn time(&self) -> f64 {
        let time = |event: &Option<Event>| event.map_or(f64::INFINITY, |event| event.time);
        time(&self.reference).min(time(&self.run))
    }
}

/// Matches each event of the reference with the run's nearest of the same kind and clearance,
/// if that is nearer than half the way to the reference's own next one.
pub fn events(run: &Trajectory, reference: &Trajectory) -> (Vec<Match>, Option<Parting>) {
    let end = reference.samples.last().map_or(0.0, |sample| sample.time);
    let theirs: Vec<Event> = run.events.iter().copied().filter(|e| e.time <= end).collect();
    let matches = reference.events.iter().enumerate().map(|(place, event)| {
        let same = |other: &&Event| other.clearance == event.clearance && other.kind == event.kind;
        let nearest = |events: &mut dyn Iterator<Item = &Event>| {
            let distances = events.filter(same).map(|other| other.time - event.time);
            distances.min_by(|a, b| a.abs().total_cmp(&b.abs()))
        };
        let others = reference.events[..place].iter().rev().take(200);
        let mut others = others.chain(reference.events[place + 1..].iter().take(200));
        let next = nearest(&mut others).map_or(f64::INFINITY, f64::abs);
        let from = theirs.partition_point(|other| other.time < event.time - next);
        let near = theirs[from..].iter().take_while(|other| other.time <= event.time + next);
        let late = nearest(&mut near.into_iter()).filter(|late| late.abs() < next / 2.0);
        Match { late }
    });
    (matches.collect(), parting(&theirs, &reference.events, end))
}

fn parting(run: &[Event], reference: &[Event], end: f64) -> Option<Parting> {
    let same = |a: &Event, b: &Event| a.clearance == b.clearance && a.kind == b.kind;
    let together = run.iter().zip(reference).take_while(|(a, b)| same(a, b)).count();
    let found =
        Parting { reference: reference.get(together).copied(), run: run.get(together).copied() };
    let some = found.reference.is_some() || found.run.is_some();
    // one event more or less in the last instants is a matter of rounding
    (some && found.time() < end * (1.0 - 1e-9)).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::Observation;
    use crate::run::EventKind::{ContactBegins, ContactEnds};

    fn trajectory(times: &[f64]) -> Trajectory {
        let events = times.iter().enumerate().map(|(k, time)| Event {
            time: *time,
            clearance: 0,
            kind: if k % 2 == 0 { ContactBegins } else { ContactEnds },
            rate: 1.0,
        });
        let sample = Observation { time: 10.0, ..Observation::default() };
        Trajectory { events: events.collect(), samples: vec![sample], ..Trajectory::default() }
    }

    #[test]
    fn a_late_event_is_told_by_how_much() {
        let (matches, parting) = events(&trajectory(&[1.0, 2.25]), &trajectory(&[1.0, 2.0]));
        assert_eq!(matches, [Match { late: Some(0.0) }, Match { late: Some(0.25) }]);
        assert_eq!(parting, None);
    }

    #[test]
    fn a_contact_that_only_the_truth_has_is_where_they_part() {
        let (matches, parting) =
            events(&trajectory(&[1.0, 2.0]), &trajectory(&[1.0, 2.0, 5.0, 6.0]));
        assert_eq!(matches[2..], [Match { late: None }, Match { late: None }]);
        assert_eq!(parting.map(|parting| parting.time()), Some(5.0));
    }
}
