//! Everything about a description that can be checked without mechanics: names, ranges, and
//! whether what is named exists.

use super::{
    BodyDescription, ClearanceDescription, Complaint, Complaints, DampingDescription, Description,
    DriveDescription, JointDescription, KeyPath, LoadDescription, NamedPoint, NormalDescription,
    Play, StartDescription, normal_law, shortened,
};
use crate::contact::Damping;
use crate::contact::elastic::{self, ElasticLaw};
use crate::friction::{self, Friction};
use crate::joint::{PRISMATIC, REVOLUTE};
use crate::load::{JOINT_FRICTION, is_smooth};
use crate::parameter::{Key, Takes, Value, Values};
use crate::scalar::Decimal;
use std::collections::HashSet;

/// The word that stands for the ground where a body may be named.
const GROUND: &str = "ground";

/// Everything wrong with a description, in the order of its lists; empty if it is sound.
///
/// Whether the mechanism can be assembled, and whether its drives and start fit it, is not
/// looked at here.
pub fn check(description: &Description) -> Vec<Complaint> {
    let mut complaints = Complaints::default();
    check_points(&mut complaints, &KeyPath::new([GROUND]), &description.ground);
    check_bodies(&mut complaints, &description.bodies);
    check_names(
        &mut complaints,
        &KeyPath::new(["joints"]),
        description.joints.iter().map(|joint| &joint.name),
    );
    for joint in &description.joints {
        check_joint(&mut complaints, description, joint);
    }
    check_members(&mut complaints, description);
    check_drives(&mut complaints, description);
    check_names(
        &mut complaints,
        &KeyPath::new(["loads"]),
        description.loads.iter().map(|load| &load.name),
    );
    for load in &description.loads {
        check_load(&mut complaints, description, load);
    }
    check_starts(&mut complaints, description);
    check_open_contacts(&mut complaints, description);
    check_observed(&mut complaints, description);
    complaints.into_vec()
}

/// Names are words, and each stands once.
fn check_names<'a>(
    complaints: &mut Complaints,
    list: &KeyPath,
    names: impl Iterator<Item = &'a String>,
) {
    let mut seen = HashSet::new();
    for name in names {
        if !is_name(name) {
            let rule = "a letter or underscore, then letters, digits and underscores";
            let told = shortened(name);
            complaints.add(list.key(name), format!("the name {told:?} must be {rule}"));
        }
        if !seen.insert(name) {
            complaints.add(list.key(name), "stands there twice");
        }
    }
}

