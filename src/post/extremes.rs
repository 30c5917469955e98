//! Extremes of every quantity of a run: of a result file, or of a case run on the spot.
//!
//! A mechanism without freedom is not sampled but evaluated, so that its extremes are true to
//! rounding. Those of any other run were found while it went on, whatever its samples. Files of
//! programs that did not keep them tell the extremes of their samples, and of normal forces the
//! peaks.

use super::refine::{maximum, stands_out};
use super::tally::{Basis, Extreme, Tally, accuracy};
use super::{Error, Quantity, Revolutions};
use crate::case::{Case, Changes};
use crate::dae::Fault;
use crate::mechanism::{Mechanism, Observation};
use crate::model::Names;
use crate::record::ResultFile;
use crate::run::{Assembled, Contact, Event, EventKind, Peak, Recorder, Revolution, TooFar};
use crate::simulate::Simulation;
use std::convert::Infallible;
use std::ops::ControlFlow;

/// Quantities of a run with their extremes.
#[derive(Debug, Clone)]
pub struct RunExtremes {
    /// Names of the run's joints, drives and bodies.
    pub names: Names,
    /// Every quantity, with its extremes.
    pub quantities: Vec<(Quantity, Tally)>,
}

impl RunExtremes {
    /// The extremes of the quantity of this name.
    pub fn of(&self, name: &str) -> Option<&Tally> {
        let found = self.quantities.iter().find(|(of, _)| of.name(&self.names) == name);
        found.map(|(_, tally)| tally)
    }

    /// Of a case without clearance, run on the spot until `end` (s), for some of its quantities.
    ///
    /// # Errors
    /// A case that describes no mechanism, or whose simulation fails.
    pub fn of_ideal(case: &Case, end: f64, wanted: Wanted<'_>) -> Result<Self, Error> {
        let simulation = Simulation::new(case).map_err(Error::Case)?;
        if let Some(assembled) = Assembled::new(simulation.mechanism().clone()) {
            return Self::of_assembled(assembled, end, None, wanted);
        }
        let tolerance = case.plan.solver.relative_tolerance;
        let mechanism = simulation.mechanism();
        let mut recording = Recording::new(mechanism, end, accuracy(tolerance), wanted);
        let (_, ran) = simulation.run(&mut recording, &mut |_| ControlFlow::Continue(()));
        ran.map_err(Error::Simulation)?;
        Ok(recording.into_extremes())
    }

    /// Of what a run found in its revolutions, to its relative tolerance. Those that begin before a time
    /// (s) do not count for the run, but each for itself.
    pub fn of_revolutions(
        names: &Names,
        (revolutions, from): (&[Revolution], f64),
        tolerance: f64,
        parts: Option<Revolutions>,
        wanted: Wanted<'_>,
    ) -> Self {
        let accuracy = accuracy(tolerance);
        let quantities = wanted.of(names).into_iter().map(|quantity| {
            let mut tally = Tally::new(parts, quantity.is_signed());
            for (k, revolution) in revolutions.iter().enumerate() {
                let counts = revolution.begin >= from * (1.0 - ROUNDING);
                tally.take_found((k, counts), revolution, quantity, accuracy);
            }
            (quantity, tally)
        });
        RunExtremes { quantities: quantities.collect(), names: names.clone() }
    }

    /// Of a mechanism that can be evaluated at any time, from 0 to `end` (s).
    ///
    /// # Errors
    /// A position that cannot be reached.
    pub fn of_assembled(
        mut assembled: Assembled<f64>,
        end: f64,
        parts: Option<Revolutions>,
        wanted: Wanted<'_>,
    ) -> Result<Self, Error> {
        let names = assembled.mechanism().model().names().clone();
        let quantities = wanted.of(&names);
        let tallies = quantities.iter().map(|quantity| Tally::new(parts, quantity.is_signed()));
        let mut tallies: Vec<Tally> = tallies.collect();
        let end = once_round(&assembled, end);
        let mut scan = Scan { assembled: &mut assembled, last: Vec::new() };
        let spans = match parts {
            Some(parts) => (0..parts.count()).map(|k| parts.bounds(k)).collect(),
            None => vec![[0.0, end]],
        };
        for [begin, end] in spans {
            let strides = ((end - begin) / scan.assembled.stride()).ceil().max(2.0);
            if !(strides <= MOST_STRIDES) {
                let source = Fault::Fatal(Box::new(TooFar { strides }));
                return Err(Error::System { time: end, source });
            }
            for k in 0..=strides as u64 {
                let time = begin + (end - begin) * (k as f64 / strides);
                scan.go(time, &quantities, &mut tallies)
                    .map_err(|source| Error::System { time, source })?;
            }
        }
        Ok(RunExtremes { names, quantities: quantities.into_iter().zip(tallies).collect() })
    }

    /// Takes the samples too, and no more for known than they are: what a run found leaves out where it
    /// passed singular positions.
    fn know_no_more_than_samples(&mut self, file: &ResultFile, times: &[f64]) -> Result<(), Error> {
        for (quantity, tally) in &mut self.quantities {
            take_samples(tally, times, &values_of(file, *quantity)?);
            tally.know_no_more_than_samples();
        }
        Ok(())
    }

