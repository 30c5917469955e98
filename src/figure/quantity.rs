//! Units of axes: SI, with the prefix that makes the numbers readable.

use super::text::Text;
use super::ticks::signed;

/// Prefixes that people read at sight, as powers of ten.
const PREFIXES: [(i32, &str); 7] =
    [(0, ""), (-3, "m"), (3, "k"), (-6, "µ"), (6, "M"), (-9, "n"), (9, "G")];

/// The unit of an axis, and what a value in SI units is divided by to be in it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unit {
    /// The unit in SI units.
    pub size: f64,
    /// How it is written.
    pub text: Text,
}

impl Unit {
    /// Degrees, for values in radians.
    pub fn degrees() -> Self {
        Unit { size: std::f64::consts::PI / 180.0, text: Text::roman("°") }
    }

    /// No unit at all.
    pub fn one() -> Self {
        Unit { size: 1.0, text: Text::default() }
    }

    /// The unit that suits values as large as this one. `unit` is written as in result files: a
    /// unit with letters of its own takes a prefix, `rad/s^2` a power of ten.
    pub fn fitting(unit: &str, largest: f64) -> Self {
        let largest = largest.abs();
        let reads_well = |power: i32| (0.5..1000.0).contains(&(largest / 10_f64.powi(power)));
        if !(largest > 0.0 && largest.is_finite()) {
            return Unit { size: 1.0, text: written(unit) };
        }
        if !unit.starts_with("rad")
            && let Some((power, prefix)) = PREFIXES.iter().find(|(power, _)| reads_well(*power))
        {
            let text = Text::roman(*prefix).and_text(&written(unit));
            return Unit { size: 10_f64.powi(*power), text };
        }
        let power = (largest.log10().floor() as i32).div_euclid(3) * 3;
        let power = if reads_well(0) { 0 } else { power };
        let factor = match power {
            0 => Text::default(),
            _ => Text::roman("10").and_superscript(signed(&power.to_string())).and("\u{a0}"),
        };
        Unit { size: 10_f64.powi(power), text: factor.and_text(&written(unit)) }
    }

    /// A number with the unit behind it: `5 kN`, `0.1 × 10⁶ rad/s²`.
    pub fn after(&self, number: &str) -> Text {
        let times = if self.text.plain().starts_with("10") { " ×" } else { "" };
        Text::roman(format!("{number}{times} ")).and_text(&self.text)
    }

    /// A title with the unit behind it in brackets.
    pub fn behind(&self, title: Text) -> Text {
        if self.text.is_empty() { title } else { title.and(" (").and_text(&self.text).and(")") }
    }
}

/// A unit of a result file as print has it.
fn written(unit: &str) -> Text {
    match unit {
        "N m" => Text::roman("N\u{a0}m"),
        "rad/s^2" => Text::roman("rad/s²"),
        "m/s^2" => Text::roman("m/s²"),
        unit => Text::roman(unit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_the_prefix_that_leaves_few_digits() {
        for (unit, largest, text) in [
            ("N", 892.9, "N"),
            ("N", 11_040.0, "kN"),
            ("N m", 0.6, "N\u{a0}m"),
            ("N m", -0.02, "mN\u{a0}m"),
            ("m", 1.1e-3, "mm"),
            ("m", 3.2e-5, "µm"),
            ("s", 0.06, "ms"),
            ("s", 2.0, "s"),
            ("m/s", 7.2, "m/s"),
            ("J", 4e-10, "10−12\u{a0}J"),
            ("J", 4e-9, "nJ"),
            ("J", 0.0, "J"),
            ("J", f64::NAN, "J"),
            ("rad/s^2", 86_935.0, "103\u{a0}rad/s²"),
            ("rad/s^2", 86.0, "rad/s²"),
        ] {
            assert_eq!(Unit::fitting(unit, largest).text.plain(), text, "{largest} {unit}");
        }
    }

    #[test]
    fn a_power_of_ten_is_multiplied_with_the_number_before_it() {
        let after = |unit, largest| Unit::fitting(unit, largest).after("0.1").plain();
        assert_eq!(after("rad/s^2", 4e6), "0.1 × 106\u{a0}rad/s²");
        assert_eq!(after("N", 4e3), "0.1 kN");
    }

    #[test]
    fn a_title_without_unit_has_no_brackets() {
        assert_eq!(Unit::one().behind(Text::roman("Digits")).plain(), "Digits");
        assert_eq!(Unit::degrees().behind(Text::italic("φ")).plain(), "φ (°)");
    }
}
