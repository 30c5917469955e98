//! The explicit engine: high order, adaptive, generic in the scalar.
//!
//! It shares with any other engine the system and nothing of the solution. In double precision it
//! is the independent check and the fast lane, in 71 digits the truth.
//!
//! - **Steps**: an eighth-order Runge–Kutta method in double precision, extrapolation of the
//!   midpoint rule with as many columns as pay otherwise. Both work on the vector of `flow.rs`,
//!   in which contacts are analytic from end to end. Cosines and sines of the turning frames are
//!   components, set anew from the angles at each step's begin. So are, in double precision, the
//!   offsets of the journals: as differences of coordinates a hundred times larger they would lose
//!   two places. What rounding takes from a sum of state and increment is kept and added to the
//!   next.
//! - **Events** are met by steps that end on them: Newton on the length of the step, with partial
//!   steps that grow as accurate as the iteration needs them. No interpolant comes near the state.
//!   That a step holds no other event is proven by bounds ([`guard`](super::guard)), with looks
//!   wherever those at its ends do not settle it.
//! - **Looks** into a step, for events and summits, read the method's dense output at middling
//!   tolerances, where it is as true as the step: four right-hand sides in place of twelve a look, one
//!   of which tells whether it is. Without one, and at the tightest and the loosest tolerances, they
//!   are partial steps. So are samples and sections at any.
//! - **Errors** are weighed by component: the largest, in units of the size that
//!   [`System::scales`] gives it, or of its own magnitude where that is larger by more than
//!   rounding allows for. Integrals follow without a say.
//! - **Drift** off the constraints is left to whoever restarts the engine: the equations are of
//!   index 1, and what drifts is of the size of the errors that the tolerance admits.

mod dop853;
mod error;
mod events;
mod extrapolation;
mod flow;
mod roots;
mod runge_kutta;
mod search;
mod stepper;
#[cfg(test)]
mod tests;

pub use error::ExplicitError;

use crate::dae::{Advance, Count, Direction, Engine, Fault, Snapshot, System};
use crate::scalar::Scalar;
use events::{Standing, Target};
use extrapolation::Extrapolation;
use flow::{Flow, Gauge};
use runge_kutta::RungeKutta;
use search::quintic_root;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use stepper::{Norm, Point, Stepper};

/// Attempts at one step, and steps at one time, after which the engine gives up.
const PATIENCE: u32 = 100;

/// Up to this tolerance partial steps from either end of a step lead to the same places as far as
/// anybody sees; beyond, all are taken from its begin.
const TIGHT: f64 = 1e-10;
/// Between these tolerances looks for events and summits read the dense output. Tighter, what that is
/// off by begins to show (some 1e-13 of a peak force); looser, partial steps are truer than the
/// tolerance asks for, and what friction and gaps make of an error counts many times itself.
const TIGHTEST: f64 = 5e-13;
/// See [`TIGHTEST`].
const LOOSE: f64 = 1e-8;

/// Steps over the relaxation of inner states, at most, where numbers carry a derivative: no error tells
/// of a derivative that a step beyond the method's stability (some 6) makes larger and larger.
const STABLE: f64 = 3.0;

/// Steps between two looks at how far the simulation has come, ...
const STRETCH: u64 = 100_000;
/// ... and steps to the end, at the pace of the last stretch, from which on it is hopeless.
const HOPELESS: f64 = 3e9;

/// Size of a root in units of its largest value. What a relative error of the root does to the
/// velocities is a few times that, of the velocities in the contact, which are a part of the
/// typical ones; measured, factors of one and ten leave the same errors, a hundred larger ones.
const ROOT_SIZE: f64 = 10.0;

/// One-step methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Eighth order, in double precision only.
    RungeKutta,
    /// Extrapolation of the midpoint rule, any order.
    Extrapolation,
}

/// Settings of the explicit engine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Error that a step may make, relative to the sizes of [`System::scales`].
    pub tolerance: f64,
    /// Length of the first step (s).
    pub initial_step: f64,
    /// Largest length of a step (s).
    pub max_step: f64,
    /// One-step method; `None` takes the one that suits the arithmetic.
    pub method: Option<Method>,
}

impl Default for Options {
    /// A tolerance of 1e-12, and steps that begin at a microsecond.
    fn default() -> Self {
        Options { tolerance: 1e-12, initial_step: 1e-6, max_step: f64::INFINITY, method: None }
    }
}

