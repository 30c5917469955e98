//! The loop over segments: advance, record, project, switch mode, restart.
//!
//! Samples are taken from the state that the engine has inside its last step, projected onto the
//! constraints, with accelerations, multipliers and forces solved afresh. At an event the state
//! that the engine returns is projected, never polished, and the new mode is latched from it.

mod checkpoint;
mod collocation;
mod erased;
mod extremes;
mod inside;
mod kinematic;
mod passage;
mod passing;
mod peak;
mod recorder;
mod sampling;
mod schedule;
mod touching;
mod trajectory;
mod window;
mod witness;

pub use checkpoint::{Checkpoint, Checkpoints, NotACheckpoint, Reached, Stretch};
pub(crate) use erased::{AnyRecorder, Erased, NotKept};
pub use extremes::LEFT_OUT;
pub use kinematic::{Assembled, TooFar, Undecided, kinematic};
pub use recorder::*;
pub use schedule::{SampleWindow, Schedule};
pub use trajectory::Trajectory;
pub use witness::Contradiction;

use crate::clearance::{Clearance, EventSlot, Mode};
use crate::dae::{Advance, Direction, Engine, Fault, Snapshot, System};
use crate::halt;
use crate::mechanism::{Ledger, Mechanism};
use crate::model::Owner;
use crate::scalar::{Scalar, bits};
use extremes::Tracker;
use inside::End;
use passing::Passing;
use sampling::Mark;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use touching::{Contacts, Touching};
use window::Window;
use witness::{Bounds, Witness};

/// Drift off the constraints that has the state projected and the engine restarted, over the
/// mechanism's characteristic length.
const DRIFT: f64 = 5e-12;
/// The same in units of the tolerance, where that is more and no penetration is a part as small.
const DRIFT_ERRORS: f64 = 5.0;
/// Off by so many roundings of the largest coordinate is no drift: far from the origin no
/// projection comes nearer.
const DRIFT_ROUNDINGS: f64 = 64.0;
/// Steps between two looks at the drift.
const DRIFT_EVERY: u64 = 50;
/// Constraints that others leave less of than this make steps as small as they are.
const SINGULAR: f64 = 1e-10;
/// By how much, in units of the tolerance, an event function of order one may be beyond its zero
/// and yet not have fired: what projections and errors of the slip over v1 come to, and more.
const MISSED: f64 = 1e8;
/// Steps between two words of progress.
const PROGRESS_EVERY: u64 = 256;

/// Why a run stopped short.
#[derive(Debug, thiserror::Error)]
pub enum Error<E: std::error::Error + 'static, R: std::error::Error + 'static> {
    /// The engine gave up.
    #[error("the simulation stopped at t = {time:e} s, in segment {segment}")]
    Engine {
        /// Where the run stood (s).
        time: f64,
        /// Number of the segment between two events, from 1.
        segment: u64,
        /// What the engine says.
        source: E,
    },
    /// The mechanism stands in a singular position, or nearly so.
    #[error(
        "the mechanism has come to a singular position (a dead centre) at t = {time:e} s: the \
         constraints of {joint} depend on the others but for {left:.1e} of them, and how it goes on \
         is not clear"
    )]
    Singular {
        /// Where the run stood (s).
        time: f64,
        /// What it is that the others hold already, nearly.
        owner: Owner,
        /// Its key.
        joint: String,
        /// What the others leave of what the joint holds: a share of the squares.
        left: f64,
        /// What the engine says, if it gave up by itself.
        source: Option<E>,
    },
    /// The mechanism could not be evaluated.
    #[error("the mechanism could not be evaluated at t = {time:e} s")]
    System {
        /// Where (s).
        time: f64,
        /// What the mechanism says.
        source: Fault,
    },
    /// The engine went past an event.
    #[error("an event of {watched} was missed before t = {time:e} s")]
    Missed {
        /// Key of the joint, or the load, whose event it was.
        watched: String,
        /// Where it was noticed (s).
        time: f64,
    },
    /// What the run has come to cannot be.
    #[error("the run contradicts itself")]
    Contradiction(#[source] Contradiction),
    /// A journal is so deep in its bearing that no contact law means anything.
    #[error(
        "the {} of {clearance} is {depth:.4e} m deep in its {} at t = {time:e} s; its \
         contact law means nothing beyond {allowed:.4e} m, {why}. A mechanism that cannot turn, a stiffness in other units than \
         N/m^n or a load far too large comes to this: `freeplay check` says which is likely",
        .surfaces[0],
        .surfaces[1]
    )]
    TooDeep {
        /// Key of the joint.
        clearance: String,
        /// What touches, and what it touches.
        surfaces: [&'static str; 2],
        /// Penetration (m).
        depth: f64,
        /// The largest that is believed (m).
        allowed: f64,
        /// What sets it.
        why: String,
        /// Where (s).
        time: f64,
    },
    /// What was to be kept could not be.
    #[error(transparent)]
    Recorder(R),
    /// Whoever watches asked to stop.
    #[error("interrupted at t = {time:e} s")]
    Interrupted {
        /// Where the run stood (s).
        time: f64,
    },
}

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Progress {
    /// Simulated time (s).
    #[serde(with = "bits")]
    pub time: f64,
    /// Length of the last step (s).
    #[serde(with = "bits")]
    pub step: f64,
    /// Steps so far.
    pub steps: u64,
    /// Events so far.
    pub events: u64,
    /// Samples recorded so far.
    pub samples: u64,
    /// Contacts begun so far.
    pub contacts: u64,
}

