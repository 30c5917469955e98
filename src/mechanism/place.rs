//! Poses and motions of every body, from time, coordinates and velocities.

use super::Mechanism;
use super::layout::FreeBody;
use crate::dae::{State, Turn};
use crate::plane::{Motion, Pose, Vector};
use crate::scalar::Scalar;

impl<S: Scalar> Mechanism<S> {
    /// Places every body at a state.
    #[inline(always)]
    pub(super) fn place(&mut self, state: &State<'_, S>) {
        self.now.time = state.time;
        let turns = state.carried.map(|carried| carried.turns);
        let offsets = state.carried.map_or(&[][..], |carried| carried.offsets);
        self.now.offsets.resize(offsets.len(), Vector::zero());
        for (offset, [x, y]) in self.now.offsets.iter_mut().zip(offsets) {
            *offset = Vector::new(*x, *y);
        }
        self.place_driven(state.time, turns);
        let states = state.q.as_chunks().0.iter().zip(state.v.as_chunks().0);
        for (FreeBody { body, .. }, ([x, y, angle], [x_rate, y_rate, rate])) in
            self.layout.free.iter().zip(states)
        {
            let position = Vector::new(*x, *y);
            self.now.poses[*body] = match turns {
                Some(turns) => with_turn(position, *angle, turns[*body - 1]),
                None => Pose::new(position, *angle),
            };
            self.now.motions[*body] =
                Motion { linear: Vector::new(*x_rate, *y_rate), angular: *rate };
        }
    }

    /// Places the bodies whose motion is prescribed, their accelerations included.
    #[inline(always)]
    fn place_driven(&mut self, time: S, turns: Option<&[Turn<S>]>) {
        for driven in &self.layout.driven {
            let pair = &self.model.joints()[driven.joint].ends.pair;
            let course = &self.model.drives()[driven.drive].course;
            let (s_base, s_own, sign) = match driven.second {
                true => (pair.s_i, pair.s_j, S::one()),
                false => (pair.s_j, pair.s_i, -S::one()),
            };
            let (base, motion) = (self.now.poses[driven.base], self.now.motions[driven.base]);
            let acceleration = self.now.accelerations[driven.base];
            let [turned, turning, bend] = course.at(time);
            let angle = base.angle + sign * turned;
            let turn = match turns {
                Some(turns) => turns[driven.body - 1],
                None => {
                    let (sin, cos) = course.wrapped(time).sin_cos();
                    let sin = sign * sin;
                    [base.cos * cos - base.sin * sin, base.sin * cos + base.cos * sin]
                }
            };
            let rate = motion.angular + sign * turning;
            let mut pose = with_turn(Vector::zero(), angle, turn);
            let (arm_base, arm) = (base.rotate(s_base), pose.rotate(s_own));
            pose.position = base.position + arm_base - arm;
            self.now.poses[driven.body] = pose;
            self.now.motions[driven.body] =
                Motion { linear: motion.at(arm_base) - arm.turned() * rate, angular: rate };
            let linear = acceleration.linear - arm_base * (motion.angular * motion.angular)
                + arm * (rate * rate);
            self.now.accelerations[driven.body] = match driven.accelerates {
                false => Motion { linear, angular: S::zero() },
                true => {
                    let angular = acceleration.angular + sign * bend;
                    let turning = arm_base.turned() * acceleration.angular;
                    Motion { linear: linear + turning - arm.turned() * angular, angular }
                }
            };
        }
    }

    /// Angles of every body but the ground (rad).
    pub(super) fn angles(&self, time: S, q: &[S], angles: &mut [S]) {
        for FreeBody { body, at, .. } in &self.layout.free {
            angles[body - 1] = q[at + 2];
        }
        for driven in &self.layout.driven {
            let base = if driven.base == 0 { S::zero() } else { angles[driven.base - 1] };
            let turned = self.model.drives()[driven.drive].course.wrapped(time);
            angles[driven.body - 1] = if driven.second { base + turned } else { base - turned };
        }
    }

    /// Angular rates of every body but the ground (rad/s).
    pub(super) fn angular_rates(&self, time: S, v: &[S], rates: &mut [S]) {
        for FreeBody { body, at, .. } in &self.layout.free {
            rates[body - 1] = v[at + 2];
        }
        for driven in &self.layout.driven {
            let rate = self.model.drives()[driven.drive].course.rate(time);
            let base = if driven.base == 0 { S::zero() } else { rates[driven.base - 1] };
            rates[driven.body - 1] = if driven.second { base + rate } else { base - rate };
        }
    }
}

fn with_turn<S: Scalar>(position: Vector<S>, angle: S, [cos, sin]: Turn<S>) -> Pose<S> {
    Pose { position, angle, cos, sin }
}
