//! Gravity and whatever else acts on bodies, one file a load.
//!
//! A load acts on two bodies, as a function of time and of how they stand and move, or as a field
//! of acceleration on all of them. The slopes that an implicit engine wants follow by dual numbers.

use crate::course::Course;
use crate::joint::{Pair, Relation};
use crate::parameter::{Values, kinds};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::{Dual, Lift, Scalar};

kinds! { $
    /// A load of any kind.
    Law, each_law:
    Gravity in gravity,
    Force in force,
    Torque in torque,
    Spring in spring,
    TorsionSpring in torsion_spring,
    JointFriction in joint_friction,
    SpeedController in speed_controller,
    GasForce in gas_force,
    #[cfg(test)]
    Scratch in scratch,
}

pub use joint_friction::is_smooth;

/// The word of the friction of a joint.
pub const JOINT_FRICTION: &str = joint_friction::KIND.word;

/// The word of the load that is a field of gravity.
pub const GRAVITY: &str = gravity::KIND.word;

/// Where a load sits, and what of the model it needs.
#[derive(Debug, Clone, Copy)]
pub struct Ends<S> {
    /// First and second body, and points on them.
    pub pair: Pair<S>,
    /// Where potential energy in a field is zero (m).
    pub datum: Vector<S>,
    /// Index of the joint that it sits in, and what that holds; `None` where it sits in none.
    pub joint: Option<(usize, Relation<S>)>,
    /// Time (s) of courses at t = 0.
    pub clock: S,
}

/// Powers of a load (W).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Powers<S> {
    /// What it puts in.
    pub work: S,
    /// What it dissipates.
    pub dissipation: S,
}

/// Where a load stands between the places at which its formula changes, over a size of its own.
#[derive(Debug, Clone, Copy)]
pub struct Gate<S> {
    /// How far it is beyond the place behind it, where there is one.
    pub above: Option<S>,
    /// How far it is from the place ahead.
    pub below: Option<S>,
    /// The rate of the first (1/s).
    pub rate: S,
    /// The sizes that these are differences of.
    pub reach: S,
}

/// What a load does to its two bodies.
pub trait Acts<S: Scalar>: Clone {
    /// What it puts on first and second body (N, N m), where they stand and move so.
    fn wrenches<T: Lift<S>>(
        &self,
        time: S,
        poses: &[Pose<T>; 2],
        motions: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2];

    /// Potential energy (J).
    fn potential_energy(&self, poses: &[Pose<S>; 2]) -> S {
        let _ = poses;
        S::zero()
    }

