//! The six families of aimed trials. The number of a trial and the seed make the same trial everywhere.

use super::line::{Law, Line, On};
use super::linkage;
use super::number::{Decimal, direction, pi, whole};
use super::truth::{Aimed, Event, State};
use super::wheel;
use fastrand::Rng;
use freeplay::run::EventKind;
use freeplay::scalar::{F256, Scalar};
use std::fmt::Write as _;

type Write = fn(&mut Rng) -> Aimed;

pub const FAMILIES: [(&str, Write); 6] = [
    ("near a dead centre", linkage::draw),
    ("symmetric drop", drop),
    ("edges of friction within a step", wheel::draw),
    ("graze", graze),
    ("two contacts in one instant", two),
    ("rest", rest),
];

/// Trial `number` of a campaign with a seed.
pub fn draw(seed: u64, number: u64) -> Aimed {
    let (family, write) = FAMILIES[(number % FAMILIES.len() as u64) as usize];
    let mut rng = Rng::with_seed(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ number);
    Aimed { family, ..write(&mut rng) }
}

/// A disc in a bearing, or a bar in two, and what pulls it along a line.
struct Drop {
    along: [Decimal; 2],
    mass: Decimal,
    c: Decimal,
    stiffness: Decimal,
    exponent: f64,
    restitution: Option<Decimal>,
    gravity: Decimal,
    start: [Decimal; 2],
    spin: Decimal,
}

const ZERO: fn() -> Decimal = || Decimal::new(0, 0);

impl Drop {
    fn draw(rng: &mut Rng) -> Drop {
        let c = Decimal::draw(rng, 5e-5, 2e-3);
        Drop {
            along: direction(rng),
            mass: Decimal::draw(rng, 0.02, 1.0),
            c,
            stiffness: Decimal::draw(rng, 1e7, 1e10),
            exponent: rng.choice([1.0, 1.5, 1.5, 2.0]).unwrap(),
            restitution: None,
            gravity: Decimal::draw(rng, 1.0, 100.0),
            start: [c * Decimal::new(rng.i32(-900..=900).into(), -3), ZERO()],
            spin: if rng.bool() { ZERO() } else { Decimal::draw(rng, 1.0, 1000.0) },
        }
    }

    /// The law over the mass that each of so many equal bearings carries.
    fn law(&self, bearings: i64) -> Law {
        let a = match self.restitution {
            None => F256::ZERO,
            Some(e) => F256::ratio(3, 4) * (F256::ONE - e.value() * e.value()),
        };
        Law {
            stiffness: whole(bearings) * self.stiffness.value() / self.mass.value(),
            exponent: self.exponent,
            damping: a,
            least: F256::ratio(1, 1000),
        }
    }

    fn line(&self, bearings: i64, contacts: usize) -> Line {
        let start = self.start.map(Decimal::value);
        Line::new(self.c.value(), self.gravity.value(), self.law(bearings), start, contacts)
    }

    fn clearance(&self, joint: &str) -> String {
        let law = match self.restitution {
            None => "law = \"hertz\"".to_owned(),
            Some(e) => format!("law = \"lankarani-nikravesh\", restitution = {e}"),
        };
        format!(
            "[joints.{joint}.clearance]\nbearing_radius = {}\nradial = {}\n\
             normal = {{ {law}, stiffness = {}, exponent = {:?} }}\n\n",
            self.c + Decimal::new(1, -2),
            self.c,
            self.stiffness,
            self.exponent
        )
    }

    fn gravity(&self) -> String {
        let [x, y] = self.along.map(|u| u * self.gravity);
        format!("[loads.gravity]\nkind = \"gravity\"\nacceleration = [{x}, {y}]\n\n")
    }

    /// The start of a body whose place without offset is `at`.
    fn start(&self, body: &str, at: [Decimal; 2], spin: Decimal) -> String {
        let [x, y] = [0, 1].map(|i| at[i] + self.along[i] * self.start[0]);
        let [vx, vy] = self.along.map(|u| u * self.start[1]);
        format!(
            "{body} = {{ x = {x}, y = {y}, angle = 0.0, velocity_x = {vx}, velocity_y = {vy}, \
             angular_velocity = {spin}, fixed = true }}\n"
        )
    }

