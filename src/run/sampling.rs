//! Samples of the last step: those due by the schedule, and those that adaptive sampling adds.

use super::recorder::Recorder;
use super::window::is_same_time;
use super::{Outcome, Run};
use crate::dae::Engine;
use crate::mechanism::{ContactRates, Mechanism, Observation};
use crate::scalar::Scalar;

/// Bend of a force curve within a step, over the larger force at its ends, from which on the
/// step's inside is looked at.
const BEND: f64 = 2.5e-3;
/// Looks that one step may take.
const MOST_PARTS: f64 = 64.0;

/// A time within the last step that adaptive sampling looks at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark<S> {
    pub time: S,
    /// The clearance that has a force peak there, and the force (N).
    pub peak: Option<(usize, f64)>,
}

impl<S, E, R> Run<'_, S, E, R>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
    R: Recorder + ?Sized,
{
    /// Records what is due up to now; `at_event` says whether the step ended at an event.
    pub(super) fn sample(&mut self, at_event: bool) -> Outcome<(), S, E, R> {
        if self.schedule.is_adaptive() { self.sample_marks(at_event) } else { self.sample_grid() }
    }

    fn sample_grid(&mut self) -> Outcome<(), S, E, R> {
        while let Some(time) = self.due() {
            let at = self.schedule.time(self.next_sample);
            let observation = self.observe(time, at)?;
            self.record(&observation)?;
            self.await_sample(self.next_sample + 1);
        }
        Ok(())
    }

    /// Time of the next sample of the grid, if it is not beyond now (s). At a checkpoint there is none
    /// that a longer run had not.
    fn due(&self) -> Option<S> {
        let only_here = self.goes_on && self.schedule.is_only_of_the_end(self.next_sample);
        self.next_time.filter(|time| !only_here && *time <= self.engine.now().time)
    }

    /// Makes sample `k` of the grid the next.
    pub(super) fn await_sample(&mut self, k: u64) {
        self.next_sample = k;
        self.next_time = (k < self.schedule.len()).then(|| self.schedule.time(k));
    }

    /// Looks at the grid, the marks and the end of the step, in the order of time.
    fn sample_marks(&mut self, at_event: bool) -> Outcome<(), S, E, R> {
        let mut marks = std::mem::take(&mut self.marks);
        let now = self.engine.now().time;
        if at_event || self.touching.iter().any(Option::is_some) {
            marks.push(Mark { time: now, peak: None });
        }
        marks.sort_by(|a, b| a.time.to_f64().total_cmp(&b.time.to_f64()));
        for mark in &marks {
            self.sample_until(mark.time)?;
            // a sample of the grid that is due some ulps later will stand for it
            let next = self.next_time.map_or(f64::INFINITY, S::to_f64);
            if !is_same_time(mark.time.to_f64(), next) {
                let observation = self.observe(mark.time, mark.time.to_f64())?;
                let keep = mark.peak.is_some() || (at_event && mark.time == now);
                self.window.push(observation, keep);
            }
            if let Some(peak) = mark.peak {
                self.let_samples_go(&[peak])?;
            }
        }
        self.sample_until(now)?;
        self.marks = marks;
        let in_flight = self.touching.iter().all(Option::is_none);
        if at_event || in_flight || self.window.is_full() {
            self.let_samples_go(&[])?;
        }
        Ok(())
    }

    /// Puts the grid's samples up to a time (s) into the window.
    fn sample_until(&mut self, time: S) -> Outcome<(), S, E, R> {
        while let Some(due) = self.due().filter(|due| *due <= time) {
            let at = self.schedule.time(self.next_sample);
            let observation = self.observe(due, at)?;
            self.window.push(observation, true);
            self.await_sample(self.next_sample + 1);
        }
        Ok(())
    }

    /// Closes the window and records its samples.
    pub(super) fn let_samples_go(&mut self, peaks: &[(usize, f64)]) -> Outcome<(), S, E, R> {
        for observation in self.window.close(peaks) {
            self.record(&observation)?;
        }
        Ok(())
    }

    fn record(&mut self, observation: &Observation) -> Outcome<(), S, E, R> {
        self.progress.samples += 1;
        self.recorder.sample(observation).map_err(super::Error::Recorder)
    }

    /// The mechanism at a time within the last step, told as that at `at` (s).
    fn observe(&mut self, time: S, at: f64) -> Outcome<Observation, S, E, R> {
        self.look(time, true)?;
        let observation = self.engine.system().observe(at, &self.scratch.integrals);
        self.witness.see(&observation).map_err(super::Error::Contradiction)?;
        Ok(observation)
    }

    /// Has the system evaluated at a time within the last step; the state stands in `scratch`.
    pub(super) fn look(&mut self, time: S, project: bool) -> Outcome<(), S, E, R> {
        if self.engine.show(time, &mut self.scratch) {
            return Ok(());
        }
        self.engine.within(time, &mut self.scratch).map_err(|source| self.stopped(source))?;
        // where another run stood it was on the constraints, and is to be found to the last bit
        let as_given = time == S::zero() && self.engine.system().model().goes_on();
        if project && !as_given {
            self.project()?;
        }
        self.evaluate()
    }

    /// Marks times inside the last step where the force of a contact bends: a line from end to
    /// end misses a curve with slopes F'₀ and F'₁ by about h |F'₁ − F'₀|/8.
    pub(super) fn mark_bend(&mut self, begin: &ContactRates<S>, end: &ContactRates<S>) {
        if !self.schedule.is_adaptive() {
            return;
        }
        let (from, to) = (self.engine.began(), self.engine.now().time);
        let turn = (end.force_rate - begin.force_rate).abs().to_f64();
        let miss = (to - from).to_f64() * turn / 8.0;
        let allowed = BEND * begin.force.abs().max(end.force.abs()).to_f64();
        let parts = (miss / allowed.max(f64::MIN_POSITIVE)).sqrt().ceil().min(MOST_PARTS);
        for part in 1..parts as u32 {
            let time = from + (to - from) * S::from_f64(f64::from(part) / parts);
            self.marks.push(Mark { time, peak: None });
        }
    }
}
