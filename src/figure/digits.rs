//! Digits over time, where a file has them: those certified of the reference, those of the run that
//! was held against it or that its companion estimates, and those that errors of double precision
//! leave.

use super::over_time::{Curve, MOST_PANELS, column, time_axis};
use super::palette::{BLACK, BLUE, GREEN, VERMILLION};
use super::panel::{Axis, Choice, Mark, Panel, Sample, range_of};
use super::quantity::Unit;
use super::runs::Runs;
use super::svg::Stroke;
use super::text::Text;
use super::{Error, Figures};

/// The curves: dataset, words, stroke.
const CURVES: [(&str, &str, Stroke); 5] = [
    ("reference_digits", "reference", Stroke::solid(BLACK, 1.0)),
    ("run_digits", "run", Stroke::solid(BLUE, 0.7)),
    ("estimated_digits", "run, estimated", Stroke::solid(BLUE, 1.0)),
    ("estimated_digits_forces", "its forces, estimated", Stroke::solid(GREEN, 0.6)),
    ("digits_left", "left to double precision", Stroke::dashed(VERMILLION, 0.9)),
];

/// Draws a figure if some file has digits.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    let mut panels = Vec::new();
    for run in runs.shown() {
        let mut curves = Vec::new();
        for (dataset, words, stroke) in CURVES {
            let Some(values) = run.optional_column(dataset)? else { continue };
            let curve = Curve::of(run, values.into_iter().map(none_below_zero).collect());
            curves.push((words, stroke, curve));
        }
        if !curves.is_empty() {
            panels.push(panel(&run.name, &x, curves));
        }
    }
    let sheets = panels.chunks(MOST_PANELS).map(|panels| column(panels.to_vec()));
    figures.add("digits", None, "True digits", sheets.collect());
    Ok(())
}

/// Fewer than no digits are none; what is no number stays so.
fn none_below_zero(digits: f64) -> f64 {
    if digits < 0.0 { 0.0 } else { digits }
}

fn panel(run: &str, x: &Axis, curves: Vec<(&str, Stroke, Curve)>) -> Panel {
    let values = curves.iter().flat_map(|(_, _, curve)| &curve.points).map(|point| point[1]);
    let [_, high] = range_of(values).unwrap_or([0.0, 16.0]);
    let y = Axis {
        title: Text::roman("True digits"),
        unit: Unit::one(),
        range: [0.0, high.max(1.0) * 1.05],
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
