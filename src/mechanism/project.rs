//! Back onto the constraints, by the smallest mass-weighted change.
//! ```text
//! q ← q − M⁻¹ Φ_qᵀ (Φ_q M⁻¹ Φ_qᵀ)⁻¹ Φ,   v ← v − M⁻¹ Φ_qᵀ (Φ_q M⁻¹ Φ_qᵀ)⁻¹ Φ̇
//! ```

use super::Mechanism;
use crate::dae::{Fault, State};
use crate::linear;
use crate::scalar::Scalar;

const MOST_ITERATIONS: usize = 20;
/// A constraint that is off by more than this, over the characteristic length, does not hold.
const OPEN: f64 = 1e-9;

/// No position near the last one has every joint closed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "{joint} does not close at t = {time:e} s: it stays off by {off:.6e} m (rad); the mechanism \
     has come to where its lengths do not let it go on"
)]
pub struct OpenJoint {
    /// Key of the joint or drive that is off most.
    pub joint: String,
    /// By how much (m, rad).
    pub off: f64,
    /// Time (s).
    pub time: f64,
}

impl<S: Scalar> Mechanism<S> {
    /// Projects q and v; returns the largest |Φ| found (m, rad). Says which joint is open if none
    /// of the positions near q closes them all.
    pub(super) fn project_onto_constraints(
        &mut self,
        time: S,
        q: &mut [S],
        v: &mut [S],
    ) -> Result<f64, Fault> {
        if self.layout.rows == 0 {
            return Ok(0.0);
        }
        let good = S::from_f64(4.0 * S::EPSILON * self.length);
        let mut drift = None;
        let mut last = S::from_f64(f64::INFINITY);
        for _ in 0..MOST_ITERATIONS {
            self.place(&State { time, q, v, carried: None });
            let error = self.position_errors();
            drift.get_or_insert(error.to_f64());
            // below `good` there is nothing but rounding; no gain means the same
            if error <= good || !(error < last) {
                if S::CARRIES_DERIVATIVE {
                    // the value may be there before its derivative is
                    self.correct(q)?;
                }
                break;
            }
            last = error;
            self.correct(q)?;
        }
        self.place(&State { time, q, v, carried: None });
        self.check_closed()?;
        self.velocity_errors();
        self.correct(v)?;
        Ok(drift.unwrap_or(0.0))
    }

    /// Refuses a position at which a constraint does not hold.
    fn check_closed(&mut self) -> Result<(), Fault> {
        let off = self.position_errors().to_f64();
        if off <= OPEN * self.length {
            return Ok(());
        }
        let worst = |a: &usize, b: &usize| {
            let error = |row: usize| self.now.lambda[row].abs().to_f64();
            error(*a).total_cmp(&error(*b))
        };
        let row = (0..self.layout.rows).max_by(worst).unwrap_or(0);
        let joint = self.layout.key(&self.model, row).to_string();
        Err(Fault::Fatal(Box::new(OpenJoint { joint, off, time: self.now.time.to_f64() })))
    }

    /// Fills λ with Φ; returns the largest of them.
    pub(super) fn position_errors(&mut self) -> S {
        let now = &mut self.now;
        for row in &self.layout.constraints {
            let error = &mut now.lambda[row.first..row.first + row.constraint.rows()];
            row.constraint.position_error(now.time, &now.poses, error);
        }
        now.lambda.iter().fold(S::zero(), |largest, error| largest.max(error.abs()))
    }

    /// Fills λ with Φ̇.
    fn velocity_errors(&mut self) {
        let now = &mut self.now;
        for row in &self.layout.constraints {
            let error = &mut now.lambda[row.first..row.first + row.constraint.rows()];
            row.constraint.velocity_error(&now.poses, &now.motions, error);
        }
    }

    /// Subtracts M⁻¹ Φ_qᵀ (Φ_q M⁻¹ Φ_qᵀ)⁻¹ λ.
    fn correct(&mut self, x: &mut [S]) -> Result<(), Fault> {
        self.factor().map_err(|singular| self.singular(singular))?;
        linear::solve_symmetric(&self.now.matrix, self.layout.rows, &mut self.now.lambda);
        for (row, arms) in self.layout.constraints.iter().zip(&self.now.arms) {
            let lambda = &self.now.lambda[row.first..row.first + row.constraint.rows()];
            let on = row.constraint.wrenches(arms, lambda);
            for (body, wrench) in row.constraint.bodies().into_iter().zip(on) {
                let super::layout::Role::Free(at) = self.layout.roles[body] else { continue };
                let change = [wrench.force.x, wrench.force.y, wrench.moment];
                for (c, change) in change.into_iter().enumerate() {
                    x[at + c] += change * self.inverse_masses[at + c];
                }
            }
        }
        Ok(())
    }
}