/// Whether the word matches `[A-Za-z_][A-Za-z0-9_]*`.
pub fn is_name(word: &str) -> bool {
    !word.starts_with(|c: char| c.is_ascii_digit())
        && !word.is_empty()
        && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The points of the body or ground at `owner`.
fn check_points(complaints: &mut Complaints, owner: &KeyPath, points: &[NamedPoint]) {
    let list = owner.key("points");
    check_names(complaints, &list, points.iter().map(|point| &point.name));
    for point in points {
        check_vector(complaints, list.key(&point.name), &point.at, "m");
    }
}

/// Both components are finite; complains once.
fn check_vector(complaints: &mut Complaints, key: KeyPath, vector: &[Decimal; 2], unit: &str) {
    if let Some(component) = vector.iter().find(|component| !component.to_f64().is_finite()) {
        complaints.require_finite(key, component, unit);
    }
}

fn check_bodies(complaints: &mut Complaints, bodies: &[BodyDescription]) {
    let list = KeyPath::new(["bodies"]);
    if bodies.is_empty() {
        complaints.add(list.clone(), "there must be at least one body");
    }
    check_names(complaints, &list, bodies.iter().map(|body| &body.name));
    for body in bodies {
        let key = list.key(&body.name);
        if body.name == GROUND {
            complaints
                .add(key.clone(), "no body may be called \"ground\": that is the fixed frame");
        }
        complaints.require_positive(key.key("mass"), &body.mass, "kg");
        complaints.require_positive(key.key("inertia"), &body.inertia, "kg m²");
        check_points(complaints, &key, &body.points);
    }
}

fn check_joint(complaints: &mut Complaints, description: &Description, joint: &JointDescription) {
    let key = KeyPath::new(["joints", &joint.name]);
    check_part(complaints, description, &key, &joint.part);
    if let Some(clearance) = &joint.clearance {
        check_clearance(complaints, description, &key.key("clearance"), clearance);
    }
}

/// A corner or a flank has a name of its own, which is that of no joint.
fn check_members(complaints: &mut Complaints, description: &Description) {
    let mut seen: HashSet<String> =
        description.joints.iter().map(|joint| joint.name.clone()).collect();
    for joint in &description.joints {
        for member in joint.members().into_iter().filter(|member| *member != joint.name) {
            if !seen.insert(member.clone()) {
                let key = KeyPath::new(["joints", &joint.name]);
                let message = format!(
                    "would give one of its walls the name {:?}, which is taken",
                    shortened(&member)
                );
                complaints.add(key, message);
            }
        }
    }
}

/// The values of a part are in the ranges of their keys, and what they name is there.
fn check_part(
    complaints: &mut Complaints,
    description: &Description,
    path: &KeyPath,
    part: &Values,
) {
    for Key { name, takes, unit, .. } in part.kind().keys {
        let (Some(value), key) = (part.get(name), path.key(*name)) else { continue };
        match (takes, value) {
            (Takes::Number(range), Value::Number(number)) => {
                complaints.require(key, number, unit, range.words(), |x| range.holds(x));
            }
            (Takes::Vector(range), Value::Vector(vector)) => {
                let length = vector[0].to_f64().hypot(vector[1].to_f64());
                if length.is_finite() && !range.holds(length) {
                    let words = range.words();
                    complaints.add(key, format!("must be {words} in length, is {length}"));
                } else {
                    check_vector(complaints, key, vector, unit);
                }
            }
            (Takes::Points, Value::Pair(between)) => {
                check_between(complaints, description, key, between);
            }
            (Takes::Point, Value::Text(point)) => {
                if let Err(reason) = find_point(complaints, description, point) {
                    complaints.add(key, reason);
                }
            }
            (Takes::Body, Value::Text(body)) => check_body(complaints, description, key, body),
            (Takes::Joint(kinds), Value::Text(joint)) => {
                check_joint_of(complaints, description, key, joint, kinds);
            }
            (Takes::Friction, Value::Part(law)) => check_part(complaints, description, &key, law),
            (Takes::Bodies, Value::Pair(bodies)) => {
                for body in bodies {
                    check_body(complaints, description, key.clone(), body);
                }
                if bodies[0] == bodies[1] {
                    complaints.add(key, format!("names {:?} twice", shortened(&bodies[0])));
                }
            }
            (Takes::Course, Value::Part(course)) => {
                check_part(complaints, description, &key, course);
                if course.is("speed") || course.is("ramp") {
                    check_goes(complaints, &key, course, "velocity", "speed_rpm");
                }
            }
            (Takes::NumberOr(range, _), Value::Number(number)) => {
                complaints.require(key, number, unit, range.words(), |x| range.holds(x));
            }
            (Takes::OfMaterials(range), Value::Materials([bearing, journal])) => {
                // what is the same for both is told once
                let others = (journal != bearing).then_some(journal);
                for number in std::iter::once(bearing).chain(others) {
                    let key = key.clone();
                    complaints.require(key, number, unit, range.words(), |x| range.holds(x));
                }
            }
            _ => {}
        }
    }
    for (key, message) in part.kind().also.map_or_else(Vec::new, |also| also(part)) {
        complaints.add(path.key(key), message);
    }
}

fn check_body(complaints: &mut Complaints, description: &Description, key: KeyPath, body: &str) {
    let mut known = description.bodies.iter().map(|body| body.name.as_str()).chain([GROUND]);
    if !known.clone().any(|known| known == body) {
        let near = complaints.near(body, known.by_ref());
        complaints.add(key, format!("there is no body {:?}{near}", shortened(body)));
    }
}

fn check_joint_name(
    complaints: &mut Complaints,
    description: &Description,
    key: KeyPath,
    joint: &str,
) {
    let mut joints = description.joints.iter().map(|known| known.name.as_str());
    if !joints.clone().any(|known| known == joint) {
        let near = complaints.near(joint, joints.by_ref());
        let joint = shortened(joint);
        complaints.add(key, format!("there is no joint {joint:?}{near}"));
    }
}

/// The joint is there, and of one of these kinds.
fn check_joint_of(
    complaints: &mut Complaints,
    description: &Description,
    key: KeyPath,
    joint: &str,
    kinds: &[&str],
) {
    check_joint_name(complaints, description, key.clone(), joint);
    let joint = description.joints.iter().find(|known| known.name == joint);
    let Some(joint) = joint.filter(|joint| !kinds.contains(&joint.part.kind().word)) else {
        return;
    };
    let kinds: Vec<String> = kinds.iter().map(|kind| format!("{kind:?}")).collect();
    let (name, kind, kinds) = (&joint.name, joint.part.kind().word, kinds.join(" or "));
    complaints.add(key, format!("joint {name:?} is {kind:?}, it must be {kinds}"));
}

/// A course that goes at a speed says it by the key of what goes, and not by the other.
fn check_goes(
    complaints: &mut Complaints,
    key: &KeyPath,
    course: &Values,
    wanted: &str,
    other: &str,
) {
    if course.get(wanted).is_none() {
        complaints.add(key.key(wanted), "is missing");
    }
    if course.get(other).is_some() {
        complaints.add(key.key(other), format!("does not belong here: use `{wanted}`"));
    }
}

/// Both ends exist, on two bodies.
fn check_between(
    complaints: &mut Complaints,
    description: &Description,
    key: KeyPath,
    between: &[String; 2],
) {
    let [from, to] = between.each_ref().map(|end| shortened(end));
    let connects = format!("connects {from:?} to {to:?}");
    let mut bodies = Vec::new();
    for end in between {
        match find_point(complaints, description, end) {
            Ok(body) => bodies.push(body),
            Err(reason) => complaints.add(key.clone(), format!("{connects}; {reason}")),
        }
    }
    if bodies.len() == 2 && bodies[0] == bodies[1] {
        let reason = "a joint cannot join a body to itself";
        complaints.add(key, format!("{connects}; {reason}"));
    }
}

/// The body that owns the point written `body.point`, or why there is no such point.
fn find_point<'a>(
    complaints: &Complaints,
    description: &Description,
    point: &'a str,
) -> Result<&'a str, String> {
    let Some((body, name)) = point.split_once('.') else {
        return Err(format!("{:?} is not written body.point", shortened(point)));
    };
    let known_bodies = || description.bodies.iter().map(|body| body.name.as_str());
    let points = match description.bodies.iter().find(|known| known.name == body) {
        _ if body == GROUND => &description.ground,
        Some(known) => &known.points,
        None => {
            let near = complaints.near(body, known_bodies().chain([GROUND]));
            return Err(format!("there is no body {:?}{near}", shortened(body)));
        }
    };
    if points.iter().any(|known| known.name == name) {
        return Ok(body);
    }
    let near = complaints.near(name, points.iter().map(|known| known.name.as_str()));
    let owner = match body == GROUND {
        true => "the ground".into(),
        false => format!("body {:?}", shortened(body)),
    };
    Err(format!("{owner} has no point {:?}{near}", shortened(name)))
}

