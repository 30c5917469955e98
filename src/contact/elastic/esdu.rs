//! Line contact of two cylinders by ESDU's data item 78035.
//! ```text
//! δ = F σ/L [ln(4 L c/(F σ)) + 1],   σ = h_b + h_j = 1/(π E*),   h = (1 − ν²)/(π E)
//! ```
//! | symbol | key               | unit | meaning                                  |
//! |--------|-------------------|------|------------------------------------------|
//! | L      | `length`          | m    | length of the contact                    |
//! | E*     | `young`, `poisson`| Pa   | 1/E* = (1 − ν_b²)/E_b + (1 − ν_j²)/E_j   |
//! | c      |                   | m    | radial clearance R_b − R_j               |
//!
//! (Engineering Sciences Data Unit, Contact phenomena I: stresses, deflections and contact dimensions
//! for normally loaded unlubricated elastic components, ESDU 78035, London, 1978; the data item was not
//! seen.)
//!
//! Conflicting prints are about: a public code has h without the π and another π before the formula,
//! which makes δ eleven times as large as Johnson's. The form here is Johnson's with + 1 for − 1, and 24 %
//! softer in a common joint.
//!
//! The formula ends where dδ/dF = 0, at δ = 4 c.

use super::logarithmic::{Logarithmic, logarithmic};
use super::{Ends, LENGTH, POISSON, YOUNG, materials};
use crate::parameter::{Kind, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "esdu-78035",
    title: "line contact, δ = F σ/L [ln(4 L c/(F σ)) + 1]",
    source: "ESDU 78035, Contact phenomena I, Engineering Sciences Data Unit, London, 1978",
    example: r#"[joints.A.clearance]
normal = { law = "lankarani-nikravesh", restitution = 0.9, elastic = "esdu-78035", young = 207e9, poisson = 0.3, length = 0.015 }"#,
    keys: &[YOUNG, POISSON, LENGTH],
    also: None,
};

/// The law.
#[derive(Debug, Clone, Copy)]
pub struct Esdu<S>(Logarithmic<S>);

impl<S: Scalar> Esdu<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let deepest = S::ratio(4, 1) * ends.radial();
        Esdu(Logarithmic::new(materials(values), values.number("length"), deepest))
    }
}

logarithmic!(Esdu);
