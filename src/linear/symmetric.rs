//! Symmetric positive definite matrices whose pattern is known: factored into L D Lᵀ in time and
//! space that grow with what the factors hold.
//!
//! Rows are eliminated in the order of least degree (Tinney and Walker 1967, scheme 2), found once
//! with the pattern; in chains of bodies and of loops the factors then hold hardly more than the
//! matrix. Small matrices are dense in the order of their rows: there the compiler knows the size.

use super::{Singular, dense};
use crate::scalar::Scalar;
use std::collections::{BTreeMap, BTreeSet};

/// Matrices of at most so many rows are dense.
const DENSE_ROWS: usize = 6;

/// A symmetric matrix, given by its lower triangle, or its factors.
#[derive(Debug, Clone)]
pub struct Symmetric<S> {
    rows: usize,
    /// What an elimination meets; `None` of a dense one.
    plan: Option<Plan>,
    /// Entries by [`place`](Self::place); later the factors, with 1/D on the diagonal.
    entries: Vec<S>,
    /// The diagonal as it was before the elimination, in its order.
    whole: Vec<S>,
}

/// The order of an elimination, and where everything stands. Of the p-th row that is eliminated the
/// diagonal entry stands at `columns[p]`; the entries below it in its column follow, up to
/// `columns[p + 1]`.
#[derive(Debug, Clone)]
struct Plan {
    /// Which row is eliminated p-th.
    order: Vec<usize>,
    columns: Vec<usize>,
    /// The row of each entry.
    row_of: Vec<usize>,
    /// Where each product of two entries below a diagonal is subtracted, in the order of use.
    targets: Vec<u32>,
    /// When each row is eliminated.
    rank: Vec<usize>,
}

impl<S: Scalar> Symmetric<S> {
    /// A matrix with these entries, by row and column, beside its diagonal.
    pub fn new(rows: usize, entries: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let plan = (rows > DENSE_ROWS).then(|| Plan::new(rows, entries));
        let held = plan.as_ref().map_or(rows * rows, |plan| plan.row_of.len());
        Symmetric { rows, plan, entries: vec![S::zero(); held], whole: vec![S::zero(); rows] }
    }

    /// Where an entry of the pattern stands in [`entries_mut`](Self::entries_mut); the row is not
    /// above the column.
    pub fn place(&self, row: usize, column: usize) -> usize {
        match &self.plan {
            None => row * self.rows + column,
            Some(plan) => plan.place(row, column),
        }
    }

    /// The entries of the lower triangle, to be written before each [`factor`](Self::factor).
    #[inline(always)]
    pub fn entries_mut(&mut self) -> &mut [S] {
        &mut self.entries
    }

    /// Factors the matrix in place.
    ///
    /// # Errors
    /// A row that depends on the others.
    #[inline(always)]
    pub fn factor(&mut self) -> Result<(), Singular> {
        match &self.plan {
            None => dense::factor_symmetric(&mut self.entries, self.rows),
            Some(plan) => plan.factor(&mut self.entries, &mut self.whole),
        }
    }

    /// The diagonal of the matrix, by row, as long as it is not factored.
    pub fn diagonal(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.rows).map(|row| self.entries[self.place(row, row)].to_f64())
    }

    /// The pivots of the factors, D, by row.
    pub fn pivots(&self) -> impl Iterator<Item = f64> + '_ {
        self.diagonal().map(f64::recip)
    }

    /// Solves with the factors, in place.
    #[inline(always)]
    pub fn solve(&self, b: &mut [S]) {
        match &self.plan {
            None => dense::solve_symmetric(&self.entries, self.rows, b),
            Some(plan) => plan.solve(&self.entries, b),
        }
    }
}

impl Plan {
    fn new(rows: usize, entries: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let mut around = vec![BTreeSet::new(); rows];
        for (row, column) in entries.into_iter().filter(|(row, column)| row != column) {
            around[row].insert(column);
            around[column].insert(row);
        }
        let (order, below) = eliminate(around);
        let mut rank = vec![0; rows];
        order.iter().enumerate().for_each(|(p, row)| rank[*row] = p);
        let mut plan = Plan {
            columns: Vec::with_capacity(rows + 1),
            row_of: Vec::new(),
            targets: Vec::new(),
            rank,
            order,
        };
        for row in &plan.order {
            plan.columns.push(plan.row_of.len());
            let mut column: Vec<usize> = below[*row].iter().copied().collect();
            column.sort_by_key(|row| plan.rank[*row]);
            plan.row_of.push(*row);
            plan.row_of.extend(column);
        }
        plan.columns.push(plan.row_of.len());
        let mut places = BTreeMap::new();
        for p in 0..rows {
            for at in plan.columns[p]..plan.columns[p + 1] {
                places.insert((plan.row_of[at], plan.order[p]), at as u32);
            }
        }
        for p in 0..rows {
            let column = &plan.row_of[plan.columns[p] + 1..plan.columns[p + 1]];
            for (k, across) in column.iter().enumerate() {
                plan.targets.extend(column[k..].iter().map(|row| places[&(*row, *across)]));
            }
        }
        plan
    }

    fn place(&self, row: usize, column: usize) -> usize {
        let (first, later) = match self.rank[row] < self.rank[column] {
            true => (row, column),
            false => (column, row),
        };
        let p = self.rank[first];
        let held = self.columns[p]..self.columns[p + 1];
        let among = self.row_of[held.clone()].iter().position(|row| *row == later);
        held.start + among.unwrap_or_else(|| unreachable!("the pattern has the entry"))
    }

