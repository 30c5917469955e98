//! Kelvin and Voigt's contact: a linear spring beside a linear damper.
//! ```text
//! F_N = K δ + c δ̇
//! ```
//! | symbol | key         | unit  | meaning                   |
//! |--------|-------------|-------|---------------------------|
//! | K      | `stiffness` | N/m   | stiffness of the spring   |
//! | c      | `damping`   | N s/m | coefficient of the damper |
//!
//! (W. Goldsmith, Impact, Arnold, 1960; the closed form agrees with a public code's linear contact.) In
//! papers on clearance joints the name also stands for K δ while δ grows and e K δ while it shrinks,
//! which has no damper, jumps at the deepest point and rebounds at √e: that law is not this one.
//!
//! **The force jumps.** A contact begins with c δ̇⁽⁻⁾ and ends with −c times the speed of the rebound.
//! Both jumps are where the mode changes, and engines begin anew there, so that no step goes over one:
//! in the mode of a contact the force is the formula at any δ, and smooth. The greatest force of an
//! impact is the jump at its begin where ζ is more than 1/2. Samples and peaks at the moment of an event
//! have the force after it.
//!
//! An impact of a mass m by itself rebounds at e = exp(−π ζ/√(1 − ζ²)), ζ = c/(2 √(K m)), whatever its
//! speed.

use super::{DAMPING, Ends, ViscousLaw};
use crate::parameter::{Kind, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "kelvin-voigt",
    title: "spring and damper, F_N = K δ + c δ̇; the force jumps at both ends",
    source: "Goldsmith 1960, Impact, Arnold",
    example: r#"[joints.A.clearance]
normal = { law = "kelvin-voigt", damping = 200.0, stiffness = 2e7, exponent = 1.0 }"#,
    keys: &[DAMPING],
    also: None,
};

/// c (N s/m).
#[derive(Debug, Clone, Copy)]
pub struct KelvinVoigt<S>(S);

impl<S: Scalar> KelvinVoigt<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        KelvinVoigt(values.number("damping"))
    }
}

impl<S: Scalar> ViscousLaw<S> for KelvinVoigt<S> {
    const EXPONENT: (i64, i64) = (1, 1);
    const GROWTH: (u32, u32) = (0, 1);

    #[inline(always)]
    fn coefficient(&self) -> S {
        self.0
    }
}
