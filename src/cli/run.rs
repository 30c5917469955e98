//! `freeplay run CASE`

use super::signals::Signals;
use super::{CaseArguments, Failure, chain};
use crate::case::Case;
use crate::certify::{self, CrossCheck, Disagreement, Tangent};
use crate::mechanism::Observation;
use crate::record::{self, Ending, Outcome, Writer, utc};
use crate::run::{Contact, Event, Peak, Progress, Recorder, Revolution, Trajectory};
use crate::simulate::{self, Simulation, Statistics};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::path::PathBuf;
use std::time::{Instant, SystemTime};

/// Ticks of the progress bar over a whole run.
const TICKS: u64 = 10_000;

/// Arguments of `run`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,
    /// Trajectory to write (HDF5); default: the case's name with .h5, in this folder.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the output if it exists.
    #[arg(long)]
    force: bool,
    /// Carry a tangent along: how errors grow, and how many digits doubles have left.
    #[arg(long)]
    tangent: bool,
    /// Follow the case with the other engine too: fail with exit code 1 where one has a contact that
    /// the other has not, while the two agree to three digits.
    #[arg(long)]
    check: bool,
    /// No progress on stderr.
    #[arg(short, long)]
    quiet: bool,
}

/// Simulates a case and writes its trajectory.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let begun = Instant::now();
    let case = arguments.case.read()?;
    let output = arguments.output.clone().unwrap_or_else(|| format!("{}.h5", case.name).into());
    let simulation = Simulation::new(&case).map_err(Failure::input)?;
    let header = simulate::header(&case, simulation.mechanism(), utc(SystemTime::now()));
    let writer = Writer::create(&output, header, arguments.force).map_err(Failure::output)?;
    let signals = Signals::new().map_err(Failure::output)?;
    let tangent = arguments.tangent.then_some(&case);
    let checked = arguments.check.then_some(&case);
    let told = simulate_into(writer, simulation, &signals, arguments.quiet, [tangent, checked])?;
    super::print(format_args!(
        "{}: {}, {} samples, {} contacts, {} steps in {:.2} s\n",
        told.path.display(),
        case.name,
        told.progress.samples,
        told.progress.contacts,
        told.progress.steps,
        begun.elapsed().as_secs_f64()
    ))?;
    if let Some(growth) = told.growth {
        super::print(growth)?;
    }
    told.check.map_or(Ok(()), tell_check)
}

/// Tells what the other engine makes of the case, and fails where the two do not agree.
fn tell_check(check: CrossCheck) -> Result<(), Failure> {
    let agreed = check.to_string();
    let error = match (check.disagreement, check.stopped) {
        (Some(disagreement), _) => NotConfirmed::Engines(disagreement),
        (None, Some(reason)) => NotConfirmed::Stopped { until: check.until, reason },
        (None, None) => return super::print(format_args!("  {agreed}\n")),
    };
    Err(Failure::with(1, error))
}

/// What was run is not confirmed by the other engine.
#[derive(Debug, thiserror::Error)]
enum NotConfirmed {
    #[error("the two engines do not have the same contacts: {0}")]
    Engines(Disagreement),
    #[error(
        "the other engine confirms the contacts until {until:e} s only, where it stopped: {reason}"
    )]
    Stopped { until: f64, reason: String },
}

/// What a finished run tells in one line.
struct Told {
    path: PathBuf,
    progress: Progress,
    /// What a tangent says, if one was asked for.
    growth: Option<String>,
    /// What the other engine says, if it was asked.
    check: Option<CrossCheck>,
}

