//! What pictures of a mechanism need beside its points: the pitch circles of gear pairs, and where its loads
//! act.
//!
//! A gear pair says a ratio and no radii. These follow from the distance d of both axes on the carrier, with
//! the ratio ρ of the wheel's angle over the pinion's:
//! ```text
//! teeth outside, ρ < 0:   r_j = d / (1 − ρ),    r_i = −ρ r_j
//! teeth inside,  ρ > 0:   r_j = d / |1 − ρ|,    r_i = ρ r_j
//! ```

use super::{Description, JointDescription, LoadDescription};
use crate::joint::REVOLUTE;

/// A pitch circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheel<'a> {
    /// Name of the body that turns with it.
    pub body: &'a str,
    /// Its centre, among the points of that body.
    pub point: &'a str,
    /// Its radius (m).
    pub radius: f64,
    /// Whether its teeth are on its inner side.
    pub is_ring: bool,
}

/// The pitch circles of pinion and wheel of a gear pair; `None` of other joints, where an axis is not one
/// point of the carrier, and where both are the same.
pub fn wheels<'a>(
    description: &'a Description,
    joint: &'a JointDescription,
) -> Option<[Wheel<'a>; 2]> {
    if !joint.part.is("gear") {
        return None;
    }
    let [first, second] = joint.between();
    let carrier = joint.part.text("carrier");
    let pinion = axis(description, first, carrier)?;
    let wheel = axis(description, second, carrier)?;
    let distance = (wheel.at[0] - pinion.at[0]).hypot(wheel.at[1] - pinion.at[1]);
    let ratio: f64 = joint.part.number("ratio");
    let radius = distance / (1.0 - ratio).abs();
    if !(distance > 0.0 && radius.is_finite()) {
        return None;
    }
    let rings = [ratio > 1.0, ratio > 0.0 && ratio < 1.0];
    let radii = [ratio.abs() * radius, radius];
    let circle = |body, axis: Axis<'a>, side: usize| Wheel {
        body,
        point: axis.own,
        radius: radii[side],
        is_ring: rings[side],
    };
    Some([circle(first, pinion, 0), circle(second, wheel, 1)])
}

/// Where a body turns on its carrier.
struct Axis<'a> {
    /// Name of the point of its own.
    own: &'a str,
    /// The place on the carrier (m).
    at: [f64; 2],
}

/// The axis of a body on a carrier: a revolute joint with it, or with a point that the carrier turns about
/// as well.
fn axis<'a>(description: &'a Description, body: &str, carrier: &str) -> Option<Axis<'a>> {
    let hinge = |joint: &'a JointDescription| {
        let [one, other] = joint.between().map(|end| end.split_once('.'));
        (joint.part.kind().word == REVOLUTE).then_some([(one?, other?), (other?, one?)])
    };
    // each joint twice, from either side
    let hinges: Vec<_> = description.joints.iter().filter_map(hinge).flatten().collect();
    let on_body: Vec<_> = hinges.iter().filter(|((owner, _), _)| *owner == body).collect();
    let direct = on_body.iter().find(|(_, (other, _))| *other == carrier);
    let shared = || {
        on_body.iter().find_map(|(own, pin)| {
            let (on, _) = hinges.iter().find(|(on, other)| on.0 == carrier && other == pin)?;
            Some((own.1, on.1))
        })
    };
    let (own, on) = direct.map(|(own, on)| (own.1, on.1)).or_else(shared)?;
    let points = match description.bodies.iter().find(|known| known.name == carrier) {
        Some(body) => &body.points,
        None => &description.ground,
    };
    let at = &points.iter().find(|point| point.name == on)?.at;
    Some(Axis { own, at: [at[0].to_f64(), at[1].to_f64()] })
}

/// Where a load acts, in the direction in which it counts positive.
#[derive(Debug, Clone, PartialEq)]
pub enum Acting<'a> {
    /// A spring between two points.
    Spring {
        /// Its ends, each `body.point`.
        between: [&'a str; 2],
        /// Length without force (m).
        length: f64,
    },
    /// A force at a point.
    Force {
        /// The point, `body.point`.
        at: &'a str,
        /// Its direction, ...
        direction: [f64; 2],
        /// ... which turns with this body.
        frame: &'a str,
    },
    /// A torque, counter-clockwise, on one body, with its reaction on another.
    Torque {
        /// The body.
        body: &'a str,
        /// Where the reaction goes.
        on: &'a str,
    },
    /// A torsion spring from one body to another.
    Coil {
        /// The body that it turns.
        body: &'a str,
        /// Where it is held.
        on: &'a str,
    },
}

/// Where a load acts; `None` of those that act everywhere, or as a drive does.
pub fn acting<'a>(description: &'a Description, load: &'a LoadDescription) -> Option<Acting<'a>> {
    let part = &load.part;
    Some(match part.kind().word {
        "spring" => {
            Acting::Spring { between: part.pair("between"), length: part.number("free_length") }
        }
        "force" => {
            let at = part.text("at");
            let given = if part.get("force").is_some() { "force" } else { "direction" };
            let turns = part.text("frame") == "body";
            let body = at.split_once('.').map_or(at, |(body, _)| body);
            Acting::Force {
                at,
                direction: part.vector(given),
                frame: if turns { body } else { "ground" },
            }
        }
        "gas-force" => {
            let guide = description.joints.iter().find(|joint| joint.name == part.text("joint"))?;
            let [first, second] = guide.between();
            let push = part.number::<f64>("area").signum();
            Acting::Force {
                at: second,
                direction: guide.part.vector("axis").map(|x: f64| push * x),
                frame: first.split_once('.').map_or(first, |(body, _)| body),
            }
        }
        "torque" => Acting::Torque { body: part.text("body"), on: part.text("on") },
        "torsion-spring" => {
            let [on, body] = part.pair("between");
            Acting::Coil { body, on }
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Case, Changes};
    use std::path::Path;

    #[test]
    fn the_wheels_of_a_planetary_gear_have_radii_like_their_teeth() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/planetary-gear.toml");
        let case = Case::read(&path, &Changes::default()).unwrap();
        let found: Vec<Wheel> = (case.description.joints.iter())
            .filter_map(|joint| wheels(&case.description, joint))
            .flatten()
            .collect();
        // 20, 20 and 60 teeth; the axes of sun and planet are 0.04 m apart
        let expected = [
            ("sun", "O", 0.02, false),
            ("planet", "P", 0.02, false),
            ("planet", "P", 0.02, false),
            ("ring", "O", 0.06, true),
        ];
        assert_eq!(found.len(), 4);
        for (wheel, (body, point, radius, is_ring)) in found.iter().zip(expected) {
            assert_eq!((wheel.body, wheel.point, wheel.is_ring), (body, point, is_ring));
            assert!((wheel.radius - radius).abs() < 1e-15, "{wheel:?}");
        }
    }
}
