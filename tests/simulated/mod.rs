//! Cases run in memory, with everything kept that a run tells.

#![allow(dead_code, reason = "each file of tests uses its own part")]

pub mod drift;
pub mod truth;

use freeplay::case::{Case, Changes};
use freeplay::dae::Count;
use freeplay::mechanism::Observation;
use freeplay::run::{Progress, Trajectory};
use freeplay::simulate::Simulation;
use std::error::Error;
use std::ops::{ControlFlow, Deref};
use std::path::{Path, PathBuf};

/// Everything that a run told, and what it counted.
#[derive(Debug, Default)]
pub struct Kept {
    trajectory: Trajectory,
    pub counts: Vec<Count>,
}

impl Deref for Kept {
    type Target = Trajectory;

    fn deref(&self) -> &Trajectory {
        &self.trajectory
    }
}

impl Kept {
    /// The sample at a time (s) of the schedule.
    pub fn at(&self, time: f64) -> &Observation {
        let found = self.samples.iter().find(|sample| sample.time == time);
        found.unwrap_or_else(|| panic!("no sample at {time:e} s"))
    }

    /// The last sample.
    pub fn last(&self) -> &Observation {
        self.samples.last().expect("a run has samples")
    }

    /// Largest magnitude of a quantity over the samples.
    pub fn largest(&self, of: impl Fn(&Observation) -> f64) -> f64 {
        self.samples.iter().map(|sample| of(sample).abs()).fold(0.0, f64::max)
    }

    /// A count of the engine or of the rulings, by name.
    pub fn count(&self, name: &str) -> u64 {
        let found = self.counts.iter().find(|count| count.name == name);
        found.unwrap_or_else(|| panic!("nothing counts {name}")).value
    }
}

/// A case file of the project, by its path, with keys set as `--set` does.
pub fn case(path: &str, set: &[&str]) -> Case {
    let path = root().join(path);
    told(Case::read(&path, &changes(set)))
}

/// A case from its text, with keys set as `--set` does.
pub fn case_of(text: &str, set: &[&str]) -> Case {
    told(Case::from_text(Path::new("case.toml"), text, &changes(set)))
}

/// The project's folder.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn changes(set: &[&str]) -> Changes {
    let set = set.iter().map(|change| change.parse().expect("KEY=VALUE")).collect();
    Changes { set, ideal: false }
}

/// Runs a case to its end.
pub fn simulate(case: &Case) -> Kept {
    let mut kept = Kept::default();
    let simulation = told(Simulation::new(case));
    let mut go_on = |_: &Progress| ControlFlow::Continue(());
    let (statistics, ran) = simulation.run(&mut kept.trajectory, &mut go_on);
    told(ran);
    kept.counts = statistics.engine.into_iter().chain(statistics.rulings).collect();
    kept
}

/// An error and its causes.
pub fn words(error: &dyn Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        words = format!("{words}: {error}");
        cause = error.source();
    }
    words
}

/// What there is, or a panic with the error and its causes.
pub fn told<T, E: Error>(result: Result<T, E>) -> T {
    result.unwrap_or_else(|error| panic!("{}", words(&error)))
}
