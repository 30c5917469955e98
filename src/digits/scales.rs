//! What an error is measured with.
//!
//! ```text
//! angles            1 rad
//! angular rates     the largest of any body
//! velocities        the largest speed of any mass centre
//! clearance vectors their radial clearance
//! positions         the largest extent of the path of any mass centre
//! forces            the largest of any joint or clearance
//! torques, moments  the largest
//! points observed   the largest extent of the path of any, the largest speed of any
//! ```
//! None is less than a thousandth of what is characteristic of the mechanism: with its mass m, its
//! length l and its rate ω these are ω, ω l, l, m l ω² and m l² ω². Where a quantity is zero but for
//! rounding, that rounding is not what it is measured with.

use crate::mechanism::{Mechanism, Observation};
use crate::scalar::Scalar;

/// A scale is no smaller than this part of what is characteristic.
const LEAST: f64 = 1e-3;

/// What is characteristic of a mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// Mass of all its bodies (kg).
    pub mass: f64,
    /// Longest arm of a joint, or widest bearing (m).
    pub length: f64,
    /// Fastest drive, or √(g/l), whichever is larger (1/s); zero without either.
    pub rate: f64,
    /// Radial clearances (m).
    pub clearances: Vec<f64>,
}

/// The largest of each quantity that was seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Largest {
    /// Angular rate of any body (rad/s).
    pub angular_velocity: f64,
    /// Speed of any mass centre (m/s).
    pub velocity: f64,
    /// Extent of the path of any mass centre, in x or y (m).
    pub position: f64,
    /// Force of any joint or clearance (N).
    pub force: f64,
    /// Torque of any drive (N m).
    pub torque: f64,
    /// Moment of any joint (N m).
    pub moment: f64,
    /// Extent of the path of any point that is observed, in x or y (m).
    pub point_position: f64,
    /// Speed of any of these (m/s).
    pub point_velocity: f64,
}

/// Sizes that errors are measured by.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales {
    /// Of angles (rad): one.
    pub angle: f64,
    /// Of angular rates (rad/s).
    pub angular_velocity: f64,
    /// Of velocities (m/s).
    pub velocity: f64,
    /// Of clearance vectors (m), by clearance.
    pub clearances: Vec<f64>,
    /// Of positions (m).
    pub position: f64,
    /// Of forces (N).
    pub force: f64,
    /// Of torques (N m).
    pub torque: f64,
    /// Of moments (N m).
    pub moment: f64,
    /// Of positions of points that are observed (m).
    pub point_position: f64,
    /// Of their velocities (m/s).
    pub point_velocity: f64,
}

impl Sizes {
    /// Those of a mechanism.
    pub fn of<S: Scalar>(mechanism: &Mechanism<S>) -> Sizes {
        let model = mechanism.model();
        let length = mechanism.length();
        let mass = model.masses().iter().map(|mass| mass.to_f64()).sum();
        let drives = model.drives().iter().map(|drive| drive.course.fastest());
        let falls = model.loads().iter().map(|load| load.pace(mass, length));
        Sizes {
            mass,
            length,
            rate: drives.chain(falls).fold(0.0, f64::max),
            clearances: model.clearances().iter().map(|c| c.radial.to_f64()).collect(),
        }
    }
}

impl Largest {
    /// The largest in some samples; what is not a number is left out.
    pub fn of(samples: &[Observation]) -> Largest {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let bodies = || samples.iter().flat_map(|sample| &sample.bodies);
        let joints = || samples.iter().flat_map(|sample| &sample.joints);
        let clearances = || samples.iter().flat_map(|sample| &sample.clearances);
        let points = samples.iter().flat_map(|sample| &sample.points);
        let torques = samples.iter().flat_map(|sample| &sample.drive_torques);
        let pressed = clearances().map(|c| c.normal_force.hypot(c.tangential_force));
        let joined = joints().map(|joint| joint.force[0].hypot(joint.force[1]));
        Largest {
            angular_velocity: largest(&mut bodies().map(|body| body.angular_velocity.abs())),
            velocity: largest(&mut bodies().map(|b| b.velocity[0].hypot(b.velocity[1]))),
            position: largest_extent(samples, |sample| {
                sample.bodies.iter().map(|body| body.position).collect()
            }),
            force: largest(&mut joined.chain(pressed)),
            torque: largest(&mut torques.map(|torque| torque.abs())),
            moment: largest(&mut joints().map(|joint| joint.moment.abs())),
            point_position: largest_extent(samples, |sample| {
                sample.points.iter().map(|point| point.position).collect()
            }),
            point_velocity: largest(&mut points.map(|p| p.velocity[0].hypot(p.velocity[1]))),
        }
    }
}

