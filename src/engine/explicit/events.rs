//! Events of the explicit engine: which are due, which lie in a step, and how to land on them.

use super::flow::Gauge;
use super::stepper::{Stepper, two_sum};
use super::{Drawing, Explicit, ExplicitError};
use crate::dae::{Advance, Fault, System};
use crate::engine::guard::{Found, Look, first_rise};
use crate::scalar::Scalar;

/// Partial steps that a landing may take.
const MOST_PARTIAL_STEPS: usize = 600;
/// How much more accurate a partial step is repeated whose miss tells no sign.
const FINER: f64 = 1e-4;
/// Partial steps of a landing after which its bracket is halved by every second one.
const TRUSTED_STEPS: usize = 12;
/// Tolerance of the first partial step of a landing.
const FIRST_ACCURACY: f64 = 1e-8;
/// What the last correction of a landing may leave, in units of the tolerance.
const LEFT: f64 = 0.1;
/// The same for an event, at the most.
const MET: f64 = 1e-12;
/// Change of a landing's length, as a fraction of the step, from which on partial steps become
/// more accurate.
const CLOSE: f64 = 1e-2;
/// Corrections after a landing on an event, each of which squares what is left.
const MOST_CORRECTIONS: usize = 6;
/// Tolerance of partial steps that need only tell a sign.
const ROUGH: f64 = 1e-12;
/// A value is of doubtful sign below this, in units of what the tolerance makes of it.
const DOUBT: f64 = 1e3;

/// How an approach stands to its zero at the begin of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// Below zero: a rise through zero is an event.
    Below,
    /// At zero, on the way down: the next rise is an event.
    Leaving,
    /// Above zero, or not watched: only after a fall can there be an event.
    Passed,
    /// At zero, on the way up: there is an event now.
    Due,
}

/// What a partial step is to meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Target<S> {
    /// The event of this function.
    Event(usize),
    /// A time.
    Time(S),
}

/// Something to land on, alone within a bracket.
#[derive(Debug, Clone, Copy)]
struct Candidate<S> {
    target: Target<S>,
    /// Lengths of steps that lead before and beyond it.
    bracket: [S; 2],
    /// Where it is thought to be.
    guess: S,
}

impl<S: Scalar, Y: System<S>> Explicit<S, Y> {
    /// Finds out how each approach stands, after a restart.
    pub(super) fn arm(&mut self) -> Result<(), Fault> {
        for k in 0..self.standing.len() {
            self.standing[k] = if self.is_watched(k) { self.stands(k)? } else { Standing::Passed };
            self.armed[k] = self.flow.system.watches()[k].direction;
        }
        Ok(())
    }

    /// Whether function `k`, which has just fired, is still at that zero. A function that fired on
    /// its way down and is watched for its way down again has been replaced by another, which may
    /// stand anywhere: the edges of a friction law follow one another in the same function.
    fn is_where_it_fired(&self, k: usize) -> bool {
        let turned = self.flow.system.watches()[k].direction != self.armed[k];
        let noise = self.noise(self.here.approach_rates[k].to_f64());
        self.fired[k] && (turned || self.here.approaches[k].to_f64().abs() <= noise)
    }

    fn stands(&mut self, k: usize) -> Result<Standing, Fault> {
        let (value, rate) =
            (self.here.approaches[k].to_f64(), self.here.approach_rates[k].to_f64());
        let fired = self.is_where_it_fired(k);
        let at_zero = fired || value.abs() <= self.noise(rate);
        if !at_zero && value < 0.0 {
            return Ok(Standing::Below);
        }
        if !at_zero && rate <= 0.0 {
            // at the zero of a root time stands still, and all that is counted by it
            let still = rate == 0.0 && self.flow.pace_at(&self.here.y) == S::zero();
            let rises = still && self.here.courses[k].rate > 0.0;
            return Ok(if rises { Standing::Due } else { Standing::Passed });
        }
        if rate < 0.0 && matches!(self.flow.gauges()[k], Gauge::Root { .. }) {
            return Ok(Standing::Leaving);
        }
        let moment = self.length_of(self.options.initial_step);
        let direction = if rate.abs() * moment > self.noise(rate) { rate } else { self.bend(k)? };
        // what moves it by less than rounding is no direction
        Ok(match direction {
            _ if direction * moment <= self.noise(0.0) => Standing::Leaving,
            _ if fired => Standing::Passed,
            _ => Standing::Due,
        })
    }

