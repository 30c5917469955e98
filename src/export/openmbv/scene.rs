//! The scene: what the bodies look like, as OpenMBV's XML.

use super::super::Error;
use crate::model::picture::{Acting, acting, wheels};
use crate::model::{Description, JointDescription, NamedPoint, Play};
use crate::record::ResultFile;
use std::f64::consts::TAU;
use std::fmt::Write;

/// From one layer of bodies to the next, over the thickness of a body.
const LAYER: f64 = 1.1;

/// Length of a guide, a slot or a rack, over that of the largest body.
const GUIDE: f64 = 1.2;
/// Coils of a spring.
const COILS: f64 = 6.0;
/// Turns of a torsion spring.
const TURNS: f64 = 2.5;
/// Length of the arrow of a load, whatever its own, over that of the largest body.
const LOAD: f64 = 0.2;

/// Corners of a circle.
const CORNERS: usize = 48;

/// The things of a scene and their shapes.
pub(super) struct Scene {
    /// The ground, then the bodies of the file.
    pub bodies: Vec<Body>,
    /// One a joint.
    pub arrows: Vec<Arrow>,
    /// Springs between points.
    pub springs: Vec<Spring>,
    /// Forces and torques that act from outside, of one size whatever their own.
    pub loads: Vec<Load>,
    /// Half the width of a bar (m).
    half_width: f64,
    /// Length of an arrow by force (m/N).
    arrow_scale: f64,
}

/// A body and its shapes, in its own frame.
pub(super) struct Body {
    /// Its name.
    pub name: String,
    /// Its index in the file; `None` for the ground.
    pub index: Option<usize>,
    shapes: Vec<Shape>,
}

/// The arrow of a joint's force.
pub(super) struct Arrow {
    /// Name of the joint.
    pub name: String,
    /// Index of the joint in the file.
    pub joint: usize,
    /// The joint's point on its second body.
    pub at: PointOnBody,
}

/// A spring between two points.
pub(super) struct Spring {
    /// Name of the load.
    pub name: String,
    /// Its ends.
    pub between: [PointOnBody; 2],
    /// Length without force (m).
    length: f64,
}

/// The arrow of a force or a torque that acts on a body, in the direction in which it counts positive.
pub(super) struct Load {
    /// Name of the load.
    pub name: String,
    /// Where it acts.
    pub at: PointOnBody,
    /// The arrow (m), ...
    pub arrow: [f64; 3],
    /// ... in the frame of this body; `None` for the ground.
    pub frame: Option<usize>,
}

/// A point that moves with a body.
#[derive(Clone, Copy)]
pub(super) struct PointOnBody {
    /// Index of the body in the file; `None` for the ground.
    pub body: Option<usize>,
    /// Where it is, in the body's frame (m).
    pub point: [f64; 2],
}

/// A prism over an outline.
struct Shape {
    name: String,
    outlines: Vec<Vec<[f64; 2]>>,
}

impl Scene {
    /// The scene of a case, whose largest force the file tells.
    pub fn of(description: &Description, file: &ResultFile) -> Result<Scene, Error> {
        let points =
            description.bodies.iter().map(|body| &body.points).chain([&description.ground]);
        let extent = points.map(|points| spread(points)).fold(0.0, f64::max);
        let extent = if extent > 0.0 { extent } else { 0.1 };
        let half_width = 0.02 * extent;
        let body = |name: &str, index: Option<usize>, points: &[NamedPoint]| Body {
            name: name.to_owned(),
            index,
            shapes: bars(points, half_width)
                .into_iter()
                .chain(eyes(description, name, points, half_width))
                .chain(fittings(description, name, points, half_width, 0.5 * GUIDE * extent))
                .chain(gears(description, name, points, half_width))
                .chain(coils(description, name, half_width))
                .collect(),
        };
        let mut bodies = vec![body("ground", None, &description.ground)];
        for (index, name) in file.bodies().iter().enumerate() {
            let found = description.bodies.iter().find(|body| body.name == *name);
            let points = found.map_or(&[][..], |found| &found.points);
            bodies.push(body(name, Some(index), points));
        }
        let arrows = file.joints().iter().enumerate();
        let largest = largest_force(file)?;
        Ok(Scene {
            arrows: arrows
                .filter_map(|(joint, name)| arrow(description, file, joint, name))
                .collect(),
            springs: springs(description, file),
            loads: loads(description, file, LOAD * extent),
            bodies,
            half_width,
            arrow_scale: if largest > 0.0 { extent / largest } else { 1.0 },
        })
    }

