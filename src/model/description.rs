//! A mechanism as a case describes it, before anything is checked.
//!
//! Numbers are decimals as written; names are words. [`Model::new`](super::Model::new) checks a
//! description and reads its numbers into an arithmetic.

use crate::contact::Damping;
use crate::contact::elastic::Ends;
use crate::joint::{PIN_SLOT, PRISMATIC};
use crate::parameter::Values;
use crate::scalar::{Decimal, Scalar};

/// A mechanism, unchecked. The order of each list is the order of the case file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Description {
    /// Points of the ground, in the fixed frame.
    pub ground: Vec<NamedPoint>,
    /// Bodies.
    pub bodies: Vec<BodyDescription>,
    /// Joints.
    pub joints: Vec<JointDescription>,
    /// Drives.
    pub drives: Vec<DriveDescription>,
    /// Loads.
    pub loads: Vec<LoadDescription>,
    /// Rough or fixed start poses.
    pub start: Vec<StartDescription>,
    /// Where in their bearings journals start.
    pub journals: Journals,
    /// Time of courses at t = 0 (s); `None`: 0.
    pub clock: Option<Decimal>,
    /// Penetration rates (m/s) at the begin of the contacts that a start is in, by joint.
    pub contacts: Vec<(String, Decimal)>,
    /// What frictions and loads remember at the start, by the name of the inner state; of others nothing.
    pub memories: Vec<(String, Decimal)>,
    /// Points that are observed, each written `body.point`.
    pub observed: Vec<String>,
}

/// Where in their bearings journals start, as nearly as fixed poses leave it open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Journals {
    /// Centred.
    #[default]
    Centred,
    /// Touching the wall that the force of the ideal mechanism presses them against.
    Touching,
    /// The same, as deep as bears that force.
    Pressed,
}

/// A named point of a body or of the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedPoint {
    /// Name, `A` in `crank.A`.
    pub name: String,
    /// Coordinates (m): in the fixed frame for the ground, else in the body's frame, whose origin
    /// is the mass centre.
    pub at: [Decimal; 2],
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyDescription {
    /// Name.
    pub name: String,
    /// Mass (kg).
    pub mass: Decimal,
    /// Moment of inertia about the mass centre (kg m²).
    pub inertia: Decimal,
    /// Points, in the body's frame.
    pub points: Vec<NamedPoint>,
}

/// A joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointDescription {
    /// Name.
    pub name: String,
    /// Its kind and keys.
    pub part: Values,
    /// Of a revolute joint: bearing on the first point, journal on the second; of a prismatic one guide
    /// and block, of a slot its flanks and the pin. Left out: an ideal joint.
    pub clearance: Option<ClearanceDescription>,
}

impl JointDescription {
    /// What it joins: two points, or, of a gear pair, two bodies.
    pub fn between(&self) -> [&str; 2] {
        self.part.pair("between")
    }

    /// Names of what may touch in it: the joint's own for a journal, `NAME_1` to `NAME_4` for the
    /// corners of a block at (+,+), (−,+), (−,−), (+,−) of its length and height, `NAME_1` and `NAME_2`
    /// for the flanks of a slot on the left and on the right of its axis.
    pub fn members(&self) -> Vec<String> {
        match self.clearance {
            Some(_) => members(&self.name, self.part.kind().word),
            None => Vec::new(),
        }
    }
}

/// Names of what may touch in a joint of a kind that has clearance ([`JointDescription::members`]).
pub fn members(joint: &str, kind: &str) -> Vec<String> {
    let count = match kind {
        PRISMATIC => 4,
        PIN_SLOT => 2,
        _ => return vec![joint.to_owned()],
    };
    (1..=count).map(|k| format!("{joint}_{k}")).collect()
}

/// Which play a joint leaves.
#[derive(Debug, Clone, PartialEq)]
pub enum Play {
    /// A journal in a bearing.
    Bearing {
        /// Radius of the bearing (m).
        bearing_radius: Decimal,
        /// Radial clearance c (m).
        radial: Decimal,
    },
    /// A block between the walls of a guide.
    Guide {
        /// Play on each side (m).
        gap: Decimal,
        /// Length of the block along the axis (m).
        length: Decimal,
        /// Its height across it (m).
        height: Decimal,
        /// Radius of its corners (m), for the stiffness alone.
        corner_radius: Option<Decimal>,
    },
    /// A pin between the flanks of a slot.
    Slot {
        /// Play on each side (m).
        gap: Decimal,
        /// Radius of the pin (m).
        pin_radius: Decimal,
    },
}

