//! Extrapolation of the explicit midpoint rule, for any number of digits.
//!
//! Column j takes the step in n_j = 2j midpoint steps (the harmonic sequence). The result has an
//! expansion in even powers of 1/n_j, so that the weights
//!
//! ```text
//! w_kj = ∏ j² / (j² − i²),  i = 1 … k, i ≠ j
//! ```
//!
//! of the first k columns leave an error of order 2k + 1 in the step's length, and
//! Σ w_kj z_j / j² is what column k changed, which serves as the estimate of the error. What is
//! extrapolated is the increment z = y − y₀, for the weights are large (their magnitudes add up
//! to 2·10¹⁰ at 32 columns) and of both signs. Step and number of columns are chosen together, by
//! the work per unit of τ (E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential
//! Equations I*, 2nd ed., Springer 1993, Section II.9).

use super::flow::Flow;
use super::stepper::{Attempt, Norm, Point};
use crate::dae::{Fault, System};
use crate::scalar::Scalar;

const LARGEST_NUMBER_OF_COLUMNS: usize = 36;
const SMALLEST_NUMBER_OF_COLUMNS: usize = 3;
/// What an error may be of the tolerance in the choice of the next step.
const SAFETY: f64 = 0.1;
const LARGEST_GROWTH: f64 = 20.0;
const LARGEST_CUT: f64 = 0.05;
/// Logarithm of the error, in units of the tolerance, that is not worth another column.
const HOPELESS: f64 = 4.0;
/// Columns over which the fall of the errors is taken.
const SPAN: usize = 4;
/// Columns beyond those reached that may be aimed at.
const FORESIGHT: usize = 4;
/// Columns beyond the number aimed at that are worth more than a new start.
const EXTRA_COLUMNS: usize = 3;

/// How columns are to be added.
#[derive(Debug, Clone, Copy)]
struct Work {
    /// The last of them.
    last: usize,
    /// Whether to go on to the last column, whatever the errors so far.
    hoping: bool,
}

/// Columns, weights and increment.
#[derive(Debug)]
pub(super) struct Extrapolation<S> {
    /// 1/n_j.
    fractions: Vec<S>,
    /// w_kj, by k − 1 and j − 1.
    weights: Vec<Vec<S>>,
    /// w_kj / j².
    differences: Vec<Vec<S>>,
    columns: Vec<Vec<S>>,
    /// Estimate of the error at each number of columns, in units of the tolerance.
    errors: Vec<f64>,
    aim: usize,
    /// Aims below this leave no columns to see by that a step is too long.
    least_aim: usize,
    place: Vec<S>,
    before: Vec<S>,
    increment: Vec<S>,
}

impl<S: Scalar> Extrapolation<S> {
    /// A method for vectors of up to `capacity` components, with as many columns as rounding
    /// allows at this tolerance.
    pub fn new(capacity: usize, tolerance: f64) -> Self {
        let mut weights: Vec<Vec<S>> = Vec::new();
        for k in 1..=LARGEST_NUMBER_OF_COLUMNS {
            let row = weights_of::<S>(k);
            let amplification: f64 = row.iter().map(|w| w.to_f64().abs()).sum();
            if k > SMALLEST_NUMBER_OF_COLUMNS && amplification * S::EPSILON > tolerance {
                break;
            }
            weights.push(row);
        }
        let square = |j: usize| (j * j) as i64;
        let differences = weights.iter().map(|row| {
            row.iter().enumerate().map(|(j, w)| *w * S::ratio(1, square(j + 1))).collect()
        });
        let zeros = || vec![S::zero(); capacity];
        let aim = (2 + (-tolerance.log10() / 2.0) as usize).min(weights.len());
        Extrapolation {
            fractions: (1..=weights.len()).map(|j| S::ratio(1, 2 * j as i64)).collect(),
            differences: differences.collect(),
            columns: vec![zeros(); weights.len()],
            errors: vec![f64::INFINITY; weights.len()],
            aim,
            least_aim: (aim / 2).max(SMALLEST_NUMBER_OF_COLUMNS),
            place: zeros(),
            before: zeros(),
            increment: zeros(),
            weights,
        }
    }

