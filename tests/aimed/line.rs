//! A mass between two walls, pushed along the line through both, in closed form.
//! ```text
//! flight    s̈ = g
//! contact   δ̈ = p − k δⁿ (1 + a δ̇/δ̇⁽⁻⁾),   δ = σ s − c,  p = σ g
//! ```
//! With n = 1 and a = 0 contacts swing. Otherwise a contact is known by its first integral: with
//! a = 0 of energy, with p = 0 of
//! ```text
//! k δⁿ⁺¹/(n + 1) = u² (G(v₀/u) − G(v/u)),   G(r) = r/a − ln(1 + a r)/a²,  u = max(v₀, least)
//! ```
//! and lasts as long as a quadrature says.

use super::number::{pi, whole};
use freeplay::scalar::{F256, Scalar};

/// A contact law over the mass.
#[derive(Clone, Copy)]
pub struct Law {
    /// k = K/m (1/(s² m^(n−1))).
    pub stiffness: F256,
    /// n: 1, 1.5 or 2.
    pub exponent: f64,
    /// a.
    pub damping: F256,
    /// Impact rate (m/s) that slower ones are raised to.
    pub least: F256,
}

#[derive(Clone, Copy)]
enum Kind {
    Flight {
        s: F256,
        w: F256,
    },
    /// Swings about `middle`: δ = middle + cosine cos ωτ + sine sin ωτ.
    Swing {
        side: F256,
        middle: F256,
        cosine: F256,
        sine: F256,
    },
    /// Known by its ends only.
    Pressed,
    /// Stands still at a depth.
    Still {
        side: F256,
        depth: F256,
    },
}

struct Piece {
    begin: F256,
    kind: Kind,
}

/// Begin or end of a contact.
#[derive(Clone, Copy)]
pub struct Edge {
    pub time: F256,
    pub begins: bool,
    /// |δ̇| (m/s).
    pub rate: F256,
}

/// The motion along the line from time zero on.
pub struct Line {
    c: F256,
    g: F256,
    law: Law,
    pieces: Vec<Piece>,
    pub edges: Vec<Edge>,
    /// Largest force over the mass of each contact that ended, where it is known.
    pub peaks: Vec<Option<F256>>,
    /// Until when pieces are known (s).
    until: F256,
}

/// Place, velocity, and the push of the wall over the mass.
#[derive(Clone, Copy)]
pub struct On {
    pub s: F256,
    pub w: F256,
    pub push: F256,
}

/// xⁿ for n = 1, 1.5, 2, 2.5, 3.
fn power(x: F256, n: f64) -> F256 {
    let mut product = F256::ONE;
    for _ in 0..n as i64 {
        product *= x;
    }
    if n.fract() > 0.0 { product * Scalar::sqrt(x) } else { product }
}

impl Line {
    /// From a place (m) at a velocity (m/s) under g (m/s²), walls at ±c; until so many contacts
    /// have ended, or one never does.
    pub fn new(c: F256, g: F256, law: Law, [s, w]: [F256; 2], contacts: usize) -> Line {
        let mut line =
            Line { c, g, law, pieces: vec![], edges: vec![], peaks: vec![], until: F256::ZERO };
        let depth = Scalar::abs(s) - c;
        let side = if s < F256::ZERO { -F256::ONE } else { F256::ONE };
        let presses = depth > F256::ZERO
            || depth == F256::ZERO
                && (side * w > F256::ZERO || w == F256::ZERO && side * g > F256::ZERO);
        let mut at = [s, w];
        if presses {
            line.edge(true, side * w);
            match line.contact(side, depth, side * w) {
                Some(rate) => at = [side * c, side * rate],
                None => return line,
            }
        }
        while line.peaks.len() < contacts {
            let Some((side, rate)) = line.fly(at) else { return line };
            line.edge(true, rate);
            match line.contact(side, F256::ZERO, rate) {
                Some(rate) => at = [side * c, side * rate],
                None => return line,
            }
        }
        let _ = line.fly(at);
        line
    }

    fn edge(&mut self, begins: bool, rate: F256) {
        self.edges.push(Edge { time: self.until, begins, rate: Scalar::abs(rate) });
    }

    fn add(&mut self, kind: Kind, lasts: Option<F256>) {
        self.pieces.push(Piece { begin: self.until, kind });
        self.until = lasts.map_or(F256::from_f64(f64::INFINITY), |lasts| self.until + lasts);
    }

