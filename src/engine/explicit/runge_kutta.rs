//! The explicit Runge–Kutta method of eighth order (see [`dop853`](super::dop853)).

use super::dop853::{FIFTH, Row, STAGES, THIRD, WEIGHTS};
use super::flow::Flow;
use super::stepper::{Attempt, Norm, Point};
use crate::dae::{Fault, System};
use crate::scalar::Scalar;

const SAFETY: f64 = 0.9;
const LARGEST_GROWTH: f64 = 6.0;
const LARGEST_CUT: f64 = 0.2;

/// Stages and increment.
#[derive(Debug)]
pub(super) struct RungeKutta<S> {
    stages: Vec<Vec<S>>,
    place: Vec<S>,
    increment: Vec<S>,
    errors: [Vec<S>; 2],
}

impl<S: Scalar> RungeKutta<S> {
    /// A method for vectors of up to `capacity` components.
    pub fn new(capacity: usize) -> Self {
        let zeros = || vec![S::zero(); capacity];
        RungeKutta {
            stages: vec![zeros(); STAGES.len() + 1],
            place: zeros(),
            increment: zeros(),
            errors: [zeros(), zeros()],
        }
    }

    /// The increment of y over the last step.
    pub fn increment(&self) -> &[S] {
        &self.increment
    }

    /// A step of this length, unchecked.
    pub fn partial<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
    ) -> Result<bool, Fault> {
        self.run(flow, from, length)?;
        Ok(true)
    }

    /// Tries a step.
    pub fn attempt<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
        norm: &Norm,
    ) -> Result<Attempt, Fault> {
        self.run(flow, from, length)?;
        let controlled = flow.controlled();
        let [fifth, third] = &mut self.errors;
        combine(FIFTH, length, &self.stages, None, &mut fifth[..controlled]);
        combine(THIRD, length, &self.stages, None, &mut third[..controlled]);
        let fifth = norm.of(fifth[..controlled].iter().copied());
        let third = norm.of(third[..controlled].iter().copied());
        let error = if fifth == 0.0 {
            0.0
        } else {
            fifth * fifth / (fifth * fifth + 0.01 * third * third).sqrt()
        };
        let accepted = error <= 1.0;
        // error^(1/8); infinite errors cut most, no error lets the step grow most
        let root = error.sqrt().sqrt().sqrt();
        let factor = (SAFETY / root).clamp(LARGEST_CUT, LARGEST_GROWTH);
        Ok(Attempt { accepted, next: length.to_f64() * factor })
    }

    fn run<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
    ) -> Result<(), Fault> {
        let (controlled, len) = (flow.controlled(), flow.len());
        self.increment.resize(len, S::zero());
        self.stages[0][..len].copy_from_slice(&from.rates[..len]);
        for (s, row) in STAGES.into_iter().enumerate() {
            let place = &mut self.place[..controlled];
            combine(row, length, &self.stages, Some(&from.y), place);
            flow.rates(&self.place, &mut self.stages[s + 1])?;
        }
        combine(WEIGHTS, length, &self.stages, None, &mut self.increment);
        Ok(())
    }
}

/// `sum` = `base` + `length` · Σ weight · stage, component by component.
fn combine<S: Scalar>(row: Row, length: S, stages: &[Vec<S>], base: Option<&[S]>, sum: &mut [S]) {
    match row.len() {
        1 => combine_many::<S, 1>(row, length, stages, base, sum),
        2 => combine_many::<S, 2>(row, length, stages, base, sum),
        3 => combine_many::<S, 3>(row, length, stages, base, sum),
        4 => combine_many::<S, 4>(row, length, stages, base, sum),
        5 => combine_many::<S, 5>(row, length, stages, base, sum),
        6 => combine_many::<S, 6>(row, length, stages, base, sum),
        7 => combine_many::<S, 7>(row, length, stages, base, sum),
        8 => combine_many::<S, 8>(row, length, stages, base, sum),
        _ => combine_many::<S, 9>(row, length, stages, base, sum),
    }
}

/// [`combine`] for a row of N stages, so that the compiler sees the inner loop's length.
fn combine_many<S: Scalar, const N: usize>(
    row: Row,
    length: S,
    stages: &[Vec<S>],
    base: Option<&[S]>,
    sum: &mut [S],
) {
    let len = sum.len();
    let weights: [S; N] = std::array::from_fn(|j| length * S::from_f64(row[j].1));
    let terms: [&[S]; N] = std::array::from_fn(|j| &stages[row[j].0][..len]);
    for i in 0..len {
        let mut total = weights[0] * terms[0][i];
        for j in 1..N {
            total += weights[j] * terms[j][i];
        }
        sum[i] = total;
    }
    if let Some(base) = base {
        for (total, start) in sum.iter_mut().zip(base) {
            *total = *start + *total;
        }
    }
}
