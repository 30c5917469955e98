//! Torsion spring and damper between two bodies.
//! ```text
//! M = −k (θ_j − θ_i − φ₀) − d (ω_j − ω_i)   (N m, on the second body)
//! ```

use super::{Acts, Ends, Powers, torque_on_second};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Motion, Pose, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "torsion-spring",
    title: "a torsion spring and damper between two bodies",
    example: r#"[loads.coil]
kind = "torsion-spring"
between = ["ground", "wheel"]
stiffness = 40.0"#,
    keys: &[
        Key::new("between", Takes::Bodies, "", "its two bodies"),
        Key::new("stiffness", Takes::Number(Range::Any), "N m/rad", "k"),
        Key::new("free_angle", Takes::Number(Range::Any), "rad", "φ₀, the angle of the second body relative to the first without torque").or("0.0"),
        Key::new("damping", Takes::Number(Range::NotNegative), "N m s", "d").or("0.0"),
    ],
    ..Kind::PLAIN
};

/// The spring.
#[derive(Debug, Clone, Copy)]
pub struct TorsionSpring<S> {
    stiffness: S,
    free_angle: S,
    damping: S,
}

impl<S: Scalar> TorsionSpring<S> {
    /// The spring that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        TorsionSpring {
            stiffness: values.number("stiffness"),
            free_angle: values.number("free_angle"),
            damping: values.number("damping"),
        }
    }
}

impl<S: Scalar> Acts<S> for TorsionSpring<S> {
    fn wrenches<T: Lift<S>>(
        &self,
        _: S,
        [i, j]: &[Pose<T>; 2],
        motions: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2] {
        let twist = j.angle - i.angle - T::lift(self.free_angle);
        let rate = motions[1].angular - motions[0].angular;
        torque_on_second(-(T::lift(self.stiffness) * twist + T::lift(self.damping) * rate))
    }

    fn potential_energy(&self, [i, j]: &[Pose<S>; 2]) -> S {
        let twist = j.angle - i.angle - self.free_angle;
        S::ratio(1, 2) * self.stiffness * twist * twist
    }

    fn powers(&self, _: S, _: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> Powers<S> {
        let rate = motions[1].angular - motions[0].angular;
        Powers { work: S::zero(), dissipation: self.damping * rate * rate }
    }

    fn pace(&self, mass: f64, length: f64) -> f64 {
        (self.stiffness.to_f64().abs() / (mass * length * length)).sqrt()
    }
}
