//! `freeplay run CASE`

use super::signals::Signals;
use super::{CaseArguments, Failure, TRY_AGAIN, chain};
use crate::case::{Case, Changes, Precision};
use crate::certify::{
    self, Companion, CrossCheck, Disagreement, Errand, Horizon, LEAST_DIGITS, ONE_DRAW, Reach,
    Until, Walk, Witness, ms,
};
use crate::digits::Sizes;
use crate::mechanism::Observation;
use crate::record::{self, Ending, Header, Outcome, ResultFile, Resumed, Segmented, utc};
use crate::run::{
    Contact, Event, Kept, Peak, Progress, Recorder, Revolution, Schedule, Trajectory,
};
use crate::scalar::Decimal;
use crate::simulate::{self, Simulation, Statistics};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant, SystemTime};

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
    /// Go on from the last checkpoint of this case's run, if it has not come to its end; begin it if
    /// there is none. Nothing is done if it is complete.
    #[arg(long)]
    resume: bool,
    /// Stop at the first checkpoint behind this time (55m, 1h30m) with exit code 75; --resume goes on.
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration)]
    stop_after: Option<Duration>,
    /// Make a complete run longer: go on from its last checkpoint until this time (s).
    #[arg(long, value_name = "SECONDS", value_parser = Decimal::new)]
    extend: Option<Decimal>,
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
    let longer = arguments.extend.iter().map(|until| format!("run.duration={until}"));
    let case = arguments.case.read_with(&longer.collect::<Vec<_>>())?;
    let output = arguments.output.clone().unwrap_or_else(|| format!("{}.h5", case.name).into());
    let mut simulation = Simulation::new(&case).map_err(Failure::input)?;
    let header = simulate::header(&case, simulation.mechanism(), utc(SystemTime::now()));
    let signals = Signals::new().map_err(Failure::output)?;
    let Some((writer, resumed)) = open(arguments, &case, &output, header)? else {
        let file = output.to_string_lossy();
        let told = json!({ "file": file, "case_name": case.name, "complete_already": true });
        return match arguments.json {
            true => super::print_json(format_args!("{told:#}\n")),
            false => super::print(format_args!("{file}: complete already\n")),
        };
    };
    let tangent = Carried::of(arguments, &case, &simulation);
    let memory = Memory::new(tangent, &simulation, arguments.check);
    let stop_at = arguments.stop_after.and_then(|after| begun.checked_add(after));
    let end = simulation.schedule().duration();
    let mut witnessed = Witnessed { writer, memory, stop_at, end };
    if let Some(resumed) = resumed {
        if !arguments.quiet {
            super::say(format_args!("goes on from t = {}", ms(resumed.time)));
        }
        resumed.recall(&mut witnessed.memory).map_err(not_gone_on)?;
        simulation = simulation.from_checkpoint(resumed.run);
    }
    let checked = arguments.check.then_some(&case);
    let told = simulate_into(witnessed, simulation, &signals, arguments.quiet, tangent, checked)?;
    let seconds = begun.elapsed().as_secs_f64();
    match arguments.json {
        true => super::print_json(format_args!("{:#}\n", told.json(&case, seconds)?))?,
        false => super::print(told.words(&case, seconds)?)?,
    }
    told.check.map_or(Ok(()), confirmed)
}

/// What is asked of a run cannot be had.
#[derive(Debug, thiserror::Error)]
enum Refused {
    #[error(
        "{option} needs a case with run.checkpoint_interval (s): a run goes on from its checkpoints"
    )]
    NoCheckpoints { option: &'static str },
    #[error("there is no run to make longer: {} is not there", path.display())]
    Nothing { path: PathBuf },
    #[error("--extend {until}: {} is a run of {duration} s, which is not shorter", path.display())]
    NotLonger { path: PathBuf, until: Decimal, duration: Decimal },
}

/// The file to write, and what its run goes on from; `None` where it is complete already.
fn open(
    arguments: &Arguments,
    case: &Case,
    output: &Path,
    header: Header,
) -> Result<Option<(Segmented, Option<Resumed>)>, Failure> {
    let Arguments { force, resume, stop_after, extend, .. } = arguments;
    let asked = [
        ("--resume", *resume),
        ("--stop-after", stop_after.is_some()),
        ("--extend", extend.is_some()),
    ];
    let checkpoints = case.plan.checkpoint_interval.is_some();
    if let Some((option, _)) = asked.into_iter().find(|(_, asked)| *asked && !checkpoints) {
        return Err(Failure::input(Refused::NoCheckpoints { option }));
    }
    let inputs = [Some(arguments.case.path.as_path()), case.started_from.as_deref()];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().collect();
    if !resume && extend.is_none() {
        let writer = Segmented::begin(output, header, *force, &inputs, checkpoints);
        return Ok(Some((writer.map_err(Failure::output)?, None)));
    }
    // what is no result of ours is not in the way either, or is said to exist below
    let there = ResultFile::open(output).ok();
    if there.as_ref().is_some_and(|there| record::is_whole(there, &case.text)) {
        // as long as it is open, no other name of the same file can be locked
        drop(there);
        record::tidy(output);
        return Ok(None);
    }
    let mut force = *force;
    if let Some(until) = extend {
        let Some(there) = &there else {
            return Err(Failure::input(Refused::Nothing { path: output.to_owned() }));
        };
        is_shorter(there, case, until)?;
        if !record::has_segments(output) {
            Segmented::extend(there, header.clone()).map_err(not_gone_on)?;
        }
        force = true;
    }
    // what the run itself has left, interrupted or failed, makes room for it
    let own = |there: &ResultFile| there.text("case_toml") == Some(&case.text);
    force |= there.is_some_and(|there| own(&there) && !there.is_complete());
    Segmented::resume(output, header, force, &inputs).map(Some).map_err(not_gone_on)
}

