//! When samples are taken.

use crate::scalar::{Decimal, F256, Scalar};

/// Sample times: the multiples k · interval from 0 to the duration, both ends included; the
/// duration itself where it is no multiple. Each is the decimal product, rounded once. Or any
/// times within the duration.
#[derive(Debug, Clone)]
pub struct Schedule {
    duration: F256,
    grid: Grid,
    adaptive: bool,
}

/// The sample times that are known beforehand.
#[derive(Debug, Clone)]
enum Grid {
    Uniform {
        interval: F256,
        /// Number of multiples of the interval, zero among them.
        multiples: u64,
        ends_between: bool,
    },
    At(Vec<Decimal>),
}

/// How many times an interval fits into a duration (s), and whether nothing is left.
pub(super) fn multiples(duration: F256, interval: F256) -> (u64, bool) {
    let quotient = duration / interval;
    // a quotient of decimals that is whole may come out an ulp beside
    let nearest = quotient.round();
    let whole = (quotient - nearest).abs() <= quotient * F256::from_f64(1e-60);
    let last = if whole { nearest } else { quotient.floor() };
    (last.to_f64() as u64, whole)
}

impl Schedule {
    /// The schedule of a run of `duration` (s) sampled every `interval` (s), both positive.
    pub fn new(duration: &Decimal, interval: &Decimal) -> Self {
        let (duration, interval): (F256, F256) = (duration.value(), interval.value());
        let (last, whole) = multiples(duration, interval);
        // times are told as doubles: a multiple with the double of the duration is the duration
        let end = F256::from(last) * interval;
        let told_as_the_end = !whole && end.to_f64() >= duration.to_f64();
        let multiples = last + u64::from(!told_as_the_end);
        let grid = Grid::Uniform { interval, multiples, ends_between: !whole };
        Schedule { duration, grid, adaptive: false }
    }

    /// The same run, sampled at these times (s) and nowhere else: one or more, strictly increasing,
    /// none negative, none beyond the duration rounded to a double. Each means the shortest decimal
    /// that reads back as it, as numbers of a case do: so the times that a result file holds are
    /// those its samples were taken at, in any arithmetic.
    pub fn at(self, times: Vec<f64>) -> Self {
        let last = times.last().copied().unwrap_or(f64::NAN);
        let within = times.first() >= Some(&0.0) && last <= self.duration.to_f64();
        let increasing = times.windows(2).all(|pair| pair[0] < pair[1]);
        assert!(within && increasing, "sample times increase from 0 to the duration");
        let times = times.into_iter().map(Decimal::from).collect();
        Schedule { grid: Grid::At(times), adaptive: false, ..self }
    }

    /// The same, with samples at every event and peak, and between them wherever straight lines
    /// would miss the force curves by more than 1 % of their peaks.
    pub fn adaptive(self) -> Self {
        Schedule { adaptive: true, ..self }
    }

    /// Whether samples are added where things happen.
    pub fn is_adaptive(&self) -> bool {
        self.adaptive
    }

    /// Number of samples, those added where things happen left out.
    pub fn len(&self) -> u64 {
        match &self.grid {
            Grid::Uniform { multiples, ends_between, .. } => multiples + u64::from(*ends_between),
            Grid::At(times) => times.len() as u64,
        }
    }

    /// Whether there are no samples: never.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Time of sample `k` (s).
    pub fn time<S: Scalar>(&self, k: u64) -> S {
        match &self.grid {
            Grid::Uniform { interval, multiples, .. } if k < *multiples => {
                // the product, rounded, may pass a duration that it equals in decimals
                S::from_octuple((F256::from(k) * *interval).min(self.duration))
            }
            Grid::Uniform { .. } => self.duration(),
            // a duration with more digits than a double has may lie before its own rounding
            Grid::At(times) => times[k as usize].value::<S>().min(self.duration()),
        }
    }

