//! A wheel or pendulum on an ideal pivot, braked by friction in a bearing that stands beside it: the
//! journal's centre is the pivot, so that the normal force never changes.
//! ```text
//! I θ̈ = −m G l cos θ + R F_T(R θ̇),   F_T = −c_f c_d(v) N v/|v|
//! ```
//! Piece by piece of the law θ̈ = A cos θ + α + β θ̇, solved by Taylor series of order fifty; edges
//! where the series of the slip passes them.

use super::families::write_run;
use super::number::{Decimal, direction, whole};
use super::truth::{Aimed, Event, State};
use fastrand::Rng;
use freeplay::run::EventKind;
use freeplay::scalar::{F256, Scalar};

/// Series that a trial may take: a wheel that stays on an edge takes them without end.
const MOST_SERIES: usize = 1000;
const ORDER: usize = 50;
/// Places on a series that are looked at for edges.
const LOOKS: i64 = 16;

/// θ̈ = pull cos θ + torque c_d-law (θ̇), rates in rad/s.
struct Wheel {
    pull: F256,
    /// Full friction over the inertia (rad/s²).
    brake: F256,
    /// Edges of the ramp, as angular rates.
    low: F256,
    high: F256,
}

/// The series of angle and rate from a time on.
struct Series {
    begin: F256,
    angle: Vec<F256>,
    rate: Vec<F256>,
}

fn sum(series: &[F256], x: F256) -> F256 {
    series.iter().rev().fold(F256::ZERO, |sum, term| sum * x + *term)
}

impl Wheel {
    /// Edges between the regions, upwards; region k lies below edge k.
    fn edges(&self) -> Vec<F256> {
        match self.low == F256::ZERO {
            true => vec![-self.high, F256::ZERO, self.high],
            false => vec![-self.high, -self.low, self.low, self.high],
        }
    }

    /// α and β of a region.
    fn law(&self, region: usize) -> [F256; 2] {
        let ramp = -self.brake / (self.high - self.low);
        let all = self.edges().len();
        match region {
            0 => [self.brake, F256::ZERO],
            1 => [ramp * self.low, ramp],
            r if r == all => [-self.brake, F256::ZERO],
            r if r == all - 1 => [-(ramp * self.low), ramp],
            _ => [F256::ZERO; 2],
        }
    }

    fn series(&self, begin: F256, angle: F256, rate: F256, region: usize) -> Series {
        let [alpha, beta] = self.law(region);
        let (sin, cos) = Scalar::sin_cos(angle);
        let (mut a, mut w, mut s, mut c) = (vec![angle], vec![rate], vec![sin], vec![cos]);
        for k in 0..ORDER {
            let over = F256::ONE / whole(k as i64 + 1);
            let constant = if k == 0 { alpha } else { F256::ZERO };
            w.push((self.pull * c[k] + constant + beta * w[k]) * over);
            a.push(w[k] * over);
            let folded = |x: &[F256]| (0..=k).fold(F256::ZERO, |sum, j| sum + w[j] * x[k - j]);
            let (of_c, of_s) = (folded(&c), folded(&s));
            s.push(of_c * over);
            c.push(-of_s * over);
        }
        Series { begin, angle: a, rate: w }
    }