    /// A disc alone.
    fn disc(&self) -> String {
        format!(
            "[ground]\npoints = {{ O = [0.0, 0.0] }}\n\n\
             [bodies.disc]\nmass = {}\ninertia = 1e-5\npoints = {{ J = [0.0, 0.0] }}\n\n\
             [joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"disc.J\"]\n\n{}{}[start]\n{}\n",
            self.mass,
            self.clearance("O"),
            self.gravity(),
            self.start("disc", [ZERO(), ZERO()], self.spin)
        )
    }

    fn state(&self, on: On, time: F256, at: [F256; 2], spin: Decimal) -> State {
        let u = self.along.map(Decimal::value);
        let spin = spin.value();
        State {
            bodies: vec![[
                at[0] + u[0] * on.s,
                at[1] + u[1] * on.s,
                spin * time,
                u[0] * on.w,
                u[1] * on.w,
                spin,
            ]],
            offsets: vec![[u[0] * on.s, u[1] * on.s]],
            normals: vec![Some(self.mass.value() * on.push)],
            or: None,
        }
    }

    /// The trial of a disc alone, until so many contacts have ended.
    fn alone(self, rng: &mut Rng, contacts: usize, unambiguous: bool) -> Aimed {
        let line = self.line(1, contacts);
        let mut text = self.disc();
        let until = until(rng, &[&line], self.pace());
        write_run(&mut text, until);
        let known = known(&[&line], until);
        let events = unambiguous.then(|| events(&[&line], known));
        let mass = self.mass.value();
        let ended = line.edges.iter().filter(|edge| !edge.begins);
        let peaks = ended.zip(&line.peaks).filter(|(end, _)| end.time < known);
        let peaks = peaks.filter_map(|(_, push)| Some((0, mass * (*push)?))).collect();
        let at = move |time: F256| {
            line.at(time).map(|on| self.state(on, time, [F256::ZERO; 2], self.spin))
        };
        Aimed { family: "", text, at: Box::new(at), events, known, peaks }
    }

    /// A time (s) in which a contact swings.
    fn pace(&self) -> f64 {
        let k = self.stiffness.to_f64() / self.mass.to_f64();
        // at the depth of the weight
        let depth = (self.gravity.to_f64().abs().max(1e-3) / k).powf(1.0 / self.exponent);
        3.0 / (k * depth.powf(self.exponent - 1.0)).sqrt()
    }
}

/// A duration within what is known of some lines, of four digits; `pace` (s) where nothing ends.
fn until(rng: &mut Rng, lines: &[&Line], pace: f64) -> Decimal {
    let known = lines.iter().map(|line| line.until().to_f64()).fold(f64::INFINITY, f64::min);
    let last = lines.iter().filter_map(|line| line.edges.last()).map(|edge| edge.time.to_f64());
    let last = last.fold(0.0, f64::max);
    let known = if known.is_finite() { known } else { last + 6.0 * pace };
    Decimal::near(last.min(known) + (0.1 + 0.8 * rng.f64()) * (known - last.min(known)))
}

pub fn write_run(text: &mut String, duration: Decimal) {
    let interval = duration * Decimal::new(5, -2);
    let _ = write!(text, "[run]\nduration = {duration}\nsample_interval = {interval}\n\n");
}

/// Until when the events of a run of some lines are known (s).
fn known(lines: &[&Line], until: Decimal) -> F256 {
    lines.iter().map(|line| line.until()).fold(until.value(), Scalar::min)
}

fn events(lines: &[&Line], until: F256) -> Vec<Event> {
    let of = |(clearance, line): (usize, &&Line)| -> Vec<Event> {
        let kind = |begins| if begins { EventKind::ContactBegins } else { EventKind::ContactEnds };
        let edges = line.edges.iter().filter(|edge| edge.time < until);
        edges.map(|edge| Event { time: edge.time, kind: kind(edge.begins), clearance }).collect()
    };
    lines.iter().enumerate().flat_map(of).collect()
}

/// A disc dropped along a line through its bearing's centre, or thrown to and fro without weight
/// and with damping.
fn drop(rng: &mut Rng) -> Aimed {
    let mut drop = Drop::draw(rng);
    if rng.bool() {
        drop.start[1] = Decimal::draw(rng, 1e-3, 1.0);
    }
    if rng.f64() < 0.3 {
        drop.gravity = ZERO();
        drop.start[1] = Decimal::draw(rng, 1e-4, 2.0);
        if rng.f64() < 0.8 {
            drop.restitution = Some(Decimal::draw(rng, 0.1, 0.99));
        }
    }
    let contacts = rng.usize(1..=3);
    drop.alone(rng, contacts, true)
}

