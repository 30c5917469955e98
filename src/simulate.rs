//! From a checked case to a finished run: which arithmetic, which engine, which loop.

use crate::case::{self, Case, Changes, EngineName, NormName, Precision, Sampling, SolverPlan};
use crate::dae::{Count, Engine};
use crate::engine::explicit::{self, Explicit};
use crate::engine::ida::{self, Ida};
use crate::mechanism::{BodyObservation, Mechanism};
use crate::model::{Complaint, Complaints, KeyPath, Model};
use crate::record::{Attribute, Header};
use crate::run::{self, Recorder, RulingCounts, Schedule, Watcher};
use crate::scalar::{Dual, F256, Scalar};
use std::convert::Infallible;
use std::error::Error as StdError;
use std::path::PathBuf;

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

impl Error<Infallible> {
    /// The same, of a simulation with another recorder.
    pub fn forget_recorder<R: StdError + 'static>(self) -> Error<R> {
        match self {
            Error::Failed { case, source } => Error::Failed { case, source },
            Error::Interrupted { time } => Error::Interrupted { time },
            Error::Recorder(never) => match never {},
        }
    }
}

/// What a finished simulation tells of itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Statistics {
    /// Counts of the engine.
    pub engine: Vec<Count>,
    /// How often the decisions were called on.
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
        let schedule = Schedule::new(&case.plan.duration, &case.plan.sample_interval);
        let schedule = match case.plan.sampling {
            Sampling::Uniform => schedule,
            Sampling::Adaptive => schedule.adaptive(),
        };
        let mechanism = assemble(case)?;
        let complaints = what_no_run_begins_with(&mechanism);
        if !complaints.is_empty() {
            return Err(case.reject(complaints));
        }
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

    /// The same simulation, sampled at these times (s) and nowhere else; see [`Schedule::at`]. The
    /// trajectory does not depend on them.
    pub fn sampled_at(mut self, times: Vec<f64>) -> Self {
        self.schedule = self.schedule.at(times);
        self
    }

    /// Simulates. What is recorded until an error stays recorded; `statistics` are told in either
    /// case.
    ///
    /// # Errors
    /// See [`Error`].
    pub fn run<R: Recorder>(self, recorder: &mut R, watch: Watcher<'_>) -> Ran<R> {
        let solver = &self.case.plan.solver;
        let Simulation { case, mechanism, schedule } = self;
        match (solver.engine, solver.precision) {
            _ if is_kinematic(&mechanism) => {
                run_kinematic(case, mechanism, &schedule, recorder, watch)
            }
            (EngineName::Ida, _) => {
                let engine = Ida::new(mechanism, ida_options(solver));
                carry(case, engine, &schedule, solver.relative_tolerance, recorder, watch)
            }
            (EngineName::Explicit, Precision::Double) => {
                let options = explicit_options(solver, solver.relative_tolerance);
                let engine = Explicit::new(mechanism, options);
                carry(case, engine, &schedule, solver.relative_tolerance, recorder, watch)
            }
            (EngineName::Explicit, Precision::Octuple) => match assemble(case) {
                Ok(mechanism) => {
                    let tolerance = solver.reference_tolerance;
                    run_reference(case, mechanism, &schedule, tolerance, recorder, watch)
                }
                Err(source) => failed::<R>(case, source),
            },
        }
    }
}

/// What of an assembled start no run can begin with: journals beyond all that their contact law can
/// mean, and what is no number.
fn what_no_run_begins_with(mechanism: &Mechanism<f64>) -> Vec<Complaint> {
    let integrals = &mechanism.start().integrals;
    let start = mechanism.observe(0.0, integrals);
    let mut complaints = Complaints::default();
    let model = mechanism.model();
    for (k, clearance) in model.clearances().iter().enumerate() {
        let depth = start.clearances[k].penetration;
        let allowed = clearance.maximum_penetration * clearance.journal_radius;
        if !(depth <= allowed) {
            let key = KeyPath::new(["joints", &model.names().clearances[k], "clearance"]);
            let law = format!("its contact law means nothing beyond {allowed:.4e} m");
            let hint = "the start puts the journal there";
            complaints.add(key, format!("starts {depth:.4e} m deep in the bearing: {law}; {hint}"));
        }
    }
    let forces =
        start.joints.iter().flat_map(|joint| [joint.force[0], joint.force[1], joint.moment]);
    let motions = start.bodies.iter().flat_map(|body| {
        let BodyObservation { position: [x, y], velocity: [u, v], acceleration: [a, b], .. } =
            *body;
        [x, y, u, v, a, b, body.angle, body.angular_velocity, body.angular_acceleration]
    });
    let numbers = [
        ("positions, velocities and accelerations", motions.collect::<Vec<_>>()),
        ("forces", forces.chain(start.drive_torques.iter().copied()).collect()),
        ("energies", vec![start.energy.kinetic, start.energy.potential, start.energy.elastic]),
    ];
    for (what, numbers) in numbers {
        if complaints.is_empty() && numbers.iter().any(|number| !number.is_finite()) {
            let reason = "a number of the case is far too large or too small";
            complaints.add(KeyPath::new(["start"]), format!("{what} are not finite: {reason}"));
        }
    }
    complaints.into_vec()
}

/// Statistics and outcome of a simulation.
pub type Ran<R> = (Statistics, Result<(), Error<<R as Recorder>::Error>>);

