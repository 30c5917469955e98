//! Speed controller of a revolute joint, proportional and integral.
//! ```text
//! e = Ω − (ω_j − ω_i),   ż = e,   u = K_p e + K_i z      (N m)
//! M = u,  or, with a limit L,  M = L tanh(u/L)            on the second body, −M on the first
//! ```
//! z is zero at the start. The limit is smooth, and the integral goes on while it holds: a controller
//! that is asked for more than it can give overshoots.
//!
//! Power M (ω_j − ω_i) counts as work of loads.

use super::{Acts, Ends, torque_on_second};
use crate::joint::REVOLUTE;
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Motion, Pose, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "speed-controller",
    title: "a motor that is controlled to a speed: proportional and integral, with a limit",
    source: "K. J. Åström, R. M. Murray, Feedback Systems, 2nd edition, Princeton 2021, chapter 11",
    example: r#"[loads.servo]
kind = "speed-controller"
joint = "A0"
speed_rpm = 5000.0
proportional = 0.5
integral = 20.0
limit = 50.0"#,
    keys: &[
        Key::new("joint", Takes::Joint(&[REVOLUTE]), "", "the revolute joint whose second body it turns, against the first"),
        Key::new("speed_rpm", Takes::Number(Range::Any), "revolutions a minute", "Ω, the speed asked for"),
        Key::new("proportional", Takes::Number(Range::NotNegative), "N m s", "K_p"),
        Key::new("integral", Takes::Number(Range::NotNegative), "N m", "K_i").or("0.0"),
        Key::new("limit", Takes::Number(Range::Positive), "N m", "L, the largest torque; left out: none").optional(),
    ],
    also: None,
};

/// The controller.
#[derive(Debug, Clone, Copy)]
pub struct SpeedController<S> {
    speed: S,
    proportional: S,
    integral: S,
    limit: Option<S>,
}

impl<S: Scalar> SpeedController<S> {
    /// The controller that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        SpeedController {
            speed: values.number::<S>("speed_rpm") * (S::pi() / S::from_f64(30.0)),
            proportional: values.number("proportional"),
            integral: values.number("integral"),
            limit: values.get("limit").map(|_| values.number("limit")),
        }
    }
}

impl<S: Scalar> Acts<S> for SpeedController<S> {
    /// What it does where it remembers nothing.
    fn wrenches<T: Lift<S>>(
        &self,
        time: S,
        poses: &[Pose<T>; 2],
        motions: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2] {
        self.remembering(time, poses, motions, T::zero()).0
    }

    fn inner_scale(&self) -> Option<f64> {
        let [speed, kp, ki] =
            [self.speed, self.proportional, self.integral].map(|x| x.abs().to_f64());
        let steady = self.limit.map_or(kp * speed, S::to_f64) / ki;
        Some(if steady > 0.0 && steady.is_finite() { steady } else { 1.0 })
    }

    fn remembering<T: Lift<S>>(
        &self,
        _: S,
        _: &[Pose<T>; 2],
        motions: &[Motion<T>; 2],
        inner: T,
    ) -> ([Wrench<T>; 2], T) {
        let off = T::lift(self.speed) - (motions[1].angular - motions[0].angular);
        let wanted = T::lift(self.proportional) * off + T::lift(self.integral) * inner;
        let torque = match self.limit {
            Some(limit) => T::lift(limit) * (wanted / T::lift(limit)).tanh(),
            None => wanted,
        };
        (torque_on_second(torque), off)
    }

    fn pace(&self, mass: f64, length: f64) -> f64 {
        let inertia = mass * length * length;
        let [kp, ki] = [self.proportional, self.integral].map(S::to_f64);
        (kp / inertia).max((ki / inertia).sqrt())
    }
}
