//! Hunt, Crossley: damping weight of the family `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//! ```text
//! a = 3 (1 − e)/2
//! ```
//! For e near one: however small e is, an impact rebounds at 0.488 of its speed or more. (Hunt, Crossley 1975, J. Appl. Mech. 42(2):440–445, doi 10.1115/1.3423596.)

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "hunt-crossley",
    formula: "a = 3 (1 − e)/2",
    source: "Hunt, Crossley 1975, J. Appl. Mech. 42(2):440–445, doi 10.1115/1.3423596",
    valid: "For e near one: however small e is, an impact rebounds at 0.488 of its speed or more.",
    restitution: true,
};

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    S::ratio(3, 2) * (S::one() - e)
}

#[cfg(test)]
mod tests {
    use crate::contact::rebound;

    #[test]
    fn it_rebounds_as_an_impact_that_was_integrated() {
        for (e, found) in [(0.9, 0.909016), (0.5, 0.662962), (0.3, 0.581288)] {
            assert!((rebound(super::weight(e)) - found).abs() < 6e-7, "{e}");
        }
        assert_eq!(super::weight(1.0), 0.0);
    }
}
