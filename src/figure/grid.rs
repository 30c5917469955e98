//! Panels by run and joint: a row for each run, a column for each joint with clearance. Many joints
//! take several rows; where few would make a tall figure, several runs stand beside each other.

use super::Error;
use super::over_time::letter;
use super::panel::Panel;
use super::runs::{Run, Runs};
use super::sheet::{DOUBLE_COLUMN, Height, SINGLE_COLUMN, Sheet};
use super::touching::clearance;
use crate::record::Dimension;

/// Most columns and rows of a page.
const MOST: [usize; 2] = [4, 4];
/// Greatest height of a page (mm).
const TALLEST: f64 = 210.0;
/// About what words take beside a frame and below (mm).
const WORDS: f64 = 14.0;

/// Draws a panel for each clearance of each run; `panel` is told the run and the clearance's name
/// and index. `height` is that of the frames, in widths.
pub(super) fn by_run_and_joint(
    runs: &Runs,
    height: f64,
    panel: impl FnMut(&Run, &str, usize) -> Result<Option<Panel>, Error>,
) -> Result<Vec<Sheet>, Error> {
    by_run_and(runs, &runs.names(Dimension::Clearance), height, panel)
}

/// The same of journals in bearings alone.
pub(super) fn by_run_and_journal(
    runs: &Runs,
    height: f64,
    panel: impl FnMut(&Run, &str, usize) -> Result<Option<Panel>, Error>,
) -> Result<Vec<Sheet>, Error> {
    let mut journals = runs.names(Dimension::Clearance);
    journals.retain(|name| runs.shown().any(|run| run.is_journal(name)));
    by_run_and(runs, &journals, height, panel)
}

/// The same of some clearances.
pub(super) fn by_run_and(
    runs: &Runs,
    joints: &[&str],
    height: f64,
    mut panel: impl FnMut(&Run, &str, usize) -> Result<Option<Panel>, Error>,
) -> Result<Vec<Sheet>, Error> {
    let columns = joints.len().min(MOST[0]);
    let mut rows: Vec<Vec<Option<Panel>>> = Vec::new();
    for joints in joints.chunks(MOST[0]) {
        for run in runs.shown() {
            let mut row = Vec::new();
            for joint in joints {
                let drawn = clearance(run, joint).map(|index| panel(run, joint, index));
                row.push(drawn.transpose()?.flatten());
            }
            if row.iter().any(Option::is_some) {
                row.resize(columns, None);
                rows.push(row);
            }
        }
    }
    let (beside, fitting) = broken(columns, rows.len(), height);
    let rows: Vec<Vec<Option<Panel>>> = rows.chunks(beside).map(<[_]>::concat).collect();
    Ok(rows.chunks(fitting).map(|rows| page(rows.to_vec(), height)).collect())
}

/// How many of some rows stand beside each other, each with so many columns, and how many a page
/// then has under each other: as few beside each other as leave no page too tall, or as many as
/// there is room for.
fn broken(columns: usize, rows: usize, height: f64) -> (usize, usize) {
    let fitting = |beside: usize| {
        let columns = columns * beside;
        let width = if columns == 1 { SINGLE_COLUMN } else { DOUBLE_COLUMN };
        let frame = width / columns as f64 - WORDS;
        ((TALLEST / (height * frame + WORDS)) as usize).clamp(1, MOST[1])
    };
    let most = (MOST[0] / columns.max(1)).max(1);
    let all = |beside: &usize| rows.div_ceil(*beside) <= fitting(*beside);
    let beside = (1..=most).find(all).unwrap_or(most);
    (beside, fitting(beside))
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
    let columns = rows.iter().map(Vec::len).max().unwrap_or(1);
    Sheet {
        width: if columns == 1 { SINGLE_COLUMN } else { DOUBLE_COLUMN },
        heights: vec![Height::OfWidth(height); rows.len()],
        rows,
        shared_x: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tall_figures_break_over_columns() {
        for (joints, runs, expected) in [
            (1, 1, (1, 2)),
            (1, 2, (1, 2)),
            (1, 3, (2, 2)),
            (1, 4, (2, 2)),
            (1, 6, (3, 3)),
            (1, 20, (4, 4)),
            (2, 2, (1, 2)),
            (2, 4, (2, 4)),
            (3, 3, (1, 3)),
            (3, 5, (1, 3)),
            (4, 4, (1, 4)),
        ] {
            assert_eq!(broken(joints, runs, 1.0), expected, "{joints} joints of {runs} runs");
        }
    }
}
