//! The main engine: SUNDIALS IDA, variable-order variable-step BDF for index-1 DAEs.
//!
//! ```text
//! F(t, y, ẏ) = 0,  y = (q, v, z, λ)
//! ```
//!
//! [`Ida`] is safe to use: what is unsafe is in `ffi.rs`. The settings that let a run at tolerances
//! of 1e-12 and 1e-20 finish are the fifty error-test failures a step may have, λ out of every norm,
//! and the small first step after each restart.
//!
//! Source of the method: A. C. Hindmarsh et al., SUNDIALS: Suite of nonlinear and
//! differential/algebraic equation solvers, ACM TOMS 31 (2005) 363–396, and IDA's user guide.

mod error;
mod events;
mod ffi;
mod inverse;
mod matrix;
mod quadrature;
mod shared;
mod tolerance;
mod vector_operations;

#[cfg(test)]
mod tests;

pub use error::Error;
pub use tolerance::{AbsoluteTolerance, Norm};

use crate::dae::{Advance, Count, Dae, Engine, Fault, Snapshot};
use events::Events;
use ffi::{Counters, Return, Solver};
use quadrature::{Quadrature, looks};
use tolerance::Weights;

/// IDA's own measure of "at the stop time", in roundings of the time.
const ROUNDINGS_AT_END: f64 = 100.0;

/// This many steps in a row must lead further than this many roundings of the time each.
const STALLED_STEPS: u32 = 1000;
const STALLED_ROUNDINGS: f64 = 16.0;

/// Panels of an integral are halved no further than to this share of the step.
const SHORTEST_PANEL: f64 = 1e-4;

/// A run is given up when these many stretches of so many steps each were so short that the time
/// left would take more than this many.
const SLOW_STRETCHES: u32 = 3;
const PACE_STEPS: u32 = 100_000;
const MOST_STEPS: f64 = 1e10;

/// A step that IDA cannot take is tried again from its begin, after a restart, so many times, each
/// time with a first step that is this much shorter.
const MOST_RECOVERIES: u32 = 4;
const RECOVERY_STEP: f64 = 0.1;

/// After so many good steps, a failure is a new one.
const RECOVERED_STEPS: u32 = 50;

/// The first step is at least this many roundings of the time.
const FIRST_STEP_ROUNDINGS: f64 = 256.0;

/// How IDA is to solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Error that a step may make, relative to each component.
    pub relative_tolerance: f64,
    /// Error below which a component does not count.
    pub absolute_tolerance: AbsoluteTolerance,
    /// First step (s) after each restart; shorter where the end or `max_step` is nearer.
    pub initial_step: f64,
    /// Longest step (s); may be infinite.
    pub max_step: f64,
    /// Norm of the errors.
    pub norm: Norm,
    /// Leaves IDA's inner loops to the vector operations and the linear solver of SUNDIALS: slower
    /// by a factor of three, with the same results but for rounding. For measurements.
    pub stock_vector_operations: bool,
}

impl Default for Options {
    /// The tolerances of the literature: 1e-12 and 1e-20 with a first step of 1e-10 s.
    fn default() -> Self {
        Options {
            relative_tolerance: 1e-12,
            absolute_tolerance: AbsoluteTolerance::Scalar(1e-20),
            initial_step: 1e-10,
            max_step: f64::INFINITY,
            norm: Norm::Ode15s,
            stock_vector_operations: false,
        }
    }
}

/// Version of the SUNDIALS library that the program runs with, as "6.4.1".
pub fn sundials_version() -> String {
    ffi::version().map(|number| number.to_string()).join(".")
}

/// What the engine can do next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Nothing before a restart.
    NotStarted,
    /// IDA stands where the engine does; its last step can be interpolated.
    Running,
    /// IDA stands beyond the event where the engine does; its last step can be interpolated.
    AtEvent,
    /// The engine went on without IDA, to an end within rounding.
    Crept,
}

