//! Small dense matrices: square, row by row in one slice.

use super::Singular;
use crate::scalar::Scalar;

/// Factors a symmetric positive definite matrix in place into L D Lᵀ (lower triangle; 1/D on the
/// diagonal).
pub fn factor_symmetric<S: Scalar>(a: &mut [S], n: usize) -> Result<(), Singular> {
    // sizes that mechanisms have, known to the compiler
    match n {
        2 => factor_sized(&mut a[..4], 2),
        4 => factor_sized(&mut a[..16], 4),
        6 => factor_sized(&mut a[..36], 6),
        _ => factor_sized(a, n),
    }
}

#[inline(always)]
fn factor_sized<S: Scalar>(a: &mut [S], n: usize) -> Result<(), Singular> {
    for j in 0..n {
        let whole = a[j * n + j];
        let mut pivot = whole;
        for k in 0..j {
            // a[j, k] still holds L D, the upper triangle L
            pivot -= a[j * n + k] * a[k * n + j];
        }
        if !(pivot > whole * S::from_f64(1e4 * S::EPSILON)) {
            return Err(Singular { row: j });
        }
        let inverse = S::one() / pivot;
        for i in j + 1..n {
            let mut sum = a[i * n + j];
            for k in 0..j {
                sum -= a[i * n + k] * a[k * n + j];
            }
            a[i * n + j] = sum;
            a[j * n + i] = sum * inverse;
        }
        a[j * n + j] = inverse;
    }
    Ok(())
}

/// Solves with the factors of [`factor_symmetric`], in place.
pub fn solve_symmetric<S: Scalar>(factors: &[S], n: usize, b: &mut [S]) {
    match n {
        2 => solve_sized(&factors[..4], 2, &mut b[..2]),
        4 => solve_sized(&factors[..16], 4, &mut b[..4]),
        6 => solve_sized(&factors[..36], 6, &mut b[..6]),
        _ => solve_sized(factors, n, b),
    }
}

#[inline(always)]
fn solve_sized<S: Scalar>(factors: &[S], n: usize, b: &mut [S]) {
    for i in 0..n {
        for k in 0..i {
            b[i] -= factors[k * n + i] * b[k];
        }
    }
    for i in 0..n {
        b[i] *= factors[i * n + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= factors[i * n + k] * b[k];
        }
    }
}

/// Sign of the determinant of a square matrix, zero of a singular one; eliminates in place.
pub fn determinant_sign<S: Scalar>(a: &mut [S], n: usize) -> i8 {
    let mut sign = 1;
    for k in 0..n {
        let size = |row: &usize| a[row * n + k].abs().to_f64();
        let largest = (k..n).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(k);
        if largest != k {
            sign = -sign;
            (0..n).for_each(|c| a.swap(k * n + c, largest * n + c));
        }
        let pivot = a[k * n + k];
        if pivot == S::zero() {
            return 0;
        }
        if pivot < S::zero() {
            sign = -sign;
        }
        for i in k + 1..n {
            let factor = a[i * n + k] / pivot;
            for c in k + 1..n {
                let change = factor * a[k * n + c];
                a[i * n + c] -= change;
            }
        }
    }
    sign
}

/// Solves a square system, with the largest pivots of columns; the solution takes the place of the
/// right side. Gives false where the matrix is singular.
pub fn solve_square<S: Scalar>(a: &mut [S], b: &mut [S]) -> bool {
    let n = b.len();
    for k in 0..n {
        let size = |row: &usize| a[row * n + k].abs().to_f64();
        let largest = (k..n).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(k);
        (0..n).for_each(|c| a.swap(k * n + c, largest * n + c));
        b.swap(k, largest);
        let pivot = a[k * n + k];
        if !(pivot.abs() > S::zero()) {
            return false;
        }
        for i in k + 1..n {
            let factor = a[i * n + k] / pivot;
            for c in k + 1..n {
                let change = factor * a[k * n + c];
                a[i * n + c] -= change;
            }
            let change = factor * b[k];
            b[i] -= change;
        }
    }
    for k in (0..n).rev() {
        let known = (k + 1..n).fold(b[k], |sum, c| sum - a[k * n + c] * b[c]);
        b[k] = known / a[k * n + k];
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn times(a: &[f64], n: usize, x: &[f64]) -> Vec<f64> {
        (0..n).map(|i| (0..n).map(|k| a[i * n + k] * x[k]).sum()).collect()
    }

    #[test]
    fn the_sign_of_a_determinant_follows_rows_and_factors() {
        let plain = [2.0, 1.0, 0.0, 1.0, 3.0, 1.0, 0.0, 1.0, 4.0]; // 18
        let swapped = [0.0, 1.0, 4.0, 1.0, 3.0, 1.0, 2.0, 1.0, 0.0];
        let flat = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 1.0, 0.0, 1.0];
        for (matrix, sign) in [(plain, 1), (swapped, -1), (plain.map(|x| -x), -1), (flat, 0)] {
            assert_eq!(determinant_sign(&mut matrix.clone(), 3), sign, "{matrix:?}");
        }
    }

    proptest! {
        #[test]
        fn symmetric_solves_undo_products(
            g in proptest::collection::vec(-1.0..1.0f64, 25),
            x in proptest::collection::vec(-1.0..1.0f64, 5),
        ) {
            let n = 5;
            let mut a = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..n {
                    a[i * n + j] = (0..n).map(|k| g[i * n + k] * g[j * n + k]).sum::<f64>()
                        + f64::from(u8::from(i == j));
                }
            }
            let mut b = times(&a, n, &x);
            factor_symmetric(&mut a, n).unwrap();
            solve_symmetric(&a, n, &mut b);
            for (b, x) in b.iter().zip(&x) {
                prop_assert!((b - x).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn square_solves_exchange_rows_and_tell_singular_matrices() {
        let mut a = [0.0, 2.0, 1.0, 1.0, 1.0, 1.0, 4.0, -1.0, 0.5];
        let x = [3.0, -2.0, 0.25];
        let mut b = times(&a, 3, &x);
        assert!(solve_square(&mut a, &mut b));
        assert!(b.iter().zip(x).all(|(b, x)| (b - x).abs() < 1e-14), "{b:?}");
        assert!(!solve_square(&mut [1.0, 2.0, 2.0, 4.0], &mut [1.0, 1.0]));
    }

    #[test]
    fn a_repeated_row_is_named() {
        let mut a = vec![2.0, 1.0, 2.0, 1.0, 3.0, 1.0, 2.0, 1.0, 2.0];
        assert_eq!(factor_symmetric(&mut a, 3), Err(Singular { row: 2 }));
    }
}
