//! A summary as tables for people.

use super::{
    At, Basis, Contacts, EnergyBalance, Extreme, Extremes, Quantity, Reference, Revolutions,
    Stretch, Summary, Tally,
};
use crate::certify::{ONE_DRAW, ms};
use crate::model::one_line;
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, LineStyle, Table};
use std::fmt;

/// Revolutions that are shown at most: the first and the last half of these.
const MOST_REVOLUTIONS: usize = 24;

/// How a number is known that lies where the run has no digits left.
const BEYOND: &str = "beyond the horizon";

/// What marks such a number, and a revolution that has some.
const MARK: &str = " *";

/// What stands where there is no number.
const NONE: &str = "–";

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.heading(f)?;
        if self.samples == 0 {
            return writeln!(f, "\nThe file has no samples.");
        }
        section(f, "Joint forces, largest", self.forces())?;
        section(f, "Torques and accelerations", self.signed())?;
        if let Some(turning) = &self.turning {
            let what = if self.has_ratios() { ", ratios" } else { "" };
            let parts = turning.revolutions;
            section(f, &format!("By revolution: forces{what}"), self.forces_in(parts))?;
            let title = format!("By revolution: torques and accelerations{what}");
            section(f, &title, self.signed_in(parts))?;
        }
        if !self.contacts.is_empty() {
            section(f, "Joints with clearance", self.clearances())?;
        }
        if let Some(energy) = &self.energy {
            section(f, "Energy balance since the start", energy_table(energy))?;
        }
        self.notes(f)
    }
}

impl Summary {
    fn heading(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let colon = if self.title.is_empty() { "" } else { ": " };
        let (name, title) = (one_line(&self.case_name), one_line(&self.title));
        writeln!(f, "{}  {name}{colon}{title}", self.path.display())?;
        let (status, end) = (one_line(&self.status), figures(self.end * 1e3, 6));
        write!(f, "{status}, {end} ms, {} samples", self.samples)?;
        if let Some(turning) = &self.turning {
            let parts = turning.revolutions;
            let turns = figures(self.end / parts.period(), 4);
            let period = figures(parts.period() * 1e3, 6);
            write!(f, ", {turns} revolutions of drive {} of {period} ms", turning.drive)?;
        }
        writeln!(f)?;
        match &self.reference {
            Ok(Reference::Ideal(_)) => {
                writeln!(f, "ratios to the ideal mechanism, made from the case in the file")
            }
            Ok(Reference::Itself) => writeln!(f, "ideal: no joint has clearance"),
            Ok(Reference::File { path, case_name, .. }) => {
                writeln!(f, "ratios to {} in {}", one_line(case_name), path.display())
            }
            Err(_) => writeln!(f, "no ratios: there is no ideal run"),
        }?;
        match &self.horizon {
            Some(horizon) => writeln!(f, "{}", horizon.holds()),
            None if self.contacts.is_empty() => Ok(()),
            None => writeln!(
                f,
                "how far this run is true is not known: its errors were not followed; `freeplay \
                 run` does that, `freeplay certify` knows for certain"
            ),
        }
    }

    /// Whether ratios are worth showing: those of a run to itself are not.
    fn has_ratios(&self) -> bool {
        matches!(self.reference, Ok(Reference::Ideal(_) | Reference::File { .. }))
    }

    /// The quantities of one kind; those that are zero throughout are left out.
    fn of_kind(&self, signed: bool) -> Vec<(Quantity, &Tally)> {
        let all = self.run.quantities.iter().map(|(quantity, tally)| (*quantity, tally));
        let moves = |tally: &Tally| tally.total.magnitude().is_some_and(|largest| largest > 0.0);
        all.filter(|(quantity, tally)| quantity.is_signed() == signed && (!signed || moves(tally)))
            .collect()
    }

    fn forces(&self) -> Table {
        let mut rows = Vec::new();
        for (quantity, tally) in self.of_kind(false) {
            let Quantity::JointForce(joint) = quantity else { continue };
            let names = &self.run.names;
            let name = &names.joints[joint];
            let loose = names.clearances.iter().any(|clearance| names.joint_of(clearance) == name);
            let kind = if loose { "clearance" } else { "ideal" };
            let reference = self.reference_of(quantity).and_then(|extremes| extremes.largest);
            let [ratio, _] = self.ratios(quantity, &tally.total);
            let mut row = vec![name.clone(), kind.to_owned()];
            row.extend(self.told(tally.total.largest, reference, ratio));
            rows.push(row);
        }
        table(self.heads(&["joint", "kind"], "force (N)", " (N)"), rows, 2)
    }

