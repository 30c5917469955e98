//! `freeplay run CASE`

use super::signals::Signals;
use super::{CaseArguments, Failure, chain};
use crate::case::{Case, Precision};
use crate::certify::{
    self, Companion, CrossCheck, Disagreement, Horizon, LEAST_DIGITS, ONE_DRAW, Reach, Until,
    Witness, ms,
};
use crate::digits::Sizes;
use crate::mechanism::Observation;
use crate::record::{self, Ending, Outcome, ResultFile, Writer, utc};
use crate::run::{Contact, Event, Peak, Progress, Recorder, Revolution, Schedule, Trajectory};
use crate::simulate::{self, Simulation, Statistics};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::fmt::Write as _;
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
    /// Follow the growth of errors to the end of the run, not only to where its numbers end to
    /// mean something; of mechanisms without contacts and runs in 71 digits too.
    #[arg(long, conflicts_with = "no_tangent")]
    tangent: bool,
    /// Do not follow the growth of errors: faster, but nobody knows how far the run is true.
    #[arg(long)]
    no_tangent: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
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
    let signals = Signals::new().map_err(Failure::output)?;
    let inputs = [arguments.case.path.as_path()];
    let writer = Writer::create_from(&output, header, arguments.force, &inputs);
    let writer = writer.map_err(Failure::output)?;
    let tangent = Carried::of(arguments, &case, &simulation);
    let checked = arguments.check.then_some(&case);
    let told = simulate_into(writer, simulation, &signals, arguments.quiet, tangent, checked)?;
    let seconds = begun.elapsed().as_secs_f64();
    match arguments.json {
        true => super::print_json(format_args!("{:#}\n", told.json(&case, seconds)?))?,
        false => super::print(told.words(&case, seconds)?)?,
    }
    told.check.map_or(Ok(()), confirmed)
}

