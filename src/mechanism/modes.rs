//! The modes that a start begins in.
//!
//! A joint with δ > 0, or δ = 0 and δ̇ > 0, begins in contact, one with δ < 0, or δ = 0 and
//! δ̇ < 0, in flight. What is no larger than the rounding of the coordinates and velocities it is
//! a difference of counts as zero. Where both are zero the journal rests on the wall, and a short
//! flight tells: the first change of δ that is more than rounding. If that is outward the joint
//! begins in contact, whatever the order of the derivative behind it (a disc beside its bearing's
//! centre, released under gravity: δ = g² t⁴/8c); if it is inward, or if there is none, in flight.
//! A joint that the model says to be in contact is, with the rate at which that began.

use super::layout::Role;
use super::{Mechanism, inner_states};
use crate::clearance::{Gap, Mode};
use crate::dae::{Fault, State, System};
use crate::scalar::Scalar;

/// Units of rounding that coordinates and velocities may be off by.
const ROUNDING: f64 = 8.0;
/// Change of δ, in units of what it may be off by, that is more than rounding.
const CLEAR: f64 = 4.0;
/// Steps of the fourth-order method in one flight.
const FLIGHT_STEPS: usize = 16;
/// Flights, each four times as long as the one before.
const MOST_FLIGHTS: usize = 150;
/// A flight is short while no body turns further than this (rad), or moves further than this over
/// the mechanism's length.
const SHORT: f64 = 0.1;

/// A journal on the wall whose mode is open.
struct Resting {
    clearance: usize,
    /// Whether the flight leads outward, once it is known.
    outward: Option<bool>,
}

impl<S: Scalar> Mechanism<S> {
    /// Begins contacts at the start.
    pub(super) fn choose_start_modes(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        self.place(&state);
        let mut resting = Vec::new();
        for k in 0..self.modes.len() {
            let law = &self.model.clearances()[k];
            let gap = self.now.gap(k, law);
            let (place, pace) = self.rounding(k, &gap);
            if self.model.contacts()[k].is_some() && !law.is_centred(&gap) {
                self.begin_contact(k);
                continue;
            }
            if gap.depth.to_f64() < -place || law.is_centred(&gap) {
                continue;
            }
            let rate = law.rates(&gap, &self.now.motions).rate.to_f64();
            if gap.depth.to_f64() > place || rate > pace {
                self.begin_contact(k);
            } else if rate >= -pace {
                resting.push(Resting { clearance: k, outward: None });
            }
        }
        self.settle_resting(state, resting)?;
        self.choose_branches(state)?;
        self.watch();
        Ok(())
    }

    /// Chooses the branches of friction of the contacts at the start once more, now that the
    /// accelerations with these contacts can be known.
    fn choose_branches(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        if self.model.clearances().iter().all(|law| law.friction.is_none()) {
            return Ok(());
        }
        self.evaluate(state)?;
        let now = &self.now;
        let clearances = self.model.clearances().iter().zip(self.model.contacts());
        let places = self.inner_places.iter();
        let clearances = clearances.zip(places);
        for ((((law, given), places), mode), touch) in
            clearances.zip(&mut self.modes).zip(&now.touches)
        {
            let (Mode::Contact(contact), Some(touch)) = (mode, touch) else { continue };
            let (gap, rates) = (&touch.gap, &touch.rates);
            let (_, acceleration) = law.second_rates(gap, rates, &now.motions, &now.accelerations);
            let began = contact.impact_rate;
            let rate = if given.is_some() { rates.rate } else { began };
            *contact = law.begun_at(began, gap.depth, rate, rates.slip, acceleration);
            law.recall(contact, rates.slip, inner_states(&now.z, places));
        }
        Ok(())
    }

    /// What rounding may make of δ (m) and δ̇ (m/s), as placed.
    fn rounding(&self, clearance: usize, gap: &Gap<S>) -> (f64, f64) {
        let law = &self.model.clearances()[clearance];
        let unit = ROUNDING * S::EPSILON;
        let place = unit * (self.gap_size(clearance, gap) + law.radial.to_f64());
        let speed = |body: usize, arm: crate::plane::Vector<S>| {
            let motion = &self.now.motions[body];
            motion.linear.norm().to_f64() + (motion.angular.abs() * arm.norm()).to_f64()
        };
        let speeds = speed(law.pair.i, gap.arm_i) + speed(law.pair.j, gap.arm_j);
        // the normal turns by the rounding of the offset
        let turned = match law.wall {
            None => place / gap.eccentricity.to_f64(),
            Some(_) => unit,
        };
        (place, unit * speeds + turned * gap.offset_rate.norm().to_f64())
    }

    /// Begins the contact of a clearance, as placed.
    fn begin_contact(&mut self, k: usize) {
        let law = &self.model.clearances()[k];
        let gap = self.now.gap(k, law);
        let rates = law.rates(&gap, &self.now.motions);
        let began = self.model.contacts()[k].unwrap_or(rates.rate);
        let contact = law.begun_at(began, gap.depth, rates.rate, rates.slip, S::zero());
        self.modes[k] = Mode::Contact(contact);
    }