    fn signed(&self) -> Table {
        let mut rows = Vec::new();
        let friction = |clearance| {
            let its = |of: &Quantity| *of == Quantity::TangentialForce(clearance);
            let found = self.run.quantities.iter().find(|(of, _)| its(of));
            found.is_some_and(|(_, tally)| tally.total.magnitude() > Some(0.0))
        };
        for (quantity, tally) in self.of_kind(true) {
            // without friction the normal force is the joint's force
            if matches!(quantity, Quantity::NormalForce(clearance) if !friction(clearance)) {
                continue;
            }
            let extremes = tally.total;
            let reference = self.reference_of(quantity).unwrap_or_default();
            let ratios = self.ratios(quantity, &extremes);
            for (word, extreme, reference, ratio) in [
                ("largest", extremes.largest, reference.largest, ratios[0]),
                ("smallest", extremes.smallest, reference.smallest, ratios[1]),
            ] {
                let name = quantity.name(&self.run.names);
                let mut row = vec![name, quantity.unit().to_owned(), word.to_owned()];
                row.extend(self.told(extreme, reference, ratio));
                rows.push(row);
            }
        }
        table(self.heads(&["column", "unit", "extreme"], "value", ""), rows, 3)
    }

    /// Heads of the columns that [`Summary::told`] fills, after those given.
    fn heads(&self, first: &[&str], value: &str, unit: &str) -> Vec<String> {
        let mut heads: Vec<String> = first.iter().map(|&head| head.to_owned()).collect();
        heads.extend([value.to_owned(), "at (ms)".to_owned()]);
        if self.turning.is_some() {
            heads.push("drive (deg)".to_owned());
        }
        heads.push("known".to_owned());
        if self.has_ratios() {
            let reference = match self.reference {
                Ok(Reference::File { .. }) => "reference",
                _ => "ideal",
            };
            heads.extend([format!("{reference}{unit}"), "ratio".to_owned()]);
        }
        heads
    }

    /// An extreme: its value, time (ms), angle of the drive (degrees), how it is known, the
    /// reference's, the ratio.
    fn told(
        &self,
        extreme: Option<Extreme>,
        reference: Option<Extreme>,
        ratio: Option<f64>,
    ) -> Vec<String> {
        let time = extreme.map(|extreme| extreme.time);
        let mut row = vec![value(extreme), number(time.map(|time| time * 1e3), 8)];
        if let Some(turning) = &self.turning {
            row.push(number(time.map(|time| turning.angle(time).to_degrees()), 6));
        }
        row.push(match time {
            Some(time) if self.is_beyond(time) => BEYOND.to_owned(),
            _ => known(extreme),
        });
        if self.has_ratios() {
            row.extend([value(reference), number(ratio, 4)]);
        }
        row
    }

    /// A line a revolution: the largest force in each joint, the contacts that began.
    fn forces_in(&self, parts: Revolutions) -> Table {
        let forces = self.of_kind(false);
        let joints = self.run.names.joints.iter().map(|joint| format!("force {joint}"));
        let contacts = self.contacts.iter().map(|contacts| format!("contacts {}", contacts.joint));
        let heads = joints.chain(contacts);
        self.by_revolution(parts, heads.collect(), |k| {
            let forces = forces.iter();
            let ratios =
                forces.map(|(of, tally)| self.in_span(*of, &tally.revolutions[k])[0].clone());
            ratios.chain(self.contacts.iter().map(|c| c.revolutions[k].count.to_string())).collect()
        })
    }

    /// A line a revolution: torques and angular accelerations.
    fn signed_in(&self, parts: Revolutions) -> Table {
        let names = &self.run.names;
        let name = |quantity: Quantity| match quantity {
            Quantity::DriveTorque(drive) => Some(format!("torque {}", names.drives[drive])),
            Quantity::AngularAcceleration(body) => Some(format!("accel. {}", names.bodies[body])),
            _ => None,
        };
        let mut signed = self.of_kind(true);
        signed.retain(|(quantity, _)| name(*quantity).is_some());
        let heads = signed.iter().filter_map(|(quantity, _)| name(*quantity));
        let heads = heads.flat_map(|name| [format!("{name} +"), "−".to_owned()]);
        self.by_revolution(parts, heads.collect(), |k| {
            signed.iter().flat_map(|(of, tally)| self.in_span(*of, &tally.revolutions[k])).collect()
        })
    }

