//! An engine that goes through singular positions where the way is clear.
//!
//! From time to time it looks how much the constraints leave each other. Where that comes near to nothing
//! the engine inside is had to stop, the stretch about the position is gone as a [`Passage`], and the
//! engine begins anew behind it.

use super::passage::Passage;
use crate::dae::{Advance, Count, Engine, Snapshot, State, System};
use crate::mechanism::Mechanism;
use crate::model::Model;
use crate::scalar::{F256, Scalar};

/// Turn (rad) of the fastest body from a singular position at which a passage begins, at first; ...
const NEAR: f64 = 0.12;
/// ... and nearer than which none is tried.
const NEAREST: f64 = 1e-5;
/// Root of the share that the constraints leave each other from which on no singular position is near.
const AWAY: f64 = 0.5;
/// Turn (rad) of the fastest body over which the rate of that root is taken, at the most; ...
const TURN: f64 = 1e-4;
/// ... over the root itself; ...
const SHARE: f64 = 0.1;
/// ... and at least.
const LEAST: f64 = 1e-9;
/// The root changes by no more than this in a turn of the fastest body by 1 rad.
const FASTEST: f64 = 2.5;
/// What turns no faster (rad/s) stands still.
const SLOWEST: f64 = 1e-100;
/// Turn (rad) of what is fastest in a step from one place to the next that is looked at, ...
const STRIDE: f64 = 0.1;
/// ... in so many at the most.
const MOST_PLACES: f64 = 256.0;
/// Lines from two neighbouring places that come to zero so near to each other, over their distance, do
/// at a singular position.
const SAME: f64 = 0.3;
/// Steps between two looks at the most.
const LOOK_EVERY: u32 = 64;
/// Steps like the last that are thought of when the next look, or the next stop, is chosen.
const AHEAD: f64 = 3.0;
/// Near the begin of a passage the engine is had to stop a little beyond it.
const OVERSHOOT: f64 = 0.95;

/// An engine that passes singular positions.
pub(super) struct Passing<'a, S, E> {
    engine: &'a mut E,
    tolerance: f64,
    /// Whether there is anything to be watched.
    watches: bool,
    /// The passage that the last step was.
    passage: Option<Box<Passage<S>>>,
    /// Turn (rad) from a singular position at which one is tried next.
    near: f64,
    /// Turn (rad) of what is fastest until the next look, and steps since the last one.
    allowance: f64,
    unseen: u32,
    /// Time (s) at which a passage may begin, as far as the last look told.
    aim: Option<f64>,
    /// Length (s) of the last step.
    stride: f64,
    /// Turn (rad) of what is fastest in it, ...
    turned: f64,
    /// ... and how fast that turned at its end (rad/s).
    pace: f64,
    /// State where the last step began.
    before: Snapshot<S>,
    /// Whether the engine would step over a singular position through which no way is clear.
    refuses: bool,
    exact: Exact,
}

impl<'a, S, E> Passing<'a, S, E>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
{
    /// The engine; its relative tolerance is that of passages too.
    pub fn new(engine: &'a mut E, tolerance: f64) -> Self {
        let system = engine.system();
        // friction that hangs on forces without bound is none to be passed with
        let watches = system.multipliers() > 0 && !system.rubs();
        let before = system.start().clone();
        Passing {
            engine,
            tolerance,
            watches,
            passage: None,
            near: NEAR,
            allowance: 0.0,
            unseen: 0,
            aim: None,
            stride: 0.0,
            turned: 0.0,
            pace: 0.0,
            before,
            refuses: false,
            exact: Exact::default(),
        }
    }

    /// The passage that the last step was, if it was one.
    pub fn passage(&self) -> Option<&Passage<S>> {
        self.passage.as_deref()
    }

    /// Whether the engine can only go on over a singular position through which no way is clear; it stands
    /// before it.
    pub fn refuses(&self) -> bool {
        self.refuses
    }

    /// Has the system stand where the passage that the last step was is at a time (s), the state in a
    /// snapshot; `false` if it was none.
    pub fn show(&mut self, time: S, at: &mut Snapshot<S>) -> bool {
        match &self.passage {
            Some(passage) => {
                passage.show(self.engine.system(), time, at);
                true
            }
            None => false,
        }
    }

    /// Looks whether a singular position is near; returns the passage through it.
    fn look(&mut self, end: S) -> Option<Passage<S>> {
        self.unseen += 1;
        if AHEAD * self.turned < self.allowance && self.unseen < LOOK_EVERY {
            return None;
        }
        self.unseen = 0;
        self.aim = None;
        let now = self.engine.now().clone();
        let found = self.search(&now, end);
        if found.is_none() {
            // whatever is wrong there is told by the next step
            let _ = self.engine.system().evaluate(now.state());
        }
        found
    }

