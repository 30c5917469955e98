//! How the event functions of a clearance joint may go on from a state.
//!
//! The depth is told of by the function
//! ```text
//! g = (e·e − c²) / 2c²,   ġ = e·ė / c²,   g̈ = (ė·ė + e·ë) / c²
//! ```
//! which has the sign of δ, is δ/c beside the wall, and is smooth at the bearing's centre too. Of its
//! third derivative, (3 ė·ë + e·e⃛)/c², turning alone makes
//! ```text
//! |e⃛| ≤ j = |s_j| (|ω_j|³ + 3 |ω_j α_j|) + the same of i
//! |ë| ≤ a + j t,  |ė| ≤ v + a t + …,  |e| ≤ e + v t + …
//! ```
//! at a time t from the state; what changing forces add, the search for events takes from
//! differences of g̈. Before a wall g = δ/c, and turning makes of the third derivative of n·D, with
//! D from body `i` to the point,
//! ```text
//! |n⃛·D + 3 n̈·Ḋ + 3 ṅ·D̈ + n·D⃛|,   |ṅ| = ω_i,  |n̈| ≤ |α_i| + ω_i²,  |n⃛| ≤ |ω_i|³ + 3 |ω_i α_i|
//! ```

use super::{Clearance, EventSlot, Gap, GapRates, Mode};
use crate::dae::Course;
use crate::friction::{FrictionLaw, Inner};
use crate::plane::{Motion, Pose, Vector};
use crate::scalar::Scalar;

/// Rounding of an event function, in units of the arithmetic's, beside that of coordinates.
const ROUNDINGS: f64 = 1e3;

/// The bodies of the mechanism at a state, by body.
#[derive(Debug, Clone, Copy)]
pub struct Bodies<'a, S> {
    /// Poses.
    pub poses: &'a [Pose<S>],
    /// Motions.
    pub motions: &'a [Motion<S>],
    /// Accelerations.
    pub accelerations: &'a [Motion<S>],
}

impl<S: Scalar> Clearance<S> {
    /// The course of an event function, with the inner states of the friction. Whether the offset of the gap is `carried` by the engine,
    /// and not a difference of coordinates, decides on its rounding.
    pub fn course(
        &self,
        mode: &Mode<S>,
        slot: EventSlot,
        gap: &Gap<S>,
        inner: Inner<S>,
        bodies: Bodies<'_, S>,
        carried: bool,
    ) -> Course {
        if slot == EventSlot::Depth {
            return match self.wall {
                None => self.depth_course(gap, bodies, carried),
                Some(_) => self.wall_course(gap, bodies, carried),
            };
        }
        let rates = self.rates(gap, bodies.motions);
        let second = self.second_rates(gap, &rates, bodies.motions, bodies.accelerations);
        let value = self.event_value(mode, slot, gap, inner, || rates).to_f64();
        let rate = self.event_rate(mode, slot, gap, inner, &rates, second).to_f64();
        let grain = self.rate_grain(slot, mode, gap, &rates, inner, bodies);
        Course { value, rate, grain, noise: S::EPSILON * (ROUNDINGS + 4.0 * grain), ..Course::NONE }
    }

    fn depth_course(&self, gap: &Gap<S>, bodies: Bodies<'_, S>, carried: bool) -> Course {
        let square = S::one() / (self.radial * self.radial);
        let half = S::from_f64(0.5);
        let value = half * gap.depth * (gap.eccentricity + self.radial) * square;
        let second = self.offset_second_rate(gap, bodies.motions, bodies.accelerations);
        let rate = gap.offset.dot(gap.offset_rate) * square;
        let bend = (gap.offset_rate.dot(gap.offset_rate) + gap.offset.dot(second)) * square;
        let square = square.to_f64();
        let [e, v, a] = [gap.eccentricity, gap.offset_rate.norm(), second.norm()].map(S::to_f64);
        let j = self.turning_jerk(bodies);
        let twist = [
            (3.0 * v * a + e * j) * square,
            (3.0 * a * a + 4.0 * v * j) * square,
            5.0 * a * j * square,
        ];
        self.told([value, rate, bend], twist, gap, bodies, carried)
    }

