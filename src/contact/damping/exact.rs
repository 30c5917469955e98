//! Exact: the damping weight with which one isolated impact rebounds at just the restitution e.
//! ```text
//! a (1 + e) = ln[(1 + a)/(1 − a e)],   0 < a < 1/e
//! ```
//! The root does not depend on the stiffness, the exponent, the mass or the speed. (Gonthier, McPhee,
//! Lange, Piedbœuf 2004, doi 10.1023/B:MUBO.0000029392.21648.bc, and Zhang, Sharf 2009, J. Appl. Mech.
//! 76:051002 have the equation.)

use super::{About, carvalho_martins};
use crate::scalar::{F256, Scalar};

/// What it says of itself.
pub const ABOUT: About = About {
    word: "exact",
    formula: "a (1 + e) = ln[(1 + a)/(1 − a e)]",
    source: "Gonthier, McPhee, Lange, Piedbœuf 2004, Multibody Syst. Dyn. 11:209–233, doi \
             10.1023/B:MUBO.0000029392.21648.bc; Zhang, Sharf 2009, J. Appl. Mech. 76:051002",
    valid: "Every e: an impact without other forces rebounds at e of its speed.",
    restitution: true,
};

/// Nearer to one than this the equation, in 71 digits, loses more places than its series.
const NEAR_ONE: f64 = 1e-15;
/// Coefficients of a in powers of 1 − e, from the first on, as quotients.
const SERIES: [(i64, i64); 3] = [(3, 2), (3, 2), (27, 20)];

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    if S::EPSILON > <F256 as Scalar>::EPSILON {
        // near e = 1 the equation has few places in doubles
        return S::from_octuple(weight(F256::from_f64(e.to_f64())));
    }
    let left = S::one() - e;
    if left.to_f64() < NEAR_ONE {
        return SERIES.iter().rev().fold(S::zero(), |sum, (p, q)| (sum + S::ratio(*p, *q)) * left);
    }
    let value = |a: S| a * (S::one() + e) - ((S::one() + a) / (S::one() - a * e)).ln();
    let slope = |a: S| S::one() + e - S::one() / (S::one() + a) - e / (S::one() - a * e);
    // above zero below the root, beyond it below; a false root at zero
    let (mut low, mut high) = (S::ratio(3, 4) * left, S::one() / e);
    let mut a = carvalho_martins::weight(e).min(S::from_f64(0.999) * high);
    for _ in 0..400 {
        let f = value(a);
        if f > S::zero() { low = a } else { high = a }
        let newton = a - f / slope(a);
        let next = match newton > low && newton < high {
            true => newton,
            false => (low + high) * S::ratio(1, 2),
        };
        let moved = (next - a).abs();
        a = next;
        if moved.to_f64() <= 2.0 * S::EPSILON * a.to_f64() {
            break;
        }
    }
    a
}

#[cfg(test)]
mod tests {
    use crate::contact::rebound;
    use crate::scalar::{F256, Scalar};

    #[test]
    fn it_is_the_root_that_was_computed_in_many_digits() {
        for (e, a) in [
            (0.05, 20.0),
            (0.1, 9.998159),
            (0.2, 4.919167),
            (0.3, 3.087082),
            (0.5, 1.432751),
            (0.7, 0.634828),
            (0.9, 0.166482),
            (0.99, 0.015151),
        ] {
            assert!((super::weight::<f64>(e) - a).abs() < 6e-7 * a.max(1.0), "{e}");
        }
    }

    #[test]
    fn an_impact_rebounds_at_the_restitution() {
        for k in 1..=1000 {
            let e = f64::from(k) / 1000.0;
            let found = rebound(super::weight(e));
            assert!((found - e).abs() < 1e-11, "{e} {found}");
        }
    }

    #[test]
    fn in_71_digits_it_is_the_same_weight_with_more_places() {
        for e in ["0.05", "0.3", "0.9", "0.9989", "0.9995"] {
            let exact = super::weight(F256::parse(e).unwrap());
            let double = super::weight(f64::parse(e).unwrap());
            let off = (exact.to_f64() - double).abs() / double;
            assert!(off < 1e-12, "{e}: {off:e}");
        }
    }
}
