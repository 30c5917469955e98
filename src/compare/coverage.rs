//! How much of a reference was looked at: of its time, and of what moves freely in it.

use super::comparison::Comparison;
use super::quantity::{Column, Part, Parts, Quantity};
use super::told::seconds;
use crate::record::Dimension;
use std::fmt;

/// Distances of times that differ by no more than this, relative, are the same.
const SAME: f64 = 1e-3;
/// Times are a grid where so many of their distances are the usual one.
const GRID: f64 = 0.45;
/// Solvers that choose their steps make one at most so many times longer than those beside it.
const GROWTH: f64 = 10.0;
/// Shares are rounded; from this on they are told as whole.
const WHOLE: f64 = 0.9995;

/// How much of a reference was looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverage {
    /// Share of the time in which samples compared stand as near to one another as on their grid, or
    /// as steps beside one another do that a solver has chosen, or as those of the reference.
    pub time: f64,
    /// The longest stretch (s) without a sample that was compared, where there is one.
    pub gap: Option<[f64; 2]>,
    /// Columns that count for the gate and are not prescribed by a drive: those compared.
    pub columns: usize,
    /// And all that the mechanism has.
    pub of_columns: usize,
}

impl Coverage {
    /// Share of the columns that were compared; one where there is nothing to compare.
    pub fn column_share(&self) -> f64 {
        if self.of_columns == 0 { 1.0 } else { self.columns as f64 / self.of_columns as f64 }
    }

    /// Whether all that was compared is what drives prescribe, though other things move.
    pub fn is_of_prescribed_alone(&self) -> bool {
        self.columns == 0 && self.of_columns > 0
    }

    /// Whether samples are missing somewhere.
    pub fn has_gaps(&self) -> bool {
        self.time < WHOLE
    }

    pub(super) fn new(
        [compared, reference]: [&[f64]; 2],
        until: f64,
        [columns, of_columns]: [usize; 2],
    ) -> Coverage {
        let (time, gap) = over_time(compared, reference, until);
        Coverage { time, gap, columns, of_columns }
    }
}

/// Share of the time up to `until` (s) that samples compared cover, and the longest stretch without.
fn over_time(compared: &[f64], reference: &[f64], until: f64) -> (f64, Option<[f64; 2]>) {
    let (Some(first), Some(end)) = (reference.first(), compared.last()) else { return (0.0, None) };
    let until = until.max(*end);
    if until <= *first {
        return (1.0, None);
    }
    let grid = grid(compared);
    let bounds = std::iter::once(*first).chain(compared.iter().copied()).chain([until]);
    let bounds: Vec<f64> = bounds.collect();
    let length = |k: usize| bounds.get(k + 1).map_or(0.0, |to| to - bounds[k]);
    let mut missing = 0.0;
    let mut gap: Option<[f64; 2]> = None;
    for k in 0..bounds.len() - 1 {
        let [from, to] = [bounds[k], bounds[k + 1]];
        let next = reference.partition_point(|time| *time <= from);
        let known = reference.get(next).map_or(0.0, |time| time - from);
        let beside = length(k + 1).max(k.checked_sub(1).map_or(0.0, length));
        let usual = grid.unwrap_or(GROWTH * beside);
        let allowed = usual.max(known) * (1.0 + SAME);
        if to - from > allowed {
            missing += to - from - allowed;
            if gap.is_none_or(|[a, b]| to - from > b - a) {
                gap = Some([from, to]);
            }
        }
    }
    (1.0 - missing / (until - first), gap)
}

/// The distance of times on a grid, from which some may be missing; `None` where they are on none.
fn grid(times: &[f64]) -> Option<f64> {
    let gaps = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > 0.0);
    let mut gaps: Vec<f64> = gaps.collect();
    gaps.sort_by(f64::total_cmp);
    let usual = *gaps.get(gaps.len().saturating_sub(1) / 2)?;
    let same = gaps.iter().filter(|gap| (*gap / usual - 1.0).abs() <= SAME).count();
    (same as f64 >= GRID * gaps.len() as f64).then_some(usual)
}

/// Numbers of columns that count and that no drive prescribes: among those compared, and of all
/// that the mechanism has. `driven` tells of each body whether drives prescribe it.
pub(super) fn free_columns(
    compared: &[Column],
    parts: &Parts,
    forces: bool,
    driven: &[bool],
) -> [usize; 2] {
    let free = |column: &Column| {
        column.dataset.items() != Some(Dimension::Body)
            || !driven.get(column.item).copied().unwrap_or(false)
    };
    let part = |column: &Column| column.quantity().map(Quantity::part);
    let derived_only = compared.iter().all(|column| part(column) == Some(Part::Derived));
    let counts =
        |column: &&Column| free(column) && (derived_only || part(column) != Some(Part::Derived));
    let all = parts.compared(forces);
    let all = all.iter().filter(|c| free(c) && part(c) != Some(Part::Derived)).count();
    [compared.iter().filter(counts).count(), all]
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.gap.filter(|_| self.has_gaps()) {
            None => write!(f, "all of the time")?,
            Some([from, to]) => {
                let [from, to] = [seconds(from), seconds(to)];
                let percent = percent(self.time);
                write!(f, "{percent} of the time, nothing between {from} s and {to} s")?;
            }
        }
        write!(f, "; {} of {} columns of what moves freely", self.columns, self.of_columns)
    }
}

