//! What the page needs to draw a mechanism: points on bodies, and the joints between them.

use crate::case::{Case, Changes};
use crate::course::Course;
use crate::model::picture::{Acting, Wheel, acting, wheels};
use crate::model::{Description, JointDescription, NamedPoint, Play};
use crate::record::ResultFile;
use serde::Serialize;
use std::path::Path;

/// A mechanism's shape, in the order of the result file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Drawing {
    /// Points of the ground, in the fixed frame.
    ground: Vec<Point>,
    /// Points of each body, in its frame.
    bodies: Vec<Vec<Point>>,
    joints: Vec<DrawnJoint>,
    /// Springs, by the points between which they are.
    springs: Vec<[PointOnBody; 2]>,
    loads: Vec<DrawnLoad>,
    /// Acceleration of free fall (m/s²), fixed frame.
    gravity: Option<[f64; 2]>,
}

/// A named point.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Point {
    name: String,
    /// Coordinates (m).
    at: [f64; 2],
}

/// A joint between two points.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct DrawnJoint {
    /// Bearing and journal, or the two points of an ideal joint.
    between: [PointOnBody; 2],
    /// Its kind, as in case files.
    kind: &'static str,
    /// Direction of the line that its second point slides on, in the frame of the first body.
    axis: Option<[f64; 2]>,
    /// Radius (m) of a pinion about its second point; the rack is as far off, to the left of the axis
    /// where it is positive.
    pinion: Option<f64>,
    /// The pitch circles of a gear pair.
    wheels: Option<[DrawnWheel; 2]>,
    /// Whether a drive or a speed controller sits on it.
    driven: bool,
    /// The circles of a bearing with clearance.
    clearance: Option<DrawnClearance>,
    /// The straight walls of a guide or a slot with clearance.
    walls: Option<DrawnWalls>,
}

/// A point by its body and its place among the body's points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct PointOnBody {
    /// Index of the body; none is the ground.
    body: Option<usize>,
    point: usize,
}

/// A pitch circle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct DrawnWheel {
    at: PointOnBody,
    /// Radius (m).
    radius: f64,
    /// Whether its teeth are on its inner side.
    ring: bool,
}

/// The circles of a clearance (m).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct DrawnClearance {
    bearing_radius: f64,
    radial: f64,
}

/// Two walls and what is between them (m).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct DrawnWalls {
    /// Play on each side.
    gap: f64,
    /// Length and height of a block, whose angle in the guide is `angle` (rad); else there is a pin.
    block: Option<[f64; 2]>,
    angle: f64,
    /// Radius of a pin.
    pin: Option<f64>,
}

fn circles_of(play: &Play) -> Option<DrawnClearance> {
    let Play::Bearing { bearing_radius, radial } = play else { return None };
    Some(DrawnClearance { bearing_radius: bearing_radius.to_f64(), radial: radial.to_f64() })
}

fn walls_of(play: &Play, joint: &JointDescription) -> Option<DrawnWalls> {
    let (gap, block, pin) = match play {
        Play::Bearing { .. } => return None,
        Play::Guide { gap, length, height, .. } => {
            (gap, Some([length.to_f64(), height.to_f64()]), None)
        }
        Play::Slot { gap, pin_radius } => (gap, None, Some(pin_radius.to_f64())),
    };
    let angle = if block.is_some() { joint.part.number("angle") } else { 0.0 };
    Some(DrawnWalls { gap: gap.to_f64(), block, angle, pin })
}

impl Drawing {
    /// The drawing of a case; `None` where it does not speak of the bodies and joints of the
    /// result file.
    pub fn of(case: &Case, file: &ResultFile) -> Option<Drawing> {
        let description = &case.description;
        let bodies = description.bodies.iter().map(|body| &body.name);
        let joints = description.joints.iter().map(|joint| &joint.name);
        if !bodies.eq(file.bodies()) || !joints.eq(file.joints()) {
            return None;
        }
        let gravity = description.loads.iter().filter_map(|load| load.gravity());
        Some(Drawing {
            ground: points(&description.ground),
            bodies: description.bodies.iter().map(|body| points(&body.points)).collect(),
            joints: joints_of(description)?,
            springs: springs_of(description)?,
            loads: acting_on(description).filter_map(|load| load_of(description, &load)).collect(),
            gravity: gravity.reduce(|[x, y], [also_x, also_y]| [x + also_x, y + also_y]),
        })
    }
}

/// The case of a result file; `None` where its text is not one that this program reads.
pub(super) fn case_of(file: &ResultFile) -> Option<Case> {
    let text = file.text("case_toml")?;
    Case::from_text(Path::new("case.toml"), text, &Changes::default()).ok()
}

