//! Hu, Guo: damping weight of the family `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//! ```text
//! a = 3 (1 − e)/(2 e)
//! ```
//! Within 0.03 of e for e of 0.3 and more. Half of this weight is printed in places; it would rebound at 0.947 for e = 0.9. (Hu, Guo 2015, Multibody Syst. Dyn. 35:131–151.)

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "hu-guo",
    formula: "a = 3 (1 − e)/(2 e)",
    source: "Hu, Guo 2015, Multibody Syst. Dyn. 35:131–151",
    valid: "Within 0.03 of e for e of 0.3 and more. Half of this weight is printed in places; it would rebound at 0.947 for e = 0.9.",
    restitution: true,
};

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    S::ratio(3, 2) * (S::one() - e) / e
}

#[cfg(test)]
mod tests {
    use crate::contact::rebound;

    #[test]
    fn it_rebounds_as_an_impact_that_was_integrated() {
        for (e, found) in [(0.9, 0.899900), (0.5, 0.487741), (0.3, 0.270658)] {
            assert!((rebound(super::weight(e)) - found).abs() < 6e-7, "{e}");
        }
        assert_eq!(super::weight(1.0), 0.0);
    }
}
