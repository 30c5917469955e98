//! Largest values, contacts and energies of a run, for the tables of the page.

use super::run::Run;
use crate::record::Table;

/// A value of largest magnitude, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Largest {
    pub value: f64,
    /// Time (s); NaN where there are no values.
    pub time: f64,
}

impl Largest {
    const NONE: Largest = Largest { value: f64::NAN, time: f64::NAN };

    /// The value of largest magnitude, the first of equals.
    fn of(values: impl IntoIterator<Item = (f64, f64)>) -> Largest {
        let finite = values.into_iter().filter(|(_, value)| value.is_finite());
        finite.fold(Largest::NONE, |largest, (time, value)| match largest {
            Largest { value: before, .. } if before.abs() >= value.abs() => largest,
            _ => Largest { value, time },
        })
    }

    fn or_larger(self, other: Largest) -> Largest {
        Largest::of([(self.time, self.value), (other.time, other.value)])
    }
}

/// How a journal touched its bearing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Touching {
    pub contacts: usize,
    /// Share of the time in contact, from 0 to 1.
    pub share: f64,
    /// Longest contact (s).
    pub longest_contact: f64,
    /// Longest flight (s).
    pub longest_flight: f64,
    /// Largest penetration (m).
    pub penetration: f64,
    /// Largest impact rate (m/s).
    pub impact_rate: f64,
    /// Dissipated in all contacts (J).
    pub dissipated: f64,
}

/// The maxima and the energy balance of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Summary {
    /// Largest force of each joint (N): the true peaks of contacts, and the samples.
    pub forces: Vec<Largest>,
    /// Largest torque of each drive (N m), of the samples.
    pub torques: Vec<Largest>,
    /// Largest angular acceleration of each body (rad/s²), of the samples.
    pub accelerations: Vec<Largest>,
    /// By clearance.
    pub touching: Vec<Touching>,
    /// Energies and works at the end (J), by dataset.
    pub energies: Vec<(&'static str, f64)>,
    /// What the energy balance is off by at most (J).
    pub residual: Largest,
    /// Largest kinetic energy (J).
    pub kinetic: Largest,
}

/// Datasets of the energy balance.
pub(super) const ENERGIES: [(&str, &str); 6] = [
    ("energy_kinetic", "kinetic"),
    ("energy_potential", "potential"),
    ("energy_elastic", "elastic, in contacts"),
    ("energy_dissipated", "dissipated"),
    ("drive_work", "work of the drives"),
    ("load_work", "work of applied forces"),
];

impl Summary {
    /// The summary of a run.
    pub fn of(run: &Run<'_>) -> Summary {
        let last = |name| run.table(name).and_then(|table| table.values.last()).copied();
        let energies = ENERGIES.iter().filter_map(|(name, _)| Some((*name, last(name)?)));
        let one = |name| columns_largest(run, name).first().copied().unwrap_or(Largest::NONE);
        Summary {
            forces: forces(run),
            torques: columns_largest(run, "drive_torque"),
            accelerations: columns_largest(run, "angular_acceleration"),
            touching: (0..run.file.clearances().len()).map(|k| touching(run, k)).collect(),
            energies: energies.collect(),
            residual: one("energy_residual"),
            kinetic: one("energy_kinetic"),
        }
    }
}

fn forces(run: &Run<'_>) -> Vec<Largest> {
    let joints = run.file.joints();
    let tables = run.table("joint_force_x").zip(run.table("joint_force_y"));
    let sampled = |joint: usize| {
        tables.map_or(Largest::NONE, |(x, y)| {
            let magnitude = |(x, y): (f64, f64)| x.hypot(y);
            let values = column(x, joint).zip(column(y, joint)).map(magnitude);
            Largest::of(run.times.iter().copied().zip(values))
        })
    };
    let peaks = |clearance: usize| {
        let own = run.peaks.iter().filter(|peak| peak.clearance == clearance);
        let contacts = run.contacts.iter().filter(|contact| contact.clearance == clearance);
        let contacts = contacts.map(|contact| (contact.peak_time, contact.peak_force));
        Largest::of(own.map(|peak| (peak.time, peak.force)).chain(contacts))
    };
    let largest = |(joint, name): (usize, &String)| {
        let clearance = run.file.clearances().iter().position(|clearance| clearance == name);
        clearance.map_or(Largest::NONE, peaks).or_larger(sampled(joint))
    };
    joints.iter().enumerate().map(largest).collect()
}

/// The largest magnitude of each column of a dataset.
fn columns_largest(run: &Run<'_>, name: &str) -> Vec<Largest> {
    let Some(table) = run.table(name) else {
        return Vec::new();
    };
    let largest = |item| Largest::of(run.times.iter().copied().zip(column(table, item)));
    (0..table.width).map(largest).collect()
}

fn column(table: &Table, item: usize) -> impl Iterator<Item = f64> {
    table.values.iter().skip(item).step_by(table.width.max(1)).copied()
}

fn touching(run: &Run<'_>, clearance: usize) -> Touching {
    let begin = run.times.first().copied().unwrap_or(0.0);
    let end = run.times.last().copied().unwrap_or(0.0);
    let mut spans = Vec::new();
    let mut sum = Touching {
        contacts: 0,
        share: 0.0,
        longest_contact: 0.0,
        longest_flight: 0.0,
        penetration: 0.0,
        impact_rate: 0.0,
        dissipated: 0.0,
    };
    for contact in run.contacts.iter().filter(|contact| contact.clearance == clearance) {
        sum.contacts += 1;
        sum.penetration = sum.penetration.max(contact.peak_penetration);
        sum.impact_rate = sum.impact_rate.max(contact.impact_rate);
        sum.dissipated += contact.dissipated;
        let until = if contact.end.is_nan() { end } else { contact.end };
        spans.push([contact.begin, until]);
    }
    spans.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let mut free_since = begin;
    for [from, until] in spans {
        sum.share += until - from;
        sum.longest_contact = sum.longest_contact.max(until - from);
        sum.longest_flight = sum.longest_flight.max(from - free_since);
        free_since = free_since.max(until);
    }
    sum.longest_flight = sum.longest_flight.max(end - free_since);
    sum.share /= end - begin;
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_value_is_that_of_largest_magnitude_and_the_first_of_equals() {
        let nan = f64::NAN;
        let largest = Largest::of([(0.0, nan), (1.0, 2.0), (2.0, -3.0), (3.0, 3.0)]);
        assert_eq!(largest, Largest { value: -3.0, time: 2.0 });
        assert!(Largest::of([]).value.is_nan());
        assert_eq!(Largest::NONE.or_larger(largest), largest);
        assert_eq!(largest.or_larger(Largest::NONE), largest);
    }
}
