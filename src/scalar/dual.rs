//! Dual numbers: a value and its exact derivative along one direction.
//! ```text
//! (a + b ε)(c + d ε) = a c + (a d + b c) ε,   ε² = 0
//! ```
//! Any [`Scalar`] can be the value, 71-digit floats too, which no crate's dual numbers take; and ε may
//! have several directions. They prove the hand-written Jacobians, and carry the tangent of a trajectory along with it.

use super::{F256, Scalar};
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// What stands before ε: one derivative, or those along several directions, ε = (ε_1 … ε_N) with
/// ε_i ε_k = 0.
pub trait Infinitesimal<S>: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// How many directions.
    const COUNT: usize;

    /// The one with these parts.
    fn from_fn(part: impl FnMut(usize) -> S) -> Self;

    /// The derivative along direction `k`.
    fn part(&self, k: usize) -> S;
}

impl<S: Scalar> Infinitesimal<S> for S {
    const COUNT: usize = 1;

    #[inline(always)]
    fn from_fn(mut part: impl FnMut(usize) -> S) -> S {
        part(0)
    }

    #[inline(always)]
    fn part(&self, _: usize) -> S {
        *self
    }
}

impl<S: Scalar, const N: usize> Infinitesimal<S> for [S; N] {
    const COUNT: usize = N;

    #[inline(always)]
    fn from_fn(part: impl FnMut(usize) -> S) -> [S; N] {
        std::array::from_fn(part)
    }

    #[inline(always)]
    fn part(&self, k: usize) -> S {
        self[k]
    }
}

/// A value `re` and its derivative `eps`, or its derivatives.
#[derive(Debug, Clone, Copy)]
pub struct Dual<S, E = S> {
    /// Value.
    pub re: S,
    /// Derivative.
    pub eps: E,
}

/// Dual numbers in double precision.
pub type Dual64 = Dual<f64>;

impl<S: Scalar, E: Infinitesimal<S>> Dual<S, E> {
    /// The number re + eps ε.
    #[inline(always)]
    pub fn new(re: S, eps: E) -> Self {
        Dual { re, eps }
    }

    /// A constant.
    #[inline(always)]
    pub fn from_re(re: S) -> Self {
        Dual::by(re, |_| S::zero())
    }

    /// A value with these derivatives.
    #[inline(always)]
    fn by(re: S, part: impl FnMut(usize) -> S) -> Self {
        Dual { re, eps: E::from_fn(part) }
    }

    /// The product with another, whose value is known.
    #[inline(always)]
    fn product(self, value: S, other: Self) -> Self {
        Dual::by(value, |k| self.re * other.eps.part(k) + self.eps.part(k) * other.re)
    }

    /// f(self), from its value and a factor of the derivative.
    #[inline(always)]
    fn chain(self, value: S, slope: S) -> Self {
        Dual::by(value, |k| slope * self.eps.part(k))
    }
}

impl<S: Scalar, E: Infinitesimal<S>> Add for Dual<S, E> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Dual::by(self.re + other.re, |k| self.eps.part(k) + other.eps.part(k))
    }
}

impl<S: Scalar, E: Infinitesimal<S>> Sub for Dual<S, E> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Dual::by(self.re - other.re, |k| self.eps.part(k) - other.eps.part(k))
    }
}

impl<S: Scalar, E: Infinitesimal<S>> Mul for Dual<S, E> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.product(self.re * other.re, other)
    }
}

impl<S: Scalar, E: Infinitesimal<S>> Div for Dual<S, E> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = S::one() / other.re;
        let re = self.re * inverse;
        let part = |k| (self.eps.part(k) - re * other.eps.part(k)) * inverse;
        Dual::by(self.re / other.re, part)
    }
}

impl<S: Scalar, E: Infinitesimal<S>> Neg for Dual<S, E> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual::by(-self.re, |k| -self.eps.part(k))
    }
}

