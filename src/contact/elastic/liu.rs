//! Line contact of two cylinders that nearly fit, by Liu, Zhang and Yang.
//! ```text
//! F_e = (π/2) E* L δ √(δ/(2 (c + δ)))
//! ```
//! | symbol | key               | unit | meaning                                  |
//! |--------|-------------------|------|------------------------------------------|
//! | L      | `length`          | m    | length of the contact                    |
//! | E*     | `young`, `poisson`| Pa   | 1/E* = (1 − ν_b²)/E_b + (1 − ν_j²)/E_j   |
//! | c      |                   | m    | radial clearance R_b − R_j               |
//!
//! (C. Liu, K. Zhang, L. Yang, Normal force-displacement relationship of spherical joints with
//! clearances and its planar form, Mechanism and Machine Theory 42, 2007, 183–197, doi
//! 10.1016/j.mechmachtheory.2006.02.006; agrees with one public code, the print was not seen.)
//!
//! An elastic foundation: it grows as δ^(3/2) while δ is small beside c, and is three times as soft as
//! Johnson's law under small loads. Analytic in √δ.

use super::super::stiffness::composite;
use super::{ElasticLaw, Ends, LENGTH, POISSON, YOUNG, materials};
use crate::parameter::{Kind, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "liu",
    title: "line contact of a journal that nearly fits, F_e = (π/2) E* L δ √(δ/(2 (c + δ)))",
    source: "Liu, Zhang, Yang 2007, Mech. Mach. Theory 42:183–197, doi 10.1016/j.mechmachtheory.2006.02.006",
    example: r#"[joints.A.clearance]
normal = { law = "lankarani-nikravesh", restitution = 0.9, elastic = "liu", young = 207e9, poisson = 0.3, length = 0.015 }"#,
    keys: &[YOUNG, POISSON, LENGTH],
    also: None,
};

/// F_e = C δ^(3/2)/√(c + δ).
#[derive(Debug, Clone, Copy)]
pub struct Liu<S> {
    /// C (N/m).
    stiffness: S,
    /// c (m).
    radial: S,
}

impl<S: Scalar> Liu<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let modulus = composite(materials(values));
        let half = S::pi() * S::ratio(1, 2) * modulus * values.number("length");
        Liu { stiffness: half * S::ratio(1, 2).sqrt(), radial: ends.radial() }
    }

    /// F_e and its slope, from the depth and its root.
    #[inline(always)]
    fn at(&self, depth: S, root: S) -> (S, S) {
        let apart = self.radial + depth;
        let slope = self.stiffness * root / apart.sqrt();
        (slope * depth, slope * (S::from_f64(1.5) - S::from_f64(0.5) * depth / apart))
    }
}

impl<S: Scalar> ElasticLaw<S> for Liu<S> {
    #[inline(always)]
    fn force(&self, depth: S) -> (S, S) {
        self.at(depth, depth.sqrt())
    }

    /// With x = δ/c,
    /// ```text
    /// ∫₀^δ F dδ = C c² [(2 x − 3) √(x (1 + x)) + 3 ln(√x + √(1 + x))]/4
    ///           = (2/5) F δ Σ_k u^k Π_{i<k} (i + ½)/(i + 7/2),   u = δ/(c + δ)
    /// ```
    /// of which the first loses its digits where δ is small beside c, and the second is slow where it
    /// is large.
    fn energy(&self, depth: S) -> S {
        if depth > self.radial {
            let (x, one) = (depth / self.radial, S::one());
            let (root, next) = (x.sqrt(), (one + x).sqrt());
            let three = S::ratio(3, 1);
            let sum = (x + x - three) * root * next + three * (root + next).ln();
            return self.stiffness * self.radial * self.radial * sum * S::ratio(1, 4);
        }
        let u = depth / (self.radial + depth);
        let (mut sum, mut term, mut k) = (S::one(), S::one(), 0);
        while term.to_f64() > 0.1 * S::EPSILON || k < 4 {
            term = term * u * S::ratio(2 * k + 1, 2 * k + 7);
            sum += term;
            k += 1;
        }
        S::ratio(2, 5) * self.force(depth).0 * depth * sum
    }

    #[inline(always)]
    fn degree(&self) -> Option<u32> {
        Some(2)
    }

    #[inline(always)]
    fn force_from_root(&self, root: S) -> Option<(S, S)> {
        Some(self.at(root * root, root))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual64;

    #[test]
    fn both_forms_of_the_energy_meet_and_have_the_force_for_a_slope() {
        let law = Liu { stiffness: 1e9, radial: 5e-4 };
        let [below, above] = [1.0 - 1e-15, 1.0 + 1e-15].map(|share| law.energy(share * 5e-4));
        assert!((above / below - 1.0).abs() < 1e-14, "{below} {above}");
        let dual = Liu { stiffness: Dual64::from_re(1e9), radial: Dual64::from_re(5e-4) };
        for depth in [1e-4, 4e-4, 6e-4, 1e-2] {
            let slope = dual.energy(Dual64::new(depth, 1.0)).eps;
            let force = law.force(depth).0;
            assert!((slope / force - 1.0).abs() < 1e-13, "{depth}: {slope} {force}");
        }
    }
}