    /// Ratios of a span's extremes; the extremes themselves where there are no ratios.
    fn in_span(&self, quantity: Quantity, extremes: &Extremes) -> [String; 2] {
        match self.has_ratios() {
            true => self.ratios(quantity, extremes).map(|ratio| number(ratio, 4)),
            false => [extremes.largest, extremes.smallest].map(value),
        }
    }

    fn clearances(&self) -> Table {
        let heads = [
            "joint",
            "contacts",
            "in contact (%)",
            "longest contact (ms)",
            "longest flight (ms)",
            "deepest (µm)",
            "fastest impact (m/s)",
            "dissipated (J)",
            "permanent contact (ms)",
        ];
        let length = |stretch: Option<Stretch>| stretch.map(|stretch| stretch.length() * 1e3);
        let rows = self.contacts.iter().map(|contacts| {
            vec![
                contacts.joint.clone(),
                contacts.count.to_string(),
                number(contacts.share.map(|share| share * 100.0), 4),
                number(length(contacts.longest_contact), 5),
                number(length(contacts.longest_flight), 5),
                self.marked(contacts.deepest, 1e6),
                self.marked(contacts.fastest, 1.0),
                figures(contacts.dissipated, 5),
                permanent(contacts),
            ]
        });
        table(heads.map(str::to_owned).to_vec(), rows.collect(), 1)
    }

    /// A table with a line a revolution; those that reach beyond the horizon are marked.
    fn by_revolution(
        &self,
        parts: Revolutions,
        heads: Vec<String>,
        line: impl Fn(usize) -> Vec<String>,
    ) -> Table {
        let rows = listed(parts.count()).into_iter().map(|k| match k {
            None => vec!["…".to_owned(); heads.len() + 1],
            Some(k) => {
                let cut = if parts.is_whole(k) { "" } else { " (part)" };
                let mark = if self.reaches_beyond(k) { MARK } else { "" };
                let mut row = vec![format!("{}{cut}{mark}", k + 1)];
                row.extend(line(k));
                row
            }
        });
        let rows = rows.collect();
        let mut all = vec!["revolution".to_owned()];
        all.extend(heads);
        table(all, rows, 0)
    }

    /// What is said of peaks that the run found.
    fn peak_words(&self) -> &'static str {
        match &self.horizon {
            Some(horizon) if horizon.is_whole() => {
                "peak: found by the run between its samples, as accurate as its forces"
            }
            Some(_) => {
                "peak: found by the run between its samples, as accurate as its forces before the \
                 horizon"
            }
            None => {
                "peak: found by the run between its samples; how far the run is true is not known"
            }
        }
    }

    /// What is said of extremes that only samples tell.
    fn sample_words(&self) -> &'static str {
        if self.horizon.as_ref().is_some_and(|horizon| horizon.certified) {
            "sample: of the samples; between them it may be exceeded. A certified reference keeps no \
             extremes by revolution: steps in 71 digits are too dear to be looked into for each. \
             `freeplay run` of the same case finds them; what the reference says of its peaks is \
             certified"
        } else {
            "sample: of the samples; between them it may be exceeded"
        }
    }

    /// What the marks mean.
    fn horizon_notes(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(horizon) = self.horizon.as_ref().filter(|horizon| !horizon.is_whole()) else {
            return Ok(());
        };
        let until = ms(horizon.forces);
        match &horizon.stopped {
            None => writeln!(
                f,
                "{BEYOND}, *: behind {until} no digit of a force is left; such a number is \
                 {ONE_DRAW}, and another tolerance or machine gives another. Counts and sums hold \
                 all of the run."
            ),
            Some(why) => writeln!(
                f,
                "{BEYOND}, *: the run's errors were followed until {until} only ({why}); how far \
                 such a number is true is not known"
            ),
        }
    }

    /// A value in another unit, marked where its time lies beyond the horizon.
    fn marked(&self, at: Option<At>, factor: f64) -> String {
        let mark = if at.is_some_and(|at| self.is_beyond(at.time)) { MARK } else { "" };
        number(at.map(|at| at.value * factor), 5) + mark
    }

    fn notes(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = self.run.quantities.iter().flat_map(|(_, tally)| {
            [tally.total.largest, tally.total.smallest].into_iter().flatten()
        });
        let bases: Vec<Basis> = all.map(|extreme| extreme.basis).collect();
        writeln!(f)?;
        for (basis, words) in [
            (Basis::Evaluated, "exact: the mechanism was evaluated there, true to rounding"),
            (Basis::Peak, self.peak_words()),
            (Basis::Sample, self.sample_words()),
        ] {
            if bases.contains(&basis) {
                writeln!(f, "{words}")?;
            }
        }
        self.horizon_notes(f)?;
        if self.unresolved_contacts > 0 && bases.contains(&Basis::Sample) {
            let count = self.unresolved_contacts;
            writeln!(
                f,
                "{count} contacts have fewer than three samples: torques and accelerations in \
                 them are not seen; sample more often, or with run.sampling = \"adaptive\""
            )?;
        }
        Ok(())
    }
}