    /// Of a result file. `case` is the case that was run, where it is known.
    ///
    /// # Errors
    /// What reading the file meets.
    pub fn of_file(
        file: &ResultFile,
        case: Option<&Case>,
        parts: Option<Revolutions>,
    ) -> Result<Self, Error> {
        let mechanism = case.and_then(|case| Simulation::new(case).ok());
        let mechanism = mechanism.map(|simulation| simulation.mechanism().clone());
        let names = names_of(file);
        if let (Some(mechanism), Some(end)) = (mechanism, file.last_time()?)
            && *mechanism.model().names() == names
            && let Some(assembled) = Assembled::new(mechanism)
            && (parts.is_some() || once_round(&assembled, end) <= MOST_STRIDES * assembled.stride())
        {
            return Self::of_assembled(assembled, end, parts, Wanted::All);
        }
        let revolutions = file.revolutions()?;
        if !revolutions.is_empty() {
            let tolerance = file.number("relative_tolerance").unwrap_or(f64::INFINITY);
            let all = Wanted::All;
            let whole = (&revolutions[..], 0.0);
            let mut found = Self::of_revolutions(&names, whole, tolerance, parts, all);
            if file.events()?.iter().any(|event| event.kind == EventKind::Singular) {
                found.know_no_more_than_samples(file, &file.times()?)?;
            }
            return Ok(found);
        }
        let times = file.times()?;
        let friction = has_friction(file)?;
        let mut quantities = Vec::new();
        for quantity in Quantity::all(&names) {
            let mut tally = Tally::new(parts, quantity.is_signed());
            take_samples(&mut tally, &times, &values_of(file, quantity)?);
            take_peaks(&mut tally, file, quantity, friction)?;
            quantities.push((quantity, tally));
        }
        Ok(RunExtremes { names, quantities })
    }
}

/// Quantities that somebody asks for.
#[derive(Debug, Clone, Copy)]
pub enum Wanted<'a> {
    /// All.
    All,
    /// Those of these names: `joint_force.A`.
    Named(&'a [String]),
}

impl Wanted<'_> {
    /// The quantities of a mechanism that are meant.
    fn of(self, names: &Names) -> Vec<Quantity> {
        let mut all = Quantity::all(names);
        if let Wanted::Named(wanted) = self {
            all.retain(|quantity| wanted.contains(&quantity.name(names)));
        }
        all
    }
}

/// What of a time counts as nothing, relative to it.
const ROUNDING: f64 = 1e-9;

/// Strides through a mechanism in search of extremes, a minute's work.
const MOST_STRIDES: f64 = 1e7;

/// Where a walk to `end` (s) has seen all: what one drive does in a revolution it does in all.
fn once_round(assembled: &Assembled<f64>, end: f64) -> f64 {
    match assembled.mechanism().model().drives() {
        [drive] => end.min(drive.course.all().unwrap_or(end)),
        _ => end,
    }
}

/// Names of everything in a file.
pub(super) fn names_of(file: &ResultFile) -> Names {
    Names {
        bodies: file.bodies().to_vec(),
        joints: file.joints().to_vec(),
        clearances: file.clearances().to_vec(),
        loose: Vec::new(),
        drives: file.drives().to_vec(),
        points: file.points().to_vec(),
        memories: file.memories().to_vec(),
    }
}

/// The case that a file holds, with changes; the text of the file is the case as run.
///
/// # Errors
/// The file has none, or this program cannot read it.
pub fn case_of(file: &ResultFile, changes: &Changes) -> Result<Case, Error> {
    let Some(text) = file.text("case_toml") else {
        return Err(Error::NoCase { path: file.path().to_owned() });
    };
    Case::from_text(file.path(), text, changes).map_err(Error::Case)
}

/// A quantity at every sample of a file.
fn values_of(file: &ResultFile, quantity: Quantity) -> Result<Vec<f64>, Error> {
    let column = |name: &str, item: usize| Ok::<_, Error>(file.table(name)?.column(item));
    match quantity {
        Quantity::JointForce(joint) => {
            let (x, y) = (column("joint_force_x", joint)?, column("joint_force_y", joint)?);
            Ok(x.iter().zip(&y).map(|(x, y)| x.hypot(*y)).collect())
        }
        quantity => column(quantity.dataset(), quantity.measure().1),
    }
}

/// Takes the samples of a curve.
fn take_samples(tally: &mut Tally, times: &[f64], values: &[f64]) {
    for (&time, &value) in times.iter().zip(values) {
        tally.take(Extreme::new(value, time, Basis::Sample));
    }
}

/// Whether any sample of a file has a tangential force.
fn has_friction(file: &ResultFile) -> Result<bool, Error> {
    Ok(file.table("tangential_force")?.values.iter().any(|force| *force != 0.0))
}

