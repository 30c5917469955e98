//! What the line contacts with a logarithm have in common.
//! ```text
//! δ = s F [1 + ln(F_m/F)],   s = 1/(π E* L),   1/E* = (1 − ν_b²)/E_b + (1 − ν_j²)/E_j
//! ```
//! They differ in F_m alone, the force at which dδ/dF = s ln(F_m/F) is zero: there the formula ends,
//! at the depth δ_m = s F_m. With d = δ/δ_m and w = 1 + ln(F_m/F),
//! ```text
//! w − ln w = 1 − ln d,   F = δ/(s w),   dF/dδ = 1/(s (w − 1)),   ∫F dδ = s F² (2 w − 1)/4
//! ```
//! so that w is −W₋₁(−d/e), the lower branch of Lambert's function. It is found to rounding: a start
//! good to 2.5e-4 (D. A. Barry, P. J. Culligan-Hensley, S. J. Barry, Real values of the W-function,
//! ACM Trans. Math. Softw. 21:161–171, 1995), then steps of fourth order (F. N. Fritsch, R. E.
//! Shafer, W. P. Crowley, Algorithm 443, Commun. ACM 16:123–124, 1973).
//!
//! The slope dF/dδ tends to zero at δ = 0 as slowly as one over a logarithm. No power of δ makes such
//! a contact smooth at its ends.

use super::super::stiffness::{Material, composite};
use crate::scalar::Scalar;

/// δ = s F [1 + ln(F_m/F)].
#[derive(Debug, Clone, Copy)]
pub struct Logarithmic<S> {
    /// s (m/N).
    compliance: S,
    /// One over it (N/m).
    stiffness: S,
    /// δ_m (m).
    deepest: S,
}

impl<S: Scalar> Logarithmic<S> {
    /// A law with its materials, the length L (m) of the contact, and the depth δ_m (m) that it ends
    /// at.
    pub fn new(materials: [Material<S>; 2], length: S, deepest: S) -> Self {
        let stiffness = S::pi() * composite(materials) * length;
        Logarithmic { compliance: S::one() / stiffness, stiffness, deepest }
    }

    /// w = 1 + ln(F_m/F) at a depth (m); one where the law has ended.
    #[inline(always)]
    fn branch(&self, depth: S) -> S {
        let fallen = -(depth / self.deepest).ln();
        if fallen.to_f64() > S::EPSILON { lower_branch(fallen) } else { S::one() }
    }

    /// F (N) and dF/dδ (N/m) at a positive depth (m).
    #[inline(always)]
    pub fn force(&self, depth: S) -> (S, S) {
        let w = self.branch(depth);
        let left = w - S::one();
        let slope = if left > S::zero() { self.stiffness / left } else { self.stiffness };
        (depth * self.stiffness / w, slope)
    }

    /// Energy (J) stored at a positive depth (m).
    pub fn energy(&self, depth: S) -> S {
        let w = self.branch(depth);
        let force = depth * self.stiffness / w;
        self.compliance * force * force * (w + w - S::one()) * S::ratio(1, 4)
    }

    /// The depth (m) at which the law ends.
    pub fn deepest(&self) -> f64 {
        self.deepest.to_f64()
    }
}

/// Lets a law that holds a [`Logarithmic`] be that.
macro_rules! logarithmic {
    ($law:ident) => {
        impl<S: Scalar> super::ElasticLaw<S> for $law<S> {
            #[inline(always)]
            fn force(&self, depth: S) -> (S, S) {
                self.0.force(depth)
            }

            fn energy(&self, depth: S) -> S {
                self.0.energy(depth)
            }

            fn deepest(&self) -> f64 {
                self.0.deepest()
            }
        }
    };
}
pub(super) use logarithmic;

/// −W₋₁(−e^(−1−l)) for l > 0: the w > 1 with w − ln w = 1 + l.
#[inline(always)]
fn lower_branch<S: Scalar>(l: S) -> S {
    let mut w = S::from_f64(start(l.to_f64()));
    let mut places = 1e-3_f64;
    // numbers that carry a derivative need a step more, for the start has none
    let mut more = if S::CARRIES_DERIVATIVE { 2 } else { 0 };
    loop {
        // of W = −w
        let z = w - S::one() - l - w.ln();
        let below = S::one() - w;
        let q = (below + below) * (below + z * S::ratio(2, 3));
        w += w * (z / below * ((q - z) / (q - z - z)));
        places = places.powi(4);
        if places <= S::EPSILON {
            if more == 0 {
                return w;
            }
            more -= 1;
        }
    }
}

/// Barry's approximation of it.
#[inline(always)]
fn start(l: f64) -> f64 {
    const M: [f64; 3] = [0.3361, -0.0042, -0.0201];
    let inner = 1.0 + M[0] * (0.5 * l).sqrt() / (1.0 + M[1] * l * (M[2] * l.sqrt()).exp());
    1.0 + l + 2.0 / M[0] * (1.0 - 1.0 / inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::{Dual, Dual64, F256};

    /// How far w is from w − ln w = 1 + l, over the change that the last place of l makes.
    fn off<S: Scalar>(l: S) -> f64 {
        let w = lower_branch(l);
        let error = w - w.ln() - S::one() - l;
        error.abs().to_f64() / (S::EPSILON * w.to_f64())
    }

    #[test]
    fn the_equation_holds_to_rounding_in_doubles_and_in_71_digits() {
        let mut l = 1e-9_f64;
        while l < 800.0 {
            assert!(off(l) < 4.0, "{l:e}: {}", off(l));
            assert!(off(F256::from_f64(l)) < 8.0, "{l:e}: {} in 71 digits", off(F256::from_f64(l)));
            l *= 1.07;
        }
    }

    #[test]
    fn derivatives_are_carried_through_the_iteration() {
        for l in [1e-3, 0.1, 3.0, 20.0, 300.0] {
            // dw/dl = w/(w − 1), d²w/dl² = −w/(w − 1)³
            let w = lower_branch(l);
            let first = lower_branch(Dual64::new(l, 1.0)).eps;
            assert!((first * (w - 1.0) / w - 1.0).abs() < 1e-12, "{l}: {first}");
            let nested = Dual::new(Dual64::new(l, 1.0), Dual64::from_re(1.0));
            let second = lower_branch(nested).eps.eps;
            assert!((-second * (w - 1.0).powi(3) / w - 1.0).abs() < 1e-9, "{l}: {second}");
        }
    }
}
