//! Path of the journal's centre in the circle of the clearance.

use super::decimate::Point;
use super::grid::by_run_and_joint;
use super::palette::{BLACK, BLUE};
use super::panel::{Axis, Choice, Mark, Panel};
use super::quantity::Unit;
use super::runs::{Run, Runs};
use super::svg::Stroke;
use super::text::Text;
use super::{Error, Figures};

/// Draws one figure with a panel for each joint of each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let sheets = by_run_and_joint(runs, 1.0, |run, joint, index| {
        let path = path(run, index)?;
        let marks = vec![Mark::Path(path.clone(), Stroke::solid(BLUE, 0.4))];
        in_the_circle(run, joint, index, &path, marks).map(Some)
    })?;
    figures.add("journal-path", None, "Path of the journal's centre in its clearance", sheets);
    Ok(())
}

/// Centre of the journal relative to that of the bearing at all samples (m).
fn path(run: &Run, clearance: usize) -> Result<Vec<Point>, Error> {
    let x = run.samples("clearance_x")?.column(clearance);
    let y = run.samples("clearance_y")?.column(clearance);
    Ok(x.into_iter().zip(y).map(|(x, y)| [x, y]).collect())
}

/// A square panel about the circle of the clearance, as wide as some points need.
pub(super) fn in_the_circle(
    run: &Run,
    joint: &str,
    clearance: usize,
    points: &[Point],
    mut marks: Vec<Mark>,
) -> Result<Panel, Error> {
    let radial = run.radial_clearance(clearance)?;
    let far = points.iter().map(|[x, y]| x.abs().max(y.abs())).filter(|far| far.is_finite());
    let far = far.fold(radial.unwrap_or(0.0), f64::max);
    let far = if far > 0.0 { 1.08 * far } else { 1.0 };
    marks.extend(radial.map(|radial| Mark::Circle(radial, Stroke::dashed(BLACK, 0.6))));
    let axis = |letter: &str| Axis {
        title: Text::roman("Δ").and_italic(letter),
        unit: Unit::fitting("m", far),
        range: [-far, far],
        ticks: Choice::Decimal,
    };
    let label = Text::roman(format!("{}, {joint}", run.name));
    Ok(Panel { label, legend: Vec::new(), x: axis("x"), y: axis("y"), marks })
}
