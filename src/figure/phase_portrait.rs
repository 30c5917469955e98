//! Phase portrait of the penetration: its rate over itself, flight left of zero, contact right.

use super::decimate::Point;
use super::grid::by_run_and_joint;
use super::palette::{BLUE, VERMILLION};
use super::panel::{Axis, Choice, Mark, Panel, range_of, with_room};
use super::quantity::Unit;
use super::runs::{Run, Runs};
use super::svg::Stroke;
use super::text::Text;
use super::touching::{Moment, moments};
use super::{Error, Figures};

/// Draws one figure with a panel for each joint of each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let sheets = by_run_and_joint(runs, 0.8, |run, joint, index| {
        let moments = moments(run, index)?;
        if moments.is_empty() {
            return Ok(None);
        }
        Ok(Some(panel(run, joint, &moments)))
    })?;
    figures.add("phase-portrait", None, "Phase portrait of the penetration", sheets);
    Ok(())
}

fn panel(run: &Run, joint: &str, moments: &[Moment]) -> Panel {
    let axis = |title: Text, unit: &str, value: fn(&Moment) -> f64| {
        let range = with_room(range_of(moments.iter().map(value)));
        let unit = Unit::fitting(unit, range[0].abs().max(range[1].abs()));
        Axis { title, unit, range, ticks: Choice::Decimal }
    };
    let points: Vec<Point> = moments.iter().map(|moment| [moment.depth, moment.rate]).collect();
    let marks = vec![
        Mark::Upright(0.0, Stroke::solid(VERMILLION, 0.5)),
        Mark::Path(points, Stroke::solid(BLUE, 0.4)),
    ];
    Panel {
        label: Text::roman(format!("{}, {joint}", run.name)),
        legend: Vec::new(),
        x: axis(Text::roman("Penetration, ").and_italic("δ"), "m", |moment| moment.depth),
        y: axis(
            Text::roman("Rate, d").and_italic("δ").and("/d").and_italic("t"),
            "m/s",
            |moment| moment.rate,
        ),
        marks,
    }
}
