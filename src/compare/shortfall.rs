//! Where a trajectory falls short of what is required of it.

use super::comparison::{Comparison, later};
use super::coverage::{Coverage, percent};
use super::reference::Way;
use super::told::{floor, seconds};
use crate::digits::Hold;
use std::fmt;
use std::path::PathBuf;

/// A share that is smaller by no more than this, relative, is not smaller.
const ROUNDING: f64 = 1e-9;

/// What is required of a trajectory; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Requirement {
    /// Digits of every sample, up to the time asked for, or else to the end of the reference.
    pub digits: Option<f64>,
    /// Share of the time that its samples cover.
    pub times: Option<f64>,
    /// Share of the columns of what moves freely that can be compared.
    pub columns: Option<f64>,
}

impl Requirement {
    /// Whether anything is required.
    pub fn is_some(&self) -> bool {
        *self != Requirement::default()
    }
}

/// Where a trajectory falls short of what is required.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{} falls short of {}: {place}", path.display(), place.required(.requirement))]
pub struct Shortfall {
    /// The file that is judged.
    pub path: PathBuf,
    /// What is required.
    pub requirement: Requirement,
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
    /// Nothing is compared but what drives prescribe.
    PrescribedAlone,
    /// Samples are missing, or columns.
    Coverage {
        /// Which of the two.
        of: Covered,
        /// How much is there.
        coverage: Coverage,
    },
}

/// What a reference is covered in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Covered {
    /// Its time.
    Times,
    /// Its columns.
    Columns,
}

impl Place {
    /// What is required that falls short here.
    fn required(&self, requirement: &Requirement) -> String {
        let share = |share: Option<f64>| percent(share.unwrap_or(1.0));
        match self {
            Place::Coverage { of: Covered::Times, .. } => {
                format!("{} of the time", share(requirement.times))
            }
            Place::Coverage { of: Covered::Columns, .. } => {
                format!("{} of the columns", share(requirement.columns))
            }
            _ => format!("{} digits", requirement.digits.unwrap_or(0.0)),
        }
    }
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
            Place::PrescribedAlone => write!(
                f,
                "all that is compared is prescribed by drives; nothing that moves freely is among \
                 its columns"
            ),
            Place::Coverage { coverage, .. } => write!(f, "it covers {coverage}"),
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
    /// Where this falls short of what is required; `None` if it has it.
    pub fn shortfall(&self, requirement: &Requirement) -> Option<Shortfall> {
        let digits = requirement.digits.and_then(|required| {
            let prescribed = self.coverage.is_of_prescribed_alone();
            let short = self.short_of(required).or_else(|| self.ends_early());
            short.or(prescribed.then_some(Place::PrescribedAlone))
        });
        let place = digits.or_else(|| self.covers_less(requirement))?;
        let (path, requirement) = (self.theirs.path.clone(), *requirement);
        Some(Shortfall { path, requirement, place })
    }

    fn covers_less(&self, requirement: &Requirement) -> Option<Place> {
        let coverage = self.coverage;
        let less = |share: f64, required: Option<f64>| {
            required.is_some_and(|required| share < required * (1.0 - ROUNDING))
        };
        let of = if less(coverage.time, requirement.times) {
            Covered::Times
        } else if less(coverage.column_share(), requirement.columns) {
            Covered::Columns
        } else {
            return None;
        };
        Some(Place::Coverage { of, coverage })
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
