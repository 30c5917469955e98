//! Phase portrait of the penetration: its rate over itself, flight left of zero, contact right.

use super::decimate::Point;
use super::grid::{by_run_and_joint, tell_once};
use super::over_time::beyond_path;
use super::palette::{BEYOND_PATH, BLUE, GREY};
use super::panel::{Axis, Mark, Panel};
use super::runs::{Run, Runs};
use super::svg::Stroke;
use super::text::Text;
use super::touching::{Moment, history};
use super::{Error, Figures};

/// Draws one figure with a panel for each joint of each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let mut sheets = by_run_and_joint(runs, 0.8, |run, joint, index| {
        Ok(Some(panel(run, joint, &history(run, index)?)))
    })?;
    tell_once(&mut sheets);
    figures.add("phase-portrait", None, "Phase portrait of the penetration", sheets);
    Ok(())
}

fn panel(run: &Run, joint: &str, moments: &[Moment]) -> Panel {
    let axis = |title: Text, unit: &str, value: fn(&Moment) -> f64| {
        Axis::fitting(title, unit, moments.iter().map(value))
    };
    let points: Vec<Point> = moments.iter().map(|moment| [moment.depth, moment.rate]).collect();
    let ends = run.state_ends().unwrap_or(f64::INFINITY);
    let known = moments.partition_point(|moment| moment.time <= ends);
    let mut marks = vec![Mark::Upright(0.0, Stroke::solid(GREY, 0.5))];
    if known < points.len() {
        let beyond = points[known.saturating_sub(1)..].to_vec();
        marks.push(Mark::Path(beyond, Stroke::solid(BEYOND_PATH, 0.4)));
    }
    marks.push(Mark::Path(points[..known].to_vec(), Stroke::solid(BLUE, 0.4)));
    let rate = Text::roman("Rate, d").and_italic("δ").and("/d").and_italic("t");
    Panel {
        label: Text::roman(format!("{}, {joint}", run.name)),
        legend: (known < moments.len()).then(beyond_path).into_iter().collect(),
        x: axis(Text::roman("Penetration, ").and_italic("δ"), "m", |moment| moment.depth),
        y: axis(rate, "m/s", |moment| moment.rate),
        marks,
    }
}
