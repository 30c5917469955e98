//! Random mechanisms as case texts. A number of a mechanism and the seed of a campaign make the
//! same text everywhere.

use fastrand::Rng;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// A mechanism: what its kind is called, and its case without `[solver]`.
pub struct Drawn {
    pub kind: &'static str,
    pub text: String,
    /// Friction of each clearance, in the order of the file.
    pub frictions: Vec<Option<Friction>>,
}

/// Ambrósio's law as drawn.
#[derive(Clone, Copy)]
pub struct Friction {
    pub coefficient: f64,
    /// Edges of the ramp (m/s).
    pub v0: f64,
    pub v1: f64,
}

/// Longest time simulated (s): of what does not turn.
const LONGEST: f64 = 0.06;
const MOST_RPM: f64 = 30_000.0;

/// Writes a mechanism of one kind.
type Write = fn(&mut Draft);

const KINDS: [(&str, Write); 15] = [
    ("four-bar", four_bar),
    ("six-bar", six_bar),
    ("chain", chain),
    ("double pendulum", double_pendulum),
    ("crank on crank", crank_on_crank),
    ("rod on crank", rod_on_crank),
    ("free rotor", free_rotor),
    ("dropped disc", dropped_disc),
    ("shaft in ring", shaft_in_ring),
    ("ring and disc", ring_and_disc),
    ("loose motor", loose_motor),
    ("rotor in two bearings", rotor_in_two_bearings),
    ("block in guide", block_in_guide),
    ("slider-crank", slider_crank),
    ("swinging guide", swinging_guide),
];

/// Mechanism `number` of the campaign with a seed.
pub fn draw(seed: u64, number: u64) -> Drawn {
    let (kind, write) = KINDS[(number % KINDS.len() as u64) as usize];
    let mut draft = Draft::new(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ number);
    write(&mut draft);
    draft.finish(kind)
}

/// A case text in the making.
struct Draft {
    rng: Rng,
    points: Vec<String>,
    bodies: String,
    joints: String,
    drives: String,
    starts: Vec<String>,
    frictions: Vec<Option<Friction>>,
    /// Fastest rate (rad/s) of any drive or start.
    fastest: f64,
    gravity: bool,
}

