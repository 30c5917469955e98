//! Torque of each drive over time (the paper's figure 6).

use super::over_time::{Curve, stack, time_axis};
use super::runs::{Run, Runs};
use super::text::Text;
use super::{Error, Figures};
use crate::mechanism::Measure;
use crate::record::Dimension;

/// Draws a figure for each drive.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    for drive in runs.names(Dimension::Drive) {
        let mut curves = Vec::new();
        for run in runs.shown() {
            curves.extend(torque(run, drive)?);
        }
        let ideal = runs.ideal().map(|run| torque(run, drive)).transpose()?.flatten();
        let title = format!("Torque of drive {drive}");
        let axis = Text::roman("Torque, ").and_italic("T");
        let sheets =
            stack(figures.options.overlay, &x, &axis, "N m", drive, &curves, ideal.as_ref());
        figures.add("torque", Some(drive), &title, sheets);
    }
    Ok(())
}

fn torque(run: &Run, drive: &str) -> Result<Option<Curve>, Error> {
    let Some(index) = run.index(Dimension::Drive, drive) else { return Ok(None) };
    let values = run.samples("drive_torque")?.column(index);
    Ok(Some(Curve::of_measure(run, values, Measure::DriveTorque, index)))
}
