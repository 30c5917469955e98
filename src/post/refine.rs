//! Extremes of functions that can be evaluated anywhere: a place that neither neighbour exceeds
//! brackets a maximum, and a golden-section search finds it.

/// Rounds of the golden section: each shortens the bracket to 0.618, and the value at an extreme
/// changes with the square of the time, so that 1e-8 of the bracket is more than enough.
const ROUNDS: usize = 40;

/// Time and value of the maximum of a function inside a bracket.
pub(super) fn maximum<E>(
    [mut left, mut right]: [f64; 2],
    mut f: impl FnMut(f64) -> Result<f64, E>,
) -> Result<(f64, f64), E> {
    let golden = (5_f64.sqrt() - 1.0) / 2.0;
    let mut low = right - golden * (right - left);
    let mut high = left + golden * (right - left);
    let (mut at_low, mut at_high) = (f(low)?, f(high)?);
    for _ in 0..ROUNDS {
        if at_low > at_high {
            (right, high, at_high) = (high, low, at_low);
            low = right - golden * (right - left);
            at_low = f(low)?;
        } else {
            (left, low, at_low) = (low, high, at_high);
            high = left + golden * (right - left);
            at_high = f(high)?;
        }
    }
    Ok(if at_low > at_high { (low, at_low) } else { (high, at_high) })
}

/// Whether the middle of three values is a maximum that is more than rounding.
pub(super) fn stands_out([before, middle, after]: [f64; 3]) -> bool {
    middle > before && middle >= after && middle - before.min(after) > 1e-12 * middle.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_golden_section_finds_a_maximum_to_half_the_digits_of_its_time() {
        let f = |t: f64| Ok::<f64, ()>(3.0 - (t - 0.3).powi(2));
        let (time, value) = maximum([0.0, 1.0], f).unwrap();
        assert!((time - 0.3).abs() < 2e-8 && (value - 3.0).abs() < 1e-15, "{time} {value}");
    }

    #[test]
    fn steady_values_and_rounding_do_not_stand_out() {
        assert!(stands_out([1.0, 2.0, 1.5]));
        assert!(!stands_out([4.0, 4.0, 4.0]));
        assert!(!stands_out([1.0, 1.0 + 1e-13, 1.0]));
        assert!(!stands_out([1.0, f64::NAN, 1.0]));
    }
}