/// IDA, solving a system.
///
/// After [`Engine::restart`] and after each [`Engine::step`] the system stands evaluated at
/// [`Engine::now`], so that its accelerations, multipliers and powers can be read. A step that
/// follows an event without a restart begins with one, from the state at the event and in the
/// system's present modes.
pub struct Ida<Y: Dae> {
    solver: Solver<Y>,
    options: Options,
    phase: Phase,
    now: Snapshot<f64>,
    /// Where the last step began.
    began: Snapshot<f64>,
    /// A place within the last step.
    between: Snapshot<f64>,
    quadrature: Quadrature,
    events: Events,
    fired: Vec<bool>,
    /// Stop time (s) that IDA knows.
    stop_time: Option<f64>,
    progress: Progress,
    pace: Pace,
    restarts: u64,
    /// How often a step that failed was mended by a restart.
    recoveries: u64,
    /// How many of them were the latest attempts at one place.
    attempts: u32,
    /// Steps since the latest of them.
    steps_since: u32,
    /// What IDA counted before the last restart.
    earlier: Counters,
}

impl<Y: Dae> Ida<Y> {
    /// An engine for a system. It needs a restart before its first step.
    ///
    /// # Errors
    /// [`Error::Option`], [`Error::NothingToSolve`], [`Error::Version`], [`Error::Memory`].
    pub fn new(system: Y, options: Options) -> Result<Self, Error> {
        check_version()?;
        check_step("initial_step", options.initial_step, options.initial_step.is_finite())?;
        check_step("max_step", options.max_step, true)?;
        if system.coordinates() == 0 {
            return Err(Error::NothingToSolve);
        }
        let weights = Weights::new(
            options.relative_tolerance,
            options.absolute_tolerance,
            options.norm,
            system.scales(),
            system.inner_scales(),
        )?;
        let now = Snapshot::new(system.coordinates(), system.inner_states(), system.integrals());
        let quadrature = Quadrature::new(system.integrals(), typical_turning(system.scales()));
        let fired = vec![false; system.watches().len()];
        let events = Events::new(fired.len());
        let stock = options.stock_vector_operations;
        Ok(Ida {
            solver: Solver::new(system, weights, options.max_step, stock)?,
            options,
            phase: Phase::NotStarted,
            began: now.clone(),
            between: now.clone(),
            now,
            quadrature,
            events,
            fired,
            stop_time: None,
            progress: Progress::default(),
            pace: Pace::default(),
            restarts: 0,
            recoveries: 0,
            attempts: 0,
            steps_since: 0,
            earlier: Counters::default(),
        })
    }

    /// The options that it was made with.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Begins anew at `self.now`.
    fn begin(&mut self) -> Result<(), Error> {
        self.phase = Phase::NotStarted;
        self.began.clone_from(&self.now);
        self.evaluate()?;
        self.arm();
        self.fired.fill(false);
        let (system, now) = (self.solver.system_ref(), &self.now);
        self.quadrature.restart(now.time, system.powers(), &now.integrals);
        let values = [&now.q, &now.v, &now.z, system.lambda()].concat();
        let no_rates = vec![0.0; system.lambda().len()];
        let rates = [&now.v, system.accelerations(), system.inner_rates(), &no_rates].concat();
        let (y, yp) = self.solver.unknowns_mut();
        y.copy_from_slice(&values);
        yp.copy_from_slice(&rates);
        self.earlier += self.solver.counters();
        let shortest = FIRST_STEP_ROUNDINGS * f64::EPSILON * now.time.abs();
        let first = self.options.initial_step * RECOVERY_STEP.powi(self.attempts as i32);
        self.solver.reinitialize(now.time, first.max(shortest))?;
        self.stop_time = None;
        self.restarts += 1;
        self.phase = Phase::Running;
        Ok(())
    }

    /// Evaluates the system at `self.now`.
    fn evaluate(&mut self) -> Result<(), Error> {
        let evaluated = self.solver.system().evaluate(self.now.state());
        evaluated.map_err(|source| Error::System { time: self.now.time, source })
    }

    /// One step of IDA to `self.now`, from a state that `self.began` keeps.
    fn step_ida(&mut self, end: f64) -> Result<Advance, Error> {
        if self.stop_time != Some(end) {
            self.solver.set_stop_time(end)?;
            self.stop_time = Some(end);
        }
        let (time, ended) = self.solve(end)?;
        if ended == Return::AtStopTime {
            self.stop_time = None;
        }
        std::mem::swap(&mut self.began, &mut self.now);
        take(time, self.solver.unknowns(), &mut self.now);
        self.evaluate()?;
        let event = self.meet_events()?;
        let time = self.now.time;
        self.quadrature.advance(time, self.solver.system_ref().powers());
        if self.looks_inside(time - self.began.time) {
            let gained = self.gather(time)?;
            self.quadrature.correct(&gained);
            self.evaluate()?;
        }
        self.now.integrals.copy_from_slice(self.quadrature.totals());
        let setback = self.solver.take_setback();
        self.progress.made(time, setback)?;
        self.pace.made(time, end, self.options.max_step)?;
        Ok(if event { Advance::Event } else { Advance::Stepped })
    }

