//! Tsuji's law: Hertz's spring with a damping that makes all impacts rebound alike.
//! ```text
//! F_N = K δ^(3/2) + α √(m K) δ^(1/4) δ̇,   α = −√5 ln e/√(ln² e + π²)
//! ```
//! | symbol | key           | unit    | meaning                                        |
//! |--------|---------------|---------|------------------------------------------------|
//! | K      | `stiffness`   | N/m^1.5 | stiffness, of a power law with exponent 3/2    |
//! | e      | `restitution` | –       | what an impact of the mass m rebounds at       |
//! | m      | `mass`        | kg      | mass that journal and bearing meet with        |
//!
//! (Y. Tsuji, T. Tanaka, T. Ishida, Lagrangian numerical simulation of plug flow of cohesionless
//! particles in a horizontal pipe, Powder Technology 71, 1992, 239–250, doi 10.1016/0032-5910(92)88030-L,
//! who give α as a curve; in closed form T. Antypov, J. A. Elliott, On an analytical solution for the
//! damped Hertzian spring, EPL 94, 2011, 50004, doi 10.1209/0295-5075/94/50004. The closed form is
//! derived here too, by y = δ^(5/4), which makes a linear oscillator of the impact, and agrees with a
//! public code; the prints were not seen.)
//!
//! In a mechanism the mass that a contact moves is no one number: a contact that meets another than
//! `mass` rebounds at another e. The force begins at zero, but as the fourth root of δ: its slope is
//! infinite there, which costs an implicit engine short steps. The explicit engine follows the fourth
//! root, in which all is smooth.

use super::{Ends, ViscousLaw, ratio_of};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "tsuji",
    title: "F_N = K δ^(3/2) + c δ^(1/4) δ̇: all impacts of one mass rebound alike",
    source: "Tsuji, Tanaka, Ishida 1992, Powder Technol. 71:239–250, doi 10.1016/0032-5910(92)88030-L; Antypov, Elliott 2011, EPL 94:50004",
    example: r#"[joints.A.clearance]
normal = { law = "tsuji", restitution = 0.8, mass = 0.05, stiffness = 1e10 }"#,
    keys: &[
        Key::new("restitution", Takes::Number(Range::Restitution), "", "what one impact of the mass by itself rebounds at, over its speed"),
        Key::new("mass", Takes::Number(Range::Positive), "kg", "mass m that journal and bearing meet with (`freeplay check` tells it)"),
    ],
    also: None,
};

/// c = α √(m K) (N s/m^1.25).
#[derive(Debug, Clone, Copy)]
pub struct Tsuji<S>(S);

impl<S: Scalar> Tsuji<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let alpha = S::ratio(5, 1).sqrt() * ratio_of(values.number::<S>("restitution"));
        Tsuji(alpha * (values.number::<S>("mass") * ends.stiffness).sqrt())
    }
}

impl<S: Scalar> ViscousLaw<S> for Tsuji<S> {
    const EXPONENT: (i64, i64) = (3, 2);
    const GROWTH: (u32, u32) = (1, 4);

    #[inline(always)]
    fn coefficient(&self) -> S {
        self.0
    }
}