/// Fails where the other engine does not agree.
fn confirmed(check: CrossCheck) -> Result<(), Failure> {
    let error = match (check.disagreement, check.stopped) {
        (Some(disagreement), _) => NotConfirmed::Engines(disagreement),
        (None, Some(reason)) => NotConfirmed::Stopped { until: check.until, reason },
        (None, None) => return Ok(()),
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

/// Whether errors are followed along a run, and how far.
#[derive(Clone, Copy)]
enum Carried<'a> {
    /// Not at all.
    No,
    /// Until its numbers mean nothing any more.
    ToTheHorizon(&'a Case),
    /// However large they are.
    ToTheEnd(&'a Case),
}

impl<'a> Carried<'a> {
    /// By default where there are contacts; not of a run in 71 digits, whose companion takes
    /// several times as long as the run.
    fn of(arguments: &Arguments, case: &'a Case, simulation: &Simulation<'_>) -> Self {
        let touches = !simulation.mechanism().modes().is_empty();
        let doubles = case.plan.solver.precision == Precision::Double;
        match (arguments.tangent, arguments.no_tangent) {
            (true, _) => Carried::ToTheEnd(case),
            (false, false) if touches && doubles => Carried::ToTheHorizon(case),
            _ => Carried::No,
        }
    }
}

/// What a finished run tells.
struct Told {
    path: PathBuf,
    progress: Progress,
    /// What is known of its errors, if they were followed.
    companion: Option<Companion>,
    /// What the other engine says, if it was asked.
    check: Option<CrossCheck>,
    /// Time of a revolution of the first drive (s).
    revolution: Option<f64>,
}

impl Told {
    fn words(&self, case: &Case, seconds: f64) -> Result<String, Failure> {
        let mut words = format!(
            "{}: {}, {} samples, {} contacts, {} steps in {seconds:.2} s\n",
            self.path.display(),
            case.name,
            self.progress.samples,
            self.progress.contacts,
            self.progress.steps,
        );
        if let Some(companion) = &self.companion {
            words += &horizon_words(companion, self.revolution);
            words += &format!("  to quote     \"{}\"\n", self.sentence(companion)?);
        }
        if let Some(check) = self.check.as_ref().filter(|check| check.confirms()) {
            words += &format!("  {check}\n");
        }
        Ok(words)
    }

    fn sentence(&self, companion: &Companion) -> Result<String, Failure> {
        let file = ResultFile::open(&self.path).map_err(Failure::output)?;
        Ok(companion.horizon().sentence(&file))
    }

    fn json(&self, case: &Case, seconds: f64) -> Result<Value, Failure> {
        let horizon = self.companion.as_ref().map(|companion| {
            let Horizon { state, forces, doubles, at_end, end, stopped, .. } = companion.horizon();
            let period = self.revolution.unwrap_or(1.0);
            Ok::<_, Failure>(json!({
                "unit": "s",
                "least_digits": LEAST_DIGITS,
                "state": state,
                "forces": forces,
                "doubles": doubles,
                "end": end,
                "digits_at_end": at_end.map(|digits| {
                    json!({ "state": digits.state, "forces": digits.forces })
                }),
                "stopped": stopped,
                "parts_early": companion.parts_early,
                "growth_exponent": companion.tangent.exponent_per(period),
                "growth_exponents": companion.tangent.exponents(period),
                "growth_period": period,
                "sentence": self.sentence(companion)?,
            }))
        });
        Ok(json!({
            "file": self.path.to_string_lossy(),
            "case_name": case.name,
            "samples": self.progress.samples,
            "contacts": self.progress.contacts,
            "events": self.progress.events,
            "steps": self.progress.steps,
            "seconds": seconds,
            "horizon": horizon.transpose()?,
            "check": self.check.as_ref().map(check_json),
        }))
    }
}

/// What the other engine says of a run.
fn check_json(check: &CrossCheck) -> Value {
    json!({
        "unit": "s",
        "confirmed": check.confirms(),
        "until": check.until,
        "digits": check.digits,
        "events": check.events,
        "farthest": check.farthest,
        "disagreement": check.disagreement.as_ref().map(Disagreement::to_string),
        "stopped": check.stopped,
    })
}

/// Runs a simulation into a writer, and finishes the file however the run ends; `checked` is the
/// case that the other engine is to follow.
fn simulate_into(
    writer: Writer,
    simulation: Simulation<'_>,
    signals: &Signals,
    quiet: bool,
    tangent: Carried<'_>,
    checked: Option<&Case>,
) -> Result<Told, Failure> {
    let schedule = simulation.schedule().clone();
    let revolution = simulation.mechanism().revolution();
    let sizes = Sizes::of(simulation.mechanism());
    let duration: f64 = schedule.duration();
    let witness = (!matches!(tangent, Carried::No)).then(|| Witness::new(sizes));
    let own = checked.map(|_| Trajectory::default());
    let mut witnessed = Witnessed { writer, witness, own };
    let bar = progress_bar(quiet);
    let begun = Instant::now();
    let mut last = Progress::default();
    let mut watch = |progress: &Progress| {
        last = *progress;
        tell(&bar, progress, duration, begun);
        signals.flow()
    };
    let (statistics, ran) = simulation.run(&mut witnessed, &mut watch);
    let Witnessed { writer, witness, own } = witnessed;
    let followed = ran.and_then(|()| {
        let companion = match witness {
            Some(witness) => follow(tangent, &schedule, &witness, last.steps, signals),
            None => None,
        };
        let check = match checked.zip(own).filter(|_| signals.exit_code().is_none()) {
            Some((case, own)) => {
                let mut flow = |_: &Progress| signals.flow();
                match certify::check_run(case, &own, &mut flow) {
                    // the run is done all the same
                    Err(simulate::Error::Interrupted { .. }) => None,
                    check => Some(check.map_err(simulate::Error::forget_recorder)?),
                }
            }
            None => None,
        };
        Ok((companion, check))
    });
    bar.finish_and_clear();
    let reason = followed.as_ref().err().map(chain);
    let companion = followed.as_ref().ok().and_then(|(companion, _)| companion.as_ref());
    let finished = writer.finish(Ending {
        series: companion.map(Companion::series).unwrap_or_default(),
        attributes: companion.map(Companion::attributes).unwrap_or_default(),
        ..ending(statistics, reason)
    });
    let error = match followed {
        Ok((companion, check)) => {
            let path = finished.map_err(Failure::output)?;
            if let Some(code) = signals.exit_code() {
                let rest = format!("the run itself is complete, in {}", path.display());
                return Err(Failure { code, error: Box::new(NotFollowed), rest: Some(rest) });
            }
            return Ok(Told { path, progress: last, companion, check, revolution });
        }
        Err(error) => error,
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

/// A signal that came when the run was done.
#[derive(Debug, thiserror::Error)]
#[error("interrupted while the errors of the run were followed")]
struct NotFollowed;

/// Follows the errors of a run that is done.
fn follow(
    tangent: Carried<'_>,
    schedule: &Schedule,
    witness: &Witness,
    run_steps: u64,
    signals: &Signals,
) -> Option<Companion> {
    let (case, to_the_end) = match tangent {
        Carried::No => return None,
        Carried::ToTheHorizon(case) => (case, false),
        Carried::ToTheEnd(case) => (case, true),
    };
    let mut flow = |_: &Progress| signals.flow();
    let reach = Reach { to_the_end, run_steps };
    Some(certify::companion(case, schedule, witness, reach, &mut flow))
}

/// A writer, and who takes note of what goes to it where errors are followed.
struct Witnessed {
    writer: Writer,
    witness: Option<Witness>,
    /// What went to the writer, where the other engine is to be held against it.
    own: Option<Trajectory>,
}

impl Witnessed {
    /// Keeps something for the other engine.
    fn keep(&mut self, keep: impl FnOnce(&mut Trajectory)) {
        if let Some(own) = &mut self.own {
            keep(own);
        }
    }
}

impl Recorder for Witnessed {
    type Error = record::Error;

    fn sample(&mut self, observation: &Observation) -> Result<(), record::Error> {
        if let Some(witness) = &mut self.witness {
            witness.take(observation);
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
        if let Some(witness) = &mut self.witness {
            witness.take_contact(contact);
        }
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

/// Digits whose end is told.
const TOLD: [f64; 3] = [9.0, 6.0, 3.0];

/// How far a run is true, and how its errors grow.
fn horizon_words(companion: &Companion, revolution: Option<f64>) -> String {
    let mut words = String::new();
    let kinds: [(&str, &dyn Fn(f64) -> Until); 2] = [
        ("angles, rates, velocities, clearance vectors", &|digits| companion.state_until(digits)),
        ("forces, torques and their peaks", &|digits| companion.forces_until(digits)),
    ];
    // writing to a string cannot fail
    for (what, until) in kinds {
        let held: Vec<String> = (TOLD.iter())
            .filter_map(|digits| match until(*digits) {
                Until::Time(time) if time > 0.0 => {
                    Some(format!("{digits} digits until {}", ms(time)))
                }
                _ => None,
            })
            .collect();
        let held = if held.is_empty() { held.concat() } else { format!(" ({})", held.join(", ")) };
        let _ = match until(LEAST_DIGITS) {
            Until::End => writeln!(words, "  true         to the end: {what}{held}"),
            Until::Time(time) => writeln!(words, "  true         until {}: {what}{held}", ms(time)),
            Until::Never => writeln!(words, "  true         not to one digit: {what}"),
        };
    }
    let horizon = companion.horizon();
    let _ = match (&companion.stopped, horizon.is_whole()) {
        (_, true) => Ok(()),
        (None, false) => writeln!(words, "  beyond       a number is {ONE_DRAW}"),
        (Some(why), false) => {
            writeln!(
                words,
                "  beyond       not known: the run that follows the errors stopped: {why}"
            )
        }
    };
    if let Some(time) = companion.parts_early {
        let _ = writeln!(
            words,
            "  doubt        at {} the run parts from its companion although errors have not grown \
             that much: one of them may have missed an event; compare with another tolerance or \
             engine",
            ms(time)
        );
    }
    let _ = match companion.doubles_until() {
        Until::Time(time) if companion.stopped.is_none() => writeln!(
            words,
            "  doubles      no double-precision run of this case means anything beyond {}",
            ms(time)
        ),
        _ => Ok(()),
    };
    words + &growth_words(companion, revolution)
}

/// The growth of errors, per revolution or per second.
fn growth_words(companion: &Companion, revolution: Option<f64>) -> String {
    let tangent = &companion.tangent;
    let period = revolution.unwrap_or(1.0);
    let per = if revolution.is_some() { "revolution" } else { "second" };
    let Some(exponent) = tangent.exponent_per(period) else {
        return "  errors       do not grow\n".to_owned();
    };
    let each: Vec<String> =
        tangent.exponents(period).iter().map(|exponent| format!("{exponent:.2}")).collect();
    let each = if each.is_empty() { String::new() } else { format!(" ({})", each.join(", ")) };
    let whole = tangent.times.last().is_some_and(|time| *time >= companion.end);
    let until = match tangent.times.last() {
        Some(time) if !whole => format!(", followed until {}", ms(*time)),
        _ => String::new(),
    };
    let word = if exponent < 0.0 { "shrink" } else { "grow" };
    let exponent = exponent.abs();
    format!("  errors       {word} by a factor e^{exponent:.2} per {per}{each}{until}\n")
}

fn ending(statistics: Statistics, failure: Option<String>) -> Ending {
    let outcome = match failure {
        None => Outcome::Complete,
        Some(reason) => Outcome::Failed { reason },
    };
    let Statistics { engine: counts, rulings } = statistics;
    Ending {
        outcome,
        counts,
        rulings,
        finished_utc: utc(SystemTime::now()),
        series: Vec::new(),
        attributes: Vec::new(),
    }
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