impl Draft {
    fn new(seed: u64) -> Self {
        let mut rng = Rng::with_seed(seed);
        let gravity = rng.bool();
        Draft {
            rng,
            points: Vec::new(),
            bodies: String::new(),
            joints: String::new(),
            drives: String::new(),
            starts: Vec::new(),
            frictions: Vec::new(),
            fastest: 0.0,
            gravity,
        }
    }

    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.rng.f64()
    }

    /// Even in the logarithm.
    fn log(&mut self, from: f64, to: f64) -> f64 {
        self.between(from.ln(), to.ln()).exp()
    }

    fn chance(&mut self, share: f64) -> bool {
        self.rng.f64() < share
    }

    fn sign(&mut self) -> f64 {
        if self.rng.bool() { 1.0 } else { -1.0 }
    }

    fn angle(&mut self) -> f64 {
        self.between(-0.5 * TAU, 0.5 * TAU)
    }

    fn ground(&mut self, name: &str, at: [f64; 2]) {
        self.points.push(format!("{name} = [{:.6e}, {:.6e}]", at[0], at[1]));
    }

    /// A body with points in its frame.
    fn body(&mut self, name: &str, mass: f64, inertia: f64, points: &[(&str, [f64; 2])]) {
        let points: Vec<String> =
            points.iter().map(|(name, [x, y])| format!("{name} = [{x:.6e}, {y:.6e}]")).collect();
        let points = points.join(", ");
        let _ = write!(
            self.bodies,
            "[bodies.{name}]\nmass = {mass:.6e}\ninertia = {inertia:.6e}\npoints = {{ {points} }}\n\n"
        );
    }

    /// A rod of a length, its mass centre beside the middle, between two of its points.
    fn rod(&mut self, name: &str, length: f64, from: &str, to: &str) {
        let mass = self.log(0.01, 1.0);
        let inertia = mass * length * length / 12.0 * self.between(0.5, 2.0);
        let centre = self.between(0.3, 0.7) * length;
        self.body(name, mass, inertia, &[(from, [-centre, 0.0]), (to, [length - centre, 0.0])]);
    }

    fn joint(&mut self, name: &str, first: &str, second: &str) {
        let _ = write!(
            self.joints,
            "[joints.{name}]\nkind = \"revolute\"\nbetween = [\"{first}\", \"{second}\"]\n\n"
        );
    }

    /// A joint with clearance; returns c (m).
    fn loose(&mut self, name: &str, first: &str, second: &str) -> f64 {
        self.joint(name, first, second);
        let c = self.log(1e-6, 5e-3);
        let radius = self.between(5e-3, 15e-3).max(1.5 * c);
        self.contacts(name, &format!("bearing_radius = {radius:.6e}\nradial = {c:.6e}"), 1);
        c
    }

    /// A block of this length and height (m) in a guide along `axis`, with play; returns that (m).
    fn guide(
        &mut self,
        name: &str,
        first: &str,
        second: &str,
        axis: [f64; 2],
        size: [f64; 2],
    ) -> f64 {
        let gap = self.log(1e-6, 1e-3);
        let [x, y] = axis;
        let _ = write!(
            self.joints,
            "[joints.{name}]\nkind = \"prismatic\"\nbetween = [\"{first}\", \"{second}\"]\n\
             axis = [{x:.6}, {y:.6}]\n\n"
        );
        let [length, height] = size;
        let block = format!(
            "gap = {gap:.6e}\nlength = {length:.6e}\nheight = {height:.6e}\ncorner_radius = 0.001"
        );
        self.contacts(name, &block, 4);
        gap
    }

    /// A pin in a slot along `axis`, with play.
    fn slot(&mut self, name: &str, first: &str, second: &str, axis: [f64; 2]) {
        let (gap, radius) = (self.log(1e-6, 1e-3), self.log(2e-3, 1e-2));
        let [x, y] = axis;
        let _ = write!(
            self.joints,
            "[joints.{name}]\nkind = \"pin-slot\"\nbetween = [\"{first}\", \"{second}\"]\n\
             axis = [{x:.6}, {y:.6}]\n\n"
        );
        self.contacts(name, &format!("gap = {gap:.6e}\npin_radius = {radius:.6e}"), 2);
    }

    /// What happens in the contacts of a joint with play.
    fn contacts(&mut self, name: &str, play: &str, count: usize) {
        let stiffness = match self.chance(0.3) {
            true => "\"hertz-printed\", young = 207e9, poisson = 0.3".to_owned(),
            false => format!("{:.4e}", self.log(1e7, 1e12)),
        };
        let law = match self.chance(0.2) {
            true => "law = \"hertz\"".to_owned(),
            false => {
                let restitution = self.between(0.05, 1.0);
                format!("law = \"lankarani-nikravesh\", restitution = {restitution:.3}")
            }
        };
        let exponent = match self.chance(0.1) {
            true => format!(", exponent = {:.2}", self.between(1.1, 2.0)),
            false => String::new(),
        };
        let _ = write!(
            self.joints,
            "[joints.{name}.clearance]\n{play}\n\
             normal = {{ {law}, stiffness = {stiffness}{exponent} }}\n"
        );
        let friction = self.chance(0.5).then(|| self.friction());
        if let Some(Friction { coefficient, v0, v1 }) = friction {
            let _ = writeln!(
                self.joints,
                "friction = {{ law = \"ambrosio\", coefficient = {coefficient:e}, v0 = {v0:e}, v1 = {v1:e} }}"
            );
        }
        if self.chance(0.2) {
            self.joints.push_str("tension = \"cut\"\n");
        }
        self.joints.push('\n');
        self.frictions.extend(std::iter::repeat_n(friction, count));
    }

    fn friction(&mut self) -> Friction {
        let coefficient = self.log(0.01, 0.5);
        let v0 = if self.chance(0.3) { 0.0 } else { self.log(1e-4, 1e-2) };
        let v1 = v0 + self.log(1e-3, 0.1);
        // as the case will have them
        let [coefficient, v0, v1] =
            [coefficient, v0, v1].map(|x| format!("{x:.4e}").parse().expect("a number"));
        Friction { coefficient, v0, v1 }
    }

    /// Of these joints (name, first, second) one to three at random are loose; returns the
    /// clearances (m).
    fn some_loose(&mut self, joints: &[(&str, &str, &str)], most: usize) -> Vec<f64> {
        let mut order: Vec<usize> = (0..joints.len()).collect();
        self.rng.shuffle(&mut order);
        let count = self.rng.usize(1..=most.min(joints.len()));
        let mut clearances = Vec::new();
        for (place, (name, first, second)) in joints.iter().enumerate() {
            // either body may bear the other's journal
            let turned = self.rng.bool();
            let (first, second) = if turned { (second, first) } else { (first, second) };
            match order[..count].contains(&place) {
                true => clearances.push(self.loose(name, first, second)),
                false => self.joint(name, first, second),
            }
        }
        clearances
    }

    /// A speed (rpm) from none to thirty thousand, either way.
    fn speed(&mut self, most: f64) -> f64 {
        let rpm = if self.chance(0.05) { 0.0 } else { self.sign() * self.log(10.0, most) };
        self.fastest = self.fastest.max(rpm.abs() * TAU / 60.0);
        rpm
    }

    fn drive(&mut self, name: &str, joint: &str, angle: f64, most: f64) {
        let rpm = self.speed(most);
        let _ = write!(
            self.drives,
            "[drives.{name}]\njoint = \"{joint}\"\nspeed_rpm = {rpm:.4}\nangle = {angle:.6}\n\n"
        );
    }

    fn start(&mut self, body: &str, keys: &str) {
        self.starts.push(format!("{body} = {{ {keys} }}"));
    }

    /// A start that is fixed: place (m), angle, velocity (m/s) and rate (rad/s).
    fn fixed(&mut self, body: &str, at: [f64; 3], v: [f64; 3]) {
        self.fastest = self.fastest.max(v[2].abs());
        let [[x, y, angle], [vx, vy, rate]] = [at, v];
        self.start(
            body,
            &format!(
                "x = {x:.8e}, y = {y:.8e}, angle = {angle:.6}, velocity_x = {vx:.6e}, \
                 velocity_y = {vy:.6e}, angular_velocity = {rate:.6e}, fixed = true"
            ),
        );
    }

    /// A vector of a length in some direction.
    fn vector(&mut self, length: f64) -> [f64; 2] {
        let (sin, cos) = self.angle().sin_cos();
        [length * cos, length * sin]
    }

    fn finish(self, kind: &'static str) -> Drawn {
        let duration = match self.fastest > 0.0 {
            true => (3.0 * TAU / self.fastest).min(LONGEST),
            false => LONGEST,
        };
        let mut text = format!("# {kind}\n");
        if !self.points.is_empty() {
            let _ = write!(text, "[ground]\npoints = {{ {} }}\n\n", self.points.join(", "));
        }
        text += &self.bodies;
        text += &self.joints;
        text += &self.drives;
        if self.gravity {
            text += "[loads.gravity]\nkind = \"gravity\"\nacceleration = [0.0, -9.81]\n\n";
        }
        if !self.starts.is_empty() {
            let _ = write!(text, "[start]\n{}\n\n", self.starts.join("\n"));
        }
        let _ = write!(
            text,
            "[run]\nduration = {duration:.4e}\nsample_interval = {:.4e}\n\n\
             [solver]\nabsolute_tolerance = \"scaled\"\n",
            duration / 100.0
        );
        Drawn { kind, text, frictions: self.frictions }
    }
}

