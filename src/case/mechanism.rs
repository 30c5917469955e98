//! Case file to [`Description`]: which keys describe ground, bodies, joints, drives, loads, start.
//!
//! Joints, courses of drives, loads, elastic and friction laws say themselves which keys they take.

use super::table_reader::TableReader;
use crate::contact::{Damping, elastic, viscous};
use crate::model::{
    BodyDescription, ClearanceDescription, DampingDescription, Description, DriveDescription,
    JointDescription, Journals, LoadDescription, NamedPoint, NormalDescription, Play,
    StartDescription, Tension,
};
use crate::parameter::{Kind, Values};
use crate::scalar::Decimal;
use crate::{course, friction, joint, load};

const TENSIONS: [(&str, Tension); 2] = [("keep", Tension::Keep), ("cut", Tension::Cut)];

/// The mechanism that the root of a case describes.
pub(super) fn description(root: &mut TableReader) -> Description {
    let starts = |keys: &mut TableReader| {
        let given = (journals(keys), clock(keys), contacts(keys), memories(keys));
        (given, keys.other_tables(start))
    };
    let ((journals, clock, contacts, memories), start) =
        root.optional_table("start", starts).unwrap_or_default();
    Description {
        ground: root.optional_table("ground", points).unwrap_or_default(),
        bodies: root.named_tables("bodies", body),
        joints: root.named_tables("joints", joint).into_iter().flatten().collect(),
        drives: root.named_tables("drives", drive).into_iter().flatten().collect(),
        loads: root.named_tables("loads", load).into_iter().flatten().collect(),
        start,
        journals,
        clock,
        contacts,
        memories,
        observed: root.optional_table("observe", observed).unwrap_or_default(),
    }
}

/// The key of all starts: where journals are. A table of that name is the start of a body.
fn journals(keys: &mut TableReader) -> Journals {
    if keys.has_table("closed") {
        return Journals::Centred;
    }
    let flag = |closed| if closed { Journals::Touching } else { Journals::Centred };
    keys.flag_or_choice("closed", &[("pressed", Journals::Pressed)], flag).unwrap_or_default()
}

/// The time of courses at t = 0. A table of that name is the start of a body, here and below.
fn clock(keys: &mut TableReader) -> Option<Decimal> {
    if keys.has_table("clock") { None } else { keys.optional("clock", "s") }
}

/// Contacts that the start is in.
fn contacts(keys: &mut TableReader) -> Vec<(String, Decimal)> {
    if keys.has_table("contact") {
        return Vec::new();
    }
    let contact =
        |keys: &mut TableReader| (keys.required("joint", ""), keys.required("impact_rate", "m/s"));
    keys.list_of_tables("contact", contact)
}

/// What frictions and loads remember at the start.
fn memories(keys: &mut TableReader) -> Vec<(String, Decimal)> {
    if keys.has_table("memory") {
        return Vec::new();
    }
    let memory = |keys: &mut TableReader| (keys.required("of", ""), keys.required("value", ""));
    keys.list_of_tables("memory", memory)
}

/// The points that are observed.
fn observed(keys: &mut TableReader) -> Vec<String> {
    keys.required("points", "")
}

/// The points of a body or of the ground.
fn points(owner: &mut TableReader) -> Vec<NamedPoint> {
    let points = owner.named_values("points", "m").into_iter();
    points.map(|(name, at)| NamedPoint { name, at }).collect()
}

fn body(name: &str, keys: &mut TableReader) -> BodyDescription {
    BodyDescription {
        name: name.to_owned(),
        mass: keys.required("mass", "kg"),
        inertia: keys.required("inertia", "kg m²"),
        points: points(keys),
    }
}

fn joint(name: &str, keys: &mut TableReader) -> Option<JointDescription> {
    let part = keys.part("kind", joint::KINDS, None)?;
    let play = match part.kind().word {
        joint::REVOLUTE => Some(bearing as fn(&mut TableReader) -> Play),
        joint::PRISMATIC => Some(guide as _),
        joint::PIN_SLOT => Some(slot as _),
        _ => None,
    };
    let clearance =
        play.and_then(|play| keys.optional_table("clearance", |keys| clearance(keys, play)));
    Some(JointDescription { name: name.to_owned(), part, clearance })
}

