//! One run of a study, in memory: from its changes to its rows.

use super::attractor::{self, Point};
use super::pack::{Identity, Record, Rows};
use super::scalar::{Scalar, skeleton};
use super::section::Section;
use super::{Error, Keep, Study};
use crate::case::{Case, Changes};
use crate::certify::{self, Reach, Witness};
use crate::chaos::{self, Exponent, Lyapunov};
use crate::digits::Sizes;
use crate::halt;
use crate::mechanism::{EnergyObservation, Mechanism, Observation};
use crate::model::Names;
use crate::post::{InMemory, RunExtremes, Summary, Wanted};
use crate::record::{Ending, Outcome, Writer, sha256, utc};
use crate::run::{Contact, Event, Peak, Progress, Recorder, Revolution, Schedule};
use crate::simulate::{self, Simulation};
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};
use std::convert::Infallible;
use std::error::Error as StdError;
use std::fmt::Write;
use std::fs;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

/// Ideal mechanisms that are remembered.
const MOST_IDEALS: usize = 64;
/// Cases that are tried in search of one that can be read.
const TRIED: u64 = 64;

/// What is needed to make any run of a study.
pub(super) struct Runner<'a> {
    study: &'a Study,
    /// Numbers of each run, and of each revolution.
    pub of_runs: Vec<Scalar>,
    pub of_revolutions: Vec<Scalar>,
    pub section: Option<Section>,
    /// Quantities whose extremes are looked at.
    quantities: Vec<String>,
    /// Those that are held against the ideal mechanism.
    referred: Vec<String>,
    /// Whether samples are taken as the case has it, too.
    sampled: bool,
    names: Names,
    /// Where result files go, if they are kept.
    files: Option<PathBuf>,
    ideals: Mutex<Vec<(String, RunExtremes)>>,
    /// Revolutions that all runs have made.
    pub revolutions: AtomicU64,
}

impl<'a> Runner<'a> {
    /// Makes a study ready.
    ///
    /// # Errors
    /// No case of the study can be read, or it has nothing of what is to be kept.
    pub fn new(study: &'a Study, folder: &Path) -> Result<Self, Error> {
        let case = first_case(study)?;
        let simulation = Simulation::new(&case).map_err(Error::Case)?;
        let mechanism = simulation.mechanism();
        let mut skeleton = skeleton(&case, mechanism).map_err(|error| Error::Wrong {
            path: study.path.clone(),
            line: None,
            key: "case".to_owned(),
            message: chain(&error),
        })?;
        let wrong = |key: &str, message: String| Error::Wrong {
            path: study.path.clone(),
            line: None,
            key: key.to_owned(),
            message,
        };
        let keep = &study.keep;
        check_span(study, mechanism, simulation.schedule())
            .map_err(|(key, message)| wrong(key, message))?;
        let names = mechanism.model().names().clone();
        let states = 2 * mechanism.freedoms();
        let exponents = exponents_json(
            &vec![NOTHING; keep.exponents],
            (keep.exponents == states).then_some((NOTHING, NOTHING)),
        );
        let joints = names.clearances.iter().map(|joint| (joint.as_str(), false));
        let attractor = attractor_json((0, 0.0), joints);
        let mut asked = Vec::new();
        for (word, numbers, wanted) in [
            ("lyapunov", exponents, keep.exponents > 0),
            ("attractor", attractor, keep.attractor.is_some()),
        ] {
            if wanted {
                asked.extend(paths(word, &numbers));
                skeleton[word] = numbers;
            }
        }
        let mut of_runs = Vec::new();
        for path in keep.runs.clone().unwrap_or_else(|| choice(&names, &OF_RUNS)) {
            let scalar = Scalar::of(&path, &skeleton);
            of_runs.push(scalar.map_err(|message| wrong("keep.runs", message))?);
        }
        for path in asked {
            let scalar = Scalar::of(&path, &skeleton);
            let scalar = scalar.map_err(|message| wrong("keep", message))?;
            if !of_runs.contains(&scalar) {
                of_runs.push(scalar);
            }
        }
        let mut of_revolutions = Vec::new();
        let turns = mechanism.revolution().is_some();
        let chosen = || if turns { choice(&names, &OF_REVOLUTIONS) } else { Vec::new() };
        for path in keep.revolutions.clone().unwrap_or_else(chosen) {
            let scalar = Scalar::of_each_revolution(&path, &skeleton);
            of_revolutions.push(scalar.map_err(|message| wrong("keep.revolutions", message))?);
        }
        if study.ensemble.is_some() && of_revolutions.is_empty() {
            let message = "is of numbers of revolutions: name some in keep.revolutions";
            return Err(wrong("ensemble", message.to_owned()));
        }
        if keep.horizon {
            for path in ["horizon.state", "horizon.forces", "horizon.doubles"] {
                let scalar = Scalar::of(path, &skeleton);
                let scalar = scalar.map_err(|message| wrong("keep.horizon", message))?;
                if !of_runs.contains(&scalar) {
                    of_runs.push(scalar);
                }
            }
        }
        let all = || of_runs.iter().chain(&of_revolutions);
        if let Some(scalar) = all().find(|scalar| scalar.needs_horizon() && !keep.horizon) {
            let message = format!("{:?} is known with keep.horizon = true only", scalar.name);
            return Err(wrong("keep", message));
        }
        let sampled = keep.horizon || all().any(Scalar::needs_samples);
        let adaptive = simulation.schedule().is_adaptive();
        if let Some(scalar) = all().find(|scalar| scalar.needs_samples() && adaptive) {
            let message = format!(
                "{:?} depends on the samples: set run.sampling=uniform for the study",
                scalar.name
            );
            return Err(wrong("keep", message));
        }
        let section = keep.section.as_ref().map(|plan| Section::of(plan, mechanism.model()));
        let section = section.transpose().map_err(|(key, message)| wrong(key, message))?;
        let quantities = |of: &dyn Fn(&&Scalar) -> bool| {
            let mut names: Vec<String> =
                all().filter(of).filter_map(Scalar::quantity).cloned().collect();
            names.sort();
            names.dedup();
            names
        };
        Ok(Runner {
            study,
            quantities: quantities(&|_| true),
            referred: quantities(&|scalar| scalar.needs_reference()),
            of_runs,
            of_revolutions,
            section,
            sampled,
            names,
            files: keep.files.then(|| folder.join("files")),
            ideals: Mutex::default(),
            revolutions: AtomicU64::new(0),
        })
    }

