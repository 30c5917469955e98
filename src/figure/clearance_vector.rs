//! Clearance vector of each joint over time (the paper's figure 4): its components and its length,
//! the eccentricity.

use super::over_time::{Curve, MOST_ROWS, column, time_axis};
use super::palette::{BLACK, BLUE, GUIDE, VERMILLION};
use super::panel::{Axis, Choice, Mark, Panel, Sample, range_of, with_room};
use super::quantity::Unit;
use super::runs::{Run, Runs};
use super::sheet::Sheet;
use super::svg::Stroke;
use super::text::Text;
use super::touching::clearance;
use super::{Error, Figures};
use crate::record::Dimension;

/// The curves: dataset, letters, stroke.
fn curves() -> [(&'static str, Text, Stroke); 3] {
    [
        ("clearance_x", Text::roman("Δ").and_italic("x"), Stroke::solid(BLUE, 0.8)),
        ("clearance_y", Text::roman("Δ").and_italic("y"), Stroke::solid(VERMILLION, 0.5)),
        ("eccentricity", Text::italic("e"), Stroke::solid(BLACK, 0.4)),
    ]
}

/// Draws a figure for each joint with clearance.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    for joint in runs.names(Dimension::Clearance) {
        let mut panels = Vec::new();
        for run in runs.shown() {
            panels.extend(panel(run, joint, &x)?);
        }
        share_heights(&mut panels);
        let title = format!("Clearance vector in {joint}");
        figures.add("clearance-vector", Some(joint), &title, pages(&panels));
    }
    Ok(())
}

fn pages(panels: &[Panel]) -> Vec<Sheet> {
    let page = |panels: &[Panel]| {
        let mut panels = panels.to_vec();
        if let Some(first) = panels.first_mut() {
            let entries = curves().map(|(_, words, stroke)| (Sample::Line(stroke), words));
            first.legend = entries.to_vec();
        }
        column(panels)
    };
    panels.chunks(MOST_ROWS).map(page).collect()
}

fn panel(run: &Run, joint: &str, x: &Axis) -> Result<Option<Panel>, Error> {
    let Some(index) = clearance(run, joint) else { return Ok(None) };
    let mut marks = Vec::new();
    if let Some(radial) = run.radial_clearance(index)? {
        marks = [-radial, 0.0, radial].map(|height| Mark::Level(height, GUIDE)).to_vec();
    }
    for (dataset, _, stroke) in curves() {
        let curve = Curve::of(run, run.samples(dataset)?.column(index));
        marks.push(Mark::Curve(curve.points, stroke));
    }
    let y = Axis {
        title: Text::roman(format!("Clearance vector in {joint}")),
        unit: Unit::one(),
        range: [0.0, 1.0],
        ticks: Choice::Decimal,
    };
    let label = Text::roman(&run.name);
    Ok(Some(Panel { label, legend: Vec::new(), x: x.clone(), y, marks }))
}

/// Gives all panels the vertical axis that fits them all.
fn share_heights(panels: &mut [Panel]) {
    let heights = panels.iter().flat_map(|panel| &panel.marks).flat_map(|mark| match mark {
        Mark::Curve(points, _) => points.iter().map(|point| point[1]).collect(),
        Mark::Level(height, _) => vec![*height],
        _ => Vec::new(),
    });
    let range = with_room(range_of(heights));
    let unit = Unit::fitting("m", range[0].abs().max(range[1].abs()));
    for panel in panels {
        (panel.y.range, panel.y.unit) = (range, unit.clone());
    }
}