    /// The increment of y over the last step.
    pub fn increment(&self) -> &[S] {
        &self.increment
    }

    /// Tries a step.
    pub fn attempt<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
        norm: &Norm,
    ) -> Result<Attempt, Fault> {
        let last = (self.aim + EXTRA_COLUMNS).min(self.weights.len());
        let work = Work { last, hoping: false };
        let (reached, accepted) = self.build(flow, from, length, norm, work)?;
        if accepted {
            self.extrapolate(reached, flow.len());
        }
        let next = self.choose(length.to_f64(), reached);
        Ok(Attempt { accepted, next })
    }

    /// A step to a place within an accepted one, with as few columns as will do.
    pub fn partial<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
        norm: &Norm,
    ) -> Result<bool, Fault> {
        let work = Work { last: self.weights.len(), hoping: true };
        let (reached, accepted) = self.build(flow, from, length, norm, work)?;
        self.extrapolate(reached, flow.len());
        Ok(accepted)
    }

    /// Adds columns until the error is within the tolerance or will not come to be so by the last
    /// of them. Returns the number of columns, and whether it is.
    fn build<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
        norm: &Norm,
        work: Work,
    ) -> Result<(usize, bool), Fault> {
        for k in 1..=work.last {
            self.column(flow, from, length, k)?;
            let error = if k == 1 { f64::INFINITY } else { self.estimate(k, norm, flow) };
            self.errors[k - 1] = error;
            if error <= 1.0 {
                return Ok((k, true));
            }
            if !work.hoping && k > 1 && self.hopeless(k, work.last) {
                return Ok((k, false));
            }
        }
        Ok((work.last, false))
    }

    /// Whether the errors fall too slowly to meet the tolerance by the last column, even if they
    /// come to fall faster.
    fn hopeless(&self, k: usize, last: usize) -> bool {
        if k < SMALLEST_NUMBER_OF_COLUMNS.max(last / 3) {
            return !self.errors[k - 1].is_finite();
        }
        let fall = self.fall(k);
        let gain = self.gain(k).max(1.0 / k as f64);
        !(self.expected_at(last, k, fall, gain) <= HOPELESS)
    }

    /// Logarithm of the error that so many columns leave, as far as the first `known` tell.
    fn expected(&self, columns: usize, known: usize) -> f64 {
        self.expected_at(columns, known, self.fall(known), self.gain(known))
    }

    fn expected_at(&self, columns: usize, known: usize, fall: f64, gain: f64) -> f64 {
        if columns <= known {
            return self.log(columns);
        }
        let ahead = (columns - known) as f64;
        self.log(known) - ahead * (fall + 0.5 * gain * (ahead - 1.0))
    }

    fn log(&self, columns: usize) -> f64 {
        self.errors[columns - 1].max(1e-300).ln()
    }

    /// By how much the logarithm of the error fell from column to column, over the last few.
    fn fall(&self, known: usize) -> f64 {
        let span = (known - 2).clamp(1, SPAN);
        (self.log(known - span) - self.log(known)) / span as f64
    }

    /// By how much that grew from column to column: by 2/j at column j where the solution has no
    /// singularity (errors are then like (H/n_j)² times those of the column before), not at all
    /// where one is near.
    fn gain(&self, known: usize) -> f64 {
        if known < 2 * SPAN + 2 {
            return 0.0;
        }
        let grown = self.fall(known) - self.fall(known - SPAN);
        (grown / SPAN as f64).clamp(0.0, 2.0 / known as f64)
    }

    /// Takes the step in n_k midpoint steps.
    fn column<Y: System<S>>(
        &mut self,
        flow: &mut Flow<S, Y>,
        from: &Point<S>,
        length: S,
        k: usize,
    ) -> Result<(), Fault> {
        let (controlled, len) = (flow.controlled(), flow.len());
        let steps = 2 * k;
        let step = length * self.fractions[k - 1];
        let double = step + step;
        let mut now = std::mem::take(&mut self.columns[k - 1]);
        self.before[..len].fill(S::zero());
        for (now, rate) in now[..len].iter_mut().zip(&from.rates) {
            *now = step * *rate;
        }
        for _ in 1..steps {
            for ((place, y), now) in self.place[..controlled].iter_mut().zip(&from.y).zip(&now) {
                *place = *y + *now;
            }
            let done = flow.add_rates(&self.place, double, &mut self.before);
            std::mem::swap(&mut now, &mut self.before);
            if done.is_err() {
                self.columns[k - 1] = now;
                return done;
            }
        }
        self.columns[k - 1] = now;
        Ok(())
    }

    /// What column k changed, in units of the tolerance.
    fn estimate<Y: System<S>>(&self, k: usize, norm: &Norm, flow: &Flow<S, Y>) -> f64 {
        let weights = &self.differences[k - 1];
        norm.of((0..flow.controlled()).map(|i| {
            let mut sum = weights[0] * self.columns[0][i];
            for (weight, column) in weights[1..].iter().zip(&self.columns[1..]) {
                sum += *weight * column[i];
            }
            sum
        }))
    }

    /// The increment that the first k columns extrapolate to. The weights add up to one, so the
    /// last column may be taken out of all.
    fn extrapolate(&mut self, k: usize, len: usize) {
        let weights = &self.weights[k - 1];
        self.increment.resize(len, S::zero());
        for i in 0..len {
            let last = self.columns[k - 1][i];
            let mut sum = S::zero();
            for (weight, column) in weights[..k - 1].iter().zip(&self.columns) {
                sum += *weight * (column[i] - last);
            }
            self.increment[i] = last + sum;
        }
    }

    /// Aims at the number of columns with the least work per unit of τ, as far as the number
    /// reached lets one see; returns the length of the next step.
    fn choose(&mut self, length: f64, reached: usize) -> f64 {
        let furthest = (reached + FORESIGHT).max(self.aim).min(self.weights.len());
        let mut best = (f64::INFINITY, self.aim, LARGEST_CUT);
        for columns in SMALLEST_NUMBER_OF_COLUMNS.min(reached)..=furthest {
            let spare = SAFETY.ln() - self.expected(columns, reached);
            let factor = (spare / (2 * columns - 1) as f64).exp().min(LARGEST_GROWTH);
            let work = (columns * columns) as f64 / factor;
            if work < best.0 {
                best = (work, columns, factor);
            }
        }
        self.aim = best.1.max(self.least_aim);
        length * best.2.max(LARGEST_CUT)
    }
}

/// w_kj for j = 1 … k.
fn weights_of<S: Scalar>(k: usize) -> Vec<S> {
    let square = |j: usize| (j * j) as i64;
    let weight = |j: usize| {
        (1..=k)
            .filter(|i| *i != j)
            .fold(S::one(), |w, i| w * S::ratio(square(j), square(j) - square(i)))
    };
    (1..=k).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::F256;

    #[test]
    fn weights_remove_every_even_power_they_can() {
        for k in 1..=32 {
            let weights = weights_of::<F256>(k);
            for power in 0..k as u32 {
                let terms: Vec<F256> = weights
                    .iter()
                    .zip(1i64..)
                    .map(|(w, j)| (0..power).fold(*w, |w, _| w * F256::ratio(1, j * j)))
                    .collect();
                let sum = terms.iter().fold(F256::zero(), |sum, x| sum + *x);
                let size: f64 = terms.iter().map(|x| x.to_f64().abs()).sum();
                let expected = if power == 0 { F256::one() } else { F256::zero() };
                let error = (sum - expected).abs().to_f64();
                let rounding = 100.0 * size * <F256 as Scalar>::EPSILON;
                assert!(error <= rounding, "{k} columns, power {power}: {error:e}");
            }
        }
    }
}
