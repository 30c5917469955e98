//! Assembly: from rough poses to a start that satisfies every joint.
//!
//! Ideal joints, drives and fixed start keys hold exactly. Journals are centred in their bearings
//! as nearly as these allow. What is left free stays near the rough poses and rates: keys that
//! the case names far more than those it does not. One step of it is
//! ```text
//! minimise  |C + C_q dq|² + dqᵀ W dq   subject to   H + H_q dq = 0
//! ```
//! with the exact conditions H, the centring conditions C and a small mass-like weight W; it is
//! repeated until nothing changes, at last without C, for the exact conditions have the last word
//! where the two cannot both be met. Velocities are one such problem, linear, with the rates of
//! the same conditions.

use super::Mechanism;
use super::layout::{Origin, Row, key};
use crate::clearance::Mode;
use crate::dae::{Fault, State, System};
use crate::joint::{Constraint, Revolute};
use crate::linear;
use crate::model::{Complaint, KeyPath, Start};
use crate::scalar::Scalar;

const MOST_STEPS: usize = 200;
/// Weight of a named coordinate against a metre of eccentricity.
const NAMED: f64 = 1e-6;
/// Weight of an unnamed coordinate against a named one.
const UNNAMED: f64 = 1e-3;
/// Keeps redundant but consistent conditions solvable.
const SLACK: f64 = 1e-10;
/// Steps that only the exact conditions have a say in: each gains the digits of SLACK and more,
/// and 71 are wanted.
const LAST_STEPS: usize = 6;

/// A condition on one coordinate: it has this value.
#[derive(Debug, Clone, Copy)]
struct Fixed<S> {
    at: usize,
    value: S,
}

/// The conditions of one assembly problem, written out at a state.
struct Conditions<S> {
    exact: Vec<(Vec<S>, S)>,
    wished: Vec<(Vec<S>, S)>,
    weights: Vec<S>,
}

impl<S: Scalar> Mechanism<S> {
    /// Finds the start, the scales and the first modes.
    pub(super) fn assemble(&mut self) -> Result<(), Vec<Complaint>> {
        self.length = characteristic_length(self);
        let mut q = self.named(|start| start.coordinates);
        self.assemble_positions(&mut q);
        self.check_positions(&q)?;
        let v = self.assemble_velocities(&q)?;
        self.begin(&q, &v)
    }

    /// Changes the start by about `share` of itself, and back onto the constraints: a coordinate
    /// or velocity x of typical size s becomes x + share · (x + w s). The weights w differ, so that
    /// neither a start at rest in the origin nor a symmetry makes nothing of it.
    ///
    /// # Errors
    /// The mechanism cannot be evaluated there.
    pub fn disturb_start(&mut self, share: S) -> Result<(), Vec<Complaint>> {
        let n = self.layout.coordinates;
        let disturb = |list: &mut [S], sizes: &[f64]| {
            for (i, (x, size)) in list.iter_mut().zip(sizes).enumerate() {
                let weight = size * (i + 1) as f64 / n as f64;
                *x += share * (*x + S::from_f64(weight));
            }
        };
        let (mut q, mut v) = (self.start.q.clone(), self.start.v.clone());
        disturb(&mut q, &self.coordinate_scales);
        disturb(&mut v, &self.velocity_scales);
        self.project(S::zero(), &mut q, &mut v).map_err(start_fault)?;
        self.modes.fill(Mode::Flight);
        self.begin(&q, &v)
    }

    /// Takes a start: scales, first modes, energy.
    fn begin(&mut self, q: &[S], v: &[S]) -> Result<(), Vec<Complaint>> {
        self.start.q.copy_from_slice(q);
        self.start.v.copy_from_slice(v);
        self.set_scales(q, v);
        let state = State { time: S::zero(), q, v, carried: None };
        self.choose_start_modes(state).map_err(start_fault)?;
        self.evaluate(state).map_err(start_fault)?;
        self.start_energy = self.stored_energy();
        Ok(())
    }

    /// Values that the starts name, zero where they do not.
    fn named(&self, of: fn(&Start<S>) -> [Option<S>; 3]) -> Vec<S> {
        let mut x = vec![S::zero(); self.layout.coordinates];
        for (body, at) in self.free_bodies() {
            for (c, value) in of(&self.model.starts()[body - 1]).into_iter().enumerate() {
                x[at + c] = value.unwrap_or(S::zero());
            }
        }
        x
    }

