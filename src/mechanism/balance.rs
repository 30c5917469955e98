//! Forces on the bodies, accelerations and multipliers, and what the drives must do.

use super::layout::{Coupling, FreeBody, Hinge};
use super::{Mechanism, Touch, inner_states};
use crate::clearance::Mode;
use crate::dae::{Fault, State};
use crate::linear::Singular;
use crate::load::Powers;
use crate::model::Owner;
use crate::plane::{Motion, Vector, Wrench};
use crate::scalar::Scalar;

impl<S: Scalar> Mechanism<S> {
    /// Loads and contact forces on every body, as placed. `roots` are those that an engine
    /// carries, by event function.
    #[inline(always)]
    pub(super) fn apply_loads(&mut self, roots: &[Option<S>]) {
        let now = &mut self.now;
        now.wrenches.fill(Wrench::none());
        now.relaxation = 0.0;
        for (load, place) in self.model.loads().iter().zip(&self.load_places) {
            let (time, poses, motions) = (now.time, &now.poses, &now.motions);
            match *place {
                None => {
                    load.apply(time, self.model.masses(), poses, motions, &mut now.wrenches);
                }
                Some(place) => {
                    let (inner, wrenches) = (now.z[place], &mut now.wrenches);
                    now.z_dot[place] =
                        load.apply_remembering(time, poses, motions, inner, wrenches);
                }
            }
        }
        for (k, clearance) in self.model.clearances().iter().enumerate() {
            let places = self.inner_places[k].clone();
            let Mode::Contact(contact) = &self.modes[k] else {
                now.touches[k] = None;
                now.z_dot[places].fill(S::zero());
                continue;
            };
            let mut gap = now.gap(k, clearance);
            let rates = clearance.rates(&gap, &now.motions);
            let root = roots.get(self.depth_slots[k]).copied().flatten();
            let root = root.map(|sigma| sigma * self.radial_roots[k]);
            if let Some(root) = root {
                gap.depth = clearance.normal.depth_from_root(root);
            }
            let inner = inner_states(&now.z, &places);
            if !places.is_empty() {
                let all = clearance.inner_rates(contact, &rates, inner);
                for (which, place) in places.enumerate() {
                    let rate = &all[which];
                    now.z_dot[place] = rate.value;
                    now.relaxation = now.relaxation.max(-rate.d_inner[which].to_f64());
                }
            }
            let force = clearance.force(contact, &gap, &rates, inner, root);
            let [bearing, journal] = clearance.wrenches(&gap, &force);
            now.wrenches[clearance.pair.i] += bearing;
            now.wrenches[clearance.pair.j] += journal;
            now.touches[k] = Some(Touch { gap, rates, force });
        }
    }

    /// Accelerations of the free bodies that the wrenches on them give (paper, eq. 14).
    #[inline(always)]
    pub(super) fn accelerate(&mut self) {
        let now = &mut self.now;
        for &FreeBody { body, mass, inertia, .. } in &self.layout.free {
            let Wrench { force, moment } = now.wrenches[body];
            now.accelerations[body] = Motion { linear: force * mass, angular: moment * inertia };
        }
    }

    /// Solves for accelerations and multipliers:
    /// ```text
    /// (Φ_q M⁻¹ Φ_qᵀ) λ = Φ̈(M⁻¹ Q),   v̇ = M⁻¹ (Q − Φ_qᵀ λ)
    /// ```
    /// Friction in joints is part of Q, and depends on λ.
    pub(super) fn solve(&mut self) -> Result<(), Fault> {
        if !self.rubbings.is_empty() {
            self.find_rubbing();
        }
        self.accelerate();
        if self.layout.rows > 0 {
            self.factor().map_err(|singular| self.singular(singular))?;
            let now = &mut self.now;
            for (row, arms) in self.layout.constraints.iter().zip(&now.arms) {
                let (motions, accelerations) = (&now.motions, &now.accelerations);
                let error = &mut now.lambda[row.range()];
                row.constraint.acceleration_error(
                    now.time,
                    arms,
                    &now.poses,
                    motions,
                    accelerations,
                    error,
                );
            }
            self.now.matrix.solve(&mut self.now.lambda);
            if !self.rubbings.is_empty() {
                self.rub()?;
            }
            self.apply_multipliers();
            self.accelerate();
        }
        let now = &mut self.now;
        for (FreeBody { body, .. }, v_dot) in
            self.layout.free.iter().zip(now.v_dot.as_chunks_mut().0)
        {
            let Motion { linear, angular } = now.accelerations[*body];
            *v_dot = [linear.x, linear.y, angular];
        }
        Ok(())
    }

