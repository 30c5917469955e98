//! The tables of the page.

use super::html::escape;
use super::number::{milliseconds, significant};
use super::run::Run;
use crate::certify::ONE_DRAW;
use crate::post::{
    Basis, Contacts, EnergyBalance, Extreme, Extremes, Quantity, Reference, Stretch, Summary, Tally,
};
use crate::record::ResultFile;
use crate::run::Contact;

/// Rows of a run's contact table at most; beyond, the hardest contacts are shown.
const MOST_CONTACTS: usize = 1000;

/// Revolutions that the summary tells at most.
const MOST_REVOLUTIONS: usize = 12;

/// A run and its summary.
pub(super) struct Summarised<'a> {
    pub run: &'a Run<'a>,
    pub summary: Summary,
}

/// Joints, drives or bodies of a run, and which quantity of theirs is meant.
type Items = (fn(&ResultFile) -> &[String], fn(usize) -> Quantity);

const FORCES: Items = (ResultFile::joints, Quantity::JointForce);
const TORQUES: Items = (ResultFile::drives, Quantity::DriveTorque);
const ACCELERATIONS: Items = (ResultFile::bodies, Quantity::AngularAcceleration);

impl Summarised<'_> {
    /// The quantity of an item of this run, with its extremes.
    fn quantity(&self, (names, kind): Items, item: &str) -> Option<(Quantity, &Tally)> {
        let quantity = kind(names(self.run.file).iter().position(|name| name == item)?);
        let tally = self.summary.run.of(&quantity.name(&self.summary.run.names))?;
        Some((quantity, tally))
    }

    /// What this run knows of the contacts of a joint.
    fn contacts(&self, joint: &str) -> Option<&Contacts> {
        self.summary.contacts.iter().find(|contacts| contacts.joint == joint)
    }
}