    /// Whether sample `k` is that of the duration where this is no multiple of the interval: a longer
    /// run has none there.
    pub(super) fn is_only_of_the_end(&self, k: u64) -> bool {
        match &self.grid {
            Grid::Uniform { multiples, ends_between, .. } => *ends_between && k == *multiples,
            Grid::At(_) => false,
        }
    }

    /// Duration of the run (s).
    pub fn duration<S: Scalar>(&self) -> S {
        S::from_octuple(self.duration)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn schedule(duration: &str, interval: &str) -> Schedule {
        Schedule::new(&Decimal::new(duration).unwrap(), &Decimal::new(interval).unwrap())
    }

    #[test]
    fn both_ends_are_sampled() {
        let schedule = schedule("0.060", "1e-5");
        assert_eq!(schedule.len(), 6001);
        assert_eq!(schedule.time::<f64>(0), 0.0);
        assert_eq!(schedule.time::<f64>(6000), 0.06);
    }

    #[test]
    fn sample_times_are_the_rounded_decimals() {
        let schedule = schedule("1", "1e-5");
        for (k, literal) in [(3, 3e-5), (7, 7e-5), (99_999, 0.99999)] {
            assert_eq!(schedule.time::<f64>(k), literal);
        }
    }

    #[test]
    fn a_duration_between_two_multiples_is_sampled_too() {
        let schedule = schedule("0.25", "0.1");
        let times: Vec<f64> = (0..schedule.len()).map(|k| schedule.time(k)).collect();
        assert_eq!(times, [0.0, 0.1, 0.2, 0.25]);
    }

    #[test]
    fn no_time_is_told_twice_however_many_digits_the_interval_has() {
        for (duration, interval) in [
            ("0.3", "0.09999999999999999999"),
            ("1", "0.33333333333333333333"),
            ("0.06", "9.9999999999999999999e-6"),
        ] {
            let schedule = schedule(duration, interval);
            let times: Vec<f64> = (0..schedule.len()).map(|k| schedule.time(k)).collect();
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{duration} by {interval}");
            assert_eq!(times.last().copied(), Some(schedule.duration()));
        }
    }

    #[test]
    fn a_duration_shorter_than_the_interval_has_two_samples() {
        assert_eq!(schedule("1e-3", "1").len(), 2);
    }

    #[test]
    fn times_of_ones_own_are_sampled_and_no_others() {
        let schedule = schedule("0.3", "0.1").at(vec![0.05, 0.25]);
        let times: Vec<f64> = (0..schedule.len()).map(|k| schedule.time(k)).collect();
        assert_eq!(times, [0.05, 0.25]);
        assert_eq!(schedule.duration::<f64>(), 0.3);
    }

    #[test]
    fn times_of_ones_own_are_decimals_in_any_arithmetic() {
        let by_grid = schedule("0.1", "3e-5");
        let by_times = schedule("0.1", "1").at(vec![3e-5, 0.09999, 0.1]);
        for (own, multiple) in [(0, 1), (1, 3333)] {
            let apart = by_times.time::<F256>(own) - by_grid.time::<F256>(multiple);
            assert!(apart.abs() < F256::from_f64(1e-70), "{own}: {apart:?}");
        }
    }

    #[test]
    fn no_sample_lies_beyond_the_duration_in_any_arithmetic() {
        // the double nearest to this duration is 0.1
        let longer = schedule("0.09999999999999999999999", "1").at(vec![0.1]);
        assert_eq!(longer.time::<F256>(0), longer.duration());
        assert_eq!(longer.time::<f64>(0), 0.1);
        for (duration, interval) in [("0.003", "0.001"), ("0.012", "1e-3"), ("0.06", "1e-5")] {
            let schedule = self::schedule(duration, interval);
            let last: F256 = schedule.time(schedule.len() - 1);
            assert_eq!(last, schedule.duration(), "{duration} by {interval}");
        }
    }
}
