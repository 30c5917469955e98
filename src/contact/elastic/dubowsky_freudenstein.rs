//! Line contact of two cylinders after Goldsmith, as Dubowsky and Freudenstein have it.
//! ```text
//! δ = F σ/L [ln(L³ c/(F R_b R_j σ)) + 1],   σ = h_b + h_j = 1/(π E*),   h = (1 − ν²)/(π E)
//! ```
//! | symbol   | key               | unit | meaning                                  |
//! |----------|-------------------|------|------------------------------------------|
//! | L        | `length`          | m    | length of the contact                    |
//! | E*       | `young`, `poisson`| Pa   | 1/E* = (1 − ν_b²)/E_b + (1 − ν_j²)/E_j   |
//! | R_b, R_j |                   | m    | radii of bearing and journal             |
//! | c        |                   | m    | radial clearance R_b − R_j               |
//!
//! (W. Goldsmith, Impact, Arnold, 1960; S. Dubowsky, F. Freudenstein, Dynamic analysis of mechanical
//! systems with clearances, Journal of Engineering for Industry 93, 1971, 305–309 and 310–316, doi
//! 10.1115/1.3427895 and 10.1115/1.3427896; the prints were not seen.)
//!
//! Conflicting prints are about. Goldsmith's formula is quoted with L^m/(F R σ) in the logarithm and m =
//! 1, which has no unit only if R is a curvature; with m = 3 and R = R_b R_j/c it is this one. A public
//! code has h without the π, which makes δ π times as large; with the π the law agrees with Johnson's to
//! the order that these laws agree at all.
//!
//! The formula ends where dδ/dF = 0, at δ = L² c/(R_b R_j).

use super::logarithmic::{Logarithmic, logarithmic};
use super::{Ends, LENGTH, POISSON, YOUNG, materials};
use crate::parameter::{Kind, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "dubowsky-freudenstein",
    title: "line contact after Goldsmith, δ = F σ/L [ln(L³ c/(F R_b R_j σ)) + 1]",
    source: "Goldsmith 1960, Impact, Arnold; Dubowsky, Freudenstein 1971, J. Eng. Ind. 93:305–309, doi 10.1115/1.3427895",
    example: r#"[joints.A.clearance]
normal = { law = "lankarani-nikravesh", restitution = 0.9, elastic = "dubowsky-freudenstein", young = 207e9, poisson = 0.3, length = 0.015 }"#,
    keys: &[YOUNG, POISSON, LENGTH],
    also: None,
};

/// The law.
#[derive(Debug, Clone, Copy)]
pub struct DubowskyFreudenstein<S>(Logarithmic<S>);

impl<S: Scalar> DubowskyFreudenstein<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let (length, radii): (S, S) = (values.number("length"), ends.bearing * ends.journal);
        let deepest = length * length * ends.radial() / radii;
        DubowskyFreudenstein(Logarithmic::new(materials(values), values.number("length"), deepest))
    }
}

logarithmic!(DubowskyFreudenstein);
