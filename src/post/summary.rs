//! A run in the numbers that people ask for first.

use super::contacts::Contacts;
use super::energy::EnergyBalance;
use super::extremes::{RunExtremes, Wanted, case_of, names_of};
use super::tally::{Extremes, ratio};
use super::{Error, Quantity, Revolutions};
use crate::case::{Case, Changes};
use crate::certify::Horizon;
use crate::mechanism::{EnergyObservation, Mechanism};
use crate::model::Model;
use crate::record::ResultFile;
use crate::run::{Assembled, Contact, Revolution};
use crate::simulate;
use std::path::PathBuf;

/// The drive whose revolutions a run is parted into: the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Turning {
    /// Name of the drive.
    pub drive: String,
    /// Its angle at t = 0 (rad).
    pub start: f64,
    /// Its rate (rad/s).
    pub rate: f64,
    /// The revolutions of the run.
    pub revolutions: Revolutions,
}

impl Turning {
    /// Angle of the drive at a time (s), less whole revolutions (rad).
    pub fn angle(&self, time: f64) -> f64 {
        (self.start + self.rate * time).rem_euclid(std::f64::consts::TAU)
    }
}

/// What a run is held against.
#[derive(Debug)]
pub enum Reference {
    /// The ideal mechanism of the same case, made on the spot.
    Ideal(RunExtremes),
    /// The run itself: it has no clearance.
    Itself,
    /// Another file.
    File {
        /// The file.
        path: PathBuf,
        /// Name of its case.
        case_name: String,
        /// What it holds.
        extremes: RunExtremes,
    },
}

/// A run in memory that came to its end, as far as a summary tells of it.
#[derive(Debug, Clone, Copy)]
pub struct InMemory<'a> {
    /// The case.
    pub case: &'a Case,
    /// Its mechanism.
    pub mechanism: &'a Mechanism<f64>,
    /// Where the numbers of the whole run begin (s), a begin of one of its revolutions: what lies before
    /// is a transient. Those of single revolutions are told all the same.
    pub begin: f64,
    /// Where the run ended (s).
    pub end: f64,
    /// Contacts, in the order of their begins.
    pub contacts: &'a [Contact],
    /// Extremes of revolutions, in the order of time.
    pub revolutions: &'a [Revolution],
    /// Energies (J) at times (s), those of start and end among them.
    pub energies: &'a [(f64, EnergyObservation)],
    /// How far the run is true, if that was looked into.
    pub horizon: Option<&'a Horizon>,
}

/// A run in numbers.
#[derive(Debug)]
pub struct Summary {
    /// The file.
    pub path: PathBuf,
    /// Name of its case.
    pub case_name: String,
    /// Title of its case.
    pub title: String,
    /// `complete`, `failed` or `running`.
    pub status: String,
    /// Number of samples.
    pub samples: usize,
    /// Where the run ended (s).
    pub end: f64,
    /// Revolutions; `None` without a drive that turns.
    pub turning: Option<Turning>,
    /// Extremes of every quantity.
    pub run: RunExtremes,
    /// What they are held against, or why there is no ideal run.
    pub reference: Result<Reference, Box<Error>>,
    /// Joints with clearance.
    pub contacts: Vec<Contacts>,
    /// Contacts that have fewer than three samples: what the drives and bodies did in them is
    /// known from their neighbours only.
    pub unresolved_contacts: usize,
    /// Energies; `None` without samples.
    pub energy: Option<EnergyBalance>,
    /// How far the run is true; `None` where the file does not tell.
    pub horizon: Option<Horizon>,
    /// A sentence on that, to be quoted.
    pub sentence: Option<String>,
}

impl Summary {
    /// Summarises a file, against another one or, without it, against the ideal mechanism.
    ///
    /// # Errors
    /// Files that cannot be read, or that have nothing in common.
    pub fn of(file: &ResultFile, against: Option<&ResultFile>) -> Result<Self, Error> {
        let times = file.times()?;
        let contacts = file.contacts()?;
        let end = end_of(&times, &contacts);
        let case = case_of(file, &Changes::default()).ok();
        let model = case.as_ref().and_then(|case| Model::<f64>::new(&case.description).ok());
        let turning = model.and_then(|model| turning(&model, end, times.len()));
        let parts = turning.as_ref().map(|turning| turning.revolutions);
        let run = RunExtremes::of_file(file, case.as_ref(), parts)?;
        let reference = match against {
            Some(other) => Ok(held_against(file, &run, other)?),
            None if file.clearances().is_empty() => Ok(Reference::Itself),
            None => ideal(file, end).map(Reference::Ideal).map_err(Box::new),
        };
        let text = |name| file.text(name).unwrap_or_default().to_owned();
        let joints = file.clearances().iter().enumerate();
        let horizon = Horizon::of(file)?;
        Ok(Summary {
            path: file.path().to_owned(),
            case_name: text("case_name"),
            title: text("title"),
            status: text("run_status"),
            samples: times.len(),
            end,
            run,
            reference,
            contacts: joints
                .map(|(k, joint)| Contacts::of((k, joint), &contacts, [0.0, end], parts))
                .collect(),
            unresolved_contacts: contacts.iter().filter(|c| samples_in(c, &times) < 3).count(),
            turning,
            energy: EnergyBalance::of(file)?,
            sentence: horizon.as_ref().map(|horizon| horizon.sentence(file)),
            horizon,
        })
    }

