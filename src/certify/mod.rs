//! Certified digits: a run against references in 71-digit arithmetic.
//!
//! What is claimed is on the safe side: a reference is said to be wrong by twice what its looser
//! companion is off, and by what it loses when written as doubles; a run by its distance from the
//! reference and what the reference is wrong by.

mod digits;
mod growth;
mod horizon;
mod matching;
mod reference;
mod report;
mod stored;
mod tangent;

pub use digits::{MOST_DIGITS, Parts, Scales, digits};
pub use horizon::{
    Companion, Digits, Horizon, LEAST_DIGITS, ONE_DRAW, Reach, Until, Witness, companion, ms,
};
pub use matching::{Match, Parting};
pub use reference::{Error, Growth, Stage, Stopped, Watch};
pub use stored::NotAReference;
pub use tangent::{Tangent, tangent};

use crate::case::Case;
use crate::record::ResultFile;
use crate::run::{Schedule, Trajectory, Watcher};
use crate::simulate::{self, Simulation, Statistics};
use std::convert::Infallible;
use std::f64::consts::LOG10_E;

/// What a certificate says of each sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claim {
    /// Digits to which the reference is true.
    pub reference: Parts<f64>,
    /// Digits to which the run is; NaN where it did not come.
    pub run: Parts<f64>,
}

/// A certified reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// The trajectory, as doubles with their remainders.
    pub trajectory: Trajectory,
    /// What it may be wrong by, scaled, at each sample.
    pub wrong: Vec<Parts<f64>>,
    /// Scales of the errors.
    pub scales: Scales,
    /// Tolerances of the two runs behind it.
    pub tolerances: [f64; 2],
    /// How a small change of the start grows.
    pub growth: Growth,
    /// Whether it goes to the end that was asked for.
    pub complete: bool,
    /// Why it does not, if a run behind it stopped.
    pub stopped: Option<String>,
}

/// A run held against a certified reference.
#[derive(Debug, Clone)]
pub struct Certificate {
    /// The reference.
    pub reference: Reference,
    /// Claims, at each sample of the reference.
    pub claims: Vec<Claim>,
    /// What the run has of each event of the reference.
    pub events: Vec<Match>,
    /// Where run and reference have different events, if they do.
    pub parting: Option<Parting>,
    /// Why the run under test stopped, if it did.
    pub run_failure: Option<String>,
    /// What the run under test counted.
    pub statistics: Statistics,
}

/// Makes a certified reference of a case, to at least `digits` digits as far as 71-digit arithmetic
/// reaches.
///
/// # Errors
/// See [`Error`].
pub fn reference(
    case: &Case,
    schedule: &Schedule,
    digits: f64,
    watch: Watch<'_>,
) -> Result<Reference, Error> {
    let pair = reference::references(case, schedule, digits, watch)?;
    let growth = reference::growth(case, schedule, &pair, watch)?;
    let scales = pair.scales;
    let wrong = (pair.tight.samples.iter().zip(&pair.apart))
        .map(|(sample, apart)| {
            scales.rounding(sample).zip(*apart, |lost, apart| lost + 2.0 * apart)
        })
        .collect::<Vec<_>>();
    let mut trajectory = pair.tight;
    trajectory.samples.truncate(wrong.len());
    let complete = wrong.len() as u64 >= schedule.len();
    let stopped = pair.stopped.map(|stopped| chain(&stopped));
    let tolerances = pair.tolerances;
    Ok(Reference { trajectory, wrong, scales, tolerances, growth, complete, stopped })
}

/// An error with all its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        words.push_str(": ");
        words.push_str(&cause.to_string());
        source = cause.source();
    }
    words
}

/// A certified reference that was kept.
///
/// # Errors
/// The file holds no certificate, or that of another case.
pub fn stored(case: &Case, file: &ResultFile) -> Result<Reference, NotAReference> {
    stored::read(case, file)
}

/// Runs a case as its plan says and holds it against a reference.
pub fn certify(
    simulation: Simulation<'_>,
    reference: Reference,
    watch: Watcher<'_>,
) -> Result<Certificate, simulate::Error<Infallible>> {
    let mut run = Trajectory::default();
    let (statistics, ran) = simulation.run(&mut run, watch);
    let run_failure = match ran {
        Ok(()) => None,
        Err(simulate::Error::Interrupted { time }) => {
            return Err(simulate::Error::Interrupted { time });
        }
        Err(error) => Some(chain(&error)),
    };
    let claims = claims(&run, &reference);
    let (events, parting) = matching::events(&run, &reference.trajectory);
    Ok(Certificate { reference, claims, events, parting, run_failure, statistics })
}

/// Claims at each sample of the reference; the run has the same sample times as far as it goes.
fn claims(run: &Trajectory, reference: &Reference) -> Vec<Claim> {
    let Reference { trajectory, wrong, scales, .. } = reference;
    let mut runs = run.samples.iter().peekable();
    (trajectory.samples.iter().zip(wrong))
        .map(|(sample, wrong)| {
            while runs.peek().is_some_and(|run| run.time < sample.time) {
                runs.next();
            }
            let same = runs.peek().filter(|run| run.time == sample.time);
            let of_run = same.map_or(Parts::all(f64::NAN), |run| {
                let apart = scales.differences(run, sample);
                apart.zip(*wrong, |apart, wrong| digits(apart + wrong))
            });
            Claim { reference: wrong.map(digits), run: of_run }
        })
        .collect()
}

impl Reference {
    /// Decades by which an error grows in a second: the slope of the straight line through the
    /// logarithms of the growth, over all of it that is known; `None` where there is nothing to grow.
    pub fn growth_rate(&self) -> Option<f64> {
        let times = self.trajectory.samples.iter().map(|sample| sample.time);
        growth::rate(times.zip(self.growth.factors.iter().copied())).map(|rate| rate * LOG10_E)
    }
}

impl Reference {
    /// Time (s) up to which the growth of errors is known, where that is not the end.
    pub fn growth_known_until(&self) -> Option<f64> {
        let known = self.growth.factors.len();
        let samples = &self.trajectory.samples;
        (known < samples.len()).then(|| Some(samples.get(known.checked_sub(1)?)?.time)).flatten()
    }
}

impl Certificate {
    /// Last time (s) up to which the run holds this many digits of the state; `None` if it does
    /// not even at its start.
    pub fn run_holds(&self, digits: f64) -> Option<f64> {
        self.holds(digits, |claim| claim.run.state)
    }

    /// Last time (s) up to which the reference is certified to this many digits of the state.
    pub fn reference_holds(&self, digits: f64) -> Option<f64> {
        self.holds(digits, |claim| claim.reference.state)
    }

    /// Whether the reference is certified to this many digits to the end that was asked for.
    pub fn reference_holds_to_the_end(&self, digits: f64) -> bool {
        let held = self.claims.iter().all(|claim| claim.reference.state >= digits);
        self.reference.complete && held
    }

    fn holds(&self, digits: f64, of: fn(&Claim) -> f64) -> Option<f64> {
        let held = self.claims.iter().take_while(|claim| of(claim) >= digits).count();
        Some(self.reference.trajectory.samples[held.checked_sub(1)?].time)
    }
}