    /// Which way an approach turns that stands still here: its rate a moment later.
    fn bend(&mut self, k: usize) -> Result<f64, Fault> {
        let moment = S::from_f64(self.length_of(self.options.initial_step));
        let len = self.flow.len();
        for i in 0..len {
            self.probe.y[i] = self.here.y[i] + moment * self.here.rates[i];
        }
        self.flow.evaluate(&self.probe.y)?;
        self.evaluated_here = false;
        Ok(self.flow.approach_rate(k).to_f64())
    }

    /// Fires the events that are due without a step. Returns whether there are any.
    pub(super) fn fire_standing(&mut self) -> bool {
        for (fired, standing) in self.fired.iter_mut().zip(&mut self.standing) {
            if *standing == Standing::Due {
                *fired = true;
                *standing = Standing::Passed;
            }
        }
        self.fired.contains(&true)
    }

    /// Finds out how each approach stands, after a step.
    pub(super) fn settle(&mut self) {
        for k in 0..self.standing.len() {
            if !self.is_watched(k) || self.fired[k] {
                continue;
            }
            let value = self.here.approaches[k];
            let rate = self.here.approach_rates[k].to_f64();
            let noise = self.noise(rate).max(self.here.courses[k].noise);
            // it has risen, but by no more than a step is looked through for
            let hardly = value >= S::zero() && value.to_f64() <= noise && rate > 0.0;
            self.standing[k] = match self.standing[k] {
                _ if self.is_as_good_as_there(k) => Standing::Due,
                Standing::Below if hardly => Standing::Due,
                _ if value < S::zero() => Standing::Below,
                Standing::Leaving if value.to_f64() <= self.noise(0.0) => Standing::Leaving,
                _ => Standing::Passed,
            };
        }
    }

    /// Whether a root falls, and will reach zero sooner than the time can tell. Two roots that
    /// tend to zero together never do so in τ, and below the tolerance they may stay where they
    /// are: what time is left then is of the square of the tolerance.
    fn is_as_good_as_there(&self, k: usize) -> bool {
        let Some(slot) = self.flow.slot(k) else { return false };
        let i = self.flow.root(slot);
        let (sigma, rate) = (self.here.y[i].to_f64(), self.here.rates[i].to_f64());
        let others = self.flow.roots().len() > 1;
        if others && rate < 0.0 && sigma <= self.options.tolerance * self.deepest[k] {
            return true;
        }
        let pace = self.flow.pace_at(&self.here.y).to_f64();
        let left = sigma * pace / f64::from(self.flow.roots()[slot].degree);
        rate < 0.0 && left <= -rate * self.time().abs() * S::EPSILON
    }

    /// Looks for events in the step from `from` to `here`, and for its `end`; where there are
    /// any, the step is cut at the first. `None` if time has gone back: the step was too long.
    pub(super) fn meet_events(&mut self, end: S) -> Result<Option<Advance>, ExplicitError> {
        let mut landed = None;
        for _ in 0..self.standing.len() + 3 {
            let Some(Candidate { target, bracket, guess }) = self.first_candidate(landed, end)?
            else {
                break;
            };
            self.length = self.land(target, bracket, guess)?;
            self.drawing = Drawing::Absent;
            std::mem::swap(&mut self.here, &mut self.probe);
            self.touch_down(target).map_err(|fault| self.fault(fault))?;
            landed = Some(target);
        }
        let time = self.flow.time();
        if self.here.y[time] < self.from.y[time] {
            return Ok(None);
        }
        if let Some(target) = landed {
            self.fire(target);
        }
        let event = self.fired.contains(&true);
        Ok(Some(if event { Advance::Event } else { Advance::Stepped }))
    }

