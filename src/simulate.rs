//! From a checked case to a finished run: which arithmetic, which engine, which loop.

use crate::case::{self, Case, EngineName, NormName, Sampling, SolverPlan};
use crate::dae::{Count, Engine};
use crate::engine::ida::{self, Ida};
use crate::mechanism::Mechanism;
use crate::model::Model;
use crate::record::{Attribute, Header};
use crate::run::{self, Recorder, RulingCounts, Schedule, Watcher};
use std::error::Error as StdError;

/// Why a simulation did not finish.
#[derive(Debug, thiserror::Error)]
pub enum Error<R: StdError + 'static> {
    /// The mechanism or the engine gave up.
    #[error("case \"{case}\" stopped")]
    Failed {
        /// Name of the case.
        case: String,
        /// What gave up, and where.
        source: Box<dyn StdError + Send + Sync>,
    },
    /// What was to be kept could not be.
    #[error(transparent)]
    Recorder(R),
    /// Whoever watched asked to stop.
    #[error("interrupted at t = {time:e} s")]
    Interrupted {
        /// Where the run stood (s).
        time: f64,
    },
}

/// What a finished simulation tells of itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Statistics {
    /// Counts of the engine.
    pub engine: Vec<Count>,
    /// Counts of the rulings.
    pub rulings: Vec<Count>,
}

/// A case made ready: assembled, and its schedule drawn up.
#[derive(Debug)]
pub struct Simulation<'a> {
    case: &'a Case,
    mechanism: Mechanism<f64>,
    schedule: Schedule,
}

impl<'a> Simulation<'a> {
    /// Assembles the mechanism of a case.
    ///
    /// # Errors
    /// Complaints about the mechanism, with the lines of the case file.
    pub fn new(case: &'a Case) -> Result<Self, case::Error> {
        let model = Model::new(&case.description).map_err(|complaints| case.reject(complaints))?;
        let mechanism = Mechanism::new(model).map_err(|complaints| case.reject(complaints))?;
        let schedule = Schedule::new(&case.plan.duration, &case.plan.sample_interval);
        let schedule = match case.plan.sampling {
            Sampling::Uniform => schedule,
            Sampling::Adaptive => schedule.adaptive(),
        };
        Ok(Simulation { case, mechanism, schedule })
    }

    /// The assembled mechanism.
    pub fn mechanism(&self) -> &Mechanism<f64> {
        &self.mechanism
    }

    /// When samples are taken.
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// The same simulation, sampled at exactly these times (s): one or more, strictly increasing,
    /// none negative, none beyond the case's duration. The trajectory does not depend on them.
    pub fn sampled_at(mut self, times: Vec<f64>) -> Self {
        self.schedule = self.schedule.at(times);
        self
    }

    /// Simulates. What is recorded until an error stays recorded; `statistics` are told in either
    /// case.
    ///
    /// # Errors
    /// See [`Error`].
    pub fn run<R: Recorder>(
        self,
        recorder: &mut R,
        watch: Watcher<'_>,
    ) -> (Statistics, Result<(), Error<R::Error>>) {
        let mut mechanism = self.mechanism;
        let name = self.case.name.clone();
        if mechanism.freedoms() == 0 && mechanism.modes().is_empty() {
            let ran = run::kinematic(&mut mechanism, &self.schedule, recorder, watch);
            return finish(&name, Vec::new(), ran);
        }
        let mut engine = match Ida::new(mechanism, ida_options(&self.case.plan.solver)) {
            Ok(engine) => engine,
            Err(source) => {
                let failed = Error::Failed { case: name, source: Box::new(source) };
                return (Statistics::default(), Err(failed));
            }
        };
        let tolerance = self.case.plan.solver.relative_tolerance;
        let ran = run::run(&mut engine, &self.schedule, tolerance, recorder, watch);
        finish(&name, engine.counts(), ran)
    }
}

/// Statistics and outcome of a run, whatever engine it had.
fn finish<E, R>(
    name: &str,
    engine: Vec<Count>,
    ran: Result<RulingCounts, run::Error<E, R>>,
) -> (Statistics, Result<(), Error<R>>)
where
    E: StdError + Send + Sync + 'static,
    R: StdError + Send + Sync + 'static,
{
    let counts = ran.as_ref().copied().unwrap_or_default();
    let rulings = vec![
        Count { name: "minimum_impact_rate", value: counts.slow_approaches },
        Count { name: "tension", value: counts.tensions },
    ];
    let outcome = ran.map(|_| ()).map_err(|error| match error {
        run::Error::Recorder(source) => Error::Recorder(source),
        run::Error::Interrupted { time } => Error::Interrupted { time },
        failed => Error::Failed { case: name.to_owned(), source: Box::new(failed) },
    });
    (Statistics { engine, rulings }, outcome)
}

/// How IDA is to solve, from the plan of a case.
pub fn ida_options(plan: &SolverPlan) -> ida::Options {
    ida::Options {
        relative_tolerance: plan.relative_tolerance,
        absolute_tolerance: match plan.absolute_tolerance {
            case::AbsoluteTolerance::Scalar(tolerance) => ida::AbsoluteTolerance::Scalar(tolerance),
            case::AbsoluteTolerance::Scaled => ida::AbsoluteTolerance::Scaled,
        },
        initial_step: plan.initial_step,
        max_step: plan.max_step,
        norm: match plan.norm {
            NormName::Ode15s => ida::Norm::Ode15s,
            NormName::Wrms => ida::Norm::Wrms,
        },
        stock_vector_operations: false,
    }
}

/// The header of a case's result file.
pub fn header(case: &Case, mechanism: &Mechanism<f64>, started_utc: String) -> Header {
    let names = mechanism.model().names().clone();
    Header {
        name: case.name.clone(),
        title: case.title.clone(),
        case_text: case.text.clone(),
        attributes: attributes(case, mechanism),
        bodies: names.bodies,
        joints: names.joints,
        clearances: names.clearances,
        drives: names.drives,
        sundials_version: ida::sundials_version(),
        started_utc,
    }
}

/// Solver settings and rulings, by the names they have in result files.
fn attributes(case: &Case, mechanism: &Mechanism<f64>) -> Vec<(String, Attribute)> {
    let solver = &case.plan.solver;
    let name_of = |engine: EngineName| {
        EngineName::ALL.iter().find(|(_, known)| *known == engine).map_or("", |(name, _)| *name)
    };
    let norm = NormName::ALL.iter().find(|(_, known)| *known == solver.norm);
    let absolute = match solver.absolute_tolerance {
        case::AbsoluteTolerance::Scalar(tolerance) => Attribute::from(tolerance),
        case::AbsoluteTolerance::Scaled => Attribute::from("scaled"),
    };
    let mut attributes = vec![
        ("engine".to_owned(), Attribute::from(name_of(solver.engine))),
        ("relative_tolerance".to_owned(), Attribute::from(solver.relative_tolerance)),
        ("absolute_tolerance".to_owned(), absolute),
        ("initial_step".to_owned(), Attribute::from(solver.initial_step)),
        ("max_step".to_owned(), Attribute::from(solver.max_step)),
        ("norm".to_owned(), Attribute::from(norm.map_or("", |(name, _)| *name))),
    ];
    let model = mechanism.model();
    for (name, clearance) in model.names().clearances.iter().zip(model.clearances()) {
        let tension = if clearance.cut_tension { "cut" } else { "keep" };
        attributes.push((format!("ruling_tension_{name}"), Attribute::from(tension)));
        attributes.push((
            format!("ruling_minimum_impact_rate_{name}"),
            Attribute::from(clearance.minimum_impact_rate),
        ));
    }
    attributes
}
