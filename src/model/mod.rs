//! The checked mechanism.
//!
//! A [`Description`] becomes a [`Model`] in one place, which checks everything and collects every
//! complaint. After that bodies and joints are indices, parameters are in range, and nothing
//! below checks again.

mod check;
mod complaint;
mod description;
mod owner;
pub mod picture;

pub use crate::joint::GROUND;
pub use check::{check, is_name};
pub use complaint::*;
pub use description::*;
pub use owner::Owner;

use crate::clearance::{Clearance, Wall};
use crate::contact::elastic::{self, Elastic, ElasticLaw};
use crate::contact::viscous::{self, Viscous};
use crate::contact::{Damping, NormalLaw};
use crate::course::Course;
use crate::friction::{self, Friction, FrictionLaw};
use crate::joint::{self, Pair, Relation};
use crate::load::{self, Load};
use crate::parameter::{Takes, Value, Values};
use crate::plane::Vector;
use crate::scalar::{Decimal, F256, Scalar};
use std::ops::Range;
use std::sync::Arc;

/// A joint of a model.
#[derive(Debug, Clone)]
pub struct Joint<S> {
    /// What it holds.
    pub relation: Relation<S>,
    /// Where it sits.
    pub ends: joint::Ends<S>,
    /// What may touch in it, by index among the clearances: one journal, two flanks, four corners;
    /// nothing in an ideal joint.
    pub clearances: Range<usize>,
}

impl<S> Joint<S> {
    /// Whether it has clearance.
    pub fn is_loose(&self) -> bool {
        !self.clearances.is_empty()
    }
}

/// A drive of a model.
#[derive(Debug, Clone)]
pub struct Drive<S> {
    /// Index of the joint it sits on.
    pub joint: usize,
    /// What it prescribes: the angle (rad) of a revolute joint, the travel (m) of a prismatic one.
    pub course: Course<S>,
}

/// Where a body starts: the keys a case names.
#[derive(Debug, Clone, Copy)]
pub struct Start<S> {
    /// x, y (m, from the model's origin) and angle (rad).
    pub coordinates: [Option<S>; 3],
    /// Their rates (m/s, rad/s).
    pub velocities: [Option<S>; 3],
    /// Whether they hold exactly.
    pub fixed: bool,
}

/// A point of a body, or of the ground.
#[derive(Debug, Clone, Copy)]
pub struct Point<S> {
    /// Index of the body.
    pub body: usize,
    /// Where it is (m), in the body's frame; of the ground from the model's origin.
    pub at: Vector<S>,
}

/// Names of a model's parts, each list in the order of the case file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Names {
    /// Bodies, without the ground.
    pub bodies: Vec<String>,
    /// Joints.
    pub joints: Vec<String>,
    /// Clearances, by the name of their joint; in a guide or a slot with the number of its corner or
    /// flank: `slide_1`.
    pub clearances: Vec<String>,
    /// Index of the joint of each clearance.
    pub loose: Vec<usize>,
    /// Drives.
    pub drives: Vec<String>,
    /// Points that are observed, as `coupler.P`.
    pub points: Vec<String>,
    /// Inner states, as `A.friction` of a joint with clearance (`A.friction_2` a second one) and
    /// `governor.memory` of a load.
    pub memories: Vec<String>,
}

impl Names {
    /// The joint that a clearance is in, by its own name: `slide` of `slide_1`, where that is no joint
    /// itself.
    pub fn joint_of<'a>(&self, clearance: &'a str) -> &'a str {
        let joint = match clearance.rsplit_once('_') {
            Some((joint, number)) if number.parse::<u8>().is_ok() => joint,
            _ => return clearance,
        };
        let known = |name: &str| self.joints.iter().any(|known| known == name);
        if known(clearance) || !known(joint) { clearance } else { joint }
    }
}

/// A mechanism whose every number is in range and whose every reference leads somewhere.
#[derive(Debug, Clone)]
pub struct Model<S> {
    /// What it was read from.
    description: Arc<Description>,
    names: Names,
    origin: Vector<S>,
    masses: Vec<S>,
    inertias: Vec<S>,
    joints: Vec<Joint<S>>,
    clearances: Vec<Clearance<S>>,
    drives: Vec<Drive<S>>,
    loads: Vec<Load<S>>,
    load_names: Vec<String>,
    starts: Vec<Start<S>>,
    /// Whether the start is where another run stood.
    goes_on: bool,
    /// Penetration rates (m/s) at the begin of the contacts that the start is in, by clearance.
    contacts: Vec<Option<S>>,
    /// What frictions and loads remember at the start, by inner state.
    memories: Vec<S>,
    points: Vec<Point<S>>,
}