    /// All series and kinks until a time; `None` if there are too many.
    fn follow(&self, angle: F256, rate: F256, until: F256) -> Option<(Vec<Series>, Vec<F256>)> {
        let edges = self.edges();
        let (mut t, mut angle, mut rate) = (F256::ZERO, angle, rate);
        let mut region = edges.iter().filter(|edge| **edge < rate).count();
        // from an edge into the region that it is driven into
        if edges.contains(&rate) && self.series(t, angle, rate, region).rate[1] > F256::ZERO {
            region += 1;
        }
        let (mut all, mut kinks) = (Vec::new(), Vec::new());
        while t < until {
            let series = self.series(t, angle, rate, region);
            let h = reach(&series).min_of(until - t);
            let outside = |x: F256| {
                let rate = sum(&series.rate, x);
                if region > 0 && rate < edges[region - 1] {
                    Some((region - 1, region - 1))
                } else if region < edges.len() && rate > edges[region] {
                    Some((region, region + 1))
                } else {
                    None
                }
            };
            let at = |k: i64| h * F256::ratio(k, LOOKS);
            let left = (1..=LOOKS).find_map(|k| Some((k, outside(at(k))?)));
            let step = match left {
                None => h,
                Some((k, (edge, _))) => {
                    let off = |x: F256| sum(&series.rate, x) - edges[edge];
                    root(off, at(k - 1), at(k))
                }
            };
            angle = sum(&series.angle, step);
            rate = sum(&series.rate, step);
            if let Some((_, (edge, next))) = left {
                (rate, region) = (edges[edge], next);
                kinks.push(t + step);
            }
            t += step;
            all.push(series);
            if all.len() > MOST_SERIES {
                return None;
            }
        }
        Some((all, kinks))
    }
}

/// How far a series is good to 1e-50 or so.
fn reach(series: &Series) -> F256 {
    let last = [ORDER - 1, ORDER].map(|k| {
        let size = Scalar::abs(series.rate[k]).to_f64().max(Scalar::abs(series.angle[k]).to_f64());
        (1e-50 / size.max(1e-300)).powf(1.0 / k as f64)
    });
    F256::from_f64(0.7 * last[0].min(last[1]).min(1.0))
}

trait MinOf {
    fn min_of(self, other: Self) -> Self;
}

impl MinOf for F256 {
    fn min_of(self, other: F256) -> F256 {
        if other < self { other } else { self }
    }
}

/// The zero of a function that changes its sign, by halving and by regula falsi in turn.
pub fn root(f: impl Fn(F256) -> F256, mut a: F256, mut b: F256) -> F256 {
    let (mut fa, mut fb) = (f(a), f(b));
    // from an edge just met
    let rising = fb > F256::ZERO;
    for round in 0..600 {
        let middle = match round % 3 == 2 || fa == fb {
            true => (a + b) / whole(2),
            false => a - fa * (b - a) / (fb - fa),
        };
        let middle = if middle > a && middle < b { middle } else { (a + b) / whole(2) };
        if !(middle > a && middle < b) {
            break;
        }
        let value = f(middle);
        if value == F256::ZERO {
            return middle;
        }
        if (value > F256::ZERO) == rising {
            (b, fb) = (middle, value)
        } else {
            (a, fa) = (middle, value)
        }
        if b - a < F256::from_f64(1e-66) * Scalar::abs(b) {
            break;
        }
    }
    (a + b) / whole(2)
}

pub fn draw(rng: &mut Rng) -> Aimed {
    loop {
        if let Some(aimed) = drawn(rng) {
            return aimed;
        }
    }
}