/// The mechanism of a case, assembled in the arithmetic `S`.
///
/// # Errors
/// Complaints about the mechanism, with the lines of the case file.
pub fn assemble<S: Scalar>(case: &Case) -> Result<Mechanism<S>, case::Error> {
    let model = Model::new(&case.description).map_err(|complaints| case.reject(complaints))?;
    Mechanism::new(model).map_err(|complaints| case.reject(complaints))
}

/// A case without its clearances, in doubles. A start that is fixed and goes together with
/// clearances only is let go where the drives prescribe the ideal mechanism: it then chooses no
/// more than the branch.
///
/// # Errors
/// What is wrong with the ideal mechanism.
pub fn ideal_case(case: &Case) -> Result<Case, case::Error> {
    let path = PathBuf::from(format!("{}.toml", case.name));
    let changed = |more: &mut dyn Iterator<Item = String>| {
        let doubles = std::iter::once("solver.precision=16".to_owned());
        let set = doubles.chain(more).filter_map(|change| change.parse().ok()).collect();
        Case::from_text(&path, &case.text, &Changes { set, ideal: true })
    };
    let ideal = changed(&mut std::iter::empty())?;
    let Err(why) = assemble::<f64>(&ideal) else { return Ok(ideal) };
    let fixed = case.description.start.iter().filter(|start| start.fixed);
    let ideal = changed(&mut fixed.map(|start| format!("start.{}.fixed=false", start.body)))?;
    match assemble::<f64>(&ideal) {
        Ok(mechanism) if mechanism.freedoms() == 0 => Ok(ideal),
        _ => Err(why),
    }
}

/// Runs a case on the explicit engine in 71-digit arithmetic, at a tolerance of its own.
pub fn run_reference<R: Recorder>(
    case: &Case,
    mechanism: Mechanism<F256>,
    schedule: &Schedule,
    tolerance: f64,
    recorder: &mut R,
    watch: Watcher<'_>,
) -> Ran<R> {
    if is_kinematic(&mechanism) {
        return run_kinematic(case, mechanism, schedule, recorder, watch);
    }
    let engine = Explicit::new(mechanism, explicit_options(&case.plan.solver, tolerance));
    carry(case, engine, schedule, tolerance, recorder, watch)
}

/// Carries a tangent along: the explicit engine in dual numbers over the arithmetic `S`, whose
/// derivative is that by a change of the start ([`Mechanism::disturb_start`]). What an observation knows
/// [`beyond`](crate::mechanism::Observation::beyond) its doubles is then the tangent.
pub fn run_tangent<S: Scalar, R: Recorder>(
    case: &Case,
    schedule: &Schedule,
    tolerance: f64,
    recorder: &mut R,
    watch: Watcher<'_>,
) -> Ran<R> {
    let mechanism = assemble::<Dual<S>>(case).and_then(|mut mechanism| {
        let disturbed = mechanism.disturb_start(Dual::new(S::zero(), S::one()));
        disturbed.map_err(|complaints| case.reject(complaints))?;
        Ok(mechanism)
    });
    match mechanism {
        Ok(mechanism) if is_kinematic(&mechanism) => {
            run_kinematic(case, mechanism, schedule, recorder, watch)
        }
        Ok(mechanism) => {
            let engine = Explicit::new(mechanism, explicit_options(&case.plan.solver, tolerance));
            carry(case, engine, schedule, tolerance, recorder, watch)
        }
        Err(source) => failed::<R>(case, source),
    }
}

/// Whether nothing is left to integrate: no freedom and no clearance.
fn is_kinematic<S: Scalar>(mechanism: &Mechanism<S>) -> bool {
    mechanism.freedoms() == 0 && mechanism.modes().is_empty()
}

fn run_kinematic<S: Scalar, R: Recorder>(
    case: &Case,
    mut mechanism: Mechanism<S>,
    schedule: &Schedule,
    recorder: &mut R,
    watch: Watcher<'_>,
) -> Ran<R> {
    let ran = run::kinematic(&mut mechanism, schedule, recorder, watch);
    finish(case, Vec::new(), ran)
}

/// Runs an engine, if it could be made.
fn carry<S, E, R>(
    case: &Case,
    engine: Result<E, E::Error>,
    schedule: &Schedule,
    tolerance: f64,
    recorder: &mut R,
    watch: Watcher<'_>,
) -> Ran<R>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
    R: Recorder,
{
    match engine {
        Ok(mut engine) => {
            let ran = run::run(&mut engine, schedule, tolerance, recorder, watch);
            finish(case, engine.counts(), ran)
        }
        Err(source) => failed::<R>(case, source),
    }
}

/// The outcome of a simulation that could not begin.
fn failed<R: Recorder>(case: &Case, source: impl StdError + Send + Sync + 'static) -> Ran<R> {
    let error = Error::Failed { case: case.name.clone(), source: Box::new(source) };
    (Statistics::default(), Err(error))
}

/// Statistics and outcome of a run, whatever engine it had.
fn finish<E, R>(
    case: &Case,
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
        failed => Error::Failed { case: case.name.clone(), source: Box::new(failed) },
    });
    (Statistics { engine, rulings }, outcome)
}

/// How the explicit engine is to solve, from the plan of a case.
pub fn explicit_options(plan: &SolverPlan, tolerance: f64) -> explicit::Options {
    explicit::Options { tolerance, max_step: plan.max_step, ..explicit::Options::default() }
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

/// Solver settings and decisions, by the names they have in result files.
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
        attributes.push((
            format!("ruling_maximum_penetration_{name}"),
            Attribute::from(clearance.maximum_penetration),
        ));
    }
    attributes
}