/// Seven or so digits of a distance from 1e-9 to 1e-21 m.
fn hair(rng: &mut Rng) -> Decimal {
    Decimal::new(rng.i32(1..=9).into(), -rng.i32(9..=21))
}

/// What just reaches the wall, or just does not.
fn graze(rng: &mut Rng) -> Aimed {
    if rng.f64() < 0.4 {
        return spinning_graze(rng);
    }
    let mut drop = Drop::draw(rng);
    // thrown up: v² = 2 g h, and 1/(2 g) is a decimal
    let (g, half) = rng
        .choice([
            (Decimal::new(5, 0), Decimal::new(1, -1)),
            (Decimal::new(8, 0), Decimal::new(625, -4)),
            (Decimal::new(125, -1), Decimal::new(4, -2)),
        ])
        .unwrap();
    let speed = Decimal::draw(rng, 0.03, 0.15);
    let height = speed * speed * half;
    let off = if rng.bool() { hair(rng) } else { -hair(rng) };
    // begins in the middle or below
    let begin = -(height * Decimal::new(rng.i32(0..=40).into(), -2));
    drop.c = begin + height - off;
    drop.gravity = -g;
    drop.start = [begin, speed];
    let contacts = if off.to_f64() > 0.0 { rng.usize(1..=2) } else { 1 };
    drop.alone(rng, contacts, true)
}

/// A rotor whose mass centre rests while its journal circles, and touches the wall, or does not, by
/// a hair.
fn spinning_graze(rng: &mut Rng) -> Aimed {
    let drop = Drop::draw(rng);
    let [p, r] = [0; 2].map(|_| Decimal::draw(rng, 1e-4, 1e-3));
    let off = if rng.f64() < 0.6 { -hair(rng) } else { hair(rng) };
    let c = p + r - off;
    let rate = Decimal::draw(rng, 10.0, 2000.0);
    let phase = Decimal::new(rng.i32(1000..=5500).into(), -3);
    let u = drop.along;
    let place = u.map(|u| u * p);
    let drop = Drop { c, ..drop };
    let mut text = format!(
        "[ground]\npoints = {{ O = [0.0, 0.0] }}\n\n\
         [bodies.rotor]\nmass = {}\ninertia = 1e-4\npoints = {{ J = [{r}, 0.0] }}\n\n\
         [joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"rotor.J\"]\n\n{}\
         [start]\nrotor = {{ x = {}, y = {}, angle = {phase}, velocity_x = 0.0, velocity_y = 0.0, \
         angular_velocity = {rate}, fixed = true }}\n\n",
        drop.mass,
        drop.clearance("O"),
        place[0],
        place[1]
    );
    let [p, r, rate, phase] = [p, r, rate, phase].map(Decimal::value);
    let u = u.map(Decimal::value);
    let turn = whole(2) * pi();
    // the first time that the arm points along u
    let mut ahead = F256::atan2(&u[1], &u[0]) - phase;
    while ahead < F256::ZERO {
        ahead += turn;
    }
    let touches = off.value() > F256::ZERO;
    let begins = touches.then(|| {
        // sin² (x/2) = off (2 (p + r) − off)/(4 p r)
        let off = off.value();
        let square = off * (whole(2) * (p + r) - off) / (whole(4) * p * r);
        (ahead - whole(2) * F256::asin(&Scalar::sqrt(square))) / rate
    });
    let last = (ahead / rate).to_f64();
    let turns = rng.i32(0..=2);
    let until = match touches {
        true => Decimal::near(last * 1.05),
        false => Decimal::near(last + (f64::from(turns) + 0.5) * turn.to_f64() / rate.to_f64()),
    };
    write_run(&mut text, until);
    let known = begins.unwrap_or(until.value());
    let kind = EventKind::ContactBegins;
    let events = begins.iter().map(|time| Event { time: *time, kind, clearance: 0 }).collect();
    let at = move |time: F256| {
        if time > known {
            return None;
        }
        let (sin, cos) = Scalar::sin_cos(phase + rate * time);
        let body = [u[0] * p, u[1] * p, phase + rate * time, F256::ZERO, F256::ZERO, rate];
        let offset = [u[0] * p + r * cos, u[1] * p + r * sin];
        Some(State {
            bodies: vec![body],
            offsets: vec![offset],
            normals: vec![Some(F256::ZERO)],
            or: None,
        })
    };
    // a hair behind the begin: its event is known, what comes of it is not
    let known = if touches { known + F256::from_f64(1e-15 * last) } else { known };
    Aimed { family: "", text, at: Box::new(at), events: Some(events), known, peaks: Vec::new() }
}

