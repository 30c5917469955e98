//! The page of a study: its table, its figures, and charts of which each point leads to the row of its run,
//! with the command that makes the run again. It needs no script.

use super::html::{escape, fill};
use super::number::{significant, significant_plain};
use super::page::hash;
use crate::figure::{self, Figure};
use crate::record::{self, Draft};
use crate::study::{Error, Recorded, Rows};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const TEMPLATE: &str = include_str!("page/study.html");
const STYLE: &str = include_str!("page/study.css");

/// Runs that have a row, evenly chosen of more.
const MOST_RUNS: usize = 5000;
/// Charts with points that lead to their runs.
const MOST_CHARTS: usize = 24;
/// Digits of numbers in tables and charts.
const DIGITS: i32 = 6;
/// Width and height of a chart, and the room of its axes.
const SIZE: [f64; 2] = [460.0, 260.0];
const ROOM: [f64; 2] = [70.0, 40.0];

/// The page of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StudyPage {
    html: String,
    folder: PathBuf,
}

/// A run that has a row.
struct Row {
    number: u64,
    /// Its values of what varies, and its numbers.
    values: Vec<String>,
    numbers: Vec<f64>,
    command: String,
}

impl StudyPage {
    /// Makes the page of the study whose tables are in a folder.
    ///
    /// # Errors
    /// Tables that cannot be read.
    pub fn new(recorded: &Recorded, folder: &Path) -> Result<StudyPage, Error> {
        let study = &recorded.study;
        let behind = recorded.runs.names().iter().position(|name| name == "case_sha256");
        let names = &recorded.runs.names()[behind.map_or(0, |place| place + 1)..];
        let all = recorded.runs.column("run")?;
        let columns = names.iter().map(|name| recorded.runs.column(name));
        let columns = columns.collect::<Result<Vec<_>, _>>()?;
        let rows: Vec<Row> = chosen(all.len(), MOST_RUNS)
            .into_iter()
            .map(|place| {
                let number = all[place] as u64;
                let values = study.point(number).into_iter();
                Row {
                    number,
                    values: values.map(|value| value.text.trim_matches('"').to_owned()).collect(),
                    numbers: columns.iter().map(|column| column[place]).collect(),
                    command: command(recorded, number),
                }
            })
            .collect();
        let title = match study.title.as_str() {
            "" => folder.file_name().map_or("Study".into(), |name| name.to_string_lossy()),
            title => title.into(),
        };
        let drawn = figure::draw_study(recorded, &figure::Options::default())?;
        let style = hash(STYLE);
        let policy = format!(
            "default-src 'none'; style-src '{style}'; img-src data:; base-uri 'none'; form-action 'none'"
        );
        let html = fill(
            TEMPLATE,
            &[
                ("policy", &policy),
                ("style", STYLE),
                ("title", &escape(&title)),
                ("about", &about(recorded, all.len(), rows.len())),
                ("charts", &charts(recorded, names, &rows)),
                ("figures", &figures(&drawn)),
                ("runs", &table(recorded, names, &rows)),
                ("failures", &failures(&recorded.failures, recorded)?),
                ("study", &escape(&study.text)),
                ("case", &escape(study.template.text())),
                ("program", concat!("freeplay ", env!("CARGO_PKG_VERSION"))),
            ],
        );
        Ok(StudyPage { html, folder: folder.to_owned() })
    }

    /// The page.
    pub fn html(&self) -> &str {
        &self.html
    }

    /// Writes the page; with `force` in place of one that is there.
    ///
    /// # Errors
    /// The page is there and `force` is not, or it is a table of the study, or cannot be written.
    pub fn write(&self, path: &Path, force: bool) -> Result<(), record::Error> {
        let tables = crate::study::TABLES.iter().map(|name| format!("{name}.parquet"));
        let tables: Vec<PathBuf> = tables.map(|name| self.folder.join(name)).collect();
        let sources: Vec<&Path> = tables.iter().map(PathBuf::as_path).collect();
        Draft::create_from(path, force, &sources)?.publish_bytes(self.html.as_bytes())
    }
}