    /// Height above all bodies (m), where the arrows are.
    pub fn top(&self) -> f64 {
        LAYER * self.half_width * self.bodies.len() as f64
    }

    /// How many things move.
    pub fn things(&self) -> usize {
        self.bodies.len() + self.arrows.len() + self.springs.len() + self.loads.len()
    }

    /// The scene as XML.
    pub fn to_xml(&self, name: &str) -> String {
        let mut xml = Xml::default();
        xml.line("<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
        let namespace = "http://www.mbsim-env.de/OpenMBV";
        xml.open("Group", &format!("name=\"{}\" xmlns=\"{namespace}\"", escaped(name)));
        xml.open("Group", "name=\"bodies\"");
        for (k, body) in self.bodies.iter().enumerate() {
            self.body(&mut xml, k, body);
        }
        xml.close();
        if !self.springs.is_empty() {
            xml.open("Group", "name=\"springs\"");
            for spring in &self.springs {
                self.spring(&mut xml, spring);
            }
            xml.close();
        }
        xml.open("Group", "name=\"forces\"");
        for arrow in &self.arrows {
            self.arrow(&mut xml, &arrow.name, FORCE, "'toHead'", self.arrow_scale);
        }
        xml.close();
        if !self.loads.is_empty() {
            xml.open("Group", "name=\"loads\"");
            for load in &self.loads {
                // a torque along the axis that it turns about has two heads
                let kind = if load.arrow[2] == 0.0 { "'toHead'" } else { "'toDoubleHead'" };
                self.arrow(&mut xml, &load.name, LOADED, kind, 1.0);
            }
            xml.close();
        }
        xml.close();
        xml.text
    }

    fn body(&self, xml: &mut Xml, layer: usize, body: &Body) {
        xml.open("CompoundRigidBody", &format!("name=\"{}\"", escaped(&body.name)));
        // hue, saturation, value: the ground grey, the bodies round the wheel
        let hue = (layer as f64 * 0.381_966) % 1.0;
        let colour = if body.index.is_some() { [hue, 0.6, 0.9] } else { [0.0, 0.0, 0.5] };
        xml.vector("diffuseColor", &colour);
        xml.vector("initialTranslation", &[0.0; 3]);
        xml.vector("initialRotation", &[0.0; 3]);
        xml.number("scaleFactor", 1.0);
        for shape in &body.shapes {
            xml.open("Extrusion", &format!("name=\"{}\"", escaped(&shape.name)));
            xml.vector("initialTranslation", &[0.0, 0.0, LAYER * self.half_width * layer as f64]);
            xml.vector("initialRotation", &[0.0; 3]);
            xml.number("scaleFactor", 1.0);
            xml.element("windingRule", "'odd'");
            xml.number("height", self.half_width);
            for outline in &shape.outlines {
                let corners = outline.iter().map(|[x, y]| format!("{x:.9}, {y:.9}, 0"));
                let corners: Vec<String> = corners.collect();
                xml.element("contour", &format!("[{}]", corners.join("; ")));
            }
            xml.close();
        }
        xml.close();
    }

    fn spring(&self, xml: &mut Xml, spring: &Spring) {
        xml.open("CoilSpring", &format!("name=\"{}\"", escaped(&spring.name)));
        xml.vector("diffuseColor", &[0.6, 0.5, 0.7]);
        xml.element("type", "'tube'");
        xml.number("numberOfCoils", COILS);
        xml.number("springRadius", 0.8 * self.half_width);
        xml.number("crossSectionRadius", 0.15 * self.half_width);
        xml.number("nominalLength", spring.length);
        xml.number("scaleFactor", 1.0);
        xml.close();
    }

    fn arrow(&self, xml: &mut Xml, name: &str, colour: [f64; 3], kind: &str, scale: f64) {
        xml.open("Arrow", &format!("name=\"{}\"", escaped(name)));
        xml.vector("diffuseColor", &colour);
        xml.number("diameter", 0.4 * self.half_width);
        xml.number("headDiameter", self.half_width);
        xml.number("headLength", 1.5 * self.half_width);
        xml.element("type", kind);
        xml.element("referencePoint", "'toPoint'");
        xml.number("scaleLength", scale);
        xml.close();
    }
}

/// Colours of the forces of joints and of loads: hue, saturation, value.
const FORCE: [f64; 3] = [0.0, 1.0, 0.8];
const LOADED: [f64; 3] = [0.12, 1.0, 0.9];

/// XML as it is written, indented by the elements that are open.
#[derive(Default)]
struct Xml {
    text: String,
    open: Vec<&'static str>,
}

impl Xml {
    fn line(&mut self, line: &str) {
        let indent = "  ".repeat(self.open.len());
        self.text.push_str(&format!("{indent}{line}\n"));
    }