/// A crank-rocker by Grashof's rule, anywhere in its turn.
fn four_bar(draft: &mut Draft) {
    let size = draft.log(0.05, 0.5);
    let (crank, ground, coupler, rocker) = loop {
        let length = |draft: &mut Draft| draft.between(0.3, 1.0) * size;
        let [ground, coupler, rocker] = [length(draft), length(draft), length(draft)];
        let longest = ground.max(coupler).max(rocker);
        let room = ground + coupler + rocker - 2.0 * longest;
        let crank = draft.between(0.1, 0.8) * room;
        if room > 0.2 * size && crank > 0.02 * size && crank < 0.8 * ground.min(coupler).min(rocker)
        {
            break (crank, ground, coupler, rocker);
        }
    };
    let angle = draft.angle();
    let (sin, cos) = angle.sin_cos();
    let to_b0 = [ground - crank * cos, -crank * sin];
    let distance = to_b0[0].hypot(to_b0[1]);
    let along = (distance * distance + coupler * coupler - rocker * rocker) / (2.0 * distance);
    let beside = (coupler * coupler - along * along).max(0.0).sqrt() * draft.sign();
    let unit = to_b0.map(|x| x / distance);
    let b = [along * unit[0] - beside * unit[1], along * unit[1] + beside * unit[0]];
    let coupler_angle = b[1].atan2(b[0]);
    let rocker_angle = (b[1] - to_b0[1]).atan2(b[0] - to_b0[0]);
    draft.ground("A0", [0.0, 0.0]);
    draft.ground("B0", [ground, 0.0]);
    draft.rod("crank", crank, "A0", "A");
    draft.rod("coupler", coupler, "A", "B");
    draft.rod("rocker", rocker, "B0", "B");
    draft.joint("A0", "ground.A0", "crank.A0");
    draft.some_loose(
        &[
            ("A", "crank.A", "coupler.A"),
            ("B", "coupler.B", "rocker.B"),
            ("B0", "ground.B0", "rocker.B0"),
        ],
        3,
    );
    draft.drive("crank", "A0", angle, MOST_RPM);
    draft.start("coupler", &format!("angle = {coupler_angle:.6}"));
    draft.start("rocker", &format!("angle = {rocker_angle:.6}"));
}

