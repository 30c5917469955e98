//! Ensembles: many copies of a run whose starts differ by a little, revolution by revolution, held against
//! the revolutions of one long run.
//!
//! Beyond its horizon a run of a chaotic mechanism is one of many that its start could have led to. What
//! is left of the start is then what the copies have in common; once their distribution over a revolution is
//! that of the revolutions of one long run, nothing is (mixing).

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Resamples of a bootstrap.
const RESAMPLES: usize = 1000;
/// Of the intervals: shares of the resamples below either end (B. Efron 1979, percentiles).
const ENDS: [f64; 2] = [0.025, 0.975];
/// Kolmogorov's and Smirnov's distance that two samples of one distribution exceed in one case of a
/// hundred, times √(n m/(n + m)) (N. Smirnov 1948).
const CRITICAL: f64 = 1.628;
/// Share of the revolutions from some on that may differ by chance.
const BY_CHANCE: f64 = 0.05;

/// An ensemble of each run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnsemblePlan {
    /// Copies.
    pub copies: u64,
    /// Standard deviation of `run.disturbance`, by which their starts differ.
    pub spread: f64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Revolutions of the long run, those left out among them.
    pub long: u64,
}

/// The key of a case by which copies differ.
pub(super) const KEY: &str = "run.disturbance";

/// What is told of a number in a revolution: the ends of the columns' names, and what they are.
pub(super) const COLUMNS: [(&str, &str); 11] = [
    ("mean", "mean of the copies"),
    ("mean_low", "lower end of its 95 % interval, by bootstrap"),
    ("mean_high", "upper end of its 95 % interval, by bootstrap"),
    ("q05", "5 % of the copies are below"),
    ("q50", "half of the copies are below"),
    ("q95", "95 % of the copies are below"),
    ("long_mean", "mean over the revolutions of the long run"),
    ("long_low", "lower end of its 95 % interval, by bootstrap of batches"),
    ("long_high", "upper end of its 95 % interval, by bootstrap of batches"),
    ("distance", "largest difference of the distribution functions of copies and long run"),
    (
        "agrees_from",
        "revolution from which on copies and long run have one distribution; NaN: none",
    ),
];
/// Those that have no unit.
pub(super) const BARE: [&str; 2] = ["distance", "agrees_from"];

/// Batches that a long run is cut into: its revolutions depend on each other.
const BATCHES: usize = 50;

/// Rows of a number, one for each revolution: `copies` has the values of the copies by revolution, `long`
/// those of the long run's revolutions; `first` is the number of the first revolution.
pub(super) fn rows(
    copies: &[Vec<f64>],
    long: &[f64],
    first: u64,
    seed: u64,
) -> Vec<[f64; COLUMNS.len()]> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let all = sorted(long);
    let batches: Vec<f64> = long.chunks(long.len().div_ceil(BATCHES).max(1)).map(mean).collect();
    let [long_low, long_high] = interval(&batches, &mut random);
    let distances: Vec<f64> = copies.iter().map(|values| distance(&sorted(values), &all)).collect();
    let agrees: Vec<bool> = distances
        .iter()
        .zip(copies)
        .map(|(distance, values)| *distance <= critical(values.len(), long.len()))
        .collect();
    let from = agree_from(&agrees).map_or(f64::NAN, |k| (first + k as u64) as f64);
    (copies.iter().zip(&distances))
        .map(|(values, distance)| {
            let its = sorted(values);
            let [low, high] = interval(values, &mut random);
            let [q05, q50, q95] = [0.05, 0.5, 0.95].map(|share| quantile(&its, share));
            [
                mean(values),
                low,
                high,
                q05,
                q50,
                q95,
                mean(long),
                long_low,
                long_high,
                *distance,
                from,
            ]
        })
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values
}

/// The value below which lies a share of some, in their order.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len().saturating_sub(1)) as f64;
    let (below, part) = (place.floor() as usize, place.fract());
    match (sorted.get(below), sorted.get(below + 1)) {
        (Some(low), Some(high)) => low + part * (high - low),
        (Some(low), None) => *low,
        _ => f64::NAN,
    }
}