/// Duration of one turn of the first drive (s).
pub(super) fn period(case: &Case) -> Option<f64> {
    let drive = case.description.drives.first()?;
    Course::<f64>::of(&drive.part)?.period()
}

/// Whether two cases describe the same mechanism, under the same loads and drives, clearances
/// aside.
pub(super) fn same_but_for_clearances(one: &Case, other: &Case) -> bool {
    ideal(&one.description) == ideal(&other.description)
}

/// A description without clearances and start poses.
fn ideal(description: &Description) -> Description {
    let mut ideal = description.clone();
    ideal.start.clear();
    ideal.contacts.clear();
    ideal.memories.clear();
    ideal.observed.clear();
    for joint in &mut ideal.joints {
        joint.clearance = None;
    }
    ideal
}

fn joints_of(description: &Description) -> Option<Vec<DrawnJoint>> {
    let controlled = || {
        let controllers = description.loads.iter().filter(|load| load.part.is("speed-controller"));
        controllers.map(|controller| controller.part.text("joint"))
    };
    let circle_of = |wheel: &Wheel| {
        let at = point_on_body(description, &format!("{}.{}", wheel.body, wheel.point))?;
        Some(DrawnWheel { at, radius: wheel.radius, ring: wheel.is_ring })
    };
    let joint = |joint: &JointDescription| {
        let [first, second] = joint.between();
        Some(DrawnJoint {
            between: [point_on_body(description, first)?, point_on_body(description, second)?],
            kind: joint.part.kind().word,
            axis: joint.part.get("axis").map(|_| joint.part.vector("axis")),
            pinion: joint.part.is("rack").then(|| joint.part.number("radius")),
            wheels: wheels(description, joint)
                .and_then(|[pinion, wheel]| Some([circle_of(&pinion)?, circle_of(&wheel)?])),
            driven: description.drives.iter().any(|drive| drive.joint == joint.name)
                || controlled().any(|controlled| controlled == joint.name),
            clearance: joint.clearance.as_ref().and_then(|clearance| circles_of(&clearance.play)),
            walls: joint.clearance.as_ref().and_then(|clearance| walls_of(&clearance.play, joint)),
        })
    };
    description.joints.iter().map(joint).collect()
}

/// A load that acts at a point or on a body, in the direction in which it counts positive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
enum DrawnLoad {
    /// A force; the direction is one in the frame of a body, none the ground.
    Force { at: PointOnBody, direction: [f64; 2], frame: Option<usize> },
    /// A torque, counter-clockwise, and the body that takes its reaction.
    Torque { body: Option<usize>, on: Option<usize> },
    /// A torsion spring between two bodies.
    Coil { body: Option<usize>, on: Option<usize> },
}

/// Where the loads act.
fn acting_on(description: &Description) -> impl Iterator<Item = Acting<'_>> {
    description.loads.iter().filter_map(|load| acting(description, load))
}

fn load_of(description: &Description, load: &Acting) -> Option<DrawnLoad> {
    let body = |name: &str| description.bodies.iter().position(|body| body.name == name);
    Some(match *load {
        Acting::Spring { .. } => return None,
        Acting::Force { at, direction, frame } => {
            let at = point_on_body(description, at)?;
            DrawnLoad::Force { at, direction, frame: body(frame) }
        }
        Acting::Torque { body: own, on } => DrawnLoad::Torque { body: body(own), on: body(on) },
        Acting::Coil { body: own, on } => DrawnLoad::Coil { body: body(own), on: body(on) },
    })
}

fn springs_of(description: &Description) -> Option<Vec<[PointOnBody; 2]>> {
    let ends = acting_on(description).filter_map(|load| match load {
        Acting::Spring { between, .. } => Some(between),
        Acting::Force { .. } | Acting::Torque { .. } | Acting::Coil { .. } => None,
    });
    ends.map(|[first, second]| {
        Some([point_on_body(description, first)?, point_on_body(description, second)?])
    })
    .collect()
}

/// A point written `body.point`; of a body alone its first.
fn point_on_body(description: &Description, written: &str) -> Option<PointOnBody> {
    let (name, point) = written.split_once('.').unwrap_or((written, ""));
    let body = description.bodies.iter().position(|body| body.name == name);
    let points = match body {
        Some(body) => &description.bodies[body].points,
        None => &description.ground,
    };
    let point = match point {
        "" => (!points.is_empty()).then_some(0)?,
        point => points.iter().position(|known| known.name == point)?,
    };
    Some(PointOnBody { body, point })
}

fn points(points: &[NamedPoint]) -> Vec<Point> {
    let point = |point: &NamedPoint| Point { name: point.name.clone(), at: coordinates(&point.at) };
    points.iter().map(point).collect()
}

fn coordinates(at: &[crate::scalar::Decimal; 2]) -> [f64; 2] {
    [at[0].to_f64(), at[1].to_f64()]
}
