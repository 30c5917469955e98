//! An elastic law of one's own: a spring that hardens.
//! ```text
//! F_e = K δ (1 + δ/δ_1)
//! ```

use super::{ElasticLaw, Ends};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "hardening",
    title: "a spring that hardens",
    example: r#"[joints.A.clearance]
normal = { law = "hertz", elastic = "hardening", stiffness = 1e7, depth = 1e-4 }"#,
    keys: &[
        Key::new("stiffness", Takes::Number(Range::Positive), "N/m", "stiffness K where the contact begins"),
        Key::new("depth", Takes::Number(Range::Positive), "m", "depth δ_1 at which the force is twice that of the spring"),
    ],
    ..Kind::PLAIN
};

/// K (N/m) and δ_1 (m).
#[derive(Debug, Clone, Copy)]
pub struct Scratch<S>(S, S);

impl<S: Scalar> Scratch<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        Scratch(values.number("stiffness"), values.number("depth"))
    }
}

impl<S: Scalar> ElasticLaw<S> for Scratch<S> {
    #[inline(always)]
    fn force(&self, depth: S) -> (S, S) {
        let harder = depth / self.1;
        (self.0 * depth * (S::one() + harder), self.0 * (S::one() + harder + harder))
    }

    fn energy(&self, depth: S) -> S {
        self.0 * depth * depth * (S::ratio(1, 2) + depth / (S::ratio(3, 1) * self.1))
    }
}
