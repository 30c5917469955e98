//! Line contact of two cylinders by Pereira, Ramalho and Ambrósio: a power law fitted to Johnson's.
//! ```text
//! F_e = [(α c + β) L E*/c] δⁿ,   α = 0.965,  β = 0.0965,  n = Y c^(−0.005)
//! Y = 1.51 [ln(1000 c)]^(−0.151)    0.005 mm ≤ c ≤ 0.34954 mm
//! Y = 0.0151 c + 1.151              0.34954 mm ≤ c ≤ 10 mm
//! ```
//! with mm, N and MPa: the journal inside its bearing.
//!
//! | symbol | key               | unit | meaning                                  |
//! |--------|-------------------|------|------------------------------------------|
//! | L      | `length`          | m    | length of the contact                    |
//! | E*     | `young`, `poisson`| Pa   | 1/E* = (1 − ν_b²)/E_b + (1 − ν_j²)/E_j   |
//! | c      |                   | m    | radial clearance R_b − R_j, 5 µm to 10 mm|
//!
//! (C. M. Pereira, A. L. Ramalho, J. A. Ambrósio, A critical overview of internal and external cylinder
//! contact force models, Nonlinear Dynamics 63, 2011, 681–697, doi 10.1007/s11071-010-9830-3; agrees with
//! one public code but for that code's second branch of Y, which it enters in m; the branches meet to 5e-8
//! as they stand here. The print was not seen.)
//!
//! The authors' own damping is that of Lankarani and Nikravesh; here any goes with it.

use super::super::stiffness::composite;
use super::power::Power;
use super::{ElasticLaw, Ends, LENGTH, POISSON, YOUNG, materials};
use crate::parameter::{Kind, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "pereira",
    title: "line contact fitted by a power, F_e = [(0.965 c + 0.0965) L E*/c] δⁿ in mm, N, MPa",
    source: "Pereira, Ramalho, Ambrósio 2011, Nonlinear Dyn. 63:681–697, doi 10.1007/s11071-010-9830-3",
    example: r#"[joints.A.clearance]
normal = { law = "lankarani-nikravesh", restitution = 0.9, elastic = "pereira", young = 207e9, poisson = 0.3, length = 0.015 }"#,
    keys: &[YOUNG, POISSON, LENGTH],
    also: None,
};

/// Clearances (mm) that the fit is for.
const FITTED: [f64; 2] = [0.005, 10.0];
/// Clearance (mm) at which one branch of Y follows the other.
const BRANCH: f64 = 0.34954;
/// mm in a m.
const MILLI: f64 = 1e3;
/// Pa in a MPa.
const MEGA: f64 = 1e6;

/// The power law that the fit comes to.
#[derive(Debug, Clone, Copy)]
pub struct Pereira<S> {
    power: Power<S>,
    /// Clearance (mm).
    radial: f64,
}

impl<S: Scalar> Pereira<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let number = |text: &str| S::parse(text).unwrap_or(S::zero());
        let milli = S::from_f64(MILLI);
        let (c, length) = (ends.radial() * milli, values.number::<S>("length") * milli);
        let modulus = composite(materials::<S>(values)) / S::from_f64(MEGA);
        let y = match c.to_f64() <= BRANCH {
            true => number("1.51") * (c * milli).ln().powf(number("-0.151")),
            false => number("0.0151") * c + number("1.151"),
        };
        let exponent = y * c.powf(number("-0.005"));
        let stiffness = (number("0.965") * c + number("0.0965")) * length * modulus / c;
        let power = Power::with(stiffness * milli.powf(exponent), exponent);
        Pereira { power, radial: c.to_f64() }
    }
}

impl<S: Scalar> ElasticLaw<S> for Pereira<S> {
    #[inline(always)]
    fn force(&self, depth: S) -> (S, S) {
        self.power.force(depth)
    }

    fn energy(&self, depth: S) -> S {
        self.power.energy(depth)
    }

    #[inline(always)]
    fn degree(&self) -> Option<u32> {
        self.power.degree()
    }

    #[inline(always)]
    fn force_from_root(&self, root: S) -> Option<(S, S)> {
        self.power.force_from_root(root)
    }

    fn power(&self) -> Option<(S, S)> {
        self.power.power()
    }

    fn objection(&self) -> Option<String> {
        let [least, most] = FITTED;
        let holds = self.radial >= least && self.radial <= most;
        let radial = self.radial;
        (!holds).then(|| {
            format!("law \"pereira\" is for radial clearances of {least} to {most} mm, this is {radial:.4} mm")
        })
    }
}
