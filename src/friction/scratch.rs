//! A friction law of one's own: it grows with the slip.
//! ```text
//! F_T = −c_f F_N v_T/v_1
//! ```

use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, Sloped, WHOLE, endless};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "thick",
    title: "friction that grows with the slip",
    example: r#"[joints.A.clearance]
friction = { law = "thick", coefficient = 0.1, slip = 1.0 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("slip", Takes::Number(Range::Positive), "m/s", "slip v_1 at which F_T/F_N is the coefficient"),
    ],
    ..Kind::PLAIN
};

/// c_f/v_1 (s/m).
#[derive(Debug, Clone, Copy)]
pub struct Scratch<S>(S);

impl<S: Scalar> Scratch<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        Scratch(values.number::<S>("coefficient") / values.number("slip"))
    }
}

impl<S: Scalar> FrictionLaw<S> for Scratch<S> {
    #[inline(always)]
    fn ratio(&self, _: Branch, slip: S, _: Inner<S>) -> Sloped<S> {
        Sloped::by_slip(-self.0 * slip, -self.0)
    }

    fn branch(&self, _: S, _: S) -> Branch {
        WHOLE
    }

    fn edges(&self, _: Branch) -> (S, S) {
        endless()
    }

    fn beyond(&self, _: Branch, _: bool, _: S) -> Branch {
        WHOLE
    }

    fn slip_scale(&self) -> S {
        S::one()
    }

    fn limit(&self) -> S {
        S::from_f64(f64::INFINITY)
    }
}