    /// All that decides what a record holds, but for its case; in one line.
    pub fn kind(&self) -> String {
        let mut kind = crate::record::program();
        let scalars = [&self.of_runs, &self.of_revolutions];
        for scalars in scalars {
            let names: Vec<&str> = scalars.iter().map(|scalar| scalar.name.as_str()).collect();
            let _ = write!(kind, "\n{}", names.join("\n "));
        }
        let keep = &self.study.keep;
        let plan = keep.section.as_ref().map(|plan| (&plan.drive, plan.angle));
        let columns = self.section.iter().flat_map(|section| &section.columns);
        let columns: Vec<&str> = columns.map(|column| column.name.as_str()).collect();
        let _ = write!(kind, "\n{plan:?} {columns:?} {} {}", keep.discard, keep.files);
        let _ = write!(kind, " {} {:?}", keep.exponents, keep.attractor);
        sha256(&kind)
    }

    /// Which case a run is of, and the text that is run; the latter is an error where the case cannot
    /// be changed so.
    pub fn identify(&self, run: u64) -> (Identity, Result<(Changes, String), String>) {
        let template = &self.study.template;
        let text = match self.study.changes(run) {
            Ok(changes) => match template.resolve(&changes) {
                Ok(text) => Ok((changes, text)),
                Err(error) => Err(chain(&error)),
            },
            Err(error) => Err(chain(&error)),
        };
        let identity = match &text {
            Ok((_, text)) => Sha256::digest(text),
            Err(why) => Sha256::digest(format!("{}\n{why}", template.text())),
        };
        (identity.into(), text)
    }

    /// Makes a run. `None` where it was interrupted.
    ///
    /// # Errors
    /// A result file that was asked for cannot be written.
    pub fn run(
        &self,
        identity: Identity,
        text: Result<(Changes, String), String>,
    ) -> Result<Option<Record>, Error> {
        let outcome = match text {
            Ok((changes, text)) => match self.rows(&identity, &changes, text) {
                Err(Stopped::Interrupted) => return Ok(None),
                Err(Stopped::Output(error)) => return Err(error),
                Err(Stopped::Failed(why)) => Err(why),
                Ok(rows) => Ok(rows),
            },
            Err(why) => Err(why),
        };
        // a request to stop may be behind whatever went wrong, or is missing
        if halt::is_asked() {
            return Ok(None);
        }
        Ok(Some(Record { identity, outcome }))
    }

