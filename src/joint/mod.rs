//! Ideal joints, one file a joint, and what follows from them.
//!
//! A joint says its position error Φ and nothing more ([`Holonomic`]); Φ_q, Φ̇, Φ̈ and the slopes
//! that an implicit engine wants follow from it by dual numbers. The revolute joint, which every
//! mechanism has many of, gives them by hand besides, held against the derived ones by a test.
//!
//! In all of them body `i` is the first and `j` the second; a few joints look at a third. A
//! multiplier λ of a row puts −λ ∂Φ/∂q on its bodies.

mod constraint;
mod derived;
mod drive;

pub use constraint::{Arms, Constraint};
pub use derived::Derived;
pub(crate) use derived::seeded;
pub use drive::{AngleDrive, Travel};

use crate::parameter::{Key, Takes, Values, kinds};
use crate::plane::{Pose, Vector};
use crate::scalar::{Lift, Scalar};

kinds! { $
    /// A joint of any kind.
    #[derive(Copy)]
    Relation, each_relation:
    Revolute in revolute,
    Prismatic in prismatic,
    PinSlot in pin_slot,
    Fixed in fixed,
    Distance in distance,
    Gear in gear,
    Rack in rack,
    #[cfg(test)]
    Scratch in scratch,
}

/// The words of the kinds that a drive may sit on, or that may have clearance.
pub const REVOLUTE: &str = revolute::KIND.word;
/// See [`REVOLUTE`].
pub const PRISMATIC: &str = prismatic::KIND.word;
/// See [`REVOLUTE`].
pub const PIN_SLOT: &str = pin_slot::KIND.word;

/// Index of the ground among the bodies.
pub const GROUND: usize = 0;

/// Most bodies that a joint holds.
pub const MOST_BODIES: usize = 3;

/// Most rows of a joint.
pub const MOST_ROWS: usize = 3;

/// The coefficients of one constraint row at ẋ, ẏ, θ̇ of one body.
pub type Block<S> = [S; 3];

/// Φ_q of one row: its blocks for the bodies of the joint.
pub type Blocks<S> = [Block<S>; MOST_BODIES];

/// The bodies of a joint and the places of its points on them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair<S> {
    /// Index of the first body; 0 is the ground.
    pub i: usize,
    /// Index of the second body.
    pub j: usize,
    /// The first point, in the frame of body `i` (m).
    pub s_i: Vector<S>,
    /// The second point, in the frame of body `j` (m).
    pub s_j: Vector<S>,
}

/// Where a joint sits: its points, and a third body that it may look at (else the ground).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ends<S> {
    /// First and second body.
    pub pair: Pair<S>,
    /// Index of the third.
    pub third: usize,
}

/// The key of a joint between two points.
const BETWEEN: Key =
    Key::new("between", Takes::Points, "", "a point of the first body and one of the second");

/// What a joint says of the bodies that it holds.
pub trait Holonomic<S: Scalar>: Copy {
    /// Number of rows.
    const ROWS: usize;

    /// Which rows are angles (rad); the others are lengths (m).
    const ANGLES: [bool; MOST_ROWS] = [false; MOST_ROWS];

    /// The joint that these values describe, where it sits.
    fn new(values: &Values, ends: &Ends<S>) -> Self;

    /// Φ of each row (m, rad) where first, second and third body stand at these poses; zero beyond
    /// the last row. Parameters are lifted into the arithmetic of the poses.
    fn error<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS];
}

/// From the first point to the second (m), fixed frame.
#[inline(always)]
fn between<S: Scalar, T: Lift<S>>(pair: &Pair<S>, poses: &[Pose<T>; MOST_BODIES]) -> Vector<T> {
    let [i, j, _] = poses;
    j.position + j.carry(pair.s_j) - i.position - i.carry(pair.s_i)
}

/// Along a direction that a case gives, of length one.
fn unit<S: Scalar>([x, y]: [S; 2]) -> Vector<S> {
    let along = Vector::new(x, y);
    along * (S::one() / along.norm())
}