impl Largest {
    /// The larger of each. Extents of two parts of a path do not tell that of both: of the parts
    /// that single samples are, the extent is none.
    pub fn or(&self, other: &Largest) -> Largest {
        Largest {
            angular_velocity: self.angular_velocity.max(other.angular_velocity),
            velocity: self.velocity.max(other.velocity),
            position: self.position.max(other.position),
            force: self.force.max(other.force),
            torque: self.torque.max(other.torque),
            moment: self.moment.max(other.moment),
            point_position: self.point_position.max(other.point_position),
            point_velocity: self.point_velocity.max(other.point_velocity),
        }
    }
}

/// Largest extent of the path of any of some places, in x or y (m).
fn largest_extent(samples: &[Observation], places: impl Fn(&Observation) -> Vec<[f64; 2]>) -> f64 {
    let mut spans: Vec<[(f64, f64); 2]> = Vec::new();
    for sample in samples {
        let places = places(sample);
        spans.resize(places.len(), [(f64::INFINITY, f64::NEG_INFINITY); 2]);
        for (span, place) in spans.iter_mut().zip(places) {
            for ((low, high), x) in span.iter_mut().zip(place) {
                (*low, *high) = (f64::min(*low, x), f64::max(*high, x));
            }
        }
    }
    spans.iter().flatten().map(|(low, high)| high - low).fold(0.0, f64::max)
}

impl Scales {
    /// The scales of a mechanism of this size, in which this was the largest seen.
    pub fn new(sizes: &Sizes, largest: &Largest) -> Scales {
        let Sizes { mass, length, .. } = *sizes;
        let turning = largest.angular_velocity.max(largest.velocity / length);
        let rate = sizes.rate.max(turning);
        let at_least = |largest: f64, characteristic: f64| {
            let scale = largest.max(LEAST * characteristic);
            if scale > 0.0 { scale } else { 1.0 }
        };
        let force = mass * length * rate * rate;
        Scales {
            angle: 1.0,
            angular_velocity: at_least(largest.angular_velocity, rate),
            velocity: at_least(largest.velocity, rate * length),
            clearances: sizes.clearances.clone(),
            position: at_least(largest.position, length),
            force: at_least(largest.force, force),
            torque: at_least(largest.torque, force * length),
            moment: at_least(largest.moment, force * length),
            point_position: at_least(largest.point_position, length),
            point_velocity: at_least(largest.point_velocity, rate * length),
        }
    }

    /// The scales of a trajectory.
    pub fn of(samples: &[Observation], sizes: &Sizes) -> Scales {
        Scales::new(sizes, &Largest::of(samples))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{BodyObservation, JointObservation};

    /// Half a kilogram, 0.1 m, 100/s.
    fn sizes() -> Sizes {
        Sizes { mass: 0.5, length: 0.1, rate: 100.0, clearances: vec![1e-3] }
    }

    #[test]
    fn what_was_seen_is_what_errors_are_measured_with() {
        let body =
            BodyObservation { angular_velocity: -30.0, velocity: [3.0, 4.0], ..Default::default() };
        let joint = JointObservation { force: [-5.0, 12.0], moment: -7.0 };
        let sample = Observation {
            bodies: vec![body],
            joints: vec![joint],
            drive_torques: vec![f64::NAN, -2.0],
            ..Observation::default()
        };
        let scales = Scales::of(&[sample], &sizes());
        assert_eq!((scales.angular_velocity, scales.velocity), (30.0, 5.0));
        assert_eq!((scales.force, scales.torque, scales.moment), (13.0, 2.0, 7.0));
        assert_eq!((scales.angle, &scales.clearances[..]), (1.0, &[1e-3][..]));
    }

    #[test]
    fn rounding_of_what_is_zero_is_no_scale() {
        let noise = Largest { force: 1e-17, torque: 1e-71, velocity: 1e-18, ..Default::default() };
        let scales = Scales::new(&sizes(), &noise);
        let force = 1e-3 * 0.5 * 0.1 * 1e4;
        assert!(
            (scales.force - force).abs() < 1e-15 && (scales.torque - 0.1 * force).abs() < 1e-15
        );
        assert!((scales.velocity - 1e-2).abs() < 1e-17 && scales.angular_velocity == 0.1);
        assert!((scales.position - 1e-4).abs() < 1e-19);
    }

    #[test]
    fn where_nothing_moves_and_nothing_could_scales_are_one() {
        let scales = Scales::new(&Sizes { rate: 0.0, ..sizes() }, &Largest::default());
        assert_eq!(
            [scales.angular_velocity, scales.velocity, scales.force, scales.torque],
            [1.0; 4]
        );
    }
}
