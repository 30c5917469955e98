//! The mechanism as every engine sees it.

use super::{Mechanism, inner_states};
use crate::clearance::{Bodies, Clearance, EventSlot, Gap, Mode};
use crate::contact::Penetration;
use crate::dae::{Course, Fault, State, System, Watch};
use crate::halt::{self, Halted};
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
        let joint = self.layout.owner(row).key(self.model.names()).to_string();
        Fault::Fatal(Box::new(SingularPosition { joint, time: self.now.time.to_f64() }))
    }
}

/// Rounding of the event function of a load's place, in units of the arithmetic's.
const GATE_ROUNDINGS: f64 = 1e3;

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

    fn inner_states(&self) -> usize {
        self.inner_scales.len()
    }

    fn inner_scales(&self) -> &[f64] {
        &self.inner_scales
    }

    fn evaluate(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        self.evaluate_with_roots(state, &[])
    }

    fn evaluate_with_roots(
        &mut self,
        state: State<'_, S>,
        roots: &[Option<S>],
    ) -> Result<(), Fault> {
        if halt::is_asked() {
            return Err(Fault::Fatal(Box::new(Halted)));
        }
        self.place(&state);
        self.now.z.copy_from_slice(state.z);
        self.apply_loads(roots);
        self.solve()?;
        self.drive();
        self.measure_powers();
        Ok(())
    }

    fn accelerations(&self) -> &[S] {
        &self.now.v_dot
    }

    fn inner_rates(&self) -> &[S] {
        &self.now.z_dot
    }

    fn inner_relaxation(&self) -> f64 {
        self.now.relaxation
    }

    fn lambda(&self) -> &[S] {
        &self.now.lambda
    }

    fn powers(&self) -> &[S] {
        &self.now.powers
    }

    fn powers_run_free(&self) -> bool {
        let cut = |(mode, clearance): (&Mode<S>, &Clearance<S>)| match mode {
            Mode::Contact(contact) => contact.pulling && clearance.cut_tension,
            Mode::Flight => false,
        };
        self.modes.iter().zip(self.model.clearances()).any(cut)
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
            let inner = inner_states(state.z, &self.inner_places[k]);
            let rates = || clearance.rates(&gap, motions);
            while let Some((_, slot)) = self.slots.get(at).filter(|(owner, _)| *owner == k) {
                values[at] = clearance.event_value(&self.modes[k], *slot, &gap, inner, rates);
                at += 1;
            }
        }
        for (slot, value) in values[at..].iter_mut().enumerate() {
            *value = self.gate(slot).map_or(S::one(), |(value, _, _)| value);
        }
        Ok(())
    }

    fn event_rate(&self, slot: usize) -> S {
        let Some((k, what)) = self.slot(slot) else {
            let gate = self.gate(slot - self.slots.len());
            return gate.map_or(S::zero(), |(_, rate, _)| rate);
        };
        let clearance = &self.model.clearances()[k];
        let now = &self.now;
        if let (EventSlot::Depth, Some(touch)) = (what, &now.touches[k]) {
            return clearance.depth_event_rate(&touch.rates);
        }
        let (gap, rates) = match &now.touches[k] {
            Some(touch) => (touch.gap, touch.rates),
            None => {
                let gap = now.gap(k, clearance);
                (gap, clearance.rates(&gap, &now.motions))
            }
        };
        let second = match what {
            EventSlot::Depth => (S::zero(), S::zero()),
            _ => clearance.second_rates(&gap, &rates, &now.motions, &now.accelerations),
        };
        let inner = inner_states(&now.z, &self.inner_places[k]);
        clearance.event_rate(&self.modes[k], what, &gap, inner, &rates, second)
    }

    fn course(&self, slot: usize) -> Course {
        let Some((k, what)) = self.slot(slot) else {
            let Some((value, rate, grain)) = self.gate(slot - self.slots.len()) else {
                return Course::NONE;
            };
            let [value, rate, grain] = [value, rate, grain].map(S::to_f64);
            let noise = S::EPSILON * (GATE_ROUNDINGS + 4.0 * grain);
            return Course { value, rate, grain, noise, ..Course::NONE };
        };
        let now = &self.now;
        let clearance = &self.model.clearances()[k];
        let gap = match &now.touches[k] {
            Some(touch) => touch.gap,
            None => now.gap(k, clearance),
        };
        let bodies =
            Bodies { poses: &now.poses, motions: &now.motions, accelerations: &now.accelerations };
        let inner = inner_states(&now.z, &self.inner_places[k]);
        clearance.course(&self.modes[k], what, &gap, inner, bodies, !now.offsets.is_empty())
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

    fn turn_rates(&self, time: S, v: &[S], rates: &mut [S]) {
        self.angular_rates(time, v, rates);
    }

    fn offsets(&self) -> usize {
        self.modes.len()
    }

    fn offsets_at(&mut self, state: State<'_, S>, offsets: &mut [Vector<S>]) {
        self.place(&state);
        for (k, offset) in offsets.iter_mut().enumerate() {
            let gap = self.now.gap(k, &self.model.clearances()[k]);
            let centred = self.is_nearly_centred(k, &gap);
            *offset = match centred {
                true => Vector::zero(),
                false => self.model.clearances()[k].carried(&gap),
            };
        }
    }

    fn offset_rates(&self, rates: &mut [Vector<S>]) {
        let now = &self.now;
        for ((k, clearance), rate) in self.model.clearances().iter().enumerate().zip(rates) {
            *rate = match &now.touches[k] {
                Some(touch) => clearance.carried_rate(&touch.gap),
                None => clearance.carried_rate(&now.gap(k, clearance)),
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

    /// Square of the angular frequency (1/s²) that contact `clearance` swings with at most where it
    /// is this deep (m): ∂F_N/∂δ (1/m + r²/I), summed over both bodies as if nothing else held them.
    pub fn swing_squared(&self, clearance: usize, depth: f64) -> f64 {
        let law = &self.model.clearances()[clearance];
        let pressed = Penetration {
            depth: S::from_f64(depth),
            rate: S::zero(),
            inverse_impact_rate: S::zero(),
        };
        let slope = law.normal.force(pressed).d_depth.to_f64();
        let [along, _] = match self.mobilities[clearance] {
            Some(mobility) => mobility,
            None => self.mobility_before_wall(law, &self.now.gap(clearance, law)),
        };
        slope * along
    }

    /// Penetration rate and slip velocity (m/s) of a clearance at the state last evaluated; zero
    /// where the centres coincide.
    pub fn gap_rates(&self, clearance: usize) -> (S, S) {
        let law = &self.model.clearances()[clearance];
        let gap = self.now.gap(clearance, law);
        if law.is_centred(&gap) {
            return (S::zero(), S::zero());
        }
        let rates = law.rates(&gap, &self.now.motions);
        (rates.rate, rates.slip)
    }

    /// Offset of a journal (m), as placed. A difference that is nothing but rounding is that of a
    /// centred journal.
    pub(super) fn offset(&self, clearance: usize) -> Vector<S> {
        let gap = self.now.gap(clearance, &self.model.clearances()[clearance]);
        if self.is_nearly_centred(clearance, &gap) { Vector::zero() } else { gap.offset }
    }

    /// Whether an offset, as placed, is nothing but rounding.
    fn is_nearly_centred(&self, clearance: usize, gap: &Gap<S>) -> bool {
        let rounding = 2.0 * S::EPSILON * self.gap_size(clearance, gap);
        gap.eccentricity.abs().to_f64() <= rounding && !S::CARRIES_DERIVATIVE
    }

    /// Sum of the lengths that an offset is a difference of (m).
    pub(super) fn gap_size(&self, clearance: usize, gap: &Gap<S>) -> f64 {
        let law = &self.model.clearances()[clearance];
        let [at_i, at_j] = [law.pair.i, law.pair.j].map(|body| self.now.poses[body].position);
        let sum =
            [at_i, at_j, gap.arm_i, gap.arm_j].into_iter().map(|x| x.norm().to_f64()).sum::<f64>();
        sum + law.wall.map_or(0.0, |wall| (law.pair.s_i.norm() + wall.nominal.abs()).to_f64())
    }

    /// The bodies with unknowns, and their places in q and v.
    pub(super) fn free_bodies(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.layout.free.iter().map(|free| (free.body, free.at))
    }
}
