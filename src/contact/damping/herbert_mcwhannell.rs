//! Herbert, McWhannell: damping weight of the family `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//! ```text
//! a = 6 (1 − e)/[(2 e − 1)² + 3]
//! ```
//! For e of 0.8 and more. (Herbert, McWhannell 1977, J. Eng. Ind. 99(3):513–518.)

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "herbert-mcwhannell",
    formula: "a = 6 (1 − e)/[(2 e − 1)² + 3]",
    source: "Herbert, McWhannell 1977, J. Eng. Ind. 99(3):513–518",
    valid: "For e of 0.8 and more.",
    restitution: true,
};

/// The damping weight a for a restitution e in (0, 1].
pub fn weight<S: Scalar>(e: S) -> S {
    {
        let n = S::from_f64;
        let bent = n(2.0) * e - S::one();
        n(6.0) * (S::one() - e) / (bent * bent + n(3.0))
    }
}

#[cfg(test)]
mod tests {
    use crate::contact::rebound;

    #[test]
    fn it_rebounds_as_an_impact_that_was_integrated() {
        for (e, found) in [(0.9, 0.900893), (0.5, 0.593624), (0.3, 0.519967)] {
            assert!((rebound(super::weight(e)) - found).abs() < 6e-7, "{e}");
        }
        assert_eq!(super::weight(1.0), 0.0);
    }
}
