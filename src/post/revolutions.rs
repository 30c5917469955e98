//! The revolutions of a drive in a run.

/// A run's span from 0 to its end, parted into revolutions of a drive; the last may be cut short.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Revolutions {
    period: f64,
    end: f64,
    count: usize,
}

/// What of a revolution counts as nothing: spans are decimals, periods quotients by π.
const ROUNDING: f64 = 1e-9;

impl Revolutions {
    /// The revolutions of a drive of this rate (rad/s) in a run that ends at `end` (s); `None`
    /// if it stands still, or there are more than `most`.
    pub fn new(rate: f64, end: f64, most: usize) -> Option<Self> {
        let period = std::f64::consts::TAU / rate.abs();
        let count = (end / period - ROUNDING).ceil();
        let sensible = period.is_finite() && count >= 1.0 && count <= most as f64;
        sensible.then_some(Revolutions { period, end, count: count as usize })
    }

    /// Time that one takes (s).
    pub fn period(&self) -> f64 {
        self.period
    }

    /// How many there are, the last one cut short among them.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Begin and end (s) of revolution `k`, counted from 0.
    pub fn bounds(&self, k: usize) -> [f64; 2] {
        let end = (k + 1) as f64 * self.period;
        [k as f64 * self.period, if k + 1 == self.count { self.end } else { end }]
    }

    /// Whether revolution `k` is whole.
    pub fn is_whole(&self, k: usize) -> bool {
        let [begin, end] = self.bounds(k);
        end - begin >= self.period * (1.0 - ROUNDING * (k + 1) as f64)
    }

    /// The revolution that a time (s) lies in; one at a boundary begins the next.
    pub fn of(&self, time: f64) -> usize {
        let turned = time / self.period;
        ((turned + ROUNDING).floor().max(0.0) as usize).min(self.count - 1)
    }

    /// The revolutions that touch a time (s): two at a boundary.
    pub fn touching(&self, time: f64) -> [usize; 2] {
        let before = (time / self.period - ROUNDING).floor().max(0.0) as usize;
        [before.min(self.count - 1), self.of(time)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const RATE: f64 = 5000.0 * TAU / 60.0;

    #[test]
    fn five_whole_revolutions_are_five() {
        let revolutions = Revolutions::new(RATE, 0.060, 1000).unwrap();
        assert_eq!(revolutions.count(), 5);
        assert!((0..5).all(|k| revolutions.is_whole(k)));
        assert_eq!(revolutions.bounds(4)[1], 0.060);
    }

    #[test]
    fn a_run_that_ends_within_a_revolution_cuts_it_short() {
        let revolutions = Revolutions::new(-RATE, 0.013, 1000).unwrap();
        assert_eq!(revolutions.count(), 2);
        assert!(revolutions.is_whole(0) && !revolutions.is_whole(1));
    }

    #[test]
    fn a_time_at_a_boundary_begins_a_revolution_and_touches_both() {
        let revolutions = Revolutions::new(RATE, 0.060, 1000).unwrap();
        for k in 1..5 {
            let boundary = 0.012 * k as f64;
            assert_eq!(revolutions.of(boundary), k);
            assert_eq!(revolutions.touching(boundary), [k - 1, k]);
        }
        assert_eq!(revolutions.touching(0.0), [0, 0]);
        assert_eq!(revolutions.touching(0.060), [4, 4]);
        assert_eq!(revolutions.touching(0.030), [2, 2]);
    }

    #[test]
    fn what_stands_still_or_has_no_span_has_no_revolutions() {
        assert_eq!(Revolutions::new(0.0, 1.0, 1000), None);
        assert_eq!(Revolutions::new(RATE, 0.0, 1000), None);
        assert_eq!(Revolutions::new(RATE, f64::NAN, 1000), None);
        assert_eq!(Revolutions::new(RATE, 1.0, 10), None);
    }
}