/// What is observed is there, and named once.
fn check_observed(complaints: &mut Complaints, description: &Description) {
    let key = KeyPath::new(["observe", "points"]);
    let mut seen = HashSet::new();
    for point in &description.observed {
        if let Err(reason) = find_point(complaints, description, point) {
            complaints.add(key.clone(), reason);
        } else if !seen.insert(point) {
            complaints.add(key.clone(), format!("names {point:?} twice"));
        }
    }
}

fn check_clearance(
    complaints: &mut Complaints,
    description: &Description,
    key: &KeyPath,
    clearance: &ClearanceDescription,
) {
    let is_sound = check_play(complaints, key, &clearance.play);
    let rate = &clearance.minimum_impact_rate;
    complaints.require_positive(key.key("minimum_impact_rate"), rate, "m/s");
    let share = &clearance.maximum_penetration;
    let range = match &clearance.play {
        Play::Bearing { .. } => "a share of the journal's radius, greater than 0 and at most 1",
        _ => "a share, greater than 0 and at most 1",
    };
    let holds = |share: f64| share > 0.0 && share <= 1.0;
    complaints.require(key.key("maximum_penetration"), share, "", range, holds);
    let before = complaints.len();
    check_normal(complaints, description, &key.key("normal"), &clearance.normal);
    if is_sound && complaints.len() == before {
        check_elastic(complaints, &key.key("normal"), clearance);
    }
    if let Some(friction) = &clearance.friction {
        check_part(complaints, description, &key.key("friction"), friction);
    }
}

