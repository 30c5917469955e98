//! How far the state that IDA integrates drifts off the constraints, before any projection.

use super::told;
use freeplay::case::Case;
use freeplay::dae::{Advance, Count, Engine, Snapshot, System};
use freeplay::engine::ida::{self, Ida};
use freeplay::mechanism::Mechanism;
use freeplay::model::Model;
use freeplay::run::{self, Progress, Schedule, Trajectory};
use freeplay::simulate::ida_options;
use std::ops::ControlFlow;

/// Largest |Φ| (m) after any step of a case's run.
pub fn largest_drift(case: &Case) -> f64 {
    let mechanism = Mechanism::new(Model::new(&case.description).unwrap()).unwrap();
    let options = ida_options(&case.plan.solver);
    let ruler = mechanism.clone();
    let mut engine = Drifting { ruler, ida: Ida::new(mechanism, options).unwrap(), largest: 0.0 };
    let schedule = Schedule::new(&case.plan.duration, &case.plan.duration);
    let mut go_on = |_: &Progress| ControlFlow::Continue(());
    let mut kept = Trajectory::default();
    told(run::run(&mut engine, &schedule, options.relative_tolerance, &mut kept, &mut go_on));
    engine.largest
}

/// IDA, with a look at the drift after each step.
struct Drifting {
    ida: Ida<Mechanism<f64>>,
    ruler: Mechanism<f64>,
    largest: f64,
}

impl Engine<f64> for Drifting {
    type System = Mechanism<f64>;
    type Error = ida::Error;

    fn system(&mut self) -> &mut Mechanism<f64> {
        self.ida.system()
    }

    fn restart(&mut self, now: &Snapshot<f64>) -> Result<(), ida::Error> {
        self.ida.restart(now)
    }

    fn step(&mut self, end: f64) -> Result<Advance, ida::Error> {
        let advance = self.ida.step(end)?;
        let Snapshot { time, mut q, mut v, .. } = self.ida.now().clone();
        let drift = self.ruler.project(time, &mut q, &mut v).unwrap();
        self.largest = self.largest.max(drift);
        Ok(advance)
    }

    fn now(&self) -> &Snapshot<f64> {
        self.ida.now()
    }

    fn began(&self) -> f64 {
        self.ida.began()
    }

    fn within(&mut self, time: f64, at: &mut Snapshot<f64>) -> Result<(), ida::Error> {
        self.ida.within(time, at)
    }

    fn fired(&self) -> &[bool] {
        self.ida.fired()
    }

    fn counts(&self) -> Vec<Count> {
        self.ida.counts()
    }
}
