//! Interpolating spline of the fifth degree through points, four times differentiable.
//! ```text
//! s(x) = Σ_r c_r (x − k)^r  between a knot k and the next,   s(x_i) = y_i
//! ```
//! Inner knots are the points but for the first three and the last three of them (not-a-knot), so
//! that every polynomial of the fifth degree is its own spline, and a smooth curve is met to the
//! sixth power of the distance of points. Up to six points are joined by the one polynomial through
//! them.
//!
//! Source: C. de Boor, *A Practical Guide to Splines*, revised edition, Springer 2001, chapters IX, X
//! and XIII: B-splines by recurrence, and their collocation matrix, which is banded, totally positive
//! and so solved without pivoting. Solved in 71 digits, whatever arithmetic the spline is for.

use crate::parameter::Values;
use crate::scalar::{Decimal, F256, Lift, Scalar};
use std::sync::Arc;

/// Degree where there are points enough.
const DEGREE: usize = 5;

/// A spline through points; outside of them it keeps the value of the first, or of the last.
#[derive(Debug, Clone)]
pub struct Spline<S> {
    pieces: Arc<[Piece<S>]>,
    /// Every knot, first and last among them.
    knots: Arc<[S]>,
}

/// What must hold for the points of a spline: the first two keys of a kind, and its `file`.
pub(crate) fn points(values: &Values) -> Vec<(&'static str, String)> {
    let [first, second] = [0, 1].map(|k| values.kind().keys[k].name);
    let there = |key| values.get(key).is_some();
    match (there(first), there(second)) {
        (false, false) => return vec![(first, format!("is missing, with {second}; or file"))],
        (true, false) => return vec![(second, format!("is missing beside {first}"))],
        (false, true) => return vec![(first, format!("is missing beside {second}"))],
        (true, true) => {}
    }
    let (x, y) = (values.numbers(first), values.numbers(second));
    let mut wrong = Vec::new();
    for (key, numbers) in [(first, x), (second, y)] {
        let place = numbers.iter().position(|number| !number.to_f64().is_finite());
        if let Some(place) = place {
            let number = &numbers[place];
            wrong.push((key, format!("must be finite, number {} is {number}", place + 1)));
        }
    }
    for (key, numbers) in [(first, x), (second, y)] {
        if numbers.len() < 2 {
            wrong.push((key, format!("must be two or more, are {}", numbers.len())));
        }
    }
    if x.len() != y.len() && wrong.is_empty() {
        let message = format!("are {} for {} {first}: there must be as many", y.len(), x.len());
        wrong.push((second, message));
    }
    let value = |number: &Decimal| number.value::<F256>();
    // told as doubles they must differ too
    let falls = |pair: &[Decimal]| {
        !(value(&pair[0]) < value(&pair[1]) && pair[0].to_f64() < pair[1].to_f64())
    };
    if let Some(place) = x.windows(2).position(falls) {
        let [before, here] = [&x[place], &x[place + 1]];
        let number = place + 2;
        wrong.push((first, format!("must increase, number {number} is {here} after {before}")));
    }
    wrong
}

/// A polynomial from a knot on: its coefficients, the constant first.
#[derive(Debug, Clone, Copy)]
struct Piece<S> {
    from: S,
    coefficients: [S; DEGREE + 1],
}

impl<S: Scalar> Spline<S> {
    /// The spline through points (x, y), two or more, whose x increase strictly.
    pub fn through(points: &[(F256, F256)]) -> Self {
        let degree = DEGREE.min(points.len() - 1);
        let (first, last) = (points[0].0, points[points.len() - 1].0);
        let inner = match points.len() > DEGREE + 1 {
            true => &points[3..points.len() - 3],
            false => &[],
        };
        let mut knots = vec![first; degree + 1];
        knots.extend(inner.iter().map(|(x, _)| *x));
        knots.extend(std::iter::repeat_n(last, degree + 1));
        let weights = collocate(&knots, degree, points);
        let spans = degree..knots.len() - degree - 1;
        let piece = |span: usize| Piece {
            from: S::from_octuple(knots[span]),
            coefficients: taylor(&knots, degree, &weights, span).map(S::from_octuple),
        };
        Spline {
            pieces: spans.map(piece).collect(),
            knots: knots[degree..knots.len() - degree]
                .iter()
                .map(|x| S::from_octuple(*x))
                .collect(),
        }
    }

    /// The spline through the numbers of a kind whose first two keys they are.
    pub fn of(values: &Values) -> Self {
        let [x, y] = [0, 1].map(|k| values.numbers(values.kind().keys[k].name));
        let points: Vec<_> = x.iter().zip(y).map(|(x, y)| (x.value(), y.value())).collect();
        Spline::through(&points)
    }

    /// Whether x is not outside of the points.
    pub fn covers<T: Lift<S>>(&self, x: T) -> bool {
        x >= T::lift(self.knots[0]) && x <= T::lift(self.knots[self.knots.len() - 1])
    }