    /// Looks for events in the step to `self.now`, and goes back to the first of them. Returns
    /// whether there is one.
    fn meet_events(&mut self) -> Result<bool, Error> {
        let Some(first) = self.find_event()? else {
            self.events.go_on();
            return Ok(false);
        };
        if first < self.now.time {
            self.go_back(first)?;
        }
        Ok(true)
    }

    /// Goes back to a time (s) within IDA's last step.
    fn go_back(&mut self, time: f64) -> Result<(), Error> {
        take(time, self.solver.interpolate(time)?, &mut self.now);
        self.evaluate()
    }

    /// One step of IDA. One that fails for want of smoothness in what IDA remembers is tried again
    /// without its memory, from where it began.
    fn solve(&mut self, end: f64) -> Result<(f64, Return), Error> {
        loop {
            let error = match self.solver.step(end) {
                Ok(done) => {
                    self.steps_since = self.steps_since.saturating_add(1);
                    if self.steps_since == RECOVERED_STEPS {
                        self.attempts = 0;
                    }
                    return Ok(done);
                }
                Err(error) => error,
            };
            if !error.is_rough() || self.attempts >= MOST_RECOVERIES {
                return Err(error);
            }
            self.attempts += 1;
            self.steps_since = 0;
            self.recoveries += 1;
            self.begin()?;
            self.solver.set_stop_time(end)?;
            self.stop_time = Some(end);
        }
    }

    /// Whether the integrals over IDA's last step are those of powers inside it.
    fn looks_inside(&self, length: f64) -> bool {
        self.quadrature.wants_looks(length) || self.solver.system_ref().powers_run_free()
    }

    /// Integrals (J) from the begin of IDA's last step to a time (s) within it, of powers inside it.
    fn gather(&mut self, until: f64) -> Result<Vec<f64>, Error> {
        let shortest = SHORTEST_PANEL * (until - self.began.time);
        let free = self.solver.system_ref().powers_run_free();
        let mut panels = self.quadrature.panels(self.began.time, until);
        let mut gained = vec![0.0; self.now.integrals.len()];
        while let Some([from, to]) = panels.pop() {
            let mut over = self.over([from, to])?;
            if free {
                let middle = from.midpoint(to);
                let mut halves = self.over([from, middle])?;
                add(&mut halves, &self.over([middle, to])?);
                if to - from > shortest && !self.quadrature.agree(&over, &halves) {
                    panels.extend([[middle, to], [from, middle]]);
                    continue;
                }
                over = halves;
            }
            add(&mut gained, &over);
        }
        Ok(gained)
    }

    /// Integrals (J) over a panel within IDA's last step.
    fn over(&mut self, panel: [f64; 2]) -> Result<Vec<f64>, Error> {
        let mut gained = vec![0.0; self.now.integrals.len()];
        for (time, weight) in looks(panel) {
            take(time, self.solver.interpolate(time)?, &mut self.between);
            let evaluated = self.solver.system().evaluate(self.between.state());
            evaluated.map_err(|source| Error::System { time, source })?;
            let powers = self.solver.system_ref().powers();
            gained.iter_mut().zip(powers).for_each(|(gained, power)| *gained += weight * power);
        }
        Ok(gained)
    }

    /// Goes to an end that is within rounding, too near for IDA, along the tangent.
    fn creep(&mut self, end: f64) -> Result<Advance, Error> {
        self.began.clone_from(&self.now);
        self.phase = Phase::Crept;
        let length = end - self.now.time;
        let (system, now) = (self.solver.system_ref(), &mut self.now);
        let tangent = |x: &mut [f64], rates: &[f64]| {
            x.iter_mut().zip(rates).for_each(|(x, rate)| *x += length * rate);
        };
        tangent(&mut now.q, &now.v);
        tangent(&mut now.v, system.accelerations());
        tangent(&mut now.z, system.inner_rates());
        tangent(&mut now.integrals, system.powers());
        now.time = end;
        self.evaluate()?;
        Ok(Advance::Stepped)
    }
}

