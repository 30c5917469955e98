//! Kuwabara and Kono's law: two viscoelastic spheres.
//! ```text
//! F_N = K δ^(3/2) + c δ^(1/2) δ̇
//! ```
//! | symbol | key         | unit      | meaning                                     |
//! |--------|-------------|-----------|---------------------------------------------|
//! | K      | `stiffness` | N/m^1.5   | stiffness, of a power law with exponent 3/2 |
//! | c      | `damping`   | N s/m^1.5 | a constant of shape and material            |
//!
//! (G. Kuwabara, K. Kono, Restitution coefficient in a collision between two spheres, Japanese Journal of
//! Applied Physics 26, 1987, 1230–1233, doi 10.1143/JJAP.26.1230; the print was not seen. The quasi-static
//! law of viscoelastic spheres of others is the same, with c = (3/2) K A.)
//!
//! Fast impacts lose more than slow ones: 1 − e grows as the fifth root of the speed while it is small.
//! No closed form is known; `freeplay laws` and tests integrate the impact by itself. The force begins
//! at zero, analytic in √δ.

use super::{DAMPING, Ends, ViscousLaw};
use crate::parameter::{Key, Kind, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "kuwabara-kono",
    title: "viscoelastic spheres, F_N = K δ^(3/2) + c δ^(1/2) δ̇: fast impacts lose more",
    source: "Kuwabara, Kono 1987, Jpn. J. Appl. Phys. 26:1230–1233, doi 10.1143/JJAP.26.1230",
    example: r#"[joints.A.clearance]
normal = { law = "kuwabara-kono", damping = 2e4, stiffness = 1e10 }"#,
    keys: &[Key {
        unit: "N s/m^1.5",
        about: "coefficient c of the damping, a constant of shape and material",
        ..DAMPING
    }],
    also: None,
};

/// c (N s/m^1.5).
#[derive(Debug, Clone, Copy)]
pub struct KuwabaraKono<S>(S);

impl<S: Scalar> KuwabaraKono<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        KuwabaraKono(values.number("damping"))
    }
}

impl<S: Scalar> ViscousLaw<S> for KuwabaraKono<S> {
    const EXPONENT: (i64, i64) = (3, 2);
    const GROWTH: (u32, u32) = (1, 2);

    #[inline(always)]
    fn coefficient(&self) -> S {
        self.0
    }
}
