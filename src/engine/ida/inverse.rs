//! Solves the linear equations of Newton's method by the inverse of their matrix.
//!
//! With a dozen unknowns, SUNDIALS' substitution takes a third of a whole run: each of its short
//! loops waits for the one before. A product with the inverse waits for nothing and takes a tenth
//! of that; the inverse costs three times as much as the factors, but IDA uses it for some fifteen
//! solutions. Rounding is no worse where the unknowns are scaled sensibly, and Newton's method,
//! which computes each residual afresh, corrects what it leaves.

/// Replaces a matrix, column by column, by its inverse: Gauss–Jordan elimination in place with row
/// pivoting. `exchanges` is scratch space, one a column. Returns whether the matrix was regular;
/// if not, it is left half done.
pub(super) fn invert(
    matrix: &mut [f64],
    exchanges: &mut [usize],
    pivot_column: &mut [f64],
) -> bool {
    let n = exchanges.len();
    for k in 0..n {
        let row = largest_below(&matrix[n * k..n * (k + 1)], k);
        let pivot = matrix[n * k + row];
        if pivot == 0.0 || !pivot.is_finite() {
            return false;
        }
        exchanges[k] = row;
        matrix.chunks_exact_mut(n).for_each(|column| column.swap(k, row));
        eliminate(matrix, k, pivot, pivot_column);
    }
    for k in (0..n).rev().filter(|k| exchanges[*k] != *k) {
        let (left, right) = matrix.split_at_mut(n * exchanges[k]);
        left[n * k..n * (k + 1)].swap_with_slice(&mut right[..n]);
    }
    true
}

/// Row of the largest number of a column, from row `k` on.
#[inline(always)]
fn largest_below(column: &[f64], k: usize) -> usize {
    let mut row = k;
    for (i, number) in column.iter().enumerate().skip(k + 1) {
        if number.abs() > column[row].abs() {
            row = i;
        }
    }
    row
}

/// Clears column `k` but for its pivot, and puts the inverse's numbers in its place.
#[inline(always)]
fn eliminate(matrix: &mut [f64], k: usize, pivot: f64, pivot_column: &mut [f64]) {
    let n = pivot_column.len();
    let factor = 1.0 / pivot;
    pivot_column.copy_from_slice(&matrix[n * k..n * (k + 1)]);
    pivot_column[k] = 0.0;
    for column in matrix.chunks_exact_mut(n) {
        let share = column[k] * factor;
        for (number, pivot_number) in column.iter_mut().zip(pivot_column.iter()) {
            *number -= share * pivot_number;
        }
        column[k] = share;
    }
    for (number, pivot_number) in matrix[n * k..].iter_mut().zip(pivot_column.iter()) {
        *number = -factor * pivot_number;
    }
    matrix[n * k + k] = factor;
}

/// Rows that are summed up side by side.
const ROWS: usize = 4;

/// x = A b for a square matrix A, column by column.
#[inline(always)]
pub(super) fn multiply(matrix: &[f64], b: &[f64], x: &mut [f64]) {
    let n = x.len();
    let (blocks, rest) = x.as_chunks_mut::<ROWS>();
    for (i, block) in blocks.iter_mut().enumerate() {
        let mut sum = [0.0; ROWS];
        for (column, b) in matrix.chunks_exact(n).zip(b) {
            for (sum, number) in sum.iter_mut().zip(&column[ROWS * i..ROWS * (i + 1)]) {
                *sum += number * b;
            }
        }
        *block = sum;
    }
    let first = n - rest.len();
    for (i, x) in rest.iter_mut().enumerate() {
        *x = matrix.chunks_exact(n).zip(b).map(|(column, b)| column[first + i] * b).sum();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between −1 and 1 that look random, and the matrix of them.
    fn matrix(n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        (0..n * n).map(|_| number()).collect()
    }

    #[test]
    fn a_matrix_times_its_inverse_is_the_identity() {
        for n in [1, 2, 3, 4, 5, 12, 16, 19] {
            let a = matrix(n, n as u64);
            let mut inverse = a.clone();
            assert!(invert(&mut inverse, &mut vec![0; n], &mut vec![0.0; n]));
            let mut product = vec![0.0; n];
            for j in 0..n {
                multiply(&a, &inverse[n * j..n * (j + 1)], &mut product);
                for (i, number) in product.iter().enumerate() {
                    let error = (number - f64::from(u8::from(i == j))).abs();
                    // These matrices have condition numbers of some hundred.
                    assert!(error < 1e4 * f64::EPSILON, "n = {n}, ({i}, {j}): {error}");
                }
            }
        }
    }

    #[test]
    fn rows_of_very_different_size_do_no_harm() {
        // The block of one coordinate under a stiff contact: [c −1; k c], c = 1e4, k = 1e9 to 1e14.
        for (c, k) in [(1e4, 1e9), (1e10, 1e9), (1e3, 1e14)] {
            let mut inverse = [c, k, -1.0, c];
            assert!(invert(&mut inverse, &mut [0; 2], &mut [0.0; 2]));
            let determinant = c * c + k;
            let exact = [c, -k, 1.0, c].map(|number: f64| number / determinant);
            for (found, exact) in inverse.iter().zip(exact) {
                assert!((found / exact - 1.0).abs() < 8.0 * f64::EPSILON, "{inverse:?} {exact:?}");
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_told() {
        let mut a = [1.0, 2.0, 2.0, 4.0];
        assert!(!invert(&mut a, &mut [0; 2], &mut [0.0; 2]));
        let mut a = [0.0, 1.0, 1.0, f64::NAN];
        assert!(!invert(&mut a, &mut [0; 2], &mut [0.0; 2]));
    }
}
