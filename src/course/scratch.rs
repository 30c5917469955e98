//! A course of one's own: from rest, ever faster.
//! ```text
//! f(t) = ½ α t²
//! ```

use super::{Ends, Law};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "run-up",
    title: "goes ever faster, from rest",
    example: r#"[drives.d]
kind = "run-up"
joint = "O"
acceleration = 40.0"#,
    keys: &[Key::new("acceleration", Takes::Number(Range::Any), "rad/s²", "α")],
    ..Kind::PLAIN
};

/// α (rad/s²).
#[derive(Debug, Clone, Copy)]
pub struct Scratch<S>(S);

impl<S: Scalar> Scratch<S> {
    /// The course that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        Scratch(values.number("acceleration"))
    }
}

impl<S: Scalar> Law<S> for Scratch<S> {
    fn at(&self, time: S) -> [S; 3] {
        [S::ratio(1, 2) * self.0 * time * time, self.0 * time, self.0]
    }

    fn fastest(&self) -> f64 {
        // in the first second
        self.0.to_f64().abs()
    }

    fn period(&self) -> Option<f64> {
        None
    }
}
