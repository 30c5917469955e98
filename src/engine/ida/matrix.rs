//! The Newton matrix as the mechanism writes it, entry by entry.

use crate::dae::Entries;
use std::collections::BTreeMap;
use std::ops::Range;

/// A matrix that can be read column by column, once all its entries are there.
pub(super) trait Columns {
    /// Takes note that all entries are there.
    fn settle(&mut self) {}

    /// Calls with each entry of a column whose row is in a range, in the order of rows; what is not
    /// stored is zero.
    fn each(&self, column: usize, rows: Range<usize>, entry: impl FnMut(usize, f64));
}

/// A square matrix that stores everything, column by column.
#[derive(Debug)]
pub(super) struct Dense<'a> {
    pub columns: &'a mut [f64],
    pub size: usize,
}

impl Entries for Dense<'_> {
    #[inline(always)]
    fn add(&mut self, row: usize, column: usize, entry: f64) {
        self.columns[column * self.size + row] += entry;
    }
}

impl Columns for Dense<'_> {
    #[inline(always)]
    fn each(&self, column: usize, rows: Range<usize>, mut entry: impl FnMut(usize, f64)) {
        let numbers = &self.columns[column * self.size..][rows.clone()];
        rows.zip(numbers).for_each(|(row, number)| entry(row, *number));
    }
}

/// A square matrix that stores what was ever written, column by column: modes come and go, and what a
/// contact adds stays in the pattern.
#[derive(Debug, Default)]
pub(super) struct Sparse {
    /// Where each column begins, and where the last one ends.
    pub begins: Vec<usize>,
    /// The row of each entry, in each column from above.
    pub rows: Vec<usize>,
    pub values: Vec<f64>,
    /// Entries that the pattern has not yet, by column and row.
    fresh: BTreeMap<(usize, usize), f64>,
}

impl Sparse {
    /// A matrix without entries.
    pub fn new(size: usize) -> Self {
        Sparse {
            begins: vec![0; size + 1],
            rows: Vec::new(),
            values: Vec::new(),
            fresh: BTreeMap::new(),
        }
    }

    /// Makes all entries zero.
    pub fn clear(&mut self) {
        self.fresh.clear();
        self.values.fill(0.0);
    }
}

impl Entries for Sparse {
    fn add(&mut self, row: usize, column: usize, entry: f64) {
        let held = self.begins[column]..self.begins[column + 1];
        match self.rows[held.clone()].binary_search(&row) {
            Ok(at) => self.values[held.start + at] += entry,
            Err(_) => *self.fresh.entry((column, row)).or_default() += entry,
        }
    }
}

impl Columns for Sparse {
    /// Takes new entries into the pattern.
    fn settle(&mut self) {
        if self.fresh.is_empty() {
            return;
        }
        let mut all = std::mem::take(&mut self.fresh);
        for column in 0..self.begins.len() - 1 {
            let held = self.begins[column]..self.begins[column + 1];
            all.extend(held.map(|at| ((column, self.rows[at]), self.values[at])));
        }
        self.rows.clear();
        self.values.clear();
        self.begins.fill(0);
        for ((column, row), value) in all {
            self.begins[column + 1] += 1;
            self.rows.push(row);
            self.values.push(value);
        }
        for column in 1..self.begins.len() {
            self.begins[column] += self.begins[column - 1];
        }
    }

    fn each(&self, column: usize, rows: Range<usize>, mut entry: impl FnMut(usize, f64)) {
        for at in self.begins[column]..self.begins[column + 1] {
            if rows.contains(&self.rows[at]) {
                entry(self.rows[at], self.values[at]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_hold_what_was_added_and_a_pattern_only_grows() {
        let size = 4;
        let mut numbers = vec![0.0; size * size];
        let mut sparse = Sparse::new(size);
        for round in 0..3 {
            numbers.fill(0.0);
            sparse.clear();
            let mut dense = Dense { columns: &mut numbers, size };
            for (row, column) in [(0, 0), (3, 1), (0, 0), (2, 1), (round, 3), (1, round)] {
                dense.add(row, column, (row + 2 * column) as f64 + 0.5);
                sparse.add(row, column, (row + 2 * column) as f64 + 0.5);
            }
            sparse.settle();
            for column in 0..size {
                let (mut of_dense, mut of_sparse) = (Vec::new(), Vec::new());
                dense.each(column, 1..4, |row, entry| of_dense.push((row, entry)));
                sparse.each(column, 1..4, |row, entry| of_sparse.push((row, entry)));
                of_dense.retain(|(_, entry)| *entry != 0.0);
                of_sparse.retain(|(_, entry)| *entry != 0.0);
                assert_eq!(of_dense, of_sparse);
            }
        }
        assert_eq!(sparse.rows.len(), 9);
        assert_eq!(sparse.begins, [0, 2, 5, 6, 9]);
    }
}
