//! How many digits two observations of a mechanism share.
//! ```text
//! digits = −log10( largest |difference| / scale )
//! ```
//! over the state (angles, angular rates, velocities of mass centres, clearance vectors), over
//! the forces, or over the torques.

use super::Scales;
use crate::mechanism::Observation;

/// Something for each part of an observation that errors are measured over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts<T> {
    /// Of angles, rates, velocities, clearance vectors.
    pub state: T,
    /// Of forces in joints.
    pub forces: T,
    /// Of torques of drives.
    pub torque: T,
}

impl<T: Copy> Parts<T> {
    /// The same for each part.
    pub fn all(value: T) -> Self {
        Parts { state: value, forces: value, torque: value }
    }
    /// The same function of each part of two.
    pub fn zip<U, V>(self, other: Parts<U>, of: impl Fn(T, U) -> V) -> Parts<V> {
        Parts {
            state: of(self.state, other.state),
            forces: of(self.forces, other.forces),
            torque: of(self.torque, other.torque),
        }
    }

    /// The same function of each part.
    pub fn map<V>(self, of: impl Fn(T) -> V) -> Parts<V> {
        Parts { state: of(self.state), forces: of(self.forces), torque: of(self.torque) }
    }
}

impl Scales {
    /// Worst scaled differences of two observations, as far as their doubles and remainders
    /// tell. What is not a number differs without bound.
    pub fn differences(&self, a: &Observation, b: &Observation) -> Parts<f64> {
        let mut state = Worst::default();
        for (place, (of_a, of_b)) in a.bodies.iter().zip(&b.bodies).enumerate() {
            let at = |c: usize| beyond(a, 6 * place + c) - beyond(b, 6 * place + c);
            state.take((of_a.angle - of_b.angle) + at(2), self.angle);
            for c in 0..2 {
                state.take((of_a.velocity[c] - of_b.velocity[c]) + at(3 + c), self.velocity);
            }
            let turning = (of_a.angular_velocity - of_b.angular_velocity) + at(5);
            state.take(turning, self.angular_velocity);
        }
        let first = 6 * a.bodies.len();
        for (k, (of_a, of_b)) in a.clearances.iter().zip(&b.clearances).enumerate() {
            for c in 0..2 {
                let at = first + 2 * k + c;
                let more = beyond(a, at) - beyond(b, at);
                state.take((of_a.offset[c] - of_b.offset[c]) + more, self.clearances[k]);
            }
        }
        let mut forces = Worst::default();
        for (of_a, of_b) in a.joints.iter().zip(&b.joints) {
            for c in 0..2 {
                forces.take(of_a.force[c] - of_b.force[c], self.force);
            }
        }
        for (of_a, of_b) in a.clearances.iter().zip(&b.clearances) {
            forces.take(of_a.normal_force - of_b.normal_force, self.force);
            forces.take(of_a.tangential_force - of_b.tangential_force, self.force);
        }
        let mut torque = Worst::default();
        for (of_a, of_b) in a.drive_torques.iter().zip(&b.drive_torques) {
            torque.take(of_a - of_b, self.torque);
        }
        Parts { state: state.0, forces: forces.0, torque: torque.0 }
    }

    /// The largest, scaled, that an observation knows of its state beyond its doubles.
    pub fn beyond(&self, observation: &Observation) -> f64 {
        let doubles = Observation { beyond: Vec::new(), ..observation.clone() };
        self.differences(observation, &doubles).state
    }

    /// What an observation loses, scaled, when only its doubles are kept.
    pub fn rounding(&self, observation: &Observation) -> Parts<f64> {
        let state = self.beyond(observation);
        let ulp = |x: f64| (x.abs().next_up() - x.abs()) / 2.0;
        let mut forces = Worst::default();
        for joint in &observation.joints {
            joint.force.iter().for_each(|force| forces.take(ulp(*force), self.force));
        }
        for clearance in &observation.clearances {
            forces.take(ulp(clearance.normal_force), self.force);
            forces.take(ulp(clearance.tangential_force), self.force);
        }
        let mut torque = Worst::default();
        observation.drive_torques.iter().for_each(|drive| torque.take(ulp(*drive), self.torque));
        Parts { state, forces: forces.0, torque: torque.0 }
    }
}

fn beyond(observation: &Observation, at: usize) -> f64 {
    observation.beyond.get(at).copied().unwrap_or(0.0)
}

/// The largest of scaled differences; infinite once one is not a number.
#[derive(Default)]
struct Worst(f64);

impl Worst {
    fn take(&mut self, difference: f64, scale: f64) {
        let scaled = difference.abs() / scale;
        self.0 = if scaled.is_nan() { f64::INFINITY } else { self.0.max(scaled) };
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Sizes, digits};
    use super::*;
    use crate::mechanism::{BodyObservation, ClearanceObservation};

    fn turned(angle: f64, beyond: f64) -> Observation {
        let body = BodyObservation { angle, ..BodyObservation::default() };
        let beyond = vec![0.0, 0.0, beyond, 0.0, 0.0, 0.0];
        Observation { bodies: vec![body], beyond, ..Observation::default() }
    }

    fn scales() -> Scales {
        let sizes = Sizes { mass: 1.0, length: 1.0, rate: 1.0, clearances: Vec::new() };
        Scales::of(&[turned(1.0, 0.0)], &sizes)
    }

    #[test]
    fn differences_see_beyond_double_precision() {
        let parts = scales().differences(&turned(1.0, 3e-25), &turned(1.0, 1e-25));
        assert!((parts.state - 2e-25).abs() < 1e-39);
    }

    #[test]
    fn what_is_not_a_number_agrees_with_nothing() {
        let parts = scales().differences(&turned(f64::NAN, 0.0), &turned(f64::NAN, 0.0));
        assert_eq!(digits(parts.state), f64::NEG_INFINITY);
    }

    #[test]
    fn rounding_is_what_lies_beyond_the_doubles() {
        assert_eq!(scales().rounding(&turned(1.0, 4e-17)).state, 4e-17);
    }

    #[test]
    fn the_force_of_a_contact_is_rounded_too() {
        let clearance = ClearanceObservation { normal_force: 3.0, ..Default::default() };
        let pressed = Observation { clearances: vec![clearance], ..turned(1.0, 0.0) };
        let scales = Scales { clearances: vec![1e-3], ..scales() };
        assert_eq!(scales.rounding(&pressed).forces, f64::EPSILON / scales.force);
    }
}
