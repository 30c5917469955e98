//! Mechanisms without freedom: assembled at each time, nothing is integrated.
//!
//! Position and velocity at a time follow from the constraints alone (Newton from the last
//! sample, on the branch that the start chose), accelerations and forces from one solve. The
//! work of the drives is a Gauss–Legendre quadrature of their power.

use super::extremes::{Look, Parts, Tracker};
use super::passage::Passage;
use super::passing::{Exact, passage_near};
use super::{
    Checkpoint, Error, Event, EventKind, Progress, Reached, Recorder, RulingCounts, Schedule,
    Stretch, Watcher,
};
use crate::dae::{Fault, Snapshot, State, System};
use crate::halt;
use crate::mechanism::{Mechanism, Observation};
use crate::model::Owner;
use crate::scalar::Scalar;
use std::convert::Infallible;
use std::ops::ControlFlow;

/// The fastest body turns by no more than this angle (rad) from one assembly to the next.
const LARGEST_TURN: f64 = 0.05;

/// Strides that are gone to a time that is asked for: as far as a minute leads.
const MOST_STRIDES: f64 = 1e7;

/// Nodes and weights of the four-point Gauss–Legendre rule on [0, 1] (Abramowitz, Stegun 1964,
/// table 25.4), as functions of √(6/5) to have them in every arithmetic.
fn gauss<S: Scalar>() -> [(S, S); 4] {
    let half = S::ratio(1, 2);
    let root = S::ratio(6, 5).sqrt() * S::ratio(2, 7);
    let inner = (S::ratio(3, 7) - root).sqrt() * half;
    let outer = (S::ratio(3, 7) + root).sqrt() * half;
    let thirty = S::from_f64(30.0).sqrt();
    let heavy = (S::from_f64(18.0) + thirty) / S::from_f64(72.0);
    let light = (S::from_f64(18.0) - thirty) / S::from_f64(72.0);
    [(half - outer, light), (half - inner, heavy), (half + inner, heavy), (half + outer, light)]
}

/// Runs a mechanism without freedom through a part of its schedule. The mechanism is at its start.
///
/// # Errors
/// See [`Error`]: a position that cannot be reached or is singular, or a recorder's.
pub fn kinematic<S: Scalar, R: Recorder + ?Sized>(
    mechanism: &mut Mechanism<S>,
    schedule: &Schedule,
    stretch: &Stretch<'_, S>,
    recorder: &mut R,
    watch: Watcher<'_>,
) -> Result<Reached<S>, Error<Infallible, R::Error>> {
    match go(mechanism, schedule, stretch, recorder, watch) {
        Err(Error::System { time, .. }) if halt::is_asked() => Err(Error::Interrupted { time }),
        gone => gone,
    }
}