/// Watt's six-bar of `tests/cases`, of another size and with other masses.
fn six_bar(draft: &mut Draft) {
    let size = draft.log(0.3, 3.0);
    let mut near = |x: f64, y: f64| [x, y].map(|x| size * (x * draft.between(0.98, 1.02)));
    let (b0, c0) = (near(0.2, 0.0), near(0.42, 0.02));
    let bodies = [
        ("crank", [("A0", near(-0.015, 0.0)), ("A", near(0.015, 0.0))].to_vec()),
        ("coupler", [("A", near(-0.09, 0.0)), ("B", near(0.09, 0.0))].to_vec()),
        (
            "rocker",
            [("B0", near(-0.06, 0.0)), ("B", near(0.06, 0.0)), ("D", near(0.03, -0.04))].to_vec(),
        ),
        ("link", [("D", near(-0.1, 0.0)), ("E", near(0.1, 0.0))].to_vec()),
        ("lever", [("E", near(0.05, 0.0)), ("C0", near(-0.05, 0.01))].to_vec()),
    ];
    draft.ground("A0", [0.0, 0.0]);
    draft.ground("B0", b0);
    draft.ground("C0", c0);
    for (name, points) in bodies {
        let mass = draft.log(0.02, 0.5);
        let inertia = mass * (0.05 * size).powi(2) * draft.between(0.5, 2.0);
        draft.body(name, mass, inertia, &points);
    }
    draft.joint("A0", "ground.A0", "crank.A0");
    draft.some_loose(
        &[
            ("A", "crank.A", "coupler.A"),
            ("B", "coupler.B", "rocker.B"),
            ("B0", "ground.B0", "rocker.B0"),
            ("D", "rocker.D", "link.D"),
            ("E", "lever.E", "link.E"),
            ("C0", "lever.C0", "ground.C0"),
        ],
        3,
    );
    draft.drive("crank", "A0", 0.0, 10_000.0);
    for (body, angle) in [("coupler", 0.7), ("rocker", 1.84), ("link", 0.0), ("lever", 1.7)] {
        draft.start(body, &format!("angle = {angle}"));
    }
}

