//! Back onto the constraints, by the smallest mass-weighted change.
//! ```text
//! q ← q − M⁻¹ Φ_qᵀ (Φ_q M⁻¹ Φ_qᵀ)⁻¹ Φ,   v ← v − M⁻¹ Φ_qᵀ (Φ_q M⁻¹ Φ_qᵀ)⁻¹ Φ̇
//! ```

use super::Mechanism;
use super::layout::{FreeBody, Role};
use crate::clearance::Mode;
use crate::dae::{Fault, State};
use crate::linear;
use crate::plane::Wrench;
use crate::scalar::Scalar;

const MOST_ITERATIONS: usize = 20;
/// A constraint that is off by more than this, over the characteristic length, does not hold.
const OPEN: f64 = 1e-9;
/// Depth that is none, in roundings of the characteristic length.
const ON_THE_WALL: f64 = 1e2;
/// Share of a change across the wall that the constraints have to leave of it.
const MOVABLE: f64 = 1e-6;

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
            self.place(&State { time, q, v, z: &[], carried: None });
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
        self.place(&State { time, q, v, z: &[], carried: None });
        self.check_closed()?;
        self.velocity_errors();
        self.correct(v)?;
        Ok(drift.unwrap_or(0.0))
    }

    /// Puts journals in flight that are in the wall, on their way out, onto it: there contacts end
    /// whose depth was carried beside q, and there projections may leave a journal. By the smallest
    /// mass-weighted change again,
    /// ```text
    /// q ← q − d δ/(gᵀ d),   d = P M⁻¹ g,   g = ∂δ/∂q
    /// ```
    /// with the projector P of the constraints.
    pub fn withdraw(&mut self, time: S, q: &mut [S], v: &mut [S]) -> Result<(), Fault> {
        for _ in 0..MOST_ITERATIONS {
            self.place(&State { time, q, v, z: &[], carried: None });
            let Some((k, depth)) = self.in_the_wall() else { break };
            let across = self.across_the_wall(k);
            let mut along: Vec<S> =
                across.iter().zip(&self.inverse_masses).map(|(g, m)| *g * *m).collect();
            let mobility = dot(&across, &along);
            along.iter_mut().for_each(|d| *d = *d / mobility);
            if self.layout.rows > 0 {
                // v holds the constraints: what is off of the sum is what is off of `along`
                let sum: Vec<S> = along.iter().zip(&*v).map(|(d, v)| *d + *v).collect();
                self.place(&State { time, q, v: &sum, z: &[], carried: None });
                self.velocity_errors();
                self.correct(&mut along)?;
            }
            let left = dot(&across, &along);
            if !(left.to_f64() > MOVABLE) {
                break;
            }
            q.iter_mut().zip(&along).for_each(|(q, d)| *q -= *d * depth / left);
            self.project_onto_constraints(time, q, v)?;
        }
        Ok(())
    }

    /// A clearance in flight whose journal is in the wall and does not go deeper, and the depth
    /// (m), as placed.
    fn in_the_wall(&self) -> Option<(usize, S)> {
        let rounding = ON_THE_WALL * S::EPSILON * self.length;
        self.model.clearances().iter().enumerate().find_map(|(k, clearance)| {
            let gap = self.now.gap(k, clearance);
            let inside = self.modes[k] == Mode::Flight && gap.depth.to_f64() > rounding;
            let leaves = inside && clearance.rates(&gap, &self.now.motions).rate <= S::zero();
            leaves.then_some((k, gap.depth))
        })
    }

    /// ∂δ/∂q of a clearance off its centre, as placed.
    fn across_the_wall(&self, k: usize) -> Vec<S> {
        let clearance = &self.model.clearances()[k];
        let gap = self.now.gap(k, clearance);
        let normal = clearance.rates(&gap, &self.now.motions).normal;
        let ends = [
            (clearance.pair.i, Wrench::at(gap.arm_i, -normal)),
            (clearance.pair.j, Wrench::at(gap.arm_j, normal)),
        ];
        let mut slopes = vec![S::zero(); self.layout.coordinates];
        for (body, wrench) in ends {
            let Role::Free(at) = self.layout.roles[body] else { continue };
            slopes[at] += wrench.force.x;
            slopes[at + 1] += wrench.force.y;
            slopes[at + 2] += wrench.moment;
        }
        slopes
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
        let joint = self.layout.owner(row).key(self.model.names()).to_string();
        Err(Fault::Fatal(Box::new(OpenJoint { joint, off, time: self.now.time.to_f64() })))
    }

    /// Sign of det Φ_q of a mechanism without freedom, as placed, filled up by the directions in which
    /// multipliers do nothing: on a branch of its motion it is
    /// one and the same, and beside a dead centre the other branch has the other.
    pub fn branch(&mut self) -> i8 {
        self.reach();
        if self.redundant > 0 && self.factor().is_err() {
            return 0;
        }
        let n = self.layout.rows;
        let mut slopes = vec![S::zero(); n * n];
        for row in 0..n {
            let parts = self.now.idle.of_row(row);
            parts.enumerate().for_each(|(k, part)| slopes[(row + 1) * n - 1 - k] = part);
        }
        for row in &self.layout.constraints {
            for (r, sides) in self.now.jacobian[row.range()].iter().enumerate() {
                for (body, side) in row.constraint.bodies().into_iter().zip(sides) {
                    let Role::Free(at) = self.layout.roles[body] else { continue };
                    let from = (row.first + r) * n + at;
                    slopes[from..from + 3].copy_from_slice(side);
                }
            }
        }
        linear::determinant_sign(&mut slopes, n)
    }

    /// Fills λ with Φ; returns the largest of them.
    pub(super) fn position_errors(&mut self) -> S {
        let now = &mut self.now;
        for row in &self.layout.constraints {
            let error = &mut now.lambda[row.range()];
            row.constraint.position_error(now.time, &now.poses, error);
        }
        now.lambda.iter().fold(S::zero(), |largest, error| largest.max(error.abs()))
    }

    /// Fills λ with Φ̇.
    fn velocity_errors(&mut self) {
        let now = &mut self.now;
        for row in &self.layout.constraints {
            let error = &mut now.lambda[row.range()];
            row.constraint.velocity_error(now.time, &now.poses, &now.motions, error);
        }
    }

    /// Subtracts M⁻¹ Φ_qᵀ (Φ_q M⁻¹ Φ_qᵀ)⁻¹ λ.
    fn correct(&mut self, x: &mut [S]) -> Result<(), Fault> {
        self.factor().map_err(|singular| self.singular(singular))?;
        self.now.matrix.solve(&mut self.now.lambda);
        self.now.wrenches.fill(Wrench::none());
        self.apply_multipliers();
        for FreeBody { body, at, mass, inertia } in &self.layout.free {
            let Wrench { force, moment } = self.now.wrenches[*body];
            x[*at] += force.x * *mass;
            x[at + 1] += force.y * *mass;
            x[at + 2] += moment * *inertia;
        }
        Ok(())
    }
}

fn dot<S: Scalar>(a: &[S], b: &[S]) -> S {
    a.iter().zip(b).fold(S::zero(), |sum, (a, b)| sum + *a * *b)
}
