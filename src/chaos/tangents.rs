//! Several tangents of one trajectory, carried along from one orthonormalisation to the next.

use super::Error;
use crate::case::Case;
use crate::dae::System;
use crate::digits::Sizes;
use crate::engine::explicit::{self, Explicit};
use crate::halt;
use crate::mechanism::{Mechanism, Observation};
use crate::run::{
    self, Checkpoint, Contact, Event, Peak, Progress, Reached, Recorder, Schedule, Stretch,
};
use crate::scalar::{Dual, F256, Scalar};
use crate::simulate::explicit_options;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::panic::resume_unwind;

/// What orthogonality may take from a tangent, in powers of the arithmetic's rounding: what is left
/// then still has some six digits of a double.
const LEFT: f64 = 0.6;
/// Parts of a lap beyond which nothing more is tried.
const MOST_PARTS: u64 = 1 << 14;
/// A tangent longer than this is made shorter before numbers end.
const LONGEST: f64 = 1e100;
/// Steps in a lap, at least: errors are those of the motion, which may ask for fewer than its tangents do, ...
const STEPS: f64 = 100.0;
/// ... and largest angle (rad) that what is fastest in the mechanism by itself goes through in one.
const LARGEST_ANGLE: f64 = 0.25;
/// Velocities, over the mechanism's own, that are rest.
const REST: f64 = 1e-12;

/// Tangents of a trajectory.
pub(super) struct Tangents<'a, S: Scalar> {
    case: &'a Case,
    options: explicit::Options,
    schedule: Schedule,
    jobs: usize,
    /// Of each tangent its mechanism, which begins with its disturbance, ...
    mechanisms: Vec<Mechanism<Dual<S>>>,
    /// ... and where it has come to; `None` at the start.
    kept: Option<Vec<Checkpoint<Dual<S>>>>,
    /// One over the sizes of coordinates and velocities.
    weights: Vec<S>,
    /// Logarithms of the volumes of the start, which is not orthonormal.
    at_start: Vec<f64>,
    parts: u64,
}

impl<'a, S: Scalar> Tangents<'a, S> {
    /// So many tangents of a case, to a relative tolerance, for laps of a time (s).
    ///
    /// # Errors
    /// The mechanism cannot be evaluated near its start, or numbers do not hold its directions apart.
    pub fn new(
        case: &'a Case,
        mechanism: Mechanism<Dual<S>>,
        count: usize,
        (tolerance, lap): (f64, f64),
        jobs: NonZeroUsize,
    ) -> Result<Self, Error> {
        let options = explicit_options(&case.plan.solver, tolerance);
        // zero without anything fast, which then is no bound
        let quick = LARGEST_ANGLE / Sizes::of(&mechanism).rate;
        let max_step = options.max_step.min(lap / STEPS).min(quick);
        let (q, v) = mechanism.scales();
        let sizes = [q, v].concat();
        let weights: Vec<S> = sizes.iter().map(|size| S::one() / S::from_f64(*size)).collect();
        let mut mechanisms = Vec::new();
        let mut columns = Vec::new();
        for number in 0..count {
            let mut mechanism = mechanism.clone();
            let moved = direction(&mut mechanism, number, &sizes);
            moved.map_err(|complaints| Error::Case(case.reject(complaints)))?;
            let start = mechanism.start();
            columns.push(start.q.iter().chain(&start.v).map(|x| x.eps).collect());
            mechanisms.push(mechanism);
        }
        let at_start = orthonormalise(&mut columns, &weights);
        if let Some(number) = at_start.iter().position(|volume| !volume.resolved()) {
            return Err(Error::Collapsed { number: number + 1, time: 0.0 });
        }
        Ok(Tangents {
            options: explicit::Options { max_step, ..options },
            schedule: Schedule::new(&case.plan.duration, &case.plan.duration).at(vec![0.0]),
            jobs: jobs.get(),
            at_start: at_start.iter().map(|volume| volume.logarithm).collect(),
            parts: 1,
            case,
            mechanisms,
            kept: None,
            weights,
        })
    }

    /// How often in a lap they are made orthonormal at present.
    pub fn parts(&self) -> u64 {
        self.parts
    }