    fn open(&mut self, name: &'static str, attributes: &str) {
        self.line(&format!("<{name} {attributes}>"));
        self.open.push(name);
    }

    fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            self.line(&format!("</{name}>"));
        }
    }

    fn element(&mut self, name: &str, text: &str) {
        self.line(&format!("<{name}>{text}</{name}>"));
    }

    fn number(&mut self, name: &str, value: f64) {
        self.element(name, &format!("{value:?}"));
    }

    fn vector(&mut self, name: &str, values: &[f64]) {
        let mut text = String::from("[");
        for (k, value) in values.iter().enumerate() {
            let separator = if k == 0 { "" } else { ";" };
            let _ = write!(text, "{separator}{value:?}");
        }
        self.element(name, &(text + "]"));
    }
}

fn place(point: &NamedPoint) -> [f64; 2] {
    [point.at[0].to_f64(), point.at[1].to_f64()]
}

/// Largest distance of two points (m).
fn spread(points: &[NamedPoint]) -> f64 {
    let pairs = points.iter().flat_map(|a| points.iter().map(move |b| (place(a), place(b))));
    pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
}

/// Bars from each point to the next, back to the first where there are more than two.
fn bars(points: &[NamedPoint], half_width: f64) -> Vec<Shape> {
    let last = if points.len() > 2 { points.len() } else { points.len().saturating_sub(1) };
    let bar = |k: usize| {
        let (a, b) = (&points[k], &points[(k + 1) % points.len()]);
        let name = format!("bar_{}_{}", a.name, b.name);
        let (a, b) = (place(a), place(b));
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let across = [-(b[1] - a[1]) / length * half_width, (b[0] - a[0]) / length * half_width];
        let corner = |[x, y]: [f64; 2], sign: f64| [x + sign * across[0], y + sign * across[1]];
        let outline = vec![corner(a, -1.0), corner(b, -1.0), corner(b, 1.0), corner(a, 1.0)];
        (length > 0.0).then(|| Shape { name, outlines: vec![outline] })
    };
    (0..last).filter_map(bar).collect()
}

/// What sits at the points of a body: bearings, journals, plain eyes.
fn eyes(
    description: &Description,
    body: &str,
    points: &[NamedPoint],
    half_width: f64,
) -> Vec<Shape> {
    let eye = |point: &NamedPoint| {
        let centre = place(point);
        let here = format!("{body}.{}", point.name);
        let clearance = description.joints.iter().find_map(|joint| {
            let side = joint.between().iter().position(|end| *end == here)?;
            Some((side, &joint.clearance.as_ref()?.play))
        });
        let (name, radii) = match clearance {
            None => (format!("eye_{}", point.name), vec![1.4 * half_width]),
            Some((side, play)) => match (play, side) {
                (Play::Bearing { bearing_radius, .. }, 0) => {
                    let inner = bearing_radius.to_f64();
                    (format!("bearing_{}", point.name), vec![inner + half_width, inner])
                }
                (Play::Bearing { bearing_radius, radial }, _) => {
                    let radius = bearing_radius.to_f64() - radial.to_f64();
                    (format!("journal_{}", point.name), vec![radius])
                }
                (Play::Slot { pin_radius, .. }, 1) => {
                    (format!("pin_{}", point.name), vec![pin_radius.to_f64()])
                }
                _ => (format!("eye_{}", point.name), vec![1.4 * half_width]),
            },
        };
        Shape { name, outlines: radii.into_iter().map(|radius| circle(centre, radius)).collect() }
    };
    points.iter().map(eye).collect()
}