/// Maxima, contacts and energies: a column a run.
pub(super) fn summary(runs: &[Summarised<'_>]) -> String {
    let mut table = Matrix::new(runs.iter().map(|run| run.run.label.as_str()));
    let all = |names: fn(&ResultFile) -> &[String]| union(runs.iter().map(|r| names(r.run.file)));
    table.group("Largest force in a joint (N), and its ratio to the ideal mechanism's");
    for joint in all(ResultFile::joints) {
        table.row(&joint, runs.iter().map(|run| extreme_cell(run, FORCES, &joint, 0)));
    }
    for (heading, items) in
        [("Drive torque (N m)", TORQUES), ("Angular acceleration (rad/s²)", ACCELERATIONS)]
    {
        signed_rows(&mut table, runs, heading, items, &all(items.0));
    }
    for joint in all(ResultFile::clearances) {
        contact_rows(&mut table, runs, &joint);
        revolution_rows(&mut table, runs, &joint);
    }
    energy_rows(&mut table, runs);
    let without_ideal = runs.iter().filter_map(|run| {
        let why = run.summary.reference.as_ref().err()?;
        let (label, why) = (escape(&run.run.label), escape(&why.to_string()));
        Some(format!("<p class=\"note\">{label} has no ratios to an ideal run: {why}.</p>"))
    });
    let notes: String = without_ideal.collect();
    table.finish("summary") + &horizon_notes(runs) + &notes
}

/// The largest and the smallest value of each item that is not zero throughout.
fn signed_rows(
    table: &mut Matrix,
    runs: &[Summarised<'_>],
    heading: &str,
    items: Items,
    names: &[String],
) {
    let is_zero = |name: &&String| {
        let magnitude = |run: &Summarised<'_>| run.quantity(items, name)?.1.total.magnitude();
        runs.iter().filter_map(magnitude).all(|magnitude| magnitude == 0.0)
    };
    let names: Vec<&String> = names.iter().filter(|name| !is_zero(name)).collect();
    if !names.is_empty() {
        table.group(heading);
    }
    for name in names {
        for (side, word) in ["largest", "smallest"].into_iter().enumerate() {
            let cells = runs.iter().map(|run| extreme_cell(run, items, name, side));
            table.row(&format!("{name}, {word}"), cells);
        }
    }
}

fn contact_rows(table: &mut Matrix, runs: &[Summarised<'_>], joint: &str) {
    table.group(&format!("Journal and bearing in {}", escape(joint)));
    let mut row = |name: &str, value: fn(&Contacts) -> Option<f64>, digits: i32| {
        let cell = |run: &Summarised<'_>| {
            let value = run.contacts(joint).and_then(value);
            value.map_or_else(dash, |value| significant(value, digits))
        };
        table.row(name, runs.iter().map(cell));
    };
    row("contacts", |c| Some(c.count as f64), 1);
    row("time in contact (%)", |c| Some(100.0 * c.share?), 3);
    row("longest contact (ms)", |c| Some(1e3 * c.longest_contact?.length()), 4);
    row("longest flight (ms)", |c| Some(1e3 * c.longest_flight?.length()), 4);
    row("largest depth (µm)", |c| Some(1e6 * c.deepest?.value), 4);
    row("largest impact rate (m/s)", |c| Some(c.fastest?.value), 4);
    row("dissipated (mJ)", |c| Some(1e3 * c.dissipated), 4);
    let permanent = |run: &Summarised<'_>| {
        let phases = run.contacts(joint)?.permanent.iter();
        let phase = |s: &Stretch| format!("{} to {}", milliseconds(s.begin), milliseconds(s.end));
        Some(phases.map(phase).collect::<Vec<_>>().join("<br>"))
    };
    let told = |run| permanent(run).filter(|phases| !phases.is_empty());
    if runs.iter().any(|run| told(run).is_some()) {
        table.row("permanent contact (ms)", runs.iter().map(|run| told(run).unwrap_or_else(dash)));
    }
}

/// Ratio of the largest force in each revolution to the ideal mechanism's largest.
fn revolution_rows(table: &mut Matrix, runs: &[Summarised<'_>], joint: &str) {
    let extremes = |run: &Summarised<'_>, k: usize| {
        let (quantity, tally) = run.quantity(FORCES, joint)?;
        run.contacts(joint)?;
        run.summary.ratios(quantity, tally.revolutions.get(k)?)[0]
    };
    let count =
        (0..=MOST_REVOLUTIONS).take_while(|k| runs.iter().any(|r| extremes(r, *k).is_some()));
    let count = count.count();
    if count == 0 {
        return;
    }
    let first = if count > MOST_REVOLUTIONS { ", the first revolutions" } else { "" };
    let joint = escape(joint);
    table.group(&format!("Largest force in {joint} over the ideal mechanism's{first}"));
    for k in 0..count.min(MOST_REVOLUTIONS) {
        let cell = |run: &Summarised<'_>| {
            let told = extremes(run, k).map_or_else(dash, |ratio| significant(ratio, 3));
            if run.summary.reaches_beyond(k) { beyond(&told) } else { told }
        };
        table.row(&format!("revolution {}", k + 1), runs.iter().map(cell));
    }
}

