//! When samples are taken.

use crate::scalar::{Decimal, F256, Scalar};

/// Sample times: the multiples k · interval from 0 to the duration, both ends included; the
/// duration itself where it is no multiple. Each is the decimal product, rounded once.
#[derive(Debug, Clone, Copy)]
pub struct Schedule {
    duration: F256,
    interval: F256,
    /// Number of multiples of the interval, zero among them.
    multiples: u64,
    ends_between: bool,
    adaptive: bool,
}

impl Schedule {
    /// The schedule of a run of `duration` (s) sampled every `interval` (s), both positive.
    pub fn new(duration: &Decimal, interval: &Decimal) -> Self {
        let (duration, interval): (F256, F256) = (duration.value(), interval.value());
        let quotient = duration / interval;
        // a quotient of decimals that is whole may come out an ulp beside
        let nearest = quotient.round();
        let whole = (quotient - nearest).abs() <= quotient * F256::from_f64(1e-60);
        let last = if whole { nearest } else { quotient.floor() };
        let multiples = last.to_f64() as u64 + 1;
        Schedule { duration, interval, multiples, ends_between: !whole, adaptive: false }
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
        self.multiples + u64::from(self.ends_between)
    }

    /// Whether there are no samples: never.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Time of sample `k` (s).
    pub fn time<S: Scalar>(&self, k: u64) -> S {
        S::from_octuple(match k < self.multiples {
            true => F256::from(k) * self.interval,
            false => self.duration,
        })
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
    fn a_duration_shorter_than_the_interval_has_two_samples() {
        assert_eq!(schedule("1e-3", "1").len(), 2);
    }
}
