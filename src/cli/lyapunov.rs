//! `freeplay lyapunov CASE`

use super::signals::Signals;
use super::{CaseArguments, Failure};
use crate::chaos::{self, Error, Plan, Span, Told};
use crate::record::sha256;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::num::NonZeroUsize;

/// Arguments of `lyapunov`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,
    /// Revolutions of the first drive; default: as many as the case runs.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    revolutions: Option<u64>,
    /// Simulated time (s), in place of the case's `run.duration`; without a drive it is looked at in
    /// twenty parts.
    #[arg(long, value_name = "T", value_parser = time, conflicts_with = "revolutions")]
    until: Option<f64>,
    /// Revolutions at the begin that do not count.
    #[arg(long, value_name = "N", default_value_t = 0)]
    discard: u64,
    /// How many exponents, the largest, or `all`.
    #[arg(long, value_name = "K", default_value = "1", value_parser = exponents)]
    exponents: Wanted,
    /// Tangents at a time; default: one for each core.
    #[arg(short, long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// No progress on stderr.
    #[arg(short, long)]
    quiet: bool,
}

/// How many exponents; `None` for all.
#[derive(Debug, Clone, Copy)]
struct Wanted(Option<usize>);

fn exponents(text: &str) -> Result<Wanted, String> {
    match (text, text.parse()) {
        ("all", _) => Ok(Wanted(None)),
        (_, Ok(count)) if count > 0 => Ok(Wanted(Some(count))),
        _ => Err("must be a number of exponents from 1, or all".to_owned()),
    }
}

fn time(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(time) if time > 0.0 && f64::is_finite(time) => Ok(time),
        _ => Err("must be a positive time (s)".to_owned()),
    }
}

/// Tells the exponents of a case.
pub(super) fn lyapunov(arguments: &Arguments) -> Result<(), Failure> {
    let case = arguments.case.read()?;
    let signals = Signals::new().map_err(Failure::output)?;
    let span = match (arguments.revolutions, arguments.until) {
        (Some(count), _) => Span::Revolutions(count),
        (None, Some(time)) => Span::Time(time),
        (None, None) => Span::Case,
    };
    let cores = std::thread::available_parallelism().ok();
    let plan = Plan {
        span,
        discard: arguments.discard,
        exponents: arguments.exponents.0,
        jobs: arguments.jobs.or(cores).unwrap_or(NonZeroUsize::MIN),
    };
    let bar = progress_bar(arguments.quiet);
    let found = chaos::lyapunov(&case, &plan, &mut |done, all| {
        bar.set_length(all);
        bar.set_position(done);
    });
    bar.finish_and_clear();
    let found = found.map_err(|error| match error {
        Error::Failed { .. } | Error::Collapsed { .. } | Error::Interrupted { .. } => {
            signals.failure(error)
        }
        error => Failure::input(error),
    })?;
    let told = Told { case: &case.name, case_sha256: &sha256(&case.text) };
    match arguments.json {
        true => super::print_json(format_args!("{:#}\n", found.json(&told))),
        false => super::print(found.words(&told)),
    }
}

fn progress_bar(quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(None, target);
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len}, {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}