/// How often the decisions that clearances hold (DESIGN.md) were called on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct RulingCounts {
    /// Contacts that began slower than their `minimum_impact_rate`.
    pub slow_approaches: u64,
    /// Contacts in which the law pulled.
    pub tensions: u64,
}

/// Who watches a run: is told of its progress, and may stop it.
pub type Watcher<'a> = &'a mut dyn FnMut(&Progress) -> ControlFlow<()>;

/// Result of a run that uses engine `E` and recorder `R`.
type Outcome<T, S, E, R> = Result<T, Error<<E as Engine<S>>::Error, <R as Recorder>::Error>>;

/// A run in progress.
struct Run<'a, S: Scalar, E: Engine<S>, R: ?Sized> {
    engine: Passing<'a, S, E>,
    recorder: &'a mut R,
    schedule: &'a Schedule,
    ledger: Ledger,
    /// Relative tolerance of the engine: what it makes of a steady force is no peak.
    tolerance: f64,
    /// Whether it leads to a checkpoint, and not to the end of the run.
    goes_on: bool,
    next_sample: u64,
    /// Its time (s); `None` behind the last.
    next_time: Option<S>,
    /// Times within the last step that adaptive sampling looks at.
    marks: Vec<Mark<S>>,
    window: Window,
    witness: Witness,
    scratch: Snapshot<S>,
    touching: Vec<Option<Touching<S>>>,
    /// Largest penetrations that the contact laws are believed for (m), by clearance.
    allowed_depths: Vec<f64>,
    contacts: Contacts,
    peaks: Vec<Peak>,
    /// Extremes of the present revolution; `None` where nobody keeps them.
    tracker: Option<Box<Tracker>>,
    /// Square of the fastest pace (rad²/s²) at the last step's begin, and of that within it.
    paces: [f64; 2],
    /// Ends of the last step, where it was sketched.
    ends: [End<S>; 2],
    progress: Progress,
    segment: u64,
    /// Whether the mechanism stood in a singular position when it was last looked at.
    singular: bool,
    counts: RulingCounts,
}

/// Runs a mechanism from its start to the end of the schedule.
///
/// `tolerance` is the relative tolerance the engine works to.
///
/// # Errors
/// See [`Error`]; what was recorded until then stays recorded.
pub fn run<S, E, R>(
    engine: &mut E,
    schedule: &Schedule,
    tolerance: f64,
    recorder: &mut R,
    watch: Watcher<'_>,
) -> Outcome<RulingCounts, S, E, R>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
    R: Recorder + ?Sized,
{
    match stretch(engine, schedule, &Stretch::WHOLE, tolerance, recorder, watch)? {
        Reached::End(counts) => Ok(counts),
        Reached::Checkpoint(kept) => Ok(kept.rulings),
    }
}