    fn rows(&self, identity: &Identity, changes: &Changes, text: String) -> Result<Rows, Stopped> {
        let case = self.study.template.case(text, changes).map_err(failed)?;
        let simulation = Simulation::new(&case).map_err(failed)?;
        let mechanism = simulation.mechanism().clone();
        if *mechanism.model().names() != self.names {
            let why = "its bodies, joints, clearances or drives are not those of the study's first";
            return Err(Stopped::Failed(why.to_owned()));
        }
        let schedule = simulation.schedule().clone();
        check_span(self.study, &mechanism, &schedule)
            .map_err(|(key, message)| Stopped::Failed(format!("{key}: {message}")))?;
        let sizes = Sizes::of(&mechanism);
        let times = self.times(&mechanism, &schedule);
        let simulation = simulation.sampled_at(times.iter().map(|(time, _)| *time).collect());
        let mut kept = Kept {
            runner: self,
            times: times.iter(),
            first_time: self.study.keep.discard as f64 * mechanism.revolution().unwrap_or(0.0),
            period: mechanism.revolution(),
            contacts: Vec::new(),
            revolutions: Vec::new(),
            energies: Vec::new(),
            sections: Vec::new(),
            points: Vec::new(),
            witness: self.study.keep.horizon.then(|| Witness::new(sizes.clone())),
            sizes,
        };
        let begin = kept.first_time;
        let (mut steps, mut turned) = (0, 0);
        let period = mechanism.revolution().unwrap_or(f64::INFINITY);
        let mut watch = |progress: &Progress| {
            let turns = (progress.time / period + ROUNDING) as u64;
            self.revolutions.fetch_add(turns.saturating_sub(turned), Ordering::Relaxed);
            (steps, turned) = (progress.steps, turns);
            flow()
        };
        let (_, ran) = simulation.run(&mut kept, &mut watch);
        match ran {
            Ok(()) => {}
            Err(simulate::Error::Interrupted { .. }) => return Err(Stopped::Interrupted),
            Err(_) if halt::is_asked() => return Err(Stopped::Interrupted),
            Err(error) => return Err(failed(error)),
        }
        let turns = (schedule.duration::<f64>() / period + ROUNDING) as u64;
        self.revolutions.fetch_add(turns.saturating_sub(turned), Ordering::Relaxed);
        let Kept { contacts, revolutions, energies, sections, points, witness, .. } = kept;
        let horizon = witness.map(|witness| {
            let reach = Reach { to_the_end: false, run_steps: steps };
            let mut watch = |_: &Progress| flow();
            certify::companion(&case, &schedule, &witness, reach, &mut watch).horizon()
        });
        if halt::is_asked() {
            return Err(Stopped::Interrupted);
        }
        let run = InMemory {
            case: &case,
            mechanism: &mechanism,
            begin,
            end: schedule.duration(),
            contacts: &contacts,
            revolutions: &revolutions,
            energies: &energies,
            horizon: horizon.as_ref(),
        };
        let reference = self.reference(&case, run.end)?;
        let wanted = Wanted::Named(&self.quantities);
        let summary = Summary::of_run(&run, reference, wanted).map_err(failed)?;
        let parts = summary.turning.as_ref().map(|turning| turning.revolutions);
        let touching = summary.contacts.iter();
        let touching = touching.map(|joint| (joint.joint.as_str(), joint.share == Some(1.0)));
        let attractor = self
            .study
            .keep
            .attractor
            .as_ref()
            .map(|plan| attractor_json(attractor::period(&points, plan), touching));
        let mut summary = summary.to_json();
        if let Some(attractor) = attractor {
            summary["attractor"] = attractor;
        }
        if let Some(found) = self.exponents(&case)? {
            let more = found.sum.zip(
                found.dimension.map(|d| Exponent { per_lap: d.value, half_width: d.half_width }),
            );
            summary["lyapunov"] = exponents_json(&found.exponents, more);
        }
        let mut of_revolutions = Vec::new();
        let count = parts.map_or(0, |parts| parts.count());
        if !self.of_revolutions.is_empty() {
            for k in self.study.keep.discard as usize..count {
                let [begin, end] = parts.map_or([f64::NAN; 2], |parts| parts.bounds(k));
                of_revolutions.extend([k as f64, begin, end]);
                let numbers = self.of_revolutions.iter();
                of_revolutions
                    .extend(numbers.map(|scalar| scalar.value_in_revolution(&summary, k)));
            }
        }
        if let Some(folder) = &self.files {
            self.write_file(&case, folder, identity)?;
        }
        Ok(Rows {
            run: self.of_runs.iter().map(|scalar| scalar.value(&summary)).collect(),
            revolutions: of_revolutions,
            sections,
        })
    }