    /// Follows them through a lap of a time (s), counted from 0; gives the logarithms by which each
    /// direction has grown. Where one of them shrinks so much beside another that rounding would be all
    /// of it, the lap has more parts from there on.
    pub fn follow(&mut self, number: u64, lap: f64) -> Result<Vec<f64>, Error> {
        let mut grown = vec![0.0; self.mechanisms.len()];
        let mut part = 0;
        while part < self.parts {
            let share = F256::from(part + 1) / F256::from(self.parts);
            let end = (F256::from(number) + share) * F256::from_f64(lap);
            let mut kept = self.carry(S::from_octuple(end))?;
            let mut columns: Vec<Vec<S>> = kept.iter_mut().map(derivatives).collect();
            let volumes = orthonormalise(&mut columns, &self.weights);
            if let Some(lost) = volumes.iter().position(|volume| !volume.resolved()) {
                if self.parts >= MOST_PARTS {
                    return Err(Error::Collapsed { number: lost + 1, time: end.to_f64() });
                }
                (self.parts, part) = (2 * self.parts, 2 * part);
                continue;
            }
            for (kept, column) in kept.iter_mut().zip(columns) {
                kept.carried_mut().into_iter().zip(column).for_each(|(x, eps)| x.eps = eps);
            }
            let before = self.at_start.drain(..).chain(std::iter::repeat(0.0));
            for ((grown, volume), before) in grown.iter_mut().zip(volumes).zip(before) {
                *grown += volume.logarithm - before;
            }
            self.kept = Some(kept);
            part += 1;
        }
        Ok(grown)
    }

    /// Carries all to a time (s).
    fn carry(&self, end: S) -> Result<Vec<Checkpoint<Dual<S>>>, Error> {
        let leg = |number: usize| {
            let mut engine =
                Explicit::new(self.mechanisms[number].clone(), self.options).map_err(|error| {
                    Error::Failed { case: self.case.name.clone(), source: Box::new(error) }
                })?;
            let from = self.kept.as_ref().map(|kept| &kept[number]);
            let stretch = Stretch { from, until: Some(Dual::from_re(end)) };
            let tolerance = self.options.tolerance;
            let mut watch = |_: &Progress| match halt::is_asked() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let reached = run::stretch(
                &mut engine,
                &self.schedule,
                &stretch,
                tolerance,
                &mut Unrecorded,
                &mut watch,
            );
            match reached.map_err(|error| Error::of_run(self.case, error))? {
                Reached::Checkpoint(kept) if halt::is_asked() => {
                    Err(Error::Interrupted { time: kept.time().to_f64() })
                }
                Reached::Checkpoint(kept) => Ok(*kept),
                Reached::End(_) => unreachable!("a stretch with an end leads to a checkpoint"),
            }
        };
        let count = self.mechanisms.len();
        let jobs = self.jobs.min(count);
        let carried: Result<Vec<_>, Error> = if jobs == 1 {
            (0..count).map(leg).collect()
        } else {
            let share = |job: usize| {
                let numbers = (job..count).step_by(jobs);
                numbers.map(|number| leg(number).map(|kept| (number, kept))).collect()
            };
            let share = &share;
            let mut all = std::thread::scope(|scope| {
                let workers: Vec<_> =
                    (0..jobs).map(|job| scope.spawn(move || share(job))).collect();
                let mut all = Vec::with_capacity(count);
                for worker in workers {
                    let done: Result<Vec<_>, Error> =
                        worker.join().unwrap_or_else(|panic| resume_unwind(panic));
                    all.extend(done?);
                }
                Ok::<_, Error>(all)
            })?;
            all.sort_unstable_by_key(|(number, _)| *number);
            Ok(all.into_iter().map(|(_, kept)| kept).collect())
        };
        let carried = carried?;
        let same = carried.iter().all(|kept| {
            let (a, b) = (kept.state(), carried[0].state());
            a.q == b.q && a.v == b.v
        });
        assert!(same, "tangents of one trajectory have come to different states");
        Ok(carried)
    }

    /// Whether nothing moves where they have come to.
    pub fn rests(&self) -> bool {
        self.kept.iter().flatten().take(1).all(|kept| {
            let first = kept.state().q.len();
            let parts = kept.state().v.iter().zip(&self.weights[first..]);
            parts.into_iter().all(|(v, weight)| (v.re * *weight).abs().to_f64() < REST)
        })
    }

    /// Whether nothing has been dissipated so far.
    pub fn keeps_energy(&self) -> bool {
        let ledger = self.mechanisms[0].ledger();
        let places: Vec<usize> =
            ledger.clearances().chain(ledger.loads().map(|[_, lost]| lost)).collect();
        self.kept
            .iter()
            .flatten()
            .take(1)
            .all(|kept| places.iter().all(|place| kept.state().integrals[*place].re == S::zero()))
    }
}

