//! Friction in an ideal revolute or prismatic joint.
//! ```text
//! N = √(|F|² + N₀²),   F_T = N · ratio(v)          (ratio: F_T/F_N of the friction law, against the slip v)
//! revolute:   v = r (ω_j − ω_i),             moment r F_T on the second body, −r F_T on the first
//! prismatic:  v = u · (v_j − v_i),           force F_T u on the second body at its point, −F_T u on the first there
//! dissipated −F_T v
//! ```
//! F is the force that the joint puts on its bodies (of a prismatic one across its line), and depends
//! on the friction itself: accelerations, multipliers and friction are solved for together. A preload
//! N₀ rounds off the kink that |F| has where a guide changes sides.
//!
//! What the joint is said to put on its second body (`joint_force_*`, `joint_moment`) is without the
//! friction, as with other loads.

use super::{Acts, Ends};
use crate::friction::{self, Friction, FrictionLaw, MOST_INNER, Sloped};
use crate::joint::{PRISMATIC, Pair, Prismatic, REVOLUTE, Relation};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "joint-friction",
    title: "friction in an ideal revolute or prismatic joint",
    example: r#"[loads.rub]
kind = "joint-friction"
joint = "B0"
friction = { law = "tanh", coefficient = 0.1, transition = 1e-3 }
pin_radius = 0.01"#,
    keys: &[
        Key::new("joint", Takes::Joint(&[REVOLUTE, PRISMATIC]), "", "the joint, ideal, revolute or prismatic"),
        Key::new("friction", Takes::Friction, "", "its law: one of those that follow the slip smoothly"),
        Key::new("pin_radius", Takes::Number(Range::Positive), "m", "radius r of the pin of a revolute joint").optional(),
        Key::new("preload", Takes::Number(Range::NotNegative), "N", "N₀, the normal force where the joint carries nothing").or("0.0"),
    ],
    ..Kind::PLAIN
};

/// The friction of a joint.
#[derive(Debug, Clone, Copy)]
pub struct JointFriction<S> {
    /// Index of the joint.
    pub joint: usize,
    pair: Pair<S>,
    /// `None` where nothing rubs.
    law: Option<Friction<S>>,
    preload: S,
    way: Way<S>,
}

/// What slips.
#[derive(Debug, Clone, Copy)]
enum Way<S> {
    /// A pin of this radius (m).
    Turns(S),
    /// A block in this guide.
    Slides(Prismatic<S>),
}

/// Whether a law follows the slip smoothly: it has no edges and remembers nothing.
pub fn is_smooth(law: &Friction<f64>) -> bool {
    let (below, above) = law.edges(law.branch(0.0, 0.0));
    !law.remembers() && below.is_infinite() && above.is_infinite()
}

impl<S: Scalar> JointFriction<S> {
    /// The friction that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let law = values.part("friction").and_then(|law| {
            let rubs = law.number::<f64>("coefficient") > 0.0;
            rubs.then(|| Friction::new(law, &friction::Ends { hysteresis: S::zero() }))?
        });
        let (joint, way) = match ends.joint {
            Some((joint, Relation::Prismatic(slide))) => (joint, Way::Slides(slide)),
            Some((joint, _)) => (joint, Way::Turns(values.number("pin_radius"))),
            None => (0, Way::Turns(S::zero())),
        };
        JointFriction { joint, pair: ends.pair, law, preload: values.number("preload"), way }
    }

    /// First and second body.
    pub fn bodies(&self) -> [usize; 2] {
        [self.pair.i, self.pair.j]
    }

    /// N (N) where the multipliers of the joint's rows are these, and its derivative by each.
    pub fn normal(&self, lambda: &[S]) -> (S, [S; 2]) {
        let along = match self.way {
            Way::Turns(_) => [lambda[0], lambda[1]],
            // the second row is the moment
            Way::Slides(_) => [lambda[0], S::zero()],
        };
        self.normal_of(Vector::new(along[0], along[1]))
    }

    /// N (N) where the joint carries this force, and its derivative by each component.
    pub fn normal_of(&self, force: Vector<S>) -> (S, [S; 2]) {
        let normal = (force.dot(force) + self.preload * self.preload).sqrt();
        if normal == S::zero() {
            return (normal, [S::zero(); 2]);
        }
        (normal, [force.x / normal, force.y / normal])
    }

    /// The slip v (m/s).
    fn slip<T: Lift<S>>(&self, poses: &[Pose<T>; 2], motions: &[Motion<T>; 2]) -> T {
        match self.way {
            Way::Turns(radius) => (motions[1].angular - motions[0].angular) * T::lift(radius),
            Way::Slides(slide) => slide.rate(poses, motions),
        }
    }

    /// F_T/N where the bodies stand and move so, with its slope by the slip; and the slip (m/s).
    pub fn ratio(&self, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> (Sloped<S>, S) {
        let slip = self.slip(poses, motions);
        let ratio = |law: &Friction<S>| law.ratio(law.branch(slip, S::zero()), slip, [S::zero(); MOST_INNER]);
        (self.law.as_ref().map_or(Sloped::none(), ratio), slip)
    }

    /// What one newton of N puts on first and second body (N, N m), where F_T/N is `ratio` at
    /// the slip given with it, and goes by its slope beside that.
    pub fn of_one_newton<T: Lift<S>>(
        &self,
        (ratio, slip): &(Sloped<S>, S),
        poses: &[Pose<T>; 2],
        motions: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2] {
        let beside = self.slip(poses, motions) - T::lift(*slip);
        let ratio = T::lift(ratio.value) + T::lift(ratio.d_slip) * beside;
        match self.way {
            Way::Turns(radius) => super::torque_on_second(ratio * T::lift(radius)),
            Way::Slides(slide) => slide.pushed(ratio, poses),
        }
    }
}

impl<S: Scalar> JointFriction<S> {
    /// Slopes of what one newton of N puts on both bodies, by a coordinate of one of them and by its
    /// rate; see [`Load::slopes`](super::Load::slopes).
    pub fn slopes(
        &self,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        place: (usize, usize),
    ) -> [[Wrench<S>; 2]; 2] {
        let (poses, motions) =
            (self.bodies().map(|body| poses[body]), self.bodies().map(|body| motions[body]));
        let ratio = self.ratio(&poses, &motions);
        super::seeded(&poses, &motions, place)
            .map(|(poses, motions)| super::slopes_of(self.of_one_newton(&ratio, &poses, &motions)))
    }
}

impl<S: Scalar> Acts<S> for JointFriction<S> {
    /// It acts through the normal force, which the mechanism finds.
    fn wrenches<T: Lift<S>>(&self, _: S, _: &[Pose<T>; 2], _: &[Motion<T>; 2]) -> [Wrench<T>; 2] {
        [Wrench::none(); 2]
    }

    fn rubs(&self) -> Option<&JointFriction<S>> {
        Some(self)
    }

    fn pace(&self, _: f64, _: f64) -> f64 {
        0.0
    }
}