    /// Stands at a state whose accelerations and multipliers are known, as if evaluated there: at a
    /// singular position no equation tells them.
    pub fn stand_with(&mut self, state: State<'_, S>, accelerations: &[S], multipliers: &[S]) {
        self.place(&state);
        self.now.z.copy_from_slice(state.z);
        self.apply_loads(&[]);
        self.reach();
        self.now.lambda.copy_from_slice(multipliers);
        self.apply_multipliers();
        self.know(accelerations);
        self.drive();
        self.measure_powers();
    }

    /// Stands at a state with these accelerations, and with forces as they were last evaluated beside it.
    pub fn stand_on(&mut self, state: State<'_, S>, accelerations: &[S]) {
        self.place(&state);
        self.know(accelerations);
    }

    fn know(&mut self, accelerations: &[S]) {
        self.now.v_dot.copy_from_slice(accelerations);
        let known = accelerations.as_chunks().0;
        for (FreeBody { body, .. }, [x, y, angular]) in self.layout.free.iter().zip(known) {
            let linear = Vector::new(*x, *y);
            self.now.accelerations[*body] = Motion { linear, angular: *angular };
        }
    }

    /// Finds the arms of the joints and Φ_q, as placed.
    pub(super) fn reach(&mut self) {
        self.find_arms();
        self.find_slopes();
    }

    #[inline(always)]
    fn find_arms(&mut self) {
        let now = &mut self.now;
        for (row, arms) in self.layout.constraints.iter().zip(&mut now.arms) {
            *arms = row.constraint.arms(&now.poses);
        }
    }

    fn find_slopes(&mut self) {
        let now = &mut self.now;
        for (row, arms) in self.layout.constraints.iter().zip(&now.arms) {
            row.constraint.slopes(&now.poses, arms, &mut now.jacobian[row.range()]);
        }
    }

    /// Adds what the joints put on the bodies.
    #[inline(always)]
    pub(super) fn apply_multipliers(&mut self) {
        let now = &mut self.now;
        for (row, arms) in self.layout.constraints.iter().zip(&now.arms) {
            let (slopes, lambda) = (&now.jacobian[row.range()], &now.lambda[row.range()]);
            row.constraint.act(arms, slopes, lambda, &mut now.wrenches);
        }
    }

    /// Forms and factors Φ_q M⁻¹ Φ_qᵀ at the poses as placed.
    pub(super) fn factor(&mut self) -> Result<(), Singular> {
        self.couple();
        if self.redundant > 0 {
            self.support()?;
        }
        self.now.matrix.factor()
    }

    /// Forms Φ_q M⁻¹ Φ_qᵀ at the poses as placed.
    pub(super) fn couple(&mut self) {
        self.find_arms();
        // revolute joints need no more than arms
        if !(self.layout.couplings.is_empty() && self.rubbings.is_empty()) {
            self.find_slopes();
        }
        let now = &mut self.now;
        let entries = now.matrix.entries_mut();
        entries.fill(S::zero());
        for hinge in &self.layout.hinges {
            let Hinge { constraints: [of, with], sides, mobility: [mass, inertia], .. } = *hinge;
            let [first, second] = hinge.entries;
            let (a, b) = (now.arms[of][sides[0]], now.arms[with][sides[1]]);
            entries[first[0]] = entries[first[0]] + mass + a.y * b.y * inertia;
            entries[second[0]] += -(a.x * b.y * inertia);
            if of != with {
                entries[first[1]] += -(a.y * b.x * inertia);
            }
            entries[second[1]] = entries[second[1]] + mass + a.x * b.x * inertia;
        }
        for coupling in &self.layout.couplings {
            let Coupling { row, column, sides, at, entry } = *coupling;
            let (a, b) = (&now.jacobian[row][sides[0]], &now.jacobian[column][sides[1]]);
            let along = (a[0] * b[0] + a[1] * b[1]) * self.inverse_masses[at];
            let turning = a[2] * b[2] * self.inverse_masses[at + 2];
            entries[entry] = entries[entry] + along + turning;
        }
    }