    fn wall_course(&self, gap: &Gap<S>, bodies: Bodies<'_, S>, carried: bool) -> Course {
        let (i, j) = (self.pair.i, self.pair.j);
        let rates = self.rates(gap, bodies.motions);
        let second = self.second_rates(gap, &rates, bodies.motions, bodies.accelerations).0;
        let [value, rate, bend] = [gap.depth, rates.rate, second].map(|x| x / self.radial);
        let [omega, alpha] =
            [bodies.motions, bodies.accelerations].map(|of| of[i].angular.to_f64().abs());
        let turning = [omega, alpha + omega * omega, omega * (omega * omega + 3.0 * alpha)];
        // D, Ḋ, D̈ and what turning makes of D⃛
        let going = bodies.motions[j].at(gap.arm_j) - bodies.motions[i].linear;
        let pulled = bodies.accelerations[j].at(gap.arm_j)
            - gap.arm_j * (bodies.motions[j].angular * bodies.motions[j].angular)
            - bodies.accelerations[i].linear;
        let [d, v, a] = [gap.arm_i, going, pulled].map(|x| x.norm().to_f64());
        let jerk = Self::jerk_of(j, gap.arm_j, bodies);
        let c = self.radial.to_f64();
        let twist = [
            (turning[2] * d + 3.0 * turning[1] * v + 3.0 * turning[0] * a + jerk) / c,
            (turning[2] * v + 3.0 * turning[1] * a + 3.0 * turning[0] * jerk) / c,
            0.5 * (turning[2] * a + 3.0 * turning[1] * jerk) / c,
        ];
        self.told([value, rate, bend], twist, gap, bodies, carried)
    }

    /// The course of the depth's event function, with its grain and noise.
    fn told(
        &self,
        derivatives: [S; 3],
        twist: [f64; 3],
        gap: &Gap<S>,
        bodies: Bodies<'_, S>,
        carried: bool,
    ) -> Course {
        let [value, rate, bend] = derivatives.map(S::to_f64);
        let (i, journal) = (self.pair.i, self.pair.j);
        let reach = |body: usize, arm: Vector<S>| {
            (bodies.poses[body].position.norm() + arm.norm()).to_f64()
        };
        let grain = (reach(i, gap.arm_i) + reach(journal, gap.arm_j)) / self.radial.to_f64();
        let lost = if carried { 0.0 } else { 4.0 * grain };
        let noise = S::EPSILON * (ROUNDINGS + lost);
        Course { value, rate, bend: Some(bend), twist, grain, noise }
    }

    /// What turning makes of e⃛ at the most (m/s³).
    fn turning_jerk(&self, bodies: Bodies<'_, S>) -> f64 {
        let of = |body: usize, arm: Vector<S>| Self::jerk_of(body, arm, bodies);
        of(self.pair.i, self.pair.s_i) + of(self.pair.j, self.pair.s_j)
    }

    /// The same of a point of one body.
    fn jerk_of(body: usize, arm: Vector<S>, bodies: Bodies<'_, S>) -> f64 {
        let rate = bodies.motions[body].angular.to_f64().abs();
        let second = bodies.accelerations[body].angular.to_f64().abs();
        arm.norm().to_f64() * rate * (rate * rate + 3.0 * second)
    }

    /// What a relative error of the state makes of an event function of rates.
    fn rate_grain(
        &self,
        slot: EventSlot,
        mode: &Mode<S>,
        gap: &Gap<S>,
        rates: &GapRates<S>,
        inner: Inner<S>,
        bodies: Bodies<'_, S>,
    ) -> f64 {
        let of = |body: usize, arm: Vector<S>, radius: S| {
            let motion = &bodies.motions[body];
            motion.linear.norm() + (arm.norm() + radius) * motion.angular.abs()
        };
        let arm_i = if self.wall.is_some() { gap.arm_i } else { self.pair.s_i };
        let speed = of(self.pair.i, arm_i, self.bearing_radius)
            + of(self.pair.j, self.pair.s_j, self.journal_radius)
            + rates.sweep.abs();
        let per_speed = match (slot, mode, &self.friction) {
            (EventSlot::Pull, Mode::Contact(contact), _) => {
                self.normal.pressing_slope(contact.inverse_impact_rate)
            }
            (EventSlot::InnerEdge(edge), Mode::Contact(contact), _) => {
                let within = self.inner_edge(contact, edge, rates.slip, inner);
                let Some(within) = within else { return 0.0 };
                let remembered = within.d_inner.iter().zip(inner);
                let remembered =
                    remembered.fold(S::zero(), |sum, (slope, state)| sum + (*slope * state).abs());
                return (speed * within.d_slip.abs() + remembered).to_f64();
            }
            (_, _, Some(friction)) => S::one() / friction.slip_scale(),
            _ => S::zero(),
        };
        (speed * per_speed).to_f64()
    }
}
