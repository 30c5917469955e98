//! Clearance vector of each joint over time (the paper's figure 4): its components, and its
//! length, the eccentricity.

use super::over_time::{Curve, MOST_PANELS, beyond, column, time_axis};
use super::palette::{BLUE, GUIDE, RUN, VERMILLION};
use super::panel::{Axis, Mark, Panel, Sample};
use super::runs::{Run, Runs};
use super::sheet::Sheet;
use super::svg::Stroke;
use super::text::Text;
use super::touching::{clearance, history};
use super::{Error, Figures};
use crate::record::Dimension;

/// The component along x.
const ALONG_X: Stroke = Stroke::solid(BLUE, 0.9);
/// The component along y.
const ALONG_Y: Stroke = Stroke::solid(VERMILLION, 0.5);

/// Draws two figures for each joint with clearance.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    for joint in runs.names(Dimension::Clearance) {
        let (mut vectors, mut lengths) = (Vec::new(), Vec::new());
        for run in runs.shown() {
            let Some(index) = clearance(run, joint) else { continue };
            let label = Text::roman(format!("{}, {joint}", run.name));
            vectors.push((label.clone(), components(run, index)?));
            lengths.push((label, eccentricity(run, index)?));
        }
        let difference = |letter: &str| Text::roman("Δ").and_italic(letter);
        let title = difference("x").and(", ").and_text(&difference("y"));
        let legend = vec![
            (Sample::Line(ALONG_X), difference("x")),
            (Sample::Line(ALONG_Y), difference("y")),
        ];
        let words = format!("Clearance vector in {joint}");
        figures.add("clearance-vector", Some(joint), &words, sheets(vectors, &x, &title, legend));
        let title = Text::roman("Eccentricity, ").and_italic("e");
        let words = format!("Eccentricity in {joint}");
        figures.add("eccentricity", Some(joint), &words, sheets(lengths, &x, &title, Vec::new()));
    }
    Ok(())
}

/// Components of the clearance vector, with guides at the radial clearance.
fn components(run: &Run, clearance: usize) -> Result<Vec<Mark>, Error> {
    let radial = run.radial_clearance(clearance)?.into_iter();
    let guides = radial.flat_map(|radial| [-radial, 0.0, radial]);
    let mut marks: Vec<Mark> = run.behind(run.state_ends()).map(Mark::Beyond).into_iter().collect();
    marks.extend(guides.map(|height| Mark::Level(height, GUIDE)));
    for (dataset, stroke) in [("clearance_x", ALONG_X), ("clearance_y", ALONG_Y)] {
        let curve = Curve::of(run, run.samples(dataset)?.column(clearance));
        marks.push(Mark::Curve(curve.points, stroke));
    }
    Ok(marks)
}

/// The eccentricity, with a guide at the radial clearance.
fn eccentricity(run: &Run, clearance: usize) -> Result<Vec<Mark>, Error> {
    let Some(radial) = run.radial_clearance(clearance)? else { return Ok(Vec::new()) };
    let history = history(run, clearance)?;
    let points = history.iter().map(|moment| [run.place(moment.time), radial + moment.depth]);
    let curve = Mark::Curve(points.collect(), RUN);
    let beyond = run.behind(run.state_ends()).map(Mark::Beyond);
    let guides = [Mark::Level(radial, GUIDE), Mark::Level(0.0, GUIDE)];
    Ok(beyond.into_iter().chain(guides).chain([curve]).collect())
}

/// Panels under each other whose vertical axes fit them all.
fn sheets(
    panels: Vec<(Text, Vec<Mark>)>,
    x: &Axis,
    title: &Text,
    legend: Vec<(Sample, Text)>,
) -> Vec<Sheet> {
    let heights = panels.iter().flat_map(|(_, marks)| marks).flat_map(Mark::heights);
    let y = Axis::fitting(title.clone(), "m", heights);
    let panel = |(label, marks): &(Text, Vec<Mark>)| Panel {
        label: label.clone(),
        legend: Vec::new(),
        x: x.clone(),
        y: y.clone(),
        marks: marks.clone(),
    };
    let page = |panels: &[(Text, Vec<Mark>)]| {
        let mut panels: Vec<Panel> = panels.iter().map(panel).collect();
        if let Some(first) = panels.first_mut() {
            first.legend = legend.clone();
            let mut marks = panels.iter().flat_map(|panel| &panel.marks);
            let reaches = marks.any(|mark| matches!(mark, Mark::Beyond(_)));
            panels[0].legend.extend(reaches.then(beyond));
        }
        column(panels)
    };
    panels.chunks(MOST_PANELS).map(page).collect()
}
