//! Constraints that follow from others: a third crank of a parallelogram, a second guide in line.
//!
//! Where rows of Φ_q depend on each other wherever the mechanism can be, accelerations are determined and
//! forces are not: with the directions W in which multipliers do nothing, Φ_qᵀ W = 0, any λ + W μ does the
//! same. Those of least norm are taken, Wᵀ λ = 0, a moment counting over the mechanism's length: they solve
//! ```text
//! (Φ_q M⁻¹ Φ_qᵀ + s W Wᵀ) λ = …
//! ```
//! whatever s > 0, whose matrix is regular again. W comes from an elimination with complete pivoting. How
//! many columns it has is found at the start and holds for the run: as many as in another position of the
//! mechanism too, for what depends on others in one alone is a singular position, and none of this.

use super::Mechanism;
use super::layout::{Layout, Row};
use crate::dae::State;
use crate::linear::{self, Singular};
use crate::model::{Complaint, KeyPath, Owner};
use crate::scalar::Scalar;

/// Share, squared, that others leave of a row that follows from them.
const FOLLOWS: f64 = 1e-10;
/// How far the mechanism moves (rad, or over its length) to see whether rows follow there too.
const ASIDE: f64 = 0.05;
/// A joint that has less than this in every idle direction takes no part in them.
const TAKES_PART: f64 = 1e-6;

/// Directions in which multipliers do nothing.
#[derive(Debug, Clone)]
pub(super) struct Idle<S> {
    /// By direction and row: orthonormal, but that angles count as lengths.
    directions: Vec<Vec<S>>,
    /// What they weigh in the matrix s.
    weight: S,
}

impl<S: Scalar> Idle<S> {
    pub fn none() -> Self {
        Idle { directions: Vec::new(), weight: S::zero() }
    }

    /// Subtracts s W Wᵀ λ.
    pub fn subtract(&self, lambda: &[S], from: &mut [S]) {
        for direction in &self.directions {
            let along = direction.iter().zip(lambda).fold(S::zero(), |sum, (w, l)| sum + *w * *l);
            let weighed = self.weight * along;
            from.iter_mut().zip(direction).for_each(|(x, w)| *x -= weighed * *w);
        }
    }

    /// The entries of s W Wᵀ: row, column, value.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, S)> + '_ {
        let rows = self.directions.first().map_or(0, Vec::len);
        let value = move |row: usize, column: usize| {
            let both = self.directions.iter().map(|w| w[row] * w[column]);
            self.weight * both.fold(S::zero(), |sum, x| sum + x)
        };
        (0..rows * rows).map(move |k| (k / rows, k % rows, value(k / rows, k % rows)))
    }

    /// The part of a row in each direction.
    pub fn of_row(&self, row: usize) -> impl Iterator<Item = S> + '_ {
        self.directions.iter().map(move |direction| direction[row])
    }
}

impl<S: Scalar> Mechanism<S> {
    /// How many of the conditions of joints and drives follow from the others.
    pub fn redundant(&self) -> usize {
        self.redundant
    }

    /// The joints and drives that hold each other so, at the state last evaluated: their forces are those of
    /// least norm.
    pub fn redundantly_held(&self) -> Vec<Owner> {
        let takes_part = |row: usize| {
            let parts = self.now.idle.of_row(row);
            parts.into_iter().any(|part| part.to_f64().abs() > TAKES_PART * self.row_lengths[row])
        };
        let mut held: Vec<Owner> = self
            .layout
            .constraints
            .iter()
            .filter(|row| row.range().any(takes_part))
            .map(|row| row.owner)
            .collect();
        held.sort();
        held
    }

    /// What makes a force (N) of each row's multiplier: one over the length for an angle, else 1.
    fn find_row_lengths(&mut self) {
        let of = |row: &Row<S>, r: usize| {
            if row.constraint.is_angle(r) { 1.0 / self.length } else { 1.0 }
        };
        let rows = self.layout.constraints.iter();
        self.row_lengths = rows.flat_map(|row| (0..row.rows).map(move |r| of(row, r))).collect();
    }

    /// Finds out whether conditions follow from others at the assembled positions and beside them.
    ///
    /// # Errors
    /// Friction in a joint whose force is not determined.
    pub(super) fn find_redundant(&mut self, q: &[S]) -> Result<(), Vec<Complaint>> {
        let rest = vec![S::zero(); q.len()];
        self.place(&State { time: S::zero(), q, v: &rest, z: &[], carried: None });
        // quick, and most mechanisms have none
        if self.layout.rows == 0 || self.factor().is_ok() {
            return Ok(());
        }
        self.find_row_lengths();
        self.layout.fill(&self.model);
        self.now.matrix = self.layout.matrix.clone();
        let mut found = self.count_idle();
        while found > 0 {
            self.redundant = found;
            if self.follow_aside(q).is_some_and(|aside| aside >= found) {
                break;
            }
            found -= 1;
        }
        self.redundant = found;
        if found == 0 {
            self.layout = Layout::new(&self.model)?;
            self.now.matrix = self.layout.matrix.clone();
            return self.held_too_often();
        }
        self.place(&State { time: S::zero(), q, v: &rest, z: &[], carried: None });
        if self.factor().is_ok() && !self.rubbings.is_empty() {
            let held = self.redundantly_held();
            let friction = self.model.loads().iter().position(|load| load.rubs().is_some());
            let names: Vec<String> =
                held.iter().map(|owner| owner.name(self.model.names())).collect();
            return Err(vec![Complaint {
                key: KeyPath::new(["loads", self.model.load_name(friction.unwrap_or(0))]),
                message: format!(
                    "hangs on a force that is not determined: {} hold each other; remove one of them, or \
                     give one clearance",
                    names.join(", ")
                ),
            }]);
        }
        Ok(())
    }

