//! How long a case runs, what it samples, and how it is solved.

use super::table_reader::TableReader;
use crate::course;
use crate::model::{Complaint, Complaints, Description, KeyPath};
use crate::run::{SampleWindow, Schedule};
use crate::scalar::{Decimal, F256, Scalar};

/// Rows of samples that a run may write at most.
const MOST_SAMPLES: f64 = 1e8;

/// Checkpoints that a run may have at most.
const MOST_CHECKPOINTS: f64 = 1e4;

/// Share by which a start may be changed at most: more of it is another start.
const LARGEST_DISTURBANCE: f64 = 0.1;

/// Smallest relative tolerance of an engine that computes in doubles.
const SMALLEST_RELATIVE_TOLERANCE: f64 = 1e-15;

/// Smallest tolerance of the engine that computes with 71 digits; extrapolation needs some to
/// spare.
const SMALLEST_REFERENCE_TOLERANCE: f64 = 1e-64;

/// Largest tolerance of the explicit engine, in either arithmetic.
const LARGEST_EXPLICIT_TOLERANCE: f64 = 1e-2;

/// How a case is run: keys `run` and `solver`.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Simulated time (s).
    pub duration: Decimal,
    /// Revolutions of the first drive that it is given by, where it is.
    revolutions: Option<Decimal>,
    /// Time between samples (s).
    pub sample_interval: Decimal,
    /// Parts of the run that have samples at intervals of their own.
    pub windows: Vec<SampleWindow>,
    /// Where samples are taken.
    pub sampling: Sampling,
    /// Time between checkpoints (s); `None` without any.
    pub checkpoint_interval: Option<Decimal>,
    /// Share by which the start is changed ([`disturb_start`](crate::mechanism::Mechanism::disturb_start));
    /// `None` leaves it.
    pub disturbance: Option<Decimal>,
    /// How it is solved.
    pub solver: SolverPlan,
}

/// Where samples are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// At multiples of the sample interval.
    Uniform,
    /// There, and at every event, every peak, and where straight lines miss the forces.
    Adaptive,
}

impl Sampling {
    /// Every sampling, with its name in case files.
    pub const ALL: [(&'static str, Sampling); 2] =
        [("uniform", Sampling::Uniform), ("adaptive", Sampling::Adaptive)];
}

/// How a case is solved.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverPlan {
    /// Which engine.
    pub engine: EngineName,
    /// Relative tolerance.
    pub relative_tolerance: f64,
    /// Absolute tolerance.
    pub absolute_tolerance: AbsoluteTolerance,
    /// First step after every restart (s).
    pub initial_step: f64,
    /// Longest step (s); may be infinite.
    pub max_step: f64,
    /// Arithmetic.
    pub precision: Precision,
    /// Tolerance of the engine in 71-digit arithmetic, in place of the relative one.
    pub reference_tolerance: f64,
    /// Norm of the local error.
    pub norm: NormName,
}

/// Names of the engines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EngineName {
    /// SUNDIALS IDA.
    Ida,
    /// Explicit, of high order.
    Explicit,
}

impl EngineName {
    /// Every engine, with its name in case files.
    pub const ALL: [(&'static str, EngineName); 2] =
        [("ida", EngineName::Ida), ("explicit", EngineName::Explicit)];
}

/// Absolute tolerance of the unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AbsoluteTolerance {
    /// One number for all, in the unit of each unknown.
    Scalar(f64),
    /// 0.01 · relative tolerance · typical size of each unknown.
    Scaled,
}

/// The arithmetic of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Doubles, 16 digits.
    Double,
    /// Floats of 71 digits.
    Octuple,
}

/// Norms of the local error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormName {
    /// Largest component against max(relative tolerance · |y|, absolute tolerance), as MATLAB's
    /// ode15s has it.
    Ode15s,
    /// Weighted root mean square, IDA's own.
    Wrms,
}

