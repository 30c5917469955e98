//! The nearest point at which linear conditions hold, in time that grows with their coefficients.

use super::cascade::Row;
use super::symmetric::Symmetric;
use crate::scalar::Scalar;

/// Solutions for what rounding has left of the one before.
const PASSES: usize = 3;
/// Conditions that make more than this of an error are left to others.
const WORST: f64 = 1e6;

/// The x that minimises
/// ```text
/// Σ (wₖ xₖ + eₖ)² + Σ (a x + e)² over soft rows,   with a x + e = 0 in each hard row
/// ```
/// where row k of `near` has the one coefficient wₖ. By multipliers: (R W⁻² Rᵀ + D) λ = R x̂ + e, with
/// D = 1 for soft rows and 0 for hard ones, x = x̂ − W⁻² Rᵀ λ. Returns with it the condition number of
/// the hard rows; `None` where they depend on each other, or nearly do.
pub fn nearest<S: Scalar>(
    hard: &[&[Row<S>]],
    soft: &[Row<S>],
    near: &[Row<S>],
) -> Option<(Vec<S>, f64)> {
    let weights: Vec<S> = near.iter().map(|row| row.coefficients[0].1).collect();
    let mobility: Vec<S> = weights.iter().map(|w| S::one() / (*w * *w)).collect();
    let mut x: Vec<S> = near.iter().zip(&weights).map(|(row, w)| -row.error / *w).collect();
    let hard_rows: usize = hard.iter().map(|rows| rows.len()).sum();
    let rows: Vec<&Row<S>> = hard.iter().copied().flatten().chain(soft).collect();
    let mut matrix = coupled(&rows, hard_rows, &mobility);
    let largest = matrix.diagonal().take(hard_rows).fold(0.0, f64::max);
    matrix.factor().ok()?;
    let smallest = matrix.pivots().take(hard_rows).fold(f64::INFINITY, f64::min);
    let condition = if hard_rows == 0 { 1.0 } else { (largest / smallest).sqrt() };
    if !(condition <= WORST) {
        return None;
    }
    let mut multipliers = vec![S::zero(); rows.len()];
    for _ in 0..PASSES {
        let mut left: Vec<S> = rows.iter().map(|row| row.at(&x)).collect();
        left[hard_rows..].iter_mut().zip(&multipliers[hard_rows..]).for_each(|(r, l)| *r -= *l);
        matrix.solve(&mut left);
        for ((row, change), multiplier) in rows.iter().zip(left).zip(&mut multipliers) {
            *multiplier += change;
            row.coefficients.iter().for_each(|(k, a)| x[*k] -= mobility[*k] * *a * change);
        }
    }
    x.iter().all(|x| x.is_finite()).then_some((x, condition))
}

/// R W⁻² Rᵀ + D.
fn coupled<S: Scalar>(rows: &[&Row<S>], hard_rows: usize, mobility: &[S]) -> Symmetric<S> {
    let mut sharing = vec![Vec::new(); mobility.len()];
    for (row, Row { coefficients, .. }) in rows.iter().enumerate() {
        coefficients.iter().for_each(|(k, a)| sharing[*k].push((row, *a)));
    }
    // rows come in their order
    let pairs = || {
        sharing.iter().zip(mobility).flat_map(|(sharing, mobility)| {
            sharing.iter().enumerate().flat_map(move |(at, (row, a))| {
                let before = &sharing[..=at];
                before.iter().map(move |(column, b)| (*row, *column, *a * *b * *mobility))
            })
        })
    };
    let mut matrix = Symmetric::new(rows.len(), pairs().map(|(row, column, _)| (row, column)));
    for (row, column, product) in pairs() {
        let place = matrix.place(row, column);
        matrix.entries_mut()[place] += product;
    }
    for row in hard_rows..rows.len() {
        let place = matrix.place(row, row);
        matrix.entries_mut()[place] += S::one();
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::super::cascade::Cascade;
    use super::*;
    use proptest::prelude::*;

    fn row(numbers: &[f64]) -> Row<f64> {
        let (error, coefficients) = numbers.split_last().unwrap();
        Row { coefficients: coefficients.iter().copied().enumerate().collect(), error: *error }
    }

    proptest! {
        #[test]
        fn it_is_what_the_cascade_finds(
            g in proptest::collection::vec(-1.0..1.0f64, 54),
            weights in proptest::collection::vec(0.3..1.0f64, 8),
        ) {
            let rows: Vec<Row<f64>> = g.chunks(9).map(row).collect();
            let near: Vec<Row<f64>> = (weights.iter().enumerate())
                .map(|(k, w)| Row { coefficients: vec![(k, *w)], error: *w * 0.1 * k as f64 })
                .collect();
            let (hard, soft) = rows.split_at(3);
            let mut cascade = Cascade::new(8);
            let worst = cascade.minimise(hard, None, 1e-12);
            let both: Vec<_> = soft.iter().chain(&near).cloned().collect();
            cascade.minimise(&both, None, 0.0);
            let Some((x, condition)) = nearest(&[&hard[..1], &hard[1..]], soft, &near) else {
                prop_assert!(worst > 1e5);
                return Ok(());
            };
            for (x, other) in x.iter().zip(cascade.x()) {
                prop_assert!((x - other).abs() < 1e-12 * condition, "{x} {other}");
            }
            for row in hard {
                prop_assert!(row.at(&x).abs() < 1e-14 * condition, "{:e}", row.at(&x));
            }
        }
    }

    #[test]
    fn conditions_that_say_the_same_are_not_solved() {
        let twice = [row(&[1.0, 2.0, 3.0, 0.5]), row(&[2.0, 4.0, 6.0, 1.0])];
        let near: Vec<_> =
            (0..3).map(|k| Row { coefficients: vec![(k, 1.0)], error: 0.0 }).collect();
        assert!(nearest(&[&twice], &[], &near).is_none());
        assert!(nearest(&[&twice[..1]], &[], &near).is_some());
    }
}
