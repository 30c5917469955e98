//! Gravity: a uniform field.
//! ```text
//! F = m g,   V = −m g·(r − r₀)
//! ```

use super::{Acts, Ends};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "gravity",
    title: "a uniform field of gravity",
    example: r#"[loads.gravity]
kind = "gravity"
acceleration = [0.0, -9.81]"#,
    keys: &[Key::new("acceleration", Takes::Vector(Range::Any), "m/s²", "acceleration of free fall, fixed frame")],
    ..Kind::PLAIN
};

/// Acceleration of free fall g (m/s²), fixed frame, and where potential energy is zero (m).
#[derive(Debug, Clone, Copy)]
pub struct Gravity<S> {
    acceleration: Vector<S>,
    datum: Vector<S>,
}

impl<S: Scalar> Gravity<S> {
    /// The field that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let [x, y] = values.vector("acceleration");
        Gravity { acceleration: Vector::new(x, y), datum: ends.datum }
    }
}

impl<S: Scalar> Acts<S> for Gravity<S> {
    fn wrenches<T: Lift<S>>(
        &self,
        _: S,
        _: &[Pose<T>; 2],
        _: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2] {
        [Wrench::none(); 2]
    }

    fn field(&self) -> Option<(Vector<S>, Vector<S>)> {
        Some((self.acceleration, self.datum))
    }

    fn pace(&self, _: f64, length: f64) -> f64 {
        (self.acceleration.norm().to_f64() / length).sqrt()
    }
}
