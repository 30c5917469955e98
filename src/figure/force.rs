//! Force in each joint over time (the paper's figure 5): the normal force where the joint has
//! clearance, the length of the joint's force where it is ideal.

use super::over_time::{Curve, stack, time_axis};
use super::runs::{Run, Runs};
use super::text::Text;
use super::touching::{clearance, normal_force};
use super::{Error, Figures};
use crate::mechanism::Measure;
use crate::record::Dimension;

/// Draws a figure for each joint.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    for joint in runs.names(Dimension::Joint) {
        let mut curves = Vec::new();
        let mut touches = false;
        for run in runs.shown() {
            touches |= clearance(run, joint).is_some();
            curves.extend(force(run, joint)?);
        }
        let ideal = runs.ideal().map(|run| force(run, joint)).transpose()?.flatten();
        let (words, symbol) = if touches {
            ("Normal force", Text::italic("F").and_subscript("N"))
        } else {
            ("Force", Text::italic("F"))
        };
        let title = format!("{words} in {joint}");
        let axis = Text::roman(format!("{words}, ")).and_text(&symbol);
        let sheets = stack(figures.options.overlay, &x, &axis, "N", joint, &curves, ideal.as_ref());
        figures.add("force", Some(joint), &title, sheets);
    }
    Ok(())
}

fn force(run: &Run, joint: &str) -> Result<Option<Curve>, Error> {
    if let Some(clearance) = clearance(run, joint) {
        let points = normal_force(run, clearance)?;
        let beyond = run.behind(run.forces_end());
        return Ok(Some(Curve { run: run.name.clone(), points, beyond }));
    }
    let Some(index) = run.index(Dimension::Joint, joint) else { return Ok(None) };
    let x = run.samples("joint_force_x")?.column(index);
    let y = run.samples("joint_force_y")?.column(index);
    let lengths = x.into_iter().zip(y).map(|(x, y)| x.hypot(y)).collect();
    Ok(Some(Curve::of_measure(run, lengths, Measure::JointForce, index)))
}
