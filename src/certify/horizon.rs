//! The horizon of a run: until when its numbers are the mechanism's, and not those of its errors. As
//! its companion estimates it, or its certificate knows it.

use crate::record::{self, Dimension, ResultFile};

/// Digits with which numbers still mean something: errors below a tenth of their scale.
pub const LEAST_DIGITS: f64 = 1.0;

/// Digits of a run at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Digits {
    /// Of angles, rates, velocities and clearance vectors.
    pub state: f64,
    /// Of forces and torques, and so of their peaks.
    pub forces: f64,
}

/// The horizon of a run as its result file tells it.
#[derive(Debug, Clone, PartialEq)]
pub struct Horizon {
    /// Until when angles, rates, velocities and clearance vectors mean something (s).
    pub state: f64,
    /// Until when forces, torques, accelerations and their peaks do (s).
    pub forces: f64,
    /// Until when any double-precision run of the case does (s), where it is known.
    pub doubles: Option<f64>,
    /// Digits at the end of the run, where they are known; none beyond the horizon.
    pub at_end: Option<Digits>,
    /// Time of the last sample (s).
    pub end: f64,
    /// Whether it is certified, not estimated.
    pub certified: bool,
    /// Why what is beyond is not known, where it is not.
    pub stopped: Option<String>,
}

/// What a number beyond the horizon is.
pub const ONE_DRAW: &str = "one draw from the distribution that chaos makes of it";

impl Horizon {
    /// Of a result file; `None` where it tells none. A certified reference has that of its
    /// certificate.
    ///
    /// # Errors
    /// What reading the file meets.
    pub fn of(file: &ResultFile) -> Result<Option<Horizon>, record::Error> {
        let times = file.times()?;
        let Some(&end) = times.last() else { return Ok(None) };
        let estimated = file.number("horizon").zip(file.number("horizon_forces"));
        if let Some((state, forces)) = estimated {
            let at_end = file.number("digits_at_end").zip(file.number("digits_at_end_forces"));
            return Ok(Some(Horizon {
                state,
                forces,
                doubles: file.number("horizon_doubles"),
                at_end: at_end.map(|(state, forces)| Digits { state, forces }),
                end,
                certified: false,
                stopped: file.text("horizon_stopped").map(str::to_owned),
            }));
        }
        let certified = file.along(Dimension::Time, "reference_digits")?;
        let of = |name: &str| file.along(Dimension::Time, name);
        let Some(state) = certified.clone().map_or_else(|| of("digits_left"), |of| Ok(Some(of)))?
        else {
            return Ok(None);
        };
        let mut forces = state.clone();
        for name in ["reference_digits_forces", "reference_digits_torque"] {
            for (least, digits) in forces.iter_mut().zip(of(name)?.unwrap_or_default()) {
                *least = if digits.is_nan() { digits } else { least.min(digits) };
            }
        }
        let until = |digits: &[f64]| {
            let held = digits.iter().take_while(|digits| **digits >= LEAST_DIGITS).count();
            held.checked_sub(1).and_then(|last| times.get(last)).copied().unwrap_or(0.0)
        };
        let last = state.last().zip(forces.last());
        Ok(Some(Horizon {
            state: until(&state),
            forces: until(&forces),
            doubles: file.number("double_precision_ends"),
            at_end: last.map(|(state, forces)| Digits { state: *state, forces: *forces }),
            end,
            certified: certified.is_some(),
            stopped: None,
        }))
    }

    /// Whether the whole run lies within it.
    pub fn is_whole(&self) -> bool {
        self.state.min(self.forces) >= self.end
    }

    /// One sentence about a result file that can be quoted: what made it, from what, and how far
    /// it is true.
    pub fn sentence(&self, file: &ResultFile) -> String {
        let text = |name: &str| file.text(name).unwrap_or("unknown");
        let engine = match (file.text("engine"), self.certified) {
            (Some("ida"), false) => format!("SUNDIALS IDA {}", text("sundials_version")),
            _ => "explicit engine".to_owned(),
        };
        let tolerance = file.attribute("relative_tolerance");
        let tolerance = tolerance.map_or(String::new(), |value| {
            if self.certified {
                ", 71-digit arithmetic".to_owned()
            } else {
                format!(", relative tolerance {value}")
            }
        });
        let how = match (self.certified, file.text("engine")) {
            (true, _) => "certified against a second 71-digit run",
            (false, Some("ida")) => "by comparison with a run of an independent integrator",
            (false, _) => "by comparison with a run at another tolerance",
        };
        format!(
            "Simulated with {} ({engine}{tolerance}) from the case file with SHA-256 {}; {how}, {}.",
            text("source"),
            text("case_sha256"),
            self.holds()
        )
    }

    /// How far the run is true, in words.
    pub fn holds(&self) -> String {
        const STATE: &str = "angles, rates, velocities and clearance vectors";
        const FORCES: &str = "forces, torques and their peaks";
        let whole = |until: f64| until >= self.end;
        let of = |what: &str, until: f64, digits: Option<f64>| match (whole(until), digits) {
            (true, Some(digits)) => {
                let digits = (digits * 10.0).floor() / 10.0;
                format!("{what} are true to {digits:.1} digits to its end at {}", ms(self.end))
            }
            (true, None) => format!("{what} mean something to its end at {}", ms(self.end)),
            (false, _) if until <= 0.0 => format!("{what} are true to no digit"),
            (false, _) => format!("{what} are true to a digit or more until {}", ms(until)),
        };
        let digits = self.at_end;
        let state = of(STATE, self.state, digits.map(|digits| digits.state));
        let forces = of(FORCES, self.forces, digits.map(|digits| digits.forces));
        let beyond = match (self.is_whole(), &self.stopped) {
            (true, _) => String::new(),
            (false, None) => format!("; a number beyond is {ONE_DRAW}"),
            (false, Some(_)) => "; how far numbers beyond are true is not known".to_owned(),
        };
        format!("{state}, {forces}{beyond}")
    }
}

/// A time in milliseconds, to four digits.
pub fn ms(time: f64) -> String {
    let time = time * 1e3;
    if time == 0.0 {
        return "0 ms".to_owned();
    }
    let decimals = (3 - time.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{time:.decimals$} ms")
}
