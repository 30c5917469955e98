//! Numbers that look like a slip of units.

use super::Note;
use crate::case::Case;
use crate::model::{BodyDescription, ClearanceDescription, Description, NamedPoint, Play};
use std::f64::consts::TAU;

/// The softest that metals, polymers and rubber are, and less (Pa).
const SOFTEST: f64 = 1e6;
/// The strongest field of gravity that anybody means (m/s²): more than Jupiter's.
const STRONGEST: f64 = 100.0;
/// The fastest drive that anybody means (revolutions a minute).
const FASTEST: f64 = 1e6;
/// Share of the shortest link from which on a clearance is of its order.
const OF_A_LINK: f64 = 0.1;
/// A bearing larger than this is large in any mechanism (m).
const LARGE_BEARING: f64 = 1.0;
/// Radius of gyration over the farthest point of a body, from which on it is too small, and over
/// the size of the mechanism, from which on it is too large.
const GYRATION: [f64; 2] = [3e-3, 10.0];

/// All such numbers of a case.
pub(super) fn notes(case: &Case) -> Vec<Note> {
    let mut notes = Vec::new();
    let description = &case.description;
    let size = size_of(description);
    notes.extend(description.bodies.iter().filter_map(|body| inertia(body, size)));
    for joint in &description.joints {
        if let Some(clearance) = &joint.clearance {
            let key = format!("joints.{}.clearance", joint.name);
            notes.extend(clearance_notes(&key, clearance, description));
        }
    }
    notes.extend(angles(description));
    notes.extend(loads(description));
    notes.extend(run(case));
    notes
}

/// Links: distances of the points of a body from each other (m), those of one place left out.
fn links(points: &[NamedPoint]) -> impl Iterator<Item = f64> {
    let pairs =
        points.iter().enumerate().flat_map(|(k, a)| points[..k].iter().map(move |b| (a, b)));
    let apart = |(a, b): (&NamedPoint, &NamedPoint)| {
        let along = |c: usize| a.at[c].to_f64() - b.at[c].to_f64();
        along(0).hypot(along(1))
    };
    pairs.map(apart).filter(|length| *length > 0.0)
}

/// An inertia that no body of this size has: larger than the whole mechanism's size explains, or
/// smaller than that of a body with these points.
fn inertia(body: &BodyDescription, size: f64) -> Option<Note> {
    let reach = |point: &NamedPoint| point.at[0].to_f64().hypot(point.at[1].to_f64());
    let farthest = body.points.iter().map(reach).fold(0.0, f64::max);
    let gyration = (body.inertia.to_f64() / body.mass.to_f64()).sqrt();
    let [least, most] = GYRATION;
    let large = size > 0.0 && gyration > most * size.max(farthest);
    if !large && gyration >= least * farthest {
        return None;
    }
    let beside = if large { size.max(farthest) } else { farthest };
    let text = format!(
        "{} kg m² with a mass of {} kg is a radius of gyration of {gyration:.3e} m, beside lengths \
         of {beside:.3e} m: is it in kg m²?",
        body.inertia, body.mass
    );
    Some(Note::new(format!("bodies.{}.inertia", body.name), text))
}

/// The longest link or the largest bearing (m).
fn size_of(description: &Description) -> f64 {
    let links = description.bodies.iter().flat_map(|body| links(&body.points));
    let clearances = description.joints.iter().filter_map(|joint| joint.clearance.as_ref());
    let holes = clearances.map(|clearance| largest(&clearance.play).1);
    links.chain(holes).fold(0.0, f64::max)
}

/// The largest length (m) of what touches, and its key.
fn largest(play: &Play) -> (&'static str, f64) {
    match play {
        Play::Bearing { bearing_radius, .. } => ("bearing_radius", bearing_radius.to_f64()),
        Play::Guide { length, height, .. } if length.to_f64() < height.to_f64() => {
            ("height", height.to_f64())
        }
        Play::Guide { length, .. } => ("length", length.to_f64()),
        Play::Slot { pin_radius, .. } => ("pin_radius", pin_radius.to_f64()),
    }
}

fn clearance_notes(
    key: &str,
    clearance: &ClearanceDescription,
    description: &Description,
) -> Vec<Note> {
    let mut notes = Vec::new();
    let (large, radius) = largest(&clearance.play);
    let (play, radial) = clearance.play();
    let radial = radial.to_f64();
    let all = || description.bodies.iter().flat_map(|body| links(&body.points));
    let longest = all().fold(0.0, f64::max);
    let shortest = all().fold(f64::INFINITY, f64::min);
    if radius > LARGE_BEARING || (longest > 0.0 && radius > longest) {
        let beside = match longest > 0.0 {
            true => format!(", beside a longest link of {longest:.4} m"),
            false => String::new(),
        };
        let text = format!("{radius} m{beside}: is it in m, not in mm?");
        notes.push(Note::new(format!("{key}.{large}"), text));
    }
    if radial > OF_A_LINK * shortest {
        let text = format!(
            "{radial} m is of the order of a link: the shortest is {shortest:.4} m; is it in m?"
        );
        notes.push(Note::new(format!("{key}.{play}"), text));
    }
    let young = clearance.normal.elastic.of_materials::<f64>("young");
    if let Some(young) = young.into_iter().find(|young| *young < SOFTEST) {
        let text =
            format!("{young} Pa is softer than rubber; metals have 4e10 to 4e11 Pa (is it GPa?)");
        notes.push(Note::new(format!("{key}.normal.young"), text));
    }
    notes
}

/// Angles of more than a turn.
fn angles(description: &Description) -> Vec<Note> {
    let starts = description.start.iter().filter_map(|start| {
        let angle = start.angle.as_ref()?;
        Some((format!("start.{}.angle", start.body), angle.to_f64()))
    });
    let drives = description.drives.iter().filter_map(|drive| {
        let angle = drive.part.decimal("angle")?;
        Some((format!("drives.{}.angle", drive.name), angle.to_f64()))
    });
    let more = starts.chain(drives).filter(|(_, angle)| angle.abs() > 1.01 * TAU);
    let mut notes: Vec<Note> = more
        .map(|(key, angle)| {
            let text = format!(
                "{angle} rad is {:.2} turns; {angle} deg would be {:.6} rad",
                angle / TAU,
                angle.to_radians()
            );
            Note::new(key, text)
        })
        .collect();
    notes.extend(description.drives.iter().filter_map(|drive| {
        let speed = drive.part.decimal("speed_rpm")?.to_f64();
        (speed.abs() > FASTEST).then(|| {
            let text = format!("{speed:e} revolutions a minute is very fast");
            Note::new(format!("drives.{}.speed_rpm", drive.name), text)
        })
    }));
    notes
}

fn loads(description: &Description) -> Vec<Note> {
    let strong = description.loads.iter().filter_map(|load| {
        let [x, y] = load.gravity()?;
        let strength = x.hypot(y);
        (strength > STRONGEST).then(|| {
            let text = format!("{strength} m/s² is more than any gravity: is it in m/s²?");
            Note::new(format!("loads.{}.acceleration", load.name), text)
        })
    });
    strong.collect()
}

fn run(case: &Case) -> Option<Note> {
    let (duration, interval) = (&case.plan.duration, &case.plan.sample_interval);
    (duration.to_f64() < interval.to_f64()).then(|| {
        let text = format!(
            "{duration} s is shorter than the sample interval, {interval} s: only start and end \
             are sampled"
        );
        Note::new("run.duration", text)
    })
}
