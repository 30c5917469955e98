//! Poincaré section: where the journals' centres are whenever a drive passes an angle.

use super::decimate::Point;
use super::grid::{by_run_and_journal, tell_once};
use super::journal_path::in_the_circle;
use super::palette::{BEYOND_PATH, BLUE};
use super::panel::{Dot, Mark, Sample};
use super::runs::{DriveAngle, Run, Runs, interpolate};
use super::text::Text;
use super::ticks::signed;
use super::{Error, Figures};
use std::f64::consts::TAU;

/// A passage.
const DOT: Dot = Dot { radius: 1.4, colour: BLUE };

/// Passages that may show a pattern; fewer are a few dots.
const PATTERN: usize = 30;

/// A passage beyond the horizon of the run.
const BEYOND_DOT: Dot = Dot { radius: 1.4, colour: BEYOND_PATH };

/// Draws one figure with a panel for each joint of each run that has a drive.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let section = figures.options.section;
    let angle = signed(&format!("{}", (section.to_degrees() * 1e6).round() / 1e6));
    let mut sheets = by_run_and_journal(runs, 1.0, |run, joint, index| {
        let Some(drive) = &run.drive else { return Ok(None) };
        let times = passages(&run.times, drive, section);
        if times.is_empty() {
            return Ok(None);
        }
        let points = at(run, index, &times)?;
        let ends = run.state_ends().unwrap_or(f64::INFINITY);
        let (known, beyond) = points.split_at(times.partition_point(|time| *time <= ends));
        let marks = vec![Mark::Dots(beyond.to_vec(), BEYOND_DOT), Mark::Dots(known.to_vec(), DOT)];
        let mut panel = in_the_circle(run, joint, index, &points, marks)?;
        if !beyond.is_empty() {
            panel.legend = vec![(Sample::Dot(BEYOND_DOT), Text::roman("beyond the horizon"))];
        }
        Ok(Some(panel))
    })?;
    tell_once(&mut sheets);
    for sheet in &mut sheets {
        if let Some(first) = sheet.rows.iter_mut().flatten().flatten().next() {
            let words = Text::italic("φ").and(format!(" = {angle}°"));
            first.legend.insert(0, (Sample::Dot(DOT), words));
        }
        for panel in sheet.rows.iter_mut().flatten().flatten() {
            panel.label = std::mem::take(&mut panel.label).and_text(&too_few(&panel.marks));
        }
    }
    let title = format!("Centres of the journals at drive angle {angle}°");
    figures.add("poincare", None, &title, sheets);
    Ok(())
}

/// Says of a panel with fewer passages than a pattern needs how many there are.
fn too_few(marks: &[Mark]) -> Text {
    let passages = marks.iter().filter_map(|mark| match mark {
        Mark::Dots(points, _) => Some(points.len()),
        _ => None,
    });
    match passages.sum() {
        0 => Text::default(),
        1 => Text::roman(": 1 passage, no pattern yet"),
        few @ 2..PATTERN => Text::roman(format!(": {few} passages, no pattern yet")),
        _ => Text::default(),
    }
}

/// Times at which a drive passes an angle (rad) and the same a number of turns later (s).
fn passages(times: &[f64], drive: &DriveAngle, section: f64) -> Vec<f64> {
    let turns: Vec<f64> = drive.angles.iter().map(|angle| (angle - section) / TAU).collect();
    let mut passages = Vec::new();
    for k in 0..turns.len() {
        // The rounding of an angle at a whole turn must not lose the turn.
        let whole = turns[k].round();
        if (turns[k] - whole).abs() < 1e-12 * whole.abs().max(1.0) {
            passages.push(times[k]);
            continue;
        }
        let Some(next) = turns.get(k + 1) else { continue };
        let nearly_there = (next - next.round()).abs() < 1e-12 * next.abs().max(1.0);
        if turns[k].floor() != next.floor() && !nearly_there {
            let passed = turns[k].floor().max(next.floor());
            passages.push(
                times[k] + (times[k + 1] - times[k]) * (passed - turns[k]) / (next - turns[k]),
            );
        }
    }
    passages
}

/// Centre of the journal relative to that of the bearing at some times (m).
fn at(run: &Run, clearance: usize, times: &[f64]) -> Result<Vec<Point>, Error> {
    let x = run.samples("clearance_x")?.column(clearance);
    let y = run.samples("clearance_y")?.column(clearance);
    let centre = |time: &f64| [&x, &y].map(|values| interpolate(&run.times, values, *time));
    Ok(times.iter().map(centre).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_passes_an_angle_once_a_turn_either_way_round() {
        let times: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 1e-3).collect();
        for (rate, section) in [(30.0, 0.7), (-30.0, 0.7), (30.0, -0.7)] {
            let angles = times.iter().map(|t| rate * t).collect();
            let drive = DriveAngle { name: "crank".to_owned(), angles };
            let found = passages(&times, &drive, section);
            let turns = (-10..10).map(|turn| (section + TAU * f64::from(turn)) / rate);
            let mut expected: Vec<f64> = turns.filter(|t| (0.0..=1.0).contains(t)).collect();
            expected.sort_by(f64::total_cmp);
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            }
        }
    }

    #[test]
    fn passages_at_samples_count_once() {
        let times: Vec<f64> = (0..=40).map(|k| f64::from(k) * 0.25).collect();
        let angles = times.iter().map(|t| TAU * t).collect();
        let drive = DriveAngle { name: "crank".to_owned(), angles };
        let found = passages(&times, &drive, 0.0);
        assert_eq!(found, (0..=10).map(f64::from).collect::<Vec<_>>());
    }
}