    /// Flies to the first wall; the wall and the rate there.
    fn fly(&mut self, [s, w]: [F256; 2]) -> Option<(F256, F256)> {
        let to = |side: F256| {
            let (below, rate, pull) = (side * s - self.c, side * w, side * self.g);
            let root = rate * rate - whole(2) * pull * below;
            if root < F256::ZERO {
                return None;
            }
            let root = Scalar::sqrt(root);
            let time = if rate > F256::ZERO && below < F256::ZERO {
                -whole(2) * below / (rate + root)
            } else if pull > F256::ZERO {
                (root - rate) / pull
            } else {
                return None;
            };
            Some((time, side, root))
        };
        let hits = [to(F256::ONE), to(-F256::ONE)].into_iter().flatten();
        let first = hits.reduce(|a, b| if a.0 < b.0 { a } else { b });
        self.add(Kind::Flight { s, w }, first.map(|first| first.0));
        first.map(|(_, side, rate)| (side, rate))
    }

    /// Goes through a contact; the rate at which it ends, below zero, if it does.
    fn contact(&mut self, side: F256, depth: F256, rate: F256) -> Option<F256> {
        let Law { stiffness: k, exponent: n, damping, .. } = self.law;
        let p = side * self.g;
        let elastic = damping == F256::ZERO;
        assert!(elastic || p == F256::ZERO, "no first integral is known");
        let ended = if elastic && n == 1.0 {
            self.swing(side, p, depth, rate)
        } else if depth > F256::ZERO {
            let off = p - k * power(depth, n);
            assert!(
                rate == F256::ZERO && Scalar::abs(off) < F256::from_f64(1e-60),
                "no closed form"
            );
            self.add(Kind::Still { side, depth }, None);
            None
        } else if elastic {
            let (lasts, push) = bounce(k, n, p, rate);
            self.add(Kind::Pressed, Some(lasts));
            Some((-rate, Some(push)))
        } else {
            let (lasts, ends) = self.damped(rate);
            self.add(Kind::Pressed, Some(lasts));
            Some((ends, None))
        };
        let (rate, push) = ended?;
        self.edge(false, rate);
        self.peaks.push(push);
        Some(rate)
    }

    /// A contact whose force is linear: the rate at its end and its largest force, if it ends.
    fn swing(
        &mut self,
        side: F256,
        p: F256,
        depth: F256,
        rate: F256,
    ) -> Option<(F256, Option<F256>)> {
        let k = self.law.stiffness;
        let pace = Scalar::sqrt(k);
        let (middle, sine) = (p / k, rate / pace);
        let cosine = depth - middle;
        let swing = Scalar::sqrt(cosine * cosine + sine * sine);
        let kind = Kind::Swing { side, middle, cosine, sine };
        if middle >= swing * (F256::ONE - F256::from_f64(1e-50)) {
            self.add(kind, None);
            return None;
        }
        let phase = F256::atan2(&sine, &cosine) + F256::acos(&(-middle / swing));
        self.add(kind, Some(phase / pace));
        let energy = rate * rate + k * depth * depth - whole(2) * p * depth;
        Some((-Scalar::sqrt(energy), Some(k * (middle + swing))))
    }

    /// Duration of a damped contact and the rate at its end.
    fn damped(&self, rate: F256) -> (F256, F256) {
        let Law { stiffness: k, exponent: n, damping: a, least } = self.law;
        let unit = Scalar::max(rate, least);
        let first = rate / unit;
        let of = |r: F256| r / a - Scalar::ln(F256::ONE + a * r) / (a * a);
        let level = of(first);
        // G falls from G(r₀) to zero and rises to it again: Newton from the far side
        let mut last = -first;
        for _ in 0..200 {
            let off = of(last) - level;
            let step = off * (F256::ONE + a * last) / last;
            // 1 + a r stays above zero
            last = Scalar::max(last - step, (last - F256::ONE / a) / whole(2));
            if Scalar::abs(off) < F256::from_f64(1e-68) {
                break;
            }
        }
        let n1 = F256::from_f64(n + 1.0);
        let depth_of = |below: F256| Scalar::powf(n1 * unit * unit * below / k, F256::ONE / n1);
        // dt = −u dr / (k δⁿ (1 + a r)); beside an end G(r₀) − G(r) by its Taylor series there
        let below = |end: F256, away: F256, inward: F256| {
            let small = a * away / (F256::ONE + a * end);
            if Scalar::abs(small) > F256::from_f64(1e-6) {
                return level - of(end + inward * away);
            }
            // G(e + x) − G(e) = x/a − ln(1 + y)/a², y = a x/(1 + a e)
            let (x, y) = (inward * away, inward * small);
            let mut log = F256::ZERO;
            for order in (1..=12i64).rev() {
                log = y * (F256::ratio(if order % 2 == 1 { 1 } else { -1 }, order) + log);
            }
            -(x / a - log / (a * a))
        };
        let middle = (first + last) / whole(2);
        let half = |end: F256, inward: F256| {
            let length = Scalar::abs(middle - end);
            quadrature(|share| {
                let away = length * share;
                let depth = depth_of(below(end, away, inward));
                let r = end + inward * away;
                length * unit / (k * power(depth, n) * (F256::ONE + a * r))
            })
        };
        (half(first, -F256::ONE) + half(last, F256::ONE), last * unit)
    }

