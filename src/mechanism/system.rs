//! The mechanism as every engine sees it.

use super::Mechanism;
use super::layout::Role;
use crate::clearance::{Bodies, Mode};
use crate::dae::{Course, Fault, State, System, Watch};
use crate::linear::Singular;
use crate::plane::Vector;
use crate::scalar::Scalar;

/// The mechanism cannot be solved where it stands.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the constraints of {joint} depend on the others at t = {time:e} s: the mechanism stands in a \
     singular position (a dead centre)"
)]
pub struct SingularPosition {
    /// Key of the joint.
    pub joint: String,
    /// Time (s).
    pub time: f64,
}

impl<S: Scalar> Mechanism<S> {
    pub(super) fn singular(&self, Singular { row }: Singular) -> Fault {
        if self.now.poses.iter().any(|pose| !pose.cos.is_finite() || !pose.position.x.is_finite()) {
            return Fault::TryShorterStep("a coordinate is not finite".into());
        }
        let joint = self.layout.key(&self.model, row).to_string();
        Fault::Fatal(Box::new(SingularPosition { joint, time: self.now.time.to_f64() }))
    }
}

impl<S: Scalar> System<S> for Mechanism<S> {
    fn coordinates(&self) -> usize {
        self.layout.coordinates
    }

    fn multipliers(&self) -> usize {
        self.layout.rows
    }

    fn integrals(&self) -> usize {
        self.now.powers.len()
    }

    fn scales(&self) -> (&[f64], &[f64]) {
        (&self.coordinate_scales, &self.velocity_scales)
    }

    fn evaluate(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        self.evaluate_with_roots(state, &[])
    }

    fn evaluate_with_roots(
        &mut self,
        state: State<'_, S>,
        roots: &[Option<S>],
    ) -> Result<(), Fault> {
        self.place(&state);
        self.apply_loads(roots);
        self.solve().map_err(|singular| self.singular(singular))?;
        self.drive();
        self.measure_powers();
        Ok(())
    }

    fn accelerations(&self) -> &[S] {
        &self.now.v_dot
    }

    fn lambda(&self) -> &[S] {
        &self.now.lambda
    }

    fn powers(&self) -> &[S] {
        &self.now.powers
    }

    fn watches(&self) -> &[Watch] {
        &self.watches
    }

    fn event_values(&mut self, state: State<'_, S>, values: &mut [S]) -> Result<(), Fault> {
        self.place(&state);
        let motions = &self.now.motions;
        let mut at = 0;
        for (k, clearance) in self.model.clearances().iter().enumerate() {
            let gap = self.now.gap(k, clearance);
            while let Some((_, slot)) = self.slots.get(at).filter(|(owner, _)| *owner == k) {
                values[at] = clearance
                    .event_value(&self.modes[k], *slot, &gap, || clearance.rates(&gap, motions));
                at += 1;
            }
        }
        Ok(())
    }

    fn event_rate(&self, slot: usize) -> S {
        let (k, what) = self.slots[slot];
        let clearance = &self.model.clearances()[k];
        let now = &self.now;
        let (gap, rates) = match &now.touches[k] {
            Some(touch) => (touch.gap, touch.rates),
            None => {
                let gap = now.gap(k, clearance);
                (gap, clearance.rates(&gap, &now.motions))
            }
        };
        let second = match what {
            crate::clearance::EventSlot::Depth => (S::zero(), S::zero()),
            _ => clearance.second_rates(&gap, &rates, &now.motions, &now.accelerations),
        };
        clearance.event_rate(&self.modes[k], what, rates.rate, second)
    }

    fn course(&self, slot: usize) -> Course {
        let (k, what) = self.slots[slot];
        let now = &self.now;
        let clearance = &self.model.clearances()[k];
        let gap = match &now.touches[k] {
            Some(touch) => touch.gap,
            None => now.gap(k, clearance),
        };
        let bodies =
            Bodies { poses: &now.poses, motions: &now.motions, accelerations: &now.accelerations };
        clearance.course(&self.modes[k], what, &gap, bodies, !now.offsets.is_empty())
    }

    fn project(&mut self, time: S, q: &mut [S], v: &mut [S]) -> Result<f64, Fault> {
        self.project_onto_constraints(time, q, v)
    }

    fn turns(&self) -> usize {
        self.layout.roles.len() - 1
    }

    fn turn_angles(&self, time: S, q: &[S], angles: &mut [S]) {
        self.angles(time, q, angles);
    }

    fn turn_rates(&self, _time: S, v: &[S], rates: &mut [S]) {
        self.angular_rates(v, rates);
    }

    fn offsets(&self) -> usize {
        self.modes.len()
    }