    /// When samples are taken, and what for.
    fn times(&self, mechanism: &Mechanism<f64>, schedule: &Schedule) -> Vec<(f64, Of)> {
        let end: f64 = schedule.duration();
        let grid: Vec<f64> = match self.sampled {
            true => (0..schedule.len()).map(|k| schedule.time(k)).collect(),
            // the balance of energies is that from the start to the end
            false => vec![0.0, end],
        };
        let section = self.section.as_ref().map(|section| section.times(mechanism, end));
        let keep = &self.study.keep;
        let period = mechanism.revolution();
        let begin = period.filter(|_| keep.discard > 0).map(|period| keep.discard as f64 * period);
        let turns = period.filter(|_| keep.attractor.is_some());
        let turns = turns.into_iter().flat_map(|period| {
            let last = (end / period + ROUNDING) as u64;
            (keep.discard + 1..=last).map(move |k| (k as f64 * period).min(end))
        });
        let nothing = Of { grid: false, section: false, begin: false, turn: false };
        let of = |times: Vec<f64>, of: Of| times.into_iter().map(move |time| (time, of));
        let mut times: Vec<(f64, Of)> = of(grid, Of { grid: true, ..nothing })
            .chain(of(section.unwrap_or_default(), Of { section: true, ..nothing }))
            .chain(of(begin.into_iter().collect(), Of { begin: true, ..nothing }))
            .chain(of(turns.collect(), Of { turn: true, ..nothing }))
            .collect();
        times.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        times.dedup_by(|(time, of), (kept, all)| {
            let same = time == kept;
            if same {
                all.grid |= of.grid;
                all.section |= of.section;
                all.begin |= of.begin;
                all.turn |= of.turn;
            }
            same
        });
        times
    }

    /// Lyapunov exponents of a case, if they are kept. `None`, too, where they cannot be told apart.
    fn exponents(&self, case: &Case) -> Result<Option<Lyapunov>, Stopped> {
        let keep = &self.study.keep;
        if keep.exponents == 0 {
            return Ok(None);
        }
        let plan = chaos::Plan {
            span: chaos::Span::Case,
            discard: keep.discard,
            exponents: Some(keep.exponents),
            // runs go on at a time already
            jobs: NonZeroUsize::MIN,
        };
        match chaos::lyapunov(case, &plan, &mut |_, _| ()) {
            Ok(found) => Ok(Some(found)),
            Err(chaos::Error::Collapsed { .. }) => Ok(None),
            Err(_) if halt::is_asked() => Err(Stopped::Interrupted),
            Err(error) => Err(failed(error)),
        }
    }

    /// Extremes of the ideal mechanism of a case, where it is held against that.
    fn reference(&self, case: &Case, end: f64) -> Result<Option<RunExtremes>, Stopped> {
        if self.referred.is_empty() || self.names.clearances.is_empty() {
            return Ok(None);
        }
        // without an ideal run there are no ratios, as in a summary
        let Ok(ideal) = simulate::ideal_case(case) else { return Ok(None) };
        let key = format!("{end:?}\n{}", ideal.text);
        let ideals = || self.ideals.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some((_, known)) = ideals().iter().find(|(known, _)| *known == key) {
            return Ok(Some(known.clone()));
        }
        let extremes = RunExtremes::of_ideal(&ideal, end, Wanted::Named(&self.referred));
        if halt::is_asked() {
            return Err(Stopped::Interrupted);
        }
        let Ok(extremes) = extremes else { return Ok(None) };
        let mut ideals = ideals();
        if ideals.len() == MOST_IDEALS {
            ideals.remove(0);
        }
        ideals.push((key, extremes.clone()));
        Ok(Some(extremes))
    }

