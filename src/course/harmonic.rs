//! Harmonic course.
//! ```text
//! f(t) = m + A cos(ω t + φ)
//! ```

use super::{Ends, Law, Rate, turn};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::{Decimal, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "harmonic",
    title: "swings about a mean: mean + amplitude cos(ω t + phase)",
    example: r#"[drives.rocker]
joint = "A0"
kind = "harmonic"
amplitude = 0.2
angular_frequency = 40.0"#,
    keys: &[
        Key::new("mean", Takes::Number(Range::Any), "", "mean value, in the unit of what swings (rad, m, N, N m)").or("0.0"),
        Key::new("amplitude", Takes::Number(Range::Any), "", "amplitude, in the same unit"),
        Key::new("angular_frequency", Takes::Number(Range::Any), "rad/s", "ω"),
        Key::new("phase", Takes::Number(Range::Any), "rad", "phase at t = 0").or("0.0"),
    ],
    ..Kind::PLAIN
};

/// Mean m, amplitude A, angular frequency ω (rad/s) and phase φ (rad).
#[derive(Debug, Clone, Copy)]
pub struct Harmonic<S> {
    mean: S,
    amplitude: S,
    frequency: Rate<S>,
    phase: S,
}

impl<S: Scalar> Harmonic<S> {
    /// The course that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        let frequency = values.decimal("angular_frequency").cloned();
        Harmonic {
            mean: values.number("mean"),
            amplitude: values.number("amplitude"),
            frequency: Rate::of(&frequency.unwrap_or(Decimal::from(f64::NAN))),
            phase: values.number("phase"),
        }
    }
}

impl<S: Scalar> Law<S> for Harmonic<S> {
    fn at(&self, time: S) -> [S; 3] {
        let omega = self.frequency.rate;
        let (sin, cos) = (self.frequency.phase(time) + self.phase).sin_cos();
        let (sin, cos) = (self.amplitude * sin, self.amplitude * cos);
        [self.mean + cos, -omega * sin, -omega * omega * cos]
    }

    fn fastest(&self) -> f64 {
        (self.amplitude * self.frequency.rate).to_f64().abs()
    }

    fn period(&self) -> Option<f64> {
        turn(self.frequency.rate.to_f64())
    }
}
