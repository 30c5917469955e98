//! True extrema of penetration and force within a step.

use super::recorder::{Peak, Recorder};
use super::{Mark, Outcome, Run};
use crate::dae::Engine;
use crate::mechanism::{ContactRates, Mechanism};
use crate::scalar::Scalar;

/// Looks at a step's inside that one root may take.
const MOST_LOOKS: usize = 60;
/// Accuracy of a look, beyond that of the doubles that are told.
const GLANCE: f64 = 1e-18;

impl<S, E, R> Run<'_, S, E, R>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
    R: Recorder,
{
    /// Follows every open contact through the last step: rates at its end, maxima inside it.
    /// Marks what adaptive sampling must not miss.
    pub(super) fn follow_contacts(&mut self) -> Outcome<(), S, E, R> {
        self.marks.clear();
        // all ends first: a look inside the step moves the system away from them
        let ends: Vec<Option<ContactRates<S>>> =
            (0..self.touching.len()).map(|k| self.engine.system().contact_rates(k)).collect();
        for (k, end) in ends.into_iter().enumerate() {
            let Some((begin, end)) = self.touching[k].as_ref().map(|t| t.last).zip(end) else {
                continue;
            };
            if begin.rate > S::zero() && end.rate <= S::zero() {
                let (_, rates) = self.root(k, begin, end, |rates| rates.rate)?;
                self.deepest(k, rates.depth);
            }
            if begin.force_rate > S::zero() && end.force_rate <= S::zero() {
                let (time, rates) = self.root(k, begin, end, |rates| rates.force_rate)?;
                self.strongest(k, time.to_f64(), rates.force.to_f64());
                self.marks.push(Mark { time, peak: Some((k, rates.force.to_f64())) });
            }
            self.mark_bend(&begin, &end);
            self.deepest(k, end.depth);
            let noise = self.noise(end.slope.to_f64());
            if let Some(touching) = self.touching[k].as_mut() {
                touching.last = end;
                touching.pulled |= end.force < S::zero();
                self.peaks.extend(touching.follow(end.force.to_f64(), noise));
            }
        }
        Ok(())
    }

    fn deepest(&mut self, k: usize, depth: S) {
        let number = self.touching[k].as_ref().map(|touching| touching.number);
        if let Some(contact) = number.and_then(|number| self.contacts.get(number)) {
            contact.peak_penetration = contact.peak_penetration.max(depth.to_f64());
        }
    }

    fn strongest(&mut self, k: usize, time: f64, force: f64) {
        let Some(touching) = self.touching[k].as_mut() else { return };
        touching.maximum(Peak { time, clearance: k, force });
        if let Some(contact) = self.contacts.get(touching.number)
            && force > contact.peak_force
        {
            (contact.peak_force, contact.peak_time) = (force, time);
        }
    }

    /// The time (s) within the last step at which a rate of contact `k` falls through zero, and
    /// all its rates there: regula falsi with the Illinois rule.
    fn root(
        &mut self,
        k: usize,
        begin: ContactRates<S>,
        end: ContactRates<S>,
        of: impl Fn(&ContactRates<S>) -> S,
    ) -> Outcome<(S, ContactRates<S>), S, E, R> {
        let (mut left, mut right) = (self.engine.began(), self.engine.now().time);
        let (mut above, mut below) = (of(&begin), of(&end));
        let mut found = (right, end);
        // extrema are flat: half the digits of the time give all of the value, and the time
        // itself is wanted to the rounding of a double
        let close = (right - left) * S::from_f64(1e-10);
        let mut side = 0;
        for _ in 0..MOST_LOOKS {
            if right - left <= close || below == S::zero() {
                break;
            }
            let aim = left + (right - left) * (above / (above - below));
            let time = self.glance(aim, left, right)?;
            let Some(rates) = self.engine.system().contact_rates(k) else { break };
            let value = of(&rates);
            let moved = (time - found.0).abs();
            found = (time, rates);
            if value > S::zero() {
                (left, above) = (time, value);
                if side == 1 {
                    below *= S::from_f64(0.5);
                }
                side = 1;
            } else {
                (right, below) = (time, value);
                if side == -1 {
                    above *= S::from_f64(0.5);
                }
                side = -1;
            }
            if moved <= close {
                break;
            }
        }
        Ok(found)
    }

    /// Has the system evaluated near a time, between two others (s); returns where.
    fn glance(&mut self, aim: S, left: S, right: S) -> Outcome<S, S, E, R> {
        let glanced = self.engine.glance(aim, GLANCE, &mut self.scratch);
        glanced.map_err(|source| self.stopped(source))?;
        if !(self.scratch.time > left && self.scratch.time < right) {
            let landed = self.engine.within(aim, &mut self.scratch);
            landed.map_err(|source| self.stopped(source))?;
        }
        self.evaluate()?;
        Ok(self.scratch.time)
    }
}