fn circle([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let angle = |k: usize| TAU * k as f64 / CORNERS as f64;
    (0..CORNERS).map(|k| [x + radius * angle(k).cos(), y + radius * angle(k).sin()]).collect()
}

/// What the straight joints of a body need: the walls of guides and slots and the racks of its own, blocks
/// that slide in those of others and pinions that roll on theirs. Walls and racks are `reach` (m) long to
/// either side of their point.
fn fittings(
    description: &Description,
    body: &str,
    points: &[NamedPoint],
    half_width: f64,
    reach: f64,
) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for joint in &description.joints {
        if joint.part.get("axis").is_none() {
            continue;
        }
        for (side, end) in joint.between().into_iter().enumerate() {
            let Some((owner, point)) = end.split_once('.') else { continue };
            let at = points.iter().find(|known| owner == body && known.name == point);
            let Some(at) = at.map(place) else { continue };
            match side {
                0 => shapes.extend(walls(joint, at, half_width, reach)),
                _ => shapes.extend(slider(joint, at, half_width)),
            }
        }
    }
    shapes
}

/// The walls on either side of a line through a point, or the rack beside it.
fn walls(joint: &JointDescription, at: [f64; 2], half_width: f64, reach: f64) -> Vec<Shape> {
    let thick = 0.4 * half_width;
    let bar = |name: String, across: f64| {
        let middle = across + 0.5 * thick * across.signum();
        let outline = rectangle(at, joint.part.vector("axis"), [0.0, middle], [reach, 0.5 * thick]);
        Shape { name, outlines: vec![outline] }
    };
    if joint.part.is("rack") {
        return vec![bar(format!("rack_{}", joint.name), joint.part.number("radius"))];
    }
    let play = joint.clearance.as_ref().map(|clearance| &clearance.play);
    let beside = match play {
        Some(Play::Guide { gap, height, .. }) => 0.5 * height.to_f64() + gap.to_f64(),
        Some(Play::Slot { gap, pin_radius }) => pin_radius.to_f64() + gap.to_f64(),
        _ => 1.4 * half_width,
    };
    vec![
        bar(format!("wall_1_{}", joint.name), beside),
        bar(format!("wall_2_{}", joint.name), -beside),
    ]
}

/// What slides between walls or rolls on a rack, unless it is a pin, which stands among the eyes.
fn slider(joint: &JointDescription, at: [f64; 2], half_width: f64) -> Option<Shape> {
    if joint.part.is("rack") {
        let radius: f64 = joint.part.number("radius");
        let name = format!("pinion_{}", joint.name);
        let radius = radius.abs();
        let outlines =
            vec![circle(at, radius), circle(at, (radius - 0.5 * half_width).max(0.5 * radius))];
        return Some(Shape { name, outlines });
    }
    if !joint.part.is("prismatic") {
        return None;
    }
    let size = match joint.clearance.as_ref().map(|clearance| &clearance.play) {
        Some(Play::Guide { length, height, .. }) => [length.to_f64(), height.to_f64()],
        _ => [4.0 * half_width, 2.8 * half_width],
    };
    // the axis as the second body sees it
    let (sin, cos) = joint.part.number::<f64>("angle").sin_cos();
    let [x, y]: [f64; 2] = joint.part.vector("axis");
    let axis = [cos * x + sin * y, cos * y - sin * x];
    let outline = rectangle(at, axis, [0.0; 2], size.map(|size| 0.5 * size));
    Some(Shape { name: format!("block_{}", joint.name), outlines: vec![outline] })
}

/// A rectangle by its middle, along an axis and across it from a point (m), and its half lengths (m).
fn rectangle(
    [x, y]: [f64; 2],
    [u, v]: [f64; 2],
    [along, across]: [f64; 2],
    [half, half_across]: [f64; 2],
) -> Vec<[f64; 2]> {
    let length = u.hypot(v);
    let (u, v) = (u / length, v / length);
    let corner = |[i, j]: [f64; 2]| {
        let (a, b) = (along + i * half, across + j * half_across);
        [x + a * u - b * v, y + a * v + b * u]
    };
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).to_vec()
}

fn arrow(description: &Description, file: &ResultFile, joint: usize, name: &str) -> Option<Arrow> {
    let found = description.joints.iter().find(|joint| joint.name == name)?;
    let at = point_on_body(description, file, found.between()[1])?;
    Some(Arrow { name: name.to_owned(), joint, at })
}

fn springs(description: &Description, file: &ResultFile) -> Vec<Spring> {
    let drawn = description.loads.iter().filter_map(|load| {
        let Acting::Spring { between: [first, second], length } = acting(description, load)? else {
            return None;
        };
        let between =
            [point_on_body(description, file, first)?, point_on_body(description, file, second)?];
        Some(Spring { name: load.name.clone(), between, length })
    });
    drawn.collect()
}

