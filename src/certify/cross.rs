//! Two engines as each other's check.
//!
//! The same case, followed by the other engine in doubles at the same tolerance, must have the same
//! contacts for as long as the two agree to three digits. Whether a contact begins is decided by
//! what the two differ by: if that is d, in units of the clearance c, neither knows of a contact
//! less deep than some d c, nor of a flight less high, nor when a contact begins to better than
//! d c over its rate. What is beyond that, by a hundred times to be safe, is an error of one of
//! them.

use crate::case::{Case, EngineName, Precision};
use crate::digits::{self, Likes, Scales, Sizes, digits};
use crate::mechanism::Mechanism;
use crate::model::Owner;
use crate::run::{Contact, Event, EventKind, Trajectory, Watcher};
use crate::simulate::{self, Simulation, assemble};
use std::convert::Infallible;
use std::fmt;

/// Digits that the two must have in common for their events to be compared.
const LEAST_DIGITS: f64 = 3.0;
/// By how much a difference may grow from one event or sample to the next.
const SAFETY: f64 = 100.0;
/// Difference to start from, in units of the tolerance, and at least.
const FIRST: [f64; 2] = [1e3, 1e-12];

/// What two engines make of the same case.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossCheck {
    /// Engine of the run, and the other.
    pub engines: [EngineName; 2],
    /// Time (s) up to which events were compared.
    pub until: f64,
    /// Digits in common at the last sample before.
    pub digits: f64,
    /// Begins and ends of contacts that both have up to there.
    pub events: usize,
    /// Largest difference of their times (s).
    pub farthest: f64,
    /// The first contact that only one has, or that they have at different times.
    pub disagreement: Option<Disagreement>,
    /// Why the other engine stopped before the end, if it did.
    pub stopped: Option<String>,
}

impl CrossCheck {
    /// Whether the other engine came to the end, and has no other contacts.
    pub fn confirms(&self) -> bool {
        self.disagreement.is_none() && self.stopped.is_none()
    }
}

/// A contact on which two engines do not agree although they have digits in common.
#[derive(Debug, Clone, PartialEq)]
pub struct Disagreement {
    /// Name of the clearance.
    pub clearance: String,
    /// The event in the run.
    pub run: Option<Event>,
    /// The event in the trajectory of the other engine.
    pub other: Option<Event>,
    /// The engines.
    pub engines: [EngineName; 2],
    /// Digits that the two had in common before.
    pub digits: f64,
}

/// Follows a case with its own engine and with the other, and compares their contacts.
///
/// # Errors
/// The engine of the case stops; see [`simulate::Error`].
pub fn cross_check(
    case: &Case,
    watch: Watcher<'_>,
) -> Result<CrossCheck, simulate::Error<Infallible>> {
    let mut run = Trajectory::default();
    let simulation = Simulation::new(case).map_err(|source| failed(case, source))?;
    simulation.run(&mut run, watch).1?;
    check_run(case, &run, watch)
}

/// Follows a case with the engine that it does not name, and compares contacts with those of a run
/// of its own.
///
/// # Errors
/// The case cannot be assembled, or whoever watches asks to stop; that the other engine stops is
/// none.
pub fn check_run(
    case: &Case,
    run: &Trajectory,
    watch: Watcher<'_>,
) -> Result<CrossCheck, simulate::Error<Infallible>> {
    let mut followed = case.clone();
    let solver = &mut followed.plan.solver;
    let engines = match solver.engine {
        EngineName::Ida => [EngineName::Ida, EngineName::Explicit],
        EngineName::Explicit => [EngineName::Explicit, EngineName::Ida],
    };
    (solver.engine, solver.precision) = (engines[1], Precision::Double);
    let mechanism: Mechanism<f64> = assemble(case).map_err(|source| failed(case, source))?;
    let simulation = Simulation::new(&followed).map_err(|source| failed(case, source))?;
    let times = run.samples.iter().map(|sample| sample.time).collect();
    let mut other = Trajectory::default();
    let stopped = match simulation.sampled_at(times).run(&mut other, watch).1 {
        Ok(()) => None,
        Err(error @ simulate::Error::Interrupted { .. }) => return Err(error),
        Err(error) => Some(super::chain(&error)),
    };
    let names = &mechanism.model().names().clearances;
    let sizes = Sizes::of(&mechanism);
    let first = (FIRST[0] * case.plan.solver.relative_tolerance).max(FIRST[1]);
    let pair = Pair { run: &contacts_of(run), other: &contacts_of(&other), sizes: &sizes };
    Ok(CrossCheck { stopped, ..pair.compare(engines, names, first) })
}

