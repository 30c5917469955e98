//! Spring and damper between two points.
//! ```text
//! x = L − L₀,   F = k x + k₃ x³ + d ẋ   (N, pulls the points together)
//! V = ½ k x² + ¼ k₃ x⁴,   dissipated d ẋ²
//! ```
//! Where the points coincide there is no direction, and no force.

use super::{Acts, Ends, Powers};
use crate::joint::Pair;
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "spring",
    title: "a spring and damper between two points",
    example: r#"[loads.spring]
kind = "spring"
between = ["ground.C", "rocker.D"]
stiffness = 4530.0
free_length = 0.07785"#,
    keys: &[
        Key::new("between", Takes::Points, "", "its two points"),
        Key::new("stiffness", Takes::Number(Range::Any), "N/m", "k"),
        Key::new("free_length", Takes::Number(Range::NotNegative), "m", "L₀, the length at which it does not pull"),
        Key::new("damping", Takes::Number(Range::NotNegative), "N s/m", "d").or("0.0"),
        Key::new("cubic", Takes::Number(Range::Any), "N/m³", "k₃").or("0.0"),
    ],
    ..Kind::PLAIN
};

/// The spring.
#[derive(Debug, Clone, Copy)]
pub struct Spring<S> {
    pair: Pair<S>,
    stiffness: S,
    free_length: S,
    damping: S,
    cubic: S,
}

/// How a spring stands: arms to its points and its direction from the first to the second (fixed
/// frame), its extension x (m) and the rate of that (m/s).
struct Stretch<T> {
    arms: [Vector<T>; 2],
    along: Vector<T>,
    extension: T,
    rate: T,
}

impl<S: Scalar> Spring<S> {
    /// The spring that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        Spring {
            pair: ends.pair,
            stiffness: values.number("stiffness"),
            free_length: values.number("free_length"),
            damping: values.number("damping"),
            cubic: values.number("cubic"),
        }
    }

    fn stretch<T: Lift<S>>(
        &self,
        poses: &[Pose<T>; 2],
        motions: &[Motion<T>; 2],
    ) -> Option<Stretch<T>> {
        let arms = [poses[0].carry(self.pair.s_i), poses[1].carry(self.pair.s_j)];
        let apart = poses[1].position + arms[1] - poses[0].position - arms[0];
        let length = apart.norm();
        if length == T::zero() {
            return None;
        }
        let along = apart * (T::one() / length);
        let rate = along.dot(motions[1].at(arms[1]) - motions[0].at(arms[0]));
        Some(Stretch { arms, along, extension: length - T::lift(self.free_length), rate })
    }
}

impl<S: Scalar> Acts<S> for Spring<S> {
    fn wrenches<T: Lift<S>>(
        &self,
        _: S,
        poses: &[Pose<T>; 2],
        motions: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2] {
        let Some(Stretch { arms, along, extension: x, rate }) = self.stretch(poses, motions)
        else {
            return [Wrench::none(); 2];
        };
        let (k, cubic) = (T::lift(self.stiffness), T::lift(self.cubic));
        let pull = (k + cubic * x * x) * x + T::lift(self.damping) * rate;
        [Wrench::at(arms[0], along * pull), Wrench::at(arms[1], -along * pull)]
    }

    fn potential_energy(&self, poses: &[Pose<S>; 2]) -> S {
        let stretch = self.stretch(poses, &[Motion::rest(); 2]);
        let x = stretch.map_or(-self.free_length, |stretch| stretch.extension);
        let square = x * x;
        (self.stiffness * S::ratio(1, 2) + self.cubic * square * S::ratio(1, 4)) * square
    }

    fn powers(&self, _: S, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> Powers<S> {
        let rate = self.stretch(poses, motions).map_or(S::zero(), |stretch| stretch.rate);
        Powers { work: S::zero(), dissipation: self.damping * rate * rate }
    }

    fn pace(&self, mass: f64, length: f64) -> f64 {
        let stiffest = self.stiffness.to_f64().abs()
            + 3.0 * self.cubic.to_f64().abs() * length * length;
        (stiffest / mass).sqrt()
    }
}