/// Two to four rods in a row from the ground, each at some angle and rate.
fn chain(draft: &mut Draft) {
    let names = ["one", "two", "three", "four"];
    let count = draft.rng.usize(3..=4);
    hang(draft, &names[..count]);
}

fn double_pendulum(draft: &mut Draft) {
    hang(draft, &["upper", "lower"]);
}

fn hang(draft: &mut Draft, names: &[&str]) {
    draft.ground("P", [0.0, 0.0]);
    let still = draft.chance(0.4);
    for name in names {
        let length = draft.log(0.05, 0.5);
        draft.rod(name, length, "P", "Q");
        let angle = draft.angle();
        let rate = if still { 0.0 } else { draft.sign() * draft.log(0.1, 300.0) };
        draft.fastest = draft.fastest.max(rate.abs());
        draft.start(name, &format!("angle = {angle:.6}, angular_velocity = {rate:.4}"));
    }
    let ends: Vec<[String; 3]> = (0..names.len())
        .map(|k| {
            let before = if k == 0 { "ground.P".to_owned() } else { format!("{}.Q", names[k - 1]) };
            [format!("J{k}"), before, format!("{}.P", names[k])]
        })
        .collect();
    let joints: Vec<(&str, &str, &str)> =
        ends.iter().map(|[name, first, second]| (&**name, &**first, &**second)).collect();
    draft.some_loose(&joints, 3);
}

fn crank_on_crank(draft: &mut Draft) {
    draft.ground("O", [0.0, 0.0]);
    let lengths = [draft.log(0.02, 0.2), draft.log(0.01, 0.1), draft.log(0.02, 0.2)];
    draft.rod("first", lengths[0], "O", "P");
    draft.rod("second", lengths[1], "P", "Q");
    draft.rod("rod", lengths[2], "Q", "R");
    draft.joint("O", "ground.O", "first.O");
    draft.joint("P", "first.P", "second.P");
    draft.loose("Q", "second.Q", "rod.Q");
    for (name, joint) in [("first", "O"), ("second", "P")] {
        let angle = draft.angle();
        draft.drive(name, joint, angle, 10_000.0);
    }
    let angle = draft.angle();
    draft.start("rod", &format!("angle = {angle:.6}"));
}

fn rod_on_crank(draft: &mut Draft) {
    draft.ground("O", [0.0, 0.0]);
    let lengths = [draft.log(0.01, 0.2), draft.log(0.02, 0.3)];
    draft.rod("crank", lengths[0], "O", "Q");
    draft.rod("rod", lengths[1], "Q", "R");
    draft.joint("O", "ground.O", "crank.O");
    match draft.rng.bool() {
        true => draft.loose("Q", "crank.Q", "rod.Q"),
        false => draft.loose("Q", "rod.Q", "crank.Q"),
    };
    let angle = draft.angle();
    draft.drive("crank", "O", angle, MOST_RPM);
    let angle = draft.angle();
    draft.start("rod", &format!("angle = {angle:.6}"));
}

