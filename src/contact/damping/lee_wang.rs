//! Lee, Wang: damping weight of the family `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//! ```text
//! a = 3 (1 − e)/4
//! ```
//! For e near one: an impact rebounds at 0.663 of its speed or more. (Lee, Wang 1983, J. Mech. Trans. Autom. Des. 105(3):534–540.)

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "lee-wang",
    formula: "a = 3 (1 − e)/4",
    source: "Lee, Wang 1983, J. Mech. Trans. Autom. Des. 105(3):534–540",
    valid: "For e near one: an impact rebounds at 0.663 of its speed or more.",
    restitution: true,
};

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    S::ratio(3, 4) * (S::one() - e)
}

#[cfg(test)]
mod tests {
    use crate::contact::rebound;

    #[test]
    fn it_rebounds_as_an_impact_that_was_integrated() {
        for (e, found) in [(0.9, 0.952370), (0.5, 0.799199), (0.3, 0.738995)] {
            assert!((rebound(super::weight(e)) - found).abs() < 6e-7, "{e}");
        }
        assert_eq!(super::weight(1.0), 0.0);
    }
}
