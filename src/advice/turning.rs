//! The ideal mechanism through one revolution of each drive: whether it goes round, and where it
//! locks.

use crate::case::{self, Case};
use crate::course::Course;
use crate::dae::Fault;
use crate::mechanism::Mechanism;
use crate::run::{Assembled, Undecided};
use crate::simulate::{assemble, ideal_case};
use std::f64::consts::TAU;

/// Bodies that are looked at in all places together, at most: it takes a second or so.
const MOST_LOOKS: f64 = 400_000.0;
/// Halvings by which the place where it locks is found.
const HALVINGS: usize = 40;

/// What becomes of the ideal mechanism when its drives turn.
#[derive(Debug, Clone, PartialEq)]
pub enum Turn {
    /// It goes round.
    Whole {
        /// Time of a revolution of the slowest drive (s), or what was looked at of it.
        span: f64,
        /// The largest force in each joint (N).
        forces: Vec<(String, f64)>,
    },
    /// It locks.
    Locks {
        /// When (s).
        time: f64,
        /// Names of the drives and their angles then (rad), less whole turns.
        drives: Vec<(String, f64)>,
        /// What holds it.
        why: String,
        /// The largest force in each joint until then (N).
        forces: Vec<(String, f64)>,
    },
    /// It has freedoms that the drives do not prescribe.
    Free {
        /// How many.
        freedoms: usize,
    },
    /// No drive turns.
    Still,
    /// Without its clearances it does not go together.
    NotAssembled {
        /// Why.
        why: String,
    },
}

impl Turn {
    /// The largest force (N) in a joint, as far as it is known.
    pub fn force_in(&self, joint: &str) -> Option<f64> {
        match self {
            Turn::Whole { forces, .. } | Turn::Locks { forces, .. } => {
                forces.iter().find(|(name, _)| name == joint).map(|(_, force)| *force)
            }
            _ => None,
        }
    }
}

/// Turns the ideal mechanism of a case.
pub fn turn(case: &Case) -> Turn {
    let courses = case.description.drives.iter().filter_map(|drive| Course::<f64>::of(&drive.part));
    let once = courses.filter_map(|course| course.all()).fold(0.0, f64::max);
    if once == 0.0 {
        return Turn::Still;
    }
    let mechanism = ideal_case(case).and_then(|ideal| assemble::<f64>(&ideal));
    let mechanism = match mechanism {
        Ok(mechanism) => mechanism,
        Err(error) => return Turn::NotAssembled { why: complaints(&error) },
    };
    let freedoms = mechanism.freedoms();
    match Assembled::new(mechanism) {
        Some(assembled) => walk(assembled, once),
        None => Turn::Free { freedoms },
    }
}

/// Complaints about a mechanism in one line.
fn complaints(error: &case::Error) -> String {
    match error {
        case::Error::NotAMechanism { complaints, .. } => {
            complaints.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
        }
        other => other.to_string(),
    }
}

/// Goes through a span (s) in strides, and takes note of the largest forces.
fn walk(mut assembled: Assembled<f64>, span: f64) -> Turn {
    let bodies = assembled.mechanism().model().names().bodies.len();
    let most = (MOST_LOOKS / bodies as f64).max(2.0);
    let strides = (span / assembled.stride()).ceil().clamp(2.0, most);
    let stride = assembled.stride().min(span / strides);
    let names = assembled.mechanism().model().names().joints.clone();
    let mut forces: Vec<(String, f64)> = names.into_iter().map(|name| (name, 0.0)).collect();
    for k in 0..=strides as u64 {
        let before = assembled.clone();
        match assembled.observe(stride * k as f64) {
            Ok(seen) => {
                for ((_, largest), joint) in forces.iter_mut().zip(&seen.joints) {
                    *largest = largest.max(joint.force[0].hypot(joint.force[1]));
                }
            }
            Err(fault) => {
                let from = stride * k.saturating_sub(1) as f64;
                return locked(before, [from, stride * k as f64], fault, forces);
            }
        }
    }
    Turn::Whole { span: stride * strides, forces }
}

/// Finds between two times (s) the last that a mechanism, which stands at the first, can reach.
fn locked(
    mut at: Assembled<f64>,
    [mut from, mut to]: [f64; 2],
    fault: Fault,
    forces: Vec<(String, f64)>,
) -> Turn {
    let stands = match &fault {
        Fault::Fatal(error) => error.downcast_ref::<Undecided>().map(|undecided| undecided.time),
        Fault::TryShorterStep(_) => None,
    };
    // where it got no further after thousands of parts, halving would take them again and again
    let halvings = if stands.is_some() { 0 } else { HALVINGS };
    from = stands.unwrap_or(from);
    for _ in 0..halvings {
        let middle = 0.5 * (from + to);
        let mut next = at.clone();
        match next.observe(middle) {
            Ok(_) => (at, from) = (next, middle),
            Err(_) => to = middle,
        }
    }
    let mechanism: &Mechanism<f64> = at.mechanism();
    let model = mechanism.model();
    let drives = model.names().drives.iter().zip(model.drives());
    let drives =
        drives.map(|(name, drive)| (name.clone(), drive.course.at(from)[0].rem_euclid(TAU)));
    Turn::Locks { time: from, drives: drives.collect(), why: reason(&fault), forces }
}

fn reason(fault: &Fault) -> String {
    let told = fault.to_string();
    // the message names the time of a stride, which is not that of the lock
    match told.split_once(" at t = ") {
        Some((what, _)) => what.to_owned(),
        None => told,
    }
}
