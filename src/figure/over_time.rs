//! Histories: a panel for each run, one under the other, the ideal mechanism dashed in each.

use super::Over;
use super::decimate::Point;
use super::flattened::bends_at;
use super::palette::{BEND, BEYOND, BEYOND_PATH, IDEAL, OVERLAID, RUN};
use super::panel::{Axis, Choice, Mark, Panel, Sample, zero_line};
use super::quantity::Unit;
use super::runs::{Run, Runs};
use super::sheet::{DOUBLE_COLUMN, Height, Sheet};
use super::svg::Stroke;
use super::text::Text;
use crate::mechanism::Measure;

/// Most panels under each other.
pub(super) const MOST_ROWS: usize = 6;
/// Most panels of a page, in two columns.
pub(super) const MOST_PANELS: usize = 2 * MOST_ROWS;

/// A curve and the name of its run.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    /// Name of the run.
    pub run: String,
    /// Its points.
    pub points: Vec<Point>,
    /// Where on the horizontal axis a force of the run means nothing any more.
    pub beyond: Option<[f64; 2]>,
}

impl Curve {
    /// Values at the samples of a run.
    pub fn of(run: &Run, values: Vec<f64>) -> Self {
        let points = run.abscissa().iter().copied().zip(values).map(|(x, y)| [x, y]).collect();
        Curve { run: run.name.clone(), points, beyond: run.behind(run.forces_end()) }
    }

    /// Values at the samples of a run, and the extremes that it found between them of a measure of
    /// this item.
    pub fn of_measure(run: &Run, values: Vec<f64>, measure: Measure, item: usize) -> Self {
        let mut points: Vec<Point> =
            run.times.iter().zip(values).map(|(time, value)| [*time, value]).collect();
        for revolution in &run.revolutions {
            let found =
                [revolution.largest(measure).nth(item), revolution.smallest(measure).nth(item)];
            let found = found.into_iter().flatten().filter(|found| run.shows(found.time));
            points.extend(found.map(|found| [found.time, found.value]));
        }
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let points = points.into_iter().map(|[time, value]| [run.place(time), value]).collect();
        Curve { run: run.name.clone(), points, beyond: run.behind(run.forces_end()) }
    }
}

/// The horizontal axis of histories.
pub(super) fn time_axis(runs: &Runs, over: Over) -> Axis {
    let range = runs.range();
    match over {
        Over::Time => {
            let largest = range[0].abs().max(range[1].abs());
            let unit = Unit::fitting("s", largest);
            let title = Text::roman("Time, ").and_italic("t");
            Axis { title, unit, range, ticks: Choice::Decimal }
        }
        Over::Angle => {
            let title = format!("Angle of drive {}, ", runs.drive().unwrap_or_default());
            let title = Text::roman(title).and_italic("φ");
            Axis { title, unit: Unit::degrees(), range, ticks: Choice::Degrees }
        }
    }
}

/// Panels of one quantity of one part of the mechanism, a run each, with the ideal mechanism's curve
/// in all of them. All have the same axes, so that heights compare; where one curve would flatten
/// another these are logarithmic at their ends. With `overlay` the runs share a panel.
pub(super) fn stack(
    overlay: bool,
    x: &Axis,
    title: &Text,
    unit: &str,
    part: &str,
    curves: &[Curve],
    ideal: Option<&Curve>,
) -> Vec<Sheet> {
    let everything = || curves.iter().chain(ideal);
    let values = everything().flat_map(|curve| &curve.points).map(|point| point[1]);
    let bends = bends_at(everything().map(|curve| curve.points.as_slice()));
    let y = match bends {
        Some(beyond) => Axis::bent(title.clone(), unit, values, beyond),
        None => Axis::fitting(title.clone(), unit, values),
    };
    let panel = |curve: &Curve| {
        let mut marks: Vec<Mark> = curve.beyond.map(Mark::Beyond).into_iter().collect();
        marks.extend(levels(&y));
        marks.push(Mark::Curve(curve.points.clone(), RUN));
        marks.extend(ideal.map(|ideal| Mark::Curve(ideal.points.clone(), IDEAL)));
        Panel {
            label: Text::roman(format!("{}, {part}", curve.run)),
            legend: Vec::new(),
            x: x.clone(),
            y: y.clone(),
            marks,
        }
    };
    let legend = ideal.map(|ideal| (Sample::Line(IDEAL), Text::roman(&ideal.run)));
    if overlay && curves.len() > 1 {
        let page = |curves: &[Curve]| {
            let mut panel = overlaid(x, &y, part, curves, ideal);
            panel.legend.extend(bends.map(|beyond| bend(beyond, &y.unit)));
            column(vec![panel])
        };
        return curves.chunks(OVERLAID.len()).map(page).collect();
    }
    let page = |curves: &[Curve]| {
        let mut panels: Vec<Panel> = curves.iter().map(panel).collect();
        if let Some(first) = panels.first_mut() {
            first.legend = legend.clone().into_iter().collect();
            first.legend.extend(curves.iter().find_map(|curve| curve.beyond).map(|_| beyond()));
            first.legend.extend(bends.map(|beyond| bend(beyond, &y.unit)));
        }
        column(panels)
    };
    curves.chunks(MOST_PANELS).map(page).collect()
}

