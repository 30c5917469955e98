//! Numbers as a case file writes them.

use super::Scalar;
use std::fmt;

/// A decimal number kept as it was written, so that every arithmetic can read it exactly:
/// `0.0737` means 737/10000, not the double nearest to it.
#[derive(Clone, PartialEq, Eq)]
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

    /// The nearest double.
    pub fn to_f64(&self) -> f64 {
        self.literal.parse().unwrap_or(f64::NAN)
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
    fn words_are_refused() {
        assert_eq!(Decimal::new("heavy"), Err(NotADecimal("heavy".into())));
    }

    #[test]
    fn a_literal_too_large_for_any_arithmetic_is_infinite() {
        assert!(Decimal::new("1e999999").unwrap().to_f64().is_infinite());
    }
}
