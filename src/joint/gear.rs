//! Gear pair: a wheel turns with a pinion, both on one carrier.
//! ```text
//! Φ = (θ_j − θ_c) − ρ (θ_i − θ_c) − α = 0   (rad)
//! ```
//! with pinion i, wheel j, carrier c and the ratio ρ, negative for teeth outside.

use super::{Ends, Holonomic, MOST_BODIES, MOST_ROWS};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::Pose;
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "gear",
    title: "a wheel turns with a pinion by a ratio, as seen from their carrier",
    example: r#"[joints.mesh]
kind = "gear"
between = ["pinion", "wheel"]
ratio = -0.4"#,
    keys: &[
        Key::new("between", Takes::Bodies, "", "the pinion and the wheel"),
        Key::new("carrier", Takes::Body, "", "the body that both turn on").or("\"ground\""),
        Key::new("ratio", Takes::Number(Range::NotZero), "", "angle of the wheel over that of the pinion; negative for teeth outside"),
        Key::new("angle", Takes::Number(Range::Any), "rad", "angle of the wheel on the carrier where the pinion's is zero").or("0.0"),
    ],
    ..Kind::PLAIN
};

/// The pair: ratio and angle (rad).
#[derive(Debug, Clone, Copy)]
pub struct Gear<S> {
    ratio: S,
    angle: S,
}

impl<S: Scalar> Holonomic<S> for Gear<S> {
    const ROWS: usize = 1;
    const ANGLES: [bool; MOST_ROWS] = [true, false, false];

    fn new(values: &Values, _: &Ends<S>) -> Self {
        Gear { ratio: values.number("ratio"), angle: values.number("angle") }
    }

    fn error<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        let [pinion, wheel, carrier] = poses.each_ref().map(|pose| pose.angle);
        let turned = T::lift(self.ratio) * (pinion - carrier) + T::lift(self.angle);
        [wheel - carrier - turned, T::zero(), T::zero()]
    }
}
