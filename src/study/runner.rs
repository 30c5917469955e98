//! One run of a study, in memory: from its changes to its rows.

use super::pack::{Identity, Record, Rows};
use super::scalar::{Scalar, skeleton};
use super::section::Section;
use super::{Error, Study};
use crate::case::{Case, Changes};
use crate::certify::{self, Reach, Witness};
use crate::digits::Sizes;
use crate::halt;
use crate::mechanism::{EnergyObservation, Mechanism, Observation};
use crate::model::Names;
use crate::post::{InMemory, RunExtremes, Summary, Wanted};
use crate::record::{Ending, Outcome, Writer, sha256, utc};
use crate::run::{Contact, Event, Peak, Progress, Recorder, Revolution, Schedule};
use crate::simulate::{self, Simulation};
use sha2::{Digest, Sha256};
use std::convert::Infallible;
use std::error::Error as StdError;
use std::fmt::Write;
use std::fs;
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
        let skeleton = skeleton(&case, mechanism).map_err(|error| Error::Wrong {
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
        let names = mechanism.model().names().clone();
        let mut of_runs = Vec::new();
        for path in keep.runs.clone().unwrap_or_else(|| choice(&names, &OF_RUNS)) {
            let scalar = Scalar::of(&path, &skeleton);
            of_runs.push(scalar.map_err(|message| wrong("keep.runs", message))?);
        }
        let mut of_revolutions = Vec::new();
        let turns = mechanism.revolution().is_some();
        let chosen = || if turns { choice(&names, &OF_REVOLUTIONS) } else { Vec::new() };
        for path in keep.revolutions.clone().unwrap_or_else(chosen) {
            let scalar = Scalar::of_each_revolution(&path, &skeleton);
            of_revolutions.push(scalar.map_err(|message| wrong("keep.revolutions", message))?);
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
            witness: self.study.keep.horizon.then(|| Witness::new(Sizes::of(&mechanism))),
        };
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
        let Kept { contacts, revolutions, energies, sections, witness, .. } = kept;
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
        let summary = summary.to_json();
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
        let section = section.unwrap_or_default();
        let mut times = Vec::with_capacity(grid.len() + section.len());
        let (mut grid, mut section) = (grid.into_iter().peekable(), section.into_iter().peekable());
        loop {
            let next = match (grid.peek(), section.peek()) {
                (Some(a), Some(b)) if a == b => {
                    grid.next();
                    section.next().map(|time| (time, Of { grid: true, section: true }))
                }
                (Some(a), Some(b)) if b < a => {
                    section.next().map(|time| (time, Of { grid: false, section: true }))
                }
                (None, Some(_)) => {
                    section.next().map(|time| (time, Of { grid: false, section: true }))
                }
                _ => grid.next().map(|time| (time, Of { grid: true, section: false })),
            };
            match next {
                Some(next) => times.push(next),
                None => return times,
            }
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
    witness: Option<Witness>,
}

/// What of a revolution counts as nothing.
const ROUNDING: f64 = 1e-9;

impl Recorder for Kept<'_> {
    type Error = Infallible;

    fn sample(&mut self, observation: &Observation) -> Result<(), Infallible> {
        let Some((_, of)) = self.times.next() else { return Ok(()) };
        let time = observation.time;
        if of.grid {
            self.energies.push((time, observation.energy));
            if let Some(witness) = &mut self.witness {
                witness.take(observation);
            }
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
