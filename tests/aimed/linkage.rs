//! Four-bars that start, or pass, a hair beside a dead centre. Ideal ones and their starts are two
//! circles that meet; with clearance in A, B and B0 coupler and follower fly freely from there,
//! until the first journal meets its bearing.

use super::families::write_run;
use super::number::{Decimal, pi, whole};
use super::truth::{Aimed, Event, State};
use super::wheel::root;
use fastrand::Rng;
use freeplay::run::EventKind;
use freeplay::scalar::{F256, Scalar};
use std::fmt::Write as _;

/// π as the case has it.
const PI: &str = "3.14159265358979323846264338327950288419716939937510582097494459";

/// Lengths (m), the crank's place of the mass centres, and its turning.
#[derive(Clone)]
struct FourBar {
    crank: Decimal,
    coupler: Decimal,
    follower: Decimal,
    ground: Decimal,
    /// Distance of the mass centre from A, from B0, from A0.
    centres: [Decimal; 3],
    phase: F256,
    speed: F256,
    /// Which of the two places B is at.
    side: F256,
}

type Pair = [F256; 2];

fn plus(a: Pair, b: Pair) -> Pair {
    [a[0] + b[0], a[1] + b[1]]
}

fn times(x: F256, a: Pair) -> Pair {
    [x * a[0], x * a[1]]
}

/// Along and across an angle.
fn axes(angle: F256) -> [Pair; 2] {
    let (sin, cos) = Scalar::sin_cos(angle);
    [[cos, sin], [-sin, cos]]
}

impl FourBar {
    fn values(&self) -> [F256; 4] {
        [self.crank, self.coupler, self.follower, self.ground].map(Decimal::value)
    }

    /// Angles and rates of crank, coupler and follower.
    fn motion(&self, time: F256) -> [Pair; 3] {
        let [a, b, f, x0] = self.values();
        let angle = self.phase + self.speed * time;
        let [out, over] = axes(angle);
        let to = [x0 - a * out[0], -(a * out[1])];
        let square = to[0] * to[0] + to[1] * to[1];
        let d = Scalar::sqrt(square);
        let along = (square + b * b - f * f) / (whole(2) * d);
        // Heron's formula
        let four = (b + f + d) * (b + f - d) * (d + b - f) * (d - b + f);
        let beside = self.side * Scalar::sqrt(four) / (whole(2) * d);
        let unit = times(F256::ONE / d, to);
        let at = plus(times(along, unit), times(beside, [-unit[1], unit[0]]));
        let from_b0 = [at[0] - to[0], at[1] - to[1]];
        let beta = F256::atan2(&at[1], &at[0]);
        let gamma = F256::atan2(&from_b0[1], &from_b0[0]);
        // Ȧ + b β̇ t_β = f γ̇ t_γ; across one the other is left
        let (along_b, along_f) = (axes(beta)[0], axes(gamma)[0]);
        let dot = |p: Pair, q: Pair| p[0] * q[0] + p[1] * q[1];
        let moved = times(a * self.speed, over);
        // the sine of the angle between the two, of the triangle's area
        let sine = axes(beta)[1][0] * along_f[0] + axes(beta)[1][1] * along_f[1];
        let beta_rate = -dot(moved, along_f) / (b * sine);
        let gamma_rate = dot(moved, along_b) / (f * -sine);
        // dot(t_γ, along_b) = −dot(t_β, along_f)
        [[angle, self.speed], [beta, beta_rate], [gamma, gamma_rate]]
    }

    /// Mass centres and their velocities of the three bodies.
    fn bodies(&self, time: F256) -> Vec<[F256; 6]> {
        let [a, _, _, x0] = self.values();
        let [crank, coupler, follower] = self.motion(time);
        let of = |from: Pair, drift: Pair, arm: F256, [angle, rate]: Pair| {
            let [along, across] = axes(angle);
            let place = plus(from, times(arm, along));
            let moves = plus(drift, times(arm * rate, across));
            [place[0], place[1], angle, moves[0], moves[1], rate]
        };
        let [along, across] = axes(crank[0]);
        let (at, moves) = (times(a, along), times(a * crank[1], across));
        let still = [F256::ZERO; 2];
        let [of_coupler, of_follower, of_crank] = self.centres.map(Decimal::value);
        vec![
            of(still, still, of_crank, crank),
            of(at, moves, of_coupler, coupler),
            of([x0, F256::ZERO], still, of_follower, follower),
        ]
    }

