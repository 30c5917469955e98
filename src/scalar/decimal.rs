//! Numbers as a case file writes them.

use super::Scalar;
use std::fmt;

/// A decimal number kept as it was written, so that every arithmetic can read it exactly:
/// `0.0737` means 737/10000, not the double nearest to it. Two are equal when they are the same
/// number, however written: `5e3` and `5000.0`.
#[derive(Clone, Eq)]
pub struct Decimal {
    literal: String,
}

/// The text is not a decimal number, `inf` or `nan`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is not a decimal number")]
pub struct NotADecimal(pub String);

impl Decimal {
    /// Reads a literal: an optional sign, digits with an optional point and exponent, or `inf`,
    /// `nan`. Underscores between digits are dropped, as TOML allows them.
    pub fn new(literal: &str) -> Result<Decimal, NotADecimal> {
        let literal: String = literal.trim().chars().filter(|&c| c != '_').collect();
        let literal = literal.strip_prefix('+').unwrap_or(&literal).to_owned();
        match literal.parse::<f64>() {
            Ok(_) => Ok(Decimal { literal }),
            Err(_) => Err(NotADecimal(literal)),
        }
    }

    /// The number in the arithmetic `S`; values that are not finite come as doubles have them.
    pub fn value<S: Scalar>(&self) -> S {
        S::parse(&self.literal).unwrap_or_else(|| S::from_f64(self.to_f64()))
    }

    /// Sign, digits without zeros at either end, and the power of ten of the last of them; `None`
    /// of what is not finite.
    fn exact(&self) -> Option<(bool, String, i128)> {
        let unsigned = self.literal.trim_start_matches('-');
        let is_number = unsigned.starts_with(|c: char| c.is_ascii_digit() || c == '.');
        let (mantissa, exponent) = unsigned.split_once(['e', 'E']).unwrap_or((unsigned, "0"));
        let exponent: i128 = exponent.parse().ok().filter(|_| is_number)?;
        let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = format!("{whole}{part}");
        let kept = digits.trim_end_matches('0');
        let dropped = digits.len() - kept.len();
        let kept = kept.trim_start_matches('0');
        if kept.is_empty() {
            return Some((false, String::new(), 0));
        }
        let power = exponent - part.len() as i128 + dropped as i128;
        Some((self.literal.starts_with('-'), kept.to_owned(), power))
    }

    /// The nearest double.
    pub fn to_f64(&self) -> f64 {
        self.literal.parse().unwrap_or(f64::NAN)
    }
}

impl PartialEq for Decimal {
    fn eq(&self, other: &Decimal) -> bool {
        match (self.exact(), other.exact()) {
            (Some(a), Some(b)) => a == b,
            _ => self.literal.eq_ignore_ascii_case(&other.literal),
        }
    }
}

impl From<f64> for Decimal {
    /// The shortest decimal that reads back as `x`.
    fn from(x: f64) -> Decimal {
        Decimal { literal: format!("{x:?}") }
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.literal)
    }
}

impl fmt::Debug for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.literal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_kept_and_read_by_each_arithmetic() {
        let mass = Decimal::new("+0.073_7").unwrap();
        assert_eq!(mass.to_string(), "0.0737");
        assert_eq!(mass.value::<f64>(), 0.0737);
        assert_eq!(mass.value::<crate::scalar::F256>(), crate::scalar::F256::ratio(737, 10_000));
    }

    #[test]
    fn the_same_number_is_equal_however_it_is_written() {
        let decimal = |text: &str| Decimal::new(text).unwrap();
        for (a, b) in [
            ("5e3", "5000.0"),
            ("+5_000", "0.05E5"),
            ("-1.50e-3", "-.0015"),
            ("0.0", "-0e7"),
            ("INF", "inf"),
            ("1e999999", "10e999998"),
        ] {
            assert_eq!(decimal(a), decimal(b));
        }
        // the same double, and another number
        for (a, b) in
            [("0.1", "0.10000000000000000001"), ("5e3", "-5e3"), ("inf", "-inf"), ("5", "50")]
        {
            assert_ne!(decimal(a), decimal(b));
        }
    }

    #[test]
    fn words_are_refused() {
        assert_eq!(Decimal::new("heavy"), Err(NotADecimal("heavy".into())));
    }

    #[test]
    fn a_literal_too_large_for_any_arithmetic_is_infinite() {
        assert!(Decimal::new("1e999999").unwrap().to_f64().is_infinite());
    }
}
