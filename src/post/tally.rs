//! Largest and smallest values, in a whole run and in each revolution.

use super::{Quantity, Revolutions};
use crate::run::{Extremum, LEFT_OUT, Revolution};

/// How an extreme value is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// The mechanism was evaluated there: to rounding.
    Evaluated,
    /// The run found it while it went on, whatever its samples: to the accuracy of the run.
    Peak,
    /// The extreme of the samples: between them it may be exceeded by any amount.
    Sample,
}

impl Basis {
    /// A word for it.
    pub fn name(self) -> &'static str {
        match self {
            Basis::Evaluated => "evaluated",
            Basis::Peak => "peak",
            Basis::Sample => "sample",
        }
    }
}

/// An extreme value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extreme {
    /// The value, in the quantity's unit.
    pub value: f64,
    /// Its time (s).
    pub time: f64,
    /// How it is known.
    pub basis: Basis,
    /// By how much the run's own trajectory may exceed it, in the quantity's unit; `None` where that
    /// is nothing, or cannot be told.
    pub uncertainty: Option<f64>,
}

impl Extreme {
    /// A value that stands for itself.
    pub fn new(value: f64, time: f64, basis: Basis) -> Self {
        Extreme { value, time, basis, uncertainty: None }
    }

    /// An extreme that the run found, to this accuracy.
    pub fn found(found: Extremum, uncertainty: f64) -> Self {
        let Extremum { value, time } = found;
        Extreme {
            value,
            time,
            basis: Basis::Peak,
            uncertainty: Some(uncertainty).filter(|u| u.is_finite()),
        }
    }
}

/// What the extremes of a run of this relative tolerance may be off by from its trajectory, of the
/// largest magnitude of their revolution: what the search leaves out, rounding and drift off the
/// constraints, and what the inside of a step is known to.
pub(super) fn accuracy(tolerance: f64) -> f64 {
    (10.0 * LEFT_OUT).max(10.0 * tolerance)
}

/// The largest and the smallest value over a span; `None` if there was no number in it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extremes {
    /// The largest.
    pub largest: Option<Extreme>,
    /// The smallest.
    pub smallest: Option<Extreme>,
}

impl Extremes {
    /// The largest magnitude.
    pub fn magnitude(&self) -> Option<f64> {
        let values = [self.largest, self.smallest].into_iter().flatten();
        values.map(|extreme| extreme.value.abs()).reduce(f64::max)
    }

    /// Of values that differ by no more than rounding the one taken first stays.
    fn take(&mut self, candidate: Extreme, signed: bool) {
        let value = candidate.value;
        let beyond = |than: Extreme, by: f64| by > 1e-13 * than.value.abs().max(value.abs());
        if self.largest.is_none_or(|largest| beyond(largest, value - largest.value)) {
            self.largest = Some(candidate);
        }
        let smaller = |smallest: Extreme| beyond(smallest, smallest.value - value);
        if signed && self.smallest.is_none_or(smaller) {
            self.smallest = Some(candidate);
        }
    }
}

/// Extremes as they are found; what is no number does not count.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// Over the whole run.
    pub total: Extremes,
    /// In each revolution; empty without revolutions.
    pub revolutions: Vec<Extremes>,
    parts: Option<Revolutions>,
    signed: bool,
}

impl Tally {
    /// Nothing yet. What is not `signed`, a magnitude, has no smallest value worth telling.
    pub fn new(parts: Option<Revolutions>, signed: bool) -> Self {
        let count = parts.map_or(0, |parts| parts.count());
        let (total, revolutions) = (Extremes::default(), vec![Extremes::default(); count]);
        Tally { total, revolutions, parts, signed }
    }

