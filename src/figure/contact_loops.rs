//! Force over penetration in each contact: the area of a loop is what the contact dissipates.

use super::decimate::{BREAK, Point};
use super::grid::by_run_and_joint;
use super::palette::BLUE;
use super::panel::{Axis, Choice, Mark, Panel, range_of, with_room, zero_line};
use super::quantity::Unit;
use super::runs::{Run, Runs};
use super::svg::Stroke;
use super::text::Text;
use super::touching::{contacts, moments};
use super::{Error, Figures};

/// Draws one figure with a panel for each joint of each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let sheets = by_run_and_joint(runs, 0.8, |run, joint, index| {
        let points = loops(run, index)?;
        Ok((!points.is_empty()).then(|| panel(run, joint, points)))
    })?;
    figures.add("contact-loops", None, "Normal force over penetration in each contact", sheets);
    Ok(())
}

fn loops(run: &Run, clearance: usize) -> Result<Vec<Point>, Error> {
    let moments = moments(run, clearance)?;
    let mut points = Vec::new();
    for contact in contacts(run, clearance) {
        let end = if contact.end.is_nan() { f64::INFINITY } else { contact.end };
        let from = moments.partition_point(|moment| moment.time < contact.begin);
        let until = moments.partition_point(|moment| moment.time <= end);
        points.extend(moments[from..until].iter().map(|moment| [moment.depth, moment.force]));
        points.push(BREAK);
    }
    points.pop();
    Ok(points)
}

fn panel(run: &Run, joint: &str, points: Vec<Point>) -> Panel {
    let axis = |title: Text, unit: &str, index: usize| {
        let range = with_room(range_of(points.iter().map(|point| point[index])));
        let unit = Unit::fitting(unit, range[0].abs().max(range[1].abs()));
        Axis { title, unit, range, ticks: Choice::Decimal }
    };
    let x = axis(Text::roman("Penetration, ").and_italic("δ"), "m", 0);
    let y = axis(Text::roman("Normal force, ").and_italic("F").and_subscript("N"), "N", 1);
    let mut marks: Vec<Mark> = zero_line(y.range).into_iter().collect();
    marks.push(Mark::Path(points, Stroke::solid(BLUE, 0.4)));
    Panel { label: Text::roman(format!("{}, {joint}", run.name)), legend: Vec::new(), x, y, marks }
}
