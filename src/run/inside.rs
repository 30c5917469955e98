//! Looks into the last step for the extremes of forces, torques and accelerations.

use super::extremes::{Look, Parts, SKETCHABLE};
use super::recorder::Recorder;
use super::{Error, Outcome, Run};
use crate::dae::{Engine, Fault, Snapshot, System};
use crate::mechanism::Mechanism;
use crate::scalar::Scalar;

/// Phase (rad) of the fastest motion that a step may cover and be understood from its ends.
const RESOLVED: f64 = 0.5;
/// Parts of a step at most.
const MOST_PARTS: f64 = 4096.0;
/// Accuracy of a look, beyond that of the doubles that are told.
const ACCURACY: f64 = 1e-12;

/// Why a look into a step failed.
pub(super) enum Unseen<E> {
    Engine(E),
    System { time: f64, source: Fault },
}

impl<S, E, R> Run<'_, S, E, R>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
    R: Recorder + ?Sized,
{
    /// Takes the measures where the last step ended; the system stands evaluated there.
    #[inline]
    pub(super) fn arrive(&mut self) {
        let Some(tracker) = &mut self.tracker else { return };
        let time = self.engine.now().time.to_f64();
        let system = self.engine.system();
        tracker.arrive(time, |values| system.measure(values));
        let pace = system.pace_squared();
        self.paces = [pace, self.paces[0].max(pace)];
    }

    /// Takes the measures at a look into the last step that was had for something else.
    pub(super) fn look_around(&mut self) {
        let Some(tracker) = &mut self.tracker else { return };
        let system = self.engine.system();
        tracker.looked(self.scratch.time.to_f64(), |values| system.measure(values));
        self.paces[1] = self.paces[1].max(system.pace_squared());
    }

    /// Begins anew at a restart, where the curves may have kinks.
    pub(super) fn restart_extremes(&mut self) {
        let Some(tracker) = &mut self.tracker else { return };
        let time = self.engine.now().time.to_f64();
        let system = self.engine.system();
        tracker.restart(time, |values| system.measure(values));
        self.paces = [system.pace_squared(); 2];
    }

    /// Looks into the last step for what beats the extremes of the revolution.
    pub(super) fn follow_extremes(&mut self) -> Outcome<(), S, E, R> {
        let parts = self.parts();
        let Some(tracker) = &mut self.tracker else { return Ok(()) };
        // what is told in a passage may have no bound
        if !tracker.has_moved() || self.engine.passage().is_some() {
            return Ok(());
        }
        if parts.count == 1 && tracker.is_quiet(self.paces[1]) {
            tracker.go_on();
            return Ok(());
        }
        let mut inside = Inside {
            engine: &mut self.engine,
            at: &mut self.scratch,
            ends: &mut self.ends,
            known: false,
        };
        let examined = tracker.examine(parts, &mut inside);
        for revolution in tracker.finished() {
            self.recorder.revolution(&revolution).map_err(Error::Recorder)?;
        }
        examined.map_err(|unseen| match unseen {
            Unseen::Engine(source) => self.stopped(source),
            Unseen::System { time, source } => Error::System { time, source },
        })
    }

    /// Parts in which the last step is to be seen: as many as resolve the motion that it covers.
    fn parts(&self) -> Parts {
        let span = (self.engine.now().time - self.engine.began()).to_f64();
        let phase = (span * span * self.paces[1]).sqrt();
        let count = (phase / RESOLVED).ceil().clamp(1.0, MOST_PARTS) as u32;
        let sketched = count > 1 || self.engine.glances_are_steps();
        Parts { count, sketched: sketched && phase <= SKETCHABLE, phase }
    }

    /// Hands over the revolution that the run ended in.
    pub(super) fn close_extremes(&mut self) -> Outcome<(), S, E, R> {
        let end = self.engine.now().time.to_f64();
        let last = self.tracker.take().and_then(|tracker| tracker.last(end));
        match last {
            Some(last) => self.recorder.revolution(&last).map_err(Error::Recorder),
            None => Ok(()),
        }
    }
}

/// The last step of an engine.
struct Inside<'a, S, E> {
    engine: &'a mut E,
    at: &'a mut Snapshot<S>,
    ends: &'a mut [End<S>; 2],
    /// Whether the ends are those of this step.
    known: bool,
}

