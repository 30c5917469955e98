//! The reference at the times of the other.
//!
//! Where the reference has no sample of its own at a time, its case is run again, on its own engine
//! and with its own tolerances, sampled at exactly those times, and beside them at times where the
//! file has samples. These must come out as they stand in the file, else nothing is trusted. There
//! is no interpolation.
//!
//! The case is the text in the attribute `case_toml`, as run. The samples of a certified reference
//! were not made with its settings, but in 71 digits at the tolerance in `reference_tolerance_tight`.

use super::Error;
use super::quantity::{Column, Part, Parts, Quantity};
use super::source::{Trajectory, case_in};
use crate::case::Changes;
use crate::digits::Scales;
use crate::mechanism::Observation;
use crate::record::{self, ResultFile};
use crate::run::{Contact, Event, Peak, Progress, Recorder, Watcher};
use crate::simulate::{self, Simulation};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::path::Path;

/// Samples of the file that a second run is held against.
const CHECKS: usize = 256;

/// Units in the last place, of the number or of its scale, by which a second run may be off.
const LAST_PLACES: f64 = 4.0;

/// The same for forces, which come from the state with a loss of three digits and more.
const LAST_PLACES_OF_FORCES: f64 = 1e4;

/// How the reference came to have values at the times of the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// It has samples there.
    Stored,
    /// Its case was run again.
    RunAgain {
        /// How many samples of the file came out again.
        checked: usize,
    },
    /// Only times that both have are looked at.
    CommonTimes,
}

/// Index of the sample at exactly this time.
pub fn index_of(times: &[f64], time: f64) -> Option<usize> {
    times
        .binary_search_by(|known| known.partial_cmp(&time).unwrap_or(std::cmp::Ordering::Less))
        .ok()
}

/// The values of a trajectory at some of its samples.
pub fn pick(values: &[Vec<f64>], indices: &[usize]) -> Vec<Vec<f64>> {
    values.iter().map(|column| indices.iter().map(|index| column[*index]).collect()).collect()
}

/// A result of ours as a reference.
#[derive(Debug, Clone, Copy)]
pub struct Reference<'a> {
    /// The file.
    pub file: &'a ResultFile,
    /// Its samples.
    pub stored: &'a Trajectory,
    /// Its scales.
    pub scales: &'a Scales,
    /// Names of the mechanism's parts.
    pub parts: &'a Parts,
    /// The file that is held against it.
    pub theirs: &'a Path,
}

