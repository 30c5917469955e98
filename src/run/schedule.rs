//! When samples are taken.

use crate::scalar::{Decimal, F256, Scalar};

/// Sample times: the multiples k · interval from 0 to the duration, both ends included; the
/// duration itself where it is no multiple. Within a window they are the multiples of its own
/// interval, both its ends included. Each is the decimal product, rounded once. Or any times within
/// the duration.
#[derive(Debug, Clone)]
pub struct Schedule {
    duration: F256,
    grid: Grid,
    adaptive: bool,
}

/// A part of a run that has samples at an interval of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleWindow {
    /// Begin (s).
    pub from: Decimal,
    /// End (s).
    pub to: Decimal,
    /// Time between samples (s).
    pub interval: Decimal,
}

/// The sample times that are known beforehand.
#[derive(Debug, Clone)]
enum Grid {
    Multiples {
        pieces: Vec<Piece>,
        /// Whether the duration is none of them, and sampled for itself.
        ends_between: bool,
    },
    At(Vec<Decimal>),
}

/// Samples at neighbouring multiples of an interval (s).
#[derive(Debug, Clone, Copy)]
struct Piece {
    interval: F256,
    /// The first multiple.
    first: u64,
    /// How many.
    count: u64,
    /// Number of the first sample in the schedule.
    begins: u64,
}

impl Piece {
    /// Time of sample `k` of the schedule (s).
    fn time(&self, k: u64) -> F256 {
        F256::from(self.first + (k - self.begins)) * self.interval
    }

    fn ends(&self) -> u64 {
        self.begins + self.count
    }

    /// Time of its last sample (s), if it has one.
    fn last(&self) -> Option<F256> {
        (self.count > 0).then(|| self.time(self.ends() - 1))
    }
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

/// Adds the multiples of an interval that lie between two times, both included (s); none that is
/// told as the last before it.
fn add(pieces: &mut Vec<Piece>, interval: F256, from: F256, to: F256) {
    let (before, whole) = multiples(from, interval);
    let mut first = if whole { before } else { before + 1 };
    let (last, _) = multiples(to, interval);
    let told = pieces.iter().rev().find_map(Piece::last).map(F256::to_f64);
    while first <= last && told >= Some((F256::from(first) * interval).to_f64()) {
        first += 1;
    }
    let begins = pieces.last().map_or(0, Piece::ends);
    pieces.push(Piece { interval, first, count: (last + 1).saturating_sub(first), begins });
}

impl Schedule {
    /// The schedule of a run of `duration` (s) sampled every `interval` (s), both positive.
    pub fn new(duration: &Decimal, interval: &Decimal) -> Self {
        Schedule::with_windows(duration, interval, &[])
    }

    /// The same with windows that have intervals of their own; they do not overlap.
    pub fn with_windows(duration: &Decimal, interval: &Decimal, windows: &[SampleWindow]) -> Self {
        let (duration, interval): (F256, F256) = (duration.value(), interval.value());
        let mut windows: Vec<[F256; 3]> = (windows.iter())
            .map(|window| [&window.from, &window.to, &window.interval].map(Decimal::value))
            .filter(|[from, ..]| *from < duration)
            .collect();
        windows.sort_by(|[a, ..], [b, ..]| a.to_f64().total_cmp(&b.to_f64()));
        let mut pieces = Vec::new();
        let mut done = F256::from(0);
        for [from, to, within] in windows {
            let to = to.min(duration);
            add(&mut pieces, interval, done, from);
            add(&mut pieces, within, from, to);
            done = to;
        }
        add(&mut pieces, interval, done, duration);
        let last = pieces.iter().rev().find_map(Piece::last).unwrap_or(F256::from(0));
        let ends_between = (duration - last).abs() > duration * F256::from_f64(1e-60);
        // times are told as doubles: a multiple with the double of the duration is the duration
        if ends_between && last.to_f64() >= duration.to_f64() {
            let piece = pieces.iter_mut().rev().find(|piece| piece.count > 0);
            piece.into_iter().for_each(|piece| piece.count -= 1);
        }
        pieces.retain(|piece| piece.count > 0);
        Schedule { duration, grid: Grid::Multiples { pieces, ends_between }, adaptive: false }
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
            Grid::Multiples { pieces, ends_between } => {
                pieces.last().map_or(0, Piece::ends) + u64::from(*ends_between)
            }
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
            Grid::Multiples { pieces, .. } => {
                match pieces.get(pieces.partition_point(|piece| piece.ends() <= k)) {
                    // the product, rounded, may pass a duration that it equals in decimals
                    Some(piece) => S::from_octuple(piece.time(k).min(self.duration)),
                    None => self.duration(),
                }
            }
            // a duration with more digits than a double has may lie before its own rounding
            Grid::At(times) => times[k as usize].value::<S>().min(self.duration()),
        }
    }