    /// Begins the contacts of journals that rest on the wall and would go outward. The force of
    /// one may bring others to go outward too.
    fn settle_resting(
        &mut self,
        state: State<'_, S>,
        mut resting: Vec<Resting>,
    ) -> Result<(), Fault> {
        while !resting.is_empty() {
            self.look_ahead(state, &mut resting)?;
            let (outward, open): (Vec<_>, Vec<_>) =
                resting.into_iter().partition(|resting| resting.outward == Some(true));
            if outward.is_empty() {
                break;
            }
            self.place(&state);
            for Resting { clearance: k, .. } in outward {
                let law = &self.model.clearances()[k];
                let gap = self.now.gap(k, law);
                let rates = law.rates(&gap, &self.now.motions);
                let rate = rates.rate.max(S::zero());
                self.modes[k] = Mode::Contact(law.begin(gap.depth, rate, rates.slip, S::zero()));
            }
            resting = open;
            resting.iter_mut().for_each(|resting| resting.outward = None);
        }
        Ok(())
    }

    /// Finds out where resting journals go in the present modes.
    fn look_ahead(&mut self, state: State<'_, S>, resting: &mut [Resting]) -> Result<(), Fault> {
        self.evaluate(state)?;
        let depth = |of: &Self, k: usize| of.now.gap(k, &of.model.clearances()[k]).depth;
        let before: Vec<S> = resting.iter().map(|resting| depth(self, resting.clearance)).collect();
        let Some(mut span) = self.first_span(resting) else { return Ok(()) };
        for _ in 0..MOST_FLIGHTS {
            let (q, v) = self.fly(state, span)?;
            self.place(&State { time: state.time + span, q: &q, v: &v, z: &[], carried: None });
            for (resting, before) in resting.iter_mut().zip(&before) {
                let k = resting.clearance;
                let gap = self.now.gap(k, &self.model.clearances()[k]);
                let change = (gap.depth - *before).to_f64();
                if resting.outward.is_none() && change.abs() > CLEAR * self.rounding(k, &gap).0 {
                    resting.outward = Some(change > 0.0);
                }
            }
            let decided = resting.iter().all(|resting| resting.outward.is_some());
            if decided || !self.is_short(state, &q) {
                break;
            }
            span *= S::from_f64(4.0);
        }
        Ok(())
    }

    /// A time (s) in which nothing moves by more than rounding; `None` if nothing moves at all.
    fn first_span(&self, resting: &[Resting]) -> Option<S> {
        let largest = |of: &[crate::plane::Motion<S>]| {
            let sizes = of
                .iter()
                .map(|m| m.linear.norm().to_f64().max(m.angular.abs().to_f64() * self.length));
            sizes.fold(0.0, f64::max)
        };
        let (speed, pull) = (largest(&self.now.motions), largest(&self.now.accelerations));
        let radial = |resting: &Resting| self.model.clearances()[resting.clearance].radial.to_f64();
        let least = resting.iter().map(radial).fold(f64::INFINITY, f64::min);
        let span = (least / speed).min((least / pull).sqrt());
        span.is_finite().then(|| S::from_f64(S::EPSILON.sqrt() * span))
    }

    /// Whether a flight to q has been a short one.
    fn is_short(&self, state: State<'_, S>, q: &[S]) -> bool {
        let driven = self.now.motions.iter().zip(&self.layout.roles);
        let turning = driven.filter(|(_, role)| **role == Role::Driven);
        let span = (self.now.time - state.time).to_f64();
        let turned = turning.map(|(motion, _)| motion.angular.abs().to_f64() * span);
        let moved = q.iter().zip(state.q).zip(&self.coordinate_scales);
        let moved = moved.map(|((to, from), scale)| (*to - *from).abs().to_f64() / scale);
        moved.chain(turned).all(|moved| moved <= SHORT)
    }

    /// Coordinates and velocities after a time, by the classical fourth-order method in the present
    /// modes. Changes are summed apart from what they change.
    fn fly(&mut self, state: State<'_, S>, span: S) -> Result<(Vec<S>, Vec<S>), Fault> {
        let n = state.q.len();
        let start: Vec<S> = state.q.iter().chain(state.v).chain(state.z).copied().collect();
        let mut change = vec![S::zero(); start.len()];
        let step = span * S::from_f64(1.0 / FLIGHT_STEPS as f64);
        for i in 0..FLIGHT_STEPS {
            let begin = state.time + step * S::from_f64(i as f64);
            let mut slope = vec![S::zero(); start.len()];
            let mut sum = slope.clone();
            for (node, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
                let node = step * S::from_f64(node);
                let y: Vec<S> =
                    (0..start.len()).map(|k| start[k] + (change[k] + node * slope[k])).collect();
                let (q, v, z) = (&y[..n], &y[n..2 * n], &y[2 * n..]);
                self.evaluate(State { time: begin + node, q, v, z, carried: None })?;
                slope[..n].copy_from_slice(v);
                slope[n..2 * n].copy_from_slice(&self.now.v_dot);
                slope[2 * n..].copy_from_slice(&self.now.z_dot);
                let weight = S::from_f64(weight);
                sum.iter_mut().zip(&slope).for_each(|(sum, slope)| *sum += weight * *slope);
            }
            let sixth = step * S::ratio(1, 6);
            change.iter_mut().zip(&sum).for_each(|(change, sum)| *change += sixth * *sum);
        }
        let mut end: Vec<S> = start.iter().zip(&change).map(|(x, change)| *x + *change).collect();
        end.truncate(2 * n);
        let v = end.split_off(n);
        Ok((end, v))
    }
}
