//! Least squares in ranks.

use super::dense::{factor_symmetric, solve_symmetric};
use crate::scalar::Scalar;

/// One row of a least-squares problem: coefficients a, by unknown, and error e of a·x + e.
#[derive(Debug, Clone)]
pub struct Row<S> {
    /// The unknowns that have a coefficient, and what it is.
    pub coefficients: Vec<(usize, S)>,
    /// The error at x = 0.
    pub error: S,
}

impl<S: Scalar> Row<S> {
    /// a·x + e.
    pub fn at(&self, x: &[S]) -> S {
        self.coefficients.iter().fold(self.error, |sum, (k, a)| sum + *a * x[*k])
    }

    /// The length of a.
    fn size(&self) -> f64 {
        self.coefficients.iter().fold(S::zero(), |sum, (_, a)| sum + *a * *a).to_f64().sqrt()
    }
}

/// Least-squares problems one after another, each over what those before it leave free:
/// ```text
/// minimise |A₁ x + e₁|, then |A₂ x + e₂| among the x that do, and so on
/// ```
/// by reflections alone: nothing is squared, so that a condition number counts once. Zeros are
/// passed over: what mechanisms of many bodies ask for is mostly zeros.
#[derive(Debug, Clone)]
pub struct Cascade<S> {
    x: Vec<S>,
    /// Components of the orthonormal directions that are still free, by unknown.
    free: Vec<Vec<S>>,
    /// How many these are.
    left: usize,
}

impl<S: Scalar> Cascade<S> {
    /// A cascade over n unknowns, all of them free and zero.
    pub fn new(n: usize) -> Self {
        let unit = |k: usize| (0..n).map(|i| S::from_f64(f64::from(u8::from(i == k)))).collect();
        Cascade { x: vec![S::zero(); n], free: (0..n).map(unit).collect(), left: n }
    }

    /// The unknowns as they are now.
    pub fn x(&self) -> &[S] {
        &self.x
    }

    /// Minimises |A x + e| over what is free. Directions that a row sees with less than `least` of
    /// its largest coefficients stay free. `bend` is a symmetric matrix D of second
    /// derivatives, row by row: with it, ½|A x + e|² + ½ xᵀ D x is minimised, if that has a minimum.
    ///
    /// Returns the condition number: the largest row over what the last direction was seen with.
    pub fn minimise(&mut self, rows: &[Row<S>], bend: Option<&[S]>, least: f64) -> f64 {
        let mut along: Vec<Vec<S>> = rows.iter().map(|row| self.along(row)).collect();
        let mut right: Vec<S> = rows.iter().map(|row| -row.at(&self.x)).collect();
        let size = rows.iter().map(Row::size).fold(0.0, f64::max);
        let (rank, smallest) = self.turn(&mut along, &mut right, least * size);
        if rank == 0 {
            return 1.0;
        }
        triangulate(&mut along, &mut right, rank);
        if let Some(bend) = bend {
            self.straighten(&along, &mut right[..rank], bend);
        }
        solve_upper(&along, &mut right[..rank]);
        for (x, free) in self.x.iter_mut().zip(&mut self.free) {
            free.drain(..rank).zip(&right).for_each(|(z, w)| *x += *w * z);
        }
        self.left -= rank;
        size / smallest
    }

    /// The components of a row along the free directions.
    fn along(&self, row: &Row<S>) -> Vec<S> {
        let mut along = vec![S::zero(); self.left];
        for (k, a) in row.coefficients.iter().filter(|(_, a)| is_something(*a)) {
            along.iter_mut().zip(&self.free[*k]).for_each(|(sum, z)| *sum += *a * *z);
        }
        along
    }

