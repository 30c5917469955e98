//! Path of the journal's centre in the circle of the clearance; where it hardly leaves that circle,
//! a piece of it enlarged.

use super::decimate::Point;
use super::flattened::{FLAT, usual};
use super::grid::{by_run_and_journal, tell_once};
use super::inset::{INSET, Inset, pieces, round_down};
use super::over_time::beyond_path;
use super::palette::{BEYOND_PATH, BLACK, BLUE};
use super::panel::{Axis, Choice, Mark, Panel};
use super::quantity::Unit;
use super::runs::{Run, Runs};
use super::svg::Stroke;
use super::text::Text;
use super::touching::{Knot, cubic, history};
use super::{Error, Figures};

/// Draws one figure with a panel for each joint of each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let mut sheets = by_run_and_journal(runs, 1.0, |run, joint, index| {
        let Path { times, points: path, known } = path(run, index)?;
        let mut marks = Vec::new();
        if known < path.len() {
            // the line between them belongs to what is beyond
            let beyond = path[known.saturating_sub(1)..].to_vec();
            marks.push(Mark::Path(beyond, Stroke::solid(BEYOND_PATH, 0.4)));
        }
        marks.push(Mark::Path(path[..known].to_vec(), Stroke::solid(BLUE, 0.4)));
        let mut panel = in_the_circle(run, joint, index, &path, marks)?;
        if let Some(radial) = run.radial_clearance(index)? {
            let inset = enlarged(&times, &path, radial, &panel);
            panel.marks.extend(inset.map(Mark::Inset));
        }
        panel.legend.extend((known < path.len()).then(beyond_path));
        Ok(Some(panel))
    })?;
    tell_once(&mut sheets);
    figures.add("journal-path", None, "Path of the journal's centre in its clearance", sheets);
    Ok(())
}

/// The way of a journal.
struct Path {
    /// Times of its points (s).
    times: Vec<f64>,
    /// Centre of the journal relative to that of the bearing (m).
    points: Vec<Point>,
    /// Number of points before the horizon.
    known: usize,
}

/// Where the journal is at all samples, and as often between them as a smooth curve needs: its
/// distance is that of the clearance's history, its direction that of a cubic through the samples.
fn path(run: &Run, clearance: usize) -> Result<Path, Error> {
    let x = run.samples("clearance_x")?.column(clearance);
    let y = run.samples("clearance_y")?.column(clearance);
    let ends = run.state_ends().unwrap_or(f64::INFINITY);
    let Some(radial) = run.radial_clearance(clearance)? else {
        let known = run.times.partition_point(|time| *time <= ends);
        let points = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
        return Ok(Path { times: run.times.clone(), points, known });
    };
    let (mut times, mut points, mut known) = (Vec::new(), Vec::new(), 0);
    let mut sample = 0;
    for moment in history(run, clearance)? {
        known += usize::from(moment.time <= ends);
        times.push(moment.time);
        while run.times.get(sample + 1).is_some_and(|next| *next <= moment.time) {
            sample += 1;
        }
        if run.times[sample] == moment.time {
            points.push([x[sample], y[sample]]);
            continue;
        }
        let [x, y] = [&x, &y].map(|values| through(&run.times, values, sample, moment.time));
        let scale = (radial + moment.depth) / x.hypot(y);
        points.push([scale * x, scale * y]);
    }
    Ok(Path { times, points, known })
}

/// Share of the panel below which nothing is enlarged: rounding errors.
const NOTHING: f64 = 1e-7;
/// What is enlarged reaches so many times as far as the journal is usually off the wall.
const REACH: f64 = 2.5;

/// A piece of the wall with the path beside it, where the path is usually nearer to the wall than
/// anybody could see; the whole circle, where that is small beside the path's excursions.
fn enlarged(times: &[f64], path: &[Point], radial: f64, panel: &Panel) -> Option<Inset> {
    let far = panel.x.range[1];
    let off = |[x, y]: Point| (x.hypot(y) - radial).abs();
    let weighted = path.iter().zip(times.windows(2)).map(|(p, t)| (off(*p), t[1] - t[0]));
    let spread = usual(weighted).filter(|off| FLAT * off < far && *off > NOTHING * far)?;
    let whole = REACH * spread > radial;
    let (centre, half) = match whole {
        true => ([0.0; 2], 1.2 * (radial + spread)),
        false => {
            let usually = path.iter().copied().filter(|point| off(*point) <= spread);
            let point = usually.max_by(|a, b| off(*a).total_cmp(&off(*b)))?;
            (point, REACH * spread)
        }
    };
    // enlarged by a round number
    let half = INSET * far / round_down(INSET * far / half);
    let away = if whole { 0.55 } else { -0.15 };
    let direction = match centre[0].hypot(centre[1]) {
        0.0 => [0.7; 2],
        distance => centre.map(|value| value / distance),
    };
    Some(Inset {
        centre,
        half,
        place: direction.map(|value| away * far * value),
        marks: pieces(&panel.marks, centre, half),
    })
}

/// Value between sample `k` and the next of a cubic with the slopes of parabolas through three
/// samples each.
fn through(times: &[f64], values: &[f64], k: usize, time: f64) -> f64 {
    let last = times.len() - 1;
    if k == last {
        return values[k];
    }
    let secant = |k: usize| (values[k + 1] - values[k]) / (times[k + 1] - times[k]);
    let slope = |k: usize| {
        if k == 0 || k == last {
            return secant(k.min(last - 1));
        }
        let (before, after) = (times[k] - times[k - 1], times[k + 1] - times[k]);
        (secant(k - 1) * after + secant(k) * before) / (before + after)
    };
    let knot = |k: usize| Knot { time: times[k], value: values[k], slope: slope(k) };
    cubic([knot(k), knot(k + 1)], time).0
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
    marks.extend(radial.map(|radial| Mark::Circle(radial, Stroke::dashed(BLACK, 0.5))));
    let axis = |letter: &str| Axis {
        title: Text::roman("Δ").and_italic(letter),
        unit: Unit::fitting("m", far),
        range: [-far, far],
        ticks: Choice::Decimal,
    };
    let label = Text::roman(format!("{}, {joint}", run.name));
    Ok(Panel { label, legend: Vec::new(), x: axis("x"), y: axis("y"), marks })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_met_between_uneven_samples() {
        let times = [0.0, 1.0, 1.5, 3.0, 4.0];
        let values = times.map(|t| 2.0 - 3.0 * t + 0.5 * t * t);
        for (k, time) in [(1, 1.2), (2, 2.0), (2, 2.9)] {
            let expected = 2.0 - 3.0 * time + 0.5 * time * time;
            let found = through(&times, &values, k, time);
            assert!((found - expected).abs() < 1e-12, "{time}: {found} {expected}");
        }
        assert_eq!(through(&times, &values, 4, 4.5), values[4]);
    }
}
