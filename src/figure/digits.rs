//! Certified digits over time, where a file has them: those of the reference, and those of the run
//! that was held against it.

use super::over_time::{Curve, column, time_axis};
use super::palette::{BLACK, BLUE};
use super::panel::{Axis, Choice, Mark, Panel, Sample, range_of};
use super::quantity::Unit;
use super::runs::Runs;
use super::svg::Stroke;
use super::text::Text;
use super::{Error, Figures};

/// The curves: dataset, words, stroke.
const CURVES: [(&str, &str, Stroke); 2] = [
    ("reference_digits", "reference", Stroke::solid(BLACK, 1.0)),
    ("run_digits", "run", Stroke::solid(BLUE, 0.7)),
];

/// Draws a figure if some file has digits.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    let mut panels = Vec::new();
    for run in runs.shown() {
        let mut curves = Vec::new();
        for (dataset, words, stroke) in CURVES {
            let curve = run.optional_column(dataset)?.map(|values| Curve::of(run, values));
            curves.extend(curve.map(|curve| (words, stroke, curve)));
        }
        if !curves.is_empty() {
            panels.push(panel(&run.name, &x, curves));
        }
    }
    let sheets = panels.chunks(super::over_time::MOST_ROWS).map(|panels| column(panels.to_vec()));
    figures.add("digits", None, "Certified digits", sheets.collect());
    Ok(())
}

fn panel(run: &str, x: &Axis, curves: Vec<(&str, Stroke, Curve)>) -> Panel {
    let values = curves.iter().flat_map(|(_, _, curve)| &curve.points).map(|point| point[1]);
    let [low, high] = range_of(values).unwrap_or([0.0, 16.0]);
    let y = Axis {
        title: Text::roman("Certified digits"),
        unit: Unit::one(),
        range: [low.min(0.0), high.max(1.0) * 1.05],
        ticks: Choice::Decimal,
    };
    let legend =
        curves.iter().map(|(words, stroke, _)| (Sample::Line(*stroke), Text::roman(*words)));
    Panel {
        label: Text::roman(run),
        legend: legend.collect(),
        x: x.clone(),
        y,
        marks: curves
            .into_iter()
            .map(|(_, stroke, curve)| Mark::Curve(curve.points, stroke))
            .collect(),
    }
}
