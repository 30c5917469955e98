//! Fixed: two bodies are one.
//! ```text
//! Φ = [(r_j + A_j s_j) − (r_i + A_i s_i),  θ_j − θ_i − α] = 0   (m, m, rad)
//! ```

use super::{BETWEEN, Ends, Holonomic, MOST_BODIES, MOST_ROWS, Pair, between};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::Pose;
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "fixed",
    title: "two points stay together and their bodies do not turn against each other",
    example: r#"[joints.weld]
kind = "fixed"
between = ["a.P", "b.Q"]
angle = 0.5"#,
    keys: &[
        BETWEEN,
        Key::new("angle", Takes::Number(Range::Any), "rad", "angle of the second body relative to the first").or("0.0"),
    ],
    ..Kind::PLAIN
};

/// The weld: its points and the angle (rad) of the second body relative to the first.
#[derive(Debug, Clone, Copy)]
pub struct Fixed<S> {
    pair: Pair<S>,
    angle: S,
}

impl<S: Scalar> Holonomic<S> for Fixed<S> {
    const ROWS: usize = 3;
    const ANGLES: [bool; MOST_ROWS] = [false, false, true];

    fn new(values: &Values, ends: &Ends<S>) -> Self {
        Fixed { pair: ends.pair, angle: values.number("angle") }
    }

    fn error<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        let gap = between(&self.pair, poses);
        let [i, j, _] = poses;
        [gap.x, gap.y, j.angle - i.angle - T::lift(self.angle)]
    }
}