    /// Until when states and edges are known (s).
    pub fn until(&self) -> F256 {
        self.until
    }

    /// The motion at a time, where it is known in closed form.
    pub fn at(&self, time: F256) -> Option<On> {
        if time > self.until {
            return None;
        }
        let piece = self.pieces.iter().rfind(|piece| piece.begin <= time)?;
        let t = time - piece.begin;
        match piece.kind {
            Kind::Flight { s, w } => Some(On {
                s: s + t * (w + self.g * t / whole(2)),
                w: w + self.g * t,
                push: F256::ZERO,
            }),
            Kind::Swing { side, middle, cosine, sine } => {
                let pace = Scalar::sqrt(self.law.stiffness);
                let (sin, cos) = Scalar::sin_cos(pace * t);
                let depth = middle + cosine * cos + sine * sin;
                Some(On {
                    s: side * (self.c + depth),
                    w: side * pace * (sine * cos - cosine * sin),
                    push: self.law.stiffness * depth,
                })
            }
            Kind::Pressed => None,
            Kind::Still { side, depth } => Some(On {
                s: side * (self.c + depth),
                w: F256::ZERO,
                push: self.law.stiffness * power(depth, self.law.exponent),
            }),
        }
    }
}

/// How long an elastic contact lasts that begins at a rate under a push p outward, and the largest
/// force over the mass.
pub fn bounce(k: F256, n: f64, p: F256, rate: F256) -> (F256, F256) {
    let n1 = F256::from_f64(n + 1.0);
    // v² at depth δ, and Newton for its zero from beyond
    let square = |x: F256| rate * rate + whole(2) * x * (p - k * power(x, n) / n1);
    let slope = |x: F256| whole(2) * (p - k * power(x, n));
    let mut deepest = Scalar::powf(n1 * rate * rate / (whole(2) * k), F256::ONE / n1)
        + match p > F256::ZERO {
            true => Scalar::powf(n1 * p / k, F256::ONE / F256::from_f64(n)),
            false => F256::ZERO,
        };
    for _ in 0..200 {
        let step = square(deepest) / slope(deepest);
        deepest -= step;
        if Scalar::abs(step) < deepest * F256::from_f64(1e-69) {
            break;
        }
    }
    // from the bottom δ = D (1 − z²): v²/D = −2 ∫ slope, without cancellation for small z
    let lasts = quadrature(|z| {
        let x = deepest * (F256::ONE - z * z);
        let v = match z < F256::from_f64(1e-20) {
            true => Scalar::sqrt(-slope(deepest) * deepest) * z,
            false => Scalar::sqrt(square(x)),
        };
        whole(4) * deepest * z / v
    });
    (lasts, k * power(deepest, n))
}

/// ∫ f over (0, 1) by the tanh-sinh rule, ends left out; f may be infinite there.
pub fn quadrature(f: impl Fn(F256) -> F256) -> F256 {
    let step = F256::ratio(1, 24);
    let half_pi = pi() / whole(2);
    let mut sum = F256::ZERO;
    for k in -110..=110i64 {
        let t = step * whole(k);
        let (up, down) = (Scalar::exp(t), Scalar::exp(-t));
        let (sinh, cosh) = ((up - down) / whole(2), (up + down) / whole(2));
        // x = 1/(1 + e^(−π sinh t)), of which the distance from zero keeps all its digits
        let e = Scalar::exp(-whole(2) * half_pi * sinh);
        let x = F256::ONE / (F256::ONE + e);
        let weight = whole(2) * half_pi * cosh * x * (e * x);
        if weight < F256::from_f64(1e-60) || !(x < F256::ONE) {
            continue;
        }
        sum += weight * f(x);
    }
    sum * step
}