/// Runs a mechanism through a part of its schedule. The engine is new, and its mechanism at its start
/// or, behind a checkpoint, about to be put where that has it.
///
/// # Errors
/// See [`Error`]; what was recorded until then stays recorded.
pub fn stretch<S, E, R>(
    engine: &mut E,
    schedule: &Schedule,
    stretch: &Stretch<'_, S>,
    tolerance: f64,
    recorder: &mut R,
    watch: Watcher<'_>,
) -> Outcome<Reached<S>, S, E, R>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
    R: Recorder + ?Sized,
{
    let start = engine.system().start().clone();
    let system = engine.system();
    let (clearances, length) = (system.modes().len(), system.length());
    let speed = system.scales().1.first().copied().unwrap_or(0.0);
    let mass = system.model().masses().iter().map(|mass| mass.to_f64()).sum();
    let names = system.model().names().clearances.clone();
    let frictions = system.model().clearances().iter();
    let frictions = frictions.map(|clearance| clearance.friction.map(Bounds::of)).collect();
    let allowed_depths =
        system.model().clearances().iter().map(Clearance::believed_depth).collect();
    let tracker = recorder
        .keeps_revolutions()
        .then(|| Box::new(Tracker::new(system.measures(), system.revolution(), system.length())));
    let mut run = Run {
        scratch: start.clone(),
        touching: vec![None; clearances],
        allowed_depths,
        ledger: engine.system().ledger(),
        engine: Passing::new(engine, tolerance),
        recorder,
        schedule,
        tolerance,
        goes_on: stretch.until.is_some(),
        next_sample: 0,
        next_time: None,
        marks: Vec::new(),
        window: Window::new(clearances, f64::NEG_INFINITY),
        witness: Witness::new(names, frictions, [length, speed, mass], tolerance),
        contacts: Contacts::default(),
        peaks: Vec::new(),
        tracker,
        paces: [0.0; 2],
        ends: End::both(&start),
        progress: Progress::default(),
        segment: 1,
        singular: false,
        counts: RulingCounts::default(),
    };
    let begun = match stretch.from {
        Some(kept) => run.take_up(kept),
        None => run.restart(&start),
    };
    let going = begun.and_then(|()| run.go(stretch, &mut *watch));
    let going = match (going, stretch.until) {
        (Ok(()), Some(_)) => match run.keep() {
            Ok(kept) => return Ok(Reached::Checkpoint(Box::new(kept))),
            Err(error) => Err(error),
        },
        (going, _) => going,
    };
    let going = match going {
        Err(Error::Singular { time, owner, left, .. }) if !halt::is_asked() => {
            let event = Event { time, owner, kind: EventKind::Singular, rate: left };
            run.recorder.event(event).map_err(Error::Recorder).and(going)
        }
        going => going,
    };
    // contacts still open and peaks not settled belong to what was simulated, however it ended
    let closing = run.close();
    // the last word, whether or not it asks to stop
    let _ = watch(&run.progress);
    match going {
        // whatever stood in the way then was the request
        Err(Error::Engine { .. } | Error::Singular { .. } | Error::System { .. })
            if halt::is_asked() =>
        {
            Err(Error::Interrupted { time: run.engine.now().time.to_f64() })
        }
        going => going.and(closing).map(|()| Reached::End(run.counts)),
    }
}

