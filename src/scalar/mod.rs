//! The number type of the physics.
//!
//! Kinematics, laws, joints and accelerations are written once, generic in [`Scalar`]; its three
//! kinds are [`f64`] for every ordinary run, dual numbers for exact derivatives, and 71-digit
//! floats for trajectories that can be called true.

pub mod bits;
mod decimal;
mod double;
mod dual;
mod lift;
mod octuple;

pub use decimal::{Decimal, NotADecimal};
pub use dual::{Dual, Dual64, Infinitesimal};
pub use lift::Lift;
pub use octuple::F256;

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number in which the mechanics can be evaluated.
///
/// The order is that of the real part; a comparison never looks at a derivative.
pub trait Scalar:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// Distance from one to the next larger number of this kind.
    const EPSILON: f64;

    /// Whether [`beyond`](Scalar::beyond) tells anything.
    const GOES_BEYOND: bool = false;

    /// Whether numbers carry a derivative, which an iteration that looks at values must not leave
    /// behind.
    const CARRIES_DERIVATIVE: bool = false;

    /// What the number knows beyond its nearest double: in 71 digits the remainder, in dual
    /// numbers the derivative.
    fn beyond(self) -> f64 {
        0.0
    }

    /// The number `x`, exactly.
    fn from_f64(x: f64) -> Self;

    /// The nearest double (of the real part).
    fn to_f64(self) -> f64;

    /// The number nearest to a 71-digit one.
    fn from_octuple(x: F256) -> Self;

    /// The number (its real part) in 71 digits, exactly.
    fn octuple(self) -> F256;

    /// All bits of the number, in hexadecimal.
    fn to_bits_text(self) -> String;

    /// The number of these bits; `None` of another text.
    fn from_bits_text(text: &str) -> Option<Self>;

    /// The number a finite decimal literal means, rounded once; `None` if it is not one.
    fn parse(literal: &str) -> Option<Self>;

    /// π in this arithmetic.
    fn pi() -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle (rad).
    fn sin_cos(self) -> (Self, Self);

    /// Exponential function.
    fn exp(self) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self;

    /// `self` to a real power; the base must be positive.
    fn powf(self, exponent: Self) -> Self;

    /// Hyperbolic tangent.
    fn tanh(self) -> Self;

    /// rate · time (rad) less whole turns, where the exact rate is `rate + rate_tail`.
    fn phase(rate: Self, rate_tail: f64, time: Self) -> Self {
        let _ = rate_tail;
        rate * time
    }

    /// One over the square root.
    fn rsqrt(self) -> Self {
        Self::one() / self.sqrt()
    }

    /// Zero.
    fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// One.
    fn one() -> Self {
        Self::from_f64(1.0)
    }

    /// The quotient of two integers below 2⁵³, rounded once.
    fn ratio(numerator: i64, denominator: i64) -> Self {
        Self::from_f64(numerator as f64) / Self::from_f64(denominator as f64)
    }

    /// Magnitude.
    fn abs(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }

    /// The larger of two numbers.
    fn max(self, other: Self) -> Self {
        if self < other { other } else { self }
    }

    /// The smaller of two numbers.
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// Whether the number is neither infinite nor undefined.
    fn is_finite(self) -> bool {
        self.to_f64().is_finite()
    }
}
