//! Dual numbers: a value and its exact derivative along one direction.
//! ```text
//! (a + b ε)(c + d ε) = a c + (a d + b c) ε,   ε² = 0
//! ```
//! Any [`Scalar`] can be the value, 71-digit floats too, which no crate's dual numbers take. They
//! prove the hand-written Jacobians, and carry the tangent of a trajectory along with it.

use super::{F256, Scalar};
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A value `re` and its derivative `eps`.
#[derive(Debug, Clone, Copy)]
pub struct Dual<S> {
    /// Value.
    pub re: S,
    /// Derivative.
    pub eps: S,
}

/// Dual numbers in double precision.
pub type Dual64 = Dual<f64>;

impl<S: Scalar> Dual<S> {
    /// The number re + eps ε.
    #[inline(always)]
    pub fn new(re: S, eps: S) -> Self {
        Dual { re, eps }
    }

    /// A constant.
    #[inline(always)]
    pub fn from_re(re: S) -> Self {
        Dual { re, eps: S::zero() }
    }
}

impl<S: Scalar> Add for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Dual::new(self.re + other.re, self.eps + other.eps)
    }
}

impl<S: Scalar> Sub for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Dual::new(self.re - other.re, self.eps - other.eps)
    }
}

impl<S: Scalar> Mul for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Dual::new(self.re * other.re, self.re * other.eps + self.eps * other.re)
    }
}

impl<S: Scalar> Div for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = S::one() / other.re;
        let re = self.re * inverse;
        Dual::new(self.re / other.re, (self.eps - re * other.eps) * inverse)
    }
}

impl<S: Scalar> Neg for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual::new(-self.re, -self.eps)
    }
}

impl<S: Scalar> AddAssign for Dual<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Scalar> SubAssign for Dual<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: Scalar> MulAssign for Dual<S> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<S: Scalar> PartialEq for Dual<S> {
    fn eq(&self, other: &Self) -> bool {
        self.re == other.re
    }
}

impl<S: Scalar> PartialOrd for Dual<S> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.re.partial_cmp(&other.re)
    }
}

impl<S: Scalar> Scalar for Dual<S> {
    const EPSILON: f64 = S::EPSILON;
    const GOES_BEYOND: bool = true;
    const CARRIES_DERIVATIVE: bool = true;

    fn beyond(self) -> f64 {
        self.eps.to_f64()
    }

    fn from_f64(x: f64) -> Self {
        Dual::from_re(S::from_f64(x))
    }

    fn to_f64(self) -> f64 {
        self.re.to_f64()
    }

    fn from_octuple(x: F256) -> Self {
        Dual::from_re(S::from_octuple(x))
    }

    fn octuple(self) -> F256 {
        self.re.octuple()
    }

    fn to_bits_text(self) -> String {
        self.re.to_bits_text() + &self.eps.to_bits_text()
    }

    fn from_bits_text(text: &str) -> Option<Self> {
        let (re, eps) = text.split_at_checked(text.len() / 2)?;
        Some(Dual::new(S::from_bits_text(re)?, S::from_bits_text(eps)?))
    }

    fn parse(literal: &str) -> Option<Self> {
        S::parse(literal).map(Dual::from_re)
    }

    fn pi() -> Self {
        Dual::from_re(S::pi())
    }

    fn phase(rate: Self, rate_tail: f64, time: Self) -> Self {
        Dual::new(S::phase(rate.re, rate_tail, time.re), rate.re * time.eps + rate.eps * time.re)
    }

    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        Dual::new(root, self.eps / (root + root))
    }

    fn rsqrt(self) -> Self {
        let root = self.re.rsqrt();
        Dual::new(root, -S::ratio(1, 2) * root * root * root * self.eps)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.re.sin_cos();
        (Dual::new(sin, cos * self.eps), Dual::new(cos, -sin * self.eps))
    }

    fn exp(self) -> Self {
        let value = self.re.exp();
        Dual::new(value, value * self.eps)
    }

    fn ln(self) -> Self {
        Dual::new(self.re.ln(), self.eps / self.re)
    }

    fn powf(self, exponent: Self) -> Self {
        let value = self.re.powf(exponent.re);
        let slope = exponent.re * self.eps / self.re;
        // ln(0) would make a nonsense of constant exponents
        let bend = if exponent.eps == S::zero() { S::zero() } else { exponent.eps * self.re.ln() };
        Dual::new(value, value * (slope + bend))
    }

    fn tanh(self) -> Self {
        let value = self.re.tanh();
        Dual::new(value, (S::one() - value * value) * self.eps)
    }

    fn is_finite(self) -> bool {
        self.re.is_finite() && self.eps.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Derivative of a function that uses every operation, by dual numbers and by a central
    /// difference in 71 digits, whose error is far below double precision.
    fn functions<S: Scalar>(x: S) -> [S; 9] {
        let two = S::from_f64(2.0);
        let (sin, cos) = (x * two).sin_cos();
        [
            sin,
            cos,
            x.sqrt(),
            x.rsqrt(),
            x.exp() / (x + two),
            x.ln() * x,
            x.powf(x + two),
            x.tanh() - x,
            S::phase(x, 0.0, two - x),
        ]
    }

    proptest! {
        #[test]
        fn derivatives_are_those_of_differences_in_71_digits(x in 0.1..2.0f64) {
            let h = F256::from(1e-20);
            let at = |x: F256| functions(x);
            let (above, below) = (at(F256::from(x) + h), at(F256::from(x) - h));
            let dual = functions(Dual64::new(x, 1.0));
            for k in 0..9 {
                let exact = ((above[k] - below[k]) / (h + h)).to_f64();
                prop_assert!((dual[k].eps - exact).abs() < 1e-13 * (1.0 + exact.abs()), "{k}");
            }
        }
    }
}
