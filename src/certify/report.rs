//! A certificate in words.

use super::Certificate;
use crate::digits::{MOST_DIGITS, Parting, digits};
use crate::model::Names;
use crate::run::Event;
use std::fmt::{self, Write};

/// Digits for which the time is told up to which a run holds them.
pub(super) const TOLD: [f64; 4] = [12.0, 9.0, 6.0, 3.0];

/// What a certificate is of, beside its numbers.
#[derive(Debug, Clone, Copy)]
pub struct Told<'a> {
    /// Name of the case.
    pub case: &'a str,
    /// SHA-256 of its text, in hexadecimal.
    pub case_sha256: &'a str,
    /// Names of the mechanism's parts.
    pub names: &'a Names,
    /// Digits that were asked for.
    pub digits: f64,
    /// Time of a revolution of the first drive (s), if there is one that turns.
    pub revolution: Option<f64>,
}

impl Certificate {
    /// What the certificate says.
    pub fn words(&self, told: &Told<'_>) -> String {
        let mut words = String::new();
        // writing to a string cannot fail
        let _ = self.tell(&mut words, told);
        words
    }

    fn tell(&self, f: &mut String, told: &Told<'_>) -> fmt::Result {
        self.tell_reference(f, told.digits)?;
        if let Some(failure) = &self.run_failure {
            writeln!(f, "  run          stopped: {failure}")?;
        }
        for digits in TOLD {
            let until = self.held_words(digits);
            writeln!(f, "  run          has {digits:2} true digits of the state {until}")?;
        }
        let [forces, torque] = self.fewest_of_loads();
        let torque = match told.names.drives.is_empty() {
            true => String::new(),
            false => format!("; of torques {torque}"),
        };
        writeln!(f, "  forces       the run has {forces} of them or more{torque}")?;
        self.tell_events(f)?;
        self.tell_growth(f, told.revolution)?;
        match &self.parting {
            Some(parting) => writeln!(f, "  parting      {}", parting_words(parting, told.names))?,
            None => writeln!(f, "  parting      none: each event has its like")?,
        }
        writeln!(f, "  in a paper   {}", self.sentence(told))
    }

    fn tell_reference(&self, f: &mut String, digits: f64) -> fmt::Result {
        let reference = &self.reference;
        let [tight, loose] = reference.tolerances;
        writeln!(f, "  reference    71-digit runs at tolerances of {tight:e} and {loose:e}")?;
        let what = format!("certified to {digits} digits of the state");
        match self.reference_holds(digits) {
            Some(time) if self.reference_holds_to_the_end(digits) => {
                let before = if time < reference.until { ", its last sample before" } else { "" };
                let end = if before.is_empty() {
                    String::new()
                } else {
                    format!(" {}", ms(reference.until))
                };
                writeln!(f, "               {what} to the end, {}{before}{end}", ms(time))?;
            }
            Some(time) => writeln!(
                f,
                "               {what} until {}, of {} asked for; cannot certify beyond",
                ms(time),
                ms(reference.until)
            )?,
            None => writeln!(f, "               cannot certify {digits} digits anywhere")?,
        }
        match &reference.stopped {
            Some(stopped) => writeln!(f, "               {stopped}"),
            None => Ok(()),
        }
    }

    /// Until when the run holds so many digits.
    fn held_words(&self, digits: f64) -> String {
        let first = self.reference.trajectory.samples.first().map(|sample| sample.time);
        let last = self.reference.trajectory.samples.last().map(|sample| sample.time);
        match self.run_holds(digits) {
            None => "nowhere".to_owned(),
            held if held == last => format!("to the end, {}", ms(last.unwrap_or(0.0))),
            held if held == first => "at its first sample only".to_owned(),
            Some(time) => format!("until {}", ms(time)),
        }
    }

    /// Fewest digits of forces and of torques that the run has where doubles follow the case.
    fn fewest_of_loads(&self) -> [String; 2] {
        let until = self.reference.followed_until();
        let samples = self.reference.trajectory.samples.iter().zip(&self.claims);
        let followed =
            || samples.clone().filter(|(s, _)| s.time <= until).map(|(_, claim)| claim.run);
        let fewest = [
            followed().map(|run| run.forces).reduce(fewer),
            followed().map(|run| run.torque).reduce(fewer),
        ];
        fewest.map(counted)
    }

