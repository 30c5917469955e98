//! Prismatic: the second point slides along a line through the first, without relative rotation.
//! ```text
//! d = (r_j + A_j s_j) − (r_i + A_i s_i),   u = the axis, turning with body i
//! Φ = [u × d,  θ_j − θ_i − α] = 0   (m, rad);   travel u · d
//! ```

use super::{BETWEEN, Ends, Holonomic, MOST_BODIES, MOST_ROWS, Pair, between, unit};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::{Lift, Scalar};

/// The key of the line that a point slides on.
pub(super) const AXIS: Key = Key::new("axis", Takes::Vector(Range::Positive), "", "direction of the line, in the first body's frame");

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "prismatic",
    title: "the second point slides on a line through the first, without relative rotation",
    example: r#"[joints.slide]
kind = "prismatic"
between = ["ground.O", "slider.C"]
axis = [1.0, 0.0]"#,
    keys: &[
        BETWEEN,
        AXIS,
        Key::new("angle", Takes::Number(Range::Any), "rad", "angle of the second body relative to the first").or("0.0"),
    ],
    ..Kind::PLAIN
};

/// The slide: its points, the axis u in the frame of body `i`, and the angle (rad) of the second
/// body relative to the first.
#[derive(Debug, Clone, Copy)]
pub struct Prismatic<S> {
    pair: Pair<S>,
    axis: Vector<S>,
    angle: S,
}

impl<S: Scalar> Prismatic<S> {
    /// Rate (m/s) of the travel on the line: how fast the second body slides on the first.
    pub fn rate<T: Lift<S>>(&self, poses: &[Pose<T>; 2], motions: &[Motion<T>; 2]) -> T {
        let [arm_i, arm_j] = self.arms(poses);
        let along = poses[0].carry(self.axis);
        along.dot(motions[1].at(arm_j) - motions[0].at(arm_i))
    }

    /// What a force (N) along the axis puts on first and second body, at the second's point.
    pub fn pushed<T: Lift<S>>(&self, force: T, poses: &[Pose<T>; 2]) -> [Wrench<T>; 2] {
        let [arm_i, arm_j] = self.arms(poses);
        let force = poses[0].carry(self.axis) * force;
        [Wrench::at(arm_i, -force), Wrench::at(arm_j, force)]
    }

    /// From both mass centres to the second point (m).
    fn arms<T: Lift<S>>(&self, poses: &[Pose<T>; 2]) -> [Vector<T>; 2] {
        let arm = poses[1].carry(self.pair.s_j);
        [poses[1].position + arm - poses[0].position, arm]
    }

    /// Across the guide's line, in the first body's frame: the axis turned by +90°.
    pub fn across(&self) -> Vector<S> {
        self.axis.turned()
    }

    /// A place (m) of the second body, along and across the axis from its point, in its own frame.
    pub fn on_the_block(&self, place: Vector<S>) -> Vector<S> {
        let aligned = Pose::new(Vector::zero(), -self.angle);
        aligned.rotate(self.axis * place.x + self.axis.turned() * place.y)
    }

    /// Travel u · d (m) of the second point along the line, from the first.
    pub fn travel<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> T {
        poses[0].carry(self.axis).dot(between(&self.pair, poses))
    }
}

impl<S: Scalar> Holonomic<S> for Prismatic<S> {
    const ROWS: usize = 2;
    const ANGLES: [bool; MOST_ROWS] = [false, true, false];

    fn new(values: &Values, ends: &Ends<S>) -> Self {
        let axis = unit(values.vector("axis"));
        Prismatic { pair: ends.pair, axis, angle: values.number("angle") }
    }

    fn error<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        let [i, j, _] = poses;
        let across = i.carry(self.axis).cross(between(&self.pair, poses));
        [across, j.angle - i.angle - T::lift(self.angle), T::zero()]
    }
}
