//! Panels by run and joint: a row for each run, a column for each joint with clearance.

use super::Error;
use super::over_time::letter;
use super::panel::Panel;
use super::runs::{Run, Runs};
use super::sheet::{DOUBLE_COLUMN, Height, SINGLE_COLUMN, Sheet};
use super::touching::clearance;
use crate::record::Dimension;

/// Most columns and rows of a page.
const MOST: [usize; 2] = [4, 4];

/// Draws a panel for each clearance of each run; `panel` is told the run and the clearance's name
/// and index. `height` is that of the frames, in widths.
pub(super) fn by_run_and_joint(
    runs: &Runs,
    height: f64,
    mut panel: impl FnMut(&Run, &str, usize) -> Result<Option<Panel>, Error>,
) -> Result<Vec<Sheet>, Error> {
    let joints = runs.names(Dimension::Clearance);
    let mut pages = Vec::new();
    for joints in joints.chunks(MOST[0]) {
        let mut rows: Vec<Vec<Option<Panel>>> = Vec::new();
        for run in runs.shown() {
            let mut row = Vec::new();
            for joint in joints {
                let drawn = clearance(run, joint).map(|index| panel(run, joint, index));
                row.push(drawn.transpose()?.flatten());
            }
            if row.iter().any(Option::is_some) {
                rows.push(row);
            }
        }
        pages.extend(rows.chunks(MOST[1]).map(|rows| page(rows.to_vec(), height)));
    }
    Ok(pages)
}

/// Leaves the entries of legends on the first panel of each sheet that has some.
pub(super) fn tell_once(sheets: &mut [Sheet]) {
    for sheet in sheets {
        let mut told = false;
        for panel in sheet.rows.iter_mut().flatten().flatten() {
            match told {
                true => panel.legend.clear(),
                false => told = !panel.legend.is_empty(),
            }
        }
    }
}

fn page(mut rows: Vec<Vec<Option<Panel>>>, height: f64) -> Sheet {
    let panels: Vec<&mut Panel> = rows.iter_mut().flatten().flatten().collect();
    letter(panels.into_iter());
    let columns = rows.first().map_or(1, Vec::len);
    Sheet {
        width: if columns == 1 { SINGLE_COLUMN } else { DOUBLE_COLUMN },
        heights: vec![Height::OfWidth(height); rows.len()],
        rows,
        shared_x: false,
    }
}