/// A clearance and what happens in it.
#[derive(Debug, Clone, PartialEq)]
pub struct ClearanceDescription {
    /// What may move how far.
    pub play: Play,
    /// Law of the normal force.
    pub normal: NormalDescription,
    /// Whether a contact force may pull.
    pub tension: Tension,
    /// Smallest impact rate that the damping is scaled by (m/s).
    pub minimum_impact_rate: Decimal,
    /// Largest penetration that the law is believed for, as a share of the size of what touches
    /// ([`Clearance::size`](crate::clearance::Clearance::size)).
    pub maximum_penetration: Decimal,
    /// Law of the tangential force; `None` without friction.
    pub friction: Option<Values>,
}

impl ClearanceDescription {
    /// The play on each side (m), and the name of its key.
    pub fn play(&self) -> (&'static str, &Decimal) {
        match &self.play {
            Play::Bearing { radial, .. } => ("radial", radial),
            Play::Guide { gap, .. } | Play::Slot { gap, .. } => ("gap", gap),
        }
    }

    /// The radii that a law of the normal force may go by.
    pub fn ends<S: Scalar>(&self) -> Ends<S> {
        match &self.play {
            Play::Bearing { bearing_radius, radial } => {
                let bearing: S = bearing_radius.value();
                Ends { bearing, journal: bearing - radial.value() }
            }
            Play::Guide { corner_radius, .. } => {
                Ends::on_a_plane(corner_radius.as_ref().map_or(S::zero(), Decimal::value))
            }
            Play::Slot { pin_radius, .. } => Ends::on_a_plane(pin_radius.value()),
        }
    }
}

/// What happens where a contact law gives a tensile force (key `tension`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tension {
    /// The law as printed, which may pull.
    Keep,
    /// No force there.
    Cut,
}

/// A normal-force law and its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalDescription {
    /// The law of its damping.
    pub law: DampingDescription,
    /// Restitution c_e in (0, 1]; the Hertz law has none.
    pub restitution: Option<Decimal>,
    /// The restitution that one impact by itself is to have, in place of a nominal one.
    pub achieved_restitution: Option<Decimal>,
    /// The law of its elastic part, with its keys.
    pub elastic: Values,
}

impl Description {
    /// What a clearance, by its own name ([`JointDescription::members`]), is described by.
    pub fn clearance(&self, name: &str) -> Option<&ClearanceDescription> {
        let mut joints = self.joints.iter();
        let its = |joint: &&JointDescription| joint.members().iter().any(|member| member == name);
        joints.find(its)?.clearance.as_ref()
    }
}

/// The damping of a normal force.
#[derive(Debug, Clone, PartialEq)]
pub enum DampingDescription {
    /// A weight of 1 + a δ̇/δ̇⁽⁻⁾.
    Weight(Damping),
    /// A viscous damping, with its keys.
    Viscous(Values),
}

impl DampingDescription {
    /// Its name in case files.
    pub fn word(&self) -> &'static str {
        match self {
            DampingDescription::Weight(damping) => damping.about().word,
            DampingDescription::Viscous(viscous) => viscous.kind().word,
        }
    }
}

impl NormalDescription {
    /// The nominal restitution that gives the one to be achieved, where that is asked for.
    pub fn nominal_restitution(&self) -> Option<f64> {
        let DampingDescription::Weight(damping) = &self.law else { return None };
        damping.nominal(self.achieved_restitution.as_ref()?.to_f64())
    }
}

/// A drive.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveDescription {
    /// Name.
    pub name: String,
    /// The course of what it prescribes: the angle of a revolute joint, the travel of a prismatic
    /// one.
    pub part: Values,
    /// Name of the joint it sits on.
    pub joint: String,
}

/// A load.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadDescription {
    /// Name.
    pub name: String,
    /// Its kind and keys.
    pub part: Values,
}

impl LoadDescription {
    /// Acceleration of free fall (m/s², fixed frame) of a field of gravity.
    pub fn gravity(&self) -> Option<[f64; 2]> {
        self.part.is(crate::load::GRAVITY).then(|| self.part.vector("acceleration"))
    }
}

/// Where a body starts. Keys left out are solved for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StartDescription {
    /// Name of the body.
    pub body: String,
    /// Mass centre (m).
    pub x: Option<Decimal>,
    /// Mass centre (m).
    pub y: Option<Decimal>,
    /// Angle (rad).
    pub angle: Option<Decimal>,
    /// Velocity of the mass centre (m/s).
    pub velocity_x: Option<Decimal>,
    /// Velocity of the mass centre (m/s).
    pub velocity_y: Option<Decimal>,
    /// Angular rate (rad/s).
    pub angular_velocity: Option<Decimal>,
    /// Whether the keys given hold exactly; else they are rough and choose the branch.
    pub fixed: bool,
}
