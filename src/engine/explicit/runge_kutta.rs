//! The explicit Runge–Kutta method of eighth order (see [`dop853`](super::dop853)).

use super::dop853::{DENSE, EXTRA, EXTRA_STAGES, FIFTH, Row, STAGES, THIRD, WEIGHTS};
use super::flow::Flow;
use super::stepper::{Attempt, Norm, Point};
use crate::dae::{Fault, System};
use crate::scalar::Scalar;

const SAFETY: f64 = 0.9;
const LARGEST_GROWTH: f64 = 6.0;
const LARGEST_CUT: f64 = 0.2;

/// Terms of the dense output beside the begin.
const TERMS: usize = 7;
/// Share of a step where the dense output is held against the equations, ...
const CHECKED_AT: f64 = 0.65;
/// ... and what its slope there may be off by, in units of the tolerance over the step. Of an oscillator
/// it is some 25, and what the output itself is off by an eighth of that.
const MOST_DEFECT: f64 = 40.0;

/// Stages and increment.
#[derive(Debug)]
pub(super) struct RungeKutta<S> {
    /// Those of the step, behind them those of the dense output.
    stages: Vec<Vec<S>>,
    place: Vec<S>,
    increment: Vec<S>,
    errors: [Vec<S>; 2],
    /// The terms of the dense output of the step last drawn, component by component.
    terms: Vec<[S; TERMS]>,
}

impl<S: Scalar> RungeKutta<S> {
    /// A method for vectors of up to `capacity` components.
    pub fn new(capacity: usize) -> Self {
        let zeros = || vec![S::zero(); capacity];
        RungeKutta {
            stages: vec![zeros(); STAGES.len() + 1 + EXTRA_STAGES],
            place: zeros(),
            increment: zeros(),
            errors: [zeros(), zeros()],
            terms: Vec::with_capacity(capacity),
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

    /// Makes the dense output of a step of this length, with the rates at its end. Whether the method
    /// has just run that step decides on whether it runs it again. Returns whether it is as true as
    /// the step: an error estimate tells nothing of what is between the ends.
    pub fn draw<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
        end_rates: &[S],
        has_run: bool,
        norm: &Norm,
    ) -> Result<bool, Fault> {
        if !has_run {
            self.run(flow, from, length)?;
        }
        let (controlled, len) = (flow.controlled(), flow.len());
        let end = STAGES.len() + 1;
        self.stages[end][..len].copy_from_slice(&end_rates[..len]);
        for (extra, row) in EXTRA.into_iter().enumerate() {
            let place = &mut self.place[..controlled];
            combine(row, length, &self.stages, Some(&from.y), place);
            flow.rates(&self.place, &mut self.stages[end + 1 + extra])?;
        }
        self.terms.clear();
        self.terms.resize(len, [S::zero(); TERMS]);
        for (i, terms) in self.terms.iter_mut().enumerate() {
            let change = self.increment[i];
            let [first, last] = [0, end].map(|stage| length * self.stages[stage][i]);
            let ends = [change, first - change, change + change - first - last];
            terms[..ends.len()].copy_from_slice(&ends);
        }
        for (at, row) in DENSE.into_iter().enumerate() {
            combine(row, length, &self.stages, None, &mut self.place[..len]);
            let last = TERMS - DENSE.len() + at;
            self.terms.iter_mut().zip(&self.place).for_each(|(terms, term)| terms[last] = *term);
        }
        let share = S::from_f64(CHECKED_AT);
        for (i, place) in self.place[..controlled].iter_mut().enumerate() {
            *place = from.y[i] + gain(&self.terms[i], share);
        }
        let rates = &mut self.stages[end];
        flow.rates(&self.place, rates)?;
        let terms = self.terms[..controlled].iter().zip(&*rates);
        let defects = terms.map(|(terms, rate)| slope(terms, share) - length * *rate);
        Ok(norm.of(defects) <= MOST_DEFECT)
    }

    /// Makes the increment that over a share of the step last drawn.
    pub fn follow(&mut self, share: S) {
        let len = self.terms.len();
        self.increment.resize(len, S::zero());
        for (change, terms) in self.increment.iter_mut().zip(&self.terms) {
            *change = gain(terms, share);
        }
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

/// The dense output of one component, less its begin.
#[inline(always)]
fn gain<S: Scalar>([ends @ .., last]: &[S; TERMS], share: S) -> S {
    let rest = S::one() - share;
    let pairs = ends.as_chunks::<2>().0.iter().rev();
    pairs.fold(*last * share, |sum, [even, odd]| ((sum + *odd) * rest + *even) * share)
}

/// Its derivative by the share of the step.
fn slope<S: Scalar>([ends @ .., last]: &[S; TERMS], share: S) -> S {
    let rest = S::one() - share;
    let pairs = ends.as_chunks::<2>().0.iter().rev();
    let (_, slope) = pairs.fold((*last * share, *last), |(sum, slope), [even, odd]| {
        let (inner, slope) = (sum + *odd, slope * rest - (sum + *odd));
        let outer = inner * rest + *even;
        (outer * share, slope * share + outer)
    });
    slope
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
        9 => combine_many::<S, 9>(row, length, stages, base, sum),
        _ => combine_many::<S, 12>(row, length, stages, base, sum),
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
    let total = |i: usize| {
        let mut total = weights[0] * terms[0][i];
        for j in 1..N {
            total += weights[j] * terms[j][i];
        }
        total
    };
    match base {
        Some(base) => {
            let base = &base[..len];
            for (i, sum) in sum.iter_mut().enumerate() {
                *sum = base[i] + total(i);
            }
        }
        None => {
            for (i, sum) in sum.iter_mut().enumerate() {
                *sum = total(i);
            }
        }
    }
}
