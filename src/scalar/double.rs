//! Double precision.

use super::{F256, Scalar};
use std::f64::consts::TAU;

impl Scalar for f64 {
    const EPSILON: f64 = f64::EPSILON;

    #[inline(always)]
    fn from_f64(x: f64) -> f64 {
        x
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }

    fn from_octuple(x: F256) -> f64 {
        x.to_f64()
    }

    fn octuple(self) -> F256 {
        F256::from_f64(self)
    }

    fn to_bits_text(self) -> String {
        format!("{:016x}", self.to_bits())
    }

    fn from_bits_text(text: &str) -> Option<f64> {
        let bits = u64::from_str_radix(text, 16).ok().filter(|_| text.len() == 16)?;
        Some(f64::from_bits(bits))
    }

    fn parse(literal: &str) -> Option<f64> {
        literal.parse().ok().filter(|x: &f64| x.is_finite())
    }

    #[inline(always)]
    fn pi() -> f64 {
        std::f64::consts::PI
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn sin_cos(self) -> (f64, f64) {
        f64::sin_cos(self)
    }

    #[inline(always)]
    fn exp(self) -> f64 {
        f64::exp(self)
    }

    #[inline(always)]
    fn ln(self) -> f64 {
        f64::ln(self)
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> f64 {
        f64::powf(self, exponent)
    }

    #[inline(always)]
    fn tanh(self) -> f64 {
        f64::tanh(self)
    }

    #[inline(always)]
    fn phase(rate: f64, rate_tail: f64, time: f64) -> f64 {
        // the product and 2π to twice the digits: rate · time itself loses a place with every
        // doubling of the time
        const TAU_TAIL: f64 = 2.449_293_598_294_706_4e-16;
        let product = rate * time;
        let turns = (product / TAU).round();
        let tail = rate.mul_add(time, -product) + rate_tail * time;
        turns.mul_add(-TAU, product) + (tail - turns * TAU_TAIL)
    }

    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crank_angle_keeps_its_places_for_a_thousand_revolutions() {
        let exact = F256::parse("5000").unwrap() * F256::pi() / F256::from(30);
        let rate = exact.to_f64();
        let tail = (exact - F256::from(rate)).to_f64();
        for time in [1e-5, 0.0123, 0.06, 1.0, 12.34] {
            let turned = f64::phase(rate, tail, time);
            let (sin, cos) = (exact * F256::from(time)).sin_cos();
            let error = (turned.sin() - sin.to_f64()).hypot(turned.cos() - cos.to_f64());
            assert!(error < 4.0 * f64::EPSILON, "{time}: {error:e}");
        }
    }
}