    /// Conditions on single coordinates from the starts that are fixed.
    fn fixed(&self, of: fn(&Start<S>) -> [Option<S>; 3]) -> Vec<Fixed<S>> {
        let mut fixed = Vec::new();
        for (body, at) in self.free_bodies() {
            let start = &self.model.starts()[body - 1];
            if start.fixed {
                for (c, value) in of(start).into_iter().enumerate() {
                    fixed.extend(value.map(|value| Fixed { at: at + c, value }));
                }
            }
        }
        fixed
    }

    /// Weights W: masses over the largest, far smaller where the case names nothing.
    fn weights(&self, of: fn(&Start<S>) -> [Option<S>; 3]) -> Vec<S> {
        let masses = self.free_bodies().map(|(body, _)| self.model.masses()[body]);
        let largest = masses.fold(S::zero(), |largest, mass| largest.max(mass));
        let mut weights = vec![S::one(); self.layout.coordinates];
        for (body, at) in self.free_bodies() {
            let start = of(&self.model.starts()[body - 1]);
            let mass = self.model.masses()[body];
            let inertia = self.model.inertias()[body];
            for (c, value) in [mass, mass, inertia].into_iter().enumerate() {
                let named = if start[c].is_some() { 1.0 } else { UNNAMED };
                weights[at + c] = value / largest * S::from_f64(NAMED * named);
            }
        }
        weights
    }

    /// The clearances as joints that would centre their journals.
    fn centring(&self) -> Vec<Row<S>> {
        (self.model.clearances().iter())
            .map(|clearance| Row {
                constraint: Constraint::Revolute(Revolute { pair: clearance.pair }),
                first: 0,
                origin: Origin::Joint(0),
            })
            .collect()
    }

    /// Moves q to the assembled positions, as nearly as they can be reached.
    fn assemble_positions(&mut self, q: &mut [S]) {
        let fixed = self.fixed(|start| start.coordinates);
        for fixed in &fixed {
            q[fixed.at] = fixed.value;
        }
        self.approach(q, &fixed);
        for _ in 0..LAST_STEPS {
            let mut conditions = self.position_conditions(q, &fixed);
            conditions.wished.clear();
            let Some(change) = conditions.change() else { return };
            q.iter_mut().zip(change).for_each(|(q, change)| *q += change);
        }
    }

    /// Moves q until exact conditions and wishes are met as nearly as they can be together.
    fn approach(&mut self, q: &mut [S], fixed: &[Fixed<S>]) {
        let done = S::from_f64(4.0 * S::EPSILON * self.length);
        for step in 0..MOST_STEPS {
            let mut conditions = self.position_conditions(q, fixed);
            if step < 2 {
                // what the case does not name goes first
                let heavy = S::from_f64(1.0 / NAMED);
                conditions.weights.iter_mut().for_each(|weight| *weight *= heavy);
            }
            let before = conditions.error();
            let Some(change) = conditions.change() else { return };
            let mut fraction = S::one();
            let mut best = q.to_vec();
            for _ in 0..12 {
                for (k, x) in best.iter_mut().enumerate() {
                    *x = q[k] + fraction * change[k];
                }
                if self.position_conditions(&best, fixed).error() <= before {
                    break;
                }
                fraction *= S::from_f64(0.5);
            }
            let moved = change.iter().fold(S::zero(), |most, x| most.max(x.abs())) * fraction;
            q.copy_from_slice(&best);
            if step >= 2 && moved <= done {
                return;
            }
        }
    }

    fn position_conditions(&mut self, q: &[S], fixed: &[Fixed<S>]) -> Conditions<S> {
        let rest = vec![S::zero(); q.len()];
        self.place(&State { time: S::zero(), q, v: &rest, carried: None });
        let weights = self.weights(|start| start.coordinates);
        let at = |k: usize| q[k];
        self.conditions(weights, fixed, at, |row, error| {
            row.constraint.position_error(self.now.time, &self.now.poses, error);
        })
    }

    /// Conditions as placed, with the value of each row from `error` and that of each coordinate
    /// from `at`.
    fn conditions(
        &self,
        weights: Vec<S>,
        fixed: &[Fixed<S>],
        at: impl Fn(usize) -> S,
        error: impl Fn(&Row<S>, &mut [S]),
    ) -> Conditions<S> {
        let n = self.layout.coordinates;
        let written = |rows: &[Row<S>]| {
            let mut out = Vec::new();
            for row in rows {
                let mut errors = [S::zero(); 2];
                error(row, &mut errors);
                for (r, error) in errors.iter().enumerate().take(row.constraint.rows()) {
                    out.push((self.coefficients(&row.constraint, r), *error));
                }
            }
            out
        };
        let mut exact = written(&self.layout.constraints);
        exact.extend(fixed.iter().map(|fixed| {
            let mut coefficients = vec![S::zero(); n];
            coefficients[fixed.at] = S::one();
            (coefficients, at(fixed.at) - fixed.value)
        }));
        Conditions { exact, wished: written(&self.centring()), weights }
    }

