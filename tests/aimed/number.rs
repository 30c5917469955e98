//! Decimals that a case file and the truth about it share to the last place.

use fastrand::Rng;
use freeplay::scalar::{F256, Scalar};
use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

/// mantissa · 10^power, exactly.
#[derive(Clone, Copy, PartialEq)]
pub struct Decimal {
    mantissa: i128,
    power: i32,
}

impl Decimal {
    pub fn new(mantissa: i128, power: i32) -> Decimal {
        let mut decimal = Decimal { mantissa, power };
        while decimal.mantissa != 0 && decimal.mantissa % 10 == 0 {
            decimal = Decimal { mantissa: decimal.mantissa / 10, power: decimal.power + 1 };
        }
        decimal
    }

    /// A number of four digits, even in the logarithm.
    pub fn draw(rng: &mut Rng, from: f64, to: f64) -> Decimal {
        let drawn = (from.ln() + (to / from).ln() * rng.f64()).exp();
        Decimal::near(drawn)
    }

    /// A number of four digits that is about this one.
    pub fn near(x: f64) -> Decimal {
        let power = x.abs().log10().floor() as i32 - 3;
        Decimal::new((x / 10f64.powi(power)).round() as i128, power)
    }

    pub fn value(self) -> F256 {
        let literal = self.to_string();
        F256::parse(&literal).unwrap_or_else(|| panic!("{literal} is no number"))
    }

    pub fn to_f64(self) -> f64 {
        self.value().to_f64()
    }

    /// Its mantissa before a lower power of ten.
    fn mantissa_at(self, power: i32) -> i128 {
        self.mantissa * 10i128.pow((self.power - power) as u32)
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}e{}", self.mantissa, self.power)
    }
}

impl Mul for Decimal {
    type Output = Decimal;
    fn mul(self, other: Decimal) -> Decimal {
        Decimal::new(self.mantissa * other.mantissa, self.power + other.power)
    }
}

impl Add for Decimal {
    type Output = Decimal;
    fn add(self, other: Decimal) -> Decimal {
        let power = self.power.min(other.power);
        Decimal::new(self.mantissa_at(power) + other.mantissa_at(power), power)
    }
}

impl Neg for Decimal {
    type Output = Decimal;
    fn neg(self) -> Decimal {
        Decimal { mantissa: -self.mantissa, ..self }
    }
}

impl Sub for Decimal {
    type Output = Decimal;
    fn sub(self, other: Decimal) -> Decimal {
        self + -other
    }
}

/// A direction whose cosine and sine are decimals.
pub fn direction(rng: &mut Rng) -> [Decimal; 2] {
    let [cos, sin, power] =
        rng.choice([[1, 0, 0], [6, 8, -1], [28, 96, -2], [352, 936, -3]]).unwrap();
    let signed =
        |x: i128, rng: &mut Rng| Decimal::new(if rng.bool() { x } else { -x }, power as i32);
    let (cos, sin) = if rng.bool() { (cos, sin) } else { (sin, cos) };
    [signed(cos, rng), signed(sin, rng)]
}

/// An integer below 2⁵³.
pub fn whole(x: i64) -> F256 {
    F256::ratio(x, 1)
}

pub fn pi() -> F256 {
    <F256 as Scalar>::pi()
}
