//! The tables of the page.

use super::html::escape;
use super::number::{milliseconds, significant};
use super::run::Run;
use super::summary::{ENERGIES, Largest, Summary, Touching};
use crate::run::Contact;

/// Rows of a run's contact table at most; beyond, the hardest contacts are shown.
const MOST_CONTACTS: usize = 1000;

/// A run, its summary, and the run of the same mechanism without clearances.
pub(super) struct Summarised<'a> {
    pub run: &'a Run<'a>,
    pub summary: Summary,
    /// Index among the runs of the page.
    pub reference: Option<usize>,
}

/// Maxima, contacts and energies: a column a run.
pub(super) fn summary(runs: &[Summarised<'_>]) -> String {
    let mut table = Matrix::new(runs.iter().map(|run| run.run.label.as_str()));
    let files = || runs.iter().map(|run| run.run.file);
    table.group("Largest force in a joint (N)");
    for joint in union(files().map(|file| file.joints())) {
        table.row(&joint, runs.iter().map(|run| force_cell(runs, run, &joint)));
    }
    let drives = union(files().map(|file| file.drives()));
    table.group_if(!drives.is_empty(), "Largest drive torque (N m)");
    for drive in drives {
        let of = |run: &Summarised<'_>| {
            place(run.run.file.drives(), &drive).map(|k| run.summary.torques.get(k).copied())
        };
        table.row(&drive, runs.iter().map(|run| largest_cell(run, of(run).flatten())));
    }
    table.group("Largest angular acceleration (rad/s²)");
    for body in union(files().map(|file| file.bodies())) {
        let of = |run: &Summarised<'_>| {
            place(run.run.file.bodies(), &body).map(|k| run.summary.accelerations.get(k).copied())
        };
        table.row(&body, runs.iter().map(|run| largest_cell(run, of(run).flatten())));
    }
    for clearance in union(files().map(|file| file.clearances())) {
        contact_rows(&mut table, runs, &clearance);
    }
    energy_rows(&mut table, runs);
    table.finish("summary")
}

fn contact_rows(table: &mut Matrix, runs: &[Summarised<'_>], clearance: &str) {
    table.group(&format!("Journal and bearing in {}", escape(clearance)));
    let mut row = |name: &str, value: fn(&Touching) -> String| {
        let cell = |run: &Summarised<'_>| {
            let k = place(run.run.file.clearances(), clearance);
            k.and_then(|k| run.summary.touching.get(k)).map_or_else(dash, value)
        };
        table.row(name, runs.iter().map(cell));
    };
    row("contacts", |t| t.contacts.to_string());
    row("time in contact (%)", |t| significant(100.0 * t.share, 3));
    row("longest contact (ms)", |t| significant(1e3 * t.longest_contact, 4));
    row("longest flight (ms)", |t| significant(1e3 * t.longest_flight, 4));
    row("largest depth (µm)", |t| significant(1e6 * t.penetration, 4));
    row("largest impact rate (m/s)", |t| significant(t.impact_rate, 4));
    row("dissipated (mJ)", |t| significant(1e3 * t.dissipated, 4));
}

fn energy_rows(table: &mut Matrix, runs: &[Summarised<'_>]) {
    table.group("Energy balance at the end (J)");
    for (dataset, name) in ENERGIES {
        let of = |run: &Summarised<'_>| {
            run.summary.energies.iter().find(|(known, _)| *known == dataset).map(|(_, v)| *v)
        };
        if runs.iter().any(|run| of(run).is_some_and(|value| value != 0.0)) {
            let cell = |run| of(run).map_or_else(dash, |value| significant(value, 6));
            table.row(name, runs.iter().map(cell));
        }
    }
    let residual = |run: &Summarised<'_>| significant(run.summary.residual.value, 2);
    table.row("largest residual of the balance", runs.iter().map(residual));
    let relative = |run: &Summarised<'_>| {
        let Summary { residual, kinetic, .. } = &run.summary;
        significant(residual.value.abs() / kinetic.value.abs(), 2)
    };
    table.row("the same over the largest kinetic energy", runs.iter().map(relative));
}

/// Largest force, its ratio to the ideal mechanism's, its time.
fn force_cell(runs: &[Summarised<'_>], run: &Summarised<'_>, joint: &str) -> String {
    let force = |of: &Summarised<'_>| {
        let joint = place(of.run.file.joints(), joint)?;
        of.summary.forces.get(joint).copied()
    };
    let ideal = run.reference.and_then(|k| force(&runs[k])).map(|largest| largest.value);
    let Some(largest) = force(run) else {
        return dash();
    };
    let ratio = ideal.map(|ideal| {
        let title = "ratio to the ideal mechanism's largest force in this joint";
        let ratio = significant(largest.value / ideal, 3);
        format!(" <span class=\"ratio\" title=\"{title}\">{ratio}\u{202f}×</span>")
    });
    format!("{}{}{}", significant(largest.value, 6), ratio.unwrap_or_default(), at(run, largest))
}

fn largest_cell(run: &Summarised<'_>, largest: Option<Largest>) -> String {
    let cell = |largest: Largest| format!("{}{}", significant(largest.value, 6), at(run, largest));
    largest.map_or_else(dash, cell)
}

/// When, as a link that takes the page there.
fn at(run: &Summarised<'_>, largest: Largest) -> String {
    if largest.time.is_nan() || largest.value == 0.0 {
        return String::new();
    }
    format!(" <span class=\"when\">at {} ms</span>", moment(&run.run.label, largest.time))
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
    let tables: String = with.map(|run| contacts_of(run.run)).collect();
    if tables.is_empty() {
        return "<p>No joint has a clearance.</p>".to_owned();
    }
    tables
}

fn contacts_of(run: &Run<'_>) -> String {
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
    let rows: String = shown.iter().map(|contact| contact_row(run, contact)).collect();
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

fn contact_row(run: &Run<'_>, contact: &Contact) -> String {
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
    format!("<tr><th scope=\"row\">{joint}</th>{cells}</tr>\n")
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

    fn group_if(&mut self, wanted: bool, heading: &str) {
        if wanted {
            self.group(heading);
        }
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

fn place(names: &[String], name: &str) -> Option<usize> {
    names.iter().position(|known| known == name)
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