    /// Where its fifth derivative may jump, and where it begins and ends.
    pub fn knots(&self) -> &[S] {
        &self.knots
    }

    /// The span between knots that x is in: 0 before the first knot, 1 behind it, and so on.
    pub fn span(&self, x: S) -> usize {
        self.knots.partition_point(|knot| *knot <= x)
    }

    /// The knots on either side of a span, where it has some.
    pub fn ends(&self, span: usize) -> [Option<S>; 2] {
        [span.checked_sub(1), Some(span)].map(|knot| self.knots.get(knot?).copied())
    }

    /// Value of the polynomial of a span at x, whether or not x is in it; outside of the points the
    /// first or the last value.
    pub fn at_span<T: Lift<S>>(&self, span: usize, x: T) -> T {
        let last = self.knots.len();
        let within = match span {
            0 => T::lift(self.knots[0]),
            span if span >= last => T::lift(self.knots[last - 1]),
            _ => x,
        };
        let Piece { from, coefficients } = &self.pieces[span.clamp(1, self.pieces.len()) - 1];
        let x = within - T::lift(*from);
        coefficients.iter().rev().fold(T::zero(), |sum, c| sum * x + T::lift(*c))
    }

    /// Value and two derivatives at x.
    pub fn at<T: Lift<S>>(&self, x: T) -> [T; 3] {
        let (first, last) = (T::lift(self.knots[0]), T::lift(self.knots[self.knots.len() - 1]));
        let within = if x < first {
            first
        } else if x > last {
            last
        } else {
            x
        };
        let piece = self.pieces.partition_point(|piece| T::lift(piece.from) <= within).max(1) - 1;
        let Piece { from, coefficients } = &self.pieces[piece];
        let x = within - T::lift(*from);
        let zero = T::zero();
        let [value, rate, bend] = coefficients.iter().rev().fold([zero; 3], |sum, c| {
            let [value, rate, bend] = sum;
            [value * x + T::lift(*c), rate * x + value, bend * x + rate]
        });
        [value, rate, bend + bend]
    }
}

/// The B-splines of a degree that are not zero between knot `span` and the next, at x.
fn basis(knots: &[F256], degree: usize, span: usize, x: F256) -> Vec<F256> {
    let mut values = vec![F256::from(1)];
    for d in 1..=degree {
        let mut next = vec![F256::from(0); d + 1];
        for (k, value) in values.iter().enumerate() {
            let (left, right) = (knots[span + 1 + k - d], knots[span + 1 + k]);
            let share = *value / (right - left);
            next[k] += share * (right - x);
            next[k + 1] += share * (x - left);
        }
        values = next;
    }
    values
}

/// The weights of the B-splines with which their sum goes through the points.
fn collocate(knots: &[F256], degree: usize, points: &[(F256, F256)]) -> Vec<F256> {
    let count = points.len();
    let width = 2 * degree + 1;
    // entry (i, j) stands at i · width + j + degree − i
    let mut matrix = vec![F256::from(0); count * width];
    let mut weights: Vec<F256> = points.iter().map(|(_, y)| *y).collect();
    let mut span = degree;
    for (i, (x, _)) in points.iter().enumerate() {
        while span + 1 < count && knots[span + 1] <= *x {
            span += 1;
        }
        for (k, value) in basis(knots, degree, span, *x).into_iter().enumerate() {
            matrix[i * width + (span + k) - i] = value;
        }
    }
    for pivot in 0..count {
        for row in pivot + 1..count.min(pivot + degree + 1) {
            let factor =
                matrix[row * width + pivot + degree - row] / matrix[pivot * width + degree];
            for column in pivot..count.min(pivot + degree + 1) {
                let above = matrix[pivot * width + column + degree - pivot];
                matrix[row * width + column + degree - row] -= factor * above;
            }
            let above = weights[pivot];
            weights[row] -= factor * above;
        }
    }
    for row in (0..count).rev() {
        for column in row + 1..count.min(row + degree + 1) {
            let known = weights[column];
            weights[row] -= matrix[row * width + column + degree - row] * known;
        }
        weights[row] /= matrix[row * width + degree];
    }
    weights
}