fn go<S: Scalar, R: Recorder + ?Sized>(
    mechanism: &mut Mechanism<S>,
    schedule: &Schedule,
    stretch: &Stretch<'_, S>,
    recorder: &mut R,
    watch: Watcher<'_>,
) -> Result<Reached<S>, Error<Infallible, R::Error>> {
    let mut walk = Walk::new(mechanism.start().clone());
    let fastest = mechanism.fastest_turn().max(1e-300);
    let rule = gauss();
    let corners = mechanism.corners();
    let mut progress = Progress::default();
    let mut tracker = (recorder.keeps_revolutions())
        .then(|| Tracker::new(mechanism.measures(), mechanism.revolution(), mechanism.length()));
    let mut next = 0;
    if let Some(kept) = stretch.from {
        (progress, next) = (kept.progress, kept.next_sample);
        walk = Walk::new(kept.state.clone());
        let time = walk.now.time;
        let fault = |source| Error::System { time: time.to_f64(), source };
        walk.reach(mechanism, time).map_err(fault)?;
        if let (Some(tracker), Some(records)) = (&mut tracker, &kept.extremes) {
            tracker.take_up(records);
            tracker.restart(time.to_f64(), |values| mechanism.measure(values));
        }
    }
    loop {
        let sample = Some(next).filter(|next| *next < schedule.len());
        let sample = sample.map(|next| schedule.time::<S>(next));
        let only_here = schedule.is_only_of_the_end(next);
        let due = |time: &S| stretch.until.is_none_or(|until| *time <= until && !only_here);
        let sample = sample.filter(due);
        let Some(time) = sample.or(stretch.until) else { break };
        let span = time - walk.now.time;
        let parts = (span.to_f64() * fastest / LARGEST_TURN).ceil().max(1.0);
        for part in 1..=parts as u64 {
            let left = parts - part as f64 + 1.0;
            let to = walk.now.time + (time - walk.now.time) * S::from_f64(1.0 / left);
            let to = if left > 1.0 { to } else { time };
            let fault = |source| Error::System { time: to.to_f64(), source };
            let begin = walk.now.time;
            for (corner, owner) in corners.iter().filter(|(corner, _)| *corner <= to) {
                // the quadrature sees no jump
                if *corner > walk.now.time && *corner < to {
                    walk.advance(mechanism, *corner, &rule).map_err(fault)?;
                }
                if *corner > begin && *corner < schedule.duration() {
                    let (time, kind) = (corner.to_f64(), EventKind::CourseChanges);
                    let event = Event { time, owner: *owner, kind, rate: 0.0 };
                    recorder.event(event).map_err(Error::Recorder)?;
                    progress.events += 1;
                }
            }
            walk.advance(mechanism, to, &rule).map_err(fault)?;
            if let Some((time, owner)) = walk.passed.take_if(|(time, _)| *time <= to) {
                let (time, kind) = (time.to_f64(), EventKind::Singular);
                let event = Event { time, owner, kind, rate: 0.0 };
                recorder.event(event).map_err(Error::Recorder)?;
                progress.events += 1;
            }
            if let Some(tracker) = &mut tracker {
                follow(tracker, mechanism, &walk, recorder)?;
            }
            progress.steps += 1;
            progress.step = (span.to_f64()) / parts;
            progress.time = to.to_f64();
            if progress.steps.is_multiple_of(super::PROGRESS_EVERY)
                && watch(&progress) == ControlFlow::Break(())
            {
                return Err(Error::Interrupted { time: progress.time });
            }
        }
        if sample.is_none() {
            let extremes = tracker.as_mut().map(|tracker| tracker.hold());
            let kept = Checkpoint { extremes, ..Checkpoint::bare(walk.now, next, progress) };
            return Ok(Reached::Checkpoint(Box::new(kept)));
        }
        let observation = mechanism.observe(schedule.time(next), &walk.now.integrals);
        next += 1;
        progress.samples += 1;
        recorder.sample(&observation).map_err(Error::Recorder)?;
    }
    if let Some(last) = tracker.and_then(|tracker| tracker.last(walk.now.time.to_f64())) {
        recorder.revolution(&last).map_err(Error::Recorder)?;
    }
    let _ = watch(&progress);
    Ok(Reached::End(RulingCounts::default()))
}

/// Follows the extremes to where the mechanism now stands; leaves it there.
fn follow<S: Scalar, R: Recorder + ?Sized>(
    tracker: &mut Tracker,
    mechanism: &mut Mechanism<S>,
    walk: &Walk<S>,
    recorder: &mut R,
) -> Result<(), Error<Infallible, R::Error>> {
    let time = walk.now.time.to_f64();
    if walk.passage.is_some() {
        // what is told in a passage may have no bound
        tracker.rest();
        return Ok(());
    }
    if !tracker.has_begun() {
        tracker.restart(time, |values| mechanism.measure(values));
        return Ok(());
    }
    tracker.arrive(time, |values| mechanism.measure(values));
    if !tracker.has_moved() {
        return Ok(());
    }
    if tracker.is_quiet(mechanism.pace_squared()) {
        tracker.go_on();
        return Ok(());
    }
    let failed = |source| Error::System { time, source };
    // what stands for a sketch is assembled, and exact
    let whole = Parts { count: 1, sketched: true, phase: 0.0 };
    tracker.examine(whole, &mut Nearby { mechanism, walk: walk.clone() }).map_err(failed)?;
    for revolution in tracker.finished() {
        recorder.revolution(&revolution).map_err(Error::Recorder)?;
    }
    walk.clone().reach(mechanism, walk.now.time).map_err(failed)
}

/// A mechanism that is assembled at times near to the last.
struct Nearby<'a, S> {
    mechanism: &'a mut Mechanism<S>,
    walk: Walk<S>,
}

impl<S: Scalar> Look for Nearby<'_, S> {
    type Error = Fault;

    fn look(&mut self, time: f64, _: bool, values: &mut [f64]) -> Result<f64, Fault> {
        self.walk.reach(self.mechanism, S::from_f64(time))?;
        self.mechanism.measure(values);
        Ok(time)
    }

    fn sketch(&mut self, time: f64, values: &mut [f64]) -> Result<(), Fault> {
        self.look(time, true, values).map(|_| ())
    }
}