    /// One row of Φ_q over all coordinates.
    fn coefficients(&self, constraint: &Constraint<S>, row: usize) -> Vec<S> {
        let mut coefficients = vec![S::zero(); self.layout.coordinates];
        let blocks = constraint.jacobian(row, &constraint.arms(&self.now.poses));
        for (body, block) in constraint.bodies().into_iter().zip(blocks) {
            if let Some((_, at)) = self.free_bodies().find(|(free, _)| *free == body) {
                for (c, entry) in block.into_iter().enumerate() {
                    coefficients[at + c] += entry;
                }
            }
        }
        coefficients
    }

    /// Complains of every joint that does not close and every key that does not hold.
    fn check_positions(&mut self, q: &[S]) -> Result<(), Vec<Complaint>> {
        let rest = vec![S::zero(); q.len()];
        self.place(&State { time: S::zero(), q, v: &rest, carried: None });
        let allowed = 1e-9 * self.length;
        let mut complaints = Vec::new();
        for row in &self.layout.constraints {
            let mut error = [S::zero(); 2];
            row.constraint.position_error(S::zero(), &self.now.poses, &mut error);
            let off = error[0].to_f64().hypot(error[1].to_f64());
            if !(off <= allowed) {
                complaints.push(Complaint {
                    key: key(&self.model, row.origin),
                    message: format!(
                        "does not close: it is off by {off:.6e} m (rad) in the best assembly \
                         found; check the lengths and the poses under [start]"
                    ),
                });
            }
        }
        complaints.extend(self.unmet(q, allowed, |start| start.coordinates, ["x", "y", "angle"]));
        if !self.model.starts().iter().any(|start| start.fixed) {
            complaints.extend(self.overlaps());
        }
        if complaints.is_empty() { Ok(()) } else { Err(complaints) }
    }

    /// Complaints of fixed start keys that could not be held to within `allowed`.
    fn unmet(
        &self,
        x: &[S],
        allowed: f64,
        of: fn(&Start<S>) -> [Option<S>; 3],
        keys: [&str; 3],
    ) -> Vec<Complaint> {
        let mut complaints = Vec::new();
        for fixed in self.fixed(of) {
            let off = (x[fixed.at] - fixed.value).abs().to_f64();
            if !(off <= allowed) {
                let body = self.free_bodies().find(|(_, at)| fixed.at / 3 * 3 == *at);
                let name = body.map_or("", |(body, _)| self.model.body_name(body));
                complaints.push(Complaint {
                    key: KeyPath::new(["start", name, keys[fixed.at % 3]]),
                    message: format!(
                        "is fixed at {:e}, but the joints and the other fixed keys leave \
                         {:e}; drop one of them or `fixed`",
                        fixed.value.to_f64(),
                        x[fixed.at].to_f64()
                    ),
                });
            }
        }
        complaints
    }

    /// Complaints of journals that end up outside their clearance although nothing is fixed.
    fn overlaps(&self) -> Vec<Complaint> {
        let joints = self.model.joints().iter().enumerate();
        joints
            .filter_map(|(index, joint)| {
                let k = joint.clearance?;
                let clearance = &self.model.clearances()[k];
                let gap = self.now.gap(k, clearance);
                (gap.depth > S::zero()).then(|| Complaint {
                    key: key(&self.model, Origin::Joint(index)),
                    message: format!(
                        "does not close: the journal is {:.6e} m from the bearing's centre in \
                         the best assembly found, the radial clearance is {:.6e} m; check the \
                         lengths and the poses under [start]",
                        gap.eccentricity.to_f64(),
                        clearance.radial.to_f64()
                    ),
                })
            })
            .collect()
    }