/// A bar level on two pins, or two journals that fall from the same height but for a hair.
fn two(rng: &mut Rng) -> Aimed {
    let drop = Drop::draw(rng);
    let contacts = rng.usize(1..=2);
    match rng.f64() < 0.4 {
        true => bar(rng, drop, contacts),
        false => journals(rng, drop, contacts),
    }
}

fn bar(rng: &mut Rng, drop: Drop, contacts: usize) -> Aimed {
    let half = Decimal::draw(rng, 0.02, 0.2);
    let mut text = format!(
        "[ground]\npoints = {{ L = [{0}, 0.0], R = [{1}, 0.0] }}\n\n\
         [bodies.bar]\nmass = {2}\ninertia = 1e-3\npoints = {{ L = [{0}, 0.0], R = [{1}, 0.0] }}\n\n\
         [joints.L]\nkind = \"revolute\"\nbetween = [\"ground.L\", \"bar.L\"]\n\n{3}\
         [joints.R]\nkind = \"revolute\"\nbetween = [\"ground.R\", \"bar.R\"]\n\n{4}{5}[start]\n{6}\n",
        -half,
        half,
        drop.mass,
        drop.clearance("L"),
        drop.clearance("R"),
        drop.gravity(),
        drop.start("bar", [ZERO(), ZERO()], ZERO())
    );
    let line = drop.line(2, contacts);
    let until = until(rng, &[&line], drop.pace());
    write_run(&mut text, until);
    let known = known(&[&line], until);
    let events = Some(events(&[&line, &line], known));
    let at = move |time: F256| {
        line.at(time).map(|on| {
            let one = drop.state(on, time, [F256::ZERO; 2], ZERO());
            let half = one.normals[0].map(|normal| normal / whole(2));
            State { offsets: vec![one.offsets[0]; 2], normals: vec![half; 2], ..one }
        })
    };
    Aimed { family: "", text, at: Box::new(at), events, known, peaks: Vec::new() }
}

fn journals(rng: &mut Rng, drop: Drop, contacts: usize) -> Aimed {
    // at once, or a hair of the clearance apart
    let one = hair(rng);
    let hair = rng.choice([ZERO(), one, -one]).unwrap();
    let mut other = Drop { start: [drop.start[0] + hair, drop.start[1]], ..Drop::draw(rng) };
    (other.along, other.gravity, other.c) = (drop.along, drop.gravity, drop.c);
    if rng.bool() {
        (other.mass, other.stiffness, other.exponent) = (drop.mass, drop.stiffness, drop.exponent);
    }
    let far = Decimal::new(1, -1);
    let body = |name: &str, drop: &Drop| {
        format!(
            "[bodies.{name}]\nmass = {}\ninertia = 1e-5\npoints = {{ J = [0.0, 0.0] }}\n\n",
            drop.mass
        )
    };
    let mut text = format!(
        "[ground]\npoints = {{ L = [0.0, 0.0], R = [{far}, 0.0] }}\n\n{}{}\
         [joints.L]\nkind = \"revolute\"\nbetween = [\"ground.L\", \"left.J\"]\n\n{}\
         [joints.R]\nkind = \"revolute\"\nbetween = [\"ground.R\", \"right.J\"]\n\n{}{}[start]\n{}{}\n",
        body("left", &drop),
        body("right", &other),
        drop.clearance("L"),
        other.clearance("R"),
        drop.gravity(),
        drop.start("left", [ZERO(), ZERO()], drop.spin),
        other.start("right", [far, ZERO()], other.spin)
    );
    let lines = [drop.line(1, contacts), other.line(1, contacts)];
    let until = until(rng, &[&lines[0], &lines[1]], drop.pace().min(other.pace()));
    write_run(&mut text, until);
    let known = known(&[&lines[0], &lines[1]], until);
    let events = Some(events(&[&lines[0], &lines[1]], known));
    let at = move |time: F256| {
        let (Some(left), Some(right)) = (lines[0].at(time), lines[1].at(time)) else {
            return None;
        };
        let mut state = drop.state(left, time, [F256::ZERO; 2], drop.spin);
        let more = other.state(right, time, [far.value(), F256::ZERO], other.spin);
        state.bodies.extend(more.bodies);
        state.offsets.extend(more.offsets);
        state.normals.extend(more.normals);
        Some(state)
    };
    Aimed { family: "", text, at: Box::new(at), events, known, peaks: Vec::new() }
}