    /// Its powers; those of a load that conserves energy are zero.
    fn powers(&self, time: S, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> Powers<S> {
        let _ = (time, poses, motions);
        Powers { work: S::zero(), dissipation: S::zero() }
    }

    /// The acceleration (m/s²) that it gives every body, and where its potential is zero (m).
    fn field(&self) -> Option<(Vector<S>, Vector<S>)> {
        None
    }

    /// The course of time in it.
    fn course(&self) -> Option<&Course<S>> {
        None
    }

    /// Typical size of what it remembers, in its unit; `None` where it remembers nothing.
    fn inner_scale(&self) -> Option<f64> {
        None
    }

    /// Its wrenches, and the rate of what it remembers, where that is `inner`. What they do counts as
    /// work, in place of [`powers`](Acts::powers).
    fn remembering<T: Lift<S>>(
        &self,
        time: S,
        poses: &[Pose<T>; 2],
        motions: &[Motion<T>; 2],
        inner: T,
    ) -> ([Wrench<T>; 2], T) {
        let _ = inner;
        (self.wrenches(time, poses, motions), T::zero())
    }

    /// Whether its formula changes at places that it may pass.
    fn has_gate(&self) -> bool {
        false
    }

    /// Where it stands between these, once it has been [put](Acts::pass) between some.
    fn gate(&self, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> Option<Gate<S>> {
        let _ = (poses, motions);
        None
    }

    /// Puts it between those where it stands, until this is called again.
    fn pass(&mut self, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) {
        let _ = (poses, motions);
    }

    /// Has it pass the place ahead, or the one behind it.
    fn pass_one(&mut self, ahead: bool) {
        let _ = ahead;
    }

    /// The friction that it is.
    fn rubs(&self) -> Option<&JointFriction<S>> {
        None
    }

    /// A rate (rad/s) of the motion that it makes a mass (kg) go through, over a length (m).
    fn pace(&self, mass: f64, length: f64) -> f64;
}

/// A load of a model.
#[derive(Debug, Clone)]
pub struct Load<S> {
    law: Law<S>,
    bodies: [usize; 2],
    field: Option<(Vector<S>, Vector<S>)>,
}

impl<S: Scalar> Load<S> {
    /// The load that these values describe, where it sits; `None` for what is no load.
    pub fn new(values: &Values, ends: &Ends<S>) -> Option<Self> {
        let law = Law::new(values, ends)?;
        let field = each_law!(&law, law => law.field());
        Some(Load { law, bodies: [ends.pair.i, ends.pair.j], field })
    }

    /// Its two bodies; `None` of a field.
    pub fn bodies(&self) -> Option<[usize; 2]> {
        self.field.is_none().then_some(self.bodies)
    }

    /// The acceleration (m/s²) of a field.
    pub fn field(&self) -> Option<Vector<S>> {
        self.field.map(|(acceleration, _)| acceleration)
    }

    /// The course of time in it.
    pub fn course(&self) -> Option<&Course<S>> {
        each_law!(&self.law, law => law.course())
    }

    /// Typical size of what it remembers, if it does.
    pub fn inner_scale(&self) -> Option<f64> {
        each_law!(&self.law, law => law.inner_scale())
    }

    /// Whether its formula changes at places that it may pass.
    pub fn has_gate(&self) -> bool {
        each_law!(&self.law, law => law.has_gate())
    }

    /// Where it stands between these, if it has been put between some.
    pub fn gate(&self, poses: &[Pose<S>], motions: &[Motion<S>]) -> Option<Gate<S>> {
        let (poses, motions) = self.of(poses, motions);
        each_law!(&self.law, law => law.gate(&poses, &motions))
    }

    /// Puts it between those where it stands.
    pub fn pass(&mut self, poses: &[Pose<S>], motions: &[Motion<S>]) {
        let (poses, motions) = self.of(poses, motions);
        each_law!(&mut self.law, law => law.pass(&poses, &motions));
    }

    /// Has it pass the place ahead, or the one behind it.
    pub fn pass_one(&mut self, ahead: bool) {
        each_law!(&mut self.law, law => law.pass_one(ahead));
    }

    /// The friction that it is, where it is one.
    pub fn rubs(&self) -> Option<&JointFriction<S>> {
        each_law!(&self.law, law => law.rubs())
    }

    /// A rate (rad/s) of the motion that it makes a mass (kg) go through, over a length (m).
    pub fn pace(&self, mass: f64, length: f64) -> f64 {
        each_law!(&self.law, law => law.pace(mass, length))
    }

    /// Adds what the load puts on each body (N, N m); `masses` (kg), poses, motions and wrenches
    /// are by body.
    #[inline(always)]
    pub fn apply(
        &self,
        time: S,
        masses: &[S],
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        wrenches: &mut [Wrench<S>],
    ) {
        if let Some((acceleration, _)) = self.field {
            for (wrench, mass) in wrenches.iter_mut().zip(masses) {
                wrench.force += acceleration * *mass;
            }
            return;
        }
        let (poses, motions) = self.of(poses, motions);
        let on = each_law!(&self.law, law => law.wrenches(time, &poses, &motions));
        for (body, wrench) in self.bodies.into_iter().zip(on) {
            wrenches[body] += wrench;
        }
    }

    /// Adds what a load that remembers puts on each body, and gives the rate of what it remembers.
    pub fn apply_remembering(
        &self,
        time: S,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        inner: S,
        wrenches: &mut [Wrench<S>],
    ) -> S {
        let (poses, motions) = self.of(poses, motions);
        let (on, rate) =
            each_law!(&self.law, law => law.remembering(time, &poses, &motions, inner));
        for (body, wrench) in self.bodies.into_iter().zip(on) {
            wrenches[body] += wrench;
        }
        rate
    }

    /// Slopes of the wrenches on both bodies, and of the rate of what it remembers: by coordinate `c`
    /// (x, y, θ) of one of them, and by its rate.
    pub fn slopes(
        &self,
        time: S,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        inner: S,
        place: (usize, usize),
    ) -> [([Wrench<S>; 2], S); 2] {
        let (poses, motions) = self.of(poses, motions);
        seeded(&poses, &motions, place).map(|(poses, motions)| {
            let inner = Dual::from_re(inner);
            let (on, rate) =
                each_law!(&self.law, law => law.remembering(time, &poses, &motions, inner));
            (slopes_of(on), rate.eps)
        })
    }

    /// Slopes of the same by what it remembers.
    pub fn inner_slopes(
        &self,
        time: S,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        inner: S,
    ) -> ([Wrench<S>; 2], S) {
        let (poses, motions) = self.of(poses, motions);
        // nothing but what it remembers changes
        let [(mut poses, motions), _] = seeded(&poses, &motions, (0, 0));
        poses[0].position.x.eps = S::zero();
        let inner = Dual::new(inner, S::one());
        let (on, rate) =
            each_law!(&self.law, law => law.remembering(time, &poses, &motions, inner));
        (slopes_of(on), rate.eps)
    }

    /// Potential energy (J).
    pub fn potential_energy(&self, masses: &[S], poses: &[Pose<S>]) -> S {
        let Some((acceleration, datum)) = self.field else {
            let poses = self.bodies.map(|body| poses[body]);
            return each_law!(&self.law, law => law.potential_energy(&poses));
        };
        let weigh = |(mass, pose): (&S, &Pose<S>)| *mass * acceleration.dot(pose.position - datum);
        -masses.iter().zip(poses).map(weigh).fold(S::zero(), |sum, v| sum + v)
    }

    /// Its powers (W), where `inner` is what it remembers, if it does.
    pub fn powers(
        &self,
        time: S,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        inner: Option<S>,
    ) -> Powers<S> {
        let (poses, motions) = self.of(poses, motions);
        let Some(inner) = inner else {
            return each_law!(&self.law, law => law.powers(time, &poses, &motions));
        };
        let (on, _) = each_law!(&self.law, law => law.remembering(time, &poses, &motions, inner));
        let work = on.iter().zip(&motions).fold(S::zero(), |sum, (wrench, motion)| {
            sum + wrench.force.dot(motion.linear) + wrench.moment * motion.angular
        });
        Powers { work, dissipation: S::zero() }
    }

    fn of(&self, poses: &[Pose<S>], motions: &[Motion<S>]) -> ([Pose<S>; 2], [Motion<S>; 2]) {
        (self.bodies.map(|body| poses[body]), self.bodies.map(|body| motions[body]))
    }
}

/// Poses and motions of two bodies with a direction in which they change.
type Seeded<S> = ([Pose<Dual<S>>; 2], [Motion<Dual<S>>; 2]);

/// Poses and motions of two bodies that change in one coordinate (x, y, θ) of one of them; and the
/// same that change in its rate.
fn seeded<S: Scalar>(
    poses: &[Pose<S>; 2],
    motions: &[Motion<S>; 2],
    place: (usize, usize),
) -> [Seeded<S>; 2] {
    let constant = |m: &Motion<S>| Motion {
        linear: Vector::new(Dual::from_re(m.linear.x), Dual::from_re(m.linear.y)),
        angular: Dual::from_re(m.angular),
    };
    let motions = motions.each_ref().map(constant);
    let moved = crate::joint::seeded(poses, place);
    let still = moved.map(|pose| Pose {
        position: Vector::new(Dual::from_re(pose.position.x.re), Dual::from_re(pose.position.y.re)),
        angle: Dual::from_re(pose.angle.re),
        cos: Dual::from_re(pose.cos.re),
        sin: Dual::from_re(pose.sin.re),
    });
    let mut faster = motions;
    let motion = &mut faster[place.0];
    match place.1 {
        0 => motion.linear.x.eps = S::one(),
        1 => motion.linear.y.eps = S::one(),
        _ => motion.angular.eps = S::one(),
    }
    [(moved, motions), (still, faster)]
}

/// The slopes of wrenches by what was seeded.
fn slopes_of<S: Scalar>(wrenches: [Wrench<Dual<S>>; 2]) -> [Wrench<S>; 2] {
    wrenches
        .map(|w| Wrench { force: Vector::new(w.force.x.eps, w.force.y.eps), moment: w.moment.eps })
}

/// A vector of parameters in a richer arithmetic.
fn lift<S: Scalar, T: Lift<S>>(v: Vector<S>) -> Vector<T> {
    Vector::new(T::lift(v.x), T::lift(v.y))
}

/// A torque (N m) on the second body, and its reaction on the first.
fn torque_on_second<T: Scalar>(torque: T) -> [Wrench<T>; 2] {
    [-torque, torque].map(|moment| Wrench { force: Vector::zero(), moment })
}
