//! Distance: a massless link of fixed length between two points.
//! ```text
//! Φ = |(r_j + A_j s_j) − (r_i + A_i s_i)| − L = 0   (m)
//! ```
//! Its multiplier (N) is the tension of the link.

use super::{BETWEEN, Ends, Holonomic, MOST_BODIES, MOST_ROWS, Pair, between};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::Pose;
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "distance",
    title: "two points stay a length apart, as on a massless link",
    example: r#"[joints.strut]
kind = "distance"
between = ["a.P", "b.Q"]
length = 0.1"#,
    keys: &[
        BETWEEN,
        Key::new("length", Takes::Number(Range::Positive), "m", "distance of the two points"),
    ],
    ..Kind::PLAIN
};

/// The link: its ends and its length (m).
#[derive(Debug, Clone, Copy)]
pub struct Distance<S> {
    pair: Pair<S>,
    length: S,
}

impl<S: Scalar> Holonomic<S> for Distance<S> {
    const ROWS: usize = 1;

    fn new(values: &Values, ends: &Ends<S>) -> Self {
        Distance { pair: ends.pair, length: values.number("length") }
    }

    fn error<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        let length = between(&self.pair, poses).norm();
        [length - T::lift(self.length), T::zero(), T::zero()]
    }
}