impl<S: Scalar> Model<S> {
    /// Reads a description in the arithmetic `S`.
    ///
    /// # Errors
    /// Every complaint there is, each with its key.
    pub fn new(description: &Description) -> Result<Model<S>, Vec<Complaint>> {
        let complaints = check(description);
        if !complaints.is_empty() {
            return Err(complaints);
        }
        let names = names(description);
        let frame = Frame::of(description);
        let bodies = || description.bodies.iter();
        let with_ground = |of: fn(&BodyDescription) -> &Decimal| {
            std::iter::once(S::zero()).chain(bodies().map(|body| of(body).value())).collect()
        };
        let mut joints = Vec::new();
        let mut clearances = Vec::new();
        for joint in &description.joints {
            let sites = Sites::of(description, &frame, &joint.part);
            let ends = joint::Ends { pair: sites.pair, third: sites.third };
            let relation = known("joints", &joint.name, Relation::new(&joint.part, &ends))?;
            let first = clearances.len();
            if let Some(clearance) = &joint.clearance {
                let read = read_clearance(&relation, ends.pair, clearance);
                clearances.extend(known("joints", &joint.name, read)?);
            }
            joints.push(Joint { relation, ends, clearances: first..clearances.len() });
        }
        let clock = description.clock.as_ref().map_or(S::zero(), Decimal::value);
        let drives = description.drives.iter().map(|drive| {
            let joint = position(&names.joints, &drive.joint);
            let course = known("drives", &drive.name, Course::of(&drive.part))?.ahead(clock);
            Ok::<_, Vec<Complaint>>(Drive { joint, course })
        });
        let loads = description.loads.iter().map(|load| {
            let sites = Sites::of(description, &frame, &load.part);
            let (pair, datum) = (sites.pair, -frame.origin());
            let mut ends = load::Ends { pair, datum, joint: None, clock };
            if let Some(Value::Text(joint)) = load.part.get("joint") {
                let index = position(&names.joints, joint);
                (ends.pair, ends.joint) =
                    (joints[index].ends.pair, Some((index, joints[index].relation)));
            }
            known("loads", &load.name, Load::new(&load.part, &ends))
        });
        let contact = |joint: &String| {
            let given = description.contacts.iter().find(|(name, _)| name == joint);
            given.map(|(_, rate)| rate.value())
        };
        let loads = loads.collect::<Result<Vec<_>, _>>()?;
        let load_names: Vec<String> =
            description.loads.iter().map(|load| load.name.clone()).collect();
        let drives = drives.collect::<Result<_, _>>()?;
        let contacts = names.clearances.iter().map(contact).collect();
        let memories = memories(&names, &clearances, (&load_names, &loads));
        Ok(Model {
            memories: remembered(description, &memories)?,
            description: Arc::new(description.clone()),
            goes_on: description.clock.is_some(),
            contacts,
            masses: with_ground(|body| &body.mass),
            inertias: with_ground(|body| &body.inertia),
            drives,
            loads,
            load_names,
            points: (description.observed.iter())
                .map(|written| point(description, &frame, written))
                .map(|(body, at)| Point { body, at })
                .collect(),
            starts: bodies().map(|body| start(description, &frame, &body.name)).collect(),
            joints,
            clearances,
            names: Names { memories, ..names },
            origin: frame.origin(),
        })
    }

    /// What it was read from.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Names of the parts.
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// Where positions of the model are counted from (m, fixed frame): the first point of the
    /// ground that a joint sits on. A mechanism far from the origin of the fixed frame so keeps the
    /// digits that its coordinates there would take.
    pub fn origin(&self) -> Vector<S> {
        self.origin
    }

    /// Masses by body (kg); that of the ground counts as zero.
    pub fn masses(&self) -> &[S] {
        &self.masses
    }

    /// Moments of inertia by body about the mass centre (kg m²).
    pub fn inertias(&self) -> &[S] {
        &self.inertias
    }

    /// Joints.
    pub fn joints(&self) -> &[Joint<S>] {
        &self.joints
    }