/// A panel with the curves of several runs; the first lies on top. Grey is what lies beyond the
/// horizon of any of them.
fn overlaid(x: &Axis, y: &Axis, part: &str, curves: &[Curve], ideal: Option<&Curve>) -> Panel {
    let of_runs: Vec<(&Curve, Stroke)> = curves.iter().zip(OVERLAID).collect();
    let all = || of_runs.iter().copied().chain(ideal.map(|ideal| (ideal, IDEAL)));
    let mut marks: Vec<Mark> =
        curves.iter().filter_map(|curve| curve.beyond).map(Mark::Beyond).collect();
    let grey = (!marks.is_empty()).then(beyond);
    marks.extend(levels(y));
    let drawn = of_runs.iter().rev().copied().chain(ideal.map(|ideal| (ideal, IDEAL)));
    marks.extend(drawn.map(|(curve, stroke)| Mark::Curve(curve.points.clone(), stroke)));
    let lines = all().map(|(c, stroke)| (Sample::Line(stroke), Text::roman(&c.run)));
    Panel {
        label: Text::roman(part),
        legend: lines.chain(grey).collect(),
        x: x.clone(),
        y: y.clone(),
        marks,
    }
}

/// Lines at zero, and where an axis goes from linear to logarithmic.
fn levels(y: &Axis) -> Vec<Mark> {
    let mut marks: Vec<Mark> = zero_line(y.range).into_iter().collect();
    if let Choice::Bent(beyond) = y.ticks {
        let inside = |height: &f64| y.range[0] < *height && *height < y.range[1];
        let bends = [-beyond, beyond].into_iter().filter(inside);
        marks.extend(bends.map(|height| Mark::Level(height, BEND)));
    }
    marks
}

/// The entry of a legend that says where an axis goes from linear to logarithmic.
fn bend(beyond: f64, unit: &Unit) -> (Sample, Text) {
    let value = (beyond / unit.size * 1e9).round() / 1e9;
    (Sample::Line(BEND), unit.after(&format!("logarithmic beyond ±{value}")))
}

/// The entry of a legend for what lies beyond the horizon of a run.
pub(super) fn beyond() -> (Sample, Text) {
    (Sample::Bar(BEYOND), Text::roman("beyond the horizon"))
}

/// The same for paths and points.
pub(super) fn beyond_path() -> (Sample, Text) {
    (Sample::Line(Stroke::solid(BEYOND_PATH, 0.9)), Text::roman("beyond the horizon"))
}

/// Panels under each other over one horizontal axis; in two columns if one would be too tall.
pub(super) fn column(mut panels: Vec<Panel>) -> Sheet {
    letter(panels.iter_mut());
    let height = if panels.len() == 1 { 140.0 } else { 85.0 };
    let rows = panels.len().div_ceil(if panels.len() > MOST_ROWS { 2 } else { 1 });
    let mut places: Vec<Vec<Option<Panel>>> = vec![Vec::new(); rows];
    for (k, panel) in panels.into_iter().enumerate() {
        places[k % rows].push(Some(panel));
    }
    Sheet {
        width: DOUBLE_COLUMN,
        heights: vec![Height::Points(height); rows],
        rows: places,
        shared_x: true,
    }
}

/// Puts (a), (b), (c) before the labels of several panels.
pub(super) fn letter<'a>(panels: impl ExactSizeIterator<Item = &'a mut Panel>) {
    if panels.len() < 2 {
        return;
    }
    for (panel, letter) in panels.zip('a'..='z') {
        panel.label = Text::roman(format!("({letter})  ")).and_text(&panel.label);
    }
}