/// Lengths of a clearance are positive, and fit each other.
fn check_play(complaints: &mut Complaints, key: &KeyPath, play: &Play) -> bool {
    let mut positive =
        |name: &str, length: &Decimal| complaints.require_positive(key.key(name), length, "m");
    match play {
        Play::Bearing { bearing_radius, radial } => {
            let right = positive("bearing_radius", bearing_radius) & positive("radial", radial);
            if right && radial.to_f64() >= bearing_radius.to_f64() {
                let than = format!("must be less than bearing_radius, {bearing_radius} (m)");
                complaints.add(key.key("radial"), format!("{than}, is {radial}"));
                return false;
            }
            right
        }
        Play::Guide { gap, length, height, corner_radius } => {
            let corner = corner_radius.as_ref().is_none_or(|r| positive("corner_radius", r));
            corner & positive("gap", gap) & positive("length", length) & positive("height", height)
        }
        Play::Slot { gap, pin_radius } => positive("gap", gap) & positive("pin_radius", pin_radius),
    }
}

/// Radii and materials in range may yet be none that the law is for, or come to a stiffness that is no
/// number.
fn check_elastic(complaints: &mut Complaints, key: &KeyPath, clearance: &ClearanceDescription) {
    let (radial, elastic) = (clearance.play().1.to_f64(), &clearance.normal.elastic);
    if !matches!(clearance.play, Play::Bearing { .. }) && !elastic.is(elastic::POWER.word) {
        let message = "is the law of a cylinder in a bearing: corners and pins before straight walls \
                       take the power law";
        return complaints.add(key.key("elastic"), message);
    }
    if let Play::Guide { corner_radius: None, .. } = &clearance.play
        && !elastic.text("stiffness").is_empty()
    {
        let message = format!(
            "{:?} needs clearance.corner_radius (m), or give a number (N/mⁿ)",
            elastic.text("stiffness")
        );
        return complaints.add(key.key("stiffness"), message);
    }
    let Some(law) = normal_law::<f64>(&clearance.normal, &clearance.ends()) else { return };
    if let Some(objection) = law.elastic().objection() {
        return complaints.add(key.key("elastic"), objection);
    }
    if let Some(wanted) = law.wanted_exponent() {
        let word = clearance.normal.law.word();
        let goes_with = format!("law {word:?} goes with the power law and exponent {wanted}");
        match law.elastic().power() {
            Some((_, exponent)) if clearance.normal.elastic.is(elastic::POWER.word) => {
                if exponent != wanted {
                    complaints.add(key.key("exponent"), format!("{goes_with}, this is {exponent}"));
                }
            }
            _ => complaints.add(key.key("elastic"), goes_with),
        }
    }
    let (what, number) = match law.elastic().power() {
        Some((stiffness, _)) => ("stiffness", stiffness),
        None => ("elastic", law.elastic().force(1e-3 * radial.min(law.elastic().deepest())).1),
    };
    if !(number > 0.0 && number.is_finite()) {
        let unit = if what == "stiffness" { "N/mⁿ" } else { "N/m" };
        let from = "with these radii and materials";
        let message = format!("comes to {number:e} ({unit}) {from}: it must be positive");
        complaints.add(key.key(what), message);
    }
}

fn check_normal(
    complaints: &mut Complaints,
    description: &Description,
    key: &KeyPath,
    normal: &NormalDescription,
) {
    match &normal.law {
        DampingDescription::Weight(damping) => {
            check_restitution(complaints, key, normal, *damping);
        }
        DampingDescription::Viscous(values) => check_part(complaints, description, key, values),
    }
    check_part(complaints, description, key, &normal.elastic);
}

/// A law that dissipates needs a restitution, nominal or achieved, one that does not takes none.
fn check_restitution(
    complaints: &mut Complaints,
    key: &KeyPath,
    normal: &NormalDescription,
    damping: Damping,
) {
    let (dissipates, law) = (damping.about().restitution, damping.about().word);
    let (nominal, achieved) = (key.key("restitution"), key.key("achieved_restitution"));
    let given = [(nominal, &normal.restitution), (achieved, &normal.achieved_restitution)];
    for (key, restitution) in &given {
        let Some(restitution) = restitution else { continue };
        if !dissipates {
            complaints.add(key.clone(), format!("law {law:?} takes no restitution"));
        }
        let range = "greater than 0 and at most 1";
        complaints.require(key.clone(), restitution, "", range, |e| e > 0.0 && e <= 1.0);
    }
    let [(nominal, _), (key, _)] = given;
    match (&normal.restitution, &normal.achieved_restitution) {
        (None, None) if dissipates => {
            let rather = "needs it, or achieved_restitution";
            complaints.add(nominal, format!("is missing; law {law:?} {rather}"));
        }
        (Some(_), Some(_)) => {
            complaints.add(key, "the restitution is given too: one of the two determines the law");
        }
        (None, Some(achieved)) if dissipates => {
            let (achieved, least) = (achieved.to_f64(), damping.least_rebound());
            if achieved > 0.0 && achieved < least {
                let at = format!("law {law:?} rebounds at {least:.4} of the speed or more");
                complaints.add(key, format!("is {achieved}, but {at}; `freeplay laws` has others"));
            }
        }
        _ => {}
    }
}

