//! Force at a point of a body, in a direction of the fixed frame or of the body's.
//! ```text
//! F = the force given, or f(t) along a direction;   power F · v of the point
//! ```

use super::{Acts, Ends, Powers, lift};
use crate::course::Course;
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "force",
    title: "a force at a point of a body",
    source: "",
    example: r#"[loads.push]
kind = "force"
at = "slider.C"
force = [0.0, -1.0]"#,
    keys: &[
        Key::new("at", Takes::Point, "", "the point"),
        Key::new("force", Takes::Vector(Range::Any), "N", "the force, where it does not change").optional(),
        Key::new("direction", Takes::Vector(Range::Positive), "", "in place of `force`, with `magnitude`: its direction, of any length").optional(),
        Key::new("magnitude", Takes::Course, "N", "the force along the direction").optional(),
        Key::new("frame", Takes::Word(&["fixed", "body"]), "", "the frame that the force is written in").or("\"fixed\""),
    ],
    also: Some(one_of_two),
};

/// A force, or a direction and a magnitude.
fn one_of_two(values: &Values) -> Vec<(&'static str, String)> {
    let there = |key| values.get(key).is_some();
    let (key, message) = match (there("force"), there("direction"), there("magnitude")) {
        (true, false, false) | (false, true, true) => return Vec::new(),
        (true, true, _) => ("direction", "is not used where `force` is given"),
        (true, false, true) => ("magnitude", "is not used where `force` is given"),
        (false, true, false) => ("magnitude", "is missing beside `direction` (N)"),
        (false, false, true) => ("direction", "is missing beside `magnitude`"),
        (false, false, false) => ("force", "is missing (N)"),
    };
    vec![(key, message.to_owned())]
}

/// The force: its point on the second body, a direction, and the magnitude along it (N).
#[derive(Debug, Clone)]
pub struct Force<S> {
    at: Vector<S>,
    direction: Vector<S>,
    magnitude: Course<S>,
    turns_along: bool,
}

impl<S: Scalar> Force<S> {
    /// The force that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let whole = values.get("force").is_some();
        let [x, y] = values.vector(if whole { "force" } else { "direction" });
        let along = Vector::new(x, y);
        Force {
            at: ends.pair.s_j,
            direction: if whole { along } else { along * (S::one() / along.norm()) },
            magnitude: match whole {
                true => Course::constant(S::one()),
                false => Course::of_key(values, "magnitude").ahead(ends.clock),
            },
            turns_along: values.text("frame") == "body",
        }
    }

    /// Force (N) and arm (m) on the second body, fixed frame.
    fn on<T: Lift<S>>(&self, time: S, pose: &Pose<T>) -> (Vector<T>, Vector<T>) {
        let along = lift(self.direction);
        let along = if self.turns_along { pose.rotate(along) } else { along };
        (along * T::lift(self.magnitude.at(time)[0]), pose.carry(self.at))
    }
}

impl<S: Scalar> Acts<S> for Force<S> {
    fn wrenches<T: Lift<S>>(
        &self,
        time: S,
        poses: &[Pose<T>; 2],
        _: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2] {
        let (force, arm) = self.on(time, &poses[1]);
        [Wrench::none(), Wrench::at(arm, force)]
    }

    fn powers(&self, time: S, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> Powers<S> {
        let (force, arm) = self.on(time, &poses[1]);
        Powers { work: force.dot(motions[1].at(arm)), dissipation: S::zero() }
    }

    fn course(&self) -> Option<&Course<S>> {
        Some(&self.magnitude)
    }

    fn pace(&self, mass: f64, length: f64) -> f64 {
        let force = self.magnitude.size() * self.direction.norm().to_f64();
        (force / (mass * length)).sqrt()
    }
}