    fn tell_events(&self, f: &mut String) -> fmt::Result {
        let counted = || self.events.iter().filter(|event| event.counts);
        let late: Vec<f64> = counted().filter_map(|event| event.late).collect();
        let farthest = late.iter().fold(0.0, |most: f64, late| most.max(late.abs()));
        let (found, of) = (late.len(), counted().count());
        let off =
            if found > 0 { format!(", off by {farthest:.1e} s at most") } else { String::new() };
        let known = match self.reference.event_times_known_to(self.reference.followed_until()) {
            Some(known) => format!("; their true times are known to {known:.1e} s"),
            None => String::new(),
        };
        writeln!(
            f,
            "  events       the run has {found} of {of}{off}{}{known}",
            self.while_doubles()
        )?;
        let peaks = &self.peaks;
        let off = match peaks.found {
            0 => String::new(),
            _ => format!(", their forces true to {}", self::counted(Some(digits(peaks.error)))),
        };
        writeln!(
            f,
            "  peaks        the run has {} of {}{off}{}",
            peaks.found,
            peaks.of,
            self.while_doubles()
        )
    }

    /// Where it is said only of the time that doubles can follow.
    fn while_doubles(&self) -> &'static str {
        let ends = self.reference.growth.double_precision_ends;
        if ends.is_some() { ", until doubles end" } else { "" }
    }

    fn tell_growth(&self, f: &mut String, revolution: Option<f64>) -> fmt::Result {
        let reference = &self.reference;
        let until = reference.growth_known_until();
        let until = until.map_or(String::new(), |time| format!(" until {}", ms(time)));
        match reference.growth_rate() {
            Some(rate) => {
                writeln!(f, "  errors       {}{until}", growth_words(rate, revolution))?;
            }
            None => writeln!(f, "  errors       grow too little to be measured")?,
        }
        match reference.growth.double_precision_ends {
            Some(time) => writeln!(
                f,
                "  doubles      no double-precision run of this case means anything beyond {}",
                ms(time)
            ),
            None => writeln!(f, "  doubles      can follow this case to the end"),
        }
    }

    /// One sentence that can be quoted: what is certified of what, how, by which program.
    pub fn sentence(&self, told: &Told<'_>) -> String {
        let [tight, loose] = self.reference.tolerances;
        let held = match self.reference_holds(told.digits) {
            Some(time) => format!(
                "angles, rates, velocities of mass centres and clearance vectors are certified to \
                 {} digits until {}",
                told.digits,
                ms(time)
            ),
            None => format!("{} digits cannot be certified", told.digits),
        };
        format!(
            "freeplay {}, case {} (SHA-256 {}): {held} by two 71-digit integrations at tolerances \
             of {tight:e} and {loose:e}.",
            env!("CARGO_PKG_VERSION"),
            told.case,
            told.case_sha256,
        )
    }
}

/// The fewer digits of two; NaN, of a run that did not come, is none at all.
fn fewer(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NEG_INFINITY } else { a.min(b) }
}

/// Digits, rounded down to tenths; those below zero are none.
fn counted(digits: Option<f64>) -> String {
    match digits {
        Some(digits) if digits >= 0.05 => {
            format!("{:.1} digits", (digits.min(MOST_DIGITS) * 10.0).floor() / 10.0)
        }
        _ => "no digits".to_owned(),
    }
}

/// How fast errors grow or shrink; `rate` in decades a second.
fn growth_words(rate: f64, revolution: Option<f64>) -> String {
    let (period, per) = match revolution {
        Some(revolution) => (revolution, format!("revolution ({})", ms(revolution))),
        None => (1.0, "second".to_owned()),
    };
    let decades = rate * period;
    if decades.abs() < 0.05 {
        return format!("grow by less than 0.1 decades per {per}");
    }
    let word = if rate < 0.0 { "shrink" } else { "grow" };
    format!("{word} by {:.1} decades per {per}", decades.abs())
}

fn ms(time: f64) -> String {
    format!("{:.3} ms", time * 1e3)
}

/// An event, and where.
fn event_words(event: &Event, names: &Names) -> String {
    let what = event.kind.sentence();
    format!("{what} in {} at {}", event.owner.name(names), ms(event.time))
}

fn parting_words(parting: &Parting, names: &Names) -> String {
    let [has, lacks] = match parting.in_reference {
        true => ["in truth", "in the run"],
        false => ["in the run", "in truth"],
    };
    let nearest = match &parting.nearest {
        Some(event) => format!("the nearest like it is at {}", ms(event.time)),
        None => "none like it does".to_owned(),
    };
    format!("{has} {}; {lacks} {nearest}", event_words(&parting.event, names))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_that_shrink_are_said_to() {
        assert_eq!(growth_words(-7.0, None), "shrink by 7.0 decades per second");
        assert_eq!(
            growth_words(200.0, Some(0.01)),
            "grow by 2.0 decades per revolution (10.000 ms)"
        );
    }

    #[test]
    fn digits_are_rounded_down_and_none_are_called_so() {
        let told = [Some(9.97), Some(0.01), Some(-23.6), None].map(counted);
        assert_eq!(told, ["9.9 digits", "no digits", "no digits", "no digits"]);
        assert_eq!(fewer(3.0, f64::NAN), f64::NEG_INFINITY);
    }
}
