//! Residual and Jacobian of the index-1 form, written by hand.
//! ```text
//! r_q = q̇ − v
//! r_v = v̇ − M⁻¹ (Q(q, v, z, t) − Φ_qᵀ λ)
//! r_z = ż − f(q, v, z, t)
//! r_λ = Φ̈(q, v, v̇, t) − s W Wᵀ λ
//! ```
//! W are the directions in which multipliers do nothing, where constraints follow from others
//! (`redundant.rs`). y = (q, v, z, λ); the Jacobian is ∂r/∂y + c_j ∂r/∂ẏ. It is tested against dual numbers, column by
//! column.

use super::layout::{FreeBody, Role};
use super::{Mechanism, inner_states};
use crate::clearance::Mode;
use crate::dae::{Dae, Entries, Fault, State};
use crate::plane::{Motion, Vector, Wrench};
use crate::scalar::Scalar;

impl<S: Scalar> Mechanism<S> {
    /// The residual in any arithmetic.
    #[inline(always)]
    pub fn index_one_residual(&mut self, t: S, y: &[S], yp: &[S], r: &mut [S]) {
        let n = self.layout.coordinates;
        self.stand(t, y, yp);
        self.apply_loads(&[]);
        self.apply_multipliers();
        self.apply_rubbing();
        for k in 0..n {
            r[k] = yp[k] - y[n + k];
        }
        for (body, at) in self.free_bodies() {
            let wrench = &self.now.wrenches[body];
            let by = &self.inverse_masses[at..at + 3];
            let (row, rate) = (n + at, &yp[n + at..n + at + 3]);
            r[row] = rate[0] - by[0] * wrench.force.x;
            r[row + 1] = rate[1] - by[1] * wrench.force.y;
            r[row + 2] = rate[2] - by[2] * wrench.moment;
        }
        let now = &self.now;
        let first = 2 * n + now.z.len();
        for (k, rate) in now.z_dot.iter().enumerate() {
            r[2 * n + k] = yp[2 * n + k] - *rate;
        }
        for (row, arms) in self.layout.constraints.iter().zip(&now.arms) {
            let (motions, accelerations) = (&now.motions, &now.accelerations);
            let at = first + row.first;
            let error = &mut r[at..at + row.rows];
            let poses = &now.poses;
            row.constraint.acceleration_error(t, arms, poses, motions, accelerations, error);
        }
        // what makes multipliers that do nothing definite, as last factored
        now.idle.subtract(&now.lambda, &mut r[first..]);
    }

    /// Places the bodies at (q, v) of `y`, with z and λ of `y` and the accelerations of `yp`.
    fn stand(&mut self, t: S, y: &[S], yp: &[S]) {
        let n = self.layout.coordinates;
        let (z, lambda) = y[2 * n..].split_at(self.now.z.len());
        self.place(&State { time: t, q: &y[..n], v: &y[n..2 * n], z, carried: None });
        self.reach();
        self.now.z.copy_from_slice(z);
        self.now.lambda.copy_from_slice(lambda);
        for FreeBody { body, at, .. } in &self.layout.free {
            let a = &yp[n + at..n + at + 3];
            self.now.accelerations[*body] =
                Motion { linear: Vector::new(a[0], a[1]), angular: a[2] };
        }
    }

    /// Place in q of a free body.
    pub(super) fn place_in_q(&self, body: usize) -> Option<usize> {
        match self.layout.roles[body] {
            Role::Free(at) => Some(at),
            _ => None,
        }
    }
}

impl Dae for Mechanism<f64> {
    fn residual(&mut self, t: f64, y: &[f64], yp: &[f64], r: &mut [f64]) -> Result<(), Fault> {
        self.index_one_residual(t, y, yp, r);
        match r.iter().all(|r| r.is_finite()) {
            true => Ok(()),
            false => Err(Fault::TryShorterStep("the residual is not finite".into())),
        }
    }

    fn jacobian(
        &mut self,
        t: f64,
        y: &[f64],
        yp: &[f64],
        cj: f64,
        j: &mut impl Entries,
    ) -> Result<(), Fault> {
        let n = self.layout.coordinates;
        self.stand(t, y, yp);
        self.apply_loads(&[]);
        self.apply_rubbing();
        for k in 0..n {
            j.add(k, k, cj);
            j.add(k, n + k, -1.0);
            j.add(n + k, n + k, cj);
        }
        for k in 0..self.now.z.len() {
            j.add(2 * n + k, 2 * n + k, cj);
        }
        for clearance in 0..self.modes.len() {
            self.contact_entries(clearance, j);
        }
        self.load_entries(j);
        self.rubbing_entries(j);
        self.constraint_entries(cj, j);
        Ok(())
    }
}