    /// Summarises a run in memory that came to its end, held against `reference` if there is one.
    ///
    /// # Errors
    /// Those of [`RunExtremes::of_assembled`].
    pub fn of_run(
        run: &InMemory<'_>,
        reference: Option<RunExtremes>,
        wanted: Wanted<'_>,
    ) -> Result<Self, Error> {
        let InMemory { case, mechanism, begin, end, contacts, .. } = *run;
        let names = mechanism.model().names();
        let turning = turning(mechanism.model(), end, usize::MAX);
        let parts = turning.as_ref().map(|turning| turning.revolutions);
        let extremes = match Assembled::new(mechanism.clone()) {
            Some(assembled) => RunExtremes::of_assembled(assembled, end, parts, wanted)?,
            None => {
                let tolerance = case.plan.solver.relative_tolerance;
                let span = (run.revolutions, begin);
                RunExtremes::of_revolutions(names, span, tolerance, parts, wanted)
            }
        };
        let energies = || run.energies.iter().copied().filter(|(time, _)| *time >= begin);
        let nothing = || RunExtremes { names: names.clone(), quantities: Vec::new() };
        let joints = names.clearances.iter().enumerate();
        Ok(Summary {
            path: PathBuf::new(),
            case_name: case.name.clone(),
            title: case.title.clone(),
            status: "complete".to_owned(),
            samples: energies().count(),
            end,
            reference: Ok(match names.clearances.is_empty() {
                true => Reference::Itself,
                false => Reference::Ideal(reference.unwrap_or_else(nothing)),
            }),
            run: extremes,
            contacts: joints
                .map(|(k, joint)| Contacts::of((k, joint), contacts, [begin, end], parts))
                .collect(),
            unresolved_contacts: 0,
            turning,
            energy: EnergyBalance::of_samples(energies()),
            horizon: run.horizon.cloned(),
            sentence: None,
        })
    }

    /// Whether a force, torque or acceleration at a time (s) lies beyond the horizon of the run.
    pub fn is_beyond(&self, time: f64) -> bool {
        self.horizon.as_ref().is_some_and(|horizon| time > horizon.forces)
    }

    /// Whether some of a revolution, counted from 0, does.
    pub fn reaches_beyond(&self, revolution: usize) -> bool {
        let parts = self.turning.as_ref().map(|turning| turning.revolutions);
        parts.is_some_and(|parts| {
            let [_, end] = parts.bounds(revolution);
            self.horizon.as_ref().is_some_and(|horizon| {
                horizon.forces < horizon.end && end * (1.0 - 1e-9) > horizon.forces
            })
        })
    }

    /// Extremes of a quantity in what the run is held against.
    pub fn reference_of(&self, quantity: Quantity) -> Option<Extremes> {
        let extremes = match self.reference.as_ref().ok()? {
            Reference::Ideal(extremes) | Reference::File { extremes, .. } => extremes,
            Reference::Itself => &self.run,
        };
        extremes.of(&quantity.name(&self.run.names)).map(|tally| tally.total)
    }

    /// Ratios of a quantity's largest and smallest value in some span to those of the reference;
    /// `None` where the one or the other is missing, or they differ in sign.
    pub fn ratios(&self, quantity: Quantity, extremes: &Extremes) -> [Option<f64>; 2] {
        let reference = self.reference_of(quantity).unwrap_or_default();
        let of = |extreme: Option<super::Extreme>| extreme.map(|extreme| extreme.value);
        [(extremes.largest, reference.largest), (extremes.smallest, reference.smallest)]
            .map(|(value, reference)| ratio(of(value), of(reference)))
            .map(|ratio| ratio.filter(|ratio| *ratio >= 0.0))
    }
}

/// The end of a run (s): its last sample, or what a failed run told of after that.
fn end_of(times: &[f64], contacts: &[Contact]) -> f64 {
    let told = contacts.iter().flat_map(|contact| [contact.begin, contact.end]);
    times.last().copied().into_iter().chain(told).fold(0.0, f64::max)
}

fn samples_in(contact: &Contact, times: &[f64]) -> usize {
    let begin = times.partition_point(|time| *time < contact.begin);
    let inside = |time: &f64| contact.end.is_nan() || *time <= contact.end;
    times[begin..].iter().take_while(|time| inside(time)).take(3).count()
}

/// The first drive of a mechanism, and its revolutions; more than there are samples mean nothing.
fn turning(model: &Model<f64>, end: f64, samples: usize) -> Option<Turning> {
    let (drive, name) = model.drives().first().zip(model.names().drives.first())?;
    let [start, rate, _] = drive.course.at(0.0);
    let round = std::f64::consts::TAU / drive.course.period()?;
    let rate = if drive.course.accelerates() { round } else { rate };
    let revolutions = Revolutions::new(rate, end, samples)?;
    Some(Turning { drive: name.clone(), start, rate, revolutions })
}

/// The ideal mechanism of the case in a file, in doubles, which is all that a ratio needs.
fn ideal(file: &ResultFile, end: f64) -> Result<RunExtremes, Error> {
    let case = case_of(file, &Changes::default())?;
    let ideal = simulate::ideal_case(&case).map_err(|why| Error::NoIdeal { why: Box::new(why) })?;
    RunExtremes::of_ideal(&ideal, end, Wanted::All)
}

fn held_against(
    file: &ResultFile,
    run: &RunExtremes,
    other: &ResultFile,
) -> Result<Reference, Error> {
    let case = case_of(other, &Changes::default()).ok();
    let extremes = RunExtremes::of_file(other, case.as_ref(), None)?;
    let names = names_of(file);
    if !run.quantities.iter().any(|(of, _)| extremes.of(&of.name(&names)).is_some()) {
        let (file, against) = (file.path().to_owned(), other.path().to_owned());
        return Err(Error::NothingInCommon { file, against });
    }
    let case_name = other.text("case_name").unwrap_or_default().to_owned();
    Ok(Reference::File { path: other.path().to_owned(), case_name, extremes })
}
