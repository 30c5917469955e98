//! Friction in ideal joints, which depends on the multipliers, as they depend on it.
//!
//! With the normal forces N_k of the joints as unknowns the multipliers are λ = λ₀ + Σ N_k Λ_k, where
//! Λ_k is what one newton of N_k makes of them, and
//! ```text
//! N_k = √(|F_k(λ)|² + N₀²)
//! ```
//! is solved by Newton's method, from the normal forces without friction. IDA, which has λ among its
//! unknowns, needs no more than its slopes.

use super::Mechanism;
use super::layout::{Layout, Role};
use crate::dae::{Entries, Fault};
use crate::linear::solve_square;
use crate::load::{JointFriction, Load};
use crate::model::{Model, Owner};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::Scalar;

/// Steps of Newton's method at most.
const MOST_STEPS: usize = 50;

/// A change of a normal force that is rounding, in units of the last place of the largest.
const ROUNDING: f64 = 64.0;

/// Friction in a joint, and where the joint stands among the equations.
#[derive(Debug, Clone)]
pub(super) struct Rubbing<S> {
    friction: JointFriction<S>,
    at: Site,
    /// Name of the joint.
    name: String,
}

/// Where a joint stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Site {
    /// A constraint.
    Constraint(usize),
    /// The joint of a driven body.
    Driven(usize),
}

/// The friction of a joint, as it was evaluated.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rubbed<S> {
    /// N (N).
    normal: S,
    /// What one newton of it puts on first and second body (N, N m).
    wrenches: [Wrench<S>; 2],
    /// F_T v over N (m/s).
    power: S,
}

/// The friction of joints has no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the friction of {joint} has no solution at t = {time:e} s: it jams (more friction makes more normal \
     force than bears it). A smaller coefficient or pin does not"
)]
pub struct Jammed {
    /// Key of the joint.
    pub joint: String,
    /// Time (s).
    pub time: f64,
}

/// The frictions of a model's joints, and where they stand.
pub(super) fn rubbings<S: Scalar>(model: &Model<S>, layout: &Layout<S>) -> Vec<Rubbing<S>> {
    let frictions = model.loads().iter().filter_map(Load::rubs);
    let place = |friction: &JointFriction<S>| {
        let mut driven = layout.driven.iter();
        let mut constraints = layout.constraints.iter();
        let driven = driven.position(|driven| driven.joint == friction.joint);
        let constraint = constraints.position(|row| row.owner == Owner::Joint(friction.joint));
        let at = driven.map(Site::Driven).or(constraint.map(Site::Constraint))?;
        let name = model.names().joints[friction.joint].clone();
        Some(Rubbing { friction: *friction, at, name })
    };
    frictions.filter_map(place).collect()
}

impl<S: Scalar> Mechanism<S> {
    /// Finds what one newton of each joint's normal force does, as placed; the forces are zero yet.
    pub(super) fn find_rubbing(&mut self) {
        let now = &mut self.now;
        now.rubbed.clear();
        for rubbing in &self.rubbings {
            let friction = &rubbing.friction;
            let bodies = friction.bodies();
            let poses: [Pose<S>; 2] = bodies.map(|body| now.poses[body]);
            let motions: [Motion<S>; 2] = bodies.map(|body| now.motions[body]);
            let ratio = friction.ratio(&poses, &motions);
            let wrenches = friction.of_one_newton(&ratio, &poses, &motions);
            let power = ratio.0.value * ratio.1;
            now.rubbed.push(Rubbed { normal: S::zero(), wrenches, power });
        }
    }

    /// Adds the friction of joints to the wrenches, where the multipliers stand.
    #[inline(always)]
    pub(super) fn apply_rubbing(&mut self) {
        if self.rubbings.is_empty() {
            return;
        }
        self.find_rubbing();
        for k in 0..self.rubbings.len() {
            let Rubbing { friction, at: Site::Constraint(row), .. } = &self.rubbings[k] else {
                continue;
            };
            let row = self.layout.constraints[*row].range();
            self.now.rubbed[k].normal = friction.normal(&self.now.lambda[row]).0;
            self.add_rubbing(k);
        }
    }

    /// Adds the friction of a joint to the wrenches.
    fn add_rubbing(&mut self, k: usize) {
        let now = &mut self.now;
        let Rubbed { normal, wrenches, .. } = now.rubbed[k];
        for (body, one) in self.rubbings[k].friction.bodies().into_iter().zip(wrenches) {
            now.wrenches[body] += Wrench { force: one.force * normal, moment: one.moment * normal };
        }
    }