/// How far the dense output of the last step is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Drawing {
    /// The stages of the step are gone.
    Absent,
    /// The stages are there.
    Begun,
    /// It is there, and as true as the step.
    Done,
    /// It is not as true as the step.
    Doubtful,
}

/// Counts of work.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    steps: u64,
    rejected: u64,
    partial: u64,
    drawn: u64,
    events: u64,
    restarts: u64,
    unproven: u64,
}

/// The explicit engine (see the module's header). Make it, `restart` it, then step.
pub struct Explicit<S: Scalar, Y: System<S>> {
    flow: Flow<S, Y>,
    stepper: Stepper<S>,
    options: Options,
    norm: Norm,
    sizes: Vec<f64>,
    deepest: Vec<f64>,
    /// Begin of the last step.
    from: Point<S>,
    /// End of the last step.
    here: Point<S>,
    /// Where a partial step led.
    probe: Point<S>,
    /// Rates of y, and of what is aimed at, where the partial step before led.
    last_rates: Vec<S>,
    last_rate: S,
    /// Length of the last step in τ.
    length: S,
    /// What there is of the dense output of the last step.
    drawing: Drawing,
    /// Length that suits the next step in τ.
    next: f64,
    /// Lengths that suited the first step after a restart in the same modes.
    first_lengths: HashMap<u64, f64>,
    modes: u64,
    fresh: bool,
    evaluated_here: bool,
    standing: Vec<Standing>,
    /// Directions watched since the last restart.
    armed: Vec<Direction>,
    fired: Vec<bool>,
    /// Places of the last step that a search has looked at, by what they were seen at.
    places: Vec<(f64, S)>,
    idle: u32,
    /// Time (s) at which the present stretch of steps began.
    stretch_began: f64,
    now: Snapshot<S>,
    tally: Tally,
}

impl<S: Scalar, Y: System<S>> Explicit<S, Y> {
    /// An engine for a system; it needs a restart before its first step.
    pub fn new(system: Y, options: Options) -> Result<Self, ExplicitError> {
        let smallest = 4.0 * S::EPSILON;
        if !(options.tolerance >= smallest && options.tolerance <= 1e-2) {
            return Err(ExplicitError::Tolerance { tolerance: options.tolerance, smallest });
        }
        if !(options.initial_step > 0.0 && options.max_step > 0.0) {
            return Err(ExplicitError::StepLength);
        }
        let flow = Flow::new(system, options.tolerance <= TIGHT);
        let (capacity, functions) = (flow.capacity(), flow.gauges().len());
        let coarse = S::EPSILON >= f64::EPSILON;
        let stepper = match options.method {
            Some(Method::RungeKutta) if !coarse => return Err(ExplicitError::Coefficients),
            None if coarse => Stepper::RungeKutta(RungeKutta::new(capacity)),
            Some(Method::RungeKutta) => Stepper::RungeKutta(RungeKutta::new(capacity)),
            _ => Stepper::Extrapolation(Extrapolation::new(capacity, options.tolerance)),
        };
        let now =
            Snapshot::new(flow.coordinates(), flow.system.inner_states(), flow.system.integrals());
        let point = Point::new(capacity, functions);
        Ok(Explicit {
            stepper,
            norm: Norm { weights: Vec::with_capacity(capacity), tolerance: options.tolerance },
            sizes: sizes_of(&flow),
            deepest: vec![0.0; functions],
            from: point.clone(),
            here: point.clone(),
            probe: point,
            last_rates: vec![S::zero(); capacity],
            last_rate: S::zero(),
            length: S::zero(),
            drawing: Drawing::Absent,
            next: options.initial_step,
            first_lengths: HashMap::new(),
            modes: 0,
            fresh: true,
            evaluated_here: false,
            standing: vec![Standing::Passed; functions],
            armed: vec![Direction::Off; functions],
            fired: vec![false; functions],
            places: Vec::new(),
            idle: 0,
            stretch_began: 0.0,
            now,
            tally: Tally::default(),
            flow,
            options,
        })
    }

    fn time(&self) -> f64 {
        self.now.time.to_f64()
    }

    /// Begin of the last step (s).
    fn step_begin(&self) -> f64 {
        self.from.y[self.flow.time()].to_f64()
    }

    fn fault(&self, source: Fault) -> ExplicitError {
        ExplicitError::System { time: self.time(), source }
    }

    /// Event functions count as zero below this.
    fn noise(&self, rate: f64) -> f64 {
        S::EPSILON * (1e3 + 8.0 * rate.abs() * self.time().abs())
    }

