//! Carvalho, Martins: damping weight of the family `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//! ```text
//! a = (3/2) (1 − e) (11 − e)/(1 + 9 e)
//! ```
//! Within 0.0002 of e for e of 0.5 and more, 0.004 at 0.3; poor below 0.2. (Carvalho, Martins 2019, Mech. Mach. Theory 139:174–194, doi 10.1016/j.mechmachtheory.2019.03.028.)

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "carvalho-martins",
    formula: "a = (3/2) (1 − e) (11 − e)/(1 + 9 e)",
    source: "Carvalho, Martins 2019, Mech. Mach. Theory 139:174–194, doi 10.1016/j.mechmachtheory.2019.03.028",
    valid: "Within 0.0002 of e for e of 0.5 and more, 0.004 at 0.3; poor below 0.2.",
    restitution: true,
};

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    {
        let n = S::from_f64;
        S::ratio(3, 2) * (S::one() - e) * (n(11.0) - e) / (S::one() + n(9.0) * e)
    }
}

#[cfg(test)]
mod tests {
    use crate::contact::rebound;

    #[test]
    fn it_rebounds_as_an_impact_that_was_integrated() {
        for (e, found) in [(0.9, 0.899999), (0.5, 0.500174), (0.3, 0.303974)] {
            assert!((rebound(super::weight(e)) - found).abs() < 6e-7, "{e}");
        }
        assert_eq!(super::weight(1.0), 0.0);
    }
}
