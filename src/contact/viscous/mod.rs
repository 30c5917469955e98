//! Laws whose damping knows nothing of the impact, one file a law.
//! ```text
//! F_N = K δⁿ + c δ^p δ̇
//! ```
//! Each goes with one exponent n of the power law, and has its own p. Near the end of a contact all of
//! them pull: the contact ends where δ is zero again, and with `tension = "cut"` there is no force
//! from the moment on at which it would pull. What an impact rebounds at depends on the mass, and may
//! depend on the speed.
//!
//! Over the angle θ in the plane of rate and root of the stored energy, v = ρ cos θ and √(2 E/m) = ρ
//! sin θ, an impact by itself goes from θ = 0 to π by
//! ```text
//! d ln ρ/dθ = −C cos² θ/(1 + C sin θ cos θ),   C = c δ^p √(2 E/m)/(K δⁿ)
//! ```
//! C is 2 ζ, a constant, where n = 2 p + 1, and then the rebound is exp(−π ζ/√(1 − ζ²)).
//!
//! A new law is a file here and its line in the list of kinds.

use crate::parameter::{Key, Range, Takes, Values, kinds};
use crate::scalar::Scalar;

kinds! { $
    /// A law of viscous damping of any kind.
    #[derive(Copy)]
    Viscous, each_viscous:
    KelvinVoigt in kelvin_voigt,
    Tsuji in tsuji,
    KuwabaraKono in kuwabara_kono,
}

/// What a law is made of beside its values.
#[derive(Debug, Clone, Copy)]
pub struct Ends<S> {
    /// Stiffness K (N/mⁿ) of the elastic part.
    pub stiffness: S,
}

/// What a law of viscous damping tells.
pub trait ViscousLaw<S: Scalar> {
    /// The exponent n of the elastic force that it goes with, as a quotient.
    const EXPONENT: (i64, i64);

    /// p, as a quotient: the damping is c δ^p.
    const GROWTH: (u32, u32);

    /// c (N s/m^(1+p)).
    fn coefficient(&self) -> S;

    /// That exponent.
    fn exponent(&self) -> f64 {
        Self::EXPONENT.0 as f64 / Self::EXPONENT.1 as f64
    }

    /// The q such that force and damping are polynomials in δ^(1/q).
    #[inline(always)]
    fn degree(&self) -> u32 {
        Self::GROWTH.1.max(Self::EXPONENT.1 as u32)
    }

    /// c δ^p (N s/m) and its slope (N s/m²) at a positive depth (m).
    #[inline(always)]
    fn damping(&self, depth: S) -> (S, S) {
        let root = match Self::GROWTH.1 {
            1 => depth,
            2 => depth.sqrt(),
            4 => depth.sqrt().sqrt(),
            q => depth.powf(S::ratio(1, i64::from(q))),
        };
        self.grown(root, depth)
    }

    /// The same from the root r of the depth, for the q of [`degree`](Self::degree).
    #[inline(always)]
    fn damping_from_root(&self, root: S) -> (S, S) {
        let power = |k: u32| (0..k).fold(S::one(), |product, _| product * root);
        let q = self.degree();
        self.grown(power(q / Self::GROWTH.1), power(q))
    }

    /// c δ^p and its slope, from the root that p is a power of.
    #[inline(always)]
    fn grown(&self, root: S, depth: S) -> (S, S) {
        let (k, q) = Self::GROWTH;
        let value = (0..k).fold(self.coefficient(), |product, _| product * root);
        let slope = match k {
            0 => S::zero(),
            _ => value / depth * S::ratio(i64::from(k), i64::from(q)),
        };
        (value, slope)
    }

    /// ζ of a mass (kg) on the stiffness K (N/mⁿ), where that is one number whatever the speed.
    fn damping_ratio(&self, stiffness: f64, mass: f64) -> Option<f64> {
        let n = self.exponent();
        let p = f64::from(Self::GROWTH.0) / f64::from(Self::GROWTH.1);
        let coefficient = self.coefficient().to_f64();
        (n == 2.0 * p + 1.0).then(|| coefficient / (2.0 * (n + 1.0) * stiffness * mass).sqrt())
    }
}

impl<S: Scalar> Viscous<S> {
    /// The exponent n of the elastic force that the law goes with.
    pub fn exponent(&self) -> f64 {
        each_viscous!(self, law => law.exponent())
    }

    /// Whether there is any damping.
    pub fn damps(&self) -> bool {
        each_viscous!(self, law => law.coefficient() > S::zero())
    }

    /// See [`ViscousLaw::degree`].
    pub fn degree(&self) -> u32 {
        each_viscous!(self, law => law.degree())
    }

    /// See [`ViscousLaw::damping`].
    #[inline(always)]
    pub fn damping(&self, depth: S) -> (S, S) {
        each_viscous!(self, law => law.damping(depth))
    }

    /// See [`ViscousLaw::damping_from_root`].
    #[inline(always)]
    pub fn damping_from_root(&self, root: S) -> (S, S) {
        each_viscous!(self, law => law.damping_from_root(root))
    }

    /// See [`ViscousLaw::damping_ratio`].
    pub fn damping_ratio(&self, stiffness: f64, mass: f64) -> Option<f64> {
        each_viscous!(self, law => law.damping_ratio(stiffness, mass))
    }
}

/// ζ with which an impact rebounds at e of its speed.
fn ratio_of<S: Scalar>(restitution: S) -> S {
    let log = restitution.ln();
    -log / (log * log + S::pi() * S::pi()).sqrt()
}

/// What an impact rebounds at with a damping ratio ζ; with ζ of one and more the mass never comes back.
pub fn rebound_of(damping_ratio: f64) -> f64 {
    let left = 1.0 - damping_ratio * damping_ratio;
    if left > 0.0 { (-std::f64::consts::PI * damping_ratio / left.sqrt()).exp() } else { 0.0 }
}

/// The coefficient of the damping, where the case gives it.
const DAMPING: Key =
    Key::new("damping", Takes::Number(Range::NotNegative), "N s/m", "coefficient c of the damper");
