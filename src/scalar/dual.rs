//! Dual numbers: a value and its exact derivative along one direction.

pub use num_dual::Dual64;

use super::{F256, Scalar};
use num_dual::DualNum;

impl Scalar for Dual64 {
    const EPSILON: f64 = f64::EPSILON;

    fn from_f64(x: f64) -> Dual64 {
        Dual64::from_re(x)
    }

    fn to_f64(self) -> f64 {
        self.re
    }

    fn from_octuple(x: F256) -> Dual64 {
        Dual64::from_re(x.to_f64())
    }

    fn parse(literal: &str) -> Option<Dual64> {
        f64::parse(literal).map(Dual64::from_re)
    }

    fn pi() -> Dual64 {
        Dual64::from_re(std::f64::consts::PI)
    }

    fn sqrt(self) -> Dual64 {
        DualNum::sqrt(&self)
    }

    fn sin_cos(self) -> (Dual64, Dual64) {
        DualNum::sin_cos(&self)
    }

    fn exp(self) -> Dual64 {
        DualNum::exp(&self)
    }

    fn ln(self) -> Dual64 {
        DualNum::ln(&self)
    }

    fn powf(self, exponent: Dual64) -> Dual64 {
        DualNum::powd(&self, exponent)
    }

    fn tanh(self) -> Dual64 {
        DualNum::tanh(&self)
    }
}