    fn assemble_velocities(&mut self, q: &[S]) -> Result<Vec<S>, Vec<Complaint>> {
        self.factor().map_err(|singular| {
            vec![Complaint {
                key: self.layout.key(&self.model, singular.row),
                message: "holds what the other joints hold already, or the mechanism starts in a \
                          singular position (a dead centre); remove the joint, or start elsewhere"
                    .into(),
            }]
        })?;
        let fixed = self.fixed(|start| start.velocities);
        let mut v = self.named(|start| start.velocities);
        // the problem is linear; repeating it removes what SLACK and rounding leave
        for step in 0..2 * LAST_STEPS {
            self.place(&State { time: S::zero(), q, v: &v, carried: None });
            let weights = self.weights(|start| start.velocities);
            let mut conditions = self.conditions(
                weights,
                &fixed,
                |k| v[k],
                |row, error| {
                    row.constraint.velocity_error(&self.now.poses, &self.now.motions, error);
                },
            );
            if step >= LAST_STEPS {
                conditions.wished.clear();
            }
            let Some(change) = conditions.change() else { break };
            v.iter_mut().zip(change).for_each(|(v, change)| *v += change);
        }
        let fastest = v.iter().fold(1.0, |fastest: f64, v| fastest.max(v.abs().to_f64()));
        let keys = ["velocity_x", "velocity_y", "angular_velocity"];
        let complaints = self.unmet(&v, 1e-9 * fastest, |start| start.velocities, keys);
        if complaints.is_empty() { Ok(v) } else { Err(complaints) }
    }

    /// Typical sizes from the start: angles 1 rad; lengths the largest arm; rates the largest of
    /// any body, or, where all are at rest, one radian a second.
    fn set_scales(&mut self, q: &[S], v: &[S]) {
        self.place(&State { time: S::zero(), q, v, carried: None });
        let largest = |of: &dyn Fn(&crate::plane::Motion<S>) -> S| {
            self.now.motions.iter().map(|m| of(m).abs().to_f64()).fold(0.0, f64::max)
        };
        let or = |x: f64, other: f64| if x > 0.0 { x } else { other };
        let turning = largest(&|motion| motion.angular);
        let going = largest(&|motion| motion.linear.norm());
        let rate = or(turning, or(going / self.length, 1.0));
        let speed = or(going, rate * self.length);
        let bodies = self.layout.coordinates / 3;
        self.coordinate_scales = [self.length, self.length, 1.0].repeat(bodies);
        self.velocity_scales = [speed, speed, rate].repeat(bodies);
    }
}

impl<S: Scalar> Conditions<S> {
    /// Sum of squares of what is not met; exact conditions weigh more.
    fn error(&self) -> S {
        let squares = |rows: &[(Vec<S>, S)]| {
            rows.iter().fold(S::zero(), |sum, (_, error)| sum + *error * *error)
        };
        squares(&self.exact) * S::from_f64(1e3) + squares(&self.wished)
    }

    /// The step of the module's header; `None` if it cannot be computed.
    fn change(&self) -> Option<Vec<S>> {
        let (n, m) = (self.weights.len(), self.exact.len());
        let size = n + m;
        let mut matrix = vec![S::zero(); size * size];
        let mut right = vec![S::zero(); size];
        for (row, error) in &self.wished {
            for a in 0..n {
                right[a] -= row[a] * *error;
                for b in 0..n {
                    matrix[a * size + b] += row[a] * row[b];
                }
            }
        }
        for (k, weight) in self.weights.iter().enumerate() {
            matrix[k * size + k] += *weight;
        }
        for (r, (row, error)) in self.exact.iter().enumerate() {
            for (k, entry) in row.iter().enumerate() {
                matrix[k * size + n + r] = *entry;
                matrix[(n + r) * size + k] = *entry;
            }
            matrix[(n + r) * size + n + r] = -S::from_f64(SLACK);
            right[n + r] = -*error;
        }
        linear::solve_general(&mut matrix, size, &mut right).ok()?;
        right.truncate(n);
        right.iter().all(|x| x.is_finite()).then_some(right)
    }
}

fn start_fault(fault: Fault) -> Vec<Complaint> {
    vec![Complaint { key: KeyPath::new(["joints"]), message: fault.to_string() }]
}

/// The largest distance (m) of a joint's point from its body's mass centre, or of two points of
/// the ground from each other.
fn characteristic_length<S: Scalar>(mechanism: &Mechanism<S>) -> f64 {
    let joints = mechanism.model().joints().iter();
    let arms =
        joints.flat_map(|joint| [(joint.pair.i, joint.pair.s_i), (joint.pair.j, joint.pair.s_j)]);
    let longest = arms
        .filter(|(body, _)| *body != crate::model::GROUND)
        .map(|(_, arm)| arm.norm().to_f64())
        .fold(0.0, f64::max);
    let clearances = mechanism.model().clearances().iter();
    let widest = clearances.map(|clearance| clearance.bearing_radius.to_f64()).fold(0.0, f64::max);
    match longest.max(widest) {
        length if length > 0.0 => length,
        _ => 1.0,
    }
}