    /// Makes the run once more, as `freeplay run --no-tangent` does, into a result file.
    fn write_file(&self, case: &Case, folder: &Path, identity: &Identity) -> Result<(), Stopped> {
        let folder_failed = |source| Error::Folder { path: folder.to_owned(), source };
        fs::create_dir_all(folder).map_err(|source| Stopped::Output(folder_failed(source)))?;
        let path = folder.join(format!("{}.h5", &hexadecimal(identity)[..16]));
        let simulation = Simulation::new(case).map_err(failed)?;
        let header = simulate::header(case, simulation.mechanism(), utc(SystemTime::now()));
        let output = |error| Stopped::Output(Error::Output(error));
        let mut writer = Writer::create(&path, header, true).map_err(output)?;
        let (statistics, ran) = simulation.run(&mut writer, &mut |_| flow());
        match ran {
            Ok(()) => {}
            Err(simulate::Error::Recorder(error)) => return Err(output(error)),
            Err(_) => return Err(Stopped::Interrupted),
        }
        let simulate::Statistics { engine: counts, rulings } = statistics;
        let written = writer.finish(Ending {
            outcome: Outcome::Complete,
            counts,
            rulings,
            finished_utc: utc(SystemTime::now()),
            series: Vec::new(),
            attributes: Vec::new(),
        });
        written.map(drop).map_err(output)
    }
}

/// An identity in hexadecimal digits.
pub(super) fn hexadecimal(identity: &Identity) -> String {
    identity.iter().fold(String::with_capacity(64), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

fn flow() -> ControlFlow<()> {
    if halt::is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// Why a run has no rows.
enum Stopped {
    /// The process was asked to stop.
    Interrupted,
    /// The run failed.
    Failed(String),
    /// Something could not be written.
    Output(Error),
}

fn failed(error: impl StdError + 'static) -> Stopped {
    Stopped::Failed(chain(&error))
}

/// An error and its causes in one line.
fn chain(error: &dyn StdError) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        line = format!("{line}: {error}");
        cause = error.source();
    }
    line.lines().map(str::trim).collect::<Vec<_>>().join("; ")
}

/// Whether what is kept can be told of runs that last so long; else the key that is wrong, and why.
fn check_span(
    study: &Study,
    mechanism: &Mechanism<f64>,
    schedule: &Schedule,
) -> Result<(), (&'static str, String)> {
    let Keep { discard, exponents, attractor, .. } = &study.keep;
    let states = 2 * mechanism.freedoms();
    if *exponents > states {
        let message = format!("there are {states}, twice the freedoms; {exponents} cannot be told");
        return Err(("keep.exponents", message));
    }
    let Some(period) = mechanism.revolution() else {
        let needs =
            |key| Err((key, "no drive comes round that revolutions could be told by".to_owned()));
        return match (*discard, *exponents, attractor) {
            (0, 0, None) => Ok(()),
            (0, 0, Some(_)) => needs("attractor"),
            (0, _, _) => needs("keep.exponents"),
            _ => needs("span.discard"),
        };
    };
    let whole = (schedule.duration::<f64>() / period + ROUNDING) as u64;
    if *discard > 0 && *discard as f64 * period >= schedule.duration::<f64>() * (1.0 - ROUNDING) {
        return Err((
            "span.discard",
            format!("a run lasts {whole} revolutions; nothing would be left"),
        ));
    }
    if *exponents > 0 && whole <= *discard {
        return Err(("keep.exponents", "no whole revolution is left".to_owned()));
    }
    let needs = attractor.map_or(0, |plan| plan.needs());
    if attractor.is_some() && whole < discard + needs {
        let left = whole.saturating_sub(*discard);
        let message = format!(
            "it takes {needs} revolutions behind span.discard to tell a period; there are {left}"
        );
        return Err(("attractor.longest", message));
    }
    Ok(())
}

/// An exponent that stands for any.
const NOTHING: Exponent = Exponent { per_lap: 0.0, half_width: Some(0.0) };

/// Exponents as a study's summary has them, with the sum of all and the dimension where they are known.
fn exponents_json(exponents: &[Exponent], all: Option<(Exponent, Exponent)>) -> Value {
    let told =
        |number: &Exponent| json!({ "value": number.per_lap, "half_width": number.half_width });
    let numbered = (exponents.iter().zip(1..)).map(|(exponent, k)| (k.to_string(), told(exponent)));
    let mut told_all = Map::from_iter(numbered);
    if let Some((sum, dimension)) = all {
        told_all.insert("sum".to_owned(), told(&sum));
        told_all.insert("kaplan_yorke".to_owned(), told(&dimension));
    }
    Value::Object(told_all)
}

/// Where a motion ends, as a study's summary has it.
fn attractor_json<'j>(
    (period, apart): (u64, f64),
    touching: impl Iterator<Item = (&'j str, bool)>,
) -> Value {
    let touching = touching.map(|(joint, always)| (joint.to_owned(), json!(always)));
    json!({
        "revolutions": period,
        "apart": apart,
        "always_in_contact": Map::from_iter(touching),
    })
}

/// The paths of all numbers below a word.
fn paths(word: &str, numbers: &Value) -> Vec<String> {
    match numbers {
        Value::Object(below) => {
            below.iter().flat_map(|(key, value)| paths(&format!("{word}.{key}"), value)).collect()
        }
        _ => vec![word.to_owned()],
    }
}

/// The first case of a study that can be run.
fn first_case(study: &Study) -> Result<Case, Error> {
    let mut first = None;
    let stride = (study.runs / TRIED).max(1);
    for run in (0..study.runs).step_by(stride as usize) {
        let case = study.case(run).and_then(|case| {
            let runs = Simulation::new(&case).map(drop);
            runs.map(|()| case).map_err(Error::Case)
        });
        match case {
            Ok(case) => return Ok(case),
            Err(error) => first = first.or(Some(error)),
        }
    }
    Err(first.unwrap_or_else(|| Error::NoRuns { path: study.path.clone() }))
}

/// What is kept of each joint, and of each clearance, where a study does not say.
type Choice = (&'static [&'static str], &'static [&'static str]);
const OF_RUNS: Choice = (
    &["largest"],
    &["contacts", "share_in_contact", "largest_penetration", "largest_impact_rate", "dissipated"],
);
const OF_REVOLUTIONS: Choice = (&["largest"], &["contacts", "share_in_contact"]);