    /// Looks from the state where the engine stands, and leaves the system elsewhere.
    fn search(&mut self, now: &Snapshot<S>, end: S) -> Option<Passage<S>> {
        let time = now.time.to_f64();
        let system = self.engine.system();
        let root = root(system, now.state())?;
        let pace = pace(system, speed(&now.v));
        self.pace = pace;
        self.allowance = (root / FASTEST - NEAR).max(0.0);
        if root > AWAY {
            self.near = NEAR;
            return None;
        }
        let left = left(system, now, pace)?;
        let turn = left * pace;
        if turn > self.near {
            self.aim = Some(time + left * (1.0 - OVERSHOOT * self.near / turn));
            return None;
        }
        let found =
            Passage::find(system, now, S::from_f64(2.0 * left), self.tolerance, NEAR / turn);
        let found = found.filter(|passage| passage.to.time <= end);
        match found.filter(|passage| self.exact.agrees(system, passage)) {
            Some(passage) => {
                self.near = NEAR;
                Some(passage)
            }
            None => {
                // a shorter one may be clear
                self.near = 0.5 * turn;
                if self.near < NEAREST {
                    self.near = 0.0;
                }
                self.allowance = 0.0;
                None
            }
        }
    }

    /// Takes note of how far the last step led, from a time (s) on.
    fn count_turn(&mut self, from: f64) {
        let (to, at_begin) = (self.engine.now().time.to_f64(), self.pace);
        let speed = speed(&self.engine.now().v);
        self.pace = pace(self.engine.system(), speed);
        self.stride = to - from;
        self.turned = self.stride * self.pace.max(at_begin);
        self.allowance -= self.turned;
    }

    /// Time (s) from the begin of the last step to a singular position that it led over. Short steps are not
    /// looked into, unless a passage was tried and not found.
    fn passed_over(&mut self) -> Option<f64> {
        if self.turned <= STRIDE && self.near >= NEAR {
            return None;
        }
        let now = self.engine.now().clone();
        let system = self.engine.system();
        let over = singular_between(system, &self.before, &now, self.turned / self.stride);
        if over.is_none() {
            let _ = system.evaluate(now.state());
        }
        over
    }
}

/// A mechanism in 71 digits, from when it is first asked for; `None` if its start cannot be had.
#[derive(Debug, Clone, Default)]
pub(super) struct Exact(Option<Option<Box<Mechanism<F256>>>>);

impl Exact {
    /// Whether a passage of this mechanism is one in 71 digits too.
    pub fn agrees<S: Scalar>(&mut self, system: &Mechanism<S>, passage: &Passage<S>) -> bool {
        let same = || {
            let model = Model::new(system.model().description()).ok()?;
            Some(Box::new(Mechanism::new(model).ok()?))
        };
        let exact = self.0.get_or_insert_with(same);
        exact.as_mut().is_some_and(|exact| passage.is_sharp(exact))
    }
}

/// How fast what is fastest turns (rad/s), the bodies as placed; their largest speed (m/s) counts over ten
/// lengths of the mechanism.
fn pace<S: Scalar>(system: &Mechanism<S>, speed: f64) -> f64 {
    system.fastest_turn().max(speed / (10.0 * system.length())).max(SLOWEST)
}

/// The largest speed (m/s) among velocities, along an axis.
fn speed<S: Scalar>(v: &[S]) -> f64 {
    let bodies = v.as_chunks().0.iter();
    bodies.map(|[x, y, _]| x.abs().max(y.abs()).to_f64()).fold(0.0, f64::max)
}

/// Root of the share that the constraints leave each other at a state.
fn root<S: Scalar>(system: &mut Mechanism<S>, state: State<'_, S>) -> Option<f64> {
    system.weakest_joint(state).map(|(_, left)| left.max(0.0).sqrt())
}

/// Time (s) to where that root comes to zero along a straight line, where what is fastest turns so fast
/// (rad/s); `None` if it rises.
fn left<S: Scalar>(system: &mut Mechanism<S>, at: &Snapshot<S>, pace: f64) -> Option<f64> {
    let [root, rate] = course(system, at.state(), pace)?;
    (rate < 0.0).then_some(root / -rate)
}

/// The passage through a singular position that is near to a state, ahead or behind, by a turn of what is
/// fastest of no more than `nearest` (rad), which is halved where the way is not clear; `None` where none is
/// that near or the way is not clear. Leaves the system elsewhere.
pub(super) fn passage_near<S: Scalar>(
    system: &mut Mechanism<S>,
    at: &Snapshot<S>,
    ahead: bool,
    nearest: &mut f64,
) -> Option<Passage<S>> {
    let here = root(system, at.state()).filter(|root| *root < AWAY)?;
    let pace = pace(system, speed(&at.v));
    let [_, rate] = course(system, at.state(), pace)?;
    let left = here / -rate;
    let turn = left.abs() * pace;
    if (left > 0.0) != ahead || !(turn <= nearest.min(NEAR)) {
        return None;
    }
    *nearest = 0.5 * turn;
    Passage::find(system, at, S::from_f64(2.0 * left), S::EPSILON, NEAR / turn)
}