    /// Clearances, in the order of their joints.
    pub fn clearances(&self) -> &[Clearance<S>] {
        &self.clearances
    }

    /// Drives.
    pub fn drives(&self) -> &[Drive<S>] {
        &self.drives
    }

    /// Loads.
    pub fn loads(&self) -> &[Load<S>] {
        &self.loads
    }

    /// Name of a load.
    pub fn load_name(&self, load: usize) -> &str {
        &self.load_names[load]
    }

    /// Loads, whose places between changes of their formulas may be set.
    pub(crate) fn loads_mut(&mut self) -> &mut [Load<S>] {
        &mut self.loads
    }

    /// Start of each body, the ground left out.
    pub fn starts(&self) -> &[Start<S>] {
        &self.starts
    }

    /// Whether the start is where another run stood, with the time that courses had reached there:
    /// it holds to the last bit.
    pub fn goes_on(&self) -> bool {
        self.goes_on
    }

    /// Penetration rates (m/s) at the begin of the contacts that the start is in, by clearance; of
    /// the others `None`.
    pub fn contacts(&self) -> &[Option<S>] {
        &self.contacts
    }

    /// What frictions and loads remember at the start, by inner state, each in its own unit.
    pub fn memories(&self) -> &[S] {
        &self.memories
    }

    /// Points that are observed.
    pub fn points(&self) -> &[Point<S>] {
        &self.points
    }

    /// Name of a body by its index, `ground` among them.
    pub fn body_name(&self, body: usize) -> &str {
        if body == GROUND { "ground" } else { &self.names.bodies[body - 1] }
    }
}

fn names(description: &Description) -> Names {
    let joints = || description.joints.iter();
    let members = joints()
        .enumerate()
        .flat_map(|(index, joint)| joint.members().into_iter().map(move |member| (member, index)));
    let (clearances, loose) = members.unzip();
    Names {
        bodies: description.bodies.iter().map(|body| body.name.clone()).collect(),
        joints: joints().map(|joint| joint.name.clone()).collect(),
        clearances,
        loose,
        drives: description.drives.iter().map(|drive| drive.name.clone()).collect(),
        points: description.observed.clone(),
        memories: Vec::new(),
    }
}

/// Names of the inner states: those of the frictions in clearances, then those of loads.
fn memories<S: Scalar>(
    names: &Names,
    clearances: &[Clearance<S>],
    loads: (&[String], &[Load<S>]),
) -> Vec<String> {
    let frictions = names.clearances.iter().zip(clearances).flat_map(|(name, clearance)| {
        let count = clearance.friction.iter().flat_map(FrictionLaw::inner_scales).count();
        (1..=count).map(move |k| match k {
            1 => format!("{name}.friction"),
            k => format!("{name}.friction_{k}"),
        })
    });
    let loads = loads.0.iter().zip(loads.1).filter(|(_, load)| load.inner_scale().is_some());
    frictions.chain(loads.map(|(name, _)| format!("{name}.memory"))).collect()
}

/// What is remembered at the start, by inner state.
fn remembered<S: Scalar>(
    description: &Description,
    memories: &[String],
) -> Result<Vec<S>, Vec<Complaint>> {
    let mut complaints = Vec::new();
    let mut values = vec![S::zero(); memories.len()];
    for (k, (name, value)) in description.memories.iter().enumerate() {
        match memories.iter().position(|known| known == name) {
            Some(place) => values[place] = value.value(),
            None => complaints.push(Complaint {
                key: KeyPath::new(["start", "memory"]).key((k + 1).to_string()).key("of"),
                message: match memories {
                    [] => format!("is {name:?}, but nothing here remembers"),
                    all => format!("is {name:?}, which is none of: {}", all.join(", ")),
                },
            }),
        }
    }
    if complaints.is_empty() { Ok(values) } else { Err(complaints) }
}

/// The frame of the model: along the fixed frame, from an origin of its own.
struct Frame<'a> {
    origin: Option<&'a [Decimal; 2]>,
}

