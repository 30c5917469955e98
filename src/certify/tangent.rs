//! A live error meter: the tangent of a trajectory, carried along with it.
//!
//! The tangent is the derivative of the trajectory by a change of its start
//! ([`Mechanism::disturb_start`]), exact to the engine's accuracy: dual numbers go through the
//! mechanics, through the times of events and so through the impact rates that contacts remember.
//! Its length, in the scales that digits are counted by, over its length at the start says how
//! much an error made there has grown.

use super::growth;
use crate::case::{Case, EngineName, Precision};
use crate::digits::{MOST_DIGITS, Scales, Sizes};
use crate::mechanism::Mechanism;
use crate::run::{Schedule, Trajectory, Watcher};
use crate::scalar::F256;
use crate::simulate::{self, assemble, run_tangent};
use std::convert::Infallible;

/// Relative error of a double.
pub(super) const DOUBLE: f64 = 1e-16;
/// A tangent shorter than this, of a change that is one, is rounding.
const NOTHING: f64 = 1e-9;

/// The growth of errors along a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Tangent {
    /// Sample times (s).
    pub times: Vec<f64>,
    /// Scaled length of the tangent at each sample, over that at the start: one at first.
    pub growth: Vec<f64>,
    /// Scaled length of the tangent at the start, per relative change of it: above one, for a
    /// clearance is a small difference of large coordinates.
    pub at_start: f64,
}

/// Carries the tangent of a case along, on the schedule of its run. The arithmetic is that of the
/// case; an IDA run gets that of the explicit engine at the same tolerance, which follows the same
/// trajectory for as long as the run follows the truth.
///
/// # Errors
/// See [`simulate::Error`].
pub fn tangent(
    case: &Case,
    schedule: &Schedule,
    watch: Watcher<'_>,
) -> Result<Tangent, simulate::Error<Infallible>> {
    let solver = &case.plan.solver;
    let mut kept = Trajectory::default();
    let (_, ran) = match (solver.engine, solver.precision) {
        (EngineName::Explicit, Precision::Octuple) => {
            let tolerance = solver.reference_tolerance;
            run_tangent::<F256, _>(case, schedule, tolerance, &mut kept, watch)
        }
        _ => run_tangent::<f64, _>(case, schedule, solver.relative_tolerance, &mut kept, watch),
    };
    ran?;
    let mechanism: Mechanism<f64> = assemble(case).map_err(|source| simulate::Error::Failed {
        case: case.name.clone(),
        source: Box::new(source),
    })?;
    let scales = Scales::of(&kept.samples, &Sizes::of(&mechanism));
    let times = kept.samples.iter().map(|sample| sample.time).collect();
    let lengths = kept.samples.iter().map(|sample| scales.beyond(sample)).collect();
    Ok(Tangent::new(times, lengths))
}

impl Tangent {
    /// From sample times (s) and scaled lengths. Where there is nothing to disturb, as in a
    /// mechanism without freedom, nothing grows.
    pub(super) fn new(times: Vec<f64>, lengths: Vec<f64>) -> Self {
        let at_start = lengths.first().copied().filter(|length| *length > NOTHING).unwrap_or(0.0);
        let over_start = |length: &f64| if at_start > 0.0 { length / at_start } else { 1.0 };
        Tangent { growth: lengths.iter().map(over_start).collect(), times, at_start }
    }

    /// Digits that a double-precision run has left at each sample: those that doubles have of the
    /// start less those that the growth of errors has taken so far; none once all are taken.
    pub fn digits_left(&self) -> Vec<f64> {
        self.digits_of(DOUBLE)
    }

    /// The same of a run whose start is off by this share of itself.
    pub(super) fn digits_of(&self, share: f64) -> Vec<f64> {
        let mut largest: f64 = 0.0;
        let left = self.growth.iter().map(|growth| {
            largest = if growth.is_nan() { f64::INFINITY } else { largest.max(*growth) };
            (-(share * self.at_start * largest).log10()).clamp(0.0, MOST_DIGITS)
        });
        left.collect()
    }

    /// Growth exponent (natural logarithm) per `period` (s): the slope of the straight line
    /// through the logarithms of the growth, over the whole run; `None` where nothing can grow.
    pub fn exponent_per(&self, period: f64) -> Option<f64> {
        if self.at_start == 0.0 {
            return None;
        }
        let points = self.times.iter().copied().zip(self.growth.iter().copied());
        growth::rate(points).map(|rate| rate * period)
    }

    /// Growth exponents (natural logarithm) of each whole `period` (s).
    pub fn exponents(&self, period: f64) -> Vec<f64> {
        let at = |time: f64| {
            let place = self.times.partition_point(|t| *t < time * (1.0 - 1e-9));
            self.growth.get(place).copied()
        };
        let ends =
            (0..).map_while(|k| Some((at(f64::from(k) * period)?, at(f64::from(k + 1) * period)?)));
        ends.map(|(begin, end)| (end / begin).ln()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_begins_with_one_and_digits_with_what_doubles_have_of_the_start() {
        let tangent = Tangent::new(vec![0.0, 1.0, 2.0], vec![100.0, 1e3, 1e2]);
        assert_eq!(tangent.growth, [1.0, 10.0, 1.0]);
        let left = tangent.digits_left();
        for (left, expected) in left.iter().zip([14.0, 13.0, 13.0]) {
            assert!((left - expected).abs() < 1e-12, "{left}");
        }
    }

    #[test]
    fn digits_end_with_none_and_never_with_fewer() {
        let tangent = Tangent::new(vec![0.0, 1.0, 2.0], vec![1.0, 1e20, f64::NAN]);
        assert_eq!(tangent.digits_left(), [16.0, 0.0, 0.0]);
    }

    #[test]
    fn where_nothing_can_be_disturbed_nothing_grows() {
        let tangent = Tangent::new(vec![0.0, 1.0], vec![1e-13, 1e-290]);
        assert_eq!(tangent.growth, [1.0, 1.0]);
        assert_eq!(tangent.exponent_per(1.0), None);
        assert_eq!(tangent.digits_left(), [16.0, 16.0]);
    }
}
