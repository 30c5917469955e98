//! Offset of a block in its guide against its tilt, in the diamond that the four walls leave.
//!
//! With the ways e_1 … e_4 of the corners towards their walls the block is off the guide's line by
//! (e_1 − e_3)/2, and an end of it is turned off by (e_1 − e_2)/2, half its length times the sine of its
//! tilt. A corner touches where the sum of both, with its signs, is the play.

use super::decimate::Point;
use super::grid::{by_run_and, tell_once};
use super::over_time::beyond_path;
use super::palette::{BEYOND_PATH, BLACK, BLUE};
use super::panel::{Axis, Choice, Mark, Panel};
use super::quantity::Unit;
use super::runs::{Run, Runs};
use super::svg::Stroke;
use super::text::Text;
use super::{Error, Figures};
use crate::record::Dimension;

/// Draws one figure with a panel for each guide of each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let names = runs.names(Dimension::Clearance);
    let firsts: Vec<&str> =
        names.iter().copied().filter(|name| guide(&names, name).is_some()).collect();
    let mut sheets = by_run_and(runs, &firsts, 1.0, |run, first, index| {
        let guide = guide(&names, first).unwrap_or(first);
        panel(run, guide, index).map(Some)
    })?;
    tell_once(&mut sheets);
    figures.add("guide-path", None, "Offset and tilt of the block in its guide", sheets);
    Ok(())
}

/// The joint whose first of four corners this is.
fn guide<'a>(names: &[&str], first: &'a str) -> Option<&'a str> {
    let joint = first.strip_suffix("_1")?;
    let corners = (2..=4).all(|k| names.contains(&&*format!("{joint}_{k}")));
    corners.then_some(joint)
}

fn panel(run: &Run, guide: &str, first: usize) -> Result<Panel, Error> {
    let ways = run.samples("eccentricity")?;
    let [one, two, three] = [0, 1, 2].map(|k| ways.column(first + k));
    let points: Vec<Point> = (0..one.len())
        .map(|row| [0.5 * (one[row] - three[row]), 0.5 * (one[row] - two[row])])
        .collect();
    let ends = run.state_ends().unwrap_or(f64::INFINITY);
    let known = run.times.partition_point(|time| *time <= ends);
    let mut marks = Vec::new();
    if known < points.len() {
        let beyond = points[known.saturating_sub(1)..].to_vec();
        marks.push(Mark::Path(beyond, Stroke::solid(BEYOND_PATH, 0.4)));
    }
    marks.push(Mark::Path(points[..known].to_vec(), Stroke::solid(BLUE, 0.4)));
    let gap = run.radial_clearance(first)?;
    marks.extend(gap.map(|gap| {
        let diamond = vec![[gap, 0.0], [0.0, gap], [-gap, 0.0], [0.0, -gap], [gap, 0.0]];
        Mark::Path(diamond, Stroke::dashed(BLACK, 0.5))
    }));
    let far = points.iter().map(|[x, y]| x.abs().max(y.abs())).filter(|far| far.is_finite());
    let far = far.fold(gap.unwrap_or(0.0), f64::max);
    let far = if far > 0.0 { 1.08 * far } else { 1.0 };
    let axis = |title: Text| Axis {
        title,
        unit: Unit::fitting("m", far),
        range: [-far, far],
        ticks: Choice::Decimal,
    };
    Ok(Panel {
        label: Text::roman(format!("{}, {guide}", run.name)),
        legend: if known < points.len() { vec![beyond_path()] } else { Vec::new() },
        x: axis(Text::roman("offset")),
        y: axis(Text::roman("tilt × half length")),
        marks,
    })
}