/// What lies in its bearing, swings in it, comes just off it or just not, or circles in it.
fn rest(rng: &mut Rng) -> Aimed {
    let mut drop = Drop::draw(rng);
    if rng.f64() < 0.2 {
        return circling(rng, drop);
    }
    drop.exponent = 1.0;
    // K = 1, 2 or 5 times a power of ten: the depth of the weight is a decimal
    let (digit, inverse) = rng.choice([(1, 10), (2, 5), (5, 2)]).unwrap();
    let power = rng.i32(6..=9);
    drop.stiffness = Decimal::new(digit, power);
    let depth = drop.mass * drop.gravity * Decimal::new(inverse, -power - 1);
    let (share, unambiguous) = match rng.i32(0..5) {
        // lies still
        0 => (Decimal::new(1, 0), true),
        // swings and stays
        1 => (Decimal::new(rng.i32(1..1999).into(), -3), true),
        // from the wall, at rest: comes back to it and does not leave it
        2 => (ZERO(), false),
        // stays, or hops, by a hair
        3 => (Decimal::new(2, 0) - Decimal::new(1, -rng.i32(3..=20)), true),
        _ => (Decimal::new(2, 0) + Decimal::new(1, -rng.i32(3..=20)), true),
    };
    drop.start = [drop.c + depth * share, ZERO()];
    if rng.f64() < 0.2 && share.to_f64() > 0.5 && share.to_f64() < 1.5 {
        drop.start[1] = Decimal::draw(rng, 1e-6, 1e-2);
    }
    let contacts = rng.usize(1..=2);
    drop.alone(rng, contacts, unambiguous)
}

/// A journal that circles in permanent contact: m v²/(c + δ) = K δⁿ.
fn circling(rng: &mut Rng, mut drop: Drop) -> Aimed {
    drop.exponent = 1.5;
    // δ = q², 1/q³ a decimal; R = c + δ, 1/R a decimal
    let (q, over) = rng
        .choice([
            (Decimal::new(1, -3), Decimal::new(1, 9)),
            (Decimal::new(5, -4), Decimal::new(8, 9)),
        ])
        .unwrap();
    let (radius, inverse) = rng
        .choice([
            (Decimal::new(1, -3), Decimal::new(1, 3)),
            (Decimal::new(5, -4), Decimal::new(2, 3)),
            (Decimal::new(2, -3), Decimal::new(5, 2)),
        ])
        .unwrap();
    let speed = Decimal::draw(rng, 0.05, 2.0);
    drop.c = radius - q * q;
    drop.stiffness = drop.mass * speed * speed * inverse * over;
    drop.gravity = ZERO();
    let [ux, uy] = drop.along;
    let mut text = drop.disc();
    let begin = text.find("[start]").expect("a start");
    text.truncate(begin);
    let _ = write!(
        text,
        "[start]\ndisc = {{ x = {}, y = {}, angle = 0.0, velocity_x = {}, velocity_y = {}, \
         angular_velocity = 0.0, fixed = true }}\n\n",
        ux * radius,
        uy * radius,
        -(uy * speed),
        ux * speed
    );
    text = text.replace(&drop.gravity(), "");
    let until = Decimal::near((0.3 + 2.0 * rng.f64()) * radius.to_f64() / speed.to_f64());
    write_run(&mut text, until);
    let normal = drop.mass.value() * speed.value() * speed.value() / radius.value();
    let [ux, uy] = drop.along.map(Decimal::value);
    let at = move |time: F256| {
        let (radius, speed) = (radius.value(), speed.value());
        let (sin, cos) = Scalar::sin_cos(speed * time / radius);
        let out = [ux * cos - uy * sin, uy * cos + ux * sin];
        let offset = out.map(|x| x * radius);
        let body = [offset[0], offset[1], F256::ZERO, -out[1] * speed, out[0] * speed, F256::ZERO];
        Some(State {
            bodies: vec![body],
            offsets: vec![offset],
            normals: vec![Some(normal)],
            or: None,
        })
    };
    let begins = Event { time: F256::ZERO, kind: EventKind::ContactBegins, clearance: 0 };
    Aimed {
        family: "",
        text,
        at: Box::new(at),
        events: Some(vec![begins]),
        known: until.value(),
        peaks: Vec::new(),
    }
}