impl<'a> Frame<'a> {
    fn of(description: &'a Description) -> Frame<'a> {
        let mut ends = description.joints.iter().flat_map(|joint| joint.between());
        let origin = ends.find_map(|end| {
            let name = end.strip_prefix("ground.")?;
            let point = description.ground.iter().find(|point| point.name == name)?;
            Some(&point.at)
        });
        Frame { origin }
    }

    /// Its origin (m, fixed frame).
    fn origin<S: Scalar>(&self) -> Vector<S> {
        self.origin.map_or(Vector::zero(), vector)
    }

    /// A coordinate (m) that is written in the fixed frame, rounded once.
    fn along<S: Scalar>(&self, axis: usize, written: &Decimal) -> S {
        let Some(origin) = self.origin else { return written.value() };
        S::from_octuple(written.value::<F256>() - origin[axis].value::<F256>())
    }
}

fn vector<S: Scalar>(at: &[Decimal; 2]) -> Vector<S> {
    Vector::new(at[0].value(), at[1].value())
}

/// Place of a name that the check has found to be there.
fn position(names: &[String], name: &str) -> usize {
    let found = names.iter().position(|known| known == name);
    assert!(found.is_some(), "the check lets no unknown name pass, but \"{name}\" came through");
    found.unwrap_or(0)
}

/// Index and place of a point written `body.point`.
fn point<S: Scalar>(
    description: &Description,
    frame: &Frame<'_>,
    written: &str,
) -> (usize, Vector<S>) {
    let (body, name) = written.split_once('.').unwrap_or((written, ""));
    let (index, points) = match body {
        "ground" => (GROUND, &description.ground),
        _ => {
            let index = description.bodies.iter().position(|b| b.name == body);
            let index = index.unwrap_or_default();
            (index + 1, &description.bodies[index].points)
        }
    };
    let at = points.iter().find(|point| point.name == name);
    assert!(at.is_some(), "the check lets no unknown point pass, but \"{written}\" came through");
    let place = |point: &NamedPoint| match index {
        GROUND => Vector::new(frame.along(0, &point.at[0]), frame.along(1, &point.at[1])),
        _ => vector(&point.at),
    };
    (index, at.map_or(Vector::zero(), place))
}

/// A part of a kind that its list knows, as every part is that was read from a case.
fn known<T>(list: &str, name: &str, part: Option<T>) -> Result<T, Vec<Complaint>> {
    let message = || "is of a kind that does not belong here".to_owned();
    part.ok_or_else(|| vec![Complaint { key: KeyPath::new([list, name]), message: message() }])
}

/// Where a part sits.
struct Sites<S> {
    /// Its two points or two bodies; of a part at one point or on one body that is the second, and
    /// the first takes the reaction.
    pair: Pair<S>,
    /// Index of a third body, else the ground.
    third: usize,
}

impl<S: Scalar> Sites<S> {
    fn of(description: &Description, frame: &Frame<'_>, part: &Values) -> Self {
        let body = |name: &str| match name {
            "ground" => GROUND,
            name => 1 + description.bodies.iter().position(|b| b.name == name).unwrap_or(0),
        };
        let nowhere = Vector::zero();
        let mut pair = Pair { i: GROUND, j: GROUND, s_i: nowhere, s_j: nowhere };
        let mut single = Vec::new();
        for key in part.kind().keys {
            match (key.takes, part.get(key.name)) {
                (Takes::Points, Some(Value::Pair([first, second]))) => {
                    (pair.i, pair.s_i) = point(description, frame, first);
                    (pair.j, pair.s_j) = point(description, frame, second);
                }
                (Takes::Bodies, Some(Value::Pair([first, second]))) => {
                    (pair.i, pair.j) = (body(first), body(second));
                }
                (Takes::Point, Some(Value::Text(name))) => {
                    (pair.j, pair.s_j) = point(description, frame, name);
                }
                (Takes::Body, Some(Value::Text(name))) => single.push(body(name)),
                _ => {}
            }
        }
        let third = match *single {
            // on a body, against another
            [on, against] => {
                (pair.i, pair.j) = (against, on);
                GROUND
            }
            [third] => third,
            _ => GROUND,
        };
        Sites { pair, third }
    }
}

/// What may touch in a joint, in the order of [`JointDescription::members`].
fn read_clearance<S: Scalar>(
    relation: &Relation<S>,
    pair: Pair<S>,
    clearance: &ClearanceDescription,
) -> Option<Vec<Clearance<S>>> {
    let half = S::from_f64(0.5);
    let plain = Clearance {
        pair,
        wall: None,
        bearing_radius: S::zero(),
        journal_radius: S::zero(),
        radial: S::zero(),
        size: S::zero(),
        normal: normal_law(&clearance.normal, &clearance.ends())?,
        friction: clearance.friction.as_ref().and_then(friction_law),
        cut_tension: clearance.tension == Tension::Cut,
        minimum_impact_rate: clearance.minimum_impact_rate.value(),
        maximum_penetration: clearance.maximum_penetration.to_f64(),
    };
    let members = match (&clearance.play, relation) {
        (Play::Bearing { bearing_radius, radial }, _) => {
            let (bearing_radius, radial): (S, S) = (bearing_radius.value(), radial.value());
            let journal_radius = bearing_radius - radial;
            vec![Clearance {
                bearing_radius,
                journal_radius,
                radial,
                size: journal_radius,
                ..plain
            }]
        }
        (Play::Guide { gap, length, height, corner_radius }, Relation::Prismatic(guide)) => {
            let (along, across): (S, S) = (half * length.value(), half * height.value());
            let size = corner_radius.as_ref().map_or(across, Decimal::value);
            let corner = |(along_sign, sign): (f64, f64)| {
                let (normal, nominal) = (guide.across() * S::from_f64(sign), across);
                let place =
                    Vector::new(along * S::from_f64(along_sign), across * S::from_f64(sign));
                let wall = Some(Wall {
                    normal,
                    own_normal: guide.on_the_block(Vector::new(S::zero(), S::from_f64(sign))),
                    middle: pair.s_j,
                    nominal,
                    along: along * S::from_f64(along_sign * sign),
                });
                let pair = Pair { s_j: pair.s_j + guide.on_the_block(place), ..pair };
                Clearance { pair, wall, radial: gap.value(), size, ..plain }
            };
            CORNERS.map(corner).to_vec()
        }
        (Play::Slot { gap, pin_radius }, Relation::PinSlot(slot)) => {
            let radius: S = pin_radius.value();
            let wall = |normal: Vector<S>| Wall {
                normal,
                own_normal: normal,
                middle: pair.s_j,
                nominal: S::zero(),
                along: S::zero(),
            };
            let flank = |sign: f64| Clearance {
                wall: Some(wall(slot.across() * S::from_f64(sign))),
                bearing_radius: radius,
                journal_radius: radius,
                radial: gap.value(),
                size: radius,
                ..plain
            };
            [1.0, -1.0].map(flank).to_vec()
        }
        _ => return None,
    };
    Some(members)
}

/// The corners of a block by the signs of their places along and across the guide.
const CORNERS: [(f64, f64); 4] = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];

