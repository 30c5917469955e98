//! A comparison in words and tables.

use super::comparison::{Comparison, Identity, MappedName, Side};
use super::event::EventRow;
use super::mapping::How;
use super::reference::Way;
use crate::digits::{Grade, Hold};
use crate::model::in_brackets;
use crate::post::table;
use comfy_table::Table;
use std::fmt::{self, Display, Formatter};
use std::ops::Range;

/// Digits whose end is told.
pub const HELD: [f64; 5] = [12.0, 9.0, 6.0, 3.0, 1.0];

/// Most rows of the table of digits, give or take one.
const ROWS: f64 = 15.0;

/// Most names that a line lists.
const MOST_NAMES: usize = 12;

/// Digits, rounded down to tenths: never more than are there.
pub(super) fn floor(digits: f64) -> String {
    if digits == f64::NEG_INFINITY {
        return "no".to_owned();
    }
    // 4.299999… is 4.3 that was computed
    let tenths = (digits * 10.0 + 1e-9).floor() / 10.0;
    format!("{tenths:.1}")
}

/// A time to six significant digits, as short as it can be written.
pub(super) fn seconds(time: f64) -> String {
    let rounded: f64 = format!("{time:.5e}").parse().unwrap_or(time);
    if rounded != 0.0 && rounded.abs() < 1e-6 {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

/// A number of things, `1 column` or `2 columns`.
fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

impl Grade {
    /// The digits, with a sign where there may be more.
    fn told(&self) -> String {
        let sign = if self.at_least { "≥ " } else { "" };
        format!("{sign}{}", floor(self.digits))
    }
}

impl Display for Comparison {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "theirs     {}: {}", self.theirs.path.display(), self.theirs.description)?;
        writeln!(
            f,
            "reference  {}: {}",
            self.reference.path.display(),
            self.reference.description
        )?;
        writeln!(f, "certified  {}", self.certificate_line())?;
        writeln!(f, "compared   {}", self.compared_line())?;
        writeln!(f, "coverage   {}", self.coverage)?;
        mapping_lines(&self.theirs, f)?;
        mapping_lines(&self.reference, f)?;
        match self.identity {
            Identity::Everything => {
                writeln!(f, "\nThe two agree to the last bit of every number.")?
            }
            Identity::Compared => {
                writeln!(f, "\nThe two agree to the last bit of every number compared.")?;
            }
            Identity::None => {}
        }
        writeln!(
            f,
            "\nFewest digits of agreement, from the row before:\n{}",
            self.digits_table().trim_fmt()
        )?;
        self.hold_lines(f)?;
        self.least_line(f)?;
        self.event_lines(f)?;
        for note in &self.notes {
            writeln!(f, "note: {note}")?;
        }
        Ok(())
    }
}

impl Comparison {
    fn certificate_line(&self) -> String {
        let sealed = self.certificate.as_ref().is_some_and(|certificate| certificate.sealed);
        let seal = if sealed { "" } else { "; its certificate is not sealed" };
        match self.certified_digits() {
            Some(digits) => {
                format!("the reference, to {} digits or more here{seal}", floor(digits))
            }
            None => "no; digits are those of agreement, and true as far as the reference is".into(),
        }
    }

    fn compared_line(&self) -> String {
        let times = &self.series.times;
        let (first, last) = (times.first().copied(), times.last().copied());
        let span = |time: Option<f64>| time.map_or(String::new(), seconds);
        let mut line = format!(
            "{} of {}, {} s to {} s; ",
            counted(times.len(), "sample"),
            counted(self.columns.len(), "column"),
            span(first),
            span(last)
        );
        line += &match self.way {
            Way::Stored => "the reference has samples there".to_owned(),
            Way::RunAgain { checked } => format!(
                "the reference's case was run again to have it there, and {checked} of its own \
                 samples came out to the last bits"
            ),
            Way::CommonTimes => match self.left_out {
                0 => "both have samples there".to_owned(),
                left => format!("both have samples there; {left} others of theirs are left out"),
            },
        };
        line
    }