/// The state at an end of a step, with its accelerations (m/s², rad/s²) and inner rates.
#[derive(Debug)]
pub(super) struct End<S> {
    state: Snapshot<S>,
    accelerations: Vec<S>,
    inner_rates: Vec<S>,
}

impl<S: Scalar> End<S> {
    /// Space for the ends of steps.
    pub fn both(state: &Snapshot<S>) -> [Self; 2] {
        std::array::from_fn(|_| End {
            state: state.clone(),
            accelerations: Vec::new(),
            inner_rates: Vec::new(),
        })
    }
}

impl<S, E> Inside<'_, S, E>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
{
    /// Evaluates the system at `at`.
    fn evaluate(&mut self) -> Result<(), Unseen<E::Error>> {
        let evaluated = self.engine.system().evaluate(self.at.state());
        let time = self.at.time.to_f64();
        evaluated.map_err(|source| Unseen::System { time, source })
    }

    /// Takes the states at both ends.
    fn know_ends(&mut self) -> Result<(), Unseen<E::Error>> {
        for (k, time) in [self.engine.began(), self.engine.now().time].into_iter().enumerate() {
            self.engine.within(time, self.at).map_err(Unseen::Engine)?;
            self.evaluate()?;
            self.ends[k].state.clone_from(self.at);
            let (system, end) = (self.engine.system(), &mut self.ends[k]);
            end.accelerations.clear();
            end.accelerations.extend_from_slice(system.accelerations());
            end.inner_rates.clear();
            end.inner_rates.extend_from_slice(system.inner_rates());
        }
        self.known = true;
        Ok(())
    }

    /// Puts a sketch of the state at a time into `at`: a quintic through both ends, for inner
    /// states a cubic.
    fn draw(&mut self, time: S) {
        let [from, to] = &*self.ends;
        let (before, after) = (&from.accelerations, &to.accelerations);
        let (rates, later) = (&from.inner_rates, &to.inner_rates);
        let (from, to) = (&from.state, &to.state);
        let span = to.time - from.time;
        let part = (time - from.time) / span;
        let half = S::from_f64(0.5);
        let number = |n: f64| S::from_f64(n);
        self.at.time = time;
        for i in 0..from.q.len() {
            let (q, slope) = (from.q[i], span * from.v[i]);
            let bend = half * span * span * before[i];
            let value = to.q[i] - q - slope - bend;
            let rate = span * to.v[i] - slope - bend - bend;
            let second = span * span * after[i] - bend - bend;
            let third = number(10.0) * value - number(4.0) * rate + half * second;
            let fourth = number(7.0) * rate - number(15.0) * value - second;
            let fifth = number(6.0) * value - number(3.0) * rate + half * second;
            self.at.q[i] = q + part
                * (slope + part * (bend + part * (third + part * (fourth + part * fifth))));
            let inner = number(4.0) * fourth + part * number(5.0) * fifth;
            let slope = slope + part * (bend + bend + part * (number(3.0) * third + part * inner));
            self.at.v[i] = slope / span;
        }
        for i in 0..from.z.len() {
            let (z, slope) = (from.z[i], span * rates[i]);
            let value = to.z[i] - z - slope;
            let rate = span * later[i] - slope;
            let second = number(3.0) * value - rate;
            let third = rate - value - value;
            self.at.z[i] = z + part * (slope + part * (second + part * third));
        }
    }
}

impl<S, E> Look for Inside<'_, S, E>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
{
    type Error = Unseen<E::Error>;

    fn look(&mut self, time: f64, exactly: bool, values: &mut [f64]) -> Result<f64, Self::Error> {
        let (began, now) = (self.engine.began(), self.engine.now().time);
        let aim = S::from_f64(time).max(began).min(now);
        let mut landed = exactly;
        if !exactly {
            self.engine.glance(aim, ACCURACY, self.at).map_err(Unseen::Engine)?;
            landed = !(self.at.time >= began && self.at.time <= now);
        }
        if landed {
            self.engine.within(aim, self.at).map_err(Unseen::Engine)?;
        }
        self.evaluate()?;
        self.engine.system().measure(values);
        Ok(self.at.time.to_f64())
    }

    fn sketch(&mut self, time: f64, values: &mut [f64]) -> Result<(), Self::Error> {
        if !self.known {
            self.know_ends()?;
        }
        self.draw(S::from_f64(time));
        self.evaluate()?;
        self.engine.system().measure(values);
        Ok(())
    }
}