/// Numbers of the revolutions that are shown; `None` for those left out.
fn listed(count: usize) -> Vec<Option<usize>> {
    if count <= MOST_REVOLUTIONS {
        return (0..count).map(Some).collect();
    }
    let half = MOST_REVOLUTIONS / 2;
    let first = (0..half).map(Some);
    first.chain([None]).chain((count - half..count).map(Some)).collect()
}

fn energy_table(energy: &EnergyBalance) -> Table {
    let heads = [
        "drive work (J)",
        "load work (J)",
        "dissipated (J)",
        "stored (J)",
        "residual (J)",
        "largest residual (J)",
        "at (ms)",
        "of kinetic",
    ];
    let row = vec![
        figures(energy.drive_work, 6),
        figures(energy.load_work, 6),
        figures(energy.dissipated, 6),
        figures(energy.stored, 6),
        figures(energy.residual, 3),
        figures(energy.largest_residual.value, 3),
        figures(energy.largest_residual.time * 1e3, 6),
        figures(energy.largest_residual.value / energy.largest_kinetic, 2),
    ];
    table(heads.map(str::to_owned).to_vec(), vec![row], 0)
}

fn permanent(contacts: &Contacts) -> String {
    let phases = contacts.permanent.iter().map(|phase| {
        let end = if phase.open { "end".to_owned() } else { figures(phase.end * 1e3, 5) };
        format!("{} to {end}", figures(phase.begin * 1e3, 5))
    });
    let phases: Vec<String> = phases.collect();
    if phases.is_empty() { "none".to_owned() } else { phases.join(", ") }
}

/// A table whose columns from this one on hold numbers, aligned to the right.
pub(crate) fn table(heads: Vec<String>, rows: Vec<Vec<String>>, from: usize) -> Table {
    let mut table = Table::new();
    table.load_style(NOTHING.header_separator(LineStyle::none().fill('─').junction('─')));
    table.set_header(heads);
    table.add_rows(rows);
    for column in table.column_iter_mut().skip(from) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn section(f: &mut fmt::Formatter<'_>, title: &str, table: Table) -> fmt::Result {
    writeln!(f, "\n{title}\n{}", table.trim_fmt())
}

fn value(extreme: Option<Extreme>) -> String {
    number(extreme.map(|extreme| extreme.value), 7)
}

/// How an extreme is known.
fn known(extreme: Option<Extreme>) -> String {
    let Some(extreme) = extreme else { return NONE.to_owned() };
    match extreme.basis {
        Basis::Evaluated => "exact".to_owned(),
        basis => basis.name().to_owned(),
    }
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or(NONE.to_owned(), |value| figures(value, digits))
}

/// A number to so many significant digits.
fn figures(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let exponent: i32 =
        scientific.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    if !(-4..digits.max(6) as i32).contains(&exponent) {
        return scientific;
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_significant_digits() {
        for (value, digits, expected) in [
            (892.919_148_289, 7, "892.9191"),
            (-60236.420, 7, "-60236.42"),
            (15.2493, 4, "15.25"),
            (9.9999, 4, "10.00"),
            (0.000_123_456, 3, "0.000123"),
            (1.5e-9, 2, "1.5e-9"),
            (123_456.7, 4, "123457"),
            (1.5e12, 4, "1.500e12"),
            (0.0, 4, "0"),
            (f64::NAN, 4, "–"),
        ] {
            assert_eq!(figures(value, digits), expected);
        }
    }

    #[test]
    fn of_many_revolutions_the_first_and_the_last_are_shown() {
        assert_eq!(listed(24).len(), 24);
        let shown = listed(1000);
        assert_eq!((shown.len(), shown[0], shown[12]), (25, Some(0), None));
        assert_eq!((shown[13], shown[24]), (Some(988), Some(999)));
    }
}