    /// Turns the free directions so that the first of them are those the rows see, the largest
    /// row first. Returns their number, and what the last was seen with.
    fn turn(&mut self, along: &mut [Vec<S>], right: &mut [S], least: f64) -> (usize, f64) {
        let mut smallest = f64::INFINITY;
        let most = along.len().min(self.left);
        // squares of what is left of each row
        let tail = |row: &Vec<S>, j: usize| dot(&row[j..], &row[j..]);
        let mut tails: Vec<S> = along.iter().map(|row| tail(row, 0)).collect();
        for j in 0..most {
            let pivot =
                (j..along.len()).fold(j, |best, i| if tails[i] > tails[best] { i } else { best });
            let square = tails[pivot];
            let seen = square.to_f64().sqrt();
            if !(square > S::zero()) || seen <= least {
                return (j, smallest);
            }
            smallest = seen;
            along.swap(j, pivot);
            right.swap(j, pivot);
            tails.swap(j, pivot);
            let Some(mirror) = Mirror::new(along[j][j..].to_vec()) else { return (j, smallest) };
            for (i, row) in along.iter_mut().enumerate() {
                let turned = mirror.turn(&mut row[j..]);
                if i > j && (turned || is_something(row[j])) {
                    tails[i] = tail(row, j + 1);
                }
            }
            for free in &mut self.free {
                mirror.turn(&mut free[j..]);
            }
        }
        (most, smallest)
    }

    /// Takes D into account where there is a minimum with it: (I + R⁻ᵀ D R⁻¹)⁻¹ (b − R⁻ᵀ D x), with
    /// D along the directions seen.
    fn straighten(&self, r: &[Vec<S>], right: &mut [S], bend: &[S]) {
        let n = right.len();
        let seen: Vec<Vec<S>> =
            (0..n).map(|k| self.free.iter().map(|free| free[k]).collect()).collect();
        let bent = |x: &[S]| -> Vec<S> { bend.chunks(x.len()).map(|row| dot(row, x)).collect() };
        let images: Vec<Vec<S>> = seen.iter().map(|z| bent(z)).collect();
        let mut columns: Vec<Vec<S>> =
            seen.iter().map(|a| images.iter().map(|b| dot(a, b)).collect()).collect();
        for _ in 0..2 {
            columns.iter_mut().for_each(|column| solve_lower(r, column));
            columns = (0..n).map(|i| columns.iter().map(|column| column[i]).collect()).collect();
        }
        let mut matrix = columns.concat();
        for i in 0..n {
            matrix[i * n + i] += S::one();
        }
        if factor_symmetric(&mut matrix, n).is_ok() {
            let bent = bent(&self.x);
            let mut pull: Vec<S> = seen.iter().map(|z| dot(z, &bent)).collect();
            solve_lower(r, &mut pull);
            right.iter_mut().zip(pull).for_each(|(right, pull)| *right += -pull);
            solve_symmetric(&matrix, n, right);
        }
    }
}

/// The reflection that takes a vector onto its first component.
struct Mirror<S> {
    /// Places and components of v that are not zero, the first place first.
    v: Vec<(usize, S)>,
    /// 2/|v|².
    weight: S,
}

impl<S: Scalar> Mirror<S> {
    /// `None` for a vector without length.
    fn new(mut v: Vec<S>) -> Option<Self> {
        let square = dot(&v, &v);
        if !(square > S::zero()) {
            return None;
        }
        let length = square.sqrt();
        let first = v.first_mut()?;
        *first += if *first < S::zero() { -length } else { length };
        let weight = S::from_f64(2.0) / dot(&v, &v);
        let v = v.into_iter().enumerate().filter(|(_, v)| is_something(*v)).collect();
        Some(Mirror { v, weight })
    }

    /// Turns a vector; says whether that changes it.
    fn turn(&self, x: &mut [S]) -> bool {
        let seen = self.v.iter().fold(S::zero(), |sum, (k, v)| sum + *v * x[*k]);
        if !is_something(seen) {
            return false;
        }
        let by = self.weight * seen;
        self.v.iter().for_each(|(k, v)| x[*k] += -(by * *v));
        true
    }
}

/// Makes rows upper triangular in their first n columns, the right side along with them.
fn triangulate<S: Scalar>(rows: &mut [Vec<S>], right: &mut [S], n: usize) {
    let mut seen = vec![S::zero(); n];
    for j in 0..n {
        let column = rows[j..].iter().map(|row| row[j]).collect();
        let Some(mirror) = Mirror::new(column) else { continue };
        // the columns side by side, each as it would be turned alone
        seen.fill(S::zero());
        for (k, v) in &mirror.v {
            let row = &rows[j + k][j..n];
            seen[j..].iter_mut().zip(row).for_each(|(sum, entry)| *sum += *v * *entry);
        }
        for (k, v) in &mirror.v {
            let row = &mut rows[j + k][j..n];
            let turn = |(entry, seen): (&mut S, &S)| *entry += -(mirror.weight * *seen * *v);
            row.iter_mut().zip(&seen[j..]).for_each(turn);
        }
        mirror.turn(&mut right[j..]);
    }
}

