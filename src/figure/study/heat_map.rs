//! Heat maps: a number of the runs over two variables on a grid; of what each revolution has, the
//! median.

use super::{Drawn, Over, Series, figures as digits, quantile, sorted};
use crate::figure::Figures;
use crate::figure::palette::HEAT;
use crate::figure::panel::{Axis, Mark, Panel, Sample, range_of};
use crate::figure::sheet::{Height, SINGLE_COLUMN, Sheet};
use crate::figure::text::Text;
use crate::study::Error;

/// Colours of the legend.
const TOLD: [usize; 5] = [0, 4, 8, 12, HEAT.len() - 1];

/// The column of the periods of motions (revolutions).
const PERIOD: &str = "attractor.revolutions";
/// Periods that a legend tells at most.
const MOST_PERIODS: usize = 8;

/// Whether a study has a grid of two variables, and nothing else that varies.
pub(super) fn is_for(study: &Drawn<'_>) -> bool {
    let all = &study.recorded.study;
    let [a, b] = &study.variables[..] else { return false };
    all.variables.len() == 2 && (a.values.len() * b.values.len()) as u64 <= all.runs
}

/// Draws a figure for each number.
pub(super) fn draw(study: &Drawn<'_>, figures: &mut Figures<'_>) -> Result<(), Error> {
    if !is_for(study) {
        return Ok(());
    }
    for series in study.series()?.iter().filter(|series| !series.runs.is_empty()) {
        let Some(panel) = panel(study, series) else { continue };
        let words = super::words::of_number(&series.name).plain();
        let [a, b] = [0, 1].map(|k| super::words::in_a_sentence(&study.variables[k].name));
        let title = format!("{words} over {a} and {b}");
        let sheet = Sheet {
            width: SINGLE_COLUMN,
            heights: vec![Height::OfWidth(0.8)],
            rows: vec![vec![Some(panel)]],
            shared_x: false,
        };
        let name = series.name.strip_suffix(".value").unwrap_or(&series.name);
        figures.add("heat-map", Some(name), &title, vec![sheet]);
    }
    Ok(())
}

fn panel(study: &Drawn<'_>, series: &Series) -> Option<Panel> {
    let [across, up] = &study.variables[..] else { return None };
    let values: Vec<(u64, f64)> = (series.runs.iter())
        .map(|(run, values)| (*run, quantile(&sorted(values), 0.5)))
        .filter(|(_, value)| value.is_finite())
        .collect();
    if series.name == PERIOD {
        return Some(basins(study, values));
    }
    let [low, high] = range_of(values.iter().map(|(_, value)| *value))?;
    let span = if high > low { high - low } else { 1.0 };
    let shade =
        |value: f64| (((value - low) / span * HEAT.len() as f64) as usize).min(HEAT.len() - 1);
    let mut cells = vec![Vec::new(); HEAT.len()];
    for (run, value) in &values {
        cells[shade(*value)].push(cell(study, *run));
    }
    let marks = cells.into_iter().zip(HEAT).filter(|(cells, _)| !cells.is_empty());
    let marks = marks.map(|(cells, colour)| Mark::Field(cells, colour)).collect();
    let numbers = series.axis([low, high]);
    let legend = TOLD.map(|k| {
        // the first and the last colour tell the ends
        let value = low + (high - low) * k as f64 / (HEAT.len() - 1) as f64;
        (Sample::Bar(HEAT[k]), Text::roman(digits(value / numbers.unit.size, 3)))
    });
    let [x, y] = [across, up].map(cells_axis);
    Some(Panel { label: numbers.full_title(), legend: legend.to_vec(), x, y, marks })
}

/// Where motions end: a colour for each period that there is, in their order.
fn basins(study: &Drawn<'_>, periods: Vec<(u64, f64)>) -> Panel {
    let mut known: Vec<f64> = periods.iter().map(|(_, period)| *period).collect();
    known.sort_by(f64::total_cmp);
    known.dedup();
    let last = (known.len() - 1).max(1);
    let mut marks = Vec::new();
    let mut legend = Vec::new();
    for (k, period) in known.iter().enumerate() {
        let colour = HEAT[k * (HEAT.len() - 1) / last];
        let its = periods.iter().filter(|(_, of)| of == period);
        marks.push(Mark::Field(its.map(|(run, _)| cell(study, *run)).collect(), colour));
        let told = if *period == 0.0 { "none".to_owned() } else { digits(*period, 4) };
        legend.push((Sample::Bar(colour), Text::roman(told)));
    }
    // several periods that nobody could tell apart in a legend: the shortest and the longest
    if legend.len() > MOST_PERIODS {
        let longest = legend.split_off(legend.len() - 1);
        legend.truncate(MOST_PERIODS - 1);
        legend.extend(longest);
    }
    let [x, y] = [0, 1].map(|k| cells_axis(&study.variables[k]));
    Panel { label: super::words::of_number(PERIOD), legend, x, y, marks }
}

/// The cell of a run.
fn cell(study: &Drawn<'_>, run: u64) -> [[f64; 2]; 2] {
    let [x, y] = [0, 1].map(|k| edges(&study.variables[k], study.value(&study.variables[k], run)));
    [[x[0], y[1]], [x[1], y[0]]]
}

/// The axis of a variable whose cells fill the panel.
fn cells_axis(variable: &Over) -> Axis {
    let [first, last] = [0, variable.values.len() - 1].map(|k| edges(variable, variable.values[k]));
    Axis { range: [first[0], last[1]], ..variable.axis() }
}

/// The ends of the cell of a value: half way to its neighbours.
fn edges(variable: &Over, value: f64) -> [f64; 2] {
    let to = |x: f64| if variable.is_log { x.ln() } else { x };
    let from = |x: f64| if variable.is_log { x.exp() } else { x };
    let values = &variable.values;
    let place = values.partition_point(|known| *known < value).min(values.len() - 1);
    let here = to(values[place]);
    let before = place.checked_sub(1).map(|k| here - to(values[k]));
    let behind = values.get(place + 1).map(|next| to(*next) - here);
    let [before, behind] =
        [before.or(behind), behind.or(before)].map(|half| half.unwrap_or(1.0) / 2.0);
    [from(here - before), from(here + behind)]
}