    /// Makes exact what was landed on, and evaluates the system there.
    fn touch_down(&mut self, target: Target<S>) -> Result<(), Fault> {
        let exact = match target {
            Target::Time(time) => Some((self.flow.time(), time)),
            Target::Event(k) => self.flow.slot(k).map(|slot| (self.flow.root(slot), S::zero())),
        };
        if let Some((i, value)) = exact {
            self.here.y[i] = value;
            self.here.low[i] = S::zero();
        }
        self.arrive()?;
        match target {
            Target::Event(k) if exact.is_none() => self.close_in(k),
            _ => Ok(()),
        }
    }

    /// Moves along the flow until event function `k` is zero to rounding. What a landing leaves is
    /// within the tolerance, but may be on the wrong side of a neighbouring event.
    fn close_in(&mut self, k: usize) -> Result<(), Fault> {
        for _ in 0..MOST_CORRECTIONS {
            let (value, rate) = (self.here.approaches[k], self.here.approach_rates[k]);
            let change = -(value / rate);
            let small = change.to_f64().abs() <= self.options.tolerance * self.length.to_f64();
            if !small || value.to_f64().abs() <= 0.1 * self.noise(rate.to_f64()) {
                return Ok(());
            }
            let here = &mut self.here;
            for i in 0..self.flow.len() {
                let step = change * here.rates[i] + here.low[i];
                (here.y[i], here.low[i]) = two_sum(here.y[i], step);
            }
            self.length += change;
            self.arrive()?;
        }
        Ok(())
    }

    /// Marks the events at the place landed on: that one, and those which are zero with it.
    fn fire(&mut self, target: Target<S>) {
        for k in 0..self.fired.len() {
            let passed = !self.is_watched(k) || self.standing[k] == Standing::Passed;
            let value = self.here.approaches[k].to_f64();
            let rate = self.here.approach_rates[k].to_f64();
            let near = match target {
                Target::Event(_) => value >= -self.noise(rate),
                Target::Time(_) => value > 0.0,
            };
            if target == Target::Event(k) || (!passed && near && rate > 0.0) {
                self.fired[k] = true;
                self.standing[k] = Standing::Passed;
            }
        }
    }

    /// What comes first in the step, beside what it was cut at already. Beyond the zero of a root
    /// time goes back, where nothing can be looked for by time: a step is cut there before anything.
    fn first_candidate(
        &mut self,
        landed: Option<Target<S>>,
        end: S,
    ) -> Result<Option<Candidate<S>>, ExplicitError> {
        let root = self.first_event(landed, true)?;
        let time = self.flow.time();
        if root.is_some() || self.here.y[time] < self.from.y[time] {
            return Ok(root);
        }
        let event = self.first_event(landed, false)?;
        let end = if self.here.y[time] > end { self.at_end(end) } else { None };
        Ok(match (event, end) {
            (Some(event), Some(end)) if event.bracket[1] < end.bracket[1] => Some(event),
            (event, None) => event,
            (_, end) => end,
        })
    }

    /// The first event of a root in the step, or of what is no root.
    fn first_event(
        &mut self,
        landed: Option<Target<S>>,
        of_roots: bool,
    ) -> Result<Option<Candidate<S>>, ExplicitError> {
        let mut first: Option<Candidate<S>> = None;
        for k in 0..self.standing.len() {
            let is_root = matches!(self.flow.gauges()[k], Gauge::Root { .. });
            let passed_over = is_root != of_roots || landed == Some(Target::Event(k));
            if passed_over || !self.is_watched(k) {
                continue;
            }
            if let Some([low, high]) = self.first_rise(k)? {
                let bracket = [low.0, high.0];
                if first.is_none_or(|first| bracket[1] < first.bracket[1]) {
                    let guess = low.0 + (high.0 - low.0) * S::from_f64(rise(low.1, high.1));
                    first = Some(Candidate { target: Target::Event(k), bracket, guess });
                }
            }
        }
        Ok(first)
    }