/// Refuses to make a result file longer that is not of a shorter run of the same case.
fn is_shorter(there: &ResultFile, case: &Case, until: &Decimal) -> Result<(), Failure> {
    let text = there.text("case_toml").unwrap_or_default();
    let read = |set: &[String]| -> Result<Case, Failure> {
        let set = set.iter().map(|change| change.parse().map_err(Failure::input));
        let changes = Changes { set: set.collect::<Result<_, _>>()?, ideal: false };
        Case::from_text(there.path(), text, &changes).map_err(Failure::input)
    };
    let longer = read(&[format!("run.duration={until}")])?;
    if longer.text != case.text {
        let difference = record::first_difference(&longer.text, &case.text);
        return Err(not_gone_on(record::Error::OtherCase {
            path: there.path().to_owned(),
            difference,
        }));
    }
    let duration = read(&[])?.plan.duration;
    if !(duration.to_f64() < until.to_f64()) {
        let (path, until) = (there.path().to_owned(), until.clone());
        return Err(Failure::input(Refused::NotLonger { path, until, duration }));
    }
    Ok(())
}

/// Why a run is not gone on with: what was asked for, or what lies on the disk.
fn not_gone_on(error: record::Error) -> Failure {
    use record::Error as E;
    match error {
        E::OtherCase { .. } | E::OtherProgram { .. } | E::NoCheckpoint { .. } => {
            Failure::input(error)
        }
        E::Interrupted { .. } => Failure::with(4, error),
        error => Failure::output(error),
    }
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

    fn case(self) -> Option<&'a Case> {
        match self {
            Carried::No => None,
            Carried::ToTheHorizon(case) | Carried::ToTheEnd(case) => Some(case),
        }
    }

    /// How far the companion of a run of so many steps goes.
    fn reach(self, run_steps: u64) -> Reach {
        Reach { to_the_end: matches!(self, Carried::ToTheEnd(_)), run_steps }
    }

    /// What a companion is sent for while its run goes on. Not beside one that may stop at a
    /// checkpoint, nor where only the run finds its times: those are followed when they are done.
    fn beside<'b>(
        self,
        schedule: &Schedule,
        most_steps: &'b AtomicU64,
    ) -> Option<(&'a Case, Errand<'b>)> {
        let case = self.case().filter(|case| case.plan.checkpoint_interval.is_none())?;
        let times = certify::times_to_follow(schedule)?;
        Some((case, Errand { times, to_the_end: self.reach(0).to_the_end, most_steps }))
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
    mut witnessed: Witnessed,
    simulation: Simulation<'_>,
    signals: &Signals,
    quiet: bool,
    tangent: Carried<'_>,
    checked: Option<&Case>,
) -> Result<Told, Failure> {
    let schedule = simulation.schedule().clone();
    let revolution = simulation.mechanism().revolution();
    let duration: f64 = schedule.duration();
    let bar = progress_bar(quiet);
    let begun = Instant::now();
    let mut last = Progress::default();
    let most_steps = AtomicU64::new(u64::MAX);
    let abandoned = AtomicBool::new(false);
    let errand = tangent.beside(&schedule, &most_steps);
    let sizes = Sizes::of(simulation.mechanism());
    let (statistics, ran, walk) = std::thread::scope(|scope| {
        let beside = errand.map(|(case, errand)| {
            let mut flow = |_: &Progress| match abandoned.load(Ordering::Relaxed) {
                true => ControlFlow::Break(()),
                false => signals.flow(),
            };
            let (schedule, sizes) = (&schedule, &sizes);
            scope.spawn(move || errand.walk(case, schedule, sizes, &mut flow))
        });
        let mut watch = |progress: &Progress| {
            last = *progress;
            tell(&bar, progress, duration, begun);
            signals.flow()
        };
        let (statistics, ran) = simulation.run(&mut witnessed, &mut watch);
        match ran {
            Ok(()) => most_steps.store(tangent.reach(last.steps).most_steps(), Ordering::Relaxed),
            Err(_) => abandoned.store(true, Ordering::Relaxed),
        }
        let walk = beside.map(|walk| walk.join().unwrap_or_else(|panic| resume_unwind(panic)));
        (statistics, ran, walk)
    });
    let Witnessed { writer, memory: Memory { witness, own }, .. } = witnessed;
    if let Err(simulate::Error::Stopped { time }) = ran {
        bar.finish_and_clear();
        return Err(stopped(&writer, time));
    }
    let followed = ran.and_then(|()| {
        let companion = match witness {
            Some(witness) => follow(tangent, &schedule, &witness, walk, last.steps, signals),
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
    let goes_on = writer.segments().map(|(kept, _)| kept).filter(|kept| *kept > 0);
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
                return Err(Failure { rest: Some(rest), ..Failure::with(code, NotFollowed) });
            }
            return Ok(Told { path, progress: last, companion, check, revolution });
        }
        Err(error) => error,
    };
    let rest = match finished {
        Ok(path) => format!("what was simulated until then is in {}", path.display()),
        Err(error) => format!("what was simulated until then is lost: {}", chain(&error)),
    };
    let rest = match goes_on {
        Some(kept) => format!("{rest}\n--resume goes on from checkpoint {kept}"),
        None => rest,
    };
    let code = match (&error, signals.exit_code()) {
        (simulate::Error::Interrupted { .. }, Some(code)) => code,
        (simulate::Error::Recorder(_), _) => 3,
        _ => 4,
    };
    Err(Failure { rest: Some(rest), ..Failure::with(code, error) })
}

