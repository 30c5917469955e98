//! How errors are counted: what they are measured with, how many digits that makes, and which
//! events of two trajectories are the same. Certificates and comparisons count by one rule.

mod difference;
mod grade;
mod likes;
mod scales;

pub use difference::Parts;
pub use grade::{Grade, Hold, whole_turns};
pub use likes::{Likes, Parting, events, one_to_one};
pub use scales::{Largest, Scales, Sizes};

/// Doubles tell no more digits than this.
pub const MOST_DIGITS: f64 = 16.0;

/// Digits of a scaled error, at most [`MOST_DIGITS`]; −∞ of what is not a number.
pub fn digits(scaled: f64) -> f64 {
    let digits = -scaled.log10();
    if digits.is_nan() { f64::NEG_INFINITY } else { digits.min(MOST_DIGITS) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thousandth_is_three_digits_and_nothing_is_the_most_there_are() {
        assert!((digits(1e-3) - 3.0).abs() < 1e-15);
        assert_eq!([digits(0.0), digits(1e-30)], [MOST_DIGITS; 2]);
        assert_eq!([digits(f64::NAN), digits(f64::INFINITY)], [f64::NEG_INFINITY; 2]);
    }
}
