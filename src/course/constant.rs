//! Constant: f(t) = value. A plain number in a case stands for it.

use super::{Ends, Law};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "constant",
    title: "does not change; a number stands for it",
    example: r#"[loads.motor]
kind = "torque"
body = "crank"
torque = { kind = "constant", value = 0.5 }   # or torque = 0.5"#,
    keys: &[Key::new("value", Takes::Number(Range::Any), "", "the value")],
    ..Kind::PLAIN
};

/// The value.
#[derive(Debug, Clone, Copy)]
pub struct Constant<S>(S);

impl<S: Scalar> Constant<S> {
    /// The constant that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        Constant(values.number("value"))
    }
}

impl<S> Constant<S> {
    /// The constant of this value.
    pub(super) fn always(value: S) -> Self {
        Constant(value)
    }
}

impl<S: Scalar> Law<S> for Constant<S> {
    fn at(&self, _: S) -> [S; 3] {
        [self.0, S::zero(), S::zero()]
    }

    fn accelerates(&self) -> bool {
        false
    }

    fn fastest(&self) -> f64 {
        0.0
    }

    fn period(&self) -> Option<f64> {
        None
    }
}