    /// The bodies when coupler and follower have flown freely since the start.
    fn flown(&self, start: &[[F256; 6]], time: F256) -> Vec<[F256; 6]> {
        let fly = |b: &[F256; 6]| {
            let at = |i: usize| b[i] + time * b[i + 3];
            [at(0), at(1), at(2), b[3], b[4], b[5]]
        };
        let angle = self.phase + self.speed * time;
        let [along, across] = axes(angle);
        let arm = self.centres[2].value();
        let (place, moves) = (times(arm, along), times(arm * self.speed, across));
        let crank = [place[0], place[1], angle, moves[0], moves[1], self.speed];
        vec![crank, fly(&start[1]), fly(&start[2])]
    }

    /// Clearance vectors in A, B and B0 of bodies.
    fn offsets(&self, bodies: &[[F256; 6]]) -> [Pair; 3] {
        let [a, b, f, x0] = self.values();
        let [of_coupler, of_follower, of_crank] = self.centres.map(Decimal::value);
        let end =
            |body: &[F256; 6], arm: F256| plus([body[0], body[1]], times(arm, axes(body[2])[0]));
        let less = |p: Pair, q: Pair| [p[0] - q[0], p[1] - q[1]];
        let [crank, coupler, follower] = [&bodies[0], &bodies[1], &bodies[2]];
        [
            less(end(coupler, -of_coupler), end(crank, a - of_crank)),
            less(end(follower, f - of_follower), end(coupler, b - of_coupler)),
            less(end(follower, -of_follower), [x0, F256::ZERO]),
        ]
    }

    /// First time before `until` at which a journal is c from its bearing's centre, and which.
    fn first_contact(
        &self,
        start: &[[F256; 6]],
        c: [F256; 3],
        until: F256,
    ) -> Option<(F256, usize)> {
        let beyond = |k: usize, time: F256| {
            let [x, y] = self.offsets(&self.flown(start, time))[k];
            Scalar::sqrt(x * x + y * y) - c[k]
        };
        const LOOKS: i64 = 400;
        let at = |look: i64| until * F256::ratio(look, LOOKS);
        let look = (1..=LOOKS).find(|look| (0..3).any(|k| beyond(k, at(*look)) > F256::ZERO))?;
        let met = (0..3).filter(|k| beyond(*k, at(look)) > F256::ZERO);
        let times = met.map(|k| (root(|time| beyond(k, time), at(look - 1), at(look)), k));
        times.reduce(|a, b| if b.0 < a.0 { b } else { a })
    }
}