    /// Takes y as it stands in `here`: cosines and sines from the angles, rates, approaches.
    fn arrive(&mut self) -> Result<(), Fault> {
        let (flow, here) = (&mut self.flow, &mut self.here);
        flow.reset_turns(&mut here.y);
        let turns = flow.first_turn()..flow.first_offset();
        here.low[turns].fill(S::zero());
        flow.approaches(&here.y, &mut here.approaches)?;
        flow.rates(&here.y, &mut here.rates)?;
        for k in 0..here.approach_rates.len() {
            here.approach_rates[k] = flow.approach_rate(k);
            here.courses[k] = flow.course(&here.y, k);
        }
        here.pace_rate = flow.pace_rate(&here.y);
        self.evaluated_here = true;
        Ok(())
    }

    /// Weighs the components for a step from `from`.
    fn weigh(&mut self, length: f64) {
        let (flow, from) = (&self.flow, &self.from);
        let rounding = S::EPSILON / self.options.tolerance;
        self.norm.weights.clear();
        for (size, y) in self.sizes.iter().zip(&from.y) {
            self.norm.weights.push(1.0 / size.max(y.to_f64().abs() * rounding));
        }
        for (slot, root) in flow.roots().iter().enumerate() {
            let i = flow.root(slot);
            let reach = (from.rates[i].to_f64() * length).abs();
            let deepest = &mut self.deepest[root.function];
            *deepest = deepest.max(from.y[i].to_f64().abs());
            self.norm.weights.push(1.0 / (ROOT_SIZE * deepest.max(reach)));
        }
    }

    /// Length in τ of a duration (s) from `here`, roughly, with growing roots in mind.
    fn length_of(&self, duration: f64) -> f64 {
        let flow = &self.flow;
        if flow.roots().is_empty() || !duration.is_finite() {
            return duration;
        }
        let lasts = |tau: f64| {
            flow.roots().iter().enumerate().fold(tau, |product, (slot, root)| {
                let i = flow.root(slot);
                let growth = 0.5 * self.here.rates[i].to_f64().max(0.0) * tau;
                product * (self.here.y[i].to_f64() + growth).powi(root.degree as i32 - 1)
            })
        };
        let (mut low, mut high) = (1e-300_f64, 1e300_f64);
        for _ in 0..64 {
            let middle = (low.ln().midpoint(high.ln())).exp();
            if lasts(middle) > duration { high = middle } else { low = middle }
        }
        low
    }

    /// Puts q, v, z, t and the integrals of a snapshot into `here`; where they are those of the last
    /// step's end, what rounding left out of them is kept. Returns whether q or t are others.
    fn put(&mut self, now: &Snapshot<S>) -> bool {
        let n = self.flow.coordinates();
        let time = self.flow.time();
        let here = &mut self.here;
        // equal values may have other derivatives
        let mut moved = S::CARRIES_DERIVATIVE;
        let mut set = |i: usize, value: S| {
            if here.y[i] != value {
                here.low[i] = S::zero();
                moved |= i < n || i == time;
            }
            // equal or not: numbers that carry more than a value compare by the value alone
            here.y[i] = value;
        };
        for i in 0..n {
            set(i, now.q[i]);
            set(n + i, now.v[i]);
        }
        for (i, z) in now.z.iter().enumerate() {
            set(2 * n + i, *z);
        }
        set(time, now.time);
        let first = self.flow.controlled();
        for (i, value) in now.integrals.iter().enumerate() {
            here.y[first + i] = *value;
            here.low[first + i] = S::zero();
        }
        moved
    }

    /// The step itself, from `from`; leaves its end in `here`.
    fn advance(&mut self, end: S) -> Result<Advance, ExplicitError> {
        let mut said = None;
        for _ in 0..PATIENCE {
            let time = self.flow.time();
            let remaining = end - self.from.y[time];
            let bare = self.flow.roots().is_empty();
            let last = bare && self.next >= remaining.to_f64() * (1.0 - 1e-12);
            let length = if last { remaining } else { S::from_f64(self.next) };
            self.weigh(length.to_f64());
            let attempt = self.stepper.attempt(&mut self.flow, &self.from, length, &self.norm);
            let attempt = match attempt {
                Ok(attempt) => attempt,
                Err(fault) => {
                    // fatal or not: a trial state may be nowhere near the trajectory
                    said = Some(fault);
                    self.reject(length.to_f64() * 0.25);
                    continue;
                }
            };
            if !attempt.accepted {
                self.reject(attempt.next.min(0.9 * length.to_f64()));
                continue;
            }
            self.here.displace(&self.from, self.stepper.increment());
            if last {
                self.here.y[time] = end;
                self.here.low[time] = S::zero();
            }
            if let Err(fault) = self.arrive() {
                said = Some(fault);
                self.reject(length.to_f64() * 0.25);
                continue;
            }
            if !last {
                self.next = attempt.next;
                if std::mem::take(&mut self.fresh) {
                    self.first_lengths.insert(self.modes, self.next);
                }
            }
            self.length = length;
            self.drawing = Drawing::Begun;
            match self.meet_events(end)? {
                Some(advance) => return Ok(advance),
                None => self.reject(length.to_f64() * 0.25),
            }
        }
        Err(ExplicitError::StepTooSmall {
            time: self.time(),
            tolerance: self.options.tolerance,
            step: self.next,
            source: said,
        })
    }

