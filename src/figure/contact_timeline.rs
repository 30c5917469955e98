//! Timeline of flight and contact, a row for each joint with clearance.

use super::over_time::{MOST_ROWS, beyond, letter, time_axis};
use super::palette::BLUE;
use super::panel::{Axis, Choice, Mark, Panel, Sample};
use super::quantity::Unit;
use super::runs::{Run, Runs};
use super::sheet::{DOUBLE_COLUMN, Height, Sheet};
use super::text::Text;
use super::touching::contacts;
use super::{Error, Figures};
use crate::record::Dimension;

/// Height of a row (pt).
const ROW: f64 = 15.0;

/// Draws one figure with a panel for each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    let with_clearance = runs.shown().filter(|run| !run.is_ideal());
    let panels: Vec<(usize, Panel)> = with_clearance.map(|run| panel(run, &x)).collect();
    let sheets = panels.chunks(MOST_ROWS).map(page).collect();
    figures.add("contact-timeline", None, "Flight and contact of each joint", sheets);
    Ok(())
}

fn page(panels: &[(usize, Panel)]) -> Sheet {
    let heights = panels.iter().map(|(joints, _)| Height::Points(ROW * *joints as f64)).collect();
    let mut panels: Vec<Panel> = panels.iter().map(|(_, panel)| panel.clone()).collect();
    letter(panels.iter_mut());
    if let Some(first) = panels.first_mut() {
        first.legend = vec![(Sample::Bar(BLUE), Text::roman("contact"))];
        let mut marks = panels.iter().flat_map(|panel| &panel.marks);
        let reaches = marks.any(|mark| matches!(mark, Mark::Beyond(_)));
        panels[0].legend.extend(reaches.then(beyond));
    }
    let rows = panels.into_iter().map(|panel| vec![Some(panel)]).collect();
    Sheet { width: DOUBLE_COLUMN, rows, heights, shared_x: true }
}

fn panel(run: &Run, x: &Axis) -> (usize, Panel) {
    let joints = run.names(Dimension::Clearance);
    let last = run.times.last().copied().unwrap_or_default();
    let first = run.times.first().copied().unwrap_or_default();
    let bars = |clearance: usize| {
        let bars = contacts(run, clearance).into_iter().map(|contact| {
            let end = if contact.end.is_nan() { last } else { contact.end };
            [contact.begin.max(first), end.min(last)]
        });
        let shown = bars.filter(|[begin, end]| begin <= end);
        shown.map(|bar| {
            let [a, b] = bar.map(|time| run.place(time));
            [a.min(b), a.max(b)]
        })
    };
    let bars = (0..joints.len()).map(|joint| Mark::Bars(bars(joint).collect(), joint, BLUE));
    let marks = run.behind(run.state_ends()).map(Mark::Beyond).into_iter().chain(bars);
    let y = Axis {
        title: Text::default(),
        unit: Unit::one(),
        range: [joints.len() as f64 - 0.5, -0.5],
        ticks: Choice::Names(joints.to_vec()),
    };
    let panel = Panel {
        label: Text::roman(&run.name),
        legend: Vec::new(),
        x: x.clone(),
        y,
        marks: marks.collect(),
    };
    (joints.len(), panel)
}
