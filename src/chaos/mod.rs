//! Lyapunov exponents: by how many e-folds small differences grow in a revolution, in how many
//! directions.
//! ```text
//! λ_k = lim (1/t) Σ_j ln R_kk(j),    X(t_j) = Q_j R_j,   X(t_j) the tangents that Q_{j−1} has become
//! ```
//! K tangents of the trajectory go along with it in dual numbers, one explicit engine each; the
//! values of all are the same to the last bit. Their derivatives are made orthonormal again and again
//! (Benettin, Galgani, Giorgilli, Strelcyn 1980; Shimada, Nagashima 1979), so that the k-th measures
//! what is left of the growth of k-dimensional volumes by the k − 1 before it. What events do to a
//! tangent (P. C. Müller 1995: the saltation of systems with discontinuities) needs no formula of its
//! own: their times, and the impact rates that contacts remember, are dual numbers too.
//!
//! The states are the 2 f coordinates and velocities that the joints leave free, measured in the
//! mechanism's own scales. What contacts remember, impact rates and bristles, goes along and is counted
//! where it comes back to them: it begins and ends with each contact.

mod spectrum;
mod tangents;
mod told;

pub use spectrum::{Dimension, Exponent, Known, Zeros};
pub use told::Told;

use crate::case::{self, Case, EngineName, Precision};
use crate::mechanism::Mechanism;
use crate::run;
use crate::scalar::{Dual, F256, Scalar};
use crate::simulate::assemble;
use spectrum::Spectrum;
use std::convert::Infallible;
use std::error::Error as StdError;
use std::num::NonZeroUsize;
use tangents::Tangents;

/// Parts that a motion without a drive is looked at in, in place of revolutions.
const LAPS: u64 = 20;

/// How exponents are sought.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// How long.
    pub span: Span,
    /// Laps at the begin that do not count: the transient, in which tangents find their directions.
    pub discard: u64,
    /// How many exponents, the largest; `None` for all.
    pub exponents: Option<usize>,
    /// Threads.
    pub jobs: NonZeroUsize,
}

/// How long exponents are sought, the laps that do not count included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Span {
    /// As long as the case runs.
    Case,
    /// Revolutions of the first drive.
    Revolutions(u64),
    /// Time (s).
    Time(f64),
}

/// Exponents of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Lyapunov {
    /// Time of a lap (s): a revolution, or period, of the first drive, or a part of the whole.
    pub lap: f64,
    /// Whether laps are those of a drive.
    pub turns: bool,
    /// Laps that count.
    pub laps: u64,
    /// Laps before them.
    pub discarded: u64,
    /// How many exponents there are: twice the freedoms.
    pub states: usize,
    /// Growth of each lap that counts (e-folds), by exponent in the order of `exponents`.
    pub growth: Vec<Vec<f64>>,
    /// The exponents asked for, the largest first.
    pub exponents: Vec<Exponent>,
    /// Sum of all exponents (e-folds a lap), where all were asked for.
    pub sum: Option<Exponent>,
    /// The Kaplan–Yorke dimension, where all were asked for.
    pub dimension: Option<Dimension>,
    /// Exponents that are zero, and why.
    pub zeros: Zeros,
    /// How often in a lap tangents were made orthonormal again, at the end.
    pub parts: u64,
}

/// Why there are no exponents.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The case describes no mechanism.
    #[error(transparent)]
    Case(case::Error),
    /// The mechanism moves as it must.
    #[error("nothing in it moves freely: there are no exponents")]
    NoFreedom,
    /// More exponents than there are.
    #[error("it has {states} exponents, twice its freedoms; {asked} cannot be told")]
    TooMany {
        /// How many were asked for.
        asked: usize,
        /// How many there are.
        states: usize,
    },
    /// Revolutions of nothing.
    #[error("no drive of it comes round: give the time, not revolutions")]
    NoRevolutions,
    /// Nothing is left.
    #[error("no {lap} counts: it lasts {laps}, of which {discard} are left out")]
    NoLaps {
        /// What is counted.
        lap: &'static str,
        /// How many there are.
        laps: u64,
        /// How many are left out.
        discard: u64,
    },
    /// The run gave up.
    #[error("case \"{case}\" stopped")]
    Failed {
        /// Name of the case.
        case: String,
        /// What gave up, and where.
        source: Box<dyn StdError + Send + Sync>,
    },
    /// A direction shrinks beyond what numbers tell.
    #[error(
        "exponent {number} is too far below those before it: at t = {time:e} s volumes shrink faster \
         than numbers tell; ask for {} at most", number - 1
    )]
    Collapsed {
        /// Which, from 1.
        number: usize,
        /// When (s).
        time: f64,
    },
    /// The process was asked to stop.
    #[error("interrupted at t = {time:e} s")]
    Interrupted {
        /// Where the motion stood (s).
        time: f64,
    },
}

