//! Lankarani–Nikravesh normal force.
//! ```text
//! F_N = K δⁿ + D δ̇,  D = χ δⁿ,  χ = 3K (1 − c_e²)/(4 δ̇⁽⁻⁾)      (paper, eq. 4, 7, 8)
//!     = K δⁿ [ 1 + ¾ (1 − c_e²) δ̇/δ̇⁽⁻⁾ ]                        (paper, eq. 9)
//! ```
//! | symbol | unit | meaning                               |
//! |--------|------|---------------------------------------|
//! | K      | N/mⁿ | generalized stiffness, eq. 5          |
//! | n      | –    | 1.5 for metals                        |
//! | c_e    | –    | restitution, in (0, 1]                |
//! | δ̇⁽⁻⁾   | m/s  | penetration rate at the contact's begin |
//!
//! Holds for c_e near one: the rebound is faster than c_e δ̇⁽⁻⁾, by 1.5 % at c_e = 0.9 and by 45 %
//! at 0.5. (Lankarani, Nikravesh 1990, J. Mech. Des. 112(3):369–376, doi 10.1115/1.2912617.)

use super::About;
use crate::scalar::Scalar;

/// What it says of itself.
pub const ABOUT: About = About {
    word: "lankarani-nikravesh",
    formula: "a = 3 (1 − e²)/4",
    source: "Lankarani, Nikravesh 1990, J. Mech. Des. 112(3):369–376, doi 10.1115/1.2912617",
    valid: "For e near one: an impact rebounds at 0.663 of its speed or more.",
    restitution: true,
};

/// The damping weight a = ¾ (1 − c_e²).
pub fn weight<S: Scalar>(restitution: S) -> S {
    S::ratio(3, 4) * (S::one() - restitution * restitution)
}