/// That root at a state, where what is fastest turns so fast (rad/s), and its rate (1/s).
fn course<S: Scalar>(
    system: &mut Mechanism<S>,
    state: State<'_, S>,
    pace: f64,
) -> Option<[f64; 2]> {
    let here = root(system, state)?;
    // not over the position itself
    let span = TURN.min(SHARE * here).max(LEAST) / pace;
    let later = S::from_f64(span);
    let q: Vec<S> = state.q.iter().zip(state.v).map(|(q, v)| *q + later * *v).collect();
    let beside = root(system, State { time: state.time + later, q: &q, ..state })?;
    Some([here, (beside - here) / span])
}

/// Time (s) from the begin of a step to a singular position in it, if it led over one: along the cubic
/// through both ends, where what is fastest turns so fast (rad/s).
fn singular_between<S: Scalar>(
    system: &mut Mechanism<S>,
    from: &Snapshot<S>,
    to: &Snapshot<S>,
    pace: f64,
) -> Option<f64> {
    let span = (to.time - from.time).to_f64();
    let parts = (pace * span / STRIDE).ceil().min(MOST_PLACES);
    let part = span / parts;
    let mut at = from.clone();
    let mut last: Option<[f64; 2]> = None;
    for k in 0..=parts as u32 {
        between(from, to, S::from_f64(f64::from(k) / parts), &mut at);
        let [root, rate] = course(system, at.state(), pace)?;
        if let Some([before, fell]) = last.filter(|[_, fell]| *fell < 0.0 && rate > 0.0) {
            let [down, up] = [before / -fell, root / rate];
            if (down + up - part).abs() < SAME * part {
                return Some(f64::from(k - 1) * part + down);
            }
        }
        last = Some([root, rate]);
    }
    None
}

/// Puts the state at a part of the way from one state to another into a snapshot, by the cubics through
/// both.
fn between<S: Scalar>(from: &Snapshot<S>, to: &Snapshot<S>, part: S, at: &mut Snapshot<S>) {
    let span = to.time - from.time;
    let [two, three] = [2.0, 3.0].map(S::from_f64);
    at.time = from.time + part * span;
    for k in 0..from.q.len() {
        let (slope, gone) = (span * from.v[k], to.q[k] - from.q[k]);
        let second = three * gone - two * slope - span * to.v[k];
        let third = gone - slope - second;
        at.q[k] = from.q[k] + part * (slope + part * (second + part * third));
        at.v[k] = from.v[k] + part * (to.v[k] - from.v[k]);
    }
}

impl<S, E> Engine<S> for Passing<'_, S, E>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
{
    type System = Mechanism<S>;
    type Error = E::Error;

    fn system(&mut self) -> &mut Mechanism<S> {
        self.engine.system()
    }

    fn restart(&mut self, now: &Snapshot<S>) -> Result<(), E::Error> {
        self.passage = None;
        self.engine.restart(now)
    }

    fn step(&mut self, end: S) -> Result<Advance, E::Error> {
        self.passage = None;
        if !self.watches {
            return self.engine.step(end);
        }
        loop {
            if let Some(passage) = self.look(end) {
                self.engine.restart(&passage.to)?;
                self.passage = Some(Box::new(passage));
                return Ok(Advance::Stepped);
            }
            self.before.clone_from(self.engine.now());
            let before = self.before.time.to_f64();
            let soon = before + AHEAD * self.stride;
            let stop = self.aim.filter(|aim| *aim > before && *aim < soon);
            let stop = stop.map(S::from_f64).filter(|aim| *aim < end).unwrap_or(end);
            let advance = self.engine.step(stop)?;
            self.count_turn(before);
            let Some(left) = self.passed_over() else { return Ok(advance) };
            // back, and up to where a passage begins
            self.engine.restart(&self.before)?;
            self.refuses = self.near <= 0.0;
            if self.refuses {
                return Ok(Advance::Stepped);
            }
            let turn = left * self.pace;
            self.aim = Some(before + left * (1.0 - OVERSHOOT * self.near / turn).max(0.0));
            (self.stride, self.turned, self.allowance) = (left, turn, 0.0);
        }
    }

    fn now(&self) -> &Snapshot<S> {
        self.engine.now()
    }

    fn began(&self) -> S {
        match &self.passage {
            Some(passage) => passage.from.time,
            None => self.engine.began(),
        }
    }

    fn within(&mut self, time: S, at: &mut Snapshot<S>) -> Result<(), E::Error> {
        match &self.passage {
            Some(passage) if time < passage.to.time => {
                passage.at(time, at);
                Ok(())
            }
            _ => self.engine.within(time, at),
        }
    }

    fn glance(&mut self, time: S, accuracy: f64, at: &mut Snapshot<S>) -> Result<(), E::Error> {
        match &self.passage {
            Some(_) => self.within(time, at),
            None => self.engine.glance(time, accuracy, at),
        }
    }

    fn glances_are_steps(&self) -> bool {
        self.engine.glances_are_steps()
    }

    fn fired(&self) -> &[bool] {
        self.engine.fired()
    }

    fn counts(&self) -> Vec<Count> {
        self.engine.counts()
    }
}