fn add(sums: &mut [f64], terms: &[f64]) {
    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
}

impl<Y: Dae> Engine<f64> for Ida<Y> {
    type System = Y;
    type Error = Error;

    fn system(&mut self) -> &mut Y {
        self.solver.system()
    }

    /// # Errors
    /// [`Error::System`] if the system cannot be evaluated at `now`.
    fn restart(&mut self, now: &Snapshot<f64>) -> Result<(), Error> {
        assert_eq!(now.q.len(), self.now.q.len(), "a snapshot of another system");
        assert_eq!(now.z.len(), self.now.z.len(), "a snapshot of another system");
        assert_eq!(now.integrals.len(), self.now.integrals.len(), "a snapshot of another system");
        self.now.clone_from(now);
        self.begin()
    }

    /// # Errors
    /// [`Error::Stopped`] if IDA gives up, [`Error::System`] if the system does,
    /// [`Error::NoProgress`] if the step size has fallen to nothing, [`Error::NotStarted`], [`Error::Backwards`].
    ///
    /// # Panics
    /// With the system's own panic, if it panics.
    fn step(&mut self, end: f64) -> Result<Advance, Error> {
        let now = self.now.time;
        if self.phase == Phase::NotStarted {
            return Err(Error::NotStarted);
        }
        if end < now || end.is_nan() {
            return Err(Error::Backwards { now, end });
        }
        if end - now <= ROUNDINGS_AT_END * f64::EPSILON * (end.abs() + now.abs()) {
            self.fired.fill(false);
            return self.creep(end);
        }
        if self.phase != Phase::Running {
            self.begin()?;
        }
        self.fired.fill(false);
        // An error, or a panic of the system, leaves a state that no step can begin from.
        self.phase = Phase::NotStarted;
        let advance = self.step_ida(end)?;
        self.phase = match advance {
            Advance::Stepped => Phase::Running,
            Advance::Event => Phase::AtEvent,
        };
        Ok(advance)
    }

    fn now(&self) -> &Snapshot<f64> {
        &self.now
    }

    fn began(&self) -> f64 {
        self.began.time
    }

    /// # Errors
    /// [`Error::Outside`] if the time is not within the last step.
    fn within(&mut self, time: f64, at: &mut Snapshot<f64>) -> Result<(), Error> {
        let (began, now) = (self.began.time, self.now.time);
        if time == now {
            at.clone_from(&self.now);
        } else if time == began {
            at.clone_from(&self.began);
        } else if !(began < time && time < now) {
            return Err(Error::Outside { time, began, now });
        } else if self.phase == Phase::Crept {
            between(&self.began, &self.now, time, at);
        } else {
            take(time, self.solver.interpolate(time)?, at);
            if self.looks_inside(now - began) {
                let gained = self.gather(time)?;
                let sums = self.quadrature.before().iter().zip(gained);
                at.integrals.iter_mut().zip(sums).for_each(|(at, (before, g))| *at = before + g);
            } else {
                self.quadrature.within(time, &mut at.integrals);
            }
        }
        Ok(())
    }

    fn fired(&self) -> &[bool] {
        &self.fired
    }

    fn counts(&self) -> Vec<Count> {
        let mut ida = self.earlier;
        ida += self.solver.counters();
        let calls = self.solver.calls();
        let count = |name, value| Count { name, value };
        vec![
            count("steps", ida.steps),
            count("restarts", self.restarts),
            count("residual_evaluations", calls.residuals),
            count("jacobian_evaluations", calls.jacobians),
            count("root_evaluations", self.events.looks),
            count("nonlinear_iterations", ida.nonlinear_iterations),
            count("nonlinear_convergence_failures", ida.nonlinear_convergence_failures),
            count("error_test_failures", ida.error_test_failures),
            count("steps_at_rounding", self.solver.floored()),
            count("recoveries", self.recoveries),
            count("unproven_steps", self.events.unproven),
        ]
    }
}