fn failed(case: &Case, source: crate::case::Error) -> simulate::Error<Infallible> {
    simulate::Error::Failed { case: case.name.clone(), source: Box::new(source) }
}

/// A trajectory with no events but begins and ends of contacts.
fn contacts_of(trajectory: &Trajectory) -> Trajectory {
    let is =
        |event: &&Event| matches!(event.kind, EventKind::ContactBegins | EventKind::ContactEnds);
    let events = trajectory.events.iter().filter(is).copied().collect();
    Trajectory { events, ..trajectory.clone() }
}

/// Two trajectories with the same sample times, as far as both go.
struct Pair<'a> {
    run: &'a Trajectory,
    other: &'a Trajectory,
    sizes: &'a Sizes,
}

impl Pair<'_> {
    fn compare(&self, engines: [EngineName; 2], names: &[String], first: f64) -> CrossCheck {
        let scales = Scales::of(&self.run.samples, self.sizes);
        let samples = self.run.samples.iter().zip(&self.other.samples);
        let differences: Vec<(f64, f64)> =
            samples.map(|(run, other)| (run.time, scales.differences(run, other).state)).collect();
        let most = 10f64.powf(-LEAST_DIGITS);
        let apart = differences.iter().position(|(_, difference)| !(*difference <= most));
        // what made them part lies before the first sample that shows it
        let last = apart.or(differences.len().checked_sub(1));
        let until = last.map_or(0.0, |k| differences[k].0);
        let likes = digits::events(&self.other.events, &self.run.events, until);
        let mut check = CrossCheck {
            engines,
            until,
            digits: digits(first),
            events: 0,
            farthest: 0.0,
            disagreement: None,
            stopped: None,
        };
        let mut difference = first;
        let mut samples = differences.iter().take(last.map_or(0, |k| k + 1)).peekable();
        for found in self.in_order(&likes, until) {
            while let Some((_, seen)) = samples.next_if(|(time, _)| *time <= found.time()) {
                difference = difference.max(*seen);
            }
            check.digits = digits(difference);
            let off = self.off(&found);
            if off > SAFETY * difference {
                check.disagreement = Some(Disagreement {
                    clearance: names.get(found.clearance()).cloned().unwrap_or_default(),
                    run: found.run,
                    other: found.other,
                    engines,
                    digits: check.digits,
                });
                break;
            }
            difference = difference.max(off);
            if let (Some(run), Some(other)) = (found.run, found.other) {
                check.events += 1;
                check.farthest = check.farthest.max((run.time - other.time).abs());
            }
        }
        check
    }

    /// Events up to a time (s), each with its like, in the order of time.
    fn in_order(&self, likes: &Likes, until: f64) -> Vec<Found> {
        let matched = self.run.events.iter().zip(&likes.of_reference).filter_map(|(run, like)| {
            Some(Found { run: Some(*run), other: Some(self.other.events[(*like)?]) })
        });
        let run = likes.only_reference.iter();
        let run = run.map(|k| Found { run: Some(self.run.events[*k]), other: None });
        let other = likes.only_theirs.iter();
        let other = other.map(|k| Found { run: None, other: Some(self.other.events[*k]) });
        let mut found: Vec<Found> = matched.chain(run).chain(other).collect();
        found.retain(|found| found.time() <= until);
        found.sort_by(|a, b| a.time().total_cmp(&b.time()));
        found
    }

    /// What two trajectories that have or lack these events differ by at least, over the clearance.
    fn off(&self, found: &Found) -> f64 {
        let radial = self.sizes.clearances.get(found.clearance()).copied().unwrap_or(1.0);
        let off = match (&found.run, &found.other) {
            (Some(run), Some(other)) => {
                (run.time - other.time).abs() * run.rate.abs().min(other.rate.abs())
            }
            (Some(event), None) => weight(event, self.run),
            (None, Some(event)) => weight(event, self.other),
            (None, None) => 0.0,
        };
        off / radial
    }
}

