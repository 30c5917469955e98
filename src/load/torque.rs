//! Torque on a body, as a course of time; another body, or the ground, takes the reaction.
//! ```text
//! M = f(t);   power M (ω_j − ω_i)
//! ```

use super::{Acts, Ends, Powers, torque_on_second};
use crate::course::Course;
use crate::parameter::{Key, Kind, Takes, Values};
use crate::plane::{Motion, Pose, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "torque",
    title: "a torque on a body",
    example: r#"[loads.motor]
kind = "torque"
body = "crank"
torque = 0.033"#,
    keys: &[
        Key::new("body", Takes::Body, "", "the body"),
        Key::new("on", Takes::Body, "", "the body that takes the reaction").or("\"ground\""),
        Key::new("torque", Takes::Course, "N m", "the torque, counter-clockwise"),
    ],
    ..Kind::PLAIN
};

/// The torque (N m) on the second body.
#[derive(Debug, Clone)]
pub struct Torque<S>(Course<S>);

impl<S: Scalar> Torque<S> {
    /// The torque that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        Torque(Course::of_key(values, "torque").ahead(ends.clock))
    }
}

impl<S: Scalar> Acts<S> for Torque<S> {
    fn wrenches<T: Lift<S>>(
        &self,
        time: S,
        _: &[Pose<T>; 2],
        _: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2] {
        torque_on_second(T::lift(self.0.at(time)[0]))
    }

    fn powers(&self, time: S, _: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> Powers<S> {
        let [i, j] = motions;
        let work = self.0.at(time)[0] * (j.angular - i.angular);
        Powers { work, dissipation: S::zero() }
    }

    fn course(&self) -> Option<&Course<S>> {
        Some(&self.0)
    }

    fn pace(&self, mass: f64, length: f64) -> f64 {
        (self.0.size() / (mass * length * length)).sqrt()
    }
}
