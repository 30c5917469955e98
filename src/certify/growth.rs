//! The rate at which errors grow.
//!
//! ```text
//! ln g(t) ≈ a + r t
//! ```
//! fitted by least squares, every sample weighed by the time it stands for. The two ends alone
//! would depend on the direction of the first error, and on whether the last moment is one of
//! contact: over five revolutions of the paper's mechanisms by a twentieth to a tenth of r.

/// Exponential rate r (1/s) of (time (s), growth); `None` of fewer than two times, or where the
/// growth is not a positive number.
pub(super) fn rate(growth: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let points: Vec<(f64, f64)> = growth.map(|(time, g)| (time, g.ln())).collect();
    let time = |i: usize| points[i.clamp(0, points.len() - 1)].0;
    let weights = (0..points.len()).map(|i| time(i + 1) - time(i.saturating_sub(1)));
    let mut sums = [0.0; 5];
    for ((t, ln), w) in points.iter().zip(weights) {
        for (sum, term) in sums.iter_mut().zip([1.0, *t, t * t, *ln, t * ln]) {
            *sum += w * term;
        }
    }
    let [one, t, tt, ln, t_ln] = sums;
    let rate = (one * t_ln - t * ln) / (one * tt - t * t);
    Some(rate).filter(|rate| rate.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponential_has_its_rate_however_it_is_sampled() {
        let times = [0.0_f64, 0.1, 0.11, 0.12, 0.5, 2.0];
        let rate = rate(times.iter().map(|t| (*t, 7.0 * (3.0 * t).exp()))).unwrap();
        assert!((rate - 3.0).abs() < 1e-12, "{rate}");
    }

    #[test]
    fn an_outlier_at_the_end_moves_the_rate_less_than_the_two_ends_would() {
        let grown =
            |k: i32| (f64::from(k), if k == 100 { 51f64.exp() } else { f64::from(k).exp() });
        let ends = (51.0 - 0.0) / 100.0;
        let rate = rate((0..=100).map(grown)).unwrap();
        assert!((rate - 1.0).abs() < 0.05 && f64::abs(ends - 1.0) > 0.4, "{rate}");
    }

    #[test]
    fn nothing_has_no_rate() {
        assert_eq!(rate(std::iter::empty()), None);
        assert_eq!(rate([(0.0, 1.0)].into_iter()), None);
        assert_eq!(rate([(0.0, 0.0), (1.0, 1.0)].into_iter()), None);
    }
}