/// What has `freeplay run` make a run by itself.
fn command(recorded: &Recorded, run: u64) -> String {
    let study = &recorded.study;
    let case = study.template.path().to_string_lossy().into_owned();
    let set = study.options(run).into_iter().map(|change| format!(" --set {}", quoted(&change)));
    format!("freeplay run {}{}", quoted(&case), set.collect::<String>())
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_./=:+-,".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// Some of many, evenly chosen.
fn chosen(count: usize, most: usize) -> Vec<usize> {
    match count <= most {
        true => (0..count).collect(),
        false => (0..most).map(|k| k * (count - 1) / (most - 1)).collect(),
    }
}

fn about(recorded: &Recorded, made: usize, shown: usize) -> String {
    let study = &recorded.study;
    let failed = recorded.failures.len();
    let mut words = format!("{} runs, {failed} of them failed. ", study.runs);
    if shown < made {
        let _ = write!(words, "Of {made} rows {shown}, evenly chosen, are on this page. ");
    }
    let varies: Vec<&str> = study.variables.iter().map(|of| of.name.as_str()).collect();
    let _ = write!(words, "What varies: {}.", varies.join(", "));
    escape(&words)
}

/// A chart for each number over the first variable that is one; each point leads to its run.
fn charts(recorded: &Recorded, names: &[String], rows: &[Row]) -> String {
    let study = &recorded.study;
    let place = study.variables.iter().position(|variable| variable.is_number);
    let mut charts = String::new();
    let Some(place) = place else { return charts };
    let variable = &study.variables[place];
    let scale = |x: f64| if variable.is_log { x.log10() } else { x };
    for (k, name) in names.iter().enumerate().take(MOST_CHARTS) {
        let points: Vec<(&Row, [f64; 2])> = (rows.iter())
            .filter_map(|row| {
                let x: f64 = row.values[place].parse().ok()?;
                let point = [scale(x), row.numbers[k]];
                point.iter().all(|x| x.is_finite()).then_some((row, point))
            })
            .collect();
        let Some(ends) = ends(&points) else { continue };
        let at = |point: [f64; 2]| {
            let share = |k: usize| (point[k] - ends[k][0]) / (ends[k][1] - ends[k][0]);
            [
                ROOM[0] + share(0) * (SIZE[0] - ROOM[0] - 10.0),
                SIZE[1] - ROOM[1] - share(1) * (SIZE[1] - ROOM[1] - 10.0),
            ]
        };
        let _ = write!(
            charts,
            "<figure><figcaption>{}</figcaption>\n<svg viewBox=\"0 0 {} {}\" role=\"img\">\n\
             <rect class=\"frame\" x=\"{}\" y=\"10\" width=\"{}\" height=\"{}\"/>\n",
            escape(&with_unit(name, recorded.runs.unit(name))),
            SIZE[0],
            SIZE[1],
            ROOM[0],
            SIZE[0] - ROOM[0] - 10.0,
            SIZE[1] - ROOM[1] - 10.0,
        );
        let told = |x: f64| significant_plain(x, 4);
        let back = |x: f64| if variable.is_log { 10_f64.powf(x) } else { x };
        let bottom = SIZE[1] - ROOM[1];
        for (x, anchor, value) in
            [(ROOM[0], "start", ends[0][0]), (SIZE[0] - 10.0, "end", ends[0][1])]
        {
            let (y, value) = (bottom + 15.0, told(back(value)));
            let _ = writeln!(
                charts,
                "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\">{value}</text>"
            );
        }
        for (y, value) in [(bottom, ends[1][0]), (20.0, ends[1][1])] {
            let (x, value) = (ROOM[0] - 5.0, told(value));
            let _ =
                writeln!(charts, "<text x=\"{x}\" y=\"{y}\" text-anchor=\"end\">{value}</text>");
        }
        let over = escape(&with_unit(&variable.name, &variable.unit));
        let (x, y) = (0.5 * (ROOM[0] + SIZE[0] - 10.0), SIZE[1] - 5.0);
        let _ = writeln!(charts, "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{over}</text>");
        for (row, point) in points {
            let [x, y] = at(point);
            let _ = writeln!(
                charts,
                "<a href=\"#run-{0}\"><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"><title>run {0}: {1}, \
                 {2}</title></circle></a>",
                row.number,
                escape(&row.values.join(", ")),
                significant_plain(row.numbers[k], DIGITS),
            );
        }
        charts.push_str("</svg></figure>\n");
    }
    charts
}

/// The least and the largest of points, apart from each other.
fn ends(points: &[(&Row, [f64; 2])]) -> Option<[[f64; 2]; 2]> {
    let (_, first) = points.first()?;
    let mut ends = first.map(|x| [x, x]);
    for (_, point) in points {
        for (ends, x) in ends.iter_mut().zip(point) {
            *ends = [ends[0].min(*x), ends[1].max(*x)];
        }
    }
    Some(ends.map(|[low, high]| {
        let room = if high > low { 0.03 * (high - low) } else { 0.5 * low.abs().max(1e-300) };
        [low - room, high + room]
    }))
}

fn with_unit(name: &str, unit: &str) -> String {
    if unit == "1" { name.to_owned() } else { format!("{name} ({unit})") }
}

/// The figures of `freeplay plot`.
fn figures(drawn: &[Figure]) -> String {
    let image = |figure: &Figure| {
        let (title, data) = (escape(&figure.title), STANDARD.encode(&figure.svg));
        format!(
            "<figure><figcaption>{title}</figcaption>\
             <img alt=\"{title}\" src=\"data:image/svg+xml;base64,{data}\"></figure>\n"
        )
    };
    drawn.iter().map(image).collect()
}

fn table(recorded: &Recorded, names: &[String], rows: &[Row]) -> String {
    let variables = &recorded.study.variables;
    let heads = variables.iter().map(|of| with_unit(&of.name, &of.unit));
    let heads = heads.chain(names.iter().map(|name| with_unit(name, recorded.runs.unit(name))));
    let heads: String = heads.map(|head| format!("<th>{}</th>", escape(&head))).collect();
    let mut table = format!("<thead><tr><th>run</th>{heads}<th>again</th></tr></thead>\n<tbody>\n");
    for row in rows {
        let _ = write!(table, "<tr id=\"run-{0}\"><td>{0}</td>", row.number);
        for value in &row.values {
            let _ = write!(table, "<td>{}</td>", escape(value));
        }
        for number in &row.numbers {
            let told =
                if number.is_finite() { significant(*number, DIGITS) } else { "–".to_owned() };
            let _ = write!(table, "<td>{told}</td>");
        }
        let _ = writeln!(table, "<td><code>{}</code></td></tr>", escape(&row.command));
    }
    table.push_str("</tbody>");
    table
}

/// Runs that failed, and why.
fn failures(failures: &Rows, recorded: &Recorded) -> Result<String, Error> {
    if failures.is_empty() {
        return Ok("<p>No run failed.</p>".to_owned());
    }
    let (runs, reasons) = (failures.column("run")?, failures.texts("reason")?);
    let mut table =
        "<table><thead><tr><th>run</th><th>why</th><th>again</th></tr></thead>\n".to_owned();
    for place in chosen(runs.len(), MOST_RUNS) {
        let (run, why) = (runs[place] as u64, escape(&reasons[place]));
        let again = escape(&command(recorded, run));
        let _ = writeln!(
            table,
            "<tr id=\"run-{run}\"><td>{run}</td><td>{why}</td><td><code>{again}</code></td></tr>"
        );
    }
    table.push_str("</table>");
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_reads_a_quoted_word_as_it_stands() {
        for (word, told) in [
            ("drives.crank.speed_rpm=1000.0", "drives.crank.speed_rpm=1000.0"),
            ("title=\"it's\"", "'title=\"it'\\''s\"'"),
            ("my case.toml", "'my case.toml'"),
            ("", "''"),
        ] {
            assert_eq!(quoted(word), told);
        }
    }
}