impl<S, E, R> Run<'_, S, E, R>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
    R: Recorder + ?Sized,
{
    fn go(&mut self, stretch: &Stretch<'_, S>, watch: Watcher<'_>) -> Outcome<(), S, E, R> {
        if stretch.from.is_none() {
            self.await_sample(0);
            self.begin_contacts()?;
        }
        // at the start, or at an end that is a checkpoint
        self.sample(false)?;
        self.check_depths()?;
        let end: S = stretch.until.unwrap_or_else(|| self.schedule.duration());
        let mut corners = self.engine.system().corners();
        corners.retain(|(corner, _)| *corner < self.schedule.duration());
        while self.engine.now().time < end {
            let before = self.engine.now().time;
            let corner =
                corners[corners.partition_point(|(corner, _)| *corner <= before)..].first();
            let corner = corner.map(|(corner, _)| *corner).filter(|corner| *corner <= end);
            let until = corner.unwrap_or(end);
            let advance = self.engine.step(until).map_err(|source| self.stopped(source))?;
            if self.engine.now().time < before {
                let [from, to] = [before, self.engine.now().time].map(Scalar::to_f64);
                return Err(Error::Contradiction(Contradiction::TimeGoesBack { from, to }));
            }
            self.progress.steps += 1;
            if self.engine.refuses() {
                let now = self.engine.now().clone();
                let weakest = self.engine.system().weakest_joint(now.state());
                let (owner, left) = weakest.unwrap_or_default();
                return Err(self.singular_position(owner, left, None));
            }
            self.arrive();
            if S::EPSILON < f64::EPSILON {
                self.check_modes()?;
            }
            self.follow_contacts()?;
            self.follow_extremes()?;
            self.sample(advance == Advance::Event)?;
            self.check_depths()?;
            if self.engine.passage().is_some() {
                self.pass()?;
            }
            match advance {
                Advance::Event => self.event()?,
                Advance::Stepped if Some(self.engine.now().time) == corner => {
                    let here = corners.iter().filter(|(time, _)| Some(*time) == corner);
                    self.begin_anew(here.map(|(_, owner)| *owner))?;
                }
                Advance::Stepped if self.progress.steps.is_multiple_of(DRIFT_EVERY) => {
                    self.hold()?
                }
                Advance::Stepped => {}
            }
            // steps in many digits take long
            if S::EPSILON < f64::EPSILON || self.progress.steps.is_multiple_of(PROGRESS_EVERY) {
                self.tell(watch)?;
            }
        }
        Ok(())
    }

    /// Takes apart what goes on from the checkpoint where the run stands.
    fn keep(&mut self) -> Outcome<Checkpoint<S>, S, E, R> {
        self.let_samples_go(&[])?;
        self.flush()?;
        self.scratch.clone_from(self.engine.now());
        self.project()?;
        self.withdraw()?;
        Ok(Checkpoint {
            modes: self.engine.system().modes().to_vec(),
            sampled_until: self.window.seen_until(),
            touching: self.touching.iter().map(|open| open.as_ref().map(Touching::hold)).collect(),
            contacts: std::mem::take(&mut self.contacts),
            peaks: std::mem::take(&mut self.peaks),
            extremes: self.tracker.as_mut().map(|tracker| tracker.hold()),
            energy: self.witness.energy,
            segment: self.segment + 1,
            rulings: self.counts,
            ..Checkpoint::bare(self.scratch.clone(), self.next_sample, self.progress)
        })
    }

    /// Goes on from a checkpoint.
    fn take_up(&mut self, kept: &Checkpoint<S>) -> Outcome<(), S, E, R> {
        for (k, mode) in kept.modes.iter().enumerate() {
            self.engine.system().set_mode(k, *mode);
        }
        if let (Some(tracker), Some(records)) = (&mut self.tracker, &kept.extremes) {
            tracker.take_up(records);
        }
        self.contacts = kept.contacts.clone();
        self.peaks.clone_from(&kept.peaks);
        self.window = Window::new(self.touching.len(), kept.sampled_until);
        self.witness.energy = kept.energy;
        (self.progress, self.segment, self.counts) = (kept.progress, kept.segment, kept.rulings);
        self.await_sample(kept.next_sample);
        self.engine.system().pass_gates_at(kept.state.state());
        self.restart(&kept.state)?;
        for (k, held) in kept.touching.iter().enumerate() {
            let rates = self.engine.system().contact_rates(k);
            let open = held.as_ref().zip(rates);
            self.touching[k] = open.map(|(held, rates)| Touching::take_up(held, rates));
        }
        Ok(())
    }

    /// Whether the modes are still those of the state, as far as a reference is to be believed: two
    /// runs that miss the same event agree.
    fn check_modes(&mut self) -> Outcome<(), S, E, R> {
        let now = self.engine.now().clone();
        let time = now.time.to_f64();
        let fired = self.engine.fired().to_vec();
        let system = self.engine.system();
        let mut values = vec![S::zero(); system.watches().len()];
        system
            .event_values(now.state(), &mut values)
            .map_err(|source| Error::System { time, source })?;
        let watched = values.iter().zip(system.watches()).zip(fired);
        let beyond = watched.into_iter().position(|((value, watch), fired)| {
            let off = match watch.direction {
                _ if fired => 0.0,
                Direction::Off => 0.0,
                Direction::Rising => value.to_f64(),
                Direction::Falling => -value.to_f64(),
            };
            off > MISSED * self.tolerance
        });
        let Some(slot) = beyond else { return Ok(()) };
        let system = self.engine.system();
        let watched = system.watched(slot);
        Err(Error::Missed { watched, time })
    }

    /// Whether every contact is as shallow as its law can be believed, at the end of the step.
    fn check_depths(&mut self) -> Outcome<(), S, E, R> {
        let depths = self.touching.iter().map(|touching| touching.as_ref().map(|t| t.last.depth));
        let depths = depths.map(|depth| depth.map_or(0.0, S::to_f64));
        let mut beyond = depths.zip(&self.allowed_depths).enumerate();
        match beyond.find(|(_, (depth, allowed))| !(depth <= *allowed)) {
            Some((k, (depth, _))) => Err(self.too_deep(k, depth)),
            None => Ok(()),
        }
    }

    fn too_deep(&mut self, k: usize, depth: f64) -> Error<E::Error, R::Error> {
        let time = self.engine.now().time.to_f64();
        let model = self.engine.system().model();
        Error::TooDeep {
            clearance: format!("joints.{}", model.names().clearances[k]),
            surfaces: model.clearances()[k].surfaces(),
            depth,
            allowed: self.allowed_depths[k],
            why: model.clearances()[k].believed_because(),
            time,
        }
    }

    fn tell(&mut self, watch: Watcher<'_>) -> Outcome<(), S, E, R> {
        let time = self.engine.now().time;
        self.progress.time = time.to_f64();
        self.progress.step = (time - self.engine.began()).to_f64();
        match watch(&self.progress) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Interrupted { time: self.progress.time }),
        }
    }

    fn stopped(&mut self, source: E::Error) -> Error<E::Error, R::Error> {
        let now = self.engine.now().clone();
        let time = now.time.to_f64();
        match self.engine.system().weakest_joint(now.state()) {
            Some((owner, left)) if left < SINGULAR => {
                self.singular_position(owner, left, Some(source))
            }
            _ => Error::Engine { time, segment: self.segment, source },
        }
    }

    /// Refuses to crawl on in a singular position; one that is passed takes few steps.
    fn check_singular(&mut self) -> Outcome<(), S, E, R> {
        let now = self.engine.now().clone();
        let weakest = self.engine.system().weakest_joint(now.state());
        let Some((owner, left)) = weakest.filter(|(_, left)| *left < SINGULAR) else {
            self.singular = false;
            return Ok(());
        };
        match std::mem::replace(&mut self.singular, true) {
            true => Err(self.singular_position(owner, left, None)),
            false => Ok(()),
        }
    }

    fn singular_position(
        &mut self,
        owner: Owner,
        left: f64,
        source: Option<E::Error>,
    ) -> Error<E::Error, R::Error> {
        let joint = owner.key(self.engine.system().model().names()).to_string();
        Error::Singular { time: self.engine.now().time.to_f64(), owner, joint, left, source }
    }

    fn restart(&mut self, at: &Snapshot<S>) -> Outcome<(), S, E, R> {
        self.engine.restart(at).map_err(|source| self.stopped(source))?;
        self.restart_extremes();
        Ok(())
    }

    /// Projects the state in `scratch`; returns how far it was off.
    fn project(&mut self) -> Outcome<f64, S, E, R> {
        let Snapshot { time, q, v, .. } = &mut self.scratch;
        let system = self.engine.system();
        let at = time.to_f64();
        system.project(*time, q, v).map_err(|source| Error::System { time: at, source })
    }

    /// Takes journals in flight in `scratch` out of the walls.
    fn withdraw(&mut self) -> Outcome<(), S, E, R> {
        let Snapshot { time, q, v, .. } = &mut self.scratch;
        let system = self.engine.system();
        let at = time.to_f64();
        system.withdraw(*time, q, v).map_err(|source| Error::System { time: at, source })
    }

    /// Evaluates the system at the state in `scratch`.
    fn evaluate(&mut self) -> Outcome<(), S, E, R> {
        let evaluated = self.engine.system().evaluate(self.scratch.state());
        evaluated.map_err(|source| Error::System { time: self.scratch.time.to_f64(), source })
    }

    /// Restarts from the projected state once the trajectory has drifted off the constraints.
    fn hold(&mut self) -> Outcome<(), S, E, R> {
        if self.engine.system().multipliers() == 0 {
            return Ok(());
        }
        self.check_singular()?;
        self.scratch.clone_from(self.engine.now());
        let drift = self.project()?;
        let (system, q) = (self.engine.system(), &self.scratch.q);
        let sizes = q.iter().zip(system.scales().0).map(|(q, size)| q.abs().to_f64() / size);
        let rounding = DRIFT_ROUNDINGS * S::EPSILON * sizes.fold(0.0, f64::max);
        let errors = if self.touching.is_empty() { DRIFT_ERRORS * self.tolerance } else { 0.0 };
        if drift > rounding.max(DRIFT).max(errors) * system.length() {
            self.withdraw()?;
            let state = self.scratch.clone();
            self.restart(&state)?;
            self.segment += 1;
        }
        Ok(())
    }

    /// Restarts where a derivative of what is prescribed jumps, of these owners.
    fn begin_anew(&mut self, owners: impl Iterator<Item = Owner>) -> Outcome<(), S, E, R> {
        self.scratch.clone_from(self.engine.now());
        for owner in owners {
            self.tell_event(owner, EventKind::CourseChanges, 0.0)?;
        }
        self.project()?;
        let state = self.scratch.clone();
        self.restart(&state)?;
        self.segment += 1;
        Ok(())
    }

    /// Records the singular position that the last step led through.
    fn pass(&mut self) -> Outcome<(), S, E, R> {
        let Some(passage) = self.engine.passage() else { return Ok(()) };
        let owner = passage.owner;
        self.scratch.time = passage.time();
        self.segment += 1;
        self.tell_event(owner, EventKind::Singular, 0.0)?;
        self.restart_extremes();
        Ok(())
    }

    /// Takes every event that fired: records it, switches the mode, restarts.
    fn event(&mut self) -> Outcome<(), S, E, R> {
        self.scratch.clone_from(self.engine.now());
        self.project()?;
        self.evaluate()?;
        let fired: Vec<usize> =
            (0..self.engine.fired().len()).filter(|slot| self.engine.fired()[*slot]).collect();
        let mut begun = Vec::new();
        for slot in fired {
            let Some((k, what)) = self.engine.system().slot(slot) else {
                let owner = self.engine.system().owner(slot);
                self.tell_event(owner, EventKind::CourseChanges, 0.0)?;
                self.engine.system().switch(slot);
                continue;
            };
            let was_flight = self.engine.system().modes()[k] == Mode::Flight;
            if was_flight && what != EventSlot::Depth {
                // the contact that this function belongs to has just ended
                continue;
            }
            self.record_event(k, what, was_flight)?;
            self.engine.system().switch(slot);
            match (what, was_flight) {
                (EventSlot::Depth, true) => begun.push(k),
                (EventSlot::Depth, false) => self.end_contact(k)?,
                _ => {}
            }
        }
        self.withdraw()?;
        self.engine.system().release(&mut self.scratch.z);
        let state = self.scratch.clone();
        self.restart(&state)?;
        self.segment += 1;
        for k in begun {
            self.begin_contact(k)?;
        }
        self.refresh_contacts();
        self.flush()
    }

    fn record_event(
        &mut self,
        clearance: usize,
        what: EventSlot,
        was_flight: bool,
    ) -> Outcome<(), S, E, R> {
        let (mut rate, slip) = self.engine.system().gap_rates(clearance);
        // one that another run had begun tells the rate at which it did
        let begun = self.engine.system().model().contacts()[clearance];
        if let Some(began) = begun.filter(|_| self.scratch.time == S::zero()) {
            rate = began;
        }
        let (kind, rate) = match what {
            EventSlot::Depth if was_flight => (EventKind::ContactBegins, rate),
            EventSlot::Depth => (EventKind::ContactEnds, rate),
            EventSlot::LowerEdge | EventSlot::UpperEdge | EventSlot::InnerEdge(_) => {
                (EventKind::FrictionKink, slip)
            }
            EventSlot::Pull => (EventKind::Tension, rate),
        };
        let time = self.scratch.time.to_f64();
        if let (EventKind::Tension, Some(touching)) = (kind, self.touching[clearance].as_mut()) {
            touching.pulled = true;
        }
        if kind == EventKind::ContactBegins {
            let begins = self.witness.begins(clearance, rate.to_f64(), time);
            begins.map_err(Error::Contradiction)?;
        }
        self.tell_event(Owner::Clearance(clearance), kind, rate.to_f64())
    }

    /// Records an event at the time in `scratch`.
    fn tell_event(&mut self, owner: Owner, kind: EventKind, rate: f64) -> Outcome<(), S, E, R> {
        self.progress.events += 1;
        let event = Event { time: self.scratch.time.to_f64(), owner, kind, rate };
        self.recorder.event(event).map_err(Error::Recorder)
    }

    /// Contacts that the start is in already.
    fn begin_contacts(&mut self) -> Outcome<(), S, E, R> {
        for k in 0..self.touching.len() {
            if self.engine.system().modes()[k] != Mode::Flight {
                self.record_event(k, EventSlot::Depth, true)?;
                self.begin_contact(k)?;
            }
        }
        Ok(())
    }

    /// Opens a contact at the state last evaluated, which is that of a restart.
    fn begin_contact(&mut self, k: usize) -> Outcome<(), S, E, R> {
        let system = self.engine.system();
        let (Mode::Contact(mode), Some(rates)) = (system.modes()[k], system.contact_rates(k))
        else {
            return Ok(());
        };
        if mode.impact_rate < system.model().clearances()[k].minimum_impact_rate {
            self.counts.slow_approaches += 1;
        }
        let now = self.engine.now();
        let begin = now.time.to_f64();
        let number = self.contacts.open(Contact {
            clearance: k,
            begin,
            end: f64::NAN,
            impact_rate: mode.impact_rate.to_f64(),
            peak_penetration: rates.depth.to_f64().max(0.0),
            peak_penetration_time: begin,
            peak_force: rates.force.to_f64(),
            peak_time: begin,
            dissipated: 0.0,
        });
        self.progress.contacts += 1;
        self.window.forget_peaks(k);
        self.touching[k] =
            Some(Touching::new(number, rates, now.integrals[self.ledger.clearance(k)]));
        Ok(())
    }

    /// Closes a contact at the event in `scratch`.
    fn end_contact(&mut self, k: usize) -> Outcome<(), S, E, R> {
        if let Some(number) = self.touching[k].as_ref().map(|touching| touching.number) {
            self.settle(k);
            if let Some(contact) = self.contacts.get(number) {
                contact.end = self.scratch.time.to_f64();
            }
            self.contacts.close(number);
        }
        Ok(())
    }

    /// Takes leave of a contact at the state in `scratch`: its last maximum, its dissipation.
    fn settle(&mut self, k: usize) {
        let Some(touching) = self.touching[k].take() else { return };
        let dissipated =
            self.scratch.integrals[self.ledger.clearance(k)] - touching.dissipated_before;
        self.counts.tensions += u64::from(touching.pulled);
        if let Some(contact) = self.contacts.get(touching.number) {
            contact.dissipated = dissipated.to_f64();
        }
        let noise = self.noise(touching.last.slope.to_f64());
        self.peaks.extend(touching.unsettled(noise));
    }

    /// Rates of the open contacts at a restart, in the modes that now hold.
    fn refresh_contacts(&mut self) {
        for k in 0..self.touching.len() {
            let rates = self.engine.system().contact_rates(k);
            if let (Some(touching), Some(rates)) = (self.touching[k].as_mut(), rates) {
                touching.last = rates;
            }
        }
    }

    /// Hands over contacts and peaks whose turn has come.
    fn flush(&mut self) -> Outcome<(), S, E, R> {
        while let Some(contact) = self.contacts.next(false) {
            self.recorder.contact(contact).map_err(Error::Recorder)?;
        }
        let open = self.touching.iter().flatten().filter_map(Touching::open_since);
        let settled_until = open.fold(f64::INFINITY, f64::min);
        self.peaks.sort_by(|a, b| a.time.total_cmp(&b.time));
        let settled = self.peaks.partition_point(|peak| peak.time < settled_until);
        for peak in self.peaks.drain(..settled) {
            self.recorder.peak(peak).map_err(Error::Recorder)?;
        }
        Ok(())
    }

    /// Hands over what is still open.
    fn close(&mut self) -> Outcome<(), S, E, R> {
        self.scratch.clone_from(self.engine.now());
        for k in 0..self.touching.len() {
            self.settle(k);
        }
        self.let_samples_go(&[])?;
        self.flush()?;
        while let Some(contact) = self.contacts.next(true) {
            self.recorder.contact(contact).map_err(Error::Recorder)?;
        }
        self.close_extremes()
    }

    /// Force (N) that the tolerance makes of nothing, where a contact has this slope (N/m): a
    /// trajectory is off by some tens of times the tolerance of a step.
    fn noise(&mut self, slope: f64) -> f64 {
        100.0 * self.tolerance * self.engine.system().length() * slope.abs()
    }
}
