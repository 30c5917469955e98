//! Gonthier, McPhee, Lange, Piedbœuf: damping weight of the family `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//! ```text
//! a = (1 − e²)/e
//! ```
//! The approximation in closed form; best below e = 0.5. Their implicit equation is the law `exact`. (Gonthier, McPhee, Lange, Piedbœuf 2004, Multibody Syst. Dyn. 11:209–233, doi 10.1023/B:MUBO.0000029392.21648.bc.)

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "gonthier",
    formula: "a = (1 − e²)/e",
    source: "Gonthier, McPhee, Lange, Piedbœuf 2004, Multibody Syst. Dyn. 11:209–233, doi 10.1023/B:MUBO.0000029392.21648.bc",
    valid: "The approximation in closed form; best below e = 0.5. Their implicit equation is the law `exact`.",
    restitution: true,
};

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    (S::one() - e * e) / e
}

#[cfg(test)]
mod tests {
    use crate::contact::rebound;

    #[test]
    fn it_rebounds_as_an_impact_that_was_integrated() {
        for (e, found) in [(0.9, 0.876435), (0.5, 0.487741), (0.3, 0.304225)] {
            assert!((rebound(super::weight(e)) - found).abs() < 6e-7, "{e}");
        }
        assert_eq!(super::weight(1.0), 0.0);
    }
}
