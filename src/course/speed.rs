//! Constant speed.
//! ```text
//! f(t) = f₀ + Ω t,   Ω = 2π/60 · speed_rpm, or a velocity
//! ```

use super::{ANGLE, Ends, Law, POSITION, Rate, SPEED_RPM, VELOCITY, turn};
use crate::parameter::{Kind, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "speed",
    title: "goes at a constant speed",
    example: r#"[drives.crank]
joint = "A0"
speed_rpm = 5000.0"#,
    keys: &[SPEED_RPM, ANGLE, VELOCITY, POSITION],
    ..Kind::PLAIN
};

/// Value at t = 0 (rad, m) and speed.
#[derive(Debug, Clone, Copy)]
pub struct Speed<S> {
    start: S,
    speed: Rate<S>,
}

impl<S: Scalar> Speed<S> {
    /// The course that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        let (speed, start) = Rate::and_start(values);
        Speed { start, speed }
    }
}

impl<S: Scalar> Law<S> for Speed<S> {
    #[inline(always)]
    fn at(&self, time: S) -> [S; 3] {
        [self.start + self.speed.rate * time, self.speed.rate, S::zero()]
    }

    #[inline(always)]
    fn wrapped(&self, time: S) -> S {
        self.start + self.speed.phase(time)
    }

    fn accelerates(&self) -> bool {
        false
    }

    fn fastest(&self) -> f64 {
        self.speed.rate.to_f64().abs()
    }

    fn period(&self) -> Option<f64> {
        turn(self.speed.rate.to_f64())
    }
}