/// An event in either or both of two trajectories.
#[derive(Debug, Clone, Copy)]
struct Found {
    run: Option<Event>,
    other: Option<Event>,
}

impl Found {
    fn any(&self) -> impl Iterator<Item = &Event> {
        self.run.iter().chain(&self.other)
    }

    /// Time of the earlier (s).
    fn time(&self) -> f64 {
        self.any().map(|event| event.time).fold(f64::INFINITY, f64::min)
    }

    fn clearance(&self) -> usize {
        self.any().next().map_or(0, |event| event.owner.index())
    }
}

/// How far (m) a trajectory would have to be moved at least for it not to have this event: the
/// depth of its contact, or the height of the flight on its other side, whichever is less.
fn weight(event: &Event, of: &Trajectory) -> f64 {
    let begins = event.kind == EventKind::ContactBegins;
    let same =
        of.contacts.iter().filter(|contact| Owner::Clearance(contact.clearance) == event.owner);
    let edge = |contact: &Contact| if begins { contact.begin } else { contact.end };
    let depth = same.clone().find(|contact| edge(contact) == event.time);
    let depth = depth.map_or(f64::INFINITY, |contact| contact.peak_penetration);
    let flight = match begins {
        true => same.map(|c| event.time - c.end).filter(|dt| *dt >= 0.0).reduce(f64::min),
        false => same.map(|c| c.begin - event.time).filter(|dt| *dt >= 0.0).reduce(f64::min),
    };
    // thrown up at this rate and caught after that time
    let height = flight.map_or(f64::INFINITY, |dt| 0.25 * event.rate.abs() * dt);
    depth.min(height)
}

/// Name of an engine as a case file has it.
fn name(engine: EngineName) -> &'static str {
    EngineName::ALL.iter().find(|(_, known)| *known == engine).map_or("", |(name, _)| *name)
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told = |event: &Option<Event>| match event {
            Some(Event { time, kind: EventKind::ContactEnds, .. }) => {
                format!("a contact of {} ends at {time:e} s", self.clearance)
            }
            Some(Event { time, .. }) => {
                format!("a contact of {} begins at {time:e} s", self.clearance)
            }
            None => "there is none like it".to_owned(),
        };
        let mut sides = [(self.engines[0], &self.run), (self.engines[1], &self.other)];
        if self.run.is_none() {
            sides.swap(0, 1);
        }
        let [(first, has), (second, lacks)] = sides;
        write!(
            f,
            "by the {} engine {}, by the {} engine {}; until then the two agree to {:.1} digits",
            name(first),
            told(has),
            name(second),
            told(lacks),
            self.digits
        )
    }
}