fn bearing(keys: &mut TableReader) -> Play {
    Play::Bearing {
        bearing_radius: keys.required("bearing_radius", "m"),
        radial: keys.required("radial", "m"),
    }
}

fn guide(keys: &mut TableReader) -> Play {
    Play::Guide {
        gap: keys.required("gap", "m"),
        length: keys.required("length", "m"),
        height: keys.required("height", "m"),
        corner_radius: keys.optional("corner_radius", "m"),
    }
}

fn slot(keys: &mut TableReader) -> Play {
    Play::Slot { gap: keys.required("gap", "m"), pin_radius: keys.required("pin_radius", "m") }
}

fn clearance(keys: &mut TableReader, play: fn(&mut TableReader) -> Play) -> ClearanceDescription {
    ClearanceDescription {
        play: play(keys),
        normal: keys.table("normal", normal),
        tension: keys.choice("tension", &TENSIONS, Some("keep")).unwrap_or(Tension::Keep),
        minimum_impact_rate: keys.number_or("minimum_impact_rate", "m/s", "1e-3"),
        maximum_penetration: keys.number_or("maximum_penetration", "", "0.5"),
        friction: keys.optional_table("friction", friction).flatten(),
    }
}

/// What the word of a normal force stands for.
#[derive(Debug, Clone, Copy)]
enum Law {
    Weight(Damping),
    Viscous(&'static Kind),
}

fn normal(keys: &mut TableReader) -> NormalDescription {
    let weights = Damping::ALL.iter().map(|(word, law)| (*word, Law::Weight(*law)));
    let viscous = viscous::KINDS.iter().map(|kind| (kind.word, Law::Viscous(kind)));
    let laws: Vec<(&str, Law)> = weights.chain(viscous).collect();
    let chosen = keys.choice("law", &laws, None);
    let (mut restitution, mut achieved_restitution) = (None, None);
    let law = match chosen {
        Some(Law::Viscous(kind)) => Some(DampingDescription::Viscous(keys.values(kind))),
        chosen => {
            restitution = keys.optional("restitution", "");
            achieved_restitution = keys.optional("achieved_restitution", "");
            match chosen {
                Some(Law::Weight(damping)) => Some(DampingDescription::Weight(damping)),
                _ => None,
            }
        }
    };
    let elastic = keys.part("elastic", elastic::KINDS, Some(elastic::POWER.word));
    if law.is_none() || elastic.is_none() {
        keys.leave_unchecked(); // which other keys are wanted hangs on these two
    }
    NormalDescription {
        law: law.unwrap_or(DampingDescription::Weight(Damping::Hertz)),
        restitution,
        achieved_restitution,
        elastic: elastic.unwrap_or_else(|| Values::new(elastic::POWER)),
    }
}

fn friction(keys: &mut TableReader) -> Option<Values> {
    keys.part("law", friction::KINDS, None)
}

fn drive(name: &str, keys: &mut TableReader) -> Option<DriveDescription> {
    let joint = keys.required("joint", "");
    let part = keys.part("kind", course::KINDS, Some("speed"))?;
    Some(DriveDescription { name: name.to_owned(), joint, part })
}

fn load(name: &str, keys: &mut TableReader) -> Option<LoadDescription> {
    let part = keys.part("kind", load::KINDS, None)?;
    Some(LoadDescription { name: name.to_owned(), part })
}

fn start(body: &str, keys: &mut TableReader) -> StartDescription {
    StartDescription {
        body: body.to_owned(),
        x: keys.optional("x", "m"),
        y: keys.optional("y", "m"),
        angle: keys.optional("angle", "rad"),
        velocity_x: keys.optional("velocity_x", "m/s"),
        velocity_y: keys.optional("velocity_y", "m/s"),
        angular_velocity: keys.optional("angular_velocity", "rad/s"),
        fixed: keys.optional("fixed", "").unwrap_or(false),
    }
}