/// Coefficients of the polynomial from knot `span` to the next, by powers of the way from there.
fn taylor(knots: &[F256], degree: usize, weights: &[F256], span: usize) -> [F256; DEGREE + 1] {
    let mut coefficients = [F256::from(0); DEGREE + 1];
    let mut differences = weights[span - degree..=span].to_vec();
    let mut scale = F256::from(1);
    for (order, coefficient) in coefficients.iter_mut().enumerate().take(degree + 1) {
        let left = degree - order;
        let basis = basis(knots, left, span, knots[span]);
        let sum = basis.iter().zip(&differences).map(|(b, w)| *b * *w);
        *coefficient = scale * sum.fold(F256::from(0), |sum, term| sum + term);
        scale /= F256::from(order as u64 + 1);
        let steep = |k: usize| {
            let at = span + 1 + k;
            let over = knots[at] - knots[at - left];
            F256::from(left as u64) * (differences[k + 1] - differences[k]) / over
        };
        differences = (0..left).map(steep).collect();
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual64;

    fn points(count: usize, f: impl Fn(F256) -> F256) -> Vec<(F256, F256)> {
        // neither even nor from zero
        let x = |k: usize| F256::from_f64(0.1 + k as f64 * 0.3 + 0.05 * (k as f64 * 1.7).sin());
        (0..count).map(|k| (x(k), f(x(k)))).collect()
    }

    #[test]
    fn polynomials_of_the_fifth_degree_are_their_own_splines() {
        let powers = |x: F256| {
            let n = |k: i32| F256::from(k);
            [
                ((((n(2) * x - n(3)) * x + n(5)) * x - n(7)) * x + n(11)) * x - n(13),
                (((n(10) * x - n(12)) * x + n(15)) * x - n(14)) * x + n(11),
                ((n(40) * x - n(36)) * x + n(30)) * x - n(14),
            ]
        };
        for count in [6, 7, 8, 9, 12, 40] {
            let points = points(count, |x| powers(x)[0]);
            let (exact, double) =
                (Spline::<F256>::through(&points), Spline::<f64>::through(&points));
            let (first, last) = (points[0].0, points[count - 1].0);
            for k in 0..=100 {
                let x = first + (last - first) * F256::ratio(k, 100);
                let known = powers(x);
                for (part, known) in exact.at(x).into_iter().zip(known) {
                    let off = ((part - known) / (known.abs() + F256::from(1))).abs().to_f64();
                    assert!(off < 1e-60, "{count} points: {off:e}");
                }
                for (part, known) in double.at(x.to_f64()).into_iter().zip(known) {
                    let off = (part - known.to_f64()).abs() / (1.0 + known.to_f64().abs());
                    assert!(off < 1e-13, "{count} points: {off:e}");
                }
            }
        }
    }

    #[test]
    fn few_points_have_the_polynomial_through_them() {
        let line = Spline::<f64>::through(&points(2, |x| F256::from(3) * x));
        assert!((line.at(0.2)[0] - 0.6).abs() < 1e-15 && line.at(0.2)[2] == 0.0);
        let cubic = Spline::<f64>::through(&points(4, |x| x * x * x));
        assert!((cubic.at(0.5)[0] - 0.125).abs() < 1e-15);
        assert!((cubic.at(0.5)[2] - 3.0).abs() < 1e-13);
    }

    #[test]
    fn four_derivatives_go_on_through_the_knots() {
        let spline = Spline::<F256>::through(&points(20, |x| x.sin_cos().0));
        assert_eq!(spline.knots().len(), 2 + 20 - 6);
        for pair in spline.pieces.windows(2) {
            let far = pair[1].from - pair[0].from;
            let [before, after] = [&pair[0].coefficients, &pair[1].coefficients];
            for (order, after) in after.iter().enumerate().take(DEGREE) {
                let choose =
                    |n: usize| (0..order).fold(1.0, |c, k| c * (n - k) as f64 / (k + 1) as f64);
                let sum = (order..=DEGREE).rev().fold(F256::from(0), |sum, n| {
                    sum * far + before[n] * F256::from_f64(choose(n))
                });
                assert!((sum - *after).abs().to_f64() < 1e-60, "derivative {order}");
            }
        }
    }

    #[test]
    fn a_smooth_curve_is_met_to_the_sixth_power_of_the_distance() {
        let miss = |count: i64| {
            let at = |k: i64| F256::ratio(3 * k, count);
            let points: Vec<_> = (0..=count).map(|k| (at(k), at(k).sin_cos().0)).collect();
            let spline = Spline::<f64>::through(&points);
            let off = |k: i32| {
                let x = 3e-3 * f64::from(k);
                (spline.at(x)[0] - x.sin()).abs()
            };
            (0..=1000).map(off).fold(0.0, f64::max)
        };
        let (coarse, fine) = (miss(20), miss(40));
        assert!(fine < 1e-8 && coarse / fine > 40.0, "{coarse:e} {fine:e}");
    }

    #[test]
    fn it_keeps_its_ends_and_knows_its_slope() {
        let spline = Spline::<f64>::through(&points(9, |x| x * x));
        let (first, last) = (spline.knots()[0], spline.knots()[spline.knots().len() - 1]);
        assert!((spline.at(first - 1.0)[0] - first * first).abs() < 1e-15);
        assert!((spline.at(last + 1.0)[0] - last * last).abs() < 1e-13);
        let dual = spline.at(Dual64::new(1.3, 1.0))[0];
        assert!((dual.eps - 2.6).abs() < 1e-13 && (dual.re - 1.69).abs() < 1e-13);
        assert_eq!(spline.at(Dual64::new(last + 1.0, 1.0))[0].eps, 0.0);
    }
}
