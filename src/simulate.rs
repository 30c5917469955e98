//! From a checked case to a finished run: which arithmetic, which engine, which loop.

use crate::case::{self, Case, Changes, EngineName, NormName, Precision, SolverPlan};
use crate::clearance::Block;
use crate::contact::depth_under;
use crate::dae::{Count, Engine};
use crate::engine::explicit::{self, Explicit};
use crate::engine::ida::{self, Ida};
use crate::mechanism::{BodyObservation, JointObservation, Mechanism};
use crate::model::{Complaint, Complaints, GROUND, Joint, Journals, KeyPath, Model, Owner};
use crate::plane::{Pose, Vector};
use crate::record::{Attribute, Header};
use crate::run::{
    self, AnyRecorder, Checkpoint, Checkpoints, Erased, Kept, NotKept, Reached, Recorder,
    RulingCounts, Schedule, Stretch, Watcher,
};
use crate::scalar::{Dual, F256, Scalar};
use std::convert::Infallible;
use std::error::Error as StdError;
use std::ops::ControlFlow;
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
    /// Whoever keeps the checkpoints asked to stop at one.
    #[error("stopped at the checkpoint at t = {time:e} s")]
    Stopped {
        /// Where it is (s).
        time: f64,
    },
}

impl Error<Infallible> {
    /// The same, of a simulation with another recorder.
    pub fn forget_recorder<R: StdError + 'static>(self) -> Error<R> {
        match self {
            Error::Failed { case, source } => Error::Failed { case, source },
            Error::Interrupted { time } => Error::Interrupted { time },
            Error::Stopped { time } => Error::Stopped { time },
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
    from: Option<String>,
}

impl<'a> Simulation<'a> {
    /// Assembles the mechanism of a case.
    ///
    /// # Errors
    /// Complaints about the mechanism, with the lines of the case file.
    pub fn new(case: &'a Case) -> Result<Self, case::Error> {
        let schedule = case.plan.schedule();
        let mechanism = assemble(case)?;
        let complaints = what_no_run_begins_with(&mechanism);
        if !complaints.is_empty() {
            return Err(case.reject(complaints));
        }
        Ok(Simulation { case, mechanism, schedule, from: None })
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

    /// The same simulation, from a checkpoint on: the text that a recorder was given there.
    pub fn from_checkpoint(mut self, kept: String) -> Self {
        self.from = Some(kept);
        self
    }

    /// Simulates. What is recorded until an error stays recorded; `statistics` are told in either
    /// case.
    ///
    /// # Errors
    /// See [`Error`].
    pub fn run<R: Recorder>(self, recorder: &mut R, watch: Watcher<'_>) -> Ran<R> {
        keeping(self.case, recorder, |recorder| self.simulate(recorder, watch))
    }

    fn simulate(self, recorder: &mut AnyRecorder<'_>, watch: Watcher<'_>) -> Simulated {
        let solver = &self.case.plan.solver;
        let Simulation { case, mechanism, schedule, from } = self;
        let interval = case.plan.checkpoint_interval.as_ref();
        let task = Task {
            case,
            schedule: &schedule,
            tolerance: solver.relative_tolerance,
            checkpoints: interval.map(|every| Checkpoints::new(&case.plan.duration, every)),
            from: from.as_deref(),
        };
        match (solver.engine, solver.precision) {
            _ if is_kinematic(&mechanism) => run_kinematic(&task, mechanism, recorder, watch),
            (EngineName::Ida, _) => {
                let make = |mechanism| Ida::new(mechanism, ida_options(solver));
                carry(&task, mechanism, make, recorder, watch)
            }
            (EngineName::Explicit, Precision::Double) => {
                carry_explicitly(&task, mechanism, recorder, watch)
            }
            (EngineName::Explicit, Precision::Octuple) => match assemble::<F256>(case) {
                Ok(mechanism) => {
                    let task = Task { tolerance: solver.reference_tolerance, ..task };
                    carry_explicitly(&task, mechanism, recorder, watch)
                }
                Err(source) => (Statistics::default(), Err(failed(case, source))),
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
        let allowed = clearance.believed_depth();
        if !(depth <= allowed) {
            let key = Owner::Clearance(k).key(model.names()).key("clearance");
            let law = format!("its contact law means nothing beyond {allowed:.4e} m");
            let [inner, outer] = clearance.surfaces();
            let hint = format!("the start puts the {inner} there");
            complaints.add(key, format!("starts {depth:.4e} m deep in the {outer}: {law}; {hint}"));
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
    let offsets = match case.description.journals {
        Journals::Centred => Vec::new(),
        journals => offsets_under_load(case, journals)?,
    };
    let mechanism = Mechanism::with_journals_at(model, &offsets);
    let mut mechanism = mechanism.map_err(|complaints| case.reject(complaints))?;
    if let Some(share) = &case.plan.disturbance {
        let disturbed = mechanism.disturb_start(share.value());
        disturbed.map_err(|complaints| case.reject(complaints))?;
    }
    Ok(mechanism)
}

/// Where in their bearings journals lie under the forces of the ideal mechanism at t = 0 (m): opposite
/// to the force on each, c deep, or as much deeper as bears it; likewise pins, and blocks (m, rad).
/// What bears nothing is centred. Doubles in any arithmetic, so that it is the same start.
fn offsets_under_load(case: &Case, journals: Journals) -> Result<Vec<[f64; 2]>, case::Error> {
    if case.description.joints.iter().all(|joint| joint.clearance.is_none()) {
        return Ok(Vec::new());
    }
    let ideal = assemble::<f64>(&ideal_case(case)?)?;
    let start = ideal.observe(0.0, &ideal.start().integrals);
    let model = Model::<f64>::new(&case.description).map_err(|told| case.reject(told))?;
    let place = |(joint, observed): (&Joint<f64>, &JointObservation)| {
        let clearance = model.clearances()[joint.clearances.clone()].first()?;
        let deep = |force: f64| match journals {
            Journals::Pressed => depth_under(clearance.normal.elastic(), force),
            Journals::Touching | Journals::Centred => 0.0,
        };
        let force = Vector::new(observed.force[0], observed.force[1]);
        Some(match clearance.wall {
            None => {
                let size = force.norm();
                let none = size == 0.0;
                let offset = force * -((clearance.radial + deep(size)) / size);
                if none { [0.0; 2] } else { [offset.x, offset.y] }
            }
            Some(wall) => {
                let turned = match joint.ends.pair.i {
                    GROUND => 0.0,
                    body => start.bodies[body - 1].angle,
                };
                let across = Pose::new(Vector::zero(), turned).rotate(wall.normal).dot(force);
                match &model.clearances()[joint.clearances.clone()] {
                    [one, other, _, _] => {
                        let length = (one.pair.s_j - other.pair.s_j).norm();
                        let (height, gap) = (2.0 * wall.nominal, clearance.radial);
                        let block = Block { length, height, gap };
                        block.lying(across, observed.moment, deep)
                    }
                    _ if across == 0.0 => [0.0; 2],
                    _ => [-across.signum() * (clearance.radial + deep(across.abs())), 0.0],
                }
            }
        })
    };
    Ok(model.joints().iter().zip(&start.joints).filter_map(place).collect())
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
        // what prescribes everything cannot be disturbed, and copies of a run share their ideal
        let same = case.plan.disturbance.as_ref().map(|_| "run.disturbance=0".to_owned());
        let set =
            doubles.chain(same).chain(more).filter_map(|change| change.parse().ok()).collect();
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

/// Runs a case on the explicit engine in 71-digit arithmetic, at a tolerance of its own and without
/// checkpoints.
pub fn run_reference<R: Recorder>(
    case: &Case,
    mechanism: Mechanism<F256>,
    schedule: &Schedule,
    tolerance: f64,
    recorder: &mut R,
    watch: Watcher<'_>,
) -> Ran<R> {
    let task = Task { case, schedule, tolerance, checkpoints: None, from: None };
    keeping(case, recorder, |recorder| follow(&task, mechanism, recorder, watch))
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
    let task = Task { case, schedule, tolerance, checkpoints: None, from: None };
    keeping(case, recorder, |recorder| follow_tangent::<S>(&task, recorder, watch))
}

fn follow_tangent<S: Scalar>(
    task: &Task<'_>,
    recorder: &mut AnyRecorder<'_>,
    watch: Watcher<'_>,
) -> Simulated {
    let case = task.case;
    let mechanism = assemble::<Dual<S>>(case).and_then(|mut mechanism| {
        let disturbed = mechanism.disturb_start(Dual::new(S::zero(), S::one()));
        disturbed.map_err(|complaints| case.reject(complaints))?;
        Ok(mechanism)
    });
    match mechanism {
        Ok(mechanism) => follow(task, mechanism, recorder, watch),
        Err(source) => (Statistics::default(), Err(failed(case, source))),
    }
}

/// Runs a mechanism without IDA.
fn follow<S: Scalar>(
    task: &Task<'_>,
    mechanism: Mechanism<S>,
    recorder: &mut AnyRecorder<'_>,
    watch: Watcher<'_>,
) -> Simulated {
    match is_kinematic(&mechanism) {
        true => run_kinematic(task, mechanism, recorder, watch),
        false => carry_explicitly(task, mechanism, recorder, watch),
    }
}

/// A simulation that keeps what it tells in a recorder, and ends with that one's error if it fails.
fn keeping<R: Recorder>(
    case: &Case,
    recorder: &mut R,
    simulate: impl FnOnce(&mut AnyRecorder<'_>) -> Simulated,
) -> Ran<R> {
    let mut erased = Erased::new(recorder);
    let (statistics, ran) = simulate(&mut erased);
    let told = |error| match error {
        Error::Failed { case, source } => Error::Failed { case, source },
        Error::Interrupted { time } => Error::Interrupted { time },
        Error::Stopped { time } => Error::Stopped { time },
        Error::Recorder(not_kept) => match erased.failure.take() {
            Some(failure) => Error::Recorder(failure),
            None => failed(case, not_kept),
        },
    };
    (statistics, ran.map_err(told))
}

/// Statistics and outcome with any recorder.
type Simulated = (Statistics, Result<(), Error<NotKept>>);

/// Whether nothing is left to integrate: no freedom and no clearance.
fn is_kinematic<S: Scalar>(mechanism: &Mechanism<S>) -> bool {
    mechanism.freedoms() == 0 && mechanism.modes().is_empty()
}

/// What is to be run.
#[derive(Clone, Copy)]
struct Task<'a> {
    case: &'a Case,
    schedule: &'a Schedule,
    /// Relative tolerance of the engine.
    tolerance: f64,
    checkpoints: Option<Checkpoints>,
    /// The checkpoint that it goes on from.
    from: Option<&'a str>,
}

fn run_kinematic<S: Scalar>(
    task: &Task<'_>,
    mechanism: Mechanism<S>,
    recorder: &mut AnyRecorder<'_>,
    watch: Watcher<'_>,
) -> Simulated {
    in_stretches(task, &mechanism, recorder, |stretch, recorder| {
        let mut mechanism = mechanism.clone();
        let ran = run::kinematic(&mut mechanism, task.schedule, stretch, recorder, watch);
        (Vec::new(), ran.map_err(|error| told(task.case, error)))
    })
}

fn carry_explicitly<S: Scalar>(
    task: &Task<'_>,
    mechanism: Mechanism<S>,
    recorder: &mut AnyRecorder<'_>,
    watch: Watcher<'_>,
) -> Simulated {
    let options = explicit_options(&task.case.plan.solver, task.tolerance);
    let make = |mechanism| Explicit::new(mechanism, options);
    carry(task, mechanism, make, recorder, watch)
}

/// Runs an engine, a new one from each checkpoint on, if it can be made.
fn carry<S, E>(
    task: &Task<'_>,
    mechanism: Mechanism<S>,
    make: impl Fn(Mechanism<S>) -> Result<E, E::Error>,
    recorder: &mut AnyRecorder<'_>,
    watch: Watcher<'_>,
) -> Simulated
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
{
    let Task { case, schedule, tolerance, .. } = *task;
    in_stretches(task, &mechanism, recorder, |stretch, recorder| match make(mechanism.clone()) {
        Ok(mut engine) => {
            let ran = run::stretch(&mut engine, schedule, stretch, tolerance, recorder, watch);
            (engine.counts(), ran.map_err(|error| told(case, error)))
        }
        Err(source) => (Vec::new(), Err(failed(case, source))),
    })
}

/// What the engine of a stretch counted, and what the stretch has come to.
type Leg<S> = (Vec<Count>, Result<Reached<S>, Error<NotKept>>);

/// Runs from checkpoint to checkpoint, each stretch from what is kept at the last alone.
fn in_stretches<S: Scalar>(
    task: &Task<'_>,
    mechanism: &Mechanism<S>,
    recorder: &mut AnyRecorder<'_>,
    mut leg: impl FnMut(&Stretch<'_, S>, &mut AnyRecorder<'_>) -> Leg<S>,
) -> Simulated {
    let from = task.from.map(|text| Checkpoint::from_text(text, mechanism)).transpose();
    let mut from = match from {
        Ok(from) => from,
        Err(source) => return (Statistics::default(), Err(failed(task.case, source))),
    };
    loop {
        let number = from.as_ref().map_or(1, |kept| kept.number() + 1);
        let until = task.checkpoints.and_then(|checkpoints| checkpoints.time(number));
        let (mut engine, reached) = leg(&Stretch { from: from.as_ref(), until }, recorder);
        let before = from.iter().flat_map(Checkpoint::work);
        engine.iter_mut().zip(before).for_each(|(count, before)| count.value += before);
        let kept = match reached {
            Ok(Reached::Checkpoint(kept)) => kept,
            Ok(Reached::End(counts)) => return (statistics(engine, counts), Ok(())),
            Err(error) => return (statistics(engine, RulingCounts::default()), Err(error)),
        };
        let kept = kept.with(number, engine.iter().map(|count| count.value).collect());
        let time = kept.time().to_f64();
        match recorder.checkpoint(&Kept { number, time, text: kept.to_text() }) {
            Ok(ControlFlow::Continue(())) => from = Some(kept),
            stopped => {
                let error = stopped.map_or_else(Error::Recorder, |_| Error::Stopped { time });
                return (statistics(engine, RulingCounts::default()), Err(error));
            }
        }
    }
}

/// The error of a simulation that could not begin.
fn failed<R: StdError>(case: &Case, source: impl StdError + Send + Sync + 'static) -> Error<R> {
    Error::Failed { case: case.name.clone(), source: Box::new(source) }
}

/// The error of a simulation whose run has this one.
fn told<E, R>(case: &Case, error: run::Error<E, R>) -> Error<R>
where
    E: StdError + Send + Sync + 'static,
    R: StdError + Send + Sync + 'static,
{
    match error {
        run::Error::Recorder(source) => Error::Recorder(source),
        run::Error::Interrupted { time } => Error::Interrupted { time },
        error => failed(case, error),
    }
}

/// Statistics of a run, whatever engine it had.
fn statistics(engine: Vec<Count>, counts: RulingCounts) -> Statistics {
    let rulings = vec![
        Count { name: "minimum_impact_rate", value: counts.slow_approaches },
        Count { name: "tension", value: counts.tensions },
    ];
    Statistics { engine, rulings }
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
        points: names.points,
        memories: names.memories,
        sundials_version: ida::sundials_version(),
        started_utc,
        samples: match case.plan.checkpoint_interval {
            None => Some(case.plan.schedule().len()),
            Some(_) => None,
        },
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
    if mechanism.redundant() > 0 {
        let held = mechanism.redundantly_held();
        let held: Vec<String> = held.iter().map(|owner| owner.name(model.names())).collect();
        let count = Attribute::from(mechanism.redundant() as i64);
        attributes.push(("redundant_constraints".to_owned(), count));
        let ruling = format!("{} hold each other: forces of least norm", held.join(", "));
        attributes.push(("ruling_redundant_forces".to_owned(), Attribute::from(ruling)));
    }
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
        let described = case.description.clearance(name);
        let nominal = described.and_then(|clearance| clearance.normal.nominal_restitution());
        attributes
            .extend(nominal.map(|e| (format!("nominal_restitution_{name}"), Attribute::from(e))));
    }
    attributes
}
