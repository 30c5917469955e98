//! `freeplay compare THEIRS REFERENCE`

use super::Failure;
use super::signals::Signals;
use crate::compare::{self, Comparison, Map, Request, Requirement};
use crate::run::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;

/// Most digits that can be required: doubles carry hardly more.
const MOST_REQUIRED: f64 = 15.0;

/// Arguments of `compare`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Trajectory that is judged: a result file, CSV, MATLAB 7.3 or other HDF5.
    theirs: PathBuf,
    /// Trajectory that it is judged by: a result file, or a table with the times of the first.
    reference: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// Fail with exit code 1 where fewer digits agree.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    require_digits: Option<f64>,
    /// Fail with exit code 1 where samples cover a smaller share (0 to 1) of the time.
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    require_times: Option<f64>,
    /// Fail with exit code 1 where a smaller share (0 to 1) of the columns that move freely is
    /// compared.
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    require_columns: Option<f64>,
    /// Look no further than this time (s).
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Which column of another program is which of ours: phi3=angle.coupler, t[ms]=time.
    #[arg(long, value_name = "THEIRS=OURS")]
    map: Vec<Map>,
    /// Look at forces and torques too, and have them count.
    #[arg(long)]
    forces: bool,
    /// Look only at times that both files hold; never run the reference's case again.
    #[arg(long)]
    common_times: bool,
}

/// An argument out of its range.
#[derive(Debug, thiserror::Error)]
enum OutOfRange {
    #[error("--require-digits must be greater than 0 and at most {MOST_REQUIRED}, is {0}")]
    Digits(f64),
    #[error("{0} must be a share greater than 0 and at most 1, is {1}")]
    Share(&'static str, f64),
    #[error("--until must be a time of 0 s or later, is {0}")]
    Until(f64),
}

/// Holds a trajectory against a reference, and tells how far they agree.
pub(super) fn compare(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check().map_err(Failure::input)?;
    let request = Request {
        until: arguments.until,
        forces: arguments.forces,
        common_times: arguments.common_times,
        maps: &arguments.map,
    };
    let signals = Signals::new().map_err(Failure::output)?;
    let bar = ProgressBar::no_length();
    let style = ProgressStyle::with_template("{spinner} {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
    let mut watch = |progress: &Progress| {
        bar.set_message(format!("the reference's case is at {:.6} s", progress.time));
        bar.tick();
        signals.flow()
    };
    let compared = Comparison::new(&arguments.theirs, &arguments.reference, &request, &mut watch);
    bar.finish_and_clear();
    let comparison = compared.map_err(|error| failure(error, &signals))?;
    let requirement = arguments.requirement();
    match arguments.json {
        true => super::print_json(format_args!("{}\n", comparison.json(&requirement))),
        false => super::print(&comparison),
    }?;
    if let Some(shortfall) = comparison.shortfall(&requirement) {
        return Err(Failure::with(1, shortfall));
    }
    if requirement.digits.is_some() && comparison.coverage.has_gaps() {
        super::say(format_args!("warning: it has the digits, but covers {}", comparison.coverage));
    }
    Ok(())
}

impl Arguments {
    fn requirement(&self) -> Requirement {
        Requirement {
            digits: self.require_digits,
            times: self.require_times,
            columns: self.require_columns,
        }
    }

    fn check(&self) -> Result<(), OutOfRange> {
        for (option, share) in
            [("--require-times", self.require_times), ("--require-columns", self.require_columns)]
        {
            if let Some(share) = share.filter(|share| !(*share > 0.0 && *share <= 1.0)) {
                return Err(OutOfRange::Share(option, share));
            }
        }
        match (self.require_digits, self.until) {
            (Some(digits), _) if !(digits > 0.0 && digits <= MOST_REQUIRED) => {
                Err(OutOfRange::Digits(digits))
            }
            (_, Some(until)) if !(until >= 0.0 && until.is_finite()) => {
                Err(OutOfRange::Until(until))
            }
            _ => Ok(()),
        }
    }
}

/// What cannot be simulated is 4, anything else bad input.
fn failure(error: compare::Error, signals: &Signals) -> Failure {
    use compare::Error::{Again, Interrupted, NotReproduced};
    match error {
        Again { .. } | Interrupted | NotReproduced { .. } => signals.failure(error),
        _ => Failure::input(error),
    }
}
