//! Figures of studies: of the tables in a folder.

mod bifurcation;
mod convergence;
mod exponents;
mod heat_map;
mod histogram;
mod poincare;
mod response;
mod words;

use super::panel::{Axis, Choice, range_of, with_room};
use super::quantity::Unit;
use super::text::Text;
use super::ticks::signed;
use super::{Figure, Figures, Options};
use crate::study::{Error, Recorded, Rows, quantile};

/// What every figure of a study says of itself.
const DESCRIPTION: &str = concat!(
    "Drawn by freeplay ",
    env!("CARGO_PKG_VERSION"),
    " from the tables of a study. Points that cover each other are drawn once."
);

/// Draws all figures that the tables of a study give.
///
/// # Errors
/// What reading the tables meets.
pub fn draw_study(recorded: &Recorded, options: &Options) -> Result<Vec<Figure>, Error> {
    let mut figures = Figures { options, description: DESCRIPTION, drawn: Vec::new() };
    let study = Drawn::of(recorded)?;
    response::draw(&study, &mut figures)?;
    exponents::draw(&study, &mut figures)?;
    convergence::draw(&study, &mut figures)?;
    heat_map::draw(&study, &mut figures)?;
    bifurcation::draw(&study, &mut figures)?;
    poincare::draw(&study, &mut figures)?;
    histogram::draw(&study, &mut figures)?;
    Ok(figures.drawn)
}

/// A study that is drawn.
struct Drawn<'a> {
    recorded: &'a Recorded,
    /// What varies and is a number.
    variables: Vec<Over>,
}

/// A variable to draw over.
struct Over {
    name: String,
    unit: String,
    is_log: bool,
    /// Its different values, in their order.
    values: Vec<f64>,
}

/// Numbers of the runs.
struct Series {
    /// Name of the column.
    name: String,
    unit: String,
    /// By run that has some: its number, its numbers.
    runs: Vec<(u64, Vec<f64>)>,
    /// Whether there is one for each revolution, and not one for each run.
    of_revolutions: bool,
}

impl<'a> Drawn<'a> {
    fn of(recorded: &'a Recorded) -> Result<Self, Error> {
        let mut variables = Vec::new();
        let numbers = recorded.study.variables.iter();
        // copies of an ensemble are told by what they have in common
        let numbers = numbers.filter(|variable| variable.is_number && !variable.is_of_copies());
        for variable in numbers {
            let mut values = recorded.runs.column(&variable.name)?;
            values.retain(|value| value.is_finite());
            values.sort_by(f64::total_cmp);
            values.dedup();
            if values.len() > 1 {
                let (name, unit) = (variable.name.clone(), variable.unit.clone());
                variables.push(Over { name, unit, is_log: variable.is_log, values });
            }
        }
        Ok(Drawn { recorded, variables })
    }

    /// The value of a variable in a run.
    fn value(&self, variable: &Over, run: u64) -> f64 {
        let study = &self.recorded.study;
        let place = study.variables.iter().position(|known| known.name == variable.name);
        let value = place.and_then(|place| study.point(run)[place].number);
        value.unwrap_or(f64::NAN)
    }

    /// What there is of each revolution, and of each run what there is not of each revolution.
    fn series(&self) -> Result<Vec<Series>, Error> {
        let Recorded { runs, revolutions, .. } = self.recorded;
        let mut series = self.series_of(revolutions, "end", true)?;
        let of_runs = self.series_of(runs, "case_sha256", false)?;
        let known: Vec<String> = series.iter().map(|series| series.name.clone()).collect();
        series.extend(of_runs.into_iter().filter(|series| !known.contains(&series.name)));
        Ok(series)
    }