/// Takes the peaks of normal forces that a run found, in a file without extremes by revolution.
/// With friction the force of the joint is larger, and nobody knows by how much.
fn take_peaks(
    tally: &mut Tally,
    file: &ResultFile,
    quantity: Quantity,
    friction: bool,
) -> Result<(), Error> {
    let name = |joint: usize| &file.joints()[joint];
    let (clearance, basis) = match quantity {
        Quantity::JointForce(joint) => (
            file.clearances().iter().position(|clearance| clearance == name(joint)),
            if friction { Basis::Sample } else { Basis::Peak },
        ),
        Quantity::NormalForce(clearance) => (Some(clearance), Basis::Peak),
        _ => (None, Basis::Peak),
    };
    let Some(clearance) = clearance else { return Ok(()) };
    let peaks = file.peaks()?.into_iter().map(|peak| (peak.clearance, peak.time, peak.force));
    let contacts = file.contacts()?.into_iter();
    let contacts = contacts.map(|c| (c.clearance, c.peak_time, c.peak_force));
    for (_, time, force) in peaks.chain(contacts).filter(|(k, ..)| *k == clearance) {
        tally.take(Extreme::new(force, time, basis));
    }
    Ok(())
}

/// A walk through time that looks for extremes on its way.
struct Scan<'a> {
    assembled: &'a mut Assembled<f64>,
    /// Times of the last two stations, and the quantities there.
    last: Vec<(f64, Vec<f64>)>,
}

impl Scan<'_> {
    /// Goes to a time (s).
    fn go(&mut self, time: f64, of: &[Quantity], tallies: &mut [Tally]) -> Result<(), Fault> {
        if self.last.last().is_some_and(|(last, _)| *last >= time) {
            return Ok(());
        }
        let here = self.assembled.observe(time)?;
        let values: Vec<f64> = of.iter().map(|quantity| quantity.of(&here)).collect();
        for ((tally, value), quantity) in tallies.iter_mut().zip(&values).zip(of) {
            tally.take(Extreme::new(*value, time, self.basis(*quantity)));
        }
        self.last.push((time, values));
        if self.last.len() > 3 {
            self.last.remove(0);
        }
        if let [before, middle, after] = &self.last[..] {
            for (k, tally) in tallies.iter_mut().enumerate() {
                for &sign in tally.signs() {
                    let three = [before.1[k], middle.1[k], after.1[k]].map(|value| sign * value);
                    if stands_out(three) {
                        let (time, value) = maximum([before.0, after.0], |time| {
                            Ok::<_, Fault>(sign * of[k].of(&self.assembled.observe(time)?))
                        })?;
                        tally.take(Extreme::new(sign * value, time, self.basis(of[k])));
                    }
                }
            }
        }
        Ok(())
    }

    /// How a quantity is known where the mechanism was last evaluated.
    fn basis(&self, quantity: Quantity) -> Basis {
        match quantity {
            Quantity::JointForce(_) if self.assembled.has_no_bound() => Basis::Sample,
            _ => Basis::Evaluated,
        }
    }
}

/// What is kept of a run on the spot that has no clearance.
struct Recording {
    names: Names,
    quantities: Vec<Quantity>,
    end: f64,
    /// Of what the run finds.
    accuracy: f64,
    tallies: Vec<Tally>,
}

impl Recording {
    fn new(mechanism: &Mechanism<f64>, end: f64, accuracy: f64, wanted: Wanted<'_>) -> Self {
        let names = mechanism.model().names().clone();
        let quantities = wanted.of(&names);
        let tallies = quantities.iter().map(|quantity| Tally::new(None, quantity.is_signed()));
        Recording { tallies: tallies.collect(), names, quantities, end, accuracy }
    }

    fn into_extremes(self) -> RunExtremes {
        let quantities = self.quantities.into_iter().zip(self.tallies).collect();
        RunExtremes { names: self.names, quantities }
    }
}

impl Recorder for Recording {
    type Error = Infallible;

    fn sample(&mut self, observation: &Observation) -> Result<(), Infallible> {
        if observation.time <= self.end {
            for (tally, quantity) in self.tallies.iter_mut().zip(&self.quantities) {
                let value = quantity.of(observation);
                tally.take(Extreme::new(value, observation.time, Basis::Sample));
            }
        }
        Ok(())
    }

    fn event(&mut self, _: Event) -> Result<(), Infallible> {
        Ok(())
    }

    fn contact(&mut self, _: Contact) -> Result<(), Infallible> {
        Ok(())
    }

    fn peak(&mut self, _: Peak) -> Result<(), Infallible> {
        Ok(())
    }

    fn keeps_revolutions(&self) -> bool {
        true
    }

    /// Of a revolution that goes on beyond the end only the samples count.
    fn revolution(&mut self, revolution: &Revolution) -> Result<(), Infallible> {
        if revolution.end <= self.end {
            for (tally, quantity) in self.tallies.iter_mut().zip(&self.quantities) {
                tally.take_found((0, true), revolution, *quantity, self.accuracy);
            }
        }
        Ok(())
    }
}