/// A time is out of reach.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("it is {strides:.1e} strides of 0.05 rad away, of which {MOST_STRIDES:e} are gone")]
pub struct TooFar {
    /// Turns of the fastest body on the way, in strides.
    pub strides: f64,
}

/// A mechanism without freedom and without clearance, at any time that is asked for.
#[derive(Debug, Clone)]
pub struct Assembled<S> {
    mechanism: Mechanism<S>,
    walk: Walk<S>,
    stride: f64,
}

impl<S: Scalar> Assembled<S> {
    /// Takes a mechanism at its start; `None` if it has freedoms or clearances, so that its
    /// motion does not follow from the drives alone.
    pub fn new(mechanism: Mechanism<S>) -> Option<Self> {
        let follows = mechanism.freedoms() == 0 && mechanism.modes().is_empty();
        let walk = Walk::new(mechanism.start().clone());
        let stride = LARGEST_TURN / mechanism.fastest_turn().max(1e-300);
        follows.then_some(Assembled { mechanism, walk, stride })
    }

    /// Time (s) in which the body that is the fastest at the start turns by 0.05 rad.
    pub fn stride(&self) -> f64 {
        self.stride
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &Mechanism<S> {
        &self.mechanism
    }

    /// Whether it was last evaluated beside a singular position at which forces of joints have no bound.
    pub fn has_no_bound(&self) -> bool {
        self.walk.passage.as_ref().is_some_and(|passage| passage.has_pole)
    }

    /// Everything at a time (s), to the rounding of the arithmetic; nearest is quickest, as the
    /// way there from the time asked for last is gone in strides. Works are not carried along:
    /// `drive_work` and `residual` of the energies mean nothing.
    ///
    /// # Errors
    /// A position that cannot be reached or is singular.
    pub fn observe(&mut self, time: S) -> Result<Observation, Fault> {
        let from = self.walk.now.time;
        let strides = ((time - from).abs().to_f64() / self.stride).ceil().max(1.0);
        if !(strides <= MOST_STRIDES) {
            return Err(Fault::Fatal(Box::new(TooFar { strides })));
        }
        for k in 1..strides as u64 {
            let part = S::from_f64(k as f64 / strides);
            self.walk.reach(&mut self.mechanism, from + (time - from) * part)?;
        }
        self.walk.reach(&mut self.mechanism, time)?;
        Ok(self.mechanism.observe(time.to_f64(), &self.walk.now.integrals))
    }
}

/// Where a mechanism without freedom stands, and the passage that it is in.
#[derive(Debug, Clone)]
struct Walk<S> {
    now: Snapshot<S>,
    passage: Option<Box<Passage<S>>>,
    /// When it was in the last singular position that it came to, and whose constraints depended on the
    /// others there, until that is told.
    passed: Option<(S, Owner)>,
    exact: Exact,
}

impl<S: Scalar> Walk<S> {
    fn new(now: Snapshot<S>) -> Self {
        Walk { now, passage: None, passed: None, exact: Exact::default() }
    }

    /// Goes on to a time: work of the drives on the way, then the state there, evaluated.
    fn advance(
        &mut self,
        mechanism: &mut Mechanism<S>,
        to: S,
        rule: &[(S, S); 4],
    ) -> Result<(), Fault> {
        let (begin, mut integrals) = (self.now.time, self.now.integrals.clone());
        let span = to - begin;
        if span > S::zero() {
            for (node, weight) in rule {
                self.reach(mechanism, begin + span * *node)?;
                for (sum, power) in integrals.iter_mut().zip(mechanism.powers()) {
                    *sum += span * *weight * *power;
                }
            }
        }
        self.reach(mechanism, to)?;
        self.now.integrals = integrals;
        Ok(())
    }