    /// Changes multipliers without friction into those with it, and adds the friction to the wrenches.
    /// The mass–constraint matrix stands factored, and what rubs is found.
    pub(super) fn rub(&mut self) -> Result<(), Fault> {
        let held: Vec<(usize, usize)> = (self.rubbings.iter().enumerate())
            .filter_map(|(k, rubbing)| match rubbing.at {
                Site::Constraint(row) => Some((k, row)),
                Site::Driven(_) => None,
            })
            .collect();
        let answers: Vec<Vec<S>> = held.iter().map(|(k, _)| self.answer(*k)).collect();
        let alone = self.now.lambda.clone();
        let normal = |lambda: &[S], (k, row): &(usize, usize)| {
            let range = self.layout.constraints[*row].range();
            self.rubbings[*k].friction.normal(&lambda[range])
        };
        let mut normals: Vec<S> = held.iter().map(|place| normal(&alone, place).0).collect();
        let (count, mut settled) = (held.len(), false);
        let mut lambda = alone.clone();
        for _ in 0..MOST_STEPS {
            lambda.clone_from(&alone);
            for (answer, normal) in answers.iter().zip(&normals) {
                lambda.iter_mut().zip(answer).for_each(|(sum, part)| *sum += *part * *normal);
            }
            if settled {
                break;
            }
            let mut matrix = vec![S::zero(); count * count];
            let mut off = vec![S::zero(); count];
            for (i, place) in held.iter().enumerate() {
                let (value, by) = normal(&lambda, place);
                off[i] = value - normals[i];
                let first = self.layout.constraints[place.1].first;
                for (j, answer) in answers.iter().enumerate() {
                    let rows = answer[first..].iter().zip(by);
                    let slope = rows.fold(S::zero(), |sum, (answer, by)| sum + *answer * by);
                    let one = if i == j { S::one() } else { S::zero() };
                    matrix[i * count + j] = one - slope;
                }
            }
            if !solve_square(&mut matrix, &mut off) {
                break;
            }
            let largest = normals.iter().map(|n| n.abs().to_f64()).fold(0.0, f64::max);
            let change = off.iter().map(|n| n.abs().to_f64()).fold(0.0, f64::max);
            normals.iter_mut().zip(&off).for_each(|(normal, change)| *normal += *change);
            // the step after the last that changed anything leaves no derivative behind
            settled = change <= ROUNDING * S::EPSILON * largest;
        }
        let jams = normals.iter().position(|normal| !(*normal >= S::zero()));
        if !settled || jams.is_some() {
            let joint = held.get(jams.unwrap_or(0)).map_or("", |(k, _)| &self.rubbings[*k].name);
            let (joint, time) = (format!("joints.{joint}"), self.now.time.to_f64());
            return Err(Fault::Fatal(Box::new(Jammed { joint, time })));
        }
        self.now.lambda = lambda;
        for ((k, _), normal) in held.iter().zip(normals) {
            self.now.rubbed[*k].normal = normal;
            self.add_rubbing(*k);
        }
        Ok(())
    }

    /// What one newton of the normal force of a joint makes of the multipliers.
    fn answer(&self, k: usize) -> Vec<S> {
        let now = &self.now;
        let mut answer = vec![S::zero(); self.layout.rows];
        for (body, one) in
            self.rubbings[k].friction.bodies().into_iter().zip(now.rubbed[k].wrenches)
        {
            let Role::Free(at) = self.layout.roles[body] else { continue };
            let by = &self.inverse_masses[at..at + 3];
            let gained = [one.force.x * by[0], one.force.y * by[1], one.moment * by[2]];
            for row in &self.layout.constraints {
                for (side, other) in row.constraint.bodies().into_iter().enumerate() {
                    if other != body {
                        continue;
                    }
                    for r in row.range() {
                        let blocks = now.jacobian[r][side].iter().zip(gained);
                        answer[r] += blocks.fold(S::zero(), |sum, (a, b)| sum + *a * b);
                    }
                }
            }
        }
        now.matrix.solve(&mut answer);
        answer
    }

    /// Moment (N m) of friction on a driven body, in its joint, which carries this force (N).
    pub(super) fn rubbing_on_driven(&mut self, driven: usize, second: bool, force: Vector<S>) -> S {
        let site = Site::Driven(driven);
        let mut sum = S::zero();
        for (rubbing, rubbed) in self.rubbings.iter().zip(&mut self.now.rubbed) {
            if rubbing.at == site {
                rubbed.normal = rubbing.friction.normal_of(force).0;
                sum += rubbed.wrenches[usize::from(second)].moment * rubbed.normal;
            }
        }
        sum
    }

    /// What the friction of joints dissipates (W).
    pub(super) fn rubbing_power(&self) -> S {
        let powers = self.now.rubbed.iter().map(|rubbed| -rubbed.normal * rubbed.power);
        powers.fold(S::zero(), |sum, power| sum + power)
    }
}

impl Mechanism<f64> {
    /// −M⁻¹ ∂Q/∂(q, v, λ) of the friction of joints.
    pub(super) fn rubbing_entries(&self, j: &mut impl Entries) {
        let (n, now) = (self.layout.coordinates, &self.now);
        for (rubbing, rubbed) in self.rubbings.iter().zip(&now.rubbed) {
            let Site::Constraint(row) = rubbing.at else { continue };
            let friction = &rubbing.friction;
            let row = &self.layout.constraints[row];
            let bodies = friction.bodies();
            let scaled =
                |w: &Wrench<f64>, by: f64| Wrench { force: w.force * by, moment: w.moment * by };
            let (normal, by_lambda) = friction.normal(&now.lambda[row.range()]);
            for (r, slope) in row.range().zip(by_lambda) {
                let column = 2 * n + now.z.len() + r;
                for (on, one) in bodies.into_iter().zip(&rubbed.wrenches) {
                    self.subtract(on, column, &scaled(one, slope), j);
                }
            }
            for (side, body) in bodies.into_iter().enumerate() {
                let Some(at) = self.place_in_q(body) else { continue };
                for c in 0..3 {
                    let [by_q, by_v] = friction.slopes(&now.poses, &now.motions, (side, c));
                    for (on, (by_q, by_v)) in bodies.into_iter().zip(by_q.iter().zip(&by_v)) {
                        self.subtract(on, at + c, &scaled(by_q, normal), j);
                        self.subtract(on, n + at + c, &scaled(by_v, normal), j);
                    }
                }
            }
        }
    }
}