/// Whether a number is more than an exact zero: its value, or a derivative that it carries.
fn is_something<S: Scalar>(x: S) -> bool {
    S::CARRIES_DERIVATIVE || x != S::zero()
}

/// Solves R x = b in place; R stands above the diagonal of the first rows.
fn solve_upper<S: Scalar>(r: &[Vec<S>], b: &mut [S]) {
    for i in (0..b.len()).rev() {
        let rest = dot(&r[i][i + 1..b.len()], &b[i + 1..]);
        b[i] = (b[i] - rest) / r[i][i];
    }
}

/// Solves Rᵀ x = b in place.
fn solve_lower<S: Scalar>(r: &[Vec<S>], b: &mut [S]) {
    for i in 0..b.len() {
        let rest = (0..i).fold(S::zero(), |sum, k| sum + r[k][i] * b[k]);
        b[i] = (b[i] - rest) / r[i][i];
    }
}

fn dot<S: Scalar>(a: &[S], b: &[S]) -> S {
    a.iter().zip(b).fold(S::zero(), |sum, (a, b)| sum + *a * *b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A row of all unknowns.
    fn row(coefficients: impl IntoIterator<Item = f64>, error: f64) -> Row<f64> {
        Row { coefficients: coefficients.into_iter().enumerate().collect(), error }
    }

    proptest! {
        #[test]
        fn a_later_problem_is_solved_among_the_solutions_of_the_earlier(
            g in proptest::collection::vec(-1.0..1.0f64, 42),
        ) {
            let rows: Vec<Row<f64>> = g.chunks(7).map(|r| row(r[..6].to_vec(), r[6])).collect();
            let of = |rows: &[Row<f64>], x: &[f64]| -> Vec<f64> {
                rows.iter().map(|row| row.at(x)).collect()
            };
            let mut cascade = Cascade::new(6);
            // a third row that says what the first two say already
            let mut first = rows[..2].to_vec();
            let sum = (0..6).map(|k| rows[0].coefficients[k].1 + rows[1].coefficients[k].1);
            first.push(row(sum, rows[0].error + rows[1].error));
            let condition = cascade.minimise(&first, None, 1e-12)
                * cascade.minimise(&rows[2..4], None, 1e-12);
            let least: Vec<Row<f64>> = (0..6)
                .map(|k| Row { coefficients: vec![(k, (k + 1) as f64)], error: 0.1 })
                .collect();
            cascade.minimise(&least, None, 0.0);
            let x = cascade.x();
            for left in of(&first, x).into_iter().chain(of(&rows[2..4], x)) {
                prop_assert!(left.abs() < 1e-13 * condition, "{left:e}");
            }
            // the slope of the last lies across all that the others leave free
            let slope: Vec<f64> =
                (0..6).map(|k| (k + 1) as f64 * of(&least, x)[k]).collect();
            let mut across = Cascade::new(4);
            let rows: Vec<Row<f64>> = (0..6)
                .map(|k| row((0..4).map(|r| rows[r].coefficients[k].1), slope[k]))
                .collect();
            across.minimise(&rows, None, 1e-12);
            for left in of(&rows, across.x()) {
                prop_assert!(left.abs() < 1e-11 * condition, "{left:e}");
            }
        }

        #[test]
        fn second_derivatives_move_the_minimum(
            g in proptest::collection::vec(-1.0..1.0f64, 12),
            root in proptest::collection::vec(-1.0..1.0f64, 9),
        ) {
            let product = |i: usize, j: usize| dot(&root[3 * i..][..3], &root[3 * j..][..3]);
            let bend: Vec<f64> = (0..9).map(|k| product(k / 3, k % 3)).collect();
            let rows: Vec<Row<f64>> = g.chunks(4).map(|r| row(r[..3].to_vec(), r[3])).collect();
            let mut cascade = Cascade::new(3);
            let condition = cascade.minimise(&rows, Some(&bend), 1e-12);
            let x = cascade.x();
            for k in 0..3 {
                let slope: f64 =
                    rows.iter().map(|row| row.coefficients[k].1 * row.at(x)).sum::<f64>()
                        + dot(&bend[3 * k..][..3], x);
                prop_assert!(slope.abs() < 1e-13 * condition * condition, "{slope:e}");
            }
        }
    }
}