    /// Digits over time: for each stretch, the fewest.
    fn digits_table(&self) -> Table {
        let series = &self.series;
        let quantities = series.quantities.iter();
        let titles = quantities.clone().map(|graded| match graded.in_gate {
            true => graded.quantity.title().to_owned(),
            false => format!("({})", graded.quantity.title()),
        });
        let heads = ["until (s)".to_owned(), "gate".to_owned()].into_iter().chain(titles);
        let row = |rows: Range<usize>| {
            let grades = std::iter::once(&series.gate).chain(quantities.clone().map(|q| &q.grades));
            let fewest = grades.map(|grades| {
                let worst = grades[rows.clone()].iter().copied().reduce(Grade::worse);
                worst.map_or(String::new(), |grade| grade.told())
            });
            let until = series.times[rows.end - 1];
            let mark = if self.is_beyond(until) { " *" } else { "" };
            std::iter::once(seconds(until) + mark).chain(fewest).collect()
        };
        table(heads.collect(), stretches(&series.times).into_iter().map(row).collect(), 0)
    }

    /// Whether a time (s) lies beyond the horizon of either.
    fn is_beyond(&self, time: f64) -> bool {
        [&self.theirs, &self.reference].iter().any(|side| {
            let known = side.horizon.as_ref();
            known.is_some_and(|horizon| horizon.state < horizon.end && time > horizon.state)
        })
    }

    fn hold_lines(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let series = &self.series;
        for digits in HELD {
            let hold = Hold::new(digits, &series.times, &series.gate);
            let line = match (hold.first_below, hold.until) {
                (None, _) => "to the end".to_owned(),
                (Some(_), None) => "nowhere".to_owned(),
                (Some(row), Some(until)) => format!(
                    "until {} s; fewer at {} s, in {}",
                    seconds(until),
                    seconds(series.times[row]),
                    self.column_name(series.gate[row].column)
                ),
            };
            let word = if digits == 1.0 { "digit " } else { "digits" };
            writeln!(f, "{digits:>4} {word} {line}")?;
        }
        Ok(())
    }

    fn least_line(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let series = &self.series;
        let by_digits =
            |a: &usize, b: &usize| series.gate[*a].digits.total_cmp(&series.gate[*b].digits);
        let Some(row) = (0..series.gate.len()).min_by(by_digits) else { return Ok(()) };
        let grade = series.gate[row];
        writeln!(
            f,
            "fewest: {} digits at {} s, in {}",
            grade.told(),
            seconds(series.times[row]),
            self.column_name(grade.column)
        )
    }

    fn event_lines(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Some(events) = &self.events else { return Ok(()) };
        if events.rows.is_empty() {
            return writeln!(f, "\nNeither has events up to there.");
        }
        let first = events.first_unmatched();
        // matches behind that are as often chance as not
        let until = first.map_or(f64::INFINITY, |first| first.time);
        let heads = [
            "events",
            "in both",
            "only theirs",
            "only reference",
            "largest difference (s)",
            "at (s)",
        ];
        let rows = events.rows.iter().map(|row| self.event_cells(row, until)).collect();
        let table = table(heads.map(str::to_owned).to_vec(), rows, 1);
        match first {
            None => writeln!(f, "\nEvents, one to one; each has its like:")?,
            Some(first) => writeln!(
                f,
                "\nEvents, one to one; the first without its like: {} in {} at {} s, only in {}; \
                 differences are those before it:",
                first.kind.replace('_', " "),
                first.owner.name(&self.parts.0),
                seconds(first.time),
                if first.in_theirs { "theirs" } else { "the reference" }
            )?,
        }
        writeln!(f, "{}", table.trim_fmt())
    }

    /// A row of the table of events; differences are those before a time (s).
    fn event_cells(&self, row: &EventRow, until: f64) -> Vec<String> {
        let before = row.pairs.iter().take_while(|pair| pair.time < until);
        let worst = before.max_by(|a, b| a.later().abs().total_cmp(&b.later().abs()));
        vec![
            format!("{} {}", row.owner.name(&self.parts.0), row.kind.replace('_', " ")),
            row.pairs.len().to_string(),
            row.only_theirs.len().to_string(),
            row.only_reference.len().to_string(),
            worst.map_or(String::new(), |pair| format!("{:.1e}", pair.later().abs())),
            worst.map_or(String::new(), |pair| seconds(pair.time)),
        ]
    }
}