    fn reject(&mut self, next: f64) {
        self.tally.rejected += 1;
        self.next = next;
    }

    /// A step without length, at events that are there already.
    fn stand(&mut self) {
        self.from.clone_from(&self.here);
        self.length = S::zero();
        self.drawing = Drawing::Absent;
    }

    /// Guards against steps and events that go on at one time, and against steps so short that
    /// the `end` is out of reach.
    fn count_progress(&mut self, before: S, end: S) -> Result<(), ExplicitError> {
        self.idle = if self.now.time > before { 0 } else { self.idle + 1 };
        if self.idle > PATIENCE {
            return Err(ExplicitError::Stuck { time: self.time() });
        }
        if self.tally.steps.is_multiple_of(STRETCH) && self.idle == 0 {
            let now = self.time();
            let made = now - std::mem::replace(&mut self.stretch_began, now);
            let step = made / STRETCH as f64;
            let steps = (end.to_f64() - now) / step;
            if steps > HOPELESS {
                return Err(ExplicitError::Crawl { time: now, step, steps });
            }
        }
        Ok(())
    }
}

/// Writes a point into a snapshot.
fn take<S: Scalar, Y: System<S>>(flow: &Flow<S, Y>, point: &Point<S>, at: &mut Snapshot<S>) {
    let (n, y) = (flow.coordinates(), &point.y);
    at.time = y[flow.time()];
    at.q.copy_from_slice(&y[..n]);
    at.v.copy_from_slice(&y[n..2 * n]);
    at.z.copy_from_slice(&y[2 * n..flow.first_turn()]);
    at.integrals.copy_from_slice(&y[flow.controlled()..flow.len()]);
}

/// Sizes by which errors are weighed: of q, v and z as the system has them, one for cosines and
/// sines, and for the time the shortest that a typical velocity takes for a typical coordinate.
fn sizes_of<S: Scalar, Y: System<S>>(flow: &Flow<S, Y>) -> Vec<f64> {
    let (q, v) = flow.system.scales();
    let mut sizes = [q, v, flow.system.inner_scales()].concat();
    sizes.resize(flow.first_offset(), 1.0);
    // offsets follow the coordinates, whose errors are theirs
    sizes.resize(flow.time(), f64::INFINITY);
    sizes.push(q.iter().zip(v).map(|(q, v)| q / v).fold(f64::INFINITY, f64::min));
    sizes
}

impl<S: Scalar, Y: System<S>> Engine<S> for Explicit<S, Y> {
    type System = Y;
    type Error = ExplicitError;

    fn system(&mut self) -> &mut Y {
        &mut self.flow.system
    }

    fn restart(&mut self, now: &Snapshot<S>) -> Result<(), ExplicitError> {
        let finite = |list: &[S]| list.iter().all(|x| x.is_finite());
        if !(now.time.is_finite() && finite(&now.q) && finite(&now.v) && finite(&now.z)) {
            return Err(ExplicitError::NotFinite { time: now.time.to_f64() });
        }
        let goes_on = self.tally.restarts > 0 && now.time == self.now.time;
        self.tally.restarts += 1;
        let moved = self.put(now);
        if !goes_on {
            self.fired.fill(false);
            self.idle = 0;
        }
        self.now.clone_from(now);
        self.begin(goes_on, moved).map_err(|fault| self.fault(fault))?;
        let mut hasher = DefaultHasher::new();
        for watch in self.flow.system.watches() {
            (watch.direction as u8).hash(&mut hasher);
        }
        self.modes = hasher.finish();
        self.next = match self.first_lengths.get(&self.modes) {
            Some(length) => *length,
            None => self.length_of(self.options.initial_step),
        };
        self.fresh = true;
        self.fired.fill(false);
        self.stand();
        Ok(())
    }