/// Nobody records what a tangent sees.
struct Unrecorded;

impl Recorder for Unrecorded {
    type Error = Infallible;

    fn sample(&mut self, _: &Observation) -> Result<(), Infallible> {
        Ok(())
    }

    fn event(&mut self, _: Event) -> Result<(), Infallible> {
        Ok(())
    }

    fn contact(&mut self, _: Contact) -> Result<(), Infallible> {
        Ok(())
    }

    fn peak(&mut self, _: Peak) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Gives the start of a mechanism the derivative by a change in a direction that no symmetry has: one for
/// each number.
fn direction<S: Scalar>(
    mechanism: &mut Mechanism<Dual<S>>,
    number: usize,
    sizes: &[f64],
) -> Result<(), Vec<crate::model::Complaint>> {
    let start = mechanism.start();
    let (mut q, mut v) = (start.q.clone(), start.v.clone());
    for (i, (x, size)) in q.iter_mut().chain(v.iter_mut()).zip(sizes).enumerate() {
        let share = (((i + 1) * (2 * number + 1)) as f64).sin();
        x.eps = S::from_f64(share * size);
    }
    mechanism.move_start(q, v)
}

/// The derivatives of all that a tangent carries.
fn derivatives<S: Scalar>(kept: &mut Checkpoint<Dual<S>>) -> Vec<S> {
    kept.carried_mut().into_iter().map(|x| x.eps).collect()
}

/// What orthonormalisation finds of a column.
#[derive(Debug, Clone, Copy)]
struct Volume {
    /// Logarithm of what of its length is at right angles to those before it.
    logarithm: f64,
    /// That length over the whole.
    left: f64,
    /// Relative rounding of the arithmetic.
    rounding: f64,
}

impl Volume {
    /// Whether it is more than rounding, and numbers do not end.
    fn resolved(self) -> bool {
        self.left > self.rounding.powf(LEFT) && self.logarithm < LONGEST.ln()
    }
}

/// Makes columns orthonormal by Gram's and Schmidt's method, each twice. Lengths and angles are those
/// of their first rows, weighted; the other rows go along.
fn orthonormalise<S: Scalar>(columns: &mut [Vec<S>], weights: &[S]) -> Vec<Volume> {
    let dot = |a: &[S], b: &[S]| {
        let products = a.iter().zip(b).zip(weights).map(|((a, b), w)| (*a * *w) * (*b * *w));
        products.fold(S::zero(), |sum, product| sum + product)
    };
    let mut volumes = Vec::with_capacity(columns.len());
    for k in 0..columns.len() {
        let (before, column) = columns.split_at_mut(k);
        let column = &mut column[0];
        let whole = dot(column, column).sqrt();
        for other in before.iter().chain(before.iter()) {
            let along = dot(other, column);
            column.iter_mut().zip(other).for_each(|(x, y)| *x -= along * *y);
        }
        let length = dot(column, column).sqrt();
        column.iter_mut().for_each(|x| *x = *x / length);
        volumes.push(Volume {
            logarithm: length.ln().to_f64(),
            left: (length / whole).to_f64(),
            rounding: S::EPSILON,
        });
    }
    volumes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volumes_are_those_of_the_columns_and_other_rows_go_along() {
        // of [3, 4] and [1, 0] the first has length 5, both an area of 4; weights count twice
        let mut columns = vec![vec![3.0, 2.0, 10.0], vec![1.0, 0.0, 0.0]];
        let volumes = orthonormalise(&mut columns, &[1.0, 2.0]);
        let expected: [f64; 2] = [5.0, 4.0 / 5.0];
        for (volume, expected) in volumes.iter().zip(expected) {
            assert!((volume.logarithm - expected.ln()).abs() < 1e-15);
        }
        assert_eq!(columns[0], [0.6, 0.4, 2.0]);
        // [1, 0] less 0.6 of the first, over 0.8
        for (x, expected) in columns[1].iter().zip([0.8, -0.3, -1.5]) {
            assert!((x - expected).abs() < 1e-15, "{:?}", columns[1]);
        }
    }

    #[test]
    fn a_column_that_is_another_is_not_resolved() {
        let mut columns = vec![vec![1.0, 2.0], vec![0.3, 0.6]];
        let volumes = orthonormalise(&mut columns, &[1.0, 1.0]);
        assert!(volumes[0].resolved() && !volumes[1].resolved());
    }
}