    fn factor<S: Scalar>(&self, entries: &mut [S], wholes: &mut [S]) -> Result<(), Singular> {
        for (whole, at) in wholes.iter_mut().zip(&self.columns) {
            *whole = entries[*at];
        }
        let mut targets = self.targets.iter();
        let least = S::from_f64(1e4 * S::EPSILON);
        for (p, whole) in wholes.iter().enumerate() {
            let (at, end) = (self.columns[p], self.columns[p + 1]);
            let pivot = entries[at];
            if !(pivot > *whole * least) {
                return Err(Singular { row: self.order[p] });
            }
            let inverse = S::one() / pivot;
            entries[at] = inverse;
            for k in at + 1..end {
                let factor = entries[k] * inverse;
                for i in k..end {
                    // one for each pair, see `new`
                    let Some(target) = targets.next() else { break };
                    let change = entries[i] * factor;
                    entries[*target as usize] -= change;
                }
                entries[k] = factor;
            }
        }
        Ok(())
    }

    fn solve<S: Scalar>(&self, factors: &[S], b: &mut [S]) {
        for (p, row) in self.order.iter().enumerate() {
            let x = b[*row];
            for at in self.columns[p] + 1..self.columns[p + 1] {
                b[self.row_of[at]] -= factors[at] * x;
            }
        }
        for (p, row) in self.order.iter().enumerate().rev() {
            let at = self.columns[p];
            let mut x = b[*row] * factors[at];
            for at in at + 1..self.columns[p + 1] {
                x -= factors[at] * b[self.row_of[at]];
            }
            b[*row] = x;
        }
    }
}

/// Eliminates rows, always one of those with the fewest neighbours that are left. Gives their order,
/// and for each row its neighbours when it went.
fn eliminate(mut around: Vec<BTreeSet<usize>>) -> (Vec<usize>, Vec<BTreeSet<usize>>) {
    let mut order = Vec::with_capacity(around.len());
    let mut below = vec![BTreeSet::new(); around.len()];
    let mut left: BTreeSet<(usize, usize)> =
        around.iter().enumerate().map(|(row, around)| (around.len(), row)).collect();
    while let Some((_, row)) = left.pop_first() {
        let neighbours = std::mem::take(&mut around[row]);
        for near in &neighbours {
            left.remove(&(around[*near].len(), *near));
            around[*near].remove(&row);
            around[*near].extend(neighbours.iter().filter(|other| *other != near));
            left.insert((around[*near].len(), *near));
        }
        order.push(row);
        below[row] = neighbours;
    }
    (order, below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A matrix of a pattern that is positive definite by its diagonal, dense and by its pattern.
    fn both(rows: usize, pattern: &[(usize, usize, f64)]) -> (Vec<f64>, Symmetric<f64>) {
        let mut dense = vec![0.0; rows * rows];
        let mut sparse = Symmetric::new(rows, pattern.iter().map(|(i, k, _)| (*i, *k)));
        let mut add = |row: usize, column: usize, value: f64| {
            dense[row * rows + column] += value;
            if row != column {
                dense[column * rows + row] += value;
            }
            let place = sparse.place(row, column);
            sparse.entries_mut()[place] += value;
        };
        for row in 0..rows {
            add(row, row, 1.0 + row as f64);
        }
        for &(row, column, value) in pattern {
            add(row.max(column), row.min(column), value);
            add(row, row, value.abs());
            add(column, column, value.abs());
        }
        (dense, sparse)
    }

    proptest! {
        #[test]
        fn solves_undo_products_whatever_the_pattern(
            rows in 1..40usize,
            pattern in proptest::collection::vec((0..1000usize, 0..1000usize, -1.0..1.0f64), 0..60),
        ) {
            let pattern: Vec<_> = (pattern.iter())
                .map(|(i, k, value)| (i % rows, k % rows, *value))
                .filter(|(i, k, _)| i != k)
                .collect();
            let (dense, mut sparse) = both(rows, &pattern);
            let x: Vec<f64> = (0..rows).map(|i| 1.0 - i as f64 / 7.0).collect();
            let mut b: Vec<f64> = dense
                .chunks(rows)
                .map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum())
                .collect();
            sparse.factor().unwrap();
            sparse.solve(&mut b);
            for (b, x) in b.iter().zip(&x) {
                prop_assert!((b - x).abs() < 1e-12, "{b} {x}");
            }
        }
    }

    #[test]
    fn a_chain_of_loops_fills_nothing_that_grows() {
        // each row is coupled with the three behind it, as in loops side by side
        let held = |rows: usize| {
            let pattern =
                (0..rows).flat_map(|row| (row + 1..rows.min(row + 4)).map(move |k| (k, row)));
            let matrix = Symmetric::<f64>::new(rows, pattern);
            matrix.plan.unwrap().targets.len()
        };
        assert_eq!(held(2000) - held(1000), held(3000) - held(2000));
        assert!(held(1000) <= 6 * 1000);
    }

    #[test]
    fn a_row_that_says_what_another_says_is_named() {
        for rows in [4, 30] {
            let mut matrix = Symmetric::new(rows, [(3, 1)]);
            for row in 0..rows {
                let place = matrix.place(row, row);
                matrix.entries_mut()[place] = 2.0;
            }
            let place = matrix.place(3, 1);
            matrix.entries_mut()[place] = 2.0;
            let Singular { row } = matrix.factor().unwrap_err();
            assert!([1, 3].contains(&row), "{row}");
        }
    }
}