/// The 95 % interval of the mean of independent values, by the percentiles of a bootstrap.
fn interval(values: &[f64], random: &mut ChaCha8Rng) -> [f64; 2] {
    if values.is_empty() {
        return [f64::NAN; 2];
    }
    let mut resample = || {
        let drawn = (0..values.len()).map(|_| values[random.random_range(0..values.len())]);
        drawn.sum::<f64>() / values.len() as f64
    };
    let means = sorted(&(0..RESAMPLES).map(|_| resample()).collect::<Vec<_>>());
    ENDS.map(|share| quantile(&means, share))
}

/// The largest difference of the distribution functions of two samples, in their order.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let (mut i, mut j, mut most) = (0, 0, 0.0_f64);
    while i < a.len() && j < b.len() {
        let here = a[i].min(b[j]);
        i += a[i..].iter().take_while(|x| **x <= here).count();
        j += b[j..].iter().take_while(|x| **x <= here).count();
        most = most.max((i as f64 / a.len() as f64 - j as f64 / b.len() as f64).abs());
    }
    if a.is_empty() || b.is_empty() { f64::NAN } else { most }
}

fn critical(n: usize, m: usize) -> f64 {
    let (n, m) = (n as f64, m as f64);
    CRITICAL * ((n + m) / (n * m)).sqrt()
}

/// The first place that agrees, and from which on no more differ than chance has.
fn agree_from(agrees: &[bool]) -> Option<usize> {
    let mut differ = agrees.iter().filter(|agree| !**agree).count();
    for (k, agree) in agrees.iter().enumerate() {
        if *agree && differ as f64 <= BY_CHANCE * (agrees.len() - k) as f64 {
            return Some(k);
        }
        differ -= usize::from(!agree);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normal(count: usize, shift: f64, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // twelve uniform numbers have a variance of one
        let mut one = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0 + shift;
        (0..count).map(|_| one()).collect()
    }

    #[test]
    fn the_bootstrap_of_many_is_the_interval_of_the_normal_distribution() {
        let values = normal(400, 3.0, 1);
        let mut random = ChaCha8Rng::seed_from_u64(2);
        let [low, high] = interval(&values, &mut random);
        let variance = values.iter().map(|x| (x - mean(&values)).powi(2)).sum::<f64>() / 400.0;
        let half = 1.959964 * (variance / 400.0).sqrt();
        for (end, expected) in [(low, mean(&values) - half), (high, mean(&values) + half)] {
            assert!((end - expected).abs() < 0.15 * half, "{end} and {expected}");
        }
    }

    #[test]
    fn the_distance_is_that_of_kolmogorov_and_smirnov() {
        assert_eq!(distance(&[1.0, 2.0, 3.0, 4.0], &[1.0, 2.0, 3.0, 4.0]), 0.0);
        assert_eq!(distance(&[1.0, 2.0], &[3.0, 4.0]), 1.0);
        assert_eq!(distance(&[1.0, 2.0, 3.0, 4.0], &[2.5]), 0.5);
        // ties count on both sides at once
        assert_eq!(distance(&[1.0, 1.0, 2.0], &[1.0, 2.0, 2.0]), 1.0 / 3.0);
        assert!(distance(&[], &[1.0]).is_nan());
    }

    #[test]
    fn copies_agree_with_the_long_run_once_they_have_its_distribution() {
        let long = normal(2000, 0.0, 3);
        // they begin as one, drift apart, and are spread as the long run's from the sixth on
        let copies: Vec<Vec<f64>> = (0..40)
            .map(|k| match k {
                0..6 => normal(200, 2.0 - 0.3 * f64::from(k), 10 + k as u64),
                _ => normal(200, 0.0, 10 + k as u64),
            })
            .collect();
        let rows = rows(&copies, &long, 30, 1);
        assert_eq!(rows.len(), 40);
        assert!(rows.iter().all(|row| row[10] == 36.0), "{}", rows[0][10]);
        let within = rows[6..].iter().filter(|row| row[1] < 0.0 && row[2] > 0.0).count();
        assert!(within >= 28, "{within} of 34 intervals hold the mean");
        // copies that are one another never do
        let alike = vec![vec![1.0; 200]; 40];
        assert!(super::rows(&alike, &long, 0, 1)[0][10].is_nan());
    }
}
