//! Extremes between samples.
//!
//! A sample that neither neighbour exceeds brackets a maximum. Where the function itself can be
//! evaluated, a golden-section search finds it. Where there are only samples, a parabola goes
//! through three of them and a polynomial of degree four through five; the larger degree gives
//! the value, twice the difference of the two what it may be off by. No polynomial reaches over an
//! event, where the curve has a kink in some derivative.

use super::tally::{Basis, Extreme, Tally};

/// Rounds of the golden section: each shortens the bracket to 0.618, and the value at an extreme
/// changes with the square of the time, so that 1e-8 of the bracket is more than enough.
const ROUNDS: usize = 40;

/// How much larger than the difference of two degrees an error is allowed to be.
const MARGIN: f64 = 2.0;

/// Time and value of the maximum of a function inside a bracket.
pub(super) fn maximum<E>(
    [mut left, mut right]: [f64; 2],
    mut f: impl FnMut(f64) -> Result<f64, E>,
) -> Result<(f64, f64), E> {
    let golden = (5_f64.sqrt() - 1.0) / 2.0;
    let mut low = right - golden * (right - left);
    let mut high = left + golden * (right - left);
    let (mut at_low, mut at_high) = (f(low)?, f(high)?);
    for _ in 0..ROUNDS {
        if at_low > at_high {
            (right, high, at_high) = (high, low, at_low);
            low = right - golden * (right - left);
            at_low = f(low)?;
        } else {
            (left, low, at_low) = (low, high, at_high);
            high = left + golden * (right - left);
            at_high = f(high)?;
        }
    }
    Ok(if at_low > at_high { (low, at_low) } else { (high, at_high) })
}

/// Whether the middle of three values is a maximum that is more than rounding.
pub(super) fn stands_out([before, middle, after]: [f64; 3]) -> bool {
    middle > before && middle >= after && middle - before.min(after) > 1e-12 * middle.abs()
}

/// Takes every sample of a curve, and its extremes between them. `breaks` are the rising times
/// (s) of events.
pub(super) fn take_samples(tally: &mut Tally, times: &[f64], values: &[f64], breaks: &[f64]) {
    for (&time, &value) in times.iter().zip(values) {
        tally.take(Extreme::new(value, time, Basis::Sample));
    }
    for k in 1..times.len().min(values.len()).saturating_sub(1) {
        for &sign in tally.signs() {
            if stands_out([k - 1, k, k + 1].map(|k| sign * values[k]))
                && let Some(found) = between(times, values, breaks, k, sign)
            {
                tally.take(found);
            }
        }
    }
}

/// The maximum of `sign` · curve beside sample `k`, if the samples tell of one.
fn between(times: &[f64], values: &[f64], breaks: &[f64], k: usize, sign: f64) -> Option<Extreme> {
    let smooth = |first: usize, last: usize| {
        let next = breaks.partition_point(|event| *event <= times[first]);
        breaks.get(next).is_none_or(|event| *event >= times[last])
    };
    if !smooth(k - 1, k + 1) {
        return None;
    }
    let bracket = [times[k - 1], times[k + 1]];
    let peak = |first: usize, last: usize| {
        let polynomial = Polynomial::through(&times[first..=last], &values[first..=last]);
        let found: Result<_, std::convert::Infallible> =
            maximum(bracket, |time| Ok(sign * polynomial.at(time)));
        let Ok((time, value)) = found;
        (time, sign * value)
    };
    let (time, parabola) = peak(k - 1, k + 1);
    let wide = k >= 2
        && k + 2 < times.len()
        && smooth(k - 2, k + 2)
        && (values[k - 2] + values[k + 2]).is_finite();
    let (time, value, difference) = match wide {
        true => {
            let (time, value) = peak(k - 2, k + 2);
            (time, value, (value - parabola).abs())
        }
        false => (time, parabola, (parabola - values[k]).abs()),
    };
    let gain = sign * (value - values[k]);
    // a correction that is less sure than it is large corrects nothing
    let trusted = gain >= 0.0 && difference <= gain;
    Some(match trusted {
        true => Extreme {
            value,
            time,
            basis: Basis::Interpolated,
            uncertainty: Some(MARGIN * difference),
        },
        false => Extreme {
            value: values[k],
            time: times[k],
            basis: Basis::Sample,
            uncertainty: Some(MARGIN * difference.max(gain.abs())),
        },
    })
}