/// A body in a bearing of the ground, its journal beside its mass centre, somewhere in the
/// clearance, turning and drifting.
fn free_rotor(draft: &mut Draft) {
    draft.ground("O", [0.0, 0.0]);
    let (mass, inertia) = (draft.log(0.05, 2.0), draft.log(1e-6, 1e-2));
    let c = draft.loose("O", "ground.O", "rotor.J");
    let journal = {
        let length = draft.log(0.01, 10.0) * c;
        draft.vector(length)
    };
    draft.body("rotor", mass, inertia, &[("J", journal)]);
    let rate = draft.speed(MOST_RPM) * TAU / 60.0;
    let angle = draft.angle();
    let offset = {
        let length = draft.between(0.0, 0.95) * c;
        draft.vector(length)
    };
    let velocity = {
        let length = draft.log(1e-3, 2.0);
        draft.vector(length)
    };
    let (sin, cos) = angle.sin_cos();
    // the centre is where the journal lies in its clearance, and goes slowly against it
    let arm = [cos * journal[0] - sin * journal[1], sin * journal[0] + cos * journal[1]];
    let at = [offset[0] - arm[0], offset[1] - arm[1], angle];
    let with_arm = if draft.rng.bool() { rate } else { 0.0 };
    let v = [velocity[0] + with_arm * arm[1], velocity[1] - with_arm * arm[0], rate];
    draft.fixed("rotor", at, v);
}

/// A disc at rest under gravity: in the middle, anywhere, or touching with its weight along the
/// wall.
fn dropped_disc(draft: &mut Draft) {
    draft.gravity = true;
    draft.ground("O", [0.0, 0.0]);
    let (mass, inertia) = (draft.log(0.02, 1.0), draft.log(1e-6, 1e-3));
    draft.body("disc", mass, inertia, &[("J", [0.0, 0.0])]);
    let c = draft.loose("O", "ground.O", "disc.J");
    let rate = draft.speed(MOST_RPM) * TAU / 60.0;
    let at = match draft.rng.usize(0..3) {
        0 => [0.0, 0.0],
        1 => {
            let length = draft.between(0.0, 0.99) * c;
            draft.vector(length)
        }
        // as the case will have c
        _ => [draft.sign() * format!("{c:.6e}").parse().unwrap_or(c), 0.0],
    };
    draft.fixed("disc", [at[0], at[1], 0.0], [0.0, 0.0, rate]);
    // what falls takes the time it takes
    draft.fastest = draft.fastest.min(3.0 * TAU / 0.03);
}

fn shaft_in_ring(draft: &mut Draft) {
    draft.ground("O", [0.0, 0.0]);
    let c = draft.loose("P", "ring.P", "shaft.P");
    draft.joint("O", "ground.O", "shaft.O");
    let pin = draft.between(0.05, 0.9) * c;
    let (mass, inertia) = (draft.log(0.1, 1.0), draft.log(1e-5, 1e-3));
    draft.body("shaft", mass, inertia, &[("O", [0.0, 0.0]), ("P", [pin, 0.0])]);
    let (mass, inertia) = (draft.log(0.02, 0.5), draft.log(1e-6, 1e-3));
    draft.body("ring", mass, inertia, &[("P", [0.0, 0.0])]);
    let angle = draft.angle();
    draft.drive("shaft", "O", angle, MOST_RPM);
    let offset = {
        let length = draft.between(0.0, 0.95) * (c - pin);
        draft.vector(length)
    };
    let (sin, cos) = angle.sin_cos();
    let rate = if draft.rng.bool() { 0.0 } else { draft.sign() * draft.log(0.1, 100.0) };
    draft.fixed("ring", [pin * cos + offset[0], pin * sin + offset[1], 0.0], [0.0, 0.0, rate]);
}

/// A ring and a disc in it, both free.
fn ring_and_disc(draft: &mut Draft) {
    let c = draft.loose("gap", "ring.centre", "disc.centre");
    let arms = [draft.vector(0.01), draft.vector(0.005)];
    for (name, arm) in ["ring", "disc"].into_iter().zip(arms) {
        let (mass, inertia) = (draft.log(0.02, 1.0), draft.log(1e-5, 1e-3));
        draft.body(name, mass, inertia, &[("centre", arm)]);
    }
    let rates = [draft.speed(10_000.0), draft.speed(10_000.0)].map(|rpm| rpm * TAU / 60.0);
    let drift = draft.vector(0.5);
    let offset = {
        let length = draft.between(0.0, 0.95) * c;
        draft.vector(length)
    };
    let apart = {
        let length = draft.log(1e-3, 1.0);
        draft.vector(length)
    };
    // centres that go together but for `apart`
    draft.fixed(
        "ring",
        [-arms[0][0], -arms[0][1], 0.0],
        [drift[0] + rates[0] * arms[0][1], drift[1] - rates[0] * arms[0][0], rates[0]],
    );
    draft.fixed(
        "disc",
        [offset[0] - arms[1][0], offset[1] - arms[1][1], 0.0],
        [
            drift[0] + apart[0] + rates[1] * arms[1][1],
            drift[1] + apart[1] - rates[1] * arms[1][0],
            rates[1],
        ],
    );
}

