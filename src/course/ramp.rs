//! Ramp: from rest to a speed, smoothly, and on at that speed.
//! ```text
//! ḟ(t) = Ω x³ (10 − 15 x + 6 x²),   x = t/T,   until t = T;   ḟ = Ω from then on
//! f(t) = f₀ + Ω T x⁴ (5/2 − 3 x + x²)
//! ```
//! Speed, acceleration and its rate are continuous; at T the engines begin anew.

use super::{ANGLE, Ends, Law, POSITION, Rate, SPEED_RPM, VELOCITY, turn};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "ramp",
    title: "goes from rest to a speed in a time, smoothly",
    example: r#"[drives.crank]
joint = "A0"
kind = "ramp"
speed_rpm = 5000.0
time = 0.05"#,
    keys: &[
        SPEED_RPM,
        ANGLE,
        VELOCITY,
        POSITION,
        Key::new("time", Takes::Number(Range::Positive), "s", "time from rest to the speed"),
    ],
    ..Kind::PLAIN
};

/// Value at t = 0 (rad, m), last speed and the time (s) to it.
#[derive(Debug, Clone, Copy)]
pub struct Ramp<S> {
    start: S,
    speed: Rate<S>,
    time: S,
}

impl<S: Scalar> Ramp<S> {
    /// The course that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        let (speed, start) = Rate::and_start(values);
        Ramp { start, speed, time: values.number("time") }
    }
}

impl<S: Scalar> Law<S> for Ramp<S> {
    fn at(&self, time: S) -> [S; 3] {
        let (speed, span) = (self.speed.rate, self.time);
        if time >= span {
            return [self.start + speed * (time - span * S::ratio(1, 2)), speed, S::zero()];
        }
        let n = S::from_f64;
        let x = time / span;
        let square = x * x;
        let gone = square * square * (S::ratio(5, 2) - n(3.0) * x + square);
        let rate = square * x * (n(10.0) - n(15.0) * x + n(6.0) * square);
        let bend = n(30.0) * square * (S::one() - x) * (S::one() - x);
        [self.start + speed * span * gone, speed * rate, speed * bend / span]
    }

    fn fastest(&self) -> f64 {
        self.speed.rate.to_f64().abs()
    }

    fn period(&self) -> Option<f64> {
        None
    }

    fn all(&self) -> Option<f64> {
        turn(self.speed.rate.to_f64()).map(|turn| self.time.to_f64() + turn)
    }

    fn corners(&self) -> &[S] {
        std::slice::from_ref(&self.time)
    }
}
