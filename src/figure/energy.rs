//! Energy balance of each run: its parts, and what the balance is off by.

use super::over_time::{Curve, beyond, column, time_axis};
use super::palette::{BLACK, BLUE, GREEN, ORANGE, PURPLE, RUN, VERMILLION};
use super::panel::{Axis, Mark, Panel, Sample, range_of, zero_line};
use super::runs::{Run, Runs};
use super::svg::Stroke;
use super::text::Text;
use super::{Error, Figures};

/// The parts of the balance: dataset, words, stroke.
const PARTS: [(&str, &str, Stroke); 6] = [
    ("energy_kinetic", "kinetic", Stroke::solid(BLUE, 0.6)),
    ("energy_potential", "potential", Stroke::solid(GREEN, 1.1)),
    ("energy_elastic", "elastic", Stroke::solid(ORANGE, 0.5)),
    ("energy_dissipated", "dissipated", Stroke::solid(VERMILLION, 1.2)),
    ("drive_work", "drive work", Stroke::dashed(BLACK, 0.8)),
    ("load_work", "load work", Stroke::dashed(PURPLE, 0.8)),
];

/// Draws a figure for each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    let several = runs.shown().count() > 1;
    for run in runs.shown() {
        let parts = parts(run, &x)?;
        let residual = residual(run, &x)?;
        let title = format!("Energy balance of {}", run.name);
        let item = several.then_some(run.name.as_str());
        figures.add("energy", item, &title, vec![column(vec![parts, residual])]);
    }
    Ok(())
}

/// The parts that are not zero throughout.
fn parts(run: &Run, x: &Axis) -> Result<Panel, Error> {
    let (mut marks, mut legend, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    for (dataset, words, stroke) in PARTS {
        let values = run.samples(dataset)?.column(0);
        let Some(range) = range_of(values.iter().copied()).filter(|range| *range != [0.0; 2])
        else {
            continue;
        };
        ends.extend(range);
        marks.push(Mark::Curve(Curve::of(run, values).points, stroke));
        legend.push((Sample::Line(stroke), Text::roman(words)));
    }
    let y = Axis::fitting(Text::roman("Energy, ").and_italic("E"), "J", ends);
    marks.splice(0..0, zero_line(y.range));
    if let Some(places) = run.behind(run.state_ends()) {
        marks.insert(0, Mark::Beyond(places));
        legend.push(beyond());
    }
    Ok(Panel { label: Text::roman(&run.name), legend, x: x.clone(), y, marks })
}

fn residual(run: &Run, x: &Axis) -> Result<Panel, Error> {
    let values = run.samples("energy_residual")?.column(0);
    let y = Axis::fitting(Text::roman("Residual"), "J", values.iter().copied());
    let mut marks: Vec<Mark> = zero_line(y.range).into_iter().collect();
    marks.push(Mark::Curve(Curve::of(run, values).points, RUN));
    Ok(Panel {
        label: Text::roman("residual of the balance"),
        legend: Vec::new(),
        x: x.clone(),
        y,
        marks,
    })
}