    fn offsets_at(&mut self, state: State<'_, S>, offsets: &mut [Vector<S>]) {
        self.place(&state);
        // a difference that is nothing but rounding is that of a centred journal
        let rounding = 4.0 * S::EPSILON * self.length;
        for ((k, clearance), offset) in self.model.clearances().iter().enumerate().zip(offsets) {
            let gap = self.now.gap(k, clearance);
            let centred = gap.eccentricity.to_f64() <= rounding && !S::CARRIES_DERIVATIVE;
            *offset = if centred { Vector::zero() } else { gap.offset };
        }
    }

    fn offset_rates(&self, rates: &mut [Vector<S>]) {
        let now = &self.now;
        for ((k, clearance), rate) in self.model.clearances().iter().enumerate().zip(rates) {
            *rate = match &now.touches[k] {
                Some(touch) => touch.gap.offset_rate,
                None => now.gap(k, clearance).offset_rate,
            };
        }
    }
}

/// Penetration and force of a contact, and their rates, which are zero at true extrema.
#[derive(Debug, Clone, Copy)]
pub struct ContactRates<S> {
    /// Penetration δ (m).
    pub depth: S,
    /// Penetration rate δ̇ (m/s).
    pub rate: S,
    /// Normal force F_N (N).
    pub force: S,
    /// dF_N/dt (N/s).
    pub force_rate: S,
    /// ∂F_N/∂δ (N/m).
    pub slope: S,
}

impl<S: Scalar> Mechanism<S> {
    /// Rates of a contact at the state last evaluated; `None` in flight.
    pub fn contact_rates(&self, clearance: usize) -> Option<ContactRates<S>> {
        let touch = self.now.touches[clearance].as_ref()?;
        let (gap, rates) = (&touch.gap, &touch.rates);
        let (acceleration, _) = self.model.clearances()[clearance].second_rates(
            gap,
            rates,
            &self.now.motions,
            &self.now.accelerations,
        );
        let normal = &touch.force.normal;
        Some(ContactRates {
            depth: gap.depth,
            rate: rates.rate,
            force: normal.value,
            force_rate: normal.d_depth * rates.rate + normal.d_rate * acceleration,
            slope: normal.d_depth,
        })
    }

    /// Penetration rate and slip velocity (m/s) of a clearance at the state last evaluated; zero
    /// where the centres coincide.
    pub fn gap_rates(&self, clearance: usize) -> (S, S) {
        let law = &self.model.clearances()[clearance];
        let gap = self.now.gap(clearance, law);
        if gap.eccentricity == S::zero() {
            return (S::zero(), S::zero());
        }
        let rates = law.rates(&gap, &self.now.motions);
        (rates.rate, rates.slip)
    }

    /// The bodies without unknowns.
    pub(super) fn free_bodies(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.layout.roles.iter().enumerate().filter_map(|(body, role)| match role {
            Role::Free(at) => Some((body, *at)),
            _ => None,
        })
    }

    /// Begins contacts at the start: where δ > 0; where δ = 0 and δ̇ > 0; and where both are zero
    /// and the forces at the start press journal and bearing together, δ̈ > 0.
    pub(super) fn choose_start_modes(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        let zero = S::zero();
        let mut resting = Vec::new();
        self.place(&state);
        for k in 0..self.modes.len() {
            let law = &self.model.clearances()[k];
            let gap = self.now.gap(k, law);
            let rates = law.rates(&gap, &self.now.motions);
            if gap.depth > zero || (gap.depth == zero && rates.rate > zero) {
                self.modes[k] = Mode::Contact(law.begin(rates.rate, rates.slip, zero));
            } else if gap.depth == zero && rates.rate == zero {
                resting.push(k);
            }
        }
        if !resting.is_empty() {
            self.evaluate(state)?;
        }
        for k in resting {
            let (law, now) = (&self.model.clearances()[k], &self.now);
            let gap = now.gap(k, law);
            let rates = law.rates(&gap, &now.motions);
            let (second, _) = law.second_rates(&gap, &rates, &now.motions, &now.accelerations);
            if second > zero {
                self.modes[k] = Mode::Contact(law.begin(rates.rate, rates.slip, zero));
            }
        }
        self.choose_slip_regions(state)?;
        self.watch();
        Ok(())
    }

    /// Chooses the regions of friction of the contacts at the start once more, now that the
    /// accelerations with these contacts can be known.
    fn choose_slip_regions(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        if self.model.clearances().iter().all(|law| law.friction.is_none()) {
            return Ok(());
        }
        self.evaluate(state)?;
        let now = &self.now;
        for ((law, mode), touch) in
            self.model.clearances().iter().zip(&mut self.modes).zip(&now.touches)
        {
            let (Mode::Contact(contact), Some(touch)) = (mode, touch) else { continue };
            let (gap, rates) = (&touch.gap, &touch.rates);
            let (_, acceleration) = law.second_rates(gap, rates, &now.motions, &now.accelerations);
            *contact = law.begin(rates.rate, rates.slip, acceleration);
        }
        Ok(())
    }
}