/// Runs a simulation into a writer, and finishes the file however the run ends. `tangent` is the
/// case whose tangent is to be carried along, `checked` that which the other engine is to follow.
fn simulate_into(
    writer: Writer,
    simulation: Simulation<'_>,
    signals: &Signals,
    quiet: bool,
    [tangent, checked]: [Option<&Case>; 2],
) -> Result<Told, Failure> {
    let schedule = simulation.schedule().clone();
    let revolution = simulation.mechanism().revolution();
    let duration: f64 = schedule.duration();
    let own = checked.map(|_| Trajectory::default());
    let mut timed = Timed { writer, times: Vec::new(), kept: tangent.is_some(), own };
    let bar = progress_bar(quiet);
    let begun = Instant::now();
    let mut last = Progress::default();
    let mut watch = |progress: &Progress| {
        last = *progress;
        tell(&bar, progress, duration, begun);
        signals.flow()
    };
    let (statistics, ran) = simulation.run(&mut timed, &mut watch);
    let Timed { writer, times, own, .. } = timed;
    let mut series = Vec::new();
    let (mut growth, mut check) = (None, None);
    let ran = ran.and_then(|()| {
        if let (Some(case), Some(own)) = (checked, &own) {
            let mut flow = |_: &Progress| signals.flow();
            let checked = certify::check_run(case, own, &mut flow);
            check = Some(checked.map_err(simulate::Error::forget_recorder)?);
        }
        let Some(case) = tangent else { return Ok(()) };
        let mut flow = |_: &Progress| signals.flow();
        let tangent = certify::tangent(case, &schedule.at(times), &mut flow)
            .map_err(simulate::Error::forget_recorder)?;
        growth = Some(growth_words(&tangent, revolution));
        series = tangent.series();
        Ok(())
    });
    bar.finish_and_clear();
    let reason = ran.as_ref().err().map(chain);
    let finished = writer.finish(Ending { series, ..ending(statistics, reason) });
    let Err(error) = ran else {
        let path = finished.map_err(Failure::output)?;
        return Ok(Told { path, progress: last, growth, check });
    };
    let rest = match finished {
        Ok(path) => format!("what was simulated until then is in {}", path.display()),
        Err(error) => format!("what was simulated until then is lost: {}", chain(&error)),
    };
    let code = match (&error, signals.exit_code()) {
        (simulate::Error::Interrupted { .. }, Some(code)) => code,
        (simulate::Error::Recorder(_), _) => 3,
        _ => 4,
    };
    Err(Failure { code, error: Box::new(error), rest: Some(rest) })
}

/// A writer, and the times of the samples that went to it where they are kept.
struct Timed {
    writer: Writer,
    times: Vec<f64>,
    kept: bool,
    /// What went to the writer, where the other engine is to be held against it.
    own: Option<Trajectory>,
}

impl Timed {
    /// Keeps something for the other engine.
    fn keep(&mut self, keep: impl FnOnce(&mut Trajectory)) {
        if let Some(own) = &mut self.own {
            keep(own);
        }
    }
}

impl Recorder for Timed {
    type Error = record::Error;

    fn sample(&mut self, observation: &Observation) -> Result<(), record::Error> {
        if self.kept {
            self.times.push(observation.time);
        }
        self.keep(|own| own.samples.push(observation.clone()));
        self.writer.sample(observation)
    }

    fn event(&mut self, event: Event) -> Result<(), record::Error> {
        self.keep(|own| own.events.push(event));
        self.writer.event(event)
    }

    fn contact(&mut self, contact: Contact) -> Result<(), record::Error> {
        self.keep(|own| own.contacts.push(contact));
        self.writer.contact(contact)
    }

    fn peak(&mut self, peak: Peak) -> Result<(), record::Error> {
        self.writer.peak(peak)
    }

    fn keeps_revolutions(&self) -> bool {
        true
    }

    fn revolution(&mut self, revolution: &Revolution) -> Result<(), record::Error> {
        self.writer.revolution(revolution)
    }
}

/// The growth of errors, per revolution or per second.
fn growth_words(tangent: &Tangent, revolution: Option<f64>) -> String {
    let left = tangent.digits_left().last().copied().unwrap_or(f64::NAN);
    let left = if left >= 0.05 { format!("{left:.1} digits") } else { "no digits".to_owned() };
    let period = revolution.unwrap_or(1.0);
    let per = if revolution.is_some() { "revolution" } else { "second" };
    let Some(exponent) = tangent.exponent_per(period) else {
        return "  errors do not grow\n".to_owned();
    };
    let each: Vec<String> =
        tangent.exponents(period).iter().map(|exponent| format!("{exponent:.2}")).collect();
    let each = if each.is_empty() { String::new() } else { format!(" ({})", each.join(", ")) };
    let word = if exponent < 0.0 { "shrink" } else { "grow" };
    format!(
        "  errors {word} by a factor e^{exponent:.2} per {per}{each}; errors of double precision \
         leave {left} of the state at the end\n"
    )
}

fn ending(statistics: Statistics, failure: Option<String>) -> Ending {
    let outcome = match failure {
        None => Outcome::Complete,
        Some(reason) => Outcome::Failed { reason },
    };
    let Statistics { engine: counts, rulings } = statistics;
    Ending { outcome, counts, rulings, finished_utc: utc(SystemTime::now()), series: Vec::new() }
}

fn progress_bar(quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(TICKS), target);
    let style = ProgressStyle::with_template("{bar:40} {msg}, {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

fn tell(bar: &ProgressBar, progress: &Progress, duration: f64, begun: Instant) {
    if bar.is_hidden() {
        return;
    }
    let rate = progress.events as f64 / begun.elapsed().as_secs_f64().max(1e-3);
    bar.set_position((progress.time / duration * TICKS as f64) as u64);
    bar.set_message(format!(
        "{:.3} of {:.3} ms, {} events ({rate:.0}/s), step {:.1e} s",
        progress.time * 1e3,
        duration * 1e3,
        progress.events,
        progress.step
    ));
}
