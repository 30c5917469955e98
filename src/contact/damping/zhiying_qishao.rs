//! Qin Zhiying, Lu Qishao: damping weight of the family `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//! ```text
//! a = ¾ (1 − e²) exp[2 (1 − e)]
//! ```
//! Within 0.03 of e for e of 0.3 and more. (Qin Zhiying, Lu Qishao 2006, J. Vib. Shock 25(5).)

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "zhiying-qishao",
    formula: "a = ¾ (1 − e²) exp[2 (1 − e)]",
    source: "Qin Zhiying, Lu Qishao 2006, J. Vib. Shock 25(5)",
    valid: "Within 0.03 of e for e of 0.3 and more.",
    restitution: true,
};

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    {
        let left = S::one() - e;
        S::ratio(3, 4) * (S::one() - e * e) * (left + left).exp()
    }
}

#[cfg(test)]
mod tests {
    use crate::contact::rebound;

    #[test]
    fn it_rebounds_as_an_impact_that_was_integrated() {
        for (e, found) in [(0.9, 0.895918), (0.5, 0.482608), (0.3, 0.326697)] {
            assert!((rebound(super::weight(e)) - found).abs() < 6e-7, "{e}");
        }
        assert_eq!(super::weight(1.0), 0.0);
    }
}