/// A share in per cent, rounded down to tenths.
pub(super) fn percent(share: f64) -> String {
    format!("{:.1} %", (share * 1e3 + 1e-6).floor() / 10.0)
}

impl Comparison {
    /// What should be known of a comparison that looked at a part only.
    pub(super) fn coverage_note(&self) -> Option<String> {
        let coverage = &self.coverage;
        let path = self.theirs.path.display();
        if coverage.is_of_prescribed_alone() {
            return Some(format!(
                "nothing of {path} that moves freely is compared: its digits are those of the drives"
            ));
        }
        let [from, to] = coverage.gap.filter(|_| coverage.has_gaps())?.map(seconds);
        let share = percent(coverage.time);
        Some(format!(
            "rows are missing: samples of {path} cover {share} of the time, with none between \
             {from} s and {to} s; --require-times asks for a share"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::quantity::tests::four_bar;
    use super::*;

    /// Multiples of 1 ms up to 90 ms, of which `keep` are left.
    fn grid(keep: impl Fn(u32) -> bool) -> Vec<f64> {
        (0..=90).filter(|k| keep(*k)).map(|k| f64::from(k) * 1e-3).collect()
    }

    fn share(compared: &[f64], reference: &[f64]) -> f64 {
        over_time(compared, reference, 0.09).0
    }

    #[test]
    fn a_third_of_the_rows_missing_is_a_third_of_the_time() {
        let all = grid(|_| true);
        assert_eq!(share(&all, &all), 1.0);
        for keep in [(|k| !(30..60).contains(&k)) as fn(u32) -> bool, |k| k % 3 != 1] {
            let share = share(&grid(keep), &all);
            assert!((share - 2.0 / 3.0).abs() < 0.02, "{share}");
        }
        assert_eq!(over_time(&grid(|k| !(30..60).contains(&k)), &all, 0.09).1, Some([0.029, 0.06]));
    }

    #[test]
    fn other_samplings_leave_nothing_out() {
        let all = grid(|_| true);
        assert_eq!(share(&grid(|k| k % 10 == 0), &all), 1.0);
        // steps that grow, none longer than the reference's
        let mut steps = vec![0.0_f64];
        while steps[steps.len() - 1] < 0.09 {
            let last = steps[steps.len() - 1];
            steps.push((last + (last * 0.1).clamp(1e-5, 9e-4)).min(0.09));
        }
        assert_eq!(share(&steps, &all), 1.0);
    }

    #[test]
    fn steps_that_a_solver_chose_are_no_gaps_but_what_was_cut_out_of_them_is() {
        let fine: Vec<f64> = (0..=90_000).map(|k| f64::from(k) * 1e-6).collect();
        // an event every 10 ms, with steps from 1 ns on behind it
        let mut steps = vec![0.0_f64];
        let mut step = 1e-9;
        while steps[steps.len() - 1] < 0.09 {
            let last = steps[steps.len() - 1];
            let event = ((last * 100.0 + 1e-9).floor() + 1.0) / 100.0;
            let to = (last + step).min(event);
            step = if to < event { (1.7 * step).min(1.3e-3) } else { 1e-9 };
            steps.push(to);
        }
        assert_eq!(share(&steps, &fine), 1.0);
        let cut: Vec<f64> =
            steps.iter().copied().filter(|time| !(0.032..0.062).contains(time)).collect();
        let share = share(&cut, &fine);
        assert!(share > 0.6 && share < 0.85, "{share}");
    }

    #[test]
    fn what_is_missing_at_begin_and_end_is_missing() {
        let all = grid(|_| true);
        let late = share(&grid(|k| k >= 45), &all);
        let early = share(&grid(|k| k <= 45), &all);
        assert!((late - 0.5).abs() < 0.02 && (early - 0.5).abs() < 0.02, "{late} {early}");
        assert_eq!(share(&[], &all), 0.0);
    }

    #[test]
    fn what_a_drive_prescribes_is_no_column_of_what_moves_freely() {
        let parts = four_bar();
        let driven = [true, false, false];
        let all = parts.compared(false);
        assert_eq!(free_columns(&all, &parts, false, &driven), [10, 10]);
        assert_eq!(free_columns(&all[..1], &parts, false, &driven), [0, 10]);
        let alone = Coverage { time: 1.0, gap: None, columns: 0, of_columns: 10 };
        assert!(alone.is_of_prescribed_alone() && alone.column_share() == 0.0);
        let positions: Vec<Column> =
            all.iter().filter(|c| c.quantity() == Some(Quantity::Position)).copied().collect();
        assert_eq!(free_columns(&positions, &parts, false, &driven), [4, 10]);
    }
}
