//! Numbers as people read them in tables.

/// A number with so many significant digits, a true minus sign, and powers of ten where it is
/// very large or small; as HTML. What is no finite number is a dash.
pub(super) fn significant(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let written = format!("{:.*e}", (digits - 1).max(0) as usize, value.abs());
    let (mantissa, exponent) = written.split_once('e').unwrap_or((&written, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let sign = if value < 0.0 { "−" } else { "" };
    if (-4..7).contains(&exponent) {
        let decimals = (digits - 1 - exponent).max(0) as usize;
        return format!("{sign}{}", grouped(&format!("{:.decimals$}", value.abs())));
    }
    format!("{sign}{mantissa}\u{202f}×\u{202f}10<sup>{}</sup>", exponent_of_ten(exponent))
}

/// The same as plain text, for where there are no tags: in SVG.
pub(super) fn significant_plain(value: f64, digits: i32) -> String {
    let html = significant(value, digits);
    let Some((lead, exponent)) = html.split_once("<sup>") else { return html };
    let raised = |c: char| match c {
        '−' => '⁻',
        digit => digit.to_digit(10).map_or(digit, |digit| RAISED[digit as usize]),
    };
    let exponent: String = exponent.trim_end_matches("</sup>").chars().map(raised).collect();
    format!("{lead}{exponent}")
}

/// Digits as exponents.
const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// A number with all its digits, and powers of ten where it is very large or small; as HTML.
pub(super) fn exactly(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() || size == 0.0 || (1e-3..1e6).contains(&size) {
        return if value.is_finite() {
            value.to_string().replace('-', "−")
        } else {
            "–".to_owned()
        };
    }
    let written = format!("{size:e}");
    let (mantissa, exponent) = written.split_once('e').unwrap_or((&written, "0"));
    let sign = if value < 0.0 { "−" } else { "" };
    let lead = match mantissa {
        "1" => String::new(),
        mantissa => format!("{mantissa}\u{202f}×\u{202f}"),
    };
    format!("{sign}{lead}10<sup>{}</sup>", exponent.replace('-', "−"))
}

/// Digits before the point in groups of three, from ten thousand on.
fn grouped(number: &str) -> String {
    let (whole, fraction) = number.split_once('.').map_or((number, None), |(w, f)| (w, Some(f)));
    let mut text = String::new();
    for (place, digit) in whole.chars().enumerate() {
        if place > 0 && (whole.len() - place).is_multiple_of(3) && whole.len() > 4 {
            text.push('\u{202f}'); // narrow, and no line ends at it
        }
        text.push(digit);
    }
    if let Some(fraction) = fraction {
        text.push('.');
        text.push_str(fraction);
    }
    text
}

fn exponent_of_ten(exponent: i32) -> String {
    exponent.to_string().replace('-', "−")
}

/// A time (s) in milliseconds, to 0.1 µs.
pub(super) fn milliseconds(time: f64) -> String {
    if !time.is_finite() {
        return "–".to_owned();
    }
    format!("{:.4}", time * 1e3).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::{exactly, milliseconds, significant, significant_plain};

    #[test]
    fn plain_text_has_no_tags() {
        assert_eq!(significant_plain(2.54e-5, 4), "2.540\u{202f}×\u{202f}10⁻⁵");
        assert_eq!(significant_plain(-1.5e12, 2), "−1.5\u{202f}×\u{202f}10¹²");
        assert_eq!(significant_plain(12.5, 3), "12.5");
    }

    #[test]
    fn numbers_read_as_in_print() {
        for (value, digits, expected) in [
            (892.919_148, 6, "892.919"),
            (-10.728_744, 6, "−10.7287"),
            (60_236.42, 6, "60\u{202f}236.4"),
            (13_582.0, 3, "13\u{202f}582"),
            (0.000_123_4, 3, "0.000123"),
            (9.999_9, 3, "10.0"),
            (1.043_715e10, 4, "1.044\u{202f}×\u{202f}10<sup>10</sup>"),
            (-1e-20, 2, "−1.0\u{202f}×\u{202f}10<sup>−20</sup>"),
            (0.0, 3, "0"),
            (f64::NAN, 3, "–"),
            (f64::INFINITY, 3, "–"),
        ] {
            assert_eq!(significant(value, digits), expected);
        }
        for (value, expected) in [
            (1e-12, "10<sup>−12</sup>"),
            (-2.5e-20, "−2.5\u{202f}×\u{202f}10<sup>−20</sup>"),
            (1.043_715e10, "1.043715\u{202f}×\u{202f}10<sup>10</sup>"),
            (-0.06, "−0.06"),
            (5000.0, "5000"),
            (0.0, "0"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(exactly(value), expected);
        }
        assert_eq!(milliseconds(0.012_530_04), "12.5300");
        assert_eq!(milliseconds(f64::NAN), "–");
    }
}