fn energy_rows(table: &mut Matrix, runs: &[Summarised<'_>]) {
    table.group("Energy balance of the run (J)");
    let mut row = |name: &str, value: fn(&EnergyBalance) -> f64, digits: i32| {
        let value = |run: &Summarised<'_>| run.summary.energy.as_ref().map(value);
        if runs.iter().filter_map(value).any(|value| value != 0.0) {
            let cell = |run| value(run).map_or_else(dash, |value| significant(value, digits));
            table.row(name, runs.iter().map(cell));
        }
    };
    row("work of the drives", |e| e.drive_work, 6);
    row("work of applied forces", |e| e.load_work, 6);
    row("dissipated", |e| e.dissipated, 6);
    row("stored more than at the begin", |e| e.stored, 6);
    row("largest residual", |e| e.largest_residual.value, 2);
    row("the same over the largest kinetic energy", relative_residual, 2);
}

fn relative_residual(energy: &EnergyBalance) -> f64 {
    energy.largest_residual.value / energy.largest_kinetic
}

/// The largest (0) or smallest (1) value of an item, its ratio to the reference's, its time.
fn extreme_cell(run: &Summarised<'_>, items: Items, item: &str, side: usize) -> String {
    let Some((quantity, tally)) = run.quantity(items, item) else {
        return dash();
    };
    let Extremes { largest, smallest } = tally.total;
    let Some(extreme) = [largest, smallest][side] else {
        return dash();
    };
    let itself = matches!(run.summary.reference, Ok(Reference::Itself));
    let ratio = run.summary.ratios(quantity, &tally.total)[side].filter(|_| !itself);
    let ratio = ratio.map_or_else(String::new, |ratio| {
        let ratio = significant(ratio, 3);
        format!(" <span class=\"ratio\" title=\"over the ideal one\">{ratio}\u{202f}×</span>")
    });
    let told = format!("{}{ratio}{}", told(&extreme, side), at(run, &extreme));
    if run.summary.is_beyond(extreme.time) { beyond(&told) } else { told }
}

/// A cell that lies beyond the horizon of its run; HTML.
fn beyond(cell: &str) -> String {
    format!("<span class=\"beyond\" title=\"beyond the horizon: {ONE_DRAW}\">{cell} *</span>")
}

/// How far each run is true.
fn horizon_notes(runs: &[Summarised<'_>]) -> String {
    let told = runs.iter().filter_map(|Summarised { run, summary }| {
        let label = escape(&run.label);
        let words = match (&summary.horizon, &summary.sentence) {
            (Some(horizon), Some(sentence)) => {
                let mark = if horizon.is_whole() { "" } else { " (*, grey in the charts)" };
                format!("{}{mark}. To quote: <q>{}</q>", escape(&horizon.holds()), escape(sentence))
            }
            _ if summary.contacts.is_empty() => return None,
            _ => "how far it is true is not known: its errors were not followed".to_owned(),
        };
        Some(format!("<p class=\"note horizon\">{label}: {words}.</p>"))
    });
    told.collect()
}

/// The largest (0) or smallest (1) value, and whether no more is known than that a sample has it.
fn told(extreme: &Extreme, side: usize) -> String {
    let value = significant(extreme.value, 6);
    let sign = ['≥', '≤'][side];
    match extreme.basis {
        Basis::Sample => format!("<span class=\"about\">{sign}</span>\u{202f}{value}"),
        Basis::Evaluated | Basis::Peak => value,
    }
}

/// When, as a link that takes the page there.
fn at(run: &Summarised<'_>, extreme: &Extreme) -> String {
    format!(" <span class=\"when\">at {} ms</span>", moment(&run.run.label, extreme.time))
}

/// A link to a moment (s) of a run.
fn moment(label: &str, time: f64) -> String {
    let shown = milliseconds(time);
    let run = percent_encoded(label);
    format!("<a href=\"#t={:.6}&amp;run={run}\">{shown}</a>", time * 1e3)
}

fn percent_encoded(text: &str) -> String {
    let plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"-_.".contains(byte);
    text.bytes()
        .map(|byte| if plain(&byte) { char::from(byte).into() } else { format!("%{byte:02X}") })
        .collect()
}

/// The contacts of each run.
pub(super) fn contacts(runs: &[Summarised<'_>]) -> String {
    let with = runs.iter().filter(|run| !run.run.file.clearances().is_empty());
    let tables: String = with.map(contacts_of).collect();
    if tables.is_empty() {
        return "<p>No joint has a clearance.</p>".to_owned();
    }
    tables
}

fn contacts_of(Summarised { run, summary }: &Summarised<'_>) -> String {
    let mut shown: Vec<&Contact> = run.contacts.iter().collect();
    if shown.len() > MOST_CONTACTS {
        shown.sort_by(|one, other| other.peak_force.total_cmp(&one.peak_force));
        shown.truncate(MOST_CONTACTS);
    }
    shown.sort_by(|one, other| one.begin.total_cmp(&other.begin));
    let count = run.contacts.len();
    let which = match count > MOST_CONTACTS {
        true => format!("the {MOST_CONTACTS} hardest of {count} contacts"),
        false if count == 1 => "1 contact".to_owned(),
        false => format!("{count} contacts"),
    };
    let horizon = summary.horizon.as_ref();
    let ends = horizon.map_or(f64::INFINITY, |horizon| horizon.forces);
    let rows: String = shown.iter().map(|contact| contact_row(run, contact, ends)).collect();
    format!(
        "<details class=\"contacts\"><summary>{label}: {which}</summary>\
         <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Contacts of {label}\">\
         <table><thead><tr><th scope=\"col\">joint</th><th scope=\"col\">begins (ms)</th>\
         <th scope=\"col\">lasts (µs)</th><th scope=\"col\">impact rate (m/s)</th>\
         <th scope=\"col\">largest depth (µm)</th><th scope=\"col\">largest force (N)</th>\
         <th scope=\"col\">at (ms)</th><th scope=\"col\">dissipated (mJ)</th></tr></thead>\
         <tbody>{rows}</tbody></table></div></details>",
        label = escape(&run.label),
    )
}

/// A contact; grey where it peaks behind `ends` (s).
fn contact_row(run: &Run<'_>, contact: &Contact, ends: f64) -> String {
    let lasts = match contact.end.is_nan() {
        true => "to the end".to_owned(),
        false => significant((contact.end - contact.begin) * 1e6, 4),
    };
    let joint = run.file.clearances().get(contact.clearance);
    let cells = [
        moment(&run.label, contact.begin),
        lasts,
        significant(contact.impact_rate, 4),
        significant(contact.peak_penetration * 1e6, 4),
        significant(contact.peak_force, 5),
        moment(&run.label, contact.peak_time),
        significant(contact.dissipated * 1e3, 3),
    ];
    let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
    let joint = joint.map_or_else(dash, |joint| escape(joint));
    let class = if contact.peak_time > ends { " class=\"beyond\"" } else { "" };
    format!("<tr{class}><th scope=\"row\">{joint}</th>{cells}</tr>\n")
}

/// Rows of named quantities, a column a run.
pub(super) struct Matrix {
    head: String,
    body: String,
    columns: usize,
}

impl Matrix {
    /// A table of these runs.
    pub fn new<'l>(labels: impl Iterator<Item = &'l str>) -> Matrix {
        let mut matrix = Matrix { head: String::new(), body: String::new(), columns: 1 };
        for label in labels {
            matrix.columns += 1;
            matrix.head.push_str(&format!("<th scope=\"col\">{}</th>", escape(label)));
        }
        matrix
    }

    /// Begins a group of rows; the heading is HTML.
    pub fn group(&mut self, heading: &str) {
        let columns = self.columns;
        self.body.push_str(&format!(
            "</tbody><tbody><tr class=\"group\"><th scope=\"rowgroup\" colspan=\"{columns}\">\
             {heading}</th></tr>"
        ));
    }

    /// A row; its name is text, its cells are HTML.
    pub fn row(&mut self, name: &str, cells: impl Iterator<Item = String>) {
        let cells: String = cells.map(|cell| format!("<td>{cell}</td>")).collect();
        let name = escape(name);
        self.body.push_str(&format!("<tr><th scope=\"row\">{name}</th>{cells}</tr>\n"));
    }

    /// The table, with this class.
    pub fn finish(self, class: &str) -> String {
        let Matrix { head, body, .. } = self;
        let body = body.strip_prefix("</tbody>").unwrap_or(&body);
        let body = match body.starts_with("<tbody>") {
            true => format!("{body}</tbody>"),
            false => format!("<tbody>{body}</tbody>"),
        };
        format!(
            "<div class=\"scroll\"><table class=\"{class}\"><thead><tr><td></td>{head}</tr></thead>\
             {body}</table></div>"
        )
    }
}

fn dash() -> String {
    "–".to_owned()
}

/// All names, each once, in the order in which they are met.
fn union<'n>(lists: impl Iterator<Item = &'n [String]>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for name in lists.flatten() {
        if !all.contains(name) {
            all.push(name.clone());
        }
    }
    all
}