fn normal_law<S: Scalar>(
    normal: &NormalDescription,
    ends: &elastic::Ends<S>,
) -> Option<NormalLaw<S>> {
    let elastic = Elastic::new(&normal.elastic, ends)?;
    let damping = match &normal.law {
        DampingDescription::Weight(damping) => damping,
        DampingDescription::Viscous(values) => {
            let stiffness = elastic.power().map_or(S::one(), |(stiffness, _)| stiffness);
            let viscous = Viscous::new(values, &viscous::Ends { stiffness })?;
            return Some(NormalLaw::viscous(elastic, viscous));
        }
    };
    let damping_weight = match &normal.achieved_restitution {
        Some(achieved) => Damping::Exact.weight(achieved.value()),
        None => damping.weight(normal.restitution.as_ref().map_or(S::one(), Decimal::value)),
    };
    Some(NormalLaw::new(elastic, damping_weight))
}

/// The law, or nothing where its coefficient is zero.
fn friction_law<S: Scalar>(friction: &Values) -> Option<Friction<S>> {
    let hysteresis = S::from_f64(10.0 * S::EPSILON.sqrt());
    let coefficient: S = friction.number("coefficient");
    (coefficient > S::zero()).then(|| Friction::new(friction, &friction::Ends { hysteresis }))?
}

fn start<S: Scalar>(description: &Description, frame: &Frame<'_>, body: &str) -> Start<S> {
    let none = StartDescription::default();
    let start = description.start.iter().find(|start| start.body == body).unwrap_or(&none);
    let read = |number: &Option<Decimal>| number.as_ref().map(|number| number.value());
    Start {
        coordinates: [
            start.x.as_ref().map(|x| frame.along(0, x)),
            start.y.as_ref().map(|y| frame.along(1, y)),
            read(&start.angle),
        ],
        velocities: [
            read(&start.velocity_x),
            read(&start.velocity_y),
            read(&start.angular_velocity),
        ],
        fixed: start.fixed,
    }
}