pub fn draw(rng: &mut Rng) -> Aimed {
    let crank = Decimal::draw(rng, 0.01, 0.05);
    let [coupler, follower] =
        [0; 2].map(|_| Decimal::near(crank.to_f64() * (3.0 + 4.0 * rng.f64())));
    // η from a hundredth of a millimetre down to what doubles cannot start from
    let eta = Decimal::new(rng.i32(1..=9).into(), -rng.i32(6..=20));
    let reversed = rng.bool();
    let ground = coupler + follower - eta + if reversed { crank } else { -crank };
    let ideal = !reversed && rng.bool();
    let rpm = Decimal::draw(rng, 50.0, 6000.0);
    let speed = rpm.value() * pi() / whole(30);
    let phase = match (ideal, reversed) {
        // a quarter turn before, or there
        (true, _) if rng.bool() => "1.6".to_owned(),
        // B0 beyond the crank's end: the crank points to it, or away from it
        (_, true) => "0.0".to_owned(),
        _ => PI.to_owned(),
    };
    let four_bar = FourBar {
        crank,
        coupler,
        follower,
        ground,
        centres: [coupler, follower, crank].map(|l| l * Decimal::new(rng.i32(30..=70).into(), -2)),
        phase: F256::parse(&phase).expect("a number"),
        speed,
        side: if rng.bool() { F256::ONE } else { -F256::ONE },
    };
    let start = four_bar.bodies(F256::ZERO);
    let c = [0; 3].map(|_| Decimal::draw(rng, 1e-4, 2e-3));
    let revolution = (whole(60) / rpm.value()).to_f64();
    let loose = if ideal { 0 } else { rng.i32(1..=3) as usize };
    let contact = (loose == 3)
        .then(|| {
            four_bar.first_contact(&start, c.map(Decimal::value), F256::from_f64(0.3 * revolution))
        })
        .flatten();
    let until = match (ideal, contact) {
        (true, _) => Decimal::near(revolution * 0.9),
        (_, Some((time, _))) => Decimal::near(time.to_f64() * 1.05),
        _ => Decimal::near(1e-3 * revolution),
    };
    let text = text(rng, &four_bar, &phase, rpm, &c[..], loose, &start, until);
    let known = match contact {
        _ if ideal => until.value(),
        Some((time, _)) => time * (F256::ONE + F256::from_f64(1e-14)),
        _ => F256::ZERO,
    };
    let first = contact.map_or(F256::ZERO, |(time, _)| time);
    // starts are found from places 2⁻²⁶ apart
    let near = Scalar::sin_cos(start[1][2] - start[2][2]).0.to_f64().abs() < 1e-6;
    let kind = EventKind::ContactBegins;
    let event = |(time, clearance)| Event { time, kind, clearance };
    let events = (ideal || !near).then(|| contact.map(event).into_iter().collect());
    let mirrored = near.then(|| {
        let other = FourBar { side: -four_bar.side, ..four_bar.clone() };
        let start = other.bodies(F256::ZERO);
        (other, start)
    });
    let at = move |time: F256| {
        if !ideal && time > first {
            return None;
        }
        let of = |four_bar: &FourBar, start: &[[F256; 6]]| {
            let bodies = match ideal {
                true => four_bar.bodies(time),
                false => four_bar.flown(start, time),
            };
            let offsets = match loose {
                3 => four_bar.offsets(&bodies).to_vec(),
                loose => vec![[F256::ZERO; 2]; loose],
            };
            State { normals: vec![Some(F256::ZERO); offsets.len()], bodies, offsets, or: None }
        };
        let mirrored = mirrored.as_ref().map(|(four_bar, start)| Box::new(of(four_bar, start)));
        Some(State { or: mirrored, ..of(&four_bar, &start) })
    };
    Aimed { family: "", text, at: Box::new(at), events, known, peaks: Vec::new() }
}

#[allow(clippy::too_many_arguments)]
fn text(
    rng: &mut Rng,
    four_bar: &FourBar,
    phase: &str,
    rpm: Decimal,
    c: &[Decimal],
    loose: usize,
    start: &[[F256; 6]],
    until: Decimal,
) -> String {
    let FourBar { crank, coupler, follower, ground, centres, .. } = four_bar;
    let mut text = format!("[ground]\npoints = {{ A0 = [0.0, 0.0], B0 = [{ground}, 0.0] }}\n\n");
    for (name, ends, length, centre) in [
        ("crank", ["A0", "A"], crank, centres[2]),
        ("coupler", ["A", "B"], coupler, centres[0]),
        ("follower", ["B0", "B"], follower, centres[1]),
    ] {
        let mass = Decimal::draw(rng, 0.02, 0.5);
        let inertia = Decimal::near(mass.to_f64() * length.to_f64().powi(2) / 12.0);
        let _ = write!(
            text,
            "[bodies.{name}]\nmass = {mass}\ninertia = {inertia}\n\
             points = {{ {} = [{}, 0.0], {} = [{}, 0.0] }}\n\n",
            ends[0],
            -centre,
            ends[1],
            *length - centre
        );
    }
    let joints = [
        ("A0", "ground", "crank"),
        ("A", "crank", "coupler"),
        ("B", "coupler", "follower"),
        ("B0", "ground", "follower"),
    ];
    for (place, (joint, first, second)) in joints.into_iter().enumerate() {
        let _ = write!(
            text,
            "[joints.{joint}]\nkind = \"revolute\"\nbetween = [\"{first}.{joint}\", \"{second}.{joint}\"]\n\n"
        );
        if place > 0 && place <= loose {
            let _ = write!(
                text,
                "[joints.{joint}.clearance]\nbearing_radius = 0.01\nradial = {}\n\
                 normal = {{ law = \"hertz\", stiffness = 1e9 }}\n\n",
                c[place - 1]
            );
        }
    }
    let named = if rng.bool() { ", angular_velocity = 0.0" } else { "" };
    let _ = write!(
        text,
        "[drives.crank]\njoint = \"A0\"\nspeed_rpm = {rpm}\nangle = {phase}\n\n\
         [start]\ncoupler = {{ angle = {:.17e}{named} }}\nfollower = {{ angle = {:.17e}{named} }}\n\n",
        start[1][2].to_f64(),
        start[2][2].to_f64()
    );
    write_run(&mut text, until);
    text
}