/// A run has stopped at a checkpoint, as it was asked to.
fn stopped(writer: &Segmented, time: f64) -> Failure {
    let (kept, folder) = writer.segments().unwrap_or((0, Path::new(".")));
    let segments = if kept == 1 { "segment is" } else { "segments are" };
    Failure::stop(
        TRY_AGAIN,
        format!(
            "stopped at the checkpoint at t = {}, as --stop-after has it; {kept} {segments} in {}; \
             --resume goes on",
            ms(time),
            folder.display()
        ),
    )
}

/// A signal that came when the run was done.
#[derive(Debug, thiserror::Error)]
#[error("interrupted while the errors of the run were followed")]
struct NotFollowed;

/// Holds what a companion has seen against the run that is done, or sends one after it.
fn follow(
    tangent: Carried<'_>,
    schedule: &Schedule,
    witness: &Witness,
    walk: Option<Walk>,
    run_steps: u64,
    signals: &Signals,
) -> Option<Companion> {
    let (case, reach) = (tangent.case()?, tangent.reach(run_steps));
    Some(match walk {
        Some(walk) => walk.beside(case, witness, reach),
        None => certify::companion(case, schedule, witness, reach, &mut |_| signals.flow()),
    })
}

/// What is remembered of a run until it is done.
struct Memory {
    /// For the companion, where errors are followed.
    witness: Option<Witness>,
    /// For the other engine, where it is to be held against the run.
    own: Option<Trajectory>,
}

impl Memory {
    fn new(tangent: Carried<'_>, simulation: &Simulation<'_>, checked: bool) -> Self {
        let sizes = Sizes::of(simulation.mechanism());
        Memory {
            witness: (!matches!(tangent, Carried::No)).then(|| Witness::new(sizes)),
            own: checked.then(Trajectory::default),
        }
    }

    /// Keeps something for the other engine.
    fn keep(&mut self, keep: impl FnOnce(&mut Trajectory)) {
        if let Some(own) = &mut self.own {
            keep(own);
        }
    }
}

impl Recorder for Memory {
    type Error = record::Error;

    fn sample(&mut self, observation: &Observation) -> Result<(), record::Error> {
        if let Some(witness) = &mut self.witness {
            witness.take(observation);
        }
        self.keep(|own| own.samples.push(observation.clone()));
        Ok(())
    }

    fn event(&mut self, event: Event) -> Result<(), record::Error> {
        self.keep(|own| own.events.push(event));
        Ok(())
    }

    fn contact(&mut self, contact: Contact) -> Result<(), record::Error> {
        self.keep(|own| own.contacts.push(contact));
        if let Some(witness) = &mut self.witness {
            witness.take_contact(contact);
        }
        Ok(())
    }

    fn peak(&mut self, _: Peak) -> Result<(), record::Error> {
        Ok(())
    }
}

/// A writer, and what is remembered of what goes to it.
struct Witnessed {
    writer: Segmented,
    memory: Memory,
    /// From when on the run is to stop at a checkpoint, ...
    stop_at: Option<Instant>,
    /// ... but not at its end (s).
    end: f64,
}

impl Recorder for Witnessed {
    type Error = record::Error;

    fn sample(&mut self, observation: &Observation) -> Result<(), record::Error> {
        self.memory.sample(observation)?;
        self.writer.sample(observation)
    }

    fn event(&mut self, event: Event) -> Result<(), record::Error> {
        self.memory.event(event)?;
        self.writer.event(event)
    }

    fn contact(&mut self, contact: Contact) -> Result<(), record::Error> {
        self.memory.contact(contact)?;
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

    fn checkpoint(&mut self, kept: &Kept) -> Result<ControlFlow<()>, record::Error> {
        let flow = self.writer.checkpoint(kept)?;
        let late = self.stop_at.is_some_and(|stop_at| Instant::now() >= stop_at);
        Ok(if late && kept.time < self.end { ControlFlow::Break(()) } else { flow })
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
