//! What both steppers share: where a step begins, how an error is weighed, what an attempt tells.

use super::extrapolation::Extrapolation;
use super::flow::Flow;
use super::runge_kutta::RungeKutta;
use crate::dae::{Course, Fault, System};
use crate::scalar::Scalar;

/// A place on the trajectory.
#[derive(Debug, Clone)]
pub(super) struct Point<S> {
    /// The vector y of [`Flow`].
    pub y: Vec<S>,
    /// What rounding left out of y.
    pub low: Vec<S>,
    /// dy/dτ.
    pub rates: Vec<S>,
    /// Approach to each event.
    pub approaches: Vec<S>,
    /// d/dτ of the approaches.
    pub approach_rates: Vec<S>,
    /// Course of each approach.
    pub courses: Vec<Course>,
    /// d²t/dτ².
    pub pace_rate: S,
}

impl<S: Scalar> Point<S> {
    /// Space for so many components and event functions, all zero.
    pub fn new(components: usize, functions: usize) -> Self {
        let zeros = |n| vec![S::zero(); n];
        Point {
            y: zeros(components),
            low: zeros(components),
            rates: zeros(components),
            approaches: zeros(functions),
            approach_rates: zeros(functions),
            courses: vec![Course::NONE; functions],
            pace_rate: S::zero(),
        }
    }

    /// Puts this point's y where `from` and an increment lead; what the sum rounds away is kept.
    pub fn displace(&mut self, from: &Point<S>, increment: &[S]) {
        for (i, step) in increment.iter().enumerate() {
            let (sum, lost) = two_sum(from.y[i], *step + from.low[i]);
            self.y[i] = sum;
            self.low[i] = lost;
        }
    }
}

/// A sum, and what rounding took from it (Knuth).
pub(super) fn two_sum<S: Scalar>(a: S, b: S) -> (S, S) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// How an error is weighed: the largest of the components, each in units of its size.
#[derive(Debug, Clone)]
pub(super) struct Norm {
    /// One over the size of each controlled component.
    pub weights: Vec<f64>,
    /// What the weighed error may be.
    pub tolerance: f64,
}

impl Norm {
    /// The weighed size of a vector, in units of the tolerance; infinite if it is not a number.
    pub fn of<S: Scalar>(&self, error: impl Iterator<Item = S>) -> f64 {
        let mut largest = 0.0;
        for (e, weight) in error.zip(&self.weights) {
            let size = e.to_f64().abs() * weight;
            if size.is_nan() {
                return f64::INFINITY;
            }
            largest = f64::max(largest, size);
        }
        largest / self.tolerance
    }
}

/// What came of the attempt at a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attempt {
    /// Whether the error is within the tolerance.
    pub accepted: bool,
    /// Length that would suit the next attempt.
    pub next: f64,
}

/// A one-step method. The increment of y that it found stays with it until the next call.
#[derive(Debug)]
pub(super) enum Stepper<S> {
    /// Eighth order, for double precision.
    RungeKutta(RungeKutta<S>),
    /// Any order.
    Extrapolation(Extrapolation<S>),
}

impl<S: Scalar> Stepper<S> {
    /// Tries a step from `from`.
    pub fn attempt<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
        norm: &Norm,
    ) -> Result<Attempt, Fault> {
        match self {
            Stepper::RungeKutta(method) => method.attempt(flow, from, length, norm),
            Stepper::Extrapolation(method) => method.attempt(flow, from, length, norm),
        }
    }

    /// A step to a place within an accepted one. Returns whether it is within the tolerance.
    pub fn partial<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
        norm: &Norm,
    ) -> Result<bool, Fault> {
        match self {
            Stepper::RungeKutta(method) => method.partial(flow, from, length),
            Stepper::Extrapolation(method) => method.partial(flow, from, length, norm),
        }
    }

    /// The increment of y over the last step tried.
    pub fn increment(&self) -> &[S] {
        match self {
            Stepper::RungeKutta(method) => method.increment(),
            Stepper::Extrapolation(method) => method.increment(),
        }
    }
}
