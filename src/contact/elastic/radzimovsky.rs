//! Radzimovsky's line contact of two cylinders.
//! ```text
//! δ = F/(π E* L) [2/3 + ln(4 R_b/b) + ln(4 R_j/b)],   b = 2 a = 2 √(4 F R_b R_j/(π E* L c))
//! ```
//! | symbol   | key               | unit | meaning                                  |
//! |----------|-------------------|------|------------------------------------------|
//! | L        | `length`          | m    | length of the contact                    |
//! | E*       | `young`, `poisson`| Pa   | 1/E* = (1 − ν_b²)/E_b + (1 − ν_j²)/E_j   |
//! | R_b, R_j |                   | m    | radii of bearing and journal             |
//! | c        |                   | m    | radial clearance R_b − R_j               |
//!
//! (E. I. Radzimovsky, Stress distribution and strength conditions of two rolling cylinders pressed
//! together, University of Illinois, Engineering Experiment Station, Bulletin 408, 1953; the print was
//! not seen.)
//!
//! Of b conflicting forms are about: b = 1.60 √(F K_D/(L E*)) with the *diameters* in K_D = D_b D_j/(D_b
//! − D_j) is the full width of the contact to 0.3 %, and is meant here, without its rounding; papers and
//! a public code on clearance joints put radii there, which makes b smaller by √2 and δ larger by 8 % in
//! a common joint.
//!
//! The formula ends where dδ/dF = 0, at δ = c e^(−1/3) = 0.717 c.

use super::logarithmic::{Logarithmic, logarithmic};
use super::{Ends, LENGTH, POISSON, YOUNG, materials};
use crate::parameter::{Kind, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "radzimovsky",
    title: "line contact, δ = F/(π E* L) [2/3 + ln(4 R_b/b) + ln(4 R_j/b)]",
    source: "Radzimovsky 1953, University of Illinois, Engineering Experiment Station, Bulletin 408",
    example: r#"[joints.A.clearance]
normal = { law = "lankarani-nikravesh", restitution = 0.9, elastic = "radzimovsky", young = 207e9, poisson = 0.3, length = 0.015 }"#,
    keys: &[YOUNG, POISSON, LENGTH],
    also: None,
};

/// The law.
#[derive(Debug, Clone, Copy)]
pub struct Radzimovsky<S>(Logarithmic<S>);

impl<S: Scalar> Radzimovsky<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        // 16 R_b R_j/b² = π E* c L/F
        let deepest = ends.radial() * S::ratio(-1, 3).exp();
        Radzimovsky(Logarithmic::new(materials(values), values.number("length"), deepest))
    }
}

logarithmic!(Radzimovsky);
