//! A certificate in words.

use super::{Certificate, Parting};
use crate::model::Names;
use crate::run::{Event, EventKind};
use std::fmt::{self, Write};

/// Digits for which the time is told up to which a run holds them.
const TOLD: [f64; 4] = [12.0, 9.0, 6.0, 3.0];

impl Certificate {
    /// What the certificate says. `digits` were asked for; `revolution` (s) is that of the first
    /// drive, if there is one.
    pub fn words(&self, names: &Names, digits: f64, revolution: Option<f64>) -> String {
        let mut words = String::new();
        // writing to a string cannot fail
        let _ = self.tell(&mut words, names, digits, revolution);
        words
    }

    fn tell(
        &self,
        f: &mut String,
        names: &Names,
        digits: f64,
        revolution: Option<f64>,
    ) -> fmt::Result {
        let reference = &self.reference;
        let [tight, loose] = reference.tolerances;
        writeln!(f, "  reference    71-digit runs at {tight:e} and {loose:e}")?;
        match self.reference_holds(digits) {
            Some(time) if self.reference_holds_to_the_end(digits) => {
                writeln!(
                    f,
                    "               certified to {digits} digits to the end, {}",
                    ms(time)
                )?;
            }
            Some(time) => writeln!(
                f,
                "               certified to {digits} digits until {}; cannot certify beyond",
                ms(time)
            )?,
            None => writeln!(f, "               cannot certify {digits} digits anywhere")?,
        }
        if let Some(stopped) = &reference.stopped {
            writeln!(f, "               {stopped}")?;
        }
        if let Some(failure) = &self.run_failure {
            writeln!(f, "  run          stopped: {failure}")?;
        }
        for digits in TOLD {
            let until =
                self.run_holds(digits).map_or("never".into(), |t| format!("until {}", ms(t)));
            writeln!(f, "  run          holds {digits:2} digits {until}")?;
        }
        let until = reference.growth_known_until();
        let until = until.map_or(String::new(), |time| format!(" until {}", ms(time)));
        match (reference.growth_rate(), revolution) {
            (Some(growth), Some(revolution)) => writeln!(
                f,
                "  errors grow  {:.1} decades per revolution ({}){until}",
                growth * revolution,
                ms(revolution)
            )?,
            (Some(growth), None) => {
                writeln!(f, "  errors grow  {growth:.1} decades per second{until}")?
            }
            (None, _) => writeln!(f, "  errors grow  too little to be measured")?,
        }
        match reference.growth.double_precision_ends {
            Some(time) => writeln!(
                f,
                "  doubles      no double-precision run of this case means anything beyond {}",
                ms(time)
            )?,
            None => writeln!(f, "  doubles      can follow this case to the end")?,
        }
        let found = self.events.iter().filter(|event| event.late.is_some()).count();
        writeln!(f, "  events       the run has {found} of {}", self.events.len())?;
        match &self.parting {
            Some(parting) => writeln!(f, "  parting      {}", parting_words(parting, names)),
            None => writeln!(f, "  parting      none: the same events in the same order"),
        }
    }
}

fn ms(time: f64) -> String {
    format!("{:.3} ms", time * 1e3)
}

fn parting_words(parting: &Parting, names: &Names) -> String {
    let told = |event: &Option<Event>| match event {
        Some(event) => {
            let joint = &names.clearances[event.clearance];
            let what = match event.kind {
                EventKind::ContactBegins => "a contact begins",
                EventKind::ContactEnds => "a contact ends",
                EventKind::FrictionKink => "the slip passes an edge of friction",
                EventKind::Tension => "tension begins or ends",
            };
            format!("{what} in {joint} at {}", ms(event.time))
        }
        None => "nothing more happens".to_owned(),
    };
    format!("in truth {}; in the run {}", told(&parting.reference), told(&parting.run))
}