    fn step(&mut self, end: S) -> Result<Advance, ExplicitError> {
        let before = self.now.time;
        self.fired.fill(false);
        if self.fire_standing() {
            self.stand();
            self.tally.events += 1;
            self.count_progress(before, end)?;
            return Ok(Advance::Event);
        }
        if end <= before {
            self.stand();
            return Ok(Advance::Stepped);
        }
        self.revise_roots().map_err(|fault| self.fault(fault))?;
        self.next = self.next.min(self.length_of(self.options.max_step));
        let relaxation = self.flow.system.inner_relaxation();
        if S::CARRIES_DERIVATIVE && relaxation > 0.0 {
            self.next = self.next.min(self.length_of(STABLE / relaxation));
        }
        std::mem::swap(&mut self.from, &mut self.here);
        let advance = match self.advance(end) {
            Ok(advance) => advance,
            Err(error) => {
                std::mem::swap(&mut self.from, &mut self.here);
                return Err(error);
            }
        };
        if !self.evaluated_here {
            self.flow.evaluate(&self.here.y).map_err(|fault| self.fault(fault))?;
            self.evaluated_here = true;
        }
        take(&self.flow, &self.here, &mut self.now);
        self.tally.steps += 1;
        self.count_progress(before, end)?;
        self.tally.events += u64::from(advance == Advance::Event);
        self.settle();
        Ok(advance)
    }

    fn now(&self) -> &Snapshot<S> {
        &self.now
    }

    fn began(&self) -> S {
        self.from.y[self.flow.time()]
    }

    /// A partial step from the nearer end
    /// of the last one, while a contact lasts by as many more as it takes to land on the time. The
    /// system is left evaluated somewhere in the step.
    fn within(&mut self, time: S, at: &mut Snapshot<S>) -> Result<(), ExplicitError> {
        let (began, now) = (self.began(), self.now.time);
        if !(time >= began && time <= now) {
            let [time, began, now] = [time, began, now].map(Scalar::to_f64);
            return Err(ExplicitError::NotWithin { time, began, now });
        }
        if time == now {
            at.clone_from(&self.now);
            return Ok(());
        }
        if time == began {
            take(&self.flow, &self.from, at);
            return Ok(());
        }
        if self.flow.roots().is_empty() {
            self.partial(time - began, self.options.tolerance)?;
        } else {
            let guess = self.length * S::from_f64(self.place_of(time));
            self.land(Target::Time(time), [S::zero(), self.length], guess)?;
        }
        self.take_probe(at);
        at.time = time;
        Ok(())
    }

    fn glance(
        &mut self,
        time: S,
        accuracy: f64,
        at: &mut Snapshot<S>,
    ) -> Result<(), ExplicitError> {
        if time == self.now.time {
            at.clone_from(&self.now);
            return Ok(());
        }
        let place = match self.flow.roots().is_empty() {
            true => time - self.began(),
            false => self.length * S::from_f64(self.place_of(time)),
        };
        self.look_in(place, accuracy.max(self.options.tolerance))?;
        self.take_probe(at);
        Ok(())
    }

    fn glances_are_steps(&self) -> bool {
        true
    }

    fn fired(&self) -> &[bool] {
        &self.fired
    }

    fn counts(&self) -> Vec<Count> {
        let tally = &self.tally;
        let count = |name, value| Count { name, value };
        vec![
            count("steps", tally.steps),
            count("rejected_steps", tally.rejected),
            count("partial_steps", tally.partial),
            count("dense_outputs", tally.drawn),
            count("right_hand_sides", self.flow.evaluations),
            count("events", tally.events),
            count("restarts", tally.restarts),
            count("unproven_steps", tally.unproven),
        ]
    }
}

impl<S: Scalar, Y: System<S>> Explicit<S, Y> {
    /// Writes `probe` into a snapshot.
    fn take_probe(&self, at: &mut Snapshot<S>) {
        take(&self.flow, &self.probe, at);
    }

    /// Where in the last step a time lies, as a fraction of its length: from time and pace at
    /// its ends.
    fn place_of(&self, time: S) -> f64 {
        let (i, h) = (self.flow.time(), self.length.to_f64());
        let end = |point: &Point<S>| {
            let pace = self.flow.pace_at(&point.y).to_f64();
            [(point.y[i] - time).to_f64(), pace * h, point.pace_rate.to_f64() * h * h]
        };
        quintic_root(end(&self.from), end(&self.here))
    }