    /// Moves to another time: along velocity and acceleration, then onto the constraints; in as many
    /// strides as keep it on its branch. Beside a dead centre the other branch is near, and
    /// Newton's method ends on either: where it moves the mechanism by more than a share of what the
    /// stride does, or the sign of det Φ_q changes, the stride is halved. Through a singular position where
    /// two branches cross a passage leads.
    fn reach(&mut self, mechanism: &mut Mechanism<S>, time: S) -> Result<(), Fault> {
        if let Some(passage) = &self.passage {
            let (from, to) = (&passage.from, &passage.to);
            let (first, last) = if from.time < to.time { (from, to) } else { (to, from) };
            if first.time <= time && time <= last.time {
                passage.show(mechanism, time, &mut self.now);
                return Ok(());
            }
            self.now.clone_from(if time < first.time { first } else { last });
            self.passage = None;
        }
        let mut nearest = f64::INFINITY;
        if time != self.now.time && self.finds_passage(mechanism, time, &mut nearest) {
            return self.reach(mechanism, time);
        }
        let mut looked = self.now.time;
        let mut to = time;
        for _ in 0..MOST_PARTS {
            match stride(mechanism, &mut self.now, to) {
                Ok(true) if to == time => return Ok(()),
                Ok(true) => to = time,
                fell => {
                    let moved = std::mem::replace(&mut looked, self.now.time) != self.now.time;
                    if moved && self.finds_passage(mechanism, time, &mut nearest) {
                        return self.reach(mechanism, time);
                    }
                    let half = self.now.time + (to - self.now.time) * S::ratio(1, 2);
                    if half == self.now.time || half == to {
                        fell?;
                        break;
                    }
                    to = half;
                }
            }
        }
        Err(Fault::Fatal(Box::new(Undecided { time: self.now.time.to_f64() })))
    }

    /// Enters the passage through a singular position that is near on the way to a time (s), if there is
    /// one, and it is nearer than where none was found before.
    fn finds_passage(&mut self, mechanism: &mut Mechanism<S>, time: S, nearest: &mut f64) -> bool {
        let found = passage_near(mechanism, &self.now, time > self.now.time, nearest);
        let found = found.filter(|passage| self.exact.agrees(mechanism, passage));
        if let Some(passage) = &found {
            self.passed = Some((passage.time(), passage.owner));
        }
        self.passage = found.map(Box::new);
        self.passage.is_some()
    }
}

/// Strides that a way to the next time may be parted into.
const MOST_PARTS: usize = 10_000;
/// By what share of a stride its end may be corrected, beside what rounding makes.
const CORRECTED: f64 = 0.05;
/// What rounding makes of a position, in units of the last place of the size of the mechanism.
const ROUNDING: f64 = 1e3;

/// Two branches are nearer to each other than the arithmetic can tell.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the mechanism passes a dead centre at t = {time:e} s so closely that this arithmetic cannot \
     tell on which side it goes on"
)]
pub struct Undecided {
    /// Where it stands (s).
    pub time: f64,
}

/// Moves a state to another time if its prediction was near enough and on its branch, or leaves it.
fn stride<S: Scalar>(
    mechanism: &mut Mechanism<S>,
    state: &mut Snapshot<S>,
    to: S,
) -> Result<bool, Fault> {
    let span = to - state.time;
    let (mut q, mut v) = (state.q.clone(), state.v.clone());
    let mut branch = None;
    if span != S::zero() {
        mechanism.evaluate(State { time: state.time, q: &q, v: &v, z: &state.z, carried: None })?;
        for (k, a) in mechanism.accelerations().iter().enumerate() {
            q[k] += span * (v[k] + span * *a * S::ratio(1, 2));
            v[k] += span * *a;
        }
        branch = Some(mechanism.branch());
    }
    let expected = q.clone();
    mechanism.project(to, &mut q, &mut v)?;
    let size = |k: usize| mechanism.scales().0[k];
    let largest = |of: &dyn Fn(usize) -> S| {
        (0..q.len()).map(|k| of(k).abs().to_f64() / size(k)).fold(0.0, f64::max)
    };
    let moved = largest(&|k| expected[k] - state.q[k]);
    let corrected = largest(&|k| q[k] - expected[k]);
    let near = corrected <= CORRECTED * moved + ROUNDING * S::EPSILON;
    if branch.is_some_and(|branch| !near || mechanism.branch() != branch) {
        return Ok(false);
    }
    (state.time, state.q, state.v) = (to, q, v);
    mechanism.evaluate(state.state())?;
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gauss_rule_is_exact_to_degree_seven() {
        for degree in 0..8 {
            let sum: f64 = gauss::<f64>().iter().map(|(x, w)| w * x.powi(degree)).sum();
            assert!((sum - 1.0 / f64::from(degree + 1)).abs() < 4.0 * f64::EPSILON, "{degree}");
        }
    }
}
