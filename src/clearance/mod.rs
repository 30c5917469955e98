//! A journal in its bearing, a corner of a block in its guide, a pin in its slot: geometry, mode,
//! forces.

mod course;
mod force;
mod gap;
mod lying;
mod mode;

pub use course::Bodies;
pub use force::{ContactForce, ForceSlopes};
pub use gap::{Gap, GapRates, GapSlopes};
pub use lying::Block;
pub use mode::{Contact, EventSlot, Mode};

use crate::contact::NormalLaw;
use crate::contact::elastic::ElasticLaw;
use crate::friction::Friction;
use crate::joint::Pair;
use crate::plane::Vector;
use crate::scalar::Scalar;

/// What may touch in a joint with clearance: a journal (on body `j`) and its bearing (on body `i`), or
/// a point of body `j` and a straight wall of body `i`.
#[derive(Debug, Clone, Copy)]
pub struct Clearance<S> {
    /// The bodies, bearing centre and journal centre on them; or a place on the guide's line, and the
    /// point before the wall.
    pub pair: Pair<S>,
    /// The wall, where it is no bearing.
    pub wall: Option<Wall<S>>,
    /// Radius of the bearing R_b (m); before a wall that of the pin, as from its centre on both
    /// bodies are touched; 0 where the point is a corner.
    pub bearing_radius: S,
    /// Radius of the journal R_j, or of the pin (m); 0 where the point is a corner.
    pub journal_radius: S,
    /// Radial clearance c = R_b − R_j, or the play before a wall (m).
    pub radial: S,
    /// The length (m) that [`maximum_penetration`](Self::maximum_penetration) is a share of.
    pub size: S,
    /// Law of the normal force.
    pub normal: NormalLaw<S>,
    /// Law of the tangential force, if there is friction.
    pub friction: Option<Friction<S>>,
    /// Whether a pulling contact force is cut to zero (key `tension`).
    pub cut_tension: bool,
    /// Smallest rate that the damping is scaled by (m/s; key `minimum_impact_rate`).
    pub minimum_impact_rate: S,
    /// Largest penetration that the law is believed for, as a share of the journal's radius, of a
    /// corner's or of half the block's height (ruling `maximum_penetration`).
    pub maximum_penetration: f64,
}

/// A straight wall of a guide, as long as it has to be.
#[derive(Debug, Clone, Copy)]
pub struct Wall<S> {
    /// Its normal out of the guide, in the frame of body `i`.
    pub normal: Vector<S>,
    /// The same direction in the frame of body `j`, where the block is not tilted.
    pub own_normal: Vector<S>,
    /// The middle of the block, or of the pin, in the frame of body `j` (m).
    pub middle: Vector<S>,
    /// How far from the guide's line the point is where nothing is out of place: half the block's
    /// height h (m), nothing for a pin.
    pub nominal: S,
    /// How much further it is for a tilt (m/rad): half the block's length, with a sign.
    pub along: S,
}

impl<S: Scalar> Clearance<S> {
    /// The depth (m) up to which the contact law is believed: a share of the size of what touches, or
    /// where the elastic law ends.
    pub fn believed_depth(&self) -> f64 {
        let share = self.maximum_penetration * self.size.to_f64();
        share.min(self.normal.elastic().deepest())
    }

    /// What touches and what it touches, in words.
    pub fn surfaces(&self) -> [&'static str; 2] {
        match (self.wall, self.journal_radius > S::zero()) {
            (None, _) => ["journal", "bearing"],
            (Some(_), true) => ["pin", "slot"],
            (Some(_), false) => ["corner", "guide"],
        }
    }

    /// What sets that depth, in words.
    pub fn believed_because(&self) -> String {
        let share = self.maximum_penetration;
        match self.normal.elastic().deepest() > self.believed_depth() {
            true => {
                let of = match (self.surfaces()[0], self.wall) {
                    ("corner", Some(wall)) if wall.nominal == self.size => {
                        "half the block's height"
                    }
                    ("corner", _) => "the corner's radius",
                    ("pin", _) => "the pin's radius",
                    _ => "the journal's radius",
                };
                format!("{share} of {of} (maximum_penetration)")
            }
            false => "where the formula of its elastic part ends".to_owned(),
        }
    }
}