impl NormName {
    /// Every norm, with its name in case files.
    pub const ALL: [(&'static str, NormName); 2] =
        [("ode15s", NormName::Ode15s), ("wrms", NormName::Wrms)];
}

impl Plan {
    /// Reads the keys `run` and `solver` of a case's root.
    pub(super) fn read(root: &mut TableReader) -> Plan {
        let (
            revolutions,
            duration,
            sample_interval,
            windows,
            sampling,
            checkpoint_interval,
            disturbance,
        ) = root.table("run", |keys| {
            let revolutions: Option<Decimal> = keys.optional("revolutions", "");
            let duration = match revolutions {
                Some(_) => keys.optional("duration", "s"),
                None => Some(keys.required("duration", "s")),
            };
            (
                revolutions,
                duration,
                keys.required("sample_interval", "s"),
                keys.list_of_tables("window", window),
                keys.choice("sampling", &Sampling::ALL, Some("uniform")),
                keys.optional("checkpoint_interval", "s"),
                keys.optional("disturbance", ""),
            )
        });
        Plan {
            duration: duration.unwrap_or_else(|| Decimal::from(f64::NAN)),
            revolutions,
            sample_interval,
            windows,
            sampling: sampling.unwrap_or(Sampling::Uniform),
            checkpoint_interval,
            disturbance,
            solver: root.table_of_defaults("solver", SolverPlan::read),
        }
    }

    /// Finds the duration where it is given in revolutions, rounded to a double. Tells what is in the
    /// way.
    pub(super) fn settle(&mut self, description: &Description) -> Option<Complaint> {
        let revolutions = self.revolutions.as_ref()?;
        let key = KeyPath::new(["run", "revolutions"]);
        let mut complaints = Complaints::default();
        if !complaints.require_positive(key.clone(), revolutions, "") {
            return complaints.into_vec().pop();
        }
        let complain =
            |message: &str| Some(Complaint { key: key.clone(), message: message.into() });
        if !self.duration.to_f64().is_nan() {
            return complain("the duration is given too: one of the two says how long the run is");
        }
        let period = description.drives.first().and_then(|drive| {
            let given = |kind, key| drive.part.is(kind).then(|| drive.part.decimal(key)).flatten();
            let turn = given("speed", "speed_rpm").map(|rpm| F256::from(60) / rpm.value::<F256>());
            let swing = given("harmonic", "angular_frequency")
                .map(|rate| F256::from(2) * F256::pi() / rate.value::<F256>());
            turn.or(swing).map(Scalar::abs)
        });
        let Some(period) = period.filter(|period| period.to_f64().is_finite()) else {
            return complain(
                "needs a first drive that turns at a constant speed, or swings as \"harmonic\" has it",
            );
        };
        self.duration = Decimal::from((revolutions.value::<F256>() * period).to_f64());
        None
    }

    /// When samples are taken.
    pub fn schedule(&self) -> Schedule {
        let (duration, interval) = (&self.duration, &self.sample_interval);
        let schedule = Schedule::with_windows(duration, interval, &self.windows);
        match self.sampling {
            Sampling::Uniform => schedule,
            Sampling::Adaptive => schedule.adaptive(),
        }
    }

    /// What is wrong with the numbers of the plan.
    pub(super) fn check(&self) -> Vec<Complaint> {
        let mut complaints = Complaints::default();
        // revolutions that come to no duration have been complained about
        if self.revolutions.is_none() || !self.duration.to_f64().is_nan() {
            self.check_samples(&mut complaints);
            self.check_checkpoints(&mut complaints);
        }
        if let Some(share) = &self.disturbance
            && !(share.to_f64().abs() <= LARGEST_DISTURBANCE)
        {
            let key = KeyPath::new(["run", "disturbance"]);
            let limit = format!("must be from -{LARGEST_DISTURBANCE} to {LARGEST_DISTURBANCE}");
            complaints.add(key, format!("{limit}, a share of the start, is {share}"));
        }
        self.solver.check_tolerances(&mut complaints);
        self.solver.check_steps(&mut complaints, self.first_sample());
        complaints.into_vec()
    }

    /// What drives prescribe by tables is there for the whole run.
    pub(super) fn check_tables(&self, description: &Description) -> Vec<Complaint> {
        let mut complaints = Complaints::default();
        let clock: F256 = description.clock.as_ref().map_or(F256::from(0), Decimal::value);
        let end = clock + self.duration.value::<F256>();
        let tables = description.drives.iter().filter(|drive| drive.part.is(course::TABLE));
        for drive in tables {
            let times = drive.part.numbers("times");
            let [Some(first), Some(last)] = [times.first(), times.last()] else { continue };
            let key = KeyPath::new(["drives", &drive.name, "times"]);
            if first.value::<F256>() > clock {
                let begin = clock.to_f64();
                let message =
                    format!("begin at {first} s: a drive needs values from t = {begin} on");
                complaints.add(key, message);
            } else if end > last.value() {
                let run = format!("the run ends at {} s", end.to_f64());
                let message =
                    format!("end at {last} s, and {run}: a drive needs values until then");
                complaints.add(key, message);
            }
        }
        complaints.into_vec()
    }

    /// Time of the first sample behind the start (s).
    fn first_sample(&self) -> f64 {
        self.sample_interval.to_f64().min(self.duration.to_f64())
    }

    fn check_checkpoints(&self, complaints: &mut Complaints) {
        let Some(interval) = &self.checkpoint_interval else { return };
        let key = KeyPath::new(["run", "checkpoint_interval"]);
        let many = self.duration.to_f64() / interval.to_f64();
        if complaints.require_positive(key.clone(), interval, "s") && many > MOST_CHECKPOINTS {
            let limit = format!("at most {MOST_CHECKPOINTS:e} are kept, a file each");
            let many = format!("a run of {} s would have {many:.3e} checkpoints", self.duration);
            complaints.add(key, format!("is too small (s), {interval}: {many}, {limit}"));
        }
    }

    fn check_samples(&self, complaints: &mut Complaints) {
        let run = KeyPath::new(["run"]);
        let (duration, interval) = (&self.duration, &self.sample_interval);
        let duration_right = complaints.require_positive(run.key("duration"), duration, "s");
        let key = run.key("sample_interval");
        let interval_right = complaints.require_positive(key.clone(), interval, "s");
        let limit = format!("at most {MOST_SAMPLES:e} are written");
        let rows = duration.to_f64() / interval.to_f64();
        if duration_right && interval_right && rows > MOST_SAMPLES {
            let rows = format!("a run of {duration} s would write {rows:.3e} rows of samples");
            complaints.add(key, format!("is too small (s), {interval}: {rows}, {limit}"));
        }
        let before = complaints.len();
        self.check_windows(complaints, interval_right);
        let span = |w: &SampleWindow| (w.to.to_f64() - w.from.to_f64()) / w.interval.to_f64();
        let rows: f64 = self.windows.iter().map(span).sum();
        if complaints.len() == before && rows > MOST_SAMPLES {
            let rows = format!("have {rows:.3e} rows of samples");
            complaints.add(run.key("window"), format!("{rows} together, {limit}"));
        }
    }

    /// Windows are in order by themselves, denser than the rest, and apart from each other.
    fn check_windows(&self, complaints: &mut Complaints, interval_right: bool) {
        for (k, window) in self.windows.iter().enumerate() {
            let key = KeyPath::new(["run", "window"]).key((k + 1).to_string());
            let SampleWindow { from, to, interval } = window;
            let begins = |x: f64| x >= 0.0;
            complaints.require(key.key("from"), from, "s", "zero or positive", begins);
            if complaints.require_finite(key.key("to"), to, "s") && !(to.to_f64() > from.to_f64()) {
                let message = format!("must be greater than from, {from} (s), is {to}");
                complaints.add(key.key("to"), message);
            }
            let around = &self.sample_interval;
            if complaints.require_positive(key.key("interval"), interval, "s")
                && interval_right
                && interval.to_f64() > around.to_f64()
            {
                let message = format!("must be at most run.sample_interval, {around} (s)");
                complaints.add(key.key("interval"), format!("{message}, is {interval}"));
            }
            let overlaps = |other: &SampleWindow| {
                from.to_f64() < other.to.to_f64() && other.from.to_f64() < to.to_f64()
            };
            if let Some(other) = self.windows[..k].iter().position(overlaps) {
                let SampleWindow { from, to, .. } = &self.windows[other];
                let which = format!("window {} (from {from} to {to} s)", other + 1);
                complaints.add(key, format!("overlaps {which}: windows must be apart"));
            }
        }
    }
}

fn window(keys: &mut TableReader) -> SampleWindow {
    SampleWindow {
        from: keys.required("from", "s"),
        to: keys.required("to", "s"),
        interval: keys.required("interval", "s"),
    }
}

impl SolverPlan {
    fn read(keys: &mut TableReader) -> SolverPlan {
        let engine = keys.choice("engine", &EngineName::ALL, Some("ida"));
        let scalar = |number: Decimal| AbsoluteTolerance::Scalar(number.to_f64());
        let words = [("scaled", AbsoluteTolerance::Scaled)];
        let absolute =
            keys.number_or_choice("absolute_tolerance", "", &words, Some("1e-20"), scalar);
        let norm = keys.choice("norm", &NormName::ALL, Some("ode15s"));
        SolverPlan {
            precision: precision(keys, engine),
            engine: engine.unwrap_or(EngineName::Ida),
            relative_tolerance: keys.number_or("relative_tolerance", "", "1e-12").to_f64(),
            absolute_tolerance: absolute.unwrap_or(AbsoluteTolerance::Scaled),
            initial_step: keys.number_or("initial_step", "s", "1e-10").to_f64(),
            max_step: keys.number_or("max_step", "s", "inf").to_f64(),
            reference_tolerance: keys.number_or("reference_tolerance", "", "1e-60").to_f64(),
            norm: norm.unwrap_or(NormName::Ode15s),
        }
    }

    fn check_tolerances(&self, complaints: &mut Complaints) {
        let solver = KeyPath::new(["solver"]);
        let mut require = |name: &str, number: f64, least: f64| {
            let range = format!("at least {least:e} and less than 1");
            let holds = |x: f64| x >= least && x < 1.0;
            complaints.require(solver.key(name), &Decimal::from(number), "", &range, holds);
        };
        require("relative_tolerance", self.relative_tolerance, SMALLEST_RELATIVE_TOLERANCE);
        require("reference_tolerance", self.reference_tolerance, SMALLEST_REFERENCE_TOLERANCE);
        let (name, used) = match self.precision {
            Precision::Double => ("relative_tolerance", self.relative_tolerance),
            Precision::Octuple => ("reference_tolerance", self.reference_tolerance),
        };
        if self.engine == EngineName::Explicit && used > LARGEST_EXPLICIT_TOLERANCE && used < 1.0 {
            let range = format!("at most {LARGEST_EXPLICIT_TOLERANCE:e} for engine \"explicit\"");
            complaints.add(solver.key(name), format!("must be {range}, is {used}"));
        }
        if let AbsoluteTolerance::Scalar(tolerance) = self.absolute_tolerance {
            let (key, range) = (solver.key("absolute_tolerance"), "greater than 0 and less than 1");
            let holds = |x: f64| x > 0.0 && x < 1.0;
            complaints.require(key, &Decimal::from(tolerance), "", range, holds);
        }
    }

    /// `first` is the time of the first sample (s): steps that it swallows lead nowhere.
    fn check_steps(&self, complaints: &mut Complaints, first: f64) {
        let solver = KeyPath::new(["solver"]);
        for (name, step) in [("initial_step", self.initial_step), ("max_step", self.max_step)] {
            let (key, told) = (solver.key(name), Decimal::from(step));
            let endless = name == "max_step" && step == f64::INFINITY;
            if !endless
                && complaints.require_positive(key.clone(), &told, "s")
                && first + step == first
            {
                let reason = "added to that time it changes nothing";
                let rule = format!("the first sample is at {first:e} s, and {reason}");
                complaints.add(key, format!("is too small (s), {told}: {rule}"));
            }
        }
    }
}

/// The key `precision`, which the engine must be able to give.
fn precision(keys: &mut TableReader, engine: Option<EngineName>) -> Precision {
    let key = "precision";
    let digits = keys.number_or(key, "digits", "16");
    match digits.to_f64() {
        71.0 if engine == Some(EngineName::Ida) => {
            keys.complain(key, "71 digits need engine \"explicit\"".to_owned());
            Precision::Octuple
        }
        71.0 => Precision::Octuple,
        16.0 => Precision::Double,
        wrong => {
            if !wrong.is_nan() {
                keys.complain(key, format!("must be 16 or 71 (digits), is {digits}"));
            }
            Precision::Double
        }
    }
}