    fn at_end(&self, end: S) -> Option<Candidate<S>> {
        Some(Candidate {
            target: Target::Time(end),
            bracket: [S::zero(), self.length],
            guess: self.length * S::from_f64(self.place_of(end)),
        })
    }

    /// The first event of function k in the step, if there is one: places before and behind it,
    /// and what was seen there.
    fn first_rise(&mut self, k: usize) -> Result<Option<[(S, Look); 2]>, ExplicitError> {
        let (mut begin, end) = (self.look_at_begin(k), self.look_at_end(k));
        if matches!(self.flow.gauges()[k], Gauge::Root { .. }) && self.flow.roots().len() > 1 {
            // roots that tend to zero together decay as e^(−τ): no polynomial bounds that, and
            // beyond zero time goes back
            let risen = end.course.value >= 0.0 && self.standing[k] != Standing::Passed;
            return Ok(risen.then_some([(S::zero(), begin), (self.length, end)]));
        }
        self.places.clear();
        self.places.extend([(begin.at, S::zero()), (end.at, self.length)]);
        let above = begin.course.value > begin.course.noise;
        match (self.standing[k], above) {
            // above zero, or left there by a projection: first it has to fall
            (Standing::Passed, _) | (Standing::Leaving, true) => {
                let reversed = |look: Look| Look { course: look.course.reversed(), ..look };
                let found = first_rise(reversed(begin), reversed(end), |at| {
                    self.look(k, at).map(reversed)
                })?;
                let Found::Rise(_, fallen) = found else { return Ok(None) };
                begin = reversed(fallen);
            }
            _ => begin.course.value = begin.course.value.min(0.0),
        }
        match first_rise(begin, end, |at| self.look(k, at))? {
            Found::Nothing => Ok(None),
            // what is to be called true is to be proven
            Found::Unproven if S::EPSILON < f64::EPSILON => {
                Err(ExplicitError::Unproven { time: self.step_begin(), function: k })
            }
            Found::Unproven => {
                self.tally.unproven += 1;
                Ok(None)
            }
            Found::Rise(low, high) => {
                Ok(Some([low, high].map(|look| (self.place_seen(look.at), look))))
            }
        }
    }

    /// A place of the step by what it was seen at: the time from the step's begin (s), for a root
    /// the length.
    fn place_seen(&self, at: f64) -> S {
        let seen = self.places.iter().find(|(seen, _)| *seen == at);
        seen.map_or(self.length, |(_, place)| *place)
    }

    fn look_at_begin(&self, k: usize) -> Look {
        Look { at: 0.0, course: self.from.courses[k] }
    }

    fn look_at_end(&self, k: usize) -> Look {
        let time = self.flow.time();
        let at = match self.flow.gauges()[k] {
            Gauge::Root { .. } => self.length,
            _ => self.here.y[time] - self.from.y[time],
        };
        Look { at: at.to_f64(), course: self.here.courses[k] }
    }

    /// What function k is near a place within the step; that place is kept.
    fn look(&mut self, k: usize, at: f64) -> Result<Look, ExplicitError> {
        let time = self.flow.time();
        let by_length = matches!(self.flow.gauges()[k], Gauge::Root { .. });
        let place = match by_length || self.flow.roots().is_empty() {
            true => S::from_f64(at),
            false => {
                let then = self.from.y[time] + S::from_f64(at);
                self.length * S::from_f64(self.place_of(then))
            }
        };
        let tolerance = self.options.tolerance;
        let mut accuracy = tolerance.max(ROUGH);
        let course = loop {
            self.look_in(place, accuracy)?;
            let evaluated = self.flow.evaluate(&self.probe.y);
            evaluated
                .map_err(|source| ExplicitError::System { time: self.step_begin(), source })?;
            let course = self.flow.course(&self.probe.y, k);
            if accuracy == tolerance || course.value.abs() > DOUBT * accuracy * course.grain {
                break course;
            }
            accuracy = tolerance;
        };
        let at = match by_length {
            true => at,
            false => (self.probe.y[time] - self.from.y[time]).to_f64(),
        };
        self.places.push((at, place));
        Ok(Look { at, course })
    }