/// Which column of another program is which of ours.
fn mapping_lines(side: &Side, f: &mut Formatter<'_>) -> fmt::Result {
    for MappedName { theirs, ours, how, unit } in &side.mapping {
        let how = match how {
            How::Given => "as --map says",
            How::SameName => "the same name",
            How::Guessed => "guessed from the name",
        };
        let unit = in_brackets(unit.unwrap_or_default());
        writeln!(f, "  {ours} is \"{theirs}\"{unit}, {how}")?;
    }
    if !side.unused.is_empty() {
        let shown = side.unused.iter().take(MOST_NAMES);
        let mut names: Vec<String> = shown.map(|name| format!("\"{name}\"")).collect();
        if side.unused.len() > MOST_NAMES {
            names.push(format!("and {} more", side.unused.len() - MOST_NAMES));
        }
        writeln!(f, "  not compared: {}", names.join(", "))?;
    }
    Ok(())
}

/// Cuts samples at the multiples of a round step, into at most [`ROWS`] stretches or so, none
/// empty.
fn stretches(times: &[f64]) -> Vec<Range<usize>> {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Vec::new() };
    let step = round_step((last - first) / ROWS);
    let mut stretches = Vec::new();
    let mut begin = 0;
    while begin < times.len() {
        // a sample on a multiple, give or take its rounding, ends its stretch
        let number = (times[begin] / step - 1e-6).ceil().max(1.0);
        let beyond = |time: &f64| step > 0.0 && *time > (number + 1e-6) * step;
        let end = begin + times[begin..].iter().position(beyond).unwrap_or(times.len() - begin);
        stretches.push(begin..end.max(begin + 1));
        begin = end.max(begin + 1);
    }
    stretches
}

/// The least of 1, 2 and 5 times a power of ten that is no less than this; 0 for 0.
fn round_step(least: f64) -> f64 {
    if least <= 0.0 {
        return 0.0;
    }
    let power = 10_f64.powf(least.log10().floor());
    let round = [1.0, 2.0, 5.0].into_iter().find(|round| round * power >= least * (1.0 - 1e-9));
    round.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_rounded_down() {
        assert_eq!(floor(7.69), "7.6");
        assert_eq!(floor(-0.31), "-0.4");
        assert_eq!(floor(4.3), "4.3");
        assert_eq!(floor(f64::NEG_INFINITY), "no");
    }

    #[test]
    fn times_are_told_to_six_digits() {
        assert_eq!(seconds(4.797980194250892e-4), "0.000479798");
        assert_eq!(seconds(0.06), "0.06");
        assert_eq!(seconds(0.0), "0");
        assert_eq!(seconds(1.25e-7), "1.25e-7");
    }

    #[test]
    fn stretches_end_at_round_times() {
        let times: Vec<f64> = (0..=6000).map(|k| f64::from(k) * 1e-5).collect();
        let ends: Vec<String> =
            stretches(&times).iter().map(|rows| seconds(times[rows.end - 1])).collect();
        assert_eq!(ends[..3], ["0.005", "0.01", "0.015"]);
        assert_eq!(ends.len(), 12);
    }

    #[test]
    fn stretches_cover_every_sample_once() {
        for samples in [1, 2, 11, 12, 13, 241, 4999, 6001] {
            let times: Vec<f64> = (0..samples).map(|k| f64::from(k) * 1e-5).collect();
            let stretches = stretches(&times);
            let lengths: usize = stretches.iter().map(ExactSizeIterator::len).sum();
            assert_eq!(lengths, samples as usize);
            assert!(
                stretches.len() <= ROWS as usize + 1
                    && stretches.windows(2).all(|p| p[0].end == p[1].start)
            );
        }
    }
}
