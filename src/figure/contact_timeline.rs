//! Timeline of flight and contact, a row for each joint with clearance.

use super::over_time::{beyond, letter, time_axis};
use super::palette::BLUE;
use super::panel::{Axis, Choice, Mark, Panel, Sample};
use super::quantity::Unit;
use super::runs::{Run, Runs};
use super::sheet::{DOUBLE_COLUMN, Height, Sheet};
use super::text::Text;
use super::touching::contacts;
use super::{Error, Figures};
use crate::record::Dimension;

/// Height of a joint's lane (pt).
const LANE: f64 = 15.0;
/// Most lanes of a panel; of more joints there are several panels, side by side.
const MOST_LANES: usize = 24;
/// Most lanes under each other on a page, each panel's words counted as two.
const MOST_OF_PAGE: usize = 36;
/// Most panels side by side.
const MOST_COLUMNS: usize = 2;

/// Draws one figure with a row of panels for each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let x = time_axis(runs, figures.options.over);
    let mut pages: Vec<Vec<Row>> = Vec::new();
    let mut filled = 0;
    for row in runs.shown().flat_map(|run| rows(run, &x)) {
        let lanes = row.lanes + 2;
        match pages.last_mut() {
            Some(page) if filled + lanes <= MOST_OF_PAGE => {
                page.push(row);
                filled += lanes;
            }
            _ => {
                pages.push(vec![row]);
                filled = lanes;
            }
        }
    }
    let sheets = pages.into_iter().map(page).collect();
    figures.add("contact-timeline", None, "Flight and contact of each joint", sheets);
    Ok(())
}

/// Panels side by side.
struct Row {
    panels: Vec<Panel>,
    /// Lanes of the tallest.
    lanes: usize,
}

/// The panels of a run: one, or as many as its joints need.
fn rows(run: &Run, x: &Axis) -> Vec<Row> {
    let joints: Vec<usize> = (0..run.names(Dimension::Clearance).len()).collect();
    if joints.is_empty() {
        return Vec::new();
    }
    let panels = joints.len().div_ceil(MOST_LANES);
    let lanes = joints.len().div_ceil(panels);
    let panels: Vec<Panel> = joints.chunks(lanes).map(|joints| panel(run, x, joints)).collect();
    let row = |panels: &[Panel]| Row { panels: panels.to_vec(), lanes };
    panels.chunks(MOST_COLUMNS).map(row).collect()
}

fn page(mut rows: Vec<Row>) -> Sheet {
    let panels: Vec<&mut Panel> = rows.iter_mut().flat_map(|row| &mut row.panels).collect();
    letter(panels.into_iter());
    let mut marks = rows.iter().flat_map(|row| &row.panels).flat_map(|panel| &panel.marks);
    let reaches = marks.any(|mark| matches!(mark, Mark::Beyond(_)));
    if let Some(first) = rows.iter_mut().flat_map(|row| &mut row.panels).next() {
        first.legend = vec![(Sample::Bar(BLUE), Text::roman("contact"))];
        first.legend.extend(reaches.then(beyond));
    }
    Sheet {
        width: DOUBLE_COLUMN,
        heights: rows.iter().map(|row| Height::Points(LANE * row.lanes as f64)).collect(),
        rows: rows.into_iter().map(|row| row.panels.into_iter().map(Some).collect()).collect(),
        shared_x: true,
    }
}

fn panel(run: &Run, x: &Axis, joints: &[usize]) -> Panel {
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
    let lanes = joints.iter().enumerate();
    let bars = lanes.map(|(lane, joint)| Mark::Bars(bars(*joint).collect(), lane, BLUE));
    let marks = run.behind(run.state_ends()).map(Mark::Beyond).into_iter().chain(bars);
    let names = run.names(Dimension::Clearance);
    let y = Axis {
        title: Text::default(),
        unit: Unit::one(),
        range: [joints.len() as f64 - 0.5, -0.5],
        ticks: Choice::Names(joints.iter().map(|joint| names[*joint].clone()).collect()),
    };
    Panel {
        label: Text::roman(&run.name),
        legend: Vec::new(),
        x: x.clone(),
        y,
        marks: marks.collect(),
    }
}