/// The forces and torques from outside, as arrows of this length (m).
fn loads(description: &Description, file: &ResultFile, length: f64) -> Vec<Load> {
    let index = |body: &str| file.bodies().iter().position(|known| known == body);
    let drawn = description.loads.iter().filter_map(|load| {
        let (at, arrow, frame) = match acting(description, load)? {
            Acting::Force { at, direction: [x, y], frame } => {
                let size = length / x.hypot(y);
                (point_on_body(description, file, at)?, [size * x, size * y, 0.0], index(frame))
            }
            Acting::Torque { body, on } => {
                let body = index(body).or_else(|| index(on));
                (PointOnBody { body, point: [0.0; 2] }, [0.0, 0.0, length], None)
            }
            Acting::Spring { .. } | Acting::Coil { .. } => return None,
        };
        Some(Load { name: load.name.clone(), at, arrow, frame })
    });
    drawn.collect()
}

/// The rims of the gear wheels on a body.
fn gears(
    description: &Description,
    body: &str,
    points: &[NamedPoint],
    half_width: f64,
) -> Vec<Shape> {
    let pairs = description.joints.iter().filter_map(|joint| {
        let pair = wheels(description, joint)?;
        Some(pair.into_iter().map(|wheel| (joint.name.as_str(), wheel)))
    });
    let own = pairs.flatten().filter(|(_, wheel)| wheel.body == body);
    let shape = own.filter_map(|(joint, wheel)| {
        let centre = place(points.iter().find(|known| known.name == wheel.point)?);
        let pitch = wheel.radius;
        let rim = match wheel.is_ring {
            true => pitch + half_width,
            false => (pitch - half_width).max(0.5 * pitch),
        };
        let outlines = vec![circle(centre, pitch.max(rim)), circle(centre, pitch.min(rim))];
        Some(Shape { name: format!("gear_{joint}"), outlines })
    });
    shape.collect()
}

/// The torsion springs about the mass centre of a body.
fn coils(description: &Description, body: &str, half_width: f64) -> Vec<Shape> {
    let own = description.loads.iter().filter(|load| match acting(description, load) {
        Some(Acting::Coil { body: turned, on }) => {
            turned == body || turned == "ground" && on == body
        }
        Some(Acting::Spring { .. } | Acting::Force { .. } | Acting::Torque { .. }) | None => false,
    });
    own.map(|load| Shape {
        name: format!("coil_{}", load.name),
        outlines: vec![spiral(half_width, 4.0 * half_width, 0.2 * half_width)],
    })
    .collect()
}

/// A band along a spiral about the origin, from one radius to another (m).
fn spiral(from: f64, to: f64, width: f64) -> Vec<[f64; 2]> {
    let count = (TURNS * CORNERS as f64) as usize;
    let along = |offset: f64| {
        (0..=count).map(move |k| {
            let part = k as f64 / count as f64;
            let (sin, cos) = (TAU * TURNS * part).sin_cos();
            let radius = from + (to - from) * part + offset;
            [radius * cos, radius * sin]
        })
    };
    let back: Vec<_> = along(-0.5 * width).collect();
    along(0.5 * width).chain(back.into_iter().rev()).collect()
}

/// A point written `body.point`.
fn point_on_body(
    description: &Description,
    file: &ResultFile,
    written: &str,
) -> Option<PointOnBody> {
    let (body, point) = written.split_once('.')?;
    let index = file.bodies().iter().position(|known| known == body);
    let points = match description.bodies.iter().find(|known| known.name == body) {
        Some(body) => &body.points,
        None => &description.ground,
    };
    let point = place(points.iter().find(|known| known.name == point)?);
    Some(PointOnBody { body: index, point })
}

/// The largest force of any joint at a sample (N).
fn largest_force(file: &ResultFile) -> Result<f64, Error> {
    let (x, y) = (file.table("joint_force_x")?, file.table("joint_force_y")?);
    let forces = x.values.iter().zip(&y.values).map(|(x, y)| x.hypot(*y));
    Ok(forces.filter(|force| force.is_finite()).fold(0.0, f64::max))
}

/// Text as it stands between the quotes of an attribute.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // XML has no way to write the others
            c if c.is_control() => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn a_name_cannot_leave_its_attribute() {
        assert_eq!(escaped("a\" b=\"<&>\n"), "a&quot; b=&quot;&lt;&amp;&gt;\u{fffd}");
    }
}