impl Error {
    fn of_run<E>(case: &Case, error: run::Error<E, Infallible>) -> Error
    where
        E: StdError + Send + Sync + 'static,
    {
        match error {
            run::Error::Interrupted { time } => Error::Interrupted { time },
            run::Error::Recorder(never) => match never {},
            error => Error::Failed { case: case.name.clone(), source: Box::new(error) },
        }
    }
}

/// Seeks the exponents of a case, in its arithmetic and at its tolerance, on the explicit engine whatever
/// the case says. `tell` hears how many laps are done, of how many.
///
/// # Errors
/// See [`Error`].
pub fn lyapunov(
    case: &Case,
    plan: &Plan,
    tell: &mut dyn FnMut(u64, u64),
) -> Result<Lyapunov, Error> {
    let solver = &case.plan.solver;
    match (solver.engine, solver.precision) {
        (EngineName::Explicit, Precision::Octuple) => {
            seek::<F256>(case, plan, solver.reference_tolerance, tell)
        }
        _ => seek::<f64>(case, plan, solver.relative_tolerance, tell),
    }
}

/// The same in the arithmetic `S`, at a tolerance.
fn seek<S: Scalar>(
    case: &Case,
    plan: &Plan,
    tolerance: f64,
    tell: &mut dyn FnMut(u64, u64),
) -> Result<Lyapunov, Error> {
    let mechanism: Mechanism<Dual<S>> = assemble(case).map_err(Error::Case)?;
    let states = 2 * mechanism.freedoms();
    let count = plan.exponents.unwrap_or(states);
    if states == 0 {
        return Err(Error::NoFreedom);
    }
    if !(1..=states).contains(&count) {
        return Err(Error::TooMany { asked: count, states });
    }
    let turns = mechanism.revolution();
    let (lap, all) = laps(case, plan.span, turns)?;
    if all <= plan.discard {
        let lap = if turns.is_some() { "revolution" } else { "part" };
        return Err(Error::NoLaps { lap, laps: all, discard: plan.discard });
    }
    let autonomous = spectrum::is_autonomous(&mechanism);
    let mut tangents = Tangents::new(case, mechanism, count, (tolerance, lap), plan.jobs)?;
    let mut growth = vec![Vec::new(); count];
    for number in 0..all {
        let grown = tangents.follow(number, lap)?;
        if number >= plan.discard {
            growth.iter_mut().zip(grown).for_each(|(laps, grown)| laps.push(grown));
        }
        tell(number + 1, all);
    }
    let spectrum = Spectrum::of(growth);
    let all_of_them = count == states;
    let known =
        Known { autonomous, rests: tangents.rests(), keeps_energy: tangents.keeps_energy() };
    Ok(Lyapunov {
        lap,
        turns: turns.is_some(),
        laps: all - plan.discard,
        discarded: plan.discard,
        states,
        sum: all_of_them.then(|| spectrum.sum()),
        dimension: all_of_them.then(|| spectrum.dimension()),
        zeros: Zeros::of(&spectrum.exponents, all - plan.discard, known),
        growth: spectrum.growth,
        exponents: spectrum.exponents,
        parts: tangents.parts(),
    })
}

/// Time of a lap (s), and how many there are.
fn laps(case: &Case, span: Span, turns: Option<f64>) -> Result<(f64, u64), Error> {
    // what of a revolution counts as nothing
    const ROUNDING: f64 = 1e-9;
    let duration = match span {
        Span::Revolutions(count) => {
            return turns.map(|lap| (lap, count)).ok_or(Error::NoRevolutions);
        }
        Span::Case => case.plan.duration.value(),
        Span::Time(time) => time,
    };
    Ok(turns
        .map_or((duration / LAPS as f64, LAPS), |lap| (lap, (duration / lap + ROUNDING) as u64)))
}
