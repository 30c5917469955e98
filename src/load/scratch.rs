//! A load of one's own: the air resists a point of a body.
//! ```text
//! F = −d v   (N),   dissipated d v²
//! ```

use super::{Acts, Ends, Powers};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "drag",
    title: "the air resists a point of a body",
    example: r#"[loads.air]
kind = "drag"
at = "rod.E"
damping = 0.2"#,
    keys: &[
        Key::new("at", Takes::Point, "", "the point"),
        Key::new("damping", Takes::Number(Range::NotNegative), "N s/m", "d"),
    ],
    ..Kind::PLAIN
};

/// The point, in the frame of its body (m), and d (N s/m).
#[derive(Debug, Clone, Copy)]
pub struct Scratch<S>(Vector<S>, S);

impl<S: Scalar> Scratch<S> {
    /// The load that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        Scratch(ends.pair.s_j, values.number("damping"))
    }
}

impl<S: Scalar> Acts<S> for Scratch<S> {
    fn wrenches<T: Lift<S>>(
        &self,
        _: S,
        poses: &[Pose<T>; 2],
        motions: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2] {
        let arm = poses[1].carry(self.0);
        [Wrench::none(), Wrench::at(arm, motions[1].at(arm) * -T::lift(self.1))]
    }

    fn powers(&self, _: S, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> Powers<S> {
        let v = motions[1].at(poses[1].rotate(self.0));
        Powers { work: S::zero(), dissipation: self.1 * v.dot(v) }
    }

    fn pace(&self, mass: f64, _: f64) -> f64 {
        self.1.to_f64() / mass
    }
}
