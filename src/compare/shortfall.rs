//! Where a trajectory falls short of what is required of it.

use super::comparison::{Comparison, later};
use super::grade::Hold;
use super::reference::Way;
use super::told::{floor, seconds};
use std::fmt;
use std::path::PathBuf;

/// Where a trajectory falls short of the digits required.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{} falls short of {required} digits: {place}", path.display())]
pub struct Shortfall {
    /// The file that is judged.
    pub path: PathBuf,
    /// Digits required.
    pub required: f64,
    /// Where it falls short first.
    pub place: Place,
}

/// Where a trajectory falls short first.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// A number differs too much.
    Number {
        /// Time (s).
        time: f64,
        /// Digits there.
        digits: f64,
        /// The column.
        column: String,
        /// Its value.
        theirs: f64,
        /// Its value in the reference.
        reference: f64,
    },
    /// The reference is not certified to as many digits.
    Certificate {
        /// Time (s).
        time: f64,
        /// Digits to which it is certified.
        digits: f64,
    },
    /// There are no samples up to the time required.
    Ends {
        /// Last time compared (s).
        last: f64,
        /// The time required (s).
        until: f64,
        /// Whether `--until` asked for it.
        asked_for: bool,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Number { time, digits, column, theirs, reference } => {
                let (time, digits) = (seconds(*time), floor(*digits));
                write!(
                    f,
                    "from {time} s on, where {column} is {theirs:e} and the reference {reference:e} \
                     ({digits} digits)"
                )
            }
            Place::Certificate { time, digits } => {
                let (time, digits) = (seconds(*time), floor(*digits));
                write!(f, "at {time} s the reference itself is certified to {digits} digits only")
            }
            Place::Ends { last, until, asked_for } => {
                let (last, until) = (seconds(*last), seconds(*until));
                write!(f, "the comparison ends at {last} s, ")?;
                match asked_for {
                    true => write!(f, "before --until {until} s"),
                    false => write!(
                        f,
                        "the reference goes on until {until} s; --until {last} requires no more"
                    ),
                }
            }
        }
    }
}

impl Comparison {
    /// Where this falls short of the digits required; `None` if every sample has them, up to the
    /// time asked for, or else to the end of the reference.
    pub fn shortfall(&self, required: f64) -> Option<Shortfall> {
        let place = self.short_of(required).or_else(|| self.ends_early())?;
        Some(Shortfall { path: self.theirs.path.clone(), required, place })
    }

    fn short_of(&self, required: f64) -> Option<Place> {
        let series = &self.series;
        let row = Hold::new(required, &series.times, &series.gate).first_below?;
        let (time, grade) = (series.times[row], series.gate[row]);
        let certified = self.columns[grade.column].quantity().zip(self.certificate.as_ref());
        let certified = certified.map(|(quantity, certificate)| certificate.at(quantity, time));
        if certified.is_some_and(|certified| certified <= grade.digits) {
            return Some(Place::Certificate { time, digits: grade.digits });
        }
        Some(Place::Number {
            time,
            digits: grade.digits,
            column: self.column_name(grade.column),
            theirs: self.values.theirs[grade.column][row],
            reference: self.values.reference[grade.column][row],
        })
    }

    fn ends_early(&self) -> Option<Place> {
        let until = self.until.unwrap_or(self.reference.span[1]);
        let compared = self.series.times.last().copied().unwrap_or(f64::NEG_INFINITY);
        // where only common times are looked at, the last of the reference's must be among them
        let last = match self.way {
            Way::CommonTimes if later(compared) < self.last_wanted => compared,
            Way::CommonTimes => self.theirs.span[1],
            Way::Stored | Way::RunAgain { .. } => self.theirs.span[1],
        };
        (later(last) < until).then_some(Place::Ends {
            last,
            until,
            asked_for: self.until.is_some(),
        })
    }
}