    /// Decides on the roots to carry, evaluates the system here, and arms the events. Offsets that
    /// were carried to where q still is keep the places they have gained.
    fn begin(&mut self, goes_on: bool, moved: bool) -> Result<(), Fault> {
        self.flow.reset_turns(&mut self.here.y);
        if moved || !goes_on {
            self.flow.reset_offsets(&mut self.here.y);
            let offsets = self.flow.first_offset()..self.flow.time();
            self.here.low[offsets].fill(S::zero());
        }
        self.flow.evaluate_without_roots(&self.here.y)?;
        let mut roots = self.roots_from_here(goes_on)?;
        self.part_roots(&mut roots);
        self.carry(roots);
        self.arrive()?;
        self.arm()
    }

    /// Whether the last step may have led beyond a zero past which the equations are not smooth:
    /// then nothing starts from its end.
    fn may_be_rough_beyond(&self) -> bool {
        let mut watches = self.flow.system.watches().iter();
        watches.any(|watch| watch.direction != Direction::Off && watch.power <= 0.0)
    }

    /// Whether looks may read the dense output: where the method has one, the tolerance is a middling
    /// one, and the step has nothing that it would smooth over.
    fn may_draw(&self) -> bool {
        let has_one = matches!(self.stepper, Stepper::RungeKutta(_));
        let suits = self.options.tolerance > TIGHTEST && self.options.tolerance <= LOOSE;
        has_one && suits && !self.may_be_rough_beyond()
    }

    /// Makes the dense output of the last step. Returns whether it is as true as the step.
    fn draw(&mut self) -> Result<bool, ExplicitError> {
        let Stepper::RungeKutta(method) = &mut self.stepper else { return Ok(false) };
        if matches!(self.drawing, Drawing::Done | Drawing::Doubtful) {
            return Ok(self.drawing == Drawing::Done);
        }
        self.tally.drawn += 1;
        self.evaluated_here = false;
        let begun = self.drawing == Drawing::Begun;
        let (flow, rates) = (&mut self.flow, &self.here.rates);
        let drawn = method.draw(flow, &self.from, self.length, rates, begun, &self.norm);
        let true_enough =
            drawn.map_err(|source| ExplicitError::System { time: self.step_begin(), source })?;
        self.drawing = if true_enough { Drawing::Done } else { Drawing::Doubtful };
        Ok(true_enough)
    }

    /// Puts `probe` where the dense output is after a share of the step.
    fn follow(&mut self, share: S) {
        let Stepper::RungeKutta(method) = &mut self.stepper else { return };
        method.follow(share);
        self.evaluated_here = false;
        self.probe.displace(&self.from, self.stepper.increment());
    }

    /// Puts `probe` this far into the step, as accurately as this or as the step.
    fn look_in(&mut self, place: S, accuracy: f64) -> Result<(), ExplicitError> {
        if !(self.may_draw() && self.draw()?) {
            return self.partial(place, accuracy);
        }
        self.follow(place / self.length);
        Ok(())
    }

    /// Partial step to `probe`, which is to lie this far into the step; from its nearer end, or,
    /// where the tolerance is loose, from its begin.
    fn partial(&mut self, place: S, tolerance: f64) -> Result<(), ExplicitError> {
        self.tally.partial += 1;
        self.evaluated_here = false;
        if self.drawing == Drawing::Begun {
            self.drawing = Drawing::Absent;
        }
        let same = self.options.tolerance <= TIGHT;
        let from_end = same && place + place > self.length && !self.may_be_rough_beyond();
        let (base, length) =
            if from_end { (&self.here, place - self.length) } else { (&self.from, place) };
        self.norm.tolerance = tolerance;
        let done = self.stepper.partial(&mut self.flow, base, length, &self.norm);
        self.norm.tolerance = self.options.tolerance;
        let time = base.y[self.flow.time()].to_f64();
        if !done.map_err(|source| ExplicitError::System { time, source })? {
            let target = format!("a place {:e} into it", place.to_f64());
            return Err(ExplicitError::Landing { time: self.step_begin(), target });
        }
        self.probe.displace(base, self.stepper.increment());
        Ok(())
    }

    /// Whether the event of function `k` is watched in the present modes.
    fn is_watched(&self, k: usize) -> bool {
        self.flow.gauges()[k] != Gauge::Off
    }
}
