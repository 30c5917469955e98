//! Histograms: how the peaks of revolutions are spread, of some runs evenly chosen.

use super::bifurcation::is_peak;
use super::{Drawn, Series, chosen};
use crate::figure::Figures;
use crate::figure::palette::OVERLAID;
use crate::figure::panel::{Axis, Choice, Mark, Panel, Sample, range_of};
use crate::figure::quantity::Unit;
use crate::figure::sheet::{Height, SINGLE_COLUMN, Sheet};
use crate::figure::text::Text;
use crate::study::Error;

/// Runs that share a panel.
const MOST: usize = 4;
/// Revolutions of which a histogram tells something.
const LEAST: usize = 30;
/// Bins of a histogram at least and at most.
const BINS: [f64; 2] = [10.0, 60.0];

/// Draws a figure for each peak of revolutions.
pub(super) fn draw(study: &Drawn<'_>, figures: &mut Figures<'_>) -> Result<(), Error> {
    for series in study.series()? {
        let enough: Vec<&(u64, Vec<f64>)> =
            series.runs.iter().filter(|(_, values)| values.len() >= LEAST).collect();
        if !series.of_revolutions || !is_peak(&series.name) || enough.is_empty() {
            continue;
        }
        let runs = chosen(enough.len(), MOST).into_iter().map(|k| enough[k]);
        let panel = panel(study, &series, &runs.collect::<Vec<_>>());
        let title = super::words::of_number(&series.name).plain();
        let title = format!("{title} in a revolution: how it is spread");
        let sheet = Sheet {
            width: SINGLE_COLUMN,
            heights: vec![Height::OfWidth(0.7)],
            rows: vec![vec![Some(panel)]],
            shared_x: false,
        };
        let name = series.name.strip_suffix(".value").unwrap_or(&series.name);
        figures.add("histogram", Some(name), &title, vec![sheet]);
    }
    Ok(())
}

fn panel(study: &Drawn<'_>, series: &Series, runs: &[&(u64, Vec<f64>)]) -> Panel {
    let all = || runs.iter().flat_map(|(_, values)| values.iter().copied());
    let [low, high] = range_of(all()).unwrap_or([0.0, 1.0]);
    let x = series.axis([low, high]);
    let fewest = runs.iter().map(|(_, values)| values.len()).min().unwrap_or(LEAST);
    // as many as the cube root says (Rice), more where several runs share the range
    let bins = (2.0 * (fewest as f64).cbrt() * runs.len() as f64).clamp(BINS[0], BINS[1]).round();
    let [from, to] = [low.min(high - 1e-9 * high.abs()), high];
    let width = ((to - from) / bins).max(f64::MIN_POSITIVE);
    let mut legend = Vec::new();
    let mut marks = Vec::new();
    let mut most: f64 = 0.0;
    for ((run, values), stroke) in runs.iter().zip(OVERLAID) {
        let mut counts = vec![0.0; bins as usize];
        for value in values {
            let place = ((value - from) / width) as usize;
            counts[place.min(bins as usize - 1)] += 1.0 / values.len() as f64;
        }
        most = counts.iter().copied().fold(most, f64::max);
        let mut steps = vec![[from, 0.0]];
        for (k, count) in counts.iter().enumerate() {
            steps.extend([k, k + 1].map(|edge| [from + width * edge as f64, *count]));
        }
        steps.push([to, 0.0]);
        marks.push(Mark::Path(steps, stroke));
        let words = match &study.variables[..] {
            [variable] => variable.told(study.value(variable, *run)),
            _ => Text::roman(format!("run {run}")),
        };
        if runs.len() > 1 {
            legend.push((Sample::Line(stroke), words));
        }
    }
    // the first on top
    marks.reverse();
    let y = Axis {
        title: Text::roman("Share of revolutions"),
        unit: Unit::one(),
        range: [0.0, 1.08 * most.max(1e-9)],
        ticks: Choice::Decimal,
    };
    let label = match &study.variables[..] {
        [variable] if runs.len() > 1 => super::words::of_variable(&variable.name),
        _ => Text::default(),
    };
    Panel { label, legend, x, y, marks }
}