fn check_drives(complaints: &mut Complaints, description: &Description) {
    check_names(
        complaints,
        &KeyPath::new(["drives"]),
        description.drives.iter().map(|drive| &drive.name),
    );
    for (position, drive) in description.drives.iter().enumerate() {
        let key = KeyPath::new(["drives", &drive.name]);
        let joint = &drive.joint;
        check_joint_name(complaints, description, key.key("joint"), joint);
        let earlier = &description.drives[..position];
        if let Some(other) = earlier.iter().find(|other| other.joint == *joint) {
            let (other, joint) = (&other.name, shortened(joint));
            complaints
                .add(key.key("joint"), format!("drive {other:?} drives joint {joint:?} already"));
        }
        check_drive(complaints, description, drive);
    }
}

fn check_drive(complaints: &mut Complaints, description: &Description, drive: &DriveDescription) {
    let key = KeyPath::new(["drives", &drive.name]);
    check_part(complaints, description, &key, &drive.part);
    let joint = description.joints.iter().find(|joint| joint.name == drive.joint);
    let Some(kind) = joint.map(|joint| joint.part.kind().word) else { return };
    let pairs = match kind {
        REVOLUTE => [("speed_rpm", "velocity"), ("angle", "position")],
        PRISMATIC => [("velocity", "speed_rpm"), ("position", "angle")],
        other => {
            let message = format!(
                "joint {:?} is {other:?}, which has nothing to drive: it must be {REVOLUTE:?} or \
                 {PRISMATIC:?}",
                drive.joint
            );
            return complaints.add(key.key("joint"), message);
        }
    };
    if drive.part.kind().keys.iter().any(|key| key.name == "velocity") {
        let [(speed, other), (start, other_start)] = pairs;
        check_goes(complaints, &key, &drive.part, speed, other);
        if drive.part.get(other_start).is_some() {
            let message = format!("does not belong on joint {kind:?}: use `{start}`");
            complaints.add(key.key(other_start), message);
        }
    }
}

fn check_load(complaints: &mut Complaints, description: &Description, load: &LoadDescription) {
    let key = KeyPath::new(["loads", &load.name]);
    check_part(complaints, description, &key, &load.part);
    let joint = description.joints.iter().find(|joint| joint.name == load.part.text("joint"));
    if let Some(joint) = joint.filter(|_| load.part.is(JOINT_FRICTION)) {
        check_joint_friction(complaints, &key, &load.part, joint);
    }
}

/// The joint is ideal, its pin has a radius, and the law can be followed.
fn check_joint_friction(
    complaints: &mut Complaints,
    key: &KeyPath,
    part: &Values,
    joint: &JointDescription,
) {
    if joint.clearance.is_some() {
        let (name, rather) = (&joint.name, "its friction is a key of its clearance");
        complaints.add(key.key("joint"), format!("joint {name:?} has clearance: {rather}"));
    }
    let pin = key.key("pin_radius");
    match (joint.part.kind().word, part.get("pin_radius").is_some()) {
        (REVOLUTE, false) => complaints.add(pin, "is missing; it must be a number (m)"),
        (PRISMATIC, true) => complaints.add(pin, format!("a {PRISMATIC:?} joint has no pin")),
        _ => {}
    }
    let ends = friction::Ends { hysteresis: 0.0 };
    let law = part.part("friction").and_then(|law| Friction::<f64>::new(law, &ends));
    if law.is_some_and(|law| !is_smooth(&law)) {
        let rule = "has kinks or remembers, which only contacts can follow";
        let others = "tanh, brown-mcphee, stribeck and others follow the slip smoothly";
        complaints.add(key.key("friction").key("law"), format!("{rule}: {others}"));
    }
}