    /// Factors by which to multiply a curve so that each extreme that counts is a maximum.
    pub(super) fn signs(&self) -> &'static [f64] {
        if self.signed { &[1.0, -1.0] } else { &[1.0] }
    }

    /// Has every extreme known as one of samples is.
    pub(super) fn know_no_more_than_samples(&mut self) {
        let all = std::iter::once(&mut self.total).chain(&mut self.revolutions);
        for extreme in all.flat_map(|span| [&mut span.largest, &mut span.smallest]).flatten() {
            (extreme.basis, extreme.uncertainty) = (Basis::Sample, None);
        }
    }

    /// Takes a candidate for an extreme value.
    pub fn take(&mut self, candidate: Extreme) {
        if !candidate.value.is_finite() || !candidate.time.is_finite() {
            return;
        }
        self.total.take(candidate, self.signed);
        if let Some(parts) = self.parts {
            let [before, after] = parts.touching(candidate.time);
            self.revolutions[before].take(candidate, self.signed);
            if after != before {
                self.revolutions[after].take(candidate, self.signed);
            }
        }
    }
}

impl Tally {
    /// Takes what a run found of a quantity in revolution `k`, to an accuracy that is relative to
    /// the largest magnitude in it; says whether the revolution counts for the run.
    pub fn take_found(
        &mut self,
        (k, counts): (usize, bool),
        revolution: &Revolution,
        quantity: Quantity,
        accuracy: f64,
    ) {
        let (measure, item) = quantity.measure();
        let largest = revolution.largest(measure).nth(item);
        let smallest = revolution.smallest(measure).nth(item).filter(|_| self.signed);
        let both = || largest.into_iter().chain(smallest);
        let magnitude = both().map(|found| found.value.abs()).fold(0.0, f64::max);
        for found in both().filter(|found| found.value.is_finite() && found.time.is_finite()) {
            let found = Extreme::found(found, accuracy * magnitude);
            if counts {
                self.total.take(found, self.signed);
            }
            if let Some(extremes) = self.revolutions.get_mut(k) {
                extremes.take(found, self.signed);
            }
        }
    }
}

/// Ratio of a value to that of a reference. `None` without one, or where the reference is so
/// small beside the value that it must be rounding.
pub fn ratio(value: Option<f64>, reference: Option<f64>) -> Option<f64> {
    let ratio = value? / reference?;
    (ratio.abs() < 1e9).then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn sample(time: f64, value: f64) -> Extreme {
        Extreme::new(value, time, Basis::Sample)
    }

    #[test]
    fn a_value_on_a_boundary_counts_for_both_revolutions() {
        let parts = Revolutions::new(TAU, 2.0, 10);
        let mut tally = Tally::new(parts, true);
        for (time, value) in [(0.5, 1.0), (1.0, 5.0), (1.5, -2.0)] {
            tally.take(sample(time, value));
        }
        let largest = |extremes: &Extremes| extremes.largest.map(|extreme| extreme.value);
        let smallest = |extremes: &Extremes| extremes.smallest.map(|extreme| extreme.value);
        assert_eq!(tally.revolutions.iter().map(largest).collect::<Vec<_>>(), [Some(5.0); 2]);
        assert_eq!(
            tally.revolutions.iter().map(smallest).collect::<Vec<_>>(),
            [Some(1.0), Some(-2.0)]
        );
        assert_eq!(tally.total.magnitude(), Some(5.0));
    }

    #[test]
    fn what_is_no_number_does_not_count() {
        let mut tally = Tally::new(None, true);
        tally.take(sample(0.0, f64::NAN));
        tally.take(sample(f64::NAN, 1.0));
        tally.take(sample(0.0, f64::INFINITY));
        assert_eq!(tally, Tally::new(None, true));
    }

    #[test]
    fn a_ratio_to_nothing_is_not_told() {
        assert_eq!(ratio(Some(6.0), Some(-4.0)), Some(-1.5));
        assert_eq!(ratio(Some(6.0), None), None);
        assert_eq!(ratio(Some(6.0), Some(0.0)), None);
        assert_eq!(ratio(Some(0.0), Some(0.0)), None);
        assert_eq!(ratio(Some(6.0), Some(1e-13)), None);
    }
}
