//! A journal in its bearing: geometry, mode, forces.

mod course;
mod force;
mod gap;
mod mode;

pub use course::Bodies;
pub use force::{ContactForce, ForceSlopes};
pub use gap::{Gap, GapRates, GapSlopes};
pub use mode::{Contact, EventSlot, Mode};

use crate::contact::NormalLaw;
use crate::contact::elastic::ElasticLaw;
use crate::friction::Friction;
use crate::joint::Pair;
use crate::scalar::Scalar;

/// A revolute joint with clearance: bearing on body `i`, journal on body `j`.
#[derive(Debug, Clone, Copy)]
pub struct Clearance<S> {
    /// The bodies, bearing centre and journal centre on them.
    pub pair: Pair<S>,
    /// Radius of the bearing R_b (m).
    pub bearing_radius: S,
    /// Radius of the journal R_j (m).
    pub journal_radius: S,
    /// Radial clearance c = R_b − R_j (m).
    pub radial: S,
    /// Law of the normal force.
    pub normal: NormalLaw<S>,
    /// Law of the tangential force, if there is friction.
    pub friction: Option<Friction<S>>,
    /// Whether a pulling contact force is cut to zero (key `tension`).
    pub cut_tension: bool,
    /// Smallest rate that the damping is scaled by (m/s; key `minimum_impact_rate`).
    pub minimum_impact_rate: S,
    /// Largest penetration that the law is believed for, as a share of the journal's radius
    /// (ruling `maximum_penetration`).
    pub maximum_penetration: f64,
}

impl<S: Scalar> Clearance<S> {
    /// The depth (m) up to which the contact law is believed: a share of the journal's radius, or
    /// where the elastic law ends.
    pub fn believed_depth(&self) -> f64 {
        let share = self.maximum_penetration * self.journal_radius.to_f64();
        share.min(self.normal.elastic().deepest())
    }

    /// What sets that depth, in words.
    pub fn believed_because(&self) -> String {
        let share = self.maximum_penetration;
        match self.normal.elastic().deepest() > self.believed_depth() {
            true => format!("{share} of the journal's radius (maximum_penetration)"),
            false => "where the formula of its elastic part ends".to_owned(),
        }
    }
}
