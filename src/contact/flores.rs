//! Normal force of Flores, Machado, Silva and Martins.
//! ```text
//! F_N = K δⁿ [ 1 + 8 (1 − c_e)/(5 c_e) · δ̇/δ̇⁽⁻⁾ ]
//! ```
//! | symbol | unit | meaning                               |
//! |--------|------|---------------------------------------|
//! | K      | N/mⁿ | generalized stiffness                 |
//! | n      | –    | 1.5 for metals                        |
//! | c_e    | –    | restitution, in (0, 1]                |
//! | δ̇⁽⁻⁾   | m/s  | penetration rate at the contact's begin |
//!
//! Made for soft contacts too: the rebound is slower than c_e δ̇⁽⁻⁾, by 0.7 % at c_e = 0.9, by 6 % at
//! 0.5 and by 15 % at 0.3. (P. Flores, M. Machado, M. T. Silva, J. M. Martins, On the continuous
//! contact force models for soft materials in multibody dynamics, Multibody System Dynamics 25
//! (2011) 357–375, doi 10.1007/s11044-010-9237-4. The publication itself was not seen.)

use crate::scalar::Scalar;

/// The damping weight a = 8 (1 − c_e)/(5 c_e).
pub fn damping_weight<S: Scalar>(restitution: S) -> S {
    S::ratio(8, 5) * (S::one() - restitution) / restitution
}
