//! Assembly: from rough poses to a start that satisfies every joint.
//!
//! What is wanted stands in ranks, each of which has its say only in what the ranks before it
//! leave free:
//!
//! 1. ideal joints and drives hold;
//! 2. fixed start keys hold;
//! 3. journals are centred in their bearings, C = 0, or at other places in them that are wished, or as
//!    nearly as can be: |C| is least;
//! 4. what is still free changes least, by mass, and what the case names counts far more.
//!
//! Velocities are one such problem, linear: among the rates that the first three ranks allow, the
//! start has those nearest to the rates that the case names (nought where it does not). Positions
//! are found by Newton's method from the rough poses: each step is such a problem, for the change,
//! and the limit of the steps is the start; until they are near it they end on coarse places, so
//! that no rounding chooses the branch. Neither knows a small weight or a tolerance, so that it
//! is the same start in every arithmetic, to the last places of each. Where |C| stays above nought
//! its second derivatives are taken in, without which the steps would gain but a few digits each.
//!
//! The unknowns are lengths: angles are multiplied by the mechanism's length, so that condition
//! numbers mean something.

use super::Mechanism;
use super::layout::{Role, Row};
use crate::clearance::Mode;
use crate::dae::{Fault, State, System};
use crate::joint::{Blocks, Constraint, MOST_BODIES, MOST_ROWS};
use crate::linear::{self, Cascade, nearest};
use crate::model::{Complaint, Joint, KeyPath, Owner, Start};
use crate::scalar::Scalar;

/// Speeds and rates less than this share of others, or than this many rad/s, are none.
const HARDLY: f64 = 1e-9;
const MOST_STEPS: usize = 200;
/// First steps, which weigh centring against staying: what the case does not name goes first.
const FIRST_STEPS: usize = 2;
/// Weight of an unnamed coordinate against a named one.
const UNNAMED: f64 = 1e-3;
/// A step of this size, over the mechanism's length, is on the branch, and taken whole.
const NEAR: f64 = 1e-3;
/// Places of coordinates are this far apart, over the mechanism's length, until steps are near: 2⁻²⁶.
const COARSE: f64 = 1.0 / 67_108_864.0;
/// Near steps that leave more than this of the one before are none of Newton's.
const SLOW: f64 = 0.05;
/// Steps that are not near by then want second derivatives too.
const LATE: usize = 20;
/// Steps that are not near by then move what moves least, whatever its mass: light bodies that turn
/// far to little effect lead nowhere.
const VERY_LATE: usize = 60;
/// A condition seen by less than this in units of rounding, for each unknown, is not seen.
const BLIND: f64 = 64.0;
/// Of more unknowns than this, conditions that do not depend on each other are met by their
/// multipliers, which takes time that grows with the mechanism; of fewer by reflections, which squares
/// nothing.
const MANY: usize = 150;
/// Passes that a linear problem is given to come to rest.
const MOST_PASSES: usize = 8;
/// Steps by which a derivative that is carried along follows its value.
const FOLLOWING: usize = 2;
/// Roundings by which doubles of another run may be off the constraints, and 71 digits not.
const GOING_ON: f64 = 1e6;
/// A start that is not known to this share of itself is none.
const LEAST_ACCURACY: f64 = 1e-4;

/// A condition on one coordinate: it has this value.
#[derive(Debug, Clone, Copy)]
struct Fixed<S> {
    at: usize,
    value: S,
}

/// The conditions of one assembly problem, written out at a state, rank by rank. Columns are those
/// of unknowns that are lengths (m), or their rates.
struct Conditions<S> {
    joints: Vec<linear::Row<S>>,
    fixed: Vec<linear::Row<S>>,
    wished: Vec<linear::Row<S>>,
    /// How far each unknown is from where it would be left: its coefficient is the root of its
    /// weight.
    near: Vec<linear::Row<S>>,
    /// Second derivatives of ½|C|² under the exact conditions, where they are wanted.
    bend: Option<Vec<S>>,
}

/// A change that meets conditions.
struct Change<S> {
    /// By unknown (m).
    x: Vec<S>,
    /// How many times an error of the conditions is multiplied in it.
    condition: f64,
}