    /// Value and rate (per unit of τ) of an approach where the last partial step led.
    fn approach_at_probe(&mut self, k: usize) -> Result<(S, S), ExplicitError> {
        let time = self.step_begin();
        let fault = |source| ExplicitError::System { time, source };
        self.evaluate_probe().map_err(fault)?;
        let rate = self.flow.approach_rate(k);
        let probe = &mut self.probe;
        self.flow.approaches(&probe.y, &mut probe.approaches).map_err(fault)?;
        Ok((probe.approaches[k], rate))
    }

    /// Evaluates the system where the last partial step led. Cosines and sines are those of the
    /// angles, as whoever looks at the state will have them: those carried along are off by the
    /// tolerance.
    fn evaluate_probe(&mut self) -> Result<(), Fault> {
        let probe = &mut self.probe;
        self.flow.reset_turns(&mut probe.y);
        let turns = self.flow.first_turn()..self.flow.first_offset();
        probe.low[turns].fill(S::zero());
        self.flow.evaluate(&probe.y)
    }

    /// What is left to the target where the last partial step led, and its rate; takes the rates
    /// of the state there too.
    fn miss(&mut self, target: Target<S>) -> Result<(S, S), ExplicitError> {
        let miss = match target {
            Target::Event(k) => self.approach_at_probe(k)?,
            Target::Time(time) => {
                let (begin, i, probe) = (self.step_begin(), self.flow.time(), &self.probe);
                let evaluated = self.flow.evaluate(&probe.y);
                evaluated.map_err(|source| ExplicitError::System { time: begin, source })?;
                ((probe.y[i] - time) + probe.low[i], self.flow.pace_at(&probe.y))
            }
        };
        self.flow.rates_here(&self.probe.y, &mut self.probe.rates);
        Ok(miss)
    }

    /// Newton's iteration on the place in the step, kept in its bracket, until a correction to
    /// second order is all that is left. The partial steps are as accurate as the iteration has
    /// become. Leaves the state in `probe` and returns its place, as a length from `from`.
    pub(super) fn land(
        &mut self,
        target: Target<S>,
        bracket: [S; 2],
        guess: S,
    ) -> Result<S, ExplicitError> {
        let span = self.length.to_f64();
        let tolerance = self.options.tolerance;
        // a method of one order takes no cheaper partial steps
        let adapts = matches!(self.stepper, Stepper::Extrapolation(_));
        let roughest = if adapts { FIRST_ACCURACY.max(tolerance) } else { tolerance };
        // an event is met to the rounding of doubles however loose the tolerance: samples before it
        // must not see it
        let left = match target {
            Target::Event(_) => LEFT * tolerance.min(MET),
            Target::Time(_) => LEFT * tolerance,
        };
        let [mut low, mut high] = bracket;
        let half = S::from_f64(0.5);
        let mut at = Iterate { place: guess.max(low).min(high), accuracy: roughest };
        let mut last: Option<Iterate<S>> = None;
        for count in 0..MOST_PARTIAL_STEPS {
            self.partial(at.place, at.accuracy)?;
            let (miss, rate) = self.miss(target)?;
            let change = -(miss / rate);
            let aim = at.place + change;
            let size = change.to_f64().abs() / span;
            let done = size * size * at.doubt(last, span) <= left;
            let inside = aim >= bracket[0] && aim <= bracket[1];
            if at.accuracy == tolerance && done && inside {
                return Ok(self.correct(at.place, last, miss, rate));
            }
            // the sign of what is missed may be that of the partial step's error
            let doubt = DOUBT * at.accuracy * self.grain(target);
            let reliable = at.accuracy == tolerance || miss.to_f64().abs() > doubt;
            if reliable && miss > S::zero() {
                high = high.min(at.place.max(low))
            } else if reliable {
                low = low.max(at.place.min(high))
            }
            if at.accuracy == tolerance && (high - low).to_f64() <= 4.0 * S::EPSILON * span {
                // the bracket is the zero, to rounding
                return Ok(at.place);
            }
            let aimed = aim >= low && aim <= high && rate > S::zero();
            let halves = count > TRUSTED_STEPS && count.is_multiple_of(2);
            if aimed && !halves {
                let expected = (size * size).max(10.0 * at.accuracy);
                let finish = expected * expected * (size + at.accuracy / size) < LEFT * tolerance;
                let accuracy = match size < CLOSE {
                    true if finish => tolerance,
                    true => 1e-3 * expected * expected,
                    false => at.accuracy,
                };
                self.remember(rate);
                last = Some(at);
                at = Iterate { place: aim, accuracy };
            } else if reliable {
                at.place = (low + high) * half;
            } else {
                at.accuracy *= FINER;
            }
            if count > TRUSTED_STEPS {
                at.accuracy = tolerance;
            }
            at.accuracy = at.accuracy.clamp(tolerance, roughest);
        }
        let target = match target {
            Target::Event(k) => format!("the event of function {k}"),
            Target::Time(time) => format!("t = {:e} s", time.to_f64()),
        };
        Err(ExplicitError::Landing { time: self.step_begin(), target })
    }

