//! Events of the explicit engine: which are due, which lie in a step, and how to land on them.

use super::flow::Gauge;
use super::search::{Course, Place, Summit};
use super::stepper::{Stepper, two_sum};
use super::{Explicit, ExplicitError};
use crate::dae::{Advance, Fault, System};
use crate::scalar::Scalar;

/// Partial steps that a landing, or the climb to a summit, may take.
const MOST_PARTIAL_STEPS: usize = 80;
/// Tolerance of the first partial step of a landing.
const FIRST_ACCURACY: f64 = 1e-8;
/// What the last correction of a landing may leave, in units of the tolerance.
const LEFT: f64 = 0.1;
/// Change of a landing's length, as a fraction of the step, from which on Newton is trusted.
const CLOSE: f64 = 1e-2;
/// Corrections after a landing on an event, each of which squares what is left.
const MOST_CORRECTIONS: usize = 6;
/// Tolerance of partial steps that need only tell a sign.
const ROUGH: f64 = 1e-12;

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

/// Something to land on, within a bracket.
#[derive(Debug, Clone, Copy)]
struct Candidate<S> {
    target: Target<S>,
    /// Length of a step that leads beyond it.
    reach: S,
    /// Where it is thought to be, as a fraction of the reach.
    guess: f64,
    /// Whether the approach is zero at the begin of the step too.
    leaving: bool,
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
            return Ok(Standing::Passed);
        }
        if rate < 0.0 && matches!(self.flow.gauges()[k], Gauge::Root { .. }) {
            return Ok(Standing::Leaving);
        }
        let moment = self.length_of(self.options.initial_step);
        let direction = if rate.abs() * moment > self.noise(rate) { rate } else { self.bend(k)? };
        Ok(match direction {
            _ if direction <= 0.0 => Standing::Leaving,
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
            self.standing[k] = match self.standing[k] {
                _ if self.is_as_good_as_there(k) => Standing::Due,
                _ if value < S::zero() => Standing::Below,
                Standing::Leaving if value.to_f64() <= self.noise(0.0) => Standing::Leaving,
                _ => Standing::Passed,
            };
        }
    }

    /// Whether a root falls, and will reach zero sooner than the time can tell. Two roots that
    /// tend to zero together never do so in τ.
    fn is_as_good_as_there(&self, k: usize) -> bool {
        let Some(slot) = self.flow.slot(k) else { return false };
        let i = self.flow.root(slot);
        let (sigma, rate) = (self.here.y[i].to_f64(), self.here.rates[i].to_f64());
        let pace = self.flow.pace_at(&self.here.y).to_f64();
        let left = sigma * pace / f64::from(self.flow.roots()[slot].degree);
        rate < 0.0 && left <= -rate * self.time().abs() * S::EPSILON
    }

    /// Looks for events in the step from `from` to `here`, and for its `end`; where there are
    /// any, the step is cut at the first.
    pub(super) fn meet_events(&mut self, end: S) -> Result<Advance, ExplicitError> {
        let mut candidate = self.first_candidate(end)?;
        let mut landed = None;
        for _ in 0..self.standing.len() + 3 {
            let Some(Candidate { target, reach, guess, leaving }) = candidate else { break };
            self.length = self.land(target, reach, guess, leaving)?;
            std::mem::swap(&mut self.here, &mut self.probe);
            self.touch_down(target).map_err(|fault| self.fault(fault))?;
            landed = Some(target);
            candidate = self.earlier_candidate(target, end);
        }
        if let Some(target) = landed {
            self.fire(target);
        }
        Ok(if self.fired.contains(&true) { Advance::Event } else { Advance::Stepped })
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
            if !self.is_watched(k) || self.standing[k] == Standing::Passed {
                continue;
            }
            let value = self.here.approaches[k].to_f64();
            let rate = self.here.approach_rates[k].to_f64();
            let near = match target {
                Target::Event(_) => value >= -self.noise(rate),
                Target::Time(_) => value > 0.0,
            };
            if target == Target::Event(k) || (near && rate > 0.0) {
                self.fired[k] = true;
                self.standing[k] = Standing::Passed;
            }
        }
    }

    fn place(&self, k: usize, end: bool) -> Place {
        let length = self.length.to_f64();
        let (point, fraction) = if end { (&self.here, 1.0) } else { (&self.from, 0.0) };
        let leaving = !end && self.standing[k] == Standing::Leaving;
        let value = if leaving { 0.0 } else { point.approaches[k].to_f64() };
        Place { fraction, value, rate: point.approach_rates[k].to_f64() * length }
    }

    fn first_candidate(&mut self, end: S) -> Result<Option<Candidate<S>>, ExplicitError> {
        let mut first = self.end_candidate(end);
        for k in 0..self.standing.len() {
            if self.is_watched(k) {
                first = earlier_of(first, self.candidate(k)?);
            }
        }
        Ok(first)
    }

    /// Other events that have come to pass before the place landed on.
    fn earlier_candidate(&self, target: Target<S>, end: S) -> Option<Candidate<S>> {
        let at_end = matches!(target, Target::Time(_));
        let mut first = if at_end { None } else { self.end_candidate(end) };
        for k in 0..self.standing.len() {
            let other = self.is_watched(k) && target != Target::Event(k);
            if !other || self.standing[k] == Standing::Passed {
                continue;
            }
            let end = self.place(k, true);
            if end.value > self.noise(self.here.approach_rates[k].to_f64()) {
                let course = Course::new(self.place(k, false), end, std::iter::empty());
                first = earlier_of(first, Some(self.rise(k, &course, 1.0)));
            }
        }
        first
    }

    fn end_candidate(&self, end: S) -> Option<Candidate<S>> {
        let time = self.here.y[self.flow.time()];
        (time > end).then(|| Candidate {
            target: Target::Time(end),
            reach: self.length,
            guess: self.place_of(end),
            leaving: false,
        })
    }

    fn rise(&self, k: usize, course: &Course, limit: f64) -> Candidate<S> {
        Candidate {
            target: Target::Event(k),
            reach: self.length * S::from_f64(limit),
            guess: course.first_rise(limit) / limit,
            leaving: self.standing[k] == Standing::Leaving,
        }
    }

    /// The first event of function k in the step, if there is one.
    fn candidate(&mut self, k: usize) -> Result<Option<Candidate<S>>, ExplicitError> {
        if self.standing[k] == Standing::Passed {
            return Ok(None);
        }
        let (begin, end) = (self.place(k, false), self.place(k, true));
        if let Gauge::Root { .. } = self.flow.gauges()[k] {
            let course = Course::new(begin, end, std::iter::empty());
            return Ok((end.value >= 0.0).then(|| self.rise(k, &course, 1.0)));
        }
        let notes = self.flow.notes();
        let climbing = begin.rate > 0.0 || notes.iter().any(|note| note.rates[k] > 0.0);
        if end.value <= 0.0 && !climbing {
            return Ok(None);
        }
        let mut rates = notes.iter().map(|note| note.rates[k]).chain([end.rate]);
        if end.value <= 0.0 && rates.all(|rate| rate > 0.0) {
            return Ok(None);
        }
        let length = self.length.to_f64();
        let between = notes.iter().map(|note| (note.fraction, note.rates[k] * length));
        let course = Course::new(begin, end, between);
        let rises = end.value > 0.0;
        let limit = if rises { course.first_rise(1.0) } else { 1.0 };
        let summits: Vec<Summit> =
            course.summits().filter(|summit| summit.fraction < limit).collect();
        for summit in summits {
            if let Some(above) = self.climb(k, summit)? {
                return Ok(Some(self.rise(k, &course, above)));
            }
        }
        Ok(rises.then(|| self.rise(k, &course, 1.0)))
    }

    /// Climbs a summit by partial steps. Returns a place above zero, if there is one.
    fn climb(&mut self, k: usize, summit: Summit) -> Result<Option<f64>, ExplicitError> {
        let Summit { mut fraction, mut before, mut after } = summit;
        let mut tolerance = self.options.tolerance.max(ROUGH);
        let length = self.length.to_f64();
        for _ in 0..MOST_PARTIAL_STEPS {
            self.partial(self.length * S::from_f64(fraction), tolerance)?;
            let (value, rate) = self.approach_at_probe(k)?;
            let (value, rate) = (value.to_f64(), rate.to_f64() * length);
            if value.abs() < 1e3 * tolerance && tolerance > self.options.tolerance {
                tolerance = self.options.tolerance;
                continue;
            }
            if value > self.noise(0.0) {
                return Ok(Some(fraction));
            }
            let here = Place { fraction, value, rate };
            let other = if rate > 0.0 { after } else { before };
            let bend = (rate - other.rate) / (fraction - other.fraction);
            let more = if bend < 0.0 { -0.5 * rate * rate / bend } else { f64::INFINITY };
            let width = after.fraction - before.fraction;
            if more < 0.5 * value.abs() || width < 4.0 * f64::EPSILON {
                return Ok(None);
            }
            if rate > 0.0 {
                before = here
            } else {
                after = here
            }
            let share = before.rate / (before.rate - after.rate);
            let share = share.clamp(0.05, 0.95);
            fraction = before.fraction + share * (after.fraction - before.fraction);
        }
        Ok(None)
    }

    /// Value and rate (per unit of τ) of an approach where the last partial step led.
    fn approach_at_probe(&mut self, k: usize) -> Result<(S, S), ExplicitError> {
        let time = self.step_begin();
        let fault = |source| ExplicitError::System { time, source };
        let probe = &mut self.probe;
        self.flow.approaches(&probe.y, &mut probe.approaches).map_err(fault)?;
        self.flow.evaluate(&probe.y).map_err(fault)?;
        Ok((probe.approaches[k], self.flow.approach_rate(k)))
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

    /// Newton's iteration on the place in the step, safeguarded by a bracket, until a correction
    /// to second order is all that is left. The partial steps are as accurate as the iteration
    /// has become. Leaves the state in `probe` and returns its place, as a length from `from`.
    pub(super) fn land(
        &mut self,
        target: Target<S>,
        reach: S,
        guess: f64,
        leaving: bool,
    ) -> Result<S, ExplicitError> {
        let span = reach.to_f64();
        let tolerance = self.options.tolerance;
        // a method of one order takes no cheaper partial steps
        let adapts = matches!(self.stepper, Stepper::Extrapolation(_));
        let roughest = if adapts { FIRST_ACCURACY.max(tolerance) } else { tolerance };
        let (mut low, mut high) = (S::zero(), reach);
        let mut at = Iterate { place: reach * S::from_f64(guess), accuracy: roughest };
        let mut last: Option<Iterate<S>> = None;
        for _ in 0..MOST_PARTIAL_STEPS {
            self.partial(at.place, at.accuracy)?;
            let (miss, rate) = self.miss(target)?;
            let slope = if leaving { rate - miss / at.place } else { rate };
            let change = -(miss / slope);
            let size = change.to_f64().abs() / span;
            let done = size * size * at.doubt(last, span) <= LEFT * tolerance;
            if at.accuracy == tolerance && done {
                return Ok(self.correct(at.place, last, miss, rate));
            }
            let next = at.place + change;
            if size < CLOSE {
                // the sign of what is missed may be that of the partial step's error
                let expected = (size * size).max(10.0 * at.accuracy);
                let finish = expected * expected * (size + at.accuracy / size) < LEFT * tolerance;
                let accuracy = if finish { tolerance } else { 1e-3 * expected * expected };
                self.remember(rate);
                last = Some(at);
                at = Iterate { place: next, accuracy: accuracy.clamp(tolerance, roughest) };
                continue;
            }
            if miss > S::zero() {
                high = at.place
            } else {
                low = at.place
            }
            let inside = next > low && next < high;
            at.place = if inside { next } else { (low + high) * S::from_f64(0.5) };
        }
        let target = match target {
            Target::Event(k) => format!("the event of function {k}"),
            Target::Time(time) => format!("t = {:e} s", time.to_f64()),
        };
        Err(ExplicitError::Landing { time: self.step_begin(), target })
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

/// The earlier of two candidates.
fn earlier_of<S: Scalar>(a: Option<Candidate<S>>, b: Option<Candidate<S>>) -> Option<Candidate<S>> {
    let place = |c: &Candidate<S>| c.guess * c.reach.to_f64();
    match (a, b) {
        (Some(a), Some(b)) => Some(if place(&b) < place(&a) { b } else { a }),
        (a, b) => a.or(b),
    }
}
