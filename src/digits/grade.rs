//! Digits of agreement.
//!
//! ```text
//! digits = −log10( (|theirs − reference| + u) / scale ),  at most 16
//! ```
//! u is half a unit in the last place of the reference's number: so much of the truth is lost by
//! writing it down in a double. What is not a number agrees with nothing.

use super::{MOST_DIGITS, digits};

/// How well a number, or the worst of several, agrees with its reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grade {
    /// Digits of agreement; −∞ where there is none at all.
    pub digits: f64,
    /// Whether there may be more: nothing was seen to differ, or the reference knows no more.
    pub at_least: bool,
    /// Index of the column it is that of.
    pub column: usize,
}

impl Grade {
    /// The grade of a number in a column whose errors are measured with `scale`.
    pub fn new(theirs: f64, reference: f64, scale: f64, column: usize) -> Grade {
        let error = (theirs - reference).abs();
        Grade { digits: grade(error, reference, scale), at_least: error == 0.0, column }
    }

    /// The same for angles (rad), whole turns left out.
    pub fn of_angle(theirs: f64, reference: f64, scale: f64, column: usize) -> Grade {
        Grade::new(theirs - whole_turns(theirs, reference), reference, scale, column)
    }

    /// The worse of two grades; the first where they are equal.
    pub fn worse(self, other: Grade) -> Grade {
        if other.digits < self.digits { other } else { self }
    }

    /// This grade, but no more than a reference is certified to.
    pub fn limited(self, certified: f64) -> Grade {
        // NaN certifies nothing
        let certified = if certified.is_nan() { f64::NEG_INFINITY } else { certified };
        if self.digits <= certified {
            return self;
        }
        Grade { digits: certified, at_least: true, ..self }
    }
}

/// The angle of the whole turns by which `theirs` is off (rad).
pub fn whole_turns(theirs: f64, reference: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    ((theirs - reference) / turn).round() * turn
}

fn grade(error: f64, reference: f64, scale: f64) -> f64 {
    let off = error + reference.abs() * (f64::EPSILON / 2.0);
    if off == 0.0 { MOST_DIGITS } else { digits(off / scale) }
}

/// Up to which time at least so many digits agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// Digits.
    pub digits: f64,
    /// Time of the last sample before the first with fewer (s); `None` if the first sample has
    /// fewer.
    pub until: Option<f64>,
    /// Index of the first sample that has fewer; `None` if all have as many.
    pub first_below: Option<usize>,
}

impl Hold {
    /// Looks for the first of a series of grades that is below so many digits.
    pub fn new(digits: f64, times: &[f64], grades: &[Grade]) -> Hold {
        // written so that a grade that is no number is below
        let first_below = grades.iter().position(|grade| !(grade.digits >= digits));
        let last_above = first_below.unwrap_or(grades.len()).checked_sub(1);
        Hold { digits, until: last_above.map(|index| times[index]), first_below }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn an_error_of_a_thousandth_of_the_scale_is_three_digits() {
        let grade = Grade::new(0.123e-3 + 1e-6, 0.123e-3, 1e-3, 4);
        assert!((grade.digits - 3.0).abs() < 1e-9);
        assert!(!grade.at_least && grade.column == 4);
    }

    #[test]
    fn equal_numbers_agree_at_least_to_their_last_bit() {
        let grade = Grade::new(31.4, 31.4, 1.0, 0);
        assert!(grade.at_least);
        // half a unit in the last place of 31.4 is 1.8e-15
        assert!(grade.digits > 14.3 && grade.digits < 14.8, "{}", grade.digits);
        assert_eq!(Grade::new(0.0, 0.0, 1.0, 0).digits, MOST_DIGITS);
        assert_eq!(Grade::new(0.0, 0.0, 0.0, 0).digits, MOST_DIGITS);
    }

    #[test]
    fn what_is_no_number_agrees_with_nothing() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        for (theirs, reference, scale) in [
            (nan, 0.0, 1.0),
            (nan, nan, 1.0),
            (0.0, nan, 1.0),
            (inf, inf, 1.0),
            (1.0, 0.0, 0.0),
            (1.0, 1.0, nan),
        ] {
            let grade = Grade::new(theirs, reference, scale, 0);
            assert_eq!(grade.digits, f64::NEG_INFINITY, "{theirs} {reference} {scale}");
        }
    }

    #[test]
    fn whole_turns_of_an_angle_do_not_count() {
        let grade = Grade::of_angle(0.5 + 3.0 * TAU + 1e-6, 0.5, 1.0, 0);
        assert!((grade.digits - 6.0).abs() < 1e-6, "{}", grade.digits);
        assert_eq!(Grade::of_angle(f64::NAN, 0.5, 1.0, 0).digits, f64::NEG_INFINITY);
    }

    #[test]
    fn a_reference_grants_no_more_than_it_is_certified_to() {
        let grade = Grade::new(1.0 + 1e-9, 1.0, 1.0, 0);
        assert_eq!(grade.limited(12.0), grade);
        let limited = grade.limited(4.0);
        assert!(limited.digits == 4.0 && limited.at_least);
        assert_eq!(grade.limited(f64::NAN).digits, f64::NEG_INFINITY);
    }

    #[test]
    fn digits_hold_until_the_last_sample_before_the_first_that_falls_short() {
        let grades: Vec<Grade> = [9.0, 7.0, 5.0, 8.0]
            .map(|digits| Grade { digits, at_least: false, column: 0 })
            .to_vec();
        let times = [0.0, 1.0, 2.0, 3.0];
        let hold = |digits| Hold::new(digits, &times, &grades);
        assert_eq!((hold(6.0).until, hold(6.0).first_below), (Some(1.0), Some(2)));
        assert_eq!((hold(5.0).until, hold(5.0).first_below), (Some(3.0), None));
        assert_eq!((hold(10.0).until, hold(10.0).first_below), (None, Some(0)));
    }
}