impl Mechanism<f64> {
    /// −M⁻¹ ∂Q/∂(q, v, z) and −∂f/∂(q, v, z) of one contact.
    fn contact_entries(&self, k: usize, j: &mut impl Entries) {
        let (Some(touch), Mode::Contact(contact)) = (&self.now.touches[k], &self.modes[k]) else {
            return;
        };
        let law = &self.model.clearances()[k];
        let n = self.layout.coordinates;
        let (gap, rates, force) = (&touch.gap, &touch.rates, &touch.force);
        let places = &self.inner_places[k];
        let first = 2 * n + places.start;
        let bends = law.inner_rates(contact, rates, inner_states(&self.now.z, places));
        let bends = &bends[..places.len()];
        for inner in 0..bends.len() {
            let at = first + inner;
            let slopes = law.inner_slopes(gap, rates, force, inner);
            self.subtract(law.pair.i, at, &slopes.bearing, j);
            self.subtract(law.pair.j, at, &slopes.journal, j);
            for (row, rate) in bends.iter().enumerate() {
                j.add(first + row, at, -rate.d_inner[inner]);
            }
        }
        for (of_journal, body) in [(false, law.pair.i), (true, law.pair.j)] {
            let Some(at) = self.place_in_q(body) else { continue };
            for c in 0..3 {
                let motions = &self.now.motions;
                let by_q = law.coordinate_slopes(gap, rates, motions, of_journal, c);
                let slopes = law.force_slopes(gap, rates, force, &by_q);
                self.subtract(law.pair.i, at + c, &slopes.bearing, j);
                self.subtract(law.pair.j, at + c, &slopes.journal, j);
                let by_v = law.velocity_slopes(gap, rates, of_journal, c);
                let slopes = law.force_slopes(gap, rates, force, &by_v);
                self.subtract(law.pair.i, n + at + c, &slopes.bearing, j);
                self.subtract(law.pair.j, n + at + c, &slopes.journal, j);
                for (row, rate) in bends.iter().enumerate() {
                    j.add(first + row, at + c, -(rate.d_slip * by_q.slip));
                    j.add(first + row, n + at + c, -(rate.d_slip * by_v.slip));
                }
            }
        }
    }

    /// −M⁻¹ ∂Q/∂(q, v, z) and −∂f/∂(q, v, z) of the loads.
    fn load_entries(&self, j: &mut impl Entries) {
        let (n, now) = (self.layout.coordinates, &self.now);
        for (load, place) in self.model.loads().iter().zip(&self.load_places) {
            let Some(bodies) = load.bodies() else { continue };
            let inner = place.map_or(0.0, |place| now.z[place]);
            let row = place.map(|place| 2 * n + place);
            if let Some(row) = row {
                let (by_z, rate) = load.inner_slopes(now.time, &now.poses, &now.motions, inner);
                for (on, by_z) in bodies.into_iter().zip(&by_z) {
                    self.subtract(on, row, by_z, j);
                }
                j.add(row, row, -rate);
            }
            for (side, body) in bodies.into_iter().enumerate() {
                let Some(at) = self.place_in_q(body) else { continue };
                for c in 0..3 {
                    let place = (side, c);
                    let both = load.slopes(now.time, &now.poses, &now.motions, inner, place);
                    for ((slopes, rate), column) in both.iter().zip([at + c, n + at + c]) {
                        for (on, slopes) in bodies.into_iter().zip(slopes) {
                            self.subtract(on, column, slopes, j);
                        }
                        if let Some(row) = row {
                            j.add(row, column, -rate);
                        }
                    }
                }
            }
        }
    }

    /// Subtracts M⁻¹ of a change of a body's wrench in one column.
    pub(super) fn subtract(
        &self,
        body: usize,
        column: usize,
        change: &Wrench<f64>,
        j: &mut impl Entries,
    ) {
        let Some(at) = self.place_in_q(body) else { return };
        let row = self.layout.coordinates + at;
        let by = &self.inverse_masses[at..at + 3];
        j.add(row, column, -(by[0] * change.force.x));
        j.add(row + 1, column, -(by[1] * change.force.y));
        j.add(row + 2, column, -(by[2] * change.moment));
    }

    /// M⁻¹ Φ_qᵀ, M⁻¹ ∂(Φ_qᵀ λ)/∂q, c_j Φ_q and ∂Φ̈/∂(q, v).
    fn constraint_entries(&self, cj: f64, j: &mut impl Entries) {
        let n = self.layout.coordinates;
        let now = &self.now;
        for row in &self.layout.constraints {
            let constraint = &row.constraint;
            let bodies = constraint.bodies().map(|body| self.place_in_q(body));
            let place = |(side, c): (usize, usize)| Some(bodies[side]? + c);
            constraint.bend(&now.poses, &now.lambda[row.range()], |of, by, entry| {
                let (Some(of), Some(by)) = (place(of), place(by)) else { return };
                j.add(n + of, by, self.inverse_masses[of] * entry);
            });
            let first = 2 * n + now.z.len() + row.first;
            for (r, blocks) in now.jacobian[row.range()].iter().enumerate() {
                let equation = first + r;
                for (at, block) in bodies.into_iter().zip(blocks) {
                    let Some(at) = at else { continue };
                    for (c, entry) in block.iter().enumerate() {
                        j.add(n + at + c, equation, self.inverse_masses[at + c] * entry);
                        j.add(equation, n + at + c, cj * entry);
                    }
                }
            }
            let (poses, motions, accelerations) = (&now.poses, &now.motions, &now.accelerations);
            constraint.acceleration_slopes(poses, motions, accelerations, |r, by, [q, v]| {
                let (equation, Some(by)) = (first + r, place(by)) else { return };
                j.add(equation, by, q);
                j.add(equation, n + by, v);
            });
        }
        let first = 2 * n + now.z.len();
        for (row, column, entry) in now.idle.entries() {
            j.add(first + row, first + column, -entry);
        }
    }
}
