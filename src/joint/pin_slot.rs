//! Pin in a slot: the second point slides on a line through the first, and its body turns freely.
//! ```text
//! Φ = u × d = 0   (m),   d and u as in the prismatic joint
//! ```

use super::prismatic::AXIS;
use super::{BETWEEN, Ends, Holonomic, MOST_BODIES, MOST_ROWS, Pair, between, unit};
use crate::parameter::{Kind, Values};
use crate::plane::{Pose, Vector};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "pin-slot",
    title: "the second point slides on a line through the first, its body free to turn",
    example: r#"[joints.slot]
kind = "pin-slot"
between = ["lever.O", "crank.A"]
axis = [1.0, 0.0]"#,
    keys: &[BETWEEN, AXIS],
    ..Kind::PLAIN
};

/// The slot: its points and the axis u in the frame of body `i`.
#[derive(Debug, Clone, Copy)]
pub struct PinSlot<S> {
    pair: Pair<S>,
    axis: Vector<S>,
}

impl<S: Scalar> PinSlot<S> {
    /// Across the slot, in the first body's frame: the axis turned by +90°.
    pub fn across(&self) -> Vector<S> {
        self.axis.turned()
    }
}

impl<S: Scalar> Holonomic<S> for PinSlot<S> {
    const ROWS: usize = 1;

    fn new(values: &Values, ends: &Ends<S>) -> Self {
        PinSlot { pair: ends.pair, axis: unit(values.vector("axis")) }
    }

    fn error<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        let axis = poses[0].carry(self.axis);
        [axis.cross(between(&self.pair, poses)), T::zero(), T::zero()]
    }
}
