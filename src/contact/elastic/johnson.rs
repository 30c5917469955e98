//! Johnson's line contact of two cylinders.
//! ```text
//! δ = F/(π E* L) [ln(4 π E* c L/F) − 1]
//! ```
//! | symbol | key               | unit | meaning                                  |
//! |--------|-------------------|------|------------------------------------------|
//! | L      | `length`          | m    | length of the contact                    |
//! | E*     | `young`, `poisson`| Pa   | 1/E* = (1 − ν_b²)/E_b + (1 − ν_j²)/E_j   |
//! | c      |                   | m    | radial clearance R_b − R_j               |
//!
//! (K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, doi 10.1017/CBO9781139171731.
//! Agrees with one public code, and with the sum over both bodies of F (1 − ν²)/(π E L) [2 ln(4 R/a) −
//! 1] at the half-width a = √(4 F R_b R_j/(π E* L c)); the print was not seen.)
//!
//! Holds while a is small beside the journal's radius. The formula ends where dδ/dF = 0, at δ = 4 c/e²
//! = 0.541 c.

use super::logarithmic::{Logarithmic, logarithmic};
use super::{Ends, LENGTH, POISSON, YOUNG, materials};
use crate::parameter::{Kind, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "johnson",
    title: "line contact, δ = F/(π E* L) [ln(4 π E* c L/F) − 1]",
    source: "Johnson 1985, Contact Mechanics, Cambridge University Press, doi 10.1017/CBO9781139171731",
    example: r#"[joints.A.clearance]
normal = { law = "lankarani-nikravesh", restitution = 0.9, elastic = "johnson", young = 207e9, poisson = 0.3, length = 0.015 }"#,
    keys: &[YOUNG, POISSON, LENGTH],
    also: None,
};

/// The law.
#[derive(Debug, Clone, Copy)]
pub struct Johnson<S>(Logarithmic<S>);

impl<S: Scalar> Johnson<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        // ln(4 π E* c L/F) − 1 = 1 + ln(F_m/F)
        let deepest = S::ratio(4, 1) * ends.radial() * S::from_f64(-2.0).exp();
        Johnson(Logarithmic::new(materials(values), values.number("length"), deepest))
    }
}

logarithmic!(Johnson);