fn check_starts(complaints: &mut Complaints, description: &Description) {
    let list = KeyPath::new(["start"]);
    let mut seen = HashSet::new();
    for start in &description.start {
        let key = list.key(&start.body);
        if !seen.insert(&start.body) {
            complaints.add(key.clone(), "stands there twice");
        }
        if !description.bodies.iter().any(|body| body.name == start.body) {
            let bodies = description.bodies.iter().map(|body| body.name.as_str());
            let near = complaints.near(&start.body, bodies);
            let body = shortened(&start.body);
            complaints.add(key.clone(), format!("there is no body {body:?}{near}"));
        }
        check_start(complaints, &key, start);
    }
}

/// The contacts that a start is in are in clearances, by the names of these, each once; the clock is
/// a time, and what is remembered is named once.
fn check_open_contacts(complaints: &mut Complaints, description: &Description) {
    let start = KeyPath::new(["start"]);
    if let Some(clock) = &description.clock {
        complaints.require_finite(start.key("clock"), clock, "s");
    }
    let mut named = HashSet::new();
    for (k, (of, value)) in description.memories.iter().enumerate() {
        let key = start.key("memory").key((k + 1).to_string());
        complaints.require_finite(key.key("value"), value, "");
        if !named.insert(of) {
            complaints.add(key.key("of"), format!("names {of:?} twice"));
        }
    }
    let mut seen = HashSet::new();
    for (k, (joint, rate)) in description.contacts.iter().enumerate() {
        let key = start.key("contact").key((k + 1).to_string());
        complaints.require_finite(key.key("impact_rate"), rate, "m/s");
        let key = key.key("joint");
        let known = description.joints.iter().find(|known| known.name == *joint);
        let members: Vec<String> =
            description.joints.iter().flat_map(JointDescription::members).collect();
        if known.is_some_and(|known| known.clearance.is_none()) {
            complaints.add(key, format!("joint {joint:?} has no clearance to be in contact in"));
        } else if known.is_some() && !members.contains(joint) {
            let one = format!("{joint}_1");
            complaints.add(key, format!("joint {joint:?} touches in {one:?} and others: name one"));
        } else if !members.contains(joint) {
            check_joint_name(complaints, description, key, joint);
        } else if !seen.insert(joint) {
            complaints.add(key, format!("names joint {joint:?} twice"));
        }
    }
}

fn check_start(complaints: &mut Complaints, key: &KeyPath, start: &StartDescription) {
    let numbers = [
        ("x", &start.x, "m"),
        ("y", &start.y, "m"),
        ("angle", &start.angle, "rad"),
        ("velocity_x", &start.velocity_x, "m/s"),
        ("velocity_y", &start.velocity_y, "m/s"),
        ("angular_velocity", &start.angular_velocity, "rad/s"),
    ];
    for (name, number, unit) in &numbers {
        if let Some(number) = number {
            complaints.require_finite(key.key(*name), number, unit);
        }
    }
    if start.fixed && numbers.iter().all(|(_, number, _)| number.is_none()) {
        complaints
            .add(key.key("fixed"), "holds nothing: name a coordinate or a velocity beside it");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(literal: &str) -> Decimal {
        Decimal::new(literal).unwrap()
    }

    /// A body with a point at its mass centre.
    fn body(name: &str) -> BodyDescription {
        let centre = NamedPoint { name: "C".into(), at: [number("0"), number("0")] };
        BodyDescription {
            name: name.into(),
            mass: number("1"),
            inertia: number("1"),
            points: vec![centre],
        }
    }

    fn told(description: &Description) -> Vec<String> {
        check(description).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_body_that_no_joint_reaches_is_sound() {
        let free = Description { bodies: vec![body("_free1")], ..Description::default() };
        assert_eq!(told(&free), Vec::<String>::new());
    }

    #[test]
    fn whatever_stands_twice_is_told() {
        let mut twice =
            Description { bodies: vec![body("rod"), body("rod")], ..Default::default() };
        let point = twice.bodies[0].points[0].clone();
        twice.ground = vec![point.clone(), point];
        let start = StartDescription { body: "rod".into(), ..Default::default() };
        twice.start = vec![start.clone(), start];
        assert_eq!(
            told(&twice),
            [
                "ground.points.C: stands there twice",
                "bodies.rod: stands there twice",
                "start.rod: stands there twice"
            ]
        );
    }

    #[test]
    fn names_are_words() {
        for (name, right) in [
            ("A0", true),
            ("_", true),
            ("a_b", true),
            ("", false),
            ("0A", false),
            ("a-b", false),
            ("é", false),
        ] {
            assert_eq!(is_name(name), right, "{name:?}");
        }
    }
}