impl Reference<'_> {
    /// Values of all columns at these times (s), one or more, sorted, none twice, none outside the
    /// reference; and how they were had.
    ///
    /// # Errors
    /// The case cannot be run again, or comes out otherwise.
    pub fn at(&self, times: &[f64], watch: Watcher<'_>) -> Result<(Vec<Vec<f64>>, Way), Error> {
        let own: Option<Vec<usize>> =
            times.iter().map(|time| index_of(&self.stored.times, *time)).collect();
        match own {
            Some(own) => Ok((pick(&self.stored.values, &own), Way::Stored)),
            None => self.run_again(times, watch),
        }
    }

    fn run_again(&self, times: &[f64], watch: Watcher<'_>) -> Result<(Vec<Vec<f64>>, Way), Error> {
        let checks = self.checks(times);
        let stored = checks.iter().map(|index| self.stored.times[*index]);
        let mut all: Vec<f64> = stored.chain(times.iter().copied()).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        let again = self.simulate(&all, watch)?;
        for (row, time) in all.iter().enumerate() {
            if let Some(index) = index_of(&self.stored.times, *time) {
                self.check(index, &again, row)?;
            }
        }
        let wanted: Vec<usize> = times.iter().filter_map(|time| index_of(&all, *time)).collect();
        assert!(wanted.len() == times.len(), "a run has a sample at every time asked for");
        Ok((pick(&again, &wanted), Way::RunAgain { checked: checks.len() }))
    }

    /// Samples of the file, spread from its begin to the first at or behind the last time.
    fn checks(&self, times: &[f64]) -> Vec<usize> {
        let last = times.last().copied().unwrap_or_default();
        let stored = &self.stored.times;
        let end = stored.partition_point(|time| *time < last).min(stored.len() - 1);
        let mut checks: Vec<usize> = (0..=CHECKS).map(|k| k * end / CHECKS).collect();
        checks.dedup();
        checks
    }

    /// What the samples were made with that the case does not say.
    fn changes(&self) -> Changes {
        let Some(tolerance) = self.file.number("reference_tolerance_tight") else {
            return Changes::default();
        };
        let set = [
            "solver.engine=explicit".to_owned(),
            "solver.precision=71".to_owned(),
            format!("solver.reference_tolerance={tolerance:e}"),
        ];
        Changes { set: set.iter().filter_map(|set| set.parse().ok()).collect(), ideal: false }
    }

    /// Runs the case, sampled at these times, until the last of them.
    fn simulate(&self, times: &[f64], watch: Watcher<'_>) -> Result<Vec<Vec<f64>>, Error> {
        let case = case_in(self.file, &self.changes())?;
        let simulation = Simulation::new(&case).map_err(|source| Error::Case {
            path: self.file.path().to_owned(),
            source: Box::new(source),
        })?;
        let duration: f64 = simulation.schedule().duration();
        if times.iter().any(|time| !(0.0..=duration).contains(time)) {
            let what = format!("its case lasts {duration} s, its samples do not lie within");
            return Err(record::Error::Damaged { path: self.file.path().to_owned(), what }.into());
        }
        let mut samples = Samples::new(&self.stored.columns);
        let last = times.last().copied().unwrap_or_default();
        let mut stopped = false;
        let mut watch_to_the_last = |progress: &Progress| {
            stopped |= watch(progress).is_break();
            // the run itself must not know where the last sample is: a shorter run takes other
            // steps
            if stopped || progress.time > last {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let (_, ran) =
            simulation.sampled_at(times.to_vec()).run(&mut samples, &mut watch_to_the_last);
        match ran {
            _ if samples.rows == times.len() => Ok(samples.values),
            Err(simulate::Error::Interrupted { .. }) if stopped => Err(Error::Interrupted),
            Err(source) => Err(Error::Again {
                theirs: self.theirs.to_owned(),
                reference: self.file.path().to_owned(),
                source: Box::new(source),
            }),
            Ok(()) => Err(Error::NoSamples { path: self.file.path().to_owned(), until: last }),
        }
    }

    /// Holds a row of a second run against a sample of the file.
    fn check(&self, index: usize, again: &[Vec<f64>], row: usize) -> Result<(), Error> {
        let columns = self.stored.columns.iter().zip(&self.stored.values).zip(again);
        for ((column, stored), again) in columns {
            let (stored, again) = (stored[index], again[row]);
            let size = stored.abs().max(self.scales.of_column(column));
            let places = match column.quantity().map(Quantity::part) {
                Some(Part::Forces) => LAST_PLACES_OF_FORCES,
                _ => LAST_PLACES,
            };
            if !((stored - again).abs() <= places * f64::EPSILON * size) {
                return Err(Error::NotReproduced {
                    theirs: self.theirs.to_owned(),
                    reference: self.file.path().to_owned(),
                    column: self.parts.name(column),
                    time: self.stored.times[index],
                    stored,
                    again,
                });
            }
        }
        Ok(())
    }
}

/// Keeps the columns that are compared.
struct Samples<'a> {
    columns: &'a [Column],
    values: Vec<Vec<f64>>,
    rows: usize,
}

impl<'a> Samples<'a> {
    fn new(columns: &'a [Column]) -> Self {
        Samples { columns, values: vec![Vec::new(); columns.len()], rows: 0 }
    }
}

impl Recorder for Samples<'_> {
    type Error = Infallible;

    fn sample(&mut self, observation: &Observation) -> Result<(), Infallible> {
        for (column, values) in self.columns.iter().zip(&mut self.values) {
            values.push(column.value(observation));
        }
        self.rows += 1;
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
}