/// How well an assembly problem was solved.
#[derive(Debug, Clone, Copy)]
struct Solved {
    /// What the last step still changed (m, m/s).
    left: f64,
    condition: f64,
    /// Whether another step would be nothing but rounding.
    at_rest: bool,
}

impl<S: Scalar> Mechanism<S> {
    /// Finds the start, the scales and the first modes.
    pub(super) fn assemble(&mut self) -> Result<(), Vec<Complaint>> {
        self.length = characteristic_length(self);
        let origin = self.model.origin();
        let mut q = self.named(|start| start.coordinates, [-origin.x, -origin.y, S::zero()]);
        let positions = self.assemble_positions(&mut q);
        self.check_positions(&q)?;
        self.find_redundant(&q)?;
        let (v, velocities) = self.assemble_velocities(&q)?;
        self.check_accuracy(&q, &v, positions, velocities)?;
        self.begin(&q, &v)?;
        self.check_memories()
    }

    /// Complains of what is to be remembered of contacts that the start is not in.
    fn check_memories(&self) -> Result<(), Vec<Complaint>> {
        let names = &self.model.names().memories;
        let forgotten = self.modes.iter().zip(&self.inner_places).flat_map(|(mode, places)| {
            let flies = matches!(mode, Mode::Flight);
            places.clone().filter(move |place| flies && self.model.memories()[*place] != S::zero())
        });
        let complaints: Vec<Complaint> = forgotten
            .map(|place| Complaint {
                key: KeyPath::new(["start", "memory"]),
                message: format!(
                    "gives {:?}, but nothing touches there at the start",
                    names[place]
                ),
            })
            .collect();
        if complaints.is_empty() { Ok(()) } else { Err(complaints) }
    }

    /// How far the start may be from the exact one, over the sizes of coordinates and velocities:
    /// the rounding of the arithmetic times what the conditions make of it, and what the last
    /// step changed.
    pub fn start_accuracy(&self) -> f64 {
        self.start_accuracy
    }

    /// Finds the accuracy of a start; complains if it is none.
    fn check_accuracy(
        &mut self,
        q: &[S],
        v: &[S],
        positions: Solved,
        velocities: Solved,
    ) -> Result<(), Vec<Complaint>> {
        let scales = self.column_scales();
        let largest = |x: &[S], least: f64| {
            let sizes = x.iter().zip(&scales).map(|(x, scale)| x.abs().to_f64() / scale.to_f64());
            sizes.fold(least, f64::max)
        };
        let rounding = 4.0 * S::EPSILON * largest(q, self.length) / self.length;
        let of_positions = rounding * positions.condition + positions.left / self.length;
        // an error of the positions turns the conditions of the velocities
        let of_velocities = velocities.condition * (rounding + of_positions)
            + velocities.left / largest(v, f64::MIN_POSITIVE);
        self.start_accuracy = of_positions.max(of_velocities);
        let complain = |message| Err(vec![Complaint { key: KeyPath::new(["start"]), message }]);
        if !(positions.at_rest && velocities.at_rest) {
            return complain(format!(
                "the assembly does not come to rest: its last step still moved a body by {:.1e} m; \
                 name poses nearer to those in which the mechanism closes",
                positions.left.max(velocities.left)
            ));
        }
        if !(self.start_accuracy <= LEAST_ACCURACY) {
            return complain(format!(
                "the mechanism starts in a singular position (a dead centre), or too near to one: \
                 this arithmetic knows positions there to {of_positions:.1e} and rates to \
                 {of_velocities:.1e} of themselves; start elsewhere"
            ));
        }
        Ok(())
    }

    /// What a metre of each unknown is in its coordinate (m, rad).
    fn column_scales(&self) -> Vec<S> {
        let turning = S::one() / S::from_f64(self.length);
        [S::one(), S::one(), turning].repeat(self.layout.coordinates / 3)
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
        self.move_start(q, v)
    }

    /// Moves the start to these coordinates and velocities, and back onto the constraints.
    ///
    /// # Errors
    /// The mechanism cannot be evaluated there.
    pub fn move_start(&mut self, mut q: Vec<S>, mut v: Vec<S>) -> Result<(), Vec<Complaint>> {
        self.project(S::zero(), &mut q, &mut v).map_err(start_fault)?;
        self.modes.fill(Mode::Flight);
        // the run is to differ by its start alone
        let scales = (self.coordinate_scales.clone(), self.velocity_scales.clone());
        self.begin(&q, &v)?;
        (self.coordinate_scales, self.velocity_scales) = scales;
        Ok(())
    }