    /// A complaint where there are more conditions than coordinates.
    fn held_too_often(&self) -> Result<(), Vec<Complaint>> {
        let Layout { coordinates, rows, .. } = self.layout;
        if rows <= coordinates {
            return Ok(());
        }
        Err(vec![Complaint {
            key: KeyPath::new(["joints"]),
            message: format!(
                "hold the mechanism {} times too often, and do not agree as it moves: {coordinates} \
                 coordinates, {rows} constraints; remove a joint or a drive, or give a joint clearance",
                rows - coordinates
            ),
        }])
    }

    /// How many rows follow from others, as placed.
    fn count_idle(&mut self) -> usize {
        self.couple();
        let (_, pivots) = linear::pivots(&self.weighed_matrix(), self.layout.rows);
        pivots.iter().filter(|pivot| **pivot < FOLLOWS).count()
    }

    /// The same at a position beside one; `None` where it is not reached.
    fn follow_aside(&mut self, q: &[S]) -> Option<usize> {
        let n = q.len();
        // rates that are not those of any symmetry
        let mut v: Vec<S> = (0..n)
            .map(|k| {
                S::from_f64((1.0 + k as f64).sin() * if k % 3 == 2 { 1.0 } else { self.length })
            })
            .collect();
        let mut there = q.to_vec();
        self.project_onto_constraints(S::zero(), &mut there, &mut v).ok()?;
        let size = |k: usize| if k % 3 == 2 { 1.0 } else { self.length };
        let fastest = (0..n).map(|k| v[k].abs().to_f64() / size(k)).fold(0.0, f64::max);
        if !(fastest > 1e-9) {
            // nothing moves: there is no other position
            return Some(self.redundant);
        }
        let span = S::from_f64(ASIDE / fastest);
        there.iter_mut().zip(q).zip(&v).for_each(|((there, q), v)| *there = *q + span * *v);
        self.project_onto_constraints(span, &mut there, &mut v).ok()?;
        Some(self.count_idle())
    }

    /// Φ_q M⁻¹ Φ_qᵀ as coupled, rows of angles counted in lengths; row by row.
    fn weighed_matrix(&mut self) -> Vec<S> {
        let n = self.layout.rows;
        let lengths: Vec<S> = self.row_lengths.iter().map(|length| S::from_f64(*length)).collect();
        let matrix = &mut self.now.matrix;
        let mut whole = vec![S::zero(); n * n];
        for row in 0..n {
            for column in 0..=row {
                let at = matrix.place(row, column);
                let entry = matrix.entries_mut()[at] / (lengths[row] * lengths[column]);
                whole[row * n + column] = entry;
                whole[column * n + row] = entry;
            }
        }
        whole
    }

    /// Adds s W Wᵀ to the matrix as coupled.
    pub(super) fn support(&mut self) -> Result<(), Singular> {
        let n = self.layout.rows;
        let whole = self.weighed_matrix();
        let (order, _) = linear::pivots(&whole, n);
        let last = Singular { row: order[n.saturating_sub(self.redundant + 1)] };
        let mut directions = linear::null_space(&whole, n, &order, self.redundant).ok_or(last)?;
        let trace = (0..n).map(|row| whole[row * (n + 1)].to_f64()).sum::<f64>();
        self.orient(&mut directions);
        for direction in &mut directions {
            let lengths = self.row_lengths.iter().map(|length| S::from_f64(*length));
            direction.iter_mut().zip(lengths).for_each(|(x, length)| *x *= length);
        }
        let idle = Idle { directions, weight: S::from_f64(trace / n as f64) };
        for (row, column, value) in idle.entries().filter(|(row, column, _)| column <= row) {
            let at = self.now.matrix.place(row, column);
            self.now.matrix.entries_mut()[at] += value;
        }
        self.now.idle = idle;
        Ok(())
    }

    /// Turns one of some directions round where they have another orientation than those before, so that
    /// orientation is continuous ([`Mechanism::branch`]).
    fn orient(&self, directions: &mut [Vec<S>]) {
        let count = directions.len();
        let before = &self.now.idle.directions;
        let mut both: Vec<S> = Vec::with_capacity(count * count);
        for new in directions.iter() {
            both.extend(before.iter().map(|old| {
                new.iter().zip(old).fold(S::zero(), |sum, (new, old)| sum + *new * *old)
            }));
        }
        if both.len() == count * count
            && linear::determinant_sign(&mut both, count) < 0
            && let Some(first) = directions.first_mut()
        {
            first.iter_mut().for_each(|x| *x = -*x);
        }
    }
}
