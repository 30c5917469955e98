//! Exponents in words and in JSON.

use super::Lyapunov;
use super::spectrum::{Exponent, Known};
use serde_json::{Value, json};
use std::f64::consts::LN_10;
use std::fmt::Write;

/// What is said of exponents beside themselves.
#[derive(Debug, Clone, Copy)]
pub struct Told<'a> {
    /// Name of the case.
    pub case: &'a str,
    /// SHA-256 of its text.
    pub case_sha256: &'a str,
}

impl Lyapunov {
    /// What laps are called.
    fn lap_word(&self) -> &'static str {
        if self.turns { "revolution" } else { "part" }
    }

    /// In words.
    pub fn words(&self, told: &Told<'_>) -> String {
        let lap = self.lap_word();
        let mut words = format!(
            "{}: {} of {} exponents, over {} {lap}s of {:.6e} s",
            told.case,
            self.exponents.len(),
            self.states,
            self.laps,
            self.lap
        );
        let _ = match self.discarded {
            0 => writeln!(words, ", none before them"),
            discarded => writeln!(words, " after {discarded} that do not count"),
        };
        let _ = writeln!(words, "        e-folds per {lap:<12} per second      digits per {lap}");
        for (k, exponent) in self.exponents.iter().enumerate() {
            let _ = writeln!(
                words,
                "  {:>3}  {:>+11.5} {:<12} {:>+12.5e}   {:>+8.4}",
                k + 1,
                exponent.per_lap,
                plus_minus(exponent.half_width),
                exponent.per_lap / self.lap,
                exponent.per_lap / LN_10
            );
        }
        if let Some(sum) = self.sum {
            let width = plus_minus(sum.half_width);
            let per_second = sum.per_lap / self.lap;
            let _ = writeln!(
                words,
                "  sum  {:>+11.5} {width:<12} {per_second:>+12.5e}   of all",
                sum.per_lap
            );
        }
        if let Some(dimension) = self.dimension {
            let width = plus_minus(dimension.half_width);
            let _ = writeln!(
                words,
                "  Kaplan-Yorke dimension {:.4} {width}, of {} states",
                dimension.value, self.states
            );
        }
        let _ = writeln!(words, "  zero: {}", self.zero_words());
        if self.exponents.iter().all(|exponent| exponent.half_width.is_some()) {
            let _ = writeln!(words, "  ± is a 95 % interval from batch means");
        } else {
            let _ = writeln!(words, "  one {lap} alone has no interval");
        }
        words
    }

    /// Which exponents are zero, and why.
    fn zero_words(&self) -> String {
        let found: Vec<String> = self.zeros.found.iter().map(|k| (k + 1).to_string()).collect();
        let found = match found.len() {
            0 => "none of these may be, within its interval".to_owned(),
            1 => format!("exponent {} may be, as far as so many laps tell", found[0]),
            _ => format!("exponents {} may be, as far as so many laps tell", found.join(", ")),
        };
        let why = match self.zeros.known {
            Known { autonomous: false, .. } => {
                "time drives the motion and is no state, so that none need be"
            }
            Known { rests: true, .. } => "it has come to rest, so that none need be",
            Known { keeps_energy: true, .. } => {
                "two must be, one along the flow (no drive) and one across it (energy is kept), and \
                 the others come in pairs of opposite sign"
            }
            Known { .. } => "one must be, along the flow (no drive)",
        };
        let more = self.zeros.found.len() > self.zeros.expected();
        let other = match more {
            true => {
                ". What else makes one: a body that turns or travels freely, a contact that lasts (it \
                 remembers its impact rate for ever), a motion on a torus, a bifurcation"
            }
            false => "",
        };
        format!("{found}; {why}{other}")
    }

    /// In JSON.
    pub fn json(&self, told: &Told<'_>) -> Value {
        let exponent = |exponent: &Exponent| {
            json!({
                "per_revolution": exponent.per_lap,
                "half_width": exponent.half_width,
                "per_second": exponent.per_lap / self.lap,
                "digits_per_revolution": exponent.per_lap / LN_10,
            })
        };
        let exponents: Vec<Value> = (self.exponents.iter().zip(&self.growth))
            .map(|(its, growth)| {
                let mut told = exponent(its);
                told["revolutions"] = json!(growth);
                told
            })
            .collect();
        let known = self.zeros.known;
        json!({
            "case": told.case,
            "case_sha256": told.case_sha256,
            "revolution": { "value": self.lap, "unit": "s", "of_a_drive": self.turns },
            "revolutions": self.laps,
            "discarded": self.discarded,
            "states": self.states,
            "exponents": exponents,
            "sum": self.sum.as_ref().map(exponent),
            "kaplan_yorke": self.dimension.map(|dimension| json!({
                "dimension": dimension.value,
                "half_width": dimension.half_width,
            })),
            "zero": {
                "found": self.zeros.found.iter().map(|k| k + 1).collect::<Vec<_>>(),
                "expected": self.zeros.expected(),
                "autonomous": known.autonomous,
                "rests": known.rests,
                "keeps_energy": known.keeps_energy,
                "words": self.zero_words(),
            },
            "orthonormalised_per_revolution": self.parts,
            "confidence": 0.95,
        })
    }
}

fn plus_minus(half_width: Option<f64>) -> String {
    half_width.map_or(String::new(), |width| format!("± {width:.5}"))
}