    /// Takes a start: scales, first modes, energy.
    fn begin(&mut self, q: &[S], v: &[S]) -> Result<(), Vec<Complaint>> {
        self.start.q.copy_from_slice(q);
        self.start.v.copy_from_slice(v);
        self.set_scales(q, v);
        let z = self.start.z.clone();
        let state = State { time: S::zero(), q, v, z: &z, carried: None };
        self.place(&state);
        self.pass_gates();
        self.choose_start_modes(state).map_err(start_fault)?;
        let mut z = z.clone();
        self.release(&mut z);
        let state = State { z: &z, ..state };
        self.evaluate(state).map_err(start_fault)?;
        self.start.z.copy_from_slice(&z);
        self.start_energy = self.stored_energy();
        Ok(())
    }

    /// Values that the starts name, others where they do not.
    fn named(&self, of: fn(&Start<S>) -> [Option<S>; 3], otherwise: [S; 3]) -> Vec<S> {
        let mut x = vec![S::zero(); self.layout.coordinates];
        for (body, at) in self.free_bodies() {
            for (c, value) in of(&self.model.starts()[body - 1]).into_iter().enumerate() {
                x[at + c] = value.unwrap_or(otherwise[c]);
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

    /// Roots of the weights by which unknowns stay where they are: masses over the largest, far
    /// smaller where the case names nothing.
    fn weights(&self, of: fn(&Start<S>) -> [Option<S>; 3]) -> Vec<S> {
        let masses = self.free_bodies().map(|(body, _)| self.model.masses()[body]);
        let largest = masses.fold(S::zero(), |largest, mass| largest.max(mass));
        let mut weights = self.column_scales();
        for (body, at) in self.free_bodies() {
            let start = of(&self.model.starts()[body - 1]);
            let mass = self.model.masses()[body];
            let inertia = self.model.inertias()[body];
            for (c, value) in [mass, mass, inertia].into_iter().enumerate() {
                let named = if start[c].is_some() { 1.0 } else { UNNAMED };
                weights[at + c] *= (value / largest * S::from_f64(named)).sqrt();
            }
        }
        weights
    }

    /// The joints with clearance as the ideal ones that would centre their journals.
    fn centring(&self) -> Vec<Row<S>> {
        (self.model.joints().iter().enumerate())
            .filter(|(_, joint)| joint.is_loose())
            .map(|(index, joint)| Row {
                constraint: Constraint::joint(joint.relation, &joint.ends),
                first: 0,
                rows: joint.relation.rows(),
                owner: Owner::Joint(index),
            })
            .collect()
    }

    /// Moves q to the assembled positions, as nearly as they can be reached.
    fn assemble_positions(&mut self, q: &mut [S]) -> Solved {
        let fixed = self.fixed(|start| start.coordinates);
        for fixed in &fixed {
            q[fixed.at] = fixed.value;
        }
        let solved = self.approach(q, &fixed);
        self.hold(q, &fixed);
        solved
    }

    /// Takes what is fixed as it is written, where it is off by rounding only.
    /// What another run has come to is so to the last bit.
    fn hold(&self, x: &mut [S], fixed: &[Fixed<S>]) {
        let roundings = if self.model.goes_on() { GOING_ON } else { 1e3 };
        for fixed in fixed {
            let rounding = roundings * S::EPSILON * fixed.value.abs().to_f64().max(self.length);
            if (x[fixed.at] - fixed.value).abs().to_f64() <= rounding {
                x[fixed.at] = fixed.value;
            }
        }
    }

    /// Moves q by Newton steps until they change nothing. A step that makes things worse is
    /// halved, until the steps are near.
    fn approach(&mut self, q: &mut [S], fixed: &[Fixed<S>]) -> Solved {
        let scales = self.column_scales();
        let near = NEAR * self.length;
        let mut solved = Solved { left: f64::INFINITY, condition: 1.0, at_rest: false };
        let (mut slow, mut near_by, mut following) = (false, false, 0);
        for step in 0..MOST_STEPS {
            let mut conditions = self.position_conditions(q, fixed);
            if step >= VERY_LATE && !near_by {
                for row in &mut conditions.near {
                    row.coefficients[0].1 = S::one();
                }
            }
            if slow && q.len() <= MANY {
                conditions.bend = Some(self.bend(&conditions));
            }
            let Some(change) = conditions.change(step < FIRST_STEPS) else { break };
            let whole = change.size();
            let fraction = if whole <= near {
                S::one()
            } else {
                self.fraction(q, &change, fixed, conditions.error())
            };
            for (k, x) in q.iter_mut().enumerate() {
                *x += fraction * change.x[k] * scales[k];
            }
            if whole > near {
                self.coarsen(q, fixed);
            }
            near_by |= whole <= near;
            let moved = whole * fraction.to_f64();
            let rounding = S::EPSILON * q.iter().fold(self.length, |l, x| l.max(x.abs().to_f64()));
            let no_gain = moved > 0.9 * solved.left && moved <= 1e3 * rounding * change.condition;
            let last = std::mem::replace(
                &mut solved,
                Solved { left: moved, condition: change.condition, at_rest: false },
            );
            if step < FIRST_STEPS {
                continue;
            }
            if moved <= 4.0 * rounding || no_gain {
                solved.at_rest = true;
                following += 1;
                if !S::CARRIES_DERIVATIVE || following > FOLLOWING {
                    break;
                }
            }
            slow |= (moved <= near && moved > SLOW * last.left) || step >= LATE;
        }
        solved
    }

    /// Takes what is not fixed to the nearest of coarse places, the same in every arithmetic: far
    /// from where the mechanism closes steps multiply rounding, and might choose another branch.
    fn coarsen(&self, q: &mut [S], fixed: &[Fixed<S>]) {
        for (k, x) in q.iter_mut().enumerate() {
            let size = if k % 3 == 2 { 1.0 } else { self.length.log2().floor().exp2() };
            let coarse = COARSE * size;
            if fixed.iter().all(|fixed| fixed.at != k) && x.is_finite() {
                *x = S::from_f64((x.to_f64() / coarse).round() * coarse);
            }
        }
    }

    /// The fraction of a change, of halves, that makes things no worse than they were.
    fn fraction(&mut self, q: &[S], change: &Change<S>, fixed: &[Fixed<S>], before: S) -> S {
        let scales = self.column_scales();
        let mut fraction = S::one();
        for _ in 0..12 {
            let moved = (0..q.len()).map(|k| q[k] + fraction * change.x[k] * scales[k]);
            let there: Vec<S> = moved.collect();
            if self.position_conditions(&there, fixed).error() <= before {
                break;
            }
            fraction *= S::from_f64(0.5);
        }
        fraction
    }

    fn position_conditions(&mut self, q: &[S], fixed: &[Fixed<S>]) -> Conditions<S> {
        let rest = vec![S::zero(); q.len()];
        self.place(&State { time: S::zero(), q, v: &rest, z: &[], carried: None });
        let from_fixed = |fixed: &Fixed<S>| q[fixed.at] - fixed.value;
        let away = vec![S::zero(); q.len()];
        let weights = self.weights(|start| start.coordinates);
        let mut conditions = self.conditions(&weights, &away, fixed, from_fixed, |row, error| {
            row.constraint.position_error(self.now.time, &self.now.poses, error);
        });
        let mut wished = conditions.wished.iter_mut();
        for (joint, offset) in self.centring().iter().zip(&self.wished_offsets) {
            for (r, offset) in offset.iter().enumerate().take(joint.rows) {
                let size = self.row_size(joint, r);
                wished.next().into_iter().for_each(|row| row.error -= *offset * size);
            }
        }
        conditions
    }

    /// The length (m) that a row counts for: of angles the mechanism's.
    fn row_size(&self, row: &Row<S>, r: usize) -> S {
        if row.constraint.is_angle(r) { S::from_f64(self.length) } else { S::one() }
    }

    /// Conditions as placed: how far each unknown is `away` from where it would be left, the value
    /// of each fixed coordinate and of each row.
    fn conditions(
        &self,
        weights: &[S],
        away: &[S],
        fixed_rows: &[Fixed<S>],
        from_fixed: impl Fn(&Fixed<S>) -> S,
        error: impl Fn(&Row<S>, &mut [S]),
    ) -> Conditions<S> {
        let scales = self.column_scales();
        let single = |at: usize, coefficient: S, error: S| linear::Row {
            coefficients: vec![(at, coefficient)],
            error,
        };
        let written = |rows: &[Row<S>]| {
            let mut out = Vec::new();
            for row in rows {
                let mut errors = [S::zero(); MOST_ROWS];
                error(row, &mut errors);
                let all = self.coefficients(&row.constraint);
                for (r, (mut coefficients, error)) in all.into_iter().zip(errors).enumerate() {
                    let size = self.row_size(row, r);
                    coefficients.iter_mut().for_each(|(k, a)| *a = *a * scales[*k] * size);
                    out.push(linear::Row { coefficients, error: error * size });
                }
            }
            out
        };
        let fixed =
            |fixed: &Fixed<S>| single(fixed.at, S::one(), from_fixed(fixed) / scales[fixed.at]);
        let near = |k: usize| single(k, weights[k], weights[k] * away[k] / scales[k]);
        Conditions {
            joints: written(&self.layout.constraints),
            fixed: fixed_rows.iter().map(fixed).collect(),
            wished: written(&self.centring()),
            near: (0..scales.len()).map(near).collect(),
            bend: None,
        }
    }

    /// Second derivatives of ½|C|² under the exact conditions, as placed: a matrix, row by row.
    fn bend(&self, conditions: &Conditions<S>) -> Vec<S> {
        let n = self.layout.coordinates;
        let mut slope = vec![S::zero(); n];
        for linear::Row { coefficients, error } in &conditions.wished {
            coefficients.iter().for_each(|(k, a)| slope[*k] += *a * *error);
        }
        // what the exact conditions hold against the slope: |Hᵀ μ + Cᵀ C| is least
        let exact = || conditions.joints.iter().chain(&conditions.fixed);
        let mut across: Vec<linear::Row<S>> = slope
            .into_iter()
            .map(|error| linear::Row { coefficients: Vec::new(), error })
            .collect();
        for (row, condition) in exact().enumerate() {
            for (k, a) in &condition.coefficients {
                across[*k].coefficients.push((row, *a));
            }
        }
        let mut multipliers = Cascade::new(exact().count());
        multipliers.minimise(&across, None, blind::<S>(n));
        let scales = self.column_scales();
        let mut bend = vec![S::zero(); n * n];
        let mut add = |constraint: &Constraint<S>, lambda: &[S]| {
            let bodies = constraint.bodies();
            let place = |(side, c): (usize, usize)| match self.layout.roles[bodies[side]] {
                Role::Free(at) => Some(at + c),
                Role::Ground | Role::Driven => None,
            };
            constraint.bend(&self.now.poses, lambda, |of, by, entry| {
                let (Some(of), Some(by)) = (place(of), place(by)) else { return };
                bend[of * n + by] += entry * scales[of] * scales[by];
            });
        };
        for row in &self.layout.constraints {
            add(&row.constraint, &multipliers.x()[row.range()]);
        }
        let mut errors = conditions.wished.iter().map(|row| row.error);
        for row in self.centring() {
            let errors: Vec<S> = errors.by_ref().take(row.rows).collect();
            add(&row.constraint, &errors);
        }
        bend
    }

    /// Φ_q of a constraint, row by row: coordinates and coefficients.
    fn coefficients(&self, constraint: &Constraint<S>) -> Vec<Vec<(usize, S)>> {
        let arms = constraint.arms(&self.now.poses);
        let mut rows = vec![[[S::zero(); 3]; MOST_BODIES]; constraint.rows()];
        constraint.slopes(&self.now.poses, &arms, &mut rows);
        let written = |blocks: &Blocks<S>| {
            let mut coefficients: Vec<(usize, S)> = Vec::new();
            for (body, block) in constraint.bodies().into_iter().zip(blocks) {
                let Role::Free(at) = self.layout.roles[body] else { continue };
                let something =
                    |(_, entry): &(usize, &S)| S::CARRIES_DERIVATIVE || **entry != S::zero();
                for (k, entry) in (at..at + 3).zip(block).filter(something) {
                    match coefficients.iter_mut().find(|(known, _)| *known == k) {
                        Some((_, sum)) => *sum += *entry,
                        None => coefficients.push((k, *entry)),
                    }
                }
            }
            coefficients
        };
        rows.iter().map(written).collect()
    }

    /// Complains of every joint that does not close and every key that does not hold.
    fn check_positions(&mut self, q: &[S]) -> Result<(), Vec<Complaint>> {
        let rest = vec![S::zero(); q.len()];
        self.place(&State { time: S::zero(), q, v: &rest, z: &[], carried: None });
        let allowed = 1e-9 * self.length;
        let mut complaints = Vec::new();
        for row in &self.layout.constraints {
            let mut error = [S::zero(); MOST_ROWS];
            row.constraint.position_error(S::zero(), &self.now.poses, &mut error);
            let off = error.map(|error| error.to_f64());
            let off = off[0].hypot(off[1]).hypot(off[2]);
            if !(off <= allowed) {
                complaints.push(Complaint {
                    key: row.owner.key(self.model.names()),
                    message: format!(
                        "does not close: it is off by {off:.6e} m (rad) in the best assembly \
                         found; check the lengths and the poses under [start]"
                    ),
                });
            }
        }
        complaints.extend(self.unmet(q, allowed, |start| start.coordinates, ["x", "y", "angle"]));
        complaints.extend(self.unmet_by_drives(
            |start| start.coordinates,
            |of, body| {
                let pose = &of.now.poses[body];
                [pose.position.x, pose.position.y, pose.angle]
            },
            allowed,
            ["x", "y", "angle"],
        ));
        complaints.extend(self.off_the_wall());
        let fixed = self.model.starts().iter().any(|start| start.fixed);
        if !fixed && self.wished_offsets.is_empty() {
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

    /// The same of bodies that the drives prescribe, where the start is that of another run.
    fn unmet_by_drives(
        &self,
        of: fn(&Start<S>) -> [Option<S>; 3],
        prescribed: impl Fn(&Self, usize) -> [S; 3],
        allowed: f64,
        keys: [&str; 3],
    ) -> Vec<Complaint> {
        let mut complaints = Vec::new();
        for (body, role) in self.layout.roles.iter().enumerate().skip(1) {
            let start = &self.model.starts()[body - 1];
            if *role != Role::Driven || !start.fixed || !self.model.goes_on() {
                continue;
            }
            let values = of(start).into_iter().zip(prescribed(self, body)).zip(keys);
            for ((wanted, has), key) in values {
                let Some(wanted) = wanted else { continue };
                if !((wanted - has).abs().to_f64() <= allowed) {
                    let message = format!(
                        "is fixed at {:e}, but the drives have it at {:e} there: they are others \
                         than those of the run that this start is from",
                        wanted.to_f64(),
                        has.to_f64()
                    );
                    let name = self.model.body_name(body);
                    complaints.push(Complaint { key: KeyPath::new(["start", name, key]), message });
                }
            }
        }
        complaints
    }

    /// Complaints of contacts that the start is said to be in, but whose journals are off the wall.
    fn off_the_wall(&self) -> Vec<Complaint> {
        let clearances = self.model.clearances().iter().zip(self.model.contacts()).enumerate();
        let off = clearances.filter_map(|(k, (clearance, given))| {
            let depth = given.and(Some(self.now.gap(k, clearance).depth.to_f64()))?;
            (depth < -1e-9 * self.length).then(|| Complaint {
                key: KeyPath::new(["start", "contact"]),
                message: format!(
                    "has joint {:?} in contact, but its {} is {:.6e} m off the wall",
                    self.model.names().clearances[k],
                    clearance.surfaces()[0],
                    -depth
                ),
            })
        });
        off.collect()
    }

    /// Complaints of journals that end up outside their clearance although nothing is fixed.
    fn overlaps(&self) -> Vec<Complaint> {
        let joints = self.model.joints().iter().enumerate();
        let deepest = |(index, joint): (usize, &Joint<S>)| {
            let depth = |k: usize| self.now.gap(k, &self.model.clearances()[k]).depth.to_f64();
            let k = joint.clearances.clone().max_by(|a, b| depth(*a).total_cmp(&depth(*b)))?;
            let clearance = &self.model.clearances()[k];
            let gap = self.now.gap(k, clearance);
            let [inner, outer] = clearance.surfaces();
            let (from, play) = match clearance.wall {
                None => (format!("the {outer}'s centre"), "radial clearance"),
                Some(_) => ("its nominal place".to_owned(), "play"),
            };
            (gap.depth > S::zero()).then(|| Complaint {
                key: Owner::Joint(index).key(self.model.names()),
                message: format!(
                    "does not close: the {inner} is {:.6e} m from {from} in the best assembly found, \
                     the {play} is {:.6e} m; check the lengths and the poses under [start]",
                    gap.eccentricity.to_f64(),
                    clearance.radial.to_f64()
                ),
            })
        };
        joints.filter_map(deepest).collect()
    }

    fn assemble_velocities(&mut self, q: &[S]) -> Result<(Vec<S>, Solved), Vec<Complaint>> {
        self.factor().map_err(|singular| {
            vec![Complaint {
                key: self.layout.owner(singular.row).key(self.model.names()),
                message: "holds what the other joints hold already, or the mechanism starts in a \
                          singular position (a dead centre); remove the joint, or start elsewhere"
                    .into(),
            }]
        })?;
        let fixed = self.fixed(|start| start.velocities);
        let named = self.named(|start| start.velocities, [S::zero(); 3]);
        let scales = self.column_scales();
        let mut v = named.clone();
        let mut solved = Solved { left: f64::INFINITY, condition: 1.0, at_rest: false };
        // the problem is linear; a second pass removes what rounding leaves
        for pass in 0..MOST_PASSES {
            let conditions = self.velocity_conditions(q, &v, &named, &fixed);
            let Some(change) = conditions.change(false) else { break };
            for (k, v) in v.iter_mut().enumerate() {
                *v += change.x[k] * scales[k];
            }
            let left = change.size();
            let no_gain = pass >= FOLLOWING && !(left < 0.5 * solved.left);
            solved = Solved { left, condition: change.condition, at_rest: true };
            if no_gain || (left == 0.0 && pass >= FOLLOWING) {
                break;
            }
        }
        self.hold(&mut v, &fixed);
        let fastest = v.iter().fold(1.0, |fastest: f64, v| fastest.max(v.abs().to_f64()));
        let keys = ["velocity_x", "velocity_y", "angular_velocity"];
        let mut complaints = self.unmet(&v, 1e-9 * fastest, |start| start.velocities, keys);
        complaints.extend(self.unmet_by_drives(
            |start| start.velocities,
            |of, body| {
                let motion = &of.now.motions[body];
                [motion.linear.x, motion.linear.y, motion.angular]
            },
            1e-9 * fastest,
            keys,
        ));
        if complaints.is_empty() { Ok((v, solved)) } else { Err(complaints) }
    }

    fn velocity_conditions(
        &mut self,
        q: &[S],
        v: &[S],
        named: &[S],
        fixed: &[Fixed<S>],
    ) -> Conditions<S> {
        self.place(&State { time: S::zero(), q, v, z: &[], carried: None });
        let away: Vec<S> = v.iter().zip(named).map(|(v, named)| *v - *named).collect();
        let weights = self.weights(|start| start.velocities);
        let from_fixed = |fixed: &Fixed<S>| v[fixed.at] - fixed.value;
        self.conditions(&weights, &away, fixed, from_fixed, |row, error| {
            let (poses, motions) = (&self.now.poses, &self.now.motions);
            row.constraint.velocity_error(self.now.time, poses, motions, error);
        })
    }

    /// Typical sizes from the start: angles 1 rad; lengths the largest arm; rates the largest of
    /// any body, or, where all are at rest, one radian a second.
    fn set_scales(&mut self, q: &[S], v: &[S]) {
        self.place(&State { time: S::zero(), q, v, z: &[], carried: None });
        let largest = |of: &dyn Fn(&crate::plane::Motion<S>) -> S| {
            self.now.motions.iter().map(|m| of(m).abs().to_f64()).fold(0.0, f64::max)
        };
        // what hardly moves, or only by rounding, is no measure of what will
        let or = |x: f64, other: f64| if x > HARDLY * other { x } else { other };
        let turning = largest(&|motion| motion.angular);
        let going = largest(&|motion| motion.linear.norm());
        let rate = match or(turning, going / self.length) {
            rate if rate > HARDLY => rate,
            _ => 1.0,
        };
        let speed = or(going, rate * self.length);
        let bodies = self.layout.coordinates / 3;
        self.coordinate_scales = [self.length, self.length, 1.0].repeat(bodies);
        self.velocity_scales = [speed, speed, rate].repeat(bodies);
    }
}

impl<S: Scalar> Conditions<S> {
    /// Sum of squares of what is not met; exact conditions weigh more.
    fn error(&self) -> S {
        let squares = |rows: &[linear::Row<S>]| {
            rows.iter().fold(S::zero(), |sum, row| sum + row.error * row.error)
        };
        (squares(&self.joints) + squares(&self.fixed)) * S::from_f64(1e3) + squares(&self.wished)
    }

    /// The change of the module's header; where centring is weighed against staying, the last two
    /// ranks are one. `None` if it cannot be computed.
    fn change(&self, weighed: bool) -> Option<Change<S>> {
        let change = if self.near.len() > MANY { self.by_multipliers(weighed) } else { None };
        if change.is_some() {
            return change;
        }
        let first = self.solution(weighed)?;
        if self.bend.is_some() {
            return Some(first);
        }
        // what rounding has left of it is such a problem too
        let after = |rows: &[linear::Row<S>]| {
            let left =
                |row: &linear::Row<S>| linear::Row { error: row.at(&first.x), ..row.clone() };
            rows.iter().map(left).collect()
        };
        let second = Conditions {
            joints: after(&self.joints),
            fixed: after(&self.fixed),
            wished: after(&self.wished),
            near: after(&self.near),
            bend: None,
        };
        let second = second.solution(weighed)?;
        let x = first.x.iter().zip(&second.x).map(|(x, more)| *x + *more).collect();
        Some(Change { x, condition: first.condition })
    }

    /// The change where no condition depends on others.
    fn by_multipliers(&self, weighed: bool) -> Option<Change<S>> {
        let exact = [&*self.joints, &self.fixed];
        let (x, condition) = match weighed {
            true => nearest(&exact, &self.wished, &self.near)?,
            false => nearest(&[exact[0], exact[1], &self.wished], &[], &self.near)?,
        };
        Some(Change { x, condition })
    }

    fn solution(&self, weighed: bool) -> Option<Change<S>> {
        let n = self.near.len();
        let blind = blind::<S>(n);
        let mut cascade = Cascade::new(n);
        let mut condition = cascade.minimise(&self.joints, None, blind);
        condition *= cascade.minimise(&self.fixed, None, blind);
        match weighed {
            true => {
                let both: Vec<_> = self.wished.iter().chain(&self.near).cloned().collect();
                cascade.minimise(&both, None, 0.0);
            }
            false => {
                condition *= cascade.minimise(&self.wished, self.bend.as_deref(), blind);
                cascade.minimise(&self.near, None, 0.0);
            }
        }
        let x = cascade.x().to_vec();
        x.iter().all(|x| x.is_finite()).then_some(Change { x, condition })
    }
}

impl<S: Scalar> Change<S> {
    /// The largest change of an unknown (m).
    fn size(&self) -> f64 {
        self.x.iter().fold(0.0, |most, x| most.max(x.abs().to_f64()))
    }
}

/// What counts as not seen by a condition of n unknowns, over its coefficients.
fn blind<S: Scalar>(n: usize) -> f64 {
    BLIND * n as f64 * S::EPSILON
}

fn start_fault(fault: Fault) -> Vec<Complaint> {
    vec![Complaint { key: KeyPath::new(["joints"]), message: fault.to_string() }]
}

/// The largest distance (m) of a joint's point from its body's mass centre, or of two points of
/// the ground from each other.
fn characteristic_length<S: Scalar>(mechanism: &Mechanism<S>) -> f64 {
    let joints = mechanism.model().joints().iter();
    let arms = joints.map(|joint| joint.ends.pair).flat_map(|p| [(p.i, p.s_i), (p.j, p.s_j)]);
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
