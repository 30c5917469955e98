//! Rack and pinion: what is between them follows the angle of the pinion on the rack.
//! ```text
//! Φ = u · d − x₀ − r (θ_j − θ_i) = 0   (m),   d and u as in the prismatic joint
//! ```
//! with the rack i, the pinion j, its radius r and the travel x₀ of its centre where the angle is zero.
//! It holds one freedom: what keeps the pinion's centre at its distance is another joint. With a
//! positive radius the centre goes along u where the pinion turns counter-clockwise on the rack; a
//! wheel that rolls on top of a rack has a negative one.

use super::prismatic::AXIS;
use super::{BETWEEN, Ends, Holonomic, MOST_BODIES, MOST_ROWS, Pair, between, unit};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Pose, Vector};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "rack",
    title: "a pinion's centre travels along a rack as the pinion turns on it",
    example: r#"[joints.teeth]
kind = "rack"
between = ["rack.P", "pinion.C"]
axis = [1.0, 0.0]
radius = -0.02"#,
    keys: &[
        BETWEEN,
        AXIS,
        Key::new("radius", Takes::Number(Range::NotZero), "m", "travel of the second point along the axis over the angle of the second body \
                    relative to the first"),
        Key::new("travel", Takes::Number(Range::Any), "m", "travel where that angle is zero").or("0.0"),
    ],
    ..Kind::PLAIN
};

/// The rack: its points, the axis u in the frame of body `i`, radius and travel (m).
#[derive(Debug, Clone, Copy)]
pub struct Rack<S> {
    pair: Pair<S>,
    axis: Vector<S>,
    radius: S,
    travel: S,
}

impl<S: Scalar> Holonomic<S> for Rack<S> {
    const ROWS: usize = 1;

    fn new(values: &Values, ends: &Ends<S>) -> Self {
        Rack {
            pair: ends.pair,
            axis: unit(values.vector("axis")),
            radius: values.number("radius"),
            travel: values.number("travel"),
        }
    }

    fn error<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        let [i, j, _] = poses;
        let travel = i.carry(self.axis).dot(between(&self.pair, poses));
        let rolled = T::lift(self.travel) + T::lift(self.radius) * (j.angle - i.angle);
        [travel - rolled, T::zero(), T::zero()]
    }
}