/// A trial, if what it does is known within so many series.
fn drawn(rng: &mut Rng) -> Option<Aimed> {
    let pendulum = rng.f64() < 0.75;
    let [ux, uy] = direction(rng);
    let mass = Decimal::draw(rng, 0.05, 1.0);
    let inertia = Decimal::draw(rng, 1e-5, 1e-3);
    let arm = if pendulum { Decimal::draw(rng, 1e-3, 5e-2) } else { Decimal::new(0, 0) };
    let gravity = Decimal::draw(rng, 1.0, 100.0);
    let c = Decimal::draw(rng, 5e-5, 1e-3);
    let depth = Decimal::draw(rng, 1e-7, 2e-6);
    let radius = Decimal::draw(rng, 5e-3, 1.5e-2);
    let friction = Decimal::draw(rng, 0.02, 0.4);
    let stiffness = Decimal::draw(rng, 1e7, 1e9);
    let (l, g) = (arm.to_f64(), gravity.to_f64());
    let whole_inertia = inertia.to_f64() + mass.to_f64() * l * l;
    let normal = stiffness.to_f64() * depth.to_f64();
    let brake = friction.to_f64() * normal * radius.to_f64() / whole_inertia;
    // the pace at which rates change, and how long it takes from one edge to the other
    let pace = brake + mass.to_f64() * g * l / whole_inertia;
    let crossing = rng.choice([1e-6, 1e-5, 1e-4, 1e-3]).unwrap();
    let v1 = Decimal::near(radius.to_f64() * pace * crossing);
    let v0 = if rng.f64() < 0.3 {
        Decimal::new(0, 0)
    } else {
        v1 * Decimal::new(rng.i32(1..=99).into(), -2)
    };
    // fast enough to stop within the time, or at rest
    let lasts = crossing * rng.choice([3.0, 10.0, 30.0]).unwrap();
    let rate = match pendulum && rng.f64() < 0.3 {
        true => Decimal::new(0, 0),
        false => {
            let rate = Decimal::near(pace * lasts * (0.1 + 0.5 * rng.f64()));
            if rng.bool() { rate } else { -rate }
        }
    };
    let angle = Decimal::new(rng.i32(-3100..=3100).into(), -3);
    // ramps in which slip dies away are left before it is no more than rounding of 71 digits
    let dies = brake / (v1 - v0).to_f64() * radius.to_f64();
    let until = Decimal::near(lasts.min(40.0 / dies.max(1e-9)));
    let away = c + depth;
    let mut text = format!(
        "[ground]\npoints = {{ O = [0.0, 0.0], W = [{}, {}] }}\n\n\
         [bodies.wheel]\nmass = {mass}\ninertia = {inertia}\npoints = {{ O = [{}, 0.0] }}\n\n\
         [joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"wheel.O\"]\n\n\
         [joints.W]\nkind = \"revolute\"\nbetween = [\"ground.W\", \"wheel.O\"]\n\n\
         [joints.W.clearance]\nbearing_radius = {}\nradial = {c}\n\
         normal = {{ law = \"hertz\", stiffness = {stiffness}, exponent = 1.0 }}\n\
         friction = {{ law = \"ambrosio\", coefficient = {friction}, v0 = {v0}, v1 = {v1} }}\n\n\
         [loads.gravity]\nkind = \"gravity\"\nacceleration = [0.0, {}]\n\n\
         [start]\nwheel = {{ angle = {angle}, angular_velocity = {rate}, fixed = true }}\n\n",
        -(ux * away),
        -(uy * away),
        -arm,
        radius + c,
        -gravity
    );
    write_run(&mut text, until);
    let [m, l, g, r] = [mass, arm, gravity, radius].map(Decimal::value);
    let all = inertia.value() + m * l * l;
    let normal = stiffness.value() * depth.value();
    let wheel = Wheel {
        pull: -(m * g * l) / all,
        brake: friction.value() * normal * r / all,
        low: v0.value() / r,
        high: v1.value() / r,
    };
    let (series, kinks) = wheel.follow(angle.value(), rate.value(), until.value())?;
    let begins = Event { time: F256::ZERO, kind: EventKind::ContactBegins, clearance: 0 };
    let kinks =
        kinks.iter().map(|time| Event { time: *time, kind: EventKind::FrictionKink, clearance: 0 });
    let events = std::iter::once(begins).chain(kinks).collect();
    let offset = [ux * away, uy * away].map(Decimal::value);
    let at = move |time: F256| {
        let piece = series.iter().rfind(|piece| piece.begin <= time).expect("from zero on");
        let (angle, rate) =
            (sum(&piece.angle, time - piece.begin), sum(&piece.rate, time - piece.begin));
        let (sin, cos) = Scalar::sin_cos(angle);
        let body = [l * cos, l * sin, angle, -(l * rate * sin), l * rate * cos, rate];
        Some(State {
            bodies: vec![body],
            offsets: vec![offset],
            normals: vec![Some(normal)],
            or: None,
        })
    };
    Some(Aimed {
        family: "",
        text,
        at: Box::new(at),
        events: Some(events),
        known: until.value(),
        peaks: Vec::new(),
    })
}