    /// The joint or drive whose constraints depend most on the others at a state, and the share of
    /// their mass–constraint matrix that the others leave; `None` without constraints.
    pub fn weakest_joint(&mut self, state: State<'_, S>) -> Option<(Owner, f64)> {
        self.place(&state);
        self.couple();
        if self.redundant > 0
            && let Err(Singular { row }) = self.support()
        {
            return Some((self.layout.owner(row), 0.0));
        }
        let whole: Vec<f64> = self.now.matrix.diagonal().collect();
        let (row, left) = match self.now.matrix.factor() {
            Err(Singular { row }) => (row, 0.0),
            Ok(()) => {
                let left = self.now.matrix.pivots().zip(whole).map(|(pivot, whole)| pivot / whole);
                left.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?
            }
        };
        Some((self.layout.owner(row), left))
    }

    /// Force and torque that make each driven body move as prescribed, by Newton and Euler from
    /// the last body of each chain to the ground. Consumes the wrenches on the driven bodies.
    pub(super) fn drive(&mut self) {
        for index in (0..self.layout.driven.len()).rev() {
            let driven = self.layout.driven[index];
            let pair = self.model.joints()[driven.joint].ends.pair;
            let (s_base, s_own) =
                if driven.second { (pair.s_i, pair.s_j) } else { (pair.s_j, pair.s_i) };
            let now = &mut self.now;
            let (a, wrench) = (now.accelerations[driven.body], now.wrenches[driven.body]);
            let mass = self.model.masses()[driven.body];
            let inertia = self.model.inertias()[driven.body];
            let force: Vector<S> = a.linear * mass - wrench.force;
            let arm = now.poses[driven.body].rotate(s_own);
            let torque = inertia * a.angular - wrench.moment - arm.cross(force);
            let mut reaction = Wrench::at(now.poses[driven.base].rotate(s_base), -force);
            reaction.moment -= torque;
            now.wrenches[driven.base] += reaction;
            // of that torque friction in the joint does its part, and the drive the rest
            let rubbing = self.rubbing_on_driven(index, driven.second, force);
            self.now.driving[index] = (force, torque - rubbing);
        }
    }

    /// Torque of a drive (N m) on the second body of its joint, at the state last evaluated.
    pub(super) fn drive_torque(&self, drive: usize) -> S {
        let driven = self.layout.driven.iter().position(|driven| driven.drive == drive);
        if let Some(index) = driven {
            let torque = self.now.driving[index].1;
            return if self.layout.driven[index].second { torque } else { -torque };
        }
        let constraint =
            self.layout.constraints.iter().find(|row| row.owner == Owner::Drive(drive));
        constraint.map_or(S::zero(), |row| -self.now.lambda[row.first])
    }

    /// Powers of the drives, of the dissipation in each clearance and of the loads (W).
    pub(super) fn measure_powers(&mut self) {
        let mut driving = S::zero();
        for (index, drive) in self.model.drives().iter().enumerate() {
            driving += self.drive_torque(index) * drive.course.rate(self.now.time);
        }
        self.now.powers[self.ledger.drives()] = driving;
        for (k, touch) in self.now.touches.iter().enumerate() {
            self.now.powers[self.ledger.clearance(k)] = touch.as_ref().map_or(S::zero(), |touch| {
                let force = &touch.force;
                (force.normal.value - force.normal.elastic) * touch.rates.rate
                    - force.tangential * touch.rates.slip
            });
        }
        if let Some([work, dissipation]) = self.ledger.loads() {
            let now = &mut self.now;
            let none = Powers { work: S::zero(), dissipation: S::zero() };
            let loads = self.model.loads().iter().zip(&self.load_places);
            let sum = loads.fold(none, |sum, (load, place)| {
                let inner = place.map(|place| now.z[place]);
                let powers = load.powers(now.time, &now.poses, &now.motions, inner);
                Powers {
                    work: sum.work + powers.work,
                    dissipation: sum.dissipation + powers.dissipation,
                }
            });
            let rubbing = self.rubbing_power();
            let powers = &mut self.now.powers;
            (powers[work], powers[dissipation]) = (sum.work, sum.dissipation + rubbing);
        }
    }
}