/// A drive on a joint with clearance.
fn loose_motor(draft: &mut Draft) {
    draft.ground("O", [0.0, 0.0]);
    let beside = if draft.chance(0.2) { 0.0 } else { draft.log(1e-5, 1e-2) };
    let (mass, inertia) = (draft.log(0.05, 1.0), draft.log(1e-5, 1e-2));
    draft.body("rotor", mass, inertia, &[("O", [-beside, 0.0])]);
    draft.loose("O", "ground.O", "rotor.O");
    let angle = draft.angle();
    draft.drive("motor", "O", angle, MOST_RPM);
}

/// A shaft in two bearings, or a bar on two pins: nothing else holds it.
fn rotor_in_two_bearings(draft: &mut Draft) {
    let half = draft.log(0.01, 0.2);
    draft.ground("L", [-half, 0.0]);
    draft.ground("R", [half, 0.0]);
    let mass = draft.log(0.05, 1.0);
    let inertia = mass * half * half * draft.between(0.2, 1.0);
    let middle = draft.between(-0.5, 0.5) * half;
    draft.body("bar", mass, inertia, &[("L", [-half - middle, 0.0]), ("R", [half - middle, 0.0])]);
    draft.gravity |= draft.chance(0.7);
    match draft.rng.bool() {
        true => draft.loose("L", "ground.L", "bar.L"),
        false => draft.loose("L", "bar.L", "ground.L"),
    };
    draft.loose("R", "ground.R", "bar.R");
    let velocity = {
        let length = draft.log(1e-3, 1.0);
        draft.vector(length)
    };
    let rate = draft.sign() * draft.log(1e-3, 1.0) / half;
    draft.start(
        "bar",
        &format!(
            "x = {middle:.6e}, y = 0.0, angle = 0.0, velocity_x = {:.6e}, velocity_y = {:.6e}, \
             angular_velocity = {rate:.6e}, fixed = true",
            velocity[0], velocity[1]
        ),
    );
}

/// A block in a guide of the ground, somewhere in its play, sliding, drifting and tumbling.
fn block_in_guide(draft: &mut Draft) {
    let origin = draft.between(-0.5, 0.5);
    draft.ground("O", [origin, 0.0]);
    let (length, height) = (draft.log(0.01, 0.2), draft.log(0.01, 0.2));
    let mass = draft.log(0.05, 1.0);
    let inertia = mass * (length * length + height * height) / 12.0 * draft.between(0.5, 2.0);
    let beside = [draft.between(-0.3, 0.3) * length, draft.between(-0.3, 0.3) * height];
    draft.body("block", mass, inertia, &[("C", beside)]);
    let turned = draft.angle();
    let (sin, cos) = turned.sin_cos();
    let axis = [cos, sin];
    // the block is turned as its guide is
    let gap = draft.guide("slide", "ground.O", "block.C", axis, [length, height]);
    let along = draft.sign() * draft.log(1e-3, 1.0);
    let across = draft.between(-0.5, 0.5) * gap;
    let tilt = draft.between(-0.5, 0.5) * gap / (0.5 * length + 0.5 * height);
    // some impacts to some hundreds of them
    let pace = gap * draft.log(10.0, 1e3);
    let velocity = [along * cos - pace * sin, along * sin + pace * cos];
    let rate = draft.sign() * gap / length * draft.log(10.0, 1e3);
    // its point is where the play has it
    let (tilt_sin, tilt_cos) = tilt.sin_cos();
    let from_point = [
        -(beside[0] * tilt_cos - beside[1] * tilt_sin),
        -(beside[0] * tilt_sin + beside[1] * tilt_cos),
    ];
    let place = [origin - across * sin + from_point[0], across * cos + from_point[1]];
    draft.fixed("block", [place[0], place[1], tilt], [velocity[0], velocity[1], rate]);
    draft.fastest = 0.0;
}