    /// What a relative error of the state in `probe` makes of what is missed of a target.
    fn grain(&self, target: Target<S>) -> f64 {
        match target {
            Target::Event(k) => self.flow.course(&self.probe.y, k).grain,
            Target::Time(_) => self.sizes[self.flow.time()],
        }
    }

    /// Keeps the rates of an iterate, for the bend of the last one.
    fn remember(&mut self, rate: S) {
        std::mem::swap(&mut self.last_rates, &mut self.probe.rates);
        self.last_rate = rate;
    }

    /// The last correction of a landing, to second order where there is an iterate before this
    /// one to tell the second derivatives.
    fn correct(&mut self, place: S, last: Option<Iterate<S>>, miss: S, rate: S) -> S {
        let mut change = -(miss / rate);
        let half = S::from_f64(0.5);
        let last = last.filter(|last| last.place != place);
        let inverse = last.map_or(S::zero(), |last| S::one() / (place - last.place));
        let bend = (rate - self.last_rate) * inverse;
        change -= half * change * change * bend / rate;
        let square = half * change * change * inverse;
        let probe = &mut self.probe;
        for i in 0..self.flow.len() {
            let (f, before) = (probe.rates[i], self.last_rates[i]);
            let second = if last.is_some() { square * (f - before) } else { S::zero() };
            let step = change * f + second + probe.low[i];
            (probe.y[i], probe.low[i]) = two_sum(probe.y[i], step);
        }
        place + change
    }
}

/// A place that a landing has tried, and the tolerance of the partial step there.
#[derive(Debug, Clone, Copy)]
struct Iterate<S> {
    place: S,
    accuracy: f64,
}

impl<S: Scalar> Iterate<S> {
    /// Relative error of a second derivative from this place and the one before.
    fn doubt(&self, last: Option<Iterate<S>>, span: f64) -> f64 {
        last.map_or(1.0, |last| {
            let apart = (self.place - last.place).to_f64().abs() / span;
            (apart + last.accuracy / apart).min(1.0)
        })
    }
}

/// Where between two looks, as a share of the way, the cubic through them rises through zero.
fn rise(from: Look, to: Look) -> f64 {
    let (a, b, width) = (&from.course, &to.course, to.at - from.at);
    let cubic = |s: f64| {
        let r = 1.0 - s;
        (1.0 + 2.0 * s) * r * r * a.value
            + s * r * r * a.rate * width
            + s * s * (3.0 - 2.0 * s) * b.value
            - s * s * r * b.rate * width
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if cubic(middle) > 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}