impl<S: Scalar, E: Infinitesimal<S>> AddAssign for Dual<S, E> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Scalar, E: Infinitesimal<S>> SubAssign for Dual<S, E> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: Scalar, E: Infinitesimal<S>> MulAssign for Dual<S, E> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<S: Scalar, E> PartialEq for Dual<S, E> {
    fn eq(&self, other: &Self) -> bool {
        self.re == other.re
    }
}

impl<S: Scalar, E> PartialOrd for Dual<S, E> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.re.partial_cmp(&other.re)
    }
}

impl<S: Scalar, E: Infinitesimal<S>> Scalar for Dual<S, E> {
    const EPSILON: f64 = S::EPSILON;
    const GOES_BEYOND: bool = true;
    const CARRIES_DERIVATIVE: bool = true;

    fn beyond(self) -> f64 {
        self.eps.part(0).to_f64()
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
        let parts = (0..E::COUNT).map(|k| self.eps.part(k).to_bits_text());
        self.re.to_bits_text() + &parts.collect::<String>()
    }

    fn from_bits_text(text: &str) -> Option<Self> {
        let length = text.len() / (1 + E::COUNT);
        let number = |k: usize| S::from_bits_text(text.get(k * length..(k + 1) * length)?);
        let parts: Option<Vec<S>> = (1..=E::COUNT).map(number).collect();
        let parts = parts.filter(|_| text.len() == length * (1 + E::COUNT))?;
        Some(Dual::by(number(0)?, |k| parts[k]))
    }

    fn parse(literal: &str) -> Option<Self> {
        S::parse(literal).map(Dual::from_re)
    }

    fn pi() -> Self {
        Dual::from_re(S::pi())
    }

    fn phase(rate: Self, rate_tail: f64, time: Self) -> Self {
        rate.product(S::phase(rate.re, rate_tail, time.re), time)
    }

    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        Dual::by(root, |k| self.eps.part(k) / (root + root))
    }

    fn rsqrt(self) -> Self {
        let root = self.re.rsqrt();
        self.chain(root, -S::ratio(1, 2) * root * root * root)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.re.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    fn exp(self) -> Self {
        let value = self.re.exp();
        self.chain(value, value)
    }

    fn ln(self) -> Self {
        Dual::by(self.re.ln(), |k| self.eps.part(k) / self.re)
    }

    fn powf(self, exponent: Self) -> Self {
        let value = self.re.powf(exponent.re);
        let part = |k| {
            let slope = exponent.re * self.eps.part(k) / self.re;
            // ln(0) would make a nonsense of constant exponents
            let bend = match exponent.eps.part(k) {
                constant if constant == S::zero() => S::zero(),
                part => part * self.re.ln(),
            };
            value * (slope + bend)
        };
        Dual::by(value, part)
    }

    fn tanh(self) -> Self {
        let value = self.re.tanh();
        self.chain(value, S::one() - value * value)
    }

    fn is_finite(self) -> bool {
        self.re.is_finite() && (0..E::COUNT).all(|k| self.eps.part(k).is_finite())
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
        fn derivatives_along_several_directions_are_those_along_each(x in 0.1..2.0f64, slopes in prop::array::uniform3(-2.0..2.0f64)) {
            let all = functions(Dual::<f64, [f64; 3]>::new(x, slopes));
            for (k, slope) in slopes.into_iter().enumerate() {
                for (all, one) in all.iter().zip(functions(Dual64::new(x, slope))) {
                    prop_assert_eq!((all.re, all.eps[k]), (one.re, one.eps));
                }
            }
            for number in all {
                let text = number.to_bits_text();
                let back = Dual::<f64, [f64; 3]>::from_bits_text(&text).unwrap();
                prop_assert_eq!((back.re, back.eps), (number.re, number.eps));
                prop_assert!(Dual::<f64, [f64; 3]>::from_bits_text(&text[1..]).is_none());
            }
        }

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