/// A slider-crank whose slider has play in its guide, on or beside the crank's axis.
fn slider_crank(draft: &mut Draft) {
    let crank = draft.log(0.01, 0.1);
    let rod = crank * draft.between(2.0, 4.0);
    let beside = draft.between(-0.5, 0.5) * crank;
    draft.ground("O", [0.0, 0.0]);
    draft.ground("G", [0.0, beside]);
    draft.rod("crank", crank, "O", "A");
    draft.rod("rod", rod, "A", "B");
    let (length, height) = (draft.log(0.01, 0.1), draft.log(0.01, 0.1));
    let mass = draft.log(0.05, 1.0);
    let inertia = mass * (length * length + height * height) / 12.0;
    draft.body("slider", mass, inertia, &[("B", [0.0, 0.0]), ("C", [0.0, 0.0])]);
    draft.joint("O", "ground.O", "crank.O");
    draft.joint("A", "crank.A", "rod.A");
    match draft.chance(0.3) {
        true => {
            draft.loose("B", "rod.B", "slider.B");
        }
        false => draft.joint("B", "rod.B", "slider.B"),
    }
    draft.guide("guide", "ground.G", "slider.C", [1.0, 0.0], [length, height]);
    let angle = draft.angle();
    draft.drive("crank", "O", angle, 10_000.0);
    let (sin, cos) = angle.sin_cos();
    let reach = (rod * rod - (beside - crank * sin).powi(2)).sqrt();
    let [x, lean] = [crank * cos + reach, ((beside - crank * sin) / rod).asin()];
    draft.start("rod", &format!("angle = {lean:.4}"));
    draft.start("slider", &format!("x = {x:.4e}, y = {beside:.4e}"));
}

/// A rod on a crank, with play in a guide, or with a pin in a slot, that swings.
fn swinging_guide(draft: &mut Draft) {
    let crank = draft.log(0.01, 0.1);
    let far = crank * draft.between(2.0, 4.0);
    draft.ground("O", [0.0, 0.0]);
    draft.ground("P", [far, 0.0]);
    draft.rod("crank", crank, "O", "A");
    let length = far * draft.between(1.0, 1.3);
    draft.rod("rod", length, "A", "C");
    let inertia = draft.log(1e-5, 1e-3);
    let mass = draft.log(0.05, 1.0);
    let off = draft.between(0.0, 0.02);
    draft.body("lever", mass, inertia, &[("P", [off, 0.0]), ("C", [0.0, 0.0])]);
    draft.joint("O", "ground.O", "crank.O");
    draft.joint("P", "ground.P", "lever.P");
    match draft.chance(0.6) {
        true => {
            draft.joint("A", "crank.A", "rod.A");
            let size = [draft.log(0.01, 0.05), draft.log(0.01, 0.05)];
            draft.guide("slide", "lever.C", "rod.C", [1.0, 0.0], size);
        }
        // the crank's own pin in the lever's slot; the rod swings on it
        false => {
            draft.slot("slide", "lever.C", "crank.A", [1.0, 0.0]);
            draft.joint("A", "crank.A", "rod.A");
        }
    }
    let angle = draft.angle();
    draft.drive("crank", "O", angle, 5_000.0);
    let (sin, cos) = angle.sin_cos();
    let lean = (-crank * sin).atan2(far - crank * cos);
    draft.start("rod", &format!("angle = {lean:.4}"));
    draft.start("lever", &format!("angle = {lean:.4}"));
}
