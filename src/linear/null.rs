//! The null space of symmetric positive semidefinite matrices, given row by row.

use super::dense::{factor_symmetric, solve_symmetric};
use crate::scalar::Scalar;

/// The order in which an elimination with complete pivoting takes the rows of a matrix, and what is left
/// of each when it is taken, over its diagonal entry. In doubles, which decide alike in any arithmetic.
pub fn pivots<S: Scalar>(a: &[S], n: usize) -> (Vec<usize>, Vec<f64>) {
    let size: Vec<f64> = (0..n).map(|k| a[k * n + k].to_f64().abs().sqrt()).collect();
    let scaled = |k: usize| {
        let (i, j) = (k / n, k % n);
        let both = size[i] * size[j];
        if both > 0.0 { a[k].to_f64() / both } else { 0.0 }
    };
    let mut left: Vec<f64> = (0..n * n).map(scaled).collect();
    let (mut order, mut pivots) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let mut open: Vec<usize> = (0..n).collect();
    while let Some(at) =
        (0..open.len()).max_by(|a, b| left[open[*a] * (n + 1)].total_cmp(&left[open[*b] * (n + 1)]))
    {
        let p = open.remove(at);
        let pivot = left[p * (n + 1)];
        order.push(p);
        pivots.push(pivot.max(0.0));
        if !(pivot > 0.0) {
            continue;
        }
        for i in &open {
            let factor = left[i * n + p] / pivot;
            for j in &open {
                left[i * n + j] -= factor * left[p * n + j];
            }
        }
    }
    (order, pivots)
}

/// An orthonormal basis of the directions in which a matrix does nothing, of which there are `count`; the
/// rows in `order` up to these are independent. `None` where they are not.
pub fn null_space<S: Scalar>(
    a: &[S],
    n: usize,
    order: &[usize],
    count: usize,
) -> Option<Vec<Vec<S>>> {
    let (taken, idle) = order.split_at(n - count);
    let r = taken.len();
    let mut factors: Vec<S> = (0..r * r).map(|k| a[taken[k / r] * n + taken[k % r]]).collect();
    factor_symmetric(&mut factors, r).ok()?;
    let mut basis: Vec<Vec<S>> = Vec::with_capacity(count);
    for column in idle {
        let mut x: Vec<S> = taken.iter().map(|row| a[row * n + column]).collect();
        solve_symmetric(&factors, r, &mut x);
        let mut direction = vec![S::zero(); n];
        direction[*column] = S::one();
        taken.iter().zip(x).for_each(|(row, x)| direction[*row] = -x);
        // twice is enough (Kahan, Parlett)
        for _ in 0..2 {
            for other in &basis {
                let along = dot(&direction, other);
                direction.iter_mut().zip(other).for_each(|(x, other)| *x -= along * *other);
            }
        }
        let size = dot(&direction, &direction).sqrt();
        direction.iter_mut().for_each(|x| *x = *x / size);
        basis.push(direction);
    }
    Some(basis)
}

fn dot<S: Scalar>(a: &[S], b: &[S]) -> S {
    a.iter().zip(b).fold(S::zero(), |sum, (a, b)| sum + *a * *b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_idle_is_found(x in prop::collection::vec(-2.0..2.0f64, 24)) {
            // six rows in a space of four
            let rows: Vec<&[f64]> = x.chunks(4).collect();
            let mut a: Vec<f64> = Vec::new();
            rows.iter().for_each(|one| a.extend(rows.iter().map(|other| dot(one, other))));
            let (order, pivots) = pivots(&a, 6);
            prop_assert!(pivots[4] < 1e-12 && pivots[5] < 1e-12, "{pivots:?}");
            prop_assume!(pivots[3] > 1e-4);
            let basis = null_space(&a, 6, &order, 2).unwrap();
            for (k, w) in basis.iter().enumerate() {
                for row in a.chunks(6) {
                    prop_assert!(dot(row, w).abs() < 1e-9, "{basis:?}");
                }
                for (l, other) in basis.iter().enumerate() {
                    let expected = f64::from(u8::from(k == l));
                    prop_assert!((dot(w, other) - expected).abs() < 1e-12);
                }
            }
        }
    }
}