fn choice(names: &Names, (of_joints, of_clearances): &Choice) -> Vec<String> {
    let each = |part: &str, names: &[String], what: &[&str]| -> Vec<String> {
        let paths = names
            .iter()
            .flat_map(|name| what.iter().map(move |what| format!("{part}{name}.{what}")));
        paths.collect()
    };
    let mut all = each("columns.joint_force.", &names.joints, of_joints);
    all.extend(each("clearances.", &names.clearances, of_clearances));
    all
}

/// What a sample is taken for.
#[derive(Debug, Clone, Copy)]
struct Of {
    grid: bool,
    section: bool,
    /// What counts begins there.
    begin: bool,
    /// A revolution ends there.
    turn: bool,
}

/// What is kept of a run while it goes on.
struct Kept<'a> {
    runner: &'a Runner<'a>,
    times: std::slice::Iter<'a, (f64, Of)>,
    /// Where the first revolution that is kept begins (s).
    first_time: f64,
    /// Time of a revolution of the first drive (s).
    period: Option<f64>,
    contacts: Vec<Contact>,
    revolutions: Vec<Revolution>,
    energies: Vec<(f64, EnergyObservation)>,
    sections: Vec<f64>,
    /// States at the ends of revolutions.
    points: Vec<Point>,
    sizes: Sizes,
    witness: Option<Witness>,
}

/// What of a revolution counts as nothing.
const ROUNDING: f64 = 1e-9;

impl Recorder for Kept<'_> {
    type Error = Infallible;

    fn sample(&mut self, observation: &Observation) -> Result<(), Infallible> {
        let Some((_, of)) = self.times.next() else { return Ok(()) };
        let time = observation.time;
        if of.grid || of.begin {
            self.energies.push((time, observation.energy));
        }
        if let Some(witness) = self.witness.as_mut().filter(|_| of.grid) {
            witness.take(observation);
        }
        if of.turn {
            self.points.push(Point::of(observation, &self.sizes));
        }
        let behind = time >= self.first_time * (1.0 - ROUNDING);
        if let Some(section) = self.runner.section.as_ref().filter(|_| of.section && behind) {
            let turned = self.period.map_or(0.0, |period| (time / period + ROUNDING).floor());
            self.sections.extend([turned, time]);
            self.sections
                .extend(section.columns.iter().map(|column| column.column.value(observation)));
        }
        Ok(())
    }

    fn event(&mut self, _: Event) -> Result<(), Infallible> {
        Ok(())
    }

    fn contact(&mut self, contact: Contact) -> Result<(), Infallible> {
        if let Some(witness) = &mut self.witness {
            witness.take_contact(contact);
        }
        self.contacts.push(contact);
        Ok(())
    }

    fn peak(&mut self, _: Peak) -> Result<(), Infallible> {
        Ok(())
    }

    fn keeps_revolutions(&self) -> bool {
        !self.runner.quantities.is_empty()
    }

    fn revolution(&mut self, revolution: &Revolution) -> Result<(), Infallible> {
        self.revolutions.push(revolution.clone());
        Ok(())
    }
}