impl<S: Scalar> Relation<S> {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        fn of<S: Scalar, J: Holonomic<S>>(_: &J) -> usize {
            J::ROWS
        }
        each_relation!(self, joint => of::<S, _>(joint))
    }

    /// Whether a row is an angle (rad).
    pub fn is_angle(&self, row: usize) -> bool {
        fn of<S: Scalar, J: Holonomic<S>>(_: &J, row: usize) -> bool {
            J::ANGLES[row]
        }
        each_relation!(self, joint => of::<S, _>(joint, row))
    }

    /// Φ of each row; see [`Holonomic::error`].
    #[inline(always)]
    pub fn error<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        each_relation!(self, joint => joint.error(poses))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::Motion;
    use proptest::prelude::*;

    fn pose(x: &[f64]) -> Pose<f64> {
        Pose::new(Vector::new(x[0], x[1]), x[2])
    }

    fn motion(x: &[f64]) -> Motion<f64> {
        Motion { linear: Vector::new(x[0], x[1]), angular: x[2] }
    }

    proptest! {
        /// All that the revolute joint says by hand follows from its Φ.
        #[test]
        fn the_revolute_joint_by_hand_is_the_derived_one(x in prop::collection::vec(-2.0..2.0f64, 24)) {
            let s = |k: usize| Vector::new(x[k], x[k + 1]);
            let pair = Pair { i: 1, j: 2, s_i: s(0), s_j: s(2) };
            let ends = Ends { pair, third: 0 };
            let revolute = Relation::Revolute(Revolute { pair });
            let by_hand = Constraint::joint(revolute, &ends);
            let derived = Constraint::Derived(Derived::joint(revolute, &ends));
            let poses = [Pose::fixed(), pose(&x[4..]), pose(&x[7..])];
            let motions = [Motion::rest(), motion(&x[10..]), motion(&x[13..])];
            let accelerations = [Motion::rest(), motion(&x[16..]), motion(&x[19..])];
            let lambda = [x[22], x[23]];
            let all = |constraint: &Constraint<f64>| {
                let mut told = [[0.0; 2]; 3];
                constraint.position_error(0.0, &poses, &mut told[0]);
                constraint.velocity_error(0.0, &poses, &motions, &mut told[1]);
                let arms = constraint.arms(&poses);
                let mut slopes = [[[0.0; 3]; MOST_BODIES]; 2];
                constraint.slopes(&poses, &arms, &mut slopes);
                let (m, a) = (&motions, &accelerations);
                constraint.acceleration_error(0.0, &arms, &poses, m, a, &mut told[2]);
                let mut all: Vec<f64> = told.concat();
                all.extend(slopes.concat().concat());
                let mut wrenches = [crate::plane::Wrench::none(); 3];
                constraint.act(&arms, &slopes, &lambda, &mut wrenches);
                all.extend(wrenches.iter().flat_map(|w| [w.force.x, w.force.y, w.moment]));
                let on = constraint.on_second(&arms, &slopes, &lambda);
                all.extend([on.force.x, on.force.y, on.moment]);
                let mut bend = [0.0; 81];
                constraint.bend(&poses, &lambda, |(s, c), (t, d), entry| {
                    bend[9 * (3 * s + c) + 3 * t + d] += entry;
                });
                all.extend(bend);
                let mut by = [0.0; 36];
                constraint.acceleration_slopes(&poses, m, a, |row, (s, c), [q, v]| {
                    by[18 * row + 2 * (3 * s + c)] = q;
                    by[18 * row + 2 * (3 * s + c) + 1] = v;
                });
                all.extend(by);
                all
            };
            for (k, (a, b)) in all(&by_hand).into_iter().zip(all(&derived)).enumerate() {
                prop_assert!((a - b).abs() <= 1e-13 * (1.0 + a.abs()), "{k}: {a} {b}");
            }
        }
    }
}
