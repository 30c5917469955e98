//! A joint of one's own: two bodies do not turn against each other.
//! ```text
//! Φ = θ_j − θ_i − α = 0   (rad)
//! ```

use super::{BETWEEN, Ends, Holonomic, MOST_BODIES, MOST_ROWS};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::Pose;
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "parallel",
    title: "two bodies do not turn against each other",
    example: r#"[joints.p]
kind = "parallel"
between = ["a.P", "b.Q"]"#,
    keys: &[
        BETWEEN,
        Key::new("angle", Takes::Number(Range::Any), "rad", "angle of the second body relative to the first").or("0.0"),
    ],
    ..Kind::PLAIN
};

/// The angle (rad).
#[derive(Debug, Clone, Copy)]
pub struct Scratch<S>(S);

impl<S: Scalar> Holonomic<S> for Scratch<S> {
    const ROWS: usize = 1;
    const ANGLES: [bool; MOST_ROWS] = [true, false, false];

    fn new(values: &Values, _: &Ends<S>) -> Self {
        Scratch(values.number("angle"))
    }

    fn error<T: Lift<S>>(&self, [i, j, _]: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        [j.angle - i.angle - T::lift(self.0), T::zero(), T::zero()]
    }
}