/// Puts time (s) and q, v, z of y = (q, v, z, λ) into a snapshot.
fn take(time: f64, y: &[f64], at: &mut Snapshot<f64>) {
    let (q, rest) = y.split_at(at.q.len());
    let (v, rest) = rest.split_at(at.v.len());
    let (z, _) = rest.split_at(at.z.len());
    at.time = time;
    at.q.copy_from_slice(q);
    at.v.copy_from_slice(v);
    at.z.copy_from_slice(z);
}

/// Typical rate (rad/s) at which a system of these typical sizes of q and v turns.
fn typical_turning((coordinates, velocities): (&[f64], &[f64])) -> f64 {
    let rates = coordinates.iter().zip(velocities).map(|(size, rate)| rate / size);
    rates.fold(0.0, f64::max)
}

/// The state at a time between two states that are within rounding.
fn between(from: &Snapshot<f64>, to: &Snapshot<f64>, time: f64, at: &mut Snapshot<f64>) {
    let part = (time - from.time) / (to.time - from.time);
    let mix = |at: &mut [f64], from: &[f64], to: &[f64]| {
        for ((at, from), to) in at.iter_mut().zip(from).zip(to) {
            *at = from + part * (to - from);
        }
    };
    at.time = time;
    mix(&mut at.q, &from.q, &to.q);
    mix(&mut at.v, &from.v, &to.v);
    mix(&mut at.z, &from.z, &to.z);
    mix(&mut at.integrals, &from.integrals, &to.integrals);
}

/// Whether the library is of the version that the program was built for.
fn check_version() -> Result<(), Error> {
    match ffi::version() {
        [6, 4, _] => Ok(()),
        _ => Err(Error::Version { found: sundials_version() }),
    }
}

fn check_step(name: &'static str, value: f64, sound: bool) -> Result<(), Error> {
    if sound && value > 0.0 {
        return Ok(());
    }
    Err(Error::Option { name, value, must: "be a positive time (s)" })
}

/// Watches that time goes on. It lives through restarts, for in a storm of events it does not.
#[derive(Debug, Default)]
struct Progress {
    /// Steps since `mark`.
    steps: u32,
    /// Time (s) at which counting began.
    mark: f64,
    /// The last complaint of the system since then.
    setback: Option<Fault>,
}

impl Progress {
    /// A step led to a time (s), perhaps after a complaint of the system.
    fn made(&mut self, time: f64, setback: Option<Fault>) -> Result<(), Error> {
        let standstill = f64::from(STALLED_STEPS) * STALLED_ROUNDINGS * f64::EPSILON * time.abs();
        if (time - self.mark).abs() > standstill {
            *self = Progress { steps: 0, mark: time, setback: None };
            return Ok(());
        }
        self.steps += 1;
        self.setback = setback.or(self.setback.take());
        if self.steps < STALLED_STEPS {
            return Ok(());
        }
        let Progress { steps, mark: since, setback: source } = std::mem::take(self);
        Err(Error::NoProgress { steps, since, now: time, source })
    }
}

/// Watches that the end can be reached.
#[derive(Debug, Default)]
struct Pace {
    /// Steps since `mark`.
    steps: u32,
    /// Time (s) at which counting began.
    mark: f64,
    /// Stretches of steps in a row that led nowhere near far enough.
    slow: u32,
}

impl Pace {
    /// A step led to a time (s) on the way to an end (s), no step being longer than `max_step` (s).
    fn made(&mut self, time: f64, end: f64, max_step: f64) -> Result<(), Error> {
        self.steps += 1;
        if self.steps < PACE_STEPS {
            return Ok(());
        }
        let step = (time - self.mark).abs() / f64::from(self.steps);
        let left = (end - time) / step;
        let too_slow = left > MOST_STEPS && step < 0.01 * max_step;
        self.slow = if too_slow { self.slow + 1 } else { 0 };
        (self.steps, self.mark) = (0, time);
        match self.slow >= SLOW_STRETCHES {
            true => Err(Error::TooSlow { now: time, step, end, left }),
            false => Ok(()),
        }
    }
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Counters) {
        self.steps += other.steps;
        self.nonlinear_iterations += other.nonlinear_iterations;
        self.nonlinear_convergence_failures += other.nonlinear_convergence_failures;
        self.error_test_failures += other.error_test_failures;
    }
}
