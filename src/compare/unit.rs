//! Units that another program's column may be in, and what they are in SI.

/// A unit, as a factor on that of a result file's dataset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// As it is written: `deg/s`.
    pub text: &'static str,
    /// The dataset's unit: `rad/s`.
    pub si: &'static str,
    /// Number of the latter in one of the former.
    pub factor: f64,
}

const fn unit(text: &'static str, si: &'static str, factor: f64) -> Unit {
    Unit { text, si, factor }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const TURN_A_MINUTE: f64 = std::f64::consts::PI / 30.0;

/// The units known, in lower case.
const UNITS: [Unit; 35] = [
    unit("s", "s", 1.0),
    unit("sec", "s", 1.0),
    unit("ms", "s", 1e-3),
    unit("us", "s", 1e-6),
    unit("µs", "s", 1e-6),
    unit("rad", "rad", 1.0),
    unit("deg", "rad", DEGREE),
    unit("°", "rad", DEGREE),
    unit("rad/s", "rad/s", 1.0),
    unit("1/s", "rad/s", 1.0),
    unit("deg/s", "rad/s", DEGREE),
    unit("°/s", "rad/s", DEGREE),
    unit("rpm", "rad/s", TURN_A_MINUTE),
    unit("rad/s^2", "rad/s^2", 1.0),
    unit("rad/s2", "rad/s^2", 1.0),
    unit("rad/s²", "rad/s^2", 1.0),
    unit("deg/s^2", "rad/s^2", DEGREE),
    unit("m", "m", 1.0),
    unit("mm", "m", 1e-3),
    unit("um", "m", 1e-6),
    unit("µm", "m", 1e-6),
    unit("m/s", "m/s", 1.0),
    unit("mm/s", "m/s", 1e-3),
    unit("m/s^2", "m/s^2", 1.0),
    unit("m/s2", "m/s^2", 1.0),
    unit("m/s²", "m/s^2", 1.0),
    unit("mm/s^2", "m/s^2", 1e-3),
    unit("n", "N", 1.0),
    unit("kn", "N", 1e3),
    unit("n m", "N m", 1.0),
    unit("nm", "N m", 1.0),
    unit("n*m", "N m", 1.0),
    unit("n·m", "N m", 1.0),
    unit("j", "J", 1.0),
    unit("-", "1", 1.0),
];

/// Endings of a name that tell its unit without brackets, `phi3_deg`.
const ENDINGS: [&str; 5] = ["deg", "rad", "mm", "ms", "rpm"];

/// A name taken apart.
#[derive(Debug, Clone, PartialEq)]
pub struct Named<'a> {
    /// The name without its unit.
    pub name: &'a str,
    /// The unit; `None` where none is written.
    pub unit: Option<Unit>,
    /// What stands in square brackets at the end without being a unit known.
    pub unknown: Option<&'a str>,
}

/// Takes a name apart: `phi3 [deg]`, `phi3 (deg)`, `phi3_deg`. What stands in round brackets and
/// is no unit belongs to the name.
pub fn named(written: &str) -> Named<'_> {
    let written = written.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        let inside = written.strip_suffix(close).and_then(|rest| rest.rsplit_once(open));
        let Some((name, text)) = inside else { continue };
        let (name, text) = (name.trim(), text.trim());
        match find(text) {
            Some(unit) => return Named { name, unit: Some(unit), unknown: None },
            // an index, y[:,2], is no unit
            None if open == '[' && !text.contains([',', ':']) => {
                return Named { name, unit: None, unknown: Some(text) };
            }
            None => {}
        }
    }
    if let Some((name, ending)) = written.rsplit_once('_') {
        let ending = ending.to_lowercase();
        if ENDINGS.contains(&ending.as_str()) && !name.is_empty() {
            return Named { name, unit: find(&ending), unknown: None };
        }
    }
    Named { name: written, unit: None, unknown: None }
}

/// The unit that a text means.
fn find(text: &str) -> Option<Unit> {
    let text = text.to_lowercase().replace('μ', "µ");
    UNITS.into_iter().find(|unit| unit.text == text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_taken_off_the_name_it_stands_behind() {
        for (written, name, si, factor) in [
            ("phi3 [deg]", "phi3", "rad", DEGREE),
            ("phi3(DEG)", "phi3", "rad", DEGREE),
            ("phi3_deg", "phi3", "rad", DEGREE),
            ("t [ms]", "t", "s", 1e-3),
            ("crank speed (rpm)", "crank speed", "rad/s", TURN_A_MINUTE),
            ("F_A [kN]", "F_A", "N", 1e3),
        ] {
            let found = named(written);
            assert_eq!(found.name, name);
            let unit = found.unit.unwrap();
            assert_eq!((unit.si, unit.factor), (si, factor), "{written}");
        }
    }

    #[test]
    fn what_is_no_unit_stays_in_the_name() {
        for written in ["angle.coupler", "y(:,3)", "y[:,2]", "angle (coupler)", "deg", "B0_x"] {
            assert_eq!(named(written), Named { name: written, unit: None, unknown: None });
        }
    }

    #[test]
    fn square_brackets_with_another_word_are_a_unit_that_is_not_known() {
        assert_eq!(named("x [furlong]").unknown, Some("furlong"));
    }
}
