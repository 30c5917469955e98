//! What a case makes a careful reader ask: whether its mechanism can turn, whether a unit has
//! slipped, whether its samples can see what happens. Notes, not errors: every one of them may be
//! meant.

mod contact;
mod slips;
mod turning;

pub use contact::{Touch, touches};
pub use turning::{Turn, turn};

use crate::case::{Case, Sampling};
use crate::mechanism::Mechanism;

/// A note on a key of a case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// The key, dotted.
    pub key: String,
    /// What is to be thought of.
    pub text: String,
}

impl Note {
    fn new(key: impl Into<String>, text: impl Into<String>) -> Self {
        Note { key: key.into(), text: text.into() }
    }
}

/// Samples that a contact should have for its forces to be seen in them.
const SAMPLES_OF_A_CONTACT: f64 = 5.0;

/// All notes on a case whose mechanism is assembled.
pub fn notes(case: &Case, mechanism: &Mechanism<f64>, turn: &Turn, touches: &[Touch]) -> Vec<Note> {
    let mut notes = slips::notes(case);
    notes.extend(lock(case, turn));
    notes.extend(touches.iter().filter_map(|touch| too_soft(mechanism, touch)));
    notes.extend(too_coarse(case, mechanism, touches));
    notes.extend(too_late(case));
    notes
}

fn lock(case: &Case, turn: &Turn) -> Option<Note> {
    match turn {
        Turn::Locks { time, drives, why, .. } => {
            let late =
                if *time > case.plan.duration.to_f64() { ", after the end of the run" } else { "" };
            let angles: Vec<String> = drives
                .iter()
                .map(|(name, angle)| format!("drive {name} at {:.2} deg", angle.to_degrees()))
                .collect();
            let key = format!("drives.{}", drives.first().map_or("", |(name, _)| name));
            let text = format!(
                "the ideal mechanism locks at t = {time:.4e} s{late}, {}: {why}. With clearance \
                 alone it goes on only until its journals are pressed into their bearings",
                angles.join(", ")
            );
            Some(Note::new(key, text))
        }
        Turn::NotAssembled { why } => Some(Note::new(
            "joints",
            format!("without its clearances the mechanism does not go together: {why}"),
        )),
        _ => None,
    }
}

/// A contact that the loads known beforehand press deeper than its law is believed for.
fn too_soft(mechanism: &Mechanism<f64>, touch: &Touch) -> Option<Note> {
    let clearance = &mechanism.model().clearances()[touch.clearance];
    let allowed = clearance.believed_depth();
    let (depth, what) = match touch.pressed {
        Some((force, depth)) if depth > touch.depth => (depth, format!("a force of {force:.3e} N")),
        _ => (touch.depth, format!("an impact at {:.3e} m/s", touch.speed)),
    };
    (depth > allowed).then(|| {
        let names = mechanism.model().names();
        let name = &names.joints[names.loose[touch.clearance]];
        let [inner, outer] = clearance.surfaces();
        let text = format!(
            "{what} presses the {inner} {depth:.3e} m into its {outer}, where the law is believed \
             to {allowed:.3e} m: is K in N/m^n? 1 N/mm^1.5 is 3.162e4 N/m^1.5"
        );
        Note::new(format!("joints.{name}.clearance.normal"), text)
    })
}

/// Windows of samples that the run does not come to.
fn too_late(case: &Case) -> Vec<Note> {
    let end = case.plan.duration.to_f64();
    let windows = case.plan.windows.iter().enumerate();
    let late = windows.filter(|(_, window)| window.from.to_f64() >= end);
    late.map(|(k, window)| {
        let text =
            format!("begins at {} s, the run ends at {end} s: it has no samples", window.from);
        Note::new(format!("run.window.{}", k + 1), text)
    })
    .collect()
}

/// Samples too far apart to see a contact.
fn too_coarse(case: &Case, mechanism: &Mechanism<f64>, touches: &[Touch]) -> Option<Note> {
    let interval = case.plan.sample_interval.to_f64();
    if case.plan.sampling == Sampling::Adaptive {
        return None;
    }
    let shortest = touches.iter().min_by(|a, b| a.duration.total_cmp(&b.duration))?;
    if !(shortest.duration < SAMPLES_OF_A_CONTACT * interval) {
        return None;
    }
    let name = &mechanism.model().names().clearances[shortest.clearance];
    let text = format!(
        "{interval:e} s is too coarse for the contacts of {name}: an impact at {:.2e} m/s lasts \
         about {:.1e} s; {:.0e} s would show it, and so would run.sampling = \"adaptive\". Contacts \
         and peaks are found in any case",
        shortest.speed,
        shortest.duration,
        shortest.duration / (2.0 * SAMPLES_OF_A_CONTACT)
    );
    Some(Note::new("run.sample_interval", text))
}