/// A polynomial in Newton's form.
struct Polynomial<'a> {
    nodes: &'a [f64],
    differences: [f64; 5],
}

impl<'a> Polynomial<'a> {
    /// Through up to five points of rising times.
    fn through(nodes: &'a [f64], values: &[f64]) -> Self {
        let mut differences = [0.0; 5];
        differences[..values.len()].copy_from_slice(values);
        for order in 1..nodes.len() {
            for k in (order..nodes.len()).rev() {
                differences[k] =
                    (differences[k] - differences[k - 1]) / (nodes[k] - nodes[k - order]);
            }
        }
        Polynomial { nodes, differences }
    }

    fn at(&self, time: f64) -> f64 {
        let terms = self.nodes.iter().zip(&self.differences).rev();
        terms.fold(0.0, |sum, (node, difference)| sum * (time - node) + difference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tallied(f: impl Fn(f64) -> f64, times: &[f64], breaks: &[f64]) -> Tally {
        let values: Vec<f64> = times.iter().map(|time| f(*time)).collect();
        let mut tally = Tally::new(None, true);
        take_samples(&mut tally, times, &values, breaks);
        tally
    }

    #[test]
    fn the_golden_section_finds_a_maximum_to_half_the_digits_of_its_time() {
        let f = |t: f64| Ok::<f64, ()>(3.0 - (t - 0.3).powi(2));
        let (time, value) = maximum([0.0, 1.0], f).unwrap();
        assert!((time - 0.3).abs() < 2e-8 && (value - 3.0).abs() < 1e-15, "{time} {value}");
    }

    #[test]
    fn a_polynomial_of_degree_four_is_found_exactly_at_uneven_times() {
        let f = |t: f64| 2.0 + 0.3 * t - (t - 0.4).powi(2) - 0.5 * (t - 0.4).powi(4);
        let tally = tallied(f, &[-0.5, 0.0, 0.3, 0.9, 1.0], &[]);
        let largest = tally.total.largest.unwrap();
        assert_eq!(largest.basis, Basis::Interpolated);
        // f' = 0 at s = t − 0.4 with 0.3 − 2 s − 2 s³ = 0
        let s = 0.146834212396;
        let exact = f(0.4 + s);
        assert!((largest.value - exact).abs() < 1e-12, "{} vs {exact}", largest.value);
    }

    #[test]
    fn the_uncertainty_covers_the_error_of_a_sampled_sine() {
        for samples in [12, 30, 100] {
            let step = std::f64::consts::TAU / f64::from(samples);
            let times: Vec<f64> = (0..=samples).map(|k| (f64::from(k) + 0.37) * step).collect();
            let tally = tallied(f64::sin, &times, &[]);
            for (extreme, exact) in [(tally.total.largest, 1.0), (tally.total.smallest, -1.0)] {
                let extreme = extreme.unwrap();
                let error = (extreme.value - exact).abs();
                assert_eq!(extreme.basis, Basis::Interpolated);
                assert!(error <= extreme.uncertainty.unwrap(), "{samples}: {extreme:?}");
                // the error term of the interpolation, f⁽⁵⁾ h⁵ / 5! · |Π(s − k)|, at most 3.7
                assert!(error < 3.7 / 120.0 * step.powi(5), "{samples}: {error}");
            }
        }
    }

    #[test]
    fn nothing_is_interpolated_over_an_event() {
        let tent = |t: f64| 1.0 - (t - 0.55).abs();
        let times: Vec<f64> = (0..=10).map(|k| f64::from(k) * 0.1).collect();
        let largest = tallied(tent, &times, &[0.55]).total.largest.unwrap();
        assert_eq!(largest.basis, Basis::Sample);
        assert!((largest.value - 0.95).abs() < 1e-15, "{largest:?}");
    }

    #[test]
    fn steady_and_missing_values_have_no_extremes_between_samples() {
        let times = [0.0, 1.0, 2.0, 3.0];
        let tally = tallied(|_| 4.0, &times, &[]);
        assert_eq!(tally.total.largest.unwrap().basis, Basis::Sample);
        assert_eq!(tallied(|_| f64::NAN, &times, &[]).total.largest, None);
        assert_eq!(tallied(|t| t, &[], &[]).total.largest, None);
        assert_eq!(tallied(|t| t, &[1.0], &[]).total.largest.unwrap().value, 1.0);
    }
}
