//! Flores, Machado, Silva, Martins: damping weight of the family `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//! ```text
//! a = 8 (1 − e)/(5 e)
//! ```
//! Within 0.045 of e for e of 0.3 and more. (Flores, Machado, Silva, Martins 2011, Multibody Syst. Dyn. 25:357–375, doi 10.1007/s11044-010-9237-4; the same in Ye, Li, Zhu 2009, Earthq. Eng. Struct. Dyn. 38:1135–1142.)

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "flores",
    formula: "a = 8 (1 − e)/(5 e)",
    source: "Flores, Machado, Silva, Martins 2011, Multibody Syst. Dyn. 25:357–375, doi 10.1007/s11044-010-9237-4; the same in Ye, Li, Zhu 2009, Earthq. Eng. Struct. Dyn. 38:1135–1142",
    valid: "Within 0.045 of e for e of 0.3 and more.",
    restitution: true,
};

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    S::ratio(8, 5) * (S::one() - e) / e
}

#[cfg(test)]
mod tests {
    use crate::contact::rebound;

    #[test]
    fn it_rebounds_as_an_impact_that_was_integrated() {
        for (e, found) in [(0.9, 0.893921), (0.5, 0.470445), (0.3, 0.256208)] {
            assert!((rebound(super::weight(e)) - found).abs() < 6e-7, "{e}");
        }
        assert_eq!(super::weight(1.0), 0.0);
    }
}