    /// Whether sample `k` is that of the duration where this is no multiple of the interval: a longer
    /// run has none there.
    pub(super) fn is_only_of_the_end(&self, k: u64) -> bool {
        match &self.grid {
            Grid::Multiples { ends_between, .. } => *ends_between && k + 1 == self.len(),
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

    fn window([from, to, interval]: [&str; 3]) -> SampleWindow {
        let [from, to, interval] = [from, to, interval].map(|text| Decimal::new(text).unwrap());
        SampleWindow { from, to, interval }
    }

    fn windowed(duration: &str, interval: &str, windows: &[[&str; 3]]) -> Schedule {
        let windows: Vec<_> = windows.iter().map(|texts| window(*texts)).collect();
        let [duration, interval] = [duration, interval].map(|text| Decimal::new(text).unwrap());
        Schedule::with_windows(&duration, &interval, &windows)
    }

    fn times(schedule: &Schedule) -> Vec<f64> {
        (0..schedule.len()).map(|k| schedule.time(k)).collect()
    }

    #[test]
    fn a_window_has_the_multiples_of_its_own_interval() {
        let schedule = windowed("0.5", "0.1", &[["0.3", "0.34", "0.02"], ["0.1", "0.2", "0.05"]]);
        let expected = [0.0, 0.1, 0.15, 0.2, 0.3, 0.32, 0.34, 0.4, 0.5];
        assert_eq!(times(&schedule), expected);
        // multiples of the window that its ends are none of
        let askew = windowed("0.3", "0.1", &[["0.11", "0.2", "0.03"]]);
        assert_eq!(times(&askew), [0.0, 0.1, 0.12, 0.15, 0.18, 0.2, 0.3]);
        // nothing in it, and the whole run
        assert_eq!(times(&windowed("0.2", "0.1", &[["0.11", "0.12", "0.1"]])), [0.0, 0.1, 0.2]);
        assert_eq!(times(&windowed("0.2", "1", &[["0", "0.2", "0.1"]])), [0.0, 0.1, 0.2]);
    }

    #[test]
    fn windows_end_with_the_run_and_go_on_in_a_longer_one() {
        let windows = [["0.1", "0.4", "0.03"], ["0.9", "1", "0.001"]];
        let short = windowed("0.25", "0.1", &windows);
        assert_eq!(times(&short), [0.0, 0.1, 0.12, 0.15, 0.18, 0.21, 0.24, 0.25]);
        assert!(short.is_only_of_the_end(7));
        let long = times(&windowed("0.5", "0.1", &windows));
        assert_eq!(long[..7], times(&short)[..7]);
        assert_eq!(long[7..], [0.27, 0.3, 0.33, 0.36, 0.39, 0.4, 0.5]);
    }

    #[test]
    fn sample_times_in_windows_are_rounded_decimals_that_increase() {
        for (intervals, window) in [
            ("1e-5", ["0.012", "0.013", "1e-7"]),
            ("1e-5", ["0.0120000001", "0.0129999", "3.3e-7"]),
            ("0.09999999999999999999", ["0.1", "0.2", "0.01"]),
        ] {
            let schedule = windowed("0.3", intervals, &[window]);
            let times = times(&schedule);
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{window:?}");
            for k in 0..schedule.len() {
                assert_eq!(schedule.time::<F256>(k).to_f64(), schedule.time::<f64>(k));
            }
        }
        let schedule = windowed("0.06", "1e-5", &[["0.012", "0.013", "1e-7"]]);
        assert_eq!(schedule.len(), 6001 + 9900);
        for (k, literal) in [(1199, 0.01199), (1201, 0.0120001), (1203, 0.0120003)] {
            assert_eq!(schedule.time::<f64>(k), literal);
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