impl fmt::Display for CrossCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [run, other] = self.engines.map(name);
        write!(
            f,
            "{run} and {other} have the same {} begins and ends of contacts until {:.3} ms, off by \
             {:.1e} s at most",
            self.events,
            self.until * 1e3,
            self.farthest
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{ClearanceObservation, Observation};
    use crate::run::EventKind::{ContactBegins, ContactEnds};

    const ENGINES: [EngineName; 2] = [EngineName::Ida, EngineName::Explicit];
    const C: f64 = 1e-3;

    /// Contacts 1 µm deep that begin and end at these times at 0.1 m/s; samples every second from 0
    /// to 10, whose clearance vector is `off` times the clearance at each.
    fn trajectory(contacts: &[[f64; 2]], off: impl Fn(f64) -> f64) -> Trajectory {
        let event = |time, kind, rate| Event { time, owner: Owner::default(), kind, rate };
        let events = contacts.iter().flat_map(|[begin, end]| {
            [event(*begin, ContactBegins, 0.1), event(*end, ContactEnds, -0.1)]
        });
        let contact = |[begin, end]: &[f64; 2]| Contact {
            clearance: 0,
            begin: *begin,
            end: *end,
            impact_rate: 0.1,
            peak_penetration: 1e-6,
            peak_penetration_time: 0.0,
            peak_force: 1.0,
            peak_time: 0.5 * (begin + end),
            dissipated: 0.0,
        };
        let sample = |k: u32| {
            let time = f64::from(k);
            let clearance =
                ClearanceObservation { offset: [C * off(time), 0.0], ..Default::default() };
            Observation { time, clearances: vec![clearance], ..Observation::default() }
        };
        Trajectory {
            samples: (0..=10).map(sample).collect(),
            events: events.collect(),
            contacts: contacts.iter().map(contact).collect(),
            peaks: Vec::new(),
            revolutions: Vec::new(),
        }
    }

    fn compared(run: &Trajectory, other: &Trajectory) -> CrossCheck {
        let sizes = Sizes { mass: 1.0, length: 0.1, rate: 1.0, clearances: vec![C] };
        let pair = Pair { run, other, sizes: &sizes };
        pair.compare(ENGINES, &["A".to_owned()], 1e-9)
    }

    const THREE: [[f64; 2]; 3] = [[1.5, 1.6], [4.5, 4.6], [7.5, 7.6]];

    #[test]
    fn the_same_contacts_are_confirmed() {
        let late = THREE.map(|contact| contact.map(|time| time + 1e-11));
        let check = compared(&trajectory(&THREE, |_| 0.0), &trajectory(&late, |_| 1e-10));
        assert_eq!((check.disagreement, check.events, check.until), (None, 6, 10.0));
        assert!((check.farthest - 1e-11).abs() < 1e-14 && check.digits > 8.9);
    }

    #[test]
    fn a_contact_that_one_engine_lacks_is_an_error_of_one_of_them() {
        let lacking = trajectory(&[THREE[0], THREE[2]], |time| if time > 4.6 { 0.5 } else { 0.0 });
        let run = trajectory(&THREE, |_| 0.0);
        let found = compared(&run, &lacking).disagreement.unwrap();
        assert_eq!((found.run.map(|event| event.time), found.other), (Some(4.5), None));
        assert!((found.digits - 9.0).abs() < 0.01);
        let told = found.to_string();
        assert!(told.contains("by the ida engine a contact of A begins at 4.5e0 s"), "{told}");
        let found = compared(&lacking, &run).disagreement.unwrap();
        assert_eq!((found.run, found.other.map(|event| event.time)), (None, Some(4.5)));
        let told = found.to_string();
        assert!(told.starts_with("by the explicit engine a contact of A begins"), "{told}");
    }

    #[test]
    fn a_contact_far_later_than_digits_allow_is_another_one() {
        let mut late = THREE;
        late[1] = [4.52, 4.62];
        let found = compared(&trajectory(&THREE, |_| 0.0), &trajectory(&late, |_| 0.0));
        let found = found.disagreement.unwrap();
        assert_eq!(found.run.map(|event| event.time), Some(4.5));
        assert_eq!(found.other.map(|event| event.time), Some(4.52));
    }

    #[test]
    fn a_graze_that_the_digits_do_not_decide_is_no_error() {
        // 1 µm is a thousandth of the clearance; the two differ by a ten-thousandth before it
        let lacking = trajectory(&[THREE[0], THREE[2]], |_| 1e-4);
        let check = compared(&trajectory(&THREE, |_| 0.0), &lacking);
        assert_eq!(check.disagreement, None);
        assert_eq!(check.events, 4);
    }

    #[test]
    fn what_comes_after_the_last_common_digits_is_not_compared() {
        let other = trajectory(&[THREE[0]], |time| 1e-9 * 100f64.powf(time));
        let check = compared(&trajectory(&THREE, |_| 0.0), &other);
        assert_eq!((check.disagreement, check.until, check.events), (None, 4.0, 2));
    }
}
