//! 71-digit floats: 237 bits of significand (IEEE 754 binary256, crate `f256`).
//!
//! The crate's own square root costs sixty additions; ours is a Newton iteration for 1/√x that
//! starts from double precision, at a fifth of that.

pub use f256::f256 as F256;

use super::Scalar;
use std::str::FromStr;

const FRACTION_BITS_HIGH: u32 = 108;
const EXPONENT_MASK: u32 = 0x7_ffff;
const EXPONENT_BIAS: i32 = 0x3_ffff;

/// Sign, binary exponent and the leading 64 bits of the significand, the last of them sticky.
fn leading_bits(x: F256) -> (bool, i32, u64) {
    let (high, low) = x.to_bits();
    let exponent = (high >> FRACTION_BITS_HIGH) as u32 & EXPONENT_MASK;
    let fraction = high & ((1u128 << FRACTION_BITS_HIGH) - 1);
    let significand = fraction | (1u128 << FRACTION_BITS_HIGH);
    let spare = FRACTION_BITS_HIGH - 63;
    let sticky = (significand & ((1u128 << spare) - 1)) != 0 || low != 0;
    (
        high >> 127 == 1,
        exponent as i32 - EXPONENT_BIAS,
        (significand >> spare) as u64 | u64::from(sticky),
    )
}

/// 2^k for k within the range of doubles, zero or infinity beyond it.
fn power_of_two(k: i32) -> f64 {
    match k {
        -1022..=1023 => f64::from_bits(((k + 1023) as u64) << 52),
        -1074..=-1023 => f64::from_bits(1u64 << (k + 1074)),
        ..-1074 => 0.0,
        1024.. => f64::INFINITY,
    }
}

/// `x` times 2^k, exactly.
fn scaled(x: F256, k: i32) -> F256 {
    if k >= 0 { x.mul_pow2(k.unsigned_abs()) } else { x.div_pow2(k.unsigned_abs()) }
}

impl Scalar for F256 {
    const EPSILON: f64 = 9.055_679_078_826_712e-72;

    const GOES_BEYOND: bool = true;

    fn beyond(self) -> f64 {
        (self - F256::from(self.to_f64())).to_f64()
    }

    fn from_f64(x: f64) -> F256 {
        F256::from(x)
    }

    fn to_f64(self) -> f64 {
        if self.is_nan() {
            return f64::NAN;
        }
        let (negative, exponent, bits) = leading_bits(self);
        let magnitude = if self.eq_zero() || exponent < -1080 {
            0.0
        } else if self.is_infinite() || exponent > 1023 {
            f64::INFINITY
        } else if exponent > -960 {
            bits as f64 * power_of_two(exponent - 63)
        } else {
            bits as f64 * power_of_two(exponent + 937) * power_of_two(-1000)
        };
        if negative { -magnitude } else { magnitude }
    }

    fn from_octuple(x: F256) -> F256 {
        x
    }

    fn octuple(self) -> F256 {
        self
    }

    fn to_bits_text(self) -> String {
        let (high, low) = self.to_bits();
        format!("{high:032x}{low:032x}")
    }

    fn from_bits_text(text: &str) -> Option<F256> {
        let half = |text: Option<&str>| u128::from_str_radix(text?, 16).ok();
        let bits = half(text.get(..32)).zip(half(text.get(32..)))?;
        (text.len() == 64).then(|| F256::from_bits(bits))
    }

    fn parse(literal: &str) -> Option<F256> {
        F256::from_str(literal).ok().filter(|x| F256::is_finite(*x))
    }

    fn pi() -> F256 {
        f256::consts::PI
    }

    fn sqrt(self) -> F256 {
        if self <= F256::ZERO || !F256::is_finite(self) {
            return if self < F256::ZERO { F256::NAN } else { self };
        }
        let inverse = self.rsqrt();
        let root = self * inverse;
        root + (self - root * root) * inverse.div2()
    }

    fn rsqrt(self) -> F256 {
        if !(self > F256::ZERO) || !F256::is_finite(self) {
            return F256::ONE / F256::sqrt(self);
        }
        let (_, exponent, _) = leading_bits(self);
        let half = exponent.div_euclid(2);
        let near_one = scaled(self, -2 * half);
        let mut inverse = F256::from(1.0 / near_one.to_f64().sqrt());
        for _ in 0..3 {
            let error = F256::ONE - near_one * inverse * inverse;
            inverse += inverse.div2() * error;
        }
        scaled(inverse, -half)
    }

    fn sin_cos(self) -> (F256, F256) {
        F256::sin_cos(&self)
    }

    fn exp(self) -> F256 {
        F256::exp(&self)
    }

    fn ln(self) -> F256 {
        F256::ln(&self)
    }

    fn powf(self, exponent: F256) -> F256 {
        F256::powf(&self, &exponent)
    }

    fn tanh(self) -> F256 {
        // expm1 keeps its digits near zero, where the quotient of exponentials loses them
        let twice = self.abs().mul2().exp_m1();
        let magnitude = twice / (twice + F256::TWO);
        if self < F256::ZERO { -magnitude } else { magnitude }
    }

    fn zero() -> F256 {
        F256::ZERO
    }

    fn one() -> F256 {
        F256::ONE
    }

    fn is_finite(self) -> bool {
        F256::is_finite(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_double_survives_the_way_there_and_back(x in proptest::num::f64::NORMAL) {
            prop_assert_eq!(F256::from_f64(x).to_f64().to_bits(), x.to_bits());
        }

        #[test]
        fn rounding_to_double_is_to_nearest(x in 1e-300..1e300f64, part in -0.49..0.49f64) {
            let ulp = x.next_up() - x;
            let beside = F256::from(x) + F256::from(ulp) * F256::from(part);
            prop_assert_eq!(beside.to_f64(), x);
        }

        #[test]
        fn square_root_is_good_to_the_last_places(x in 1e-290..1e290f64, y in 1.0..2.0f64) {
            let x = F256::from(x) / F256::from(y);
            let root = Scalar::sqrt(x);
            let error = ((root * root - x) / x).abs().to_f64();
            prop_assert!(error < 4.0 * <F256 as Scalar>::EPSILON, "{error:e}");
            let error = (x.rsqrt() * root - F256::ONE).abs().to_f64();
            prop_assert!(error < 8.0 * <F256 as Scalar>::EPSILON, "{error:e}");
        }
    }

    #[test]
    fn epsilon_is_that_of_the_crate() {
        assert_eq!(F256::EPSILON.to_f64(), <F256 as Scalar>::EPSILON);
    }

    #[test]
    fn decimals_mean_themselves() {
        let x = F256::parse("0.0737").unwrap();
        assert_eq!(x, F256::ratio(737, 10_000));
        assert_ne!(x, F256::from(0.0737));
        assert_eq!((F256::from(3) * F256::parse("0.1").unwrap()).to_f64(), 0.3);
    }

    #[test]
    fn far_exponents_round_to_zero_and_infinity() {
        assert_eq!(F256::parse("1e-400").unwrap().to_f64(), 0.0);
        assert_eq!(F256::parse("-1e400").unwrap().to_f64(), f64::NEG_INFINITY);
        assert_eq!(F256::parse("5e-324").unwrap().to_f64(), 5e-324);
    }
}