    fn series_of(&self, rows: &Rows, behind: &str, each: bool) -> Result<Vec<Series>, Error> {
        if rows.is_empty() {
            return Ok(Vec::new());
        }
        let first = rows.names().iter().position(|name| name == behind).map_or(0, |k| k + 1);
        let numbers = rows.column("run")?;
        let series = rows.names()[first..].iter().map(|name| {
            let mut runs: Vec<(u64, Vec<f64>)> = Vec::new();
            for (run, value) in numbers.iter().zip(rows.column(name)?) {
                let run = *run as u64;
                match runs.last_mut() {
                    _ if !value.is_finite() => {}
                    Some((last, values)) if *last == run => values.push(value),
                    _ => runs.push((run, vec![value])),
                }
            }
            let unit = rows.unit(name).to_owned();
            Ok(Series { name: name.clone(), unit, runs, of_revolutions: each })
        });
        series.collect()
    }
}

impl Over {
    /// The axis that it is drawn over.
    fn axis(&self) -> Axis {
        let title = words::of_variable(&self.name);
        let [low, high] = [self.values[0], self.values[self.values.len() - 1]];
        if !self.is_log || low <= 0.0 {
            let range = with_room(Some([low, high]));
            // no more room than a frame needs: what varies has ends
            let room = 0.02 * (high - low);
            let range = [range[0].max(low - room), range[1].min(high + room)];
            let unit = fitting(&self.unit, high.abs().max(low.abs()));
            return Axis { title, unit, range, ticks: Choice::Decimal };
        }
        let room = (high / low).powf(0.02);
        let range = [low / room, high * room];
        let decade = 10_f64.powf(range[0].log10().floor());
        let unit = fitting(&self.unit, high);
        Axis { title, unit, range, ticks: Choice::Bent(decade) }
    }

    /// One of its values, to three digits: `0.193 mm`.
    fn told(&self, value: f64) -> Text {
        let largest = self.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let unit = fitting(&self.unit, largest);
        unit.after(&figures(value / unit.size, 3))
    }

    /// The variable with one of its values: `Radial clearance of A = 0.193 mm`.
    fn equals(&self, value: f64) -> Text {
        words::of_variable(&self.name).and(" = ").and_text(&self.told(value))
    }
}

/// A number to so many digits, without zeros behind the last.
fn figures(value: f64, digits: i32) -> String {
    let power = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    let decimals = (digits - 1 - power).clamp(0, 12) as usize;
    let number = format!("{value:.decimals$}");
    let short = match number.contains('.') {
        true => number.trim_end_matches('0').trim_end_matches('.'),
        false => &number,
    };
    signed(short)
}

/// A unit as axes have it, that suits values as large as this one.
fn fitting(unit: &str, largest: f64) -> Unit {
    match unit {
        "1" => Unit::one(),
        // nobody counts thousands of them
        "rpm" => Unit { size: 1.0, text: Text::roman(unit) },
        unit => Unit::fitting(unit, largest),
    }
}

/// The axis of numbers of this unit, with room for all of them.
fn axis(title: Text, unit: &str, values: impl IntoIterator<Item = f64>) -> Axis {
    let range = with_room(range_of(values));
    let unit = fitting(unit, range[0].abs().max(range[1].abs()));
    Axis { title, unit, range, ticks: Choice::Decimal }
}

impl Series {
    /// The axis of its numbers.
    fn axis(&self, values: impl IntoIterator<Item = f64>) -> Axis {
        axis(words::of_number(&self.name), &self.unit, values)
    }
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values
}

/// Some of many runs, evenly chosen.
fn chosen(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|k| k * (count - 1) / (most - 1).max(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_on_the_line_between_their_neighbours() {
        let values = [1.0, 2.0, 4.0, 8.0, 16.0];
        for (share, value) in [(0.0, 1.0), (0.5, 4.0), (0.125, 1.5), (1.0, 16.0)] {
            assert_eq!(quantile(&values, share), value);
        }
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn numbers_are_told_to_as_many_digits_as_they_need() {
        for (value, told) in [(0.193_069_8, "0.1931"), (1000.0, "1000"), (-0.5, "−0.5"), (0.0, "0")]
        {
            assert_eq!(figures(value, 4), told);
        }
    }

    #[test]
    fn the_first_and_the_last_are_among_the_chosen() {
        assert_eq!(chosen(3, 9), [0, 1, 2]);
        assert_eq!(chosen(101, 5), [0, 25, 50, 75, 100]);
    }
}
