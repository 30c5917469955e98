//! Angular acceleration of each body over time (the paper's figures 7 and 8).

use super::over_time::{Curve, stack, time_axis};
use super::runs::{Run, Runs};
use super::text::Text;
use super::{Error, Figures};
use crate::mechanism::Measure;
use crate::record::Dimension;

/// Share of the largest angular acceleration of all bodies below which a body counts as turning
/// evenly: rounding errors of one that a drive turns at a constant rate.
const EVEN: f64 = 1e-9;

/// Draws a figure for each body that does not turn evenly.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    let mut bodies = Vec::new();
    for body in runs.names(Dimension::Body) {
        let mut curves = Vec::new();
        for run in runs.shown() {
            curves.extend(acceleration(run, body)?);
        }
        bodies.push((body, curves));
    }
    let largest = |curves: &[Curve]| {
        let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point[1].abs());
        values.filter(|value| value.is_finite()).fold(0.0, f64::max)
    };
    let of_all = bodies.iter().map(|(_, curves)| largest(curves)).fold(0.0, f64::max);
    for (body, curves) in bodies.iter().filter(|(_, curves)| largest(curves) > EVEN * of_all) {
        let ideal = runs.ideal().map(|run| acceleration(run, body)).transpose()?.flatten();
        let title = format!("Angular acceleration of {body}");
        let axis = Text::roman("Angular acceleration, ").and_italic("α");
        let sheets =
            stack(figures.options.overlay, &x, &axis, "rad/s^2", body, curves, ideal.as_ref());
        figures.add("angular-acceleration", Some(body), &title, sheets);
    }
    Ok(())
}

fn acceleration(run: &Run, body: &str) -> Result<Option<Curve>, Error> {
    let Some(index) = run.index(Dimension::Body, body) else { return Ok(None) };
    let values = run.samples("angular_acceleration")?.column(index);
    Ok(Some(Curve::of_measure(run, values, Measure::AngularAcceleration, index)))
}
