//! True extrema of penetration and force within a step.

use super::recorder::{Contact, Peak, Recorder};
use super::{Mark, Outcome, Run};
use crate::dae::Engine;
use crate::mechanism::{ContactRates, Mechanism};
use crate::scalar::Scalar;

/// Looks at a step's inside that one root may take.
const MOST_LOOKS: usize = 60;
/// Looks after which the bracket is halved, so that the search ends whatever the rate does.
const TRUSTED_LOOKS: usize = 12;
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
                let (time, rates) = self.summit(k, begin, end, |at| (at.depth, at.rate))?;
                self.deepest(k, time.to_f64(), rates.depth.to_f64());
            }
            if rises(&begin) && end.force_rate <= S::zero() {
                let (time, rates) = self.summit(k, begin, end, |at| (at.force, at.force_rate))?;
                self.strongest(k, time.to_f64(), rates.force.to_f64());
                self.marks.push(Mark { time, peak: Some((k, rates.force.to_f64())) });
            }
            self.mark_bend(&begin, &end);
            let now = self.engine.now().time.to_f64();
            self.deepest(k, now, end.depth.to_f64());
            self.hardest(k, now, end.force.to_f64());
            let noise = self.noise(end.slope.to_f64());
            if let Some(touching) = self.touching[k].as_mut() {
                touching.last = end;
                touching.pulled |= end.force < S::zero();
                self.peaks.extend(touching.follow(end.force.to_f64(), noise));
            }
        }
        Ok(())
    }

    /// The open contact, if clearance `k` is in one.
    fn contact(&mut self, k: usize) -> Option<&mut Contact> {
        let number = self.touching[k].as_ref()?.number;
        self.contacts.get(number)
    }

    /// Takes a penetration (m) at a time (s) as a candidate for the contact's largest.
    fn deepest(&mut self, k: usize, time: f64, depth: f64) {
        if let Some(contact) = self.contact(k).filter(|contact| depth > contact.peak_penetration) {
            (contact.peak_penetration, contact.peak_penetration_time) = (depth, time);
        }
    }

    /// Takes a force (N) at a time (s) as a candidate for the contact's largest.
    fn hardest(&mut self, k: usize, time: f64, force: f64) {
        if let Some(contact) = self.contact(k).filter(|contact| force > contact.peak_force) {
            (contact.peak_force, contact.peak_time) = (force, time);
        }
    }

    /// Takes note of a maximum of the force (N) at a time (s).
    fn strongest(&mut self, k: usize, time: f64, force: f64) {
        if let Some(touching) = &mut self.touching[k] {
            touching.maximum(Peak { time, clearance: k, force });
        }
        self.hardest(k, time, force);
    }

    /// The time (s) within the last step at which a quantity of contact `k` is largest, and what
    /// the contact is there: the zero of its rate by Muller's iteration, kept in a bracket.
    /// `of` gives the quantity and its rate.
    fn summit(
        &mut self,
        k: usize,
        begin: ContactRates<S>,
        end: ContactRates<S>,
        of: impl Fn(&ContactRates<S>) -> (S, S),
    ) -> Outcome<(S, ContactRates<S>), S, E, R> {
        let (mut left, mut right) = (self.engine.began(), self.engine.now().time);
        let mut found = (right, end);
        // a summit is flat: what is this near to it is as high, and Muller's next place is far
        // nearer still
        let close = (right - left) * S::from_f64(1e-7);
        let ((low, rising), (high, falling)) = (of(&begin), of(&end));
        let mut known = [(left, rising), (right, falling), (right, falling)];
        let mut aim = left + summit_between(right - left, [low, high], [rising, falling]);
        for look in 0..MOST_LOOKS {
            if !(aim > left && aim < right) || look > TRUSTED_LOOKS {
                aim = left + (right - left) * S::from_f64(0.5);
            }
            let time = self.glance(aim, left, right)?;
            let Some(rates) = self.engine.system().contact_rates(k) else { break };
            let rate = of(&rates).1;
            found = (time, rates);
            if rate > S::zero() {
                left = time
            } else {
                right = time
            }
            known = [(time, rate), known[0], known[1]];
            aim = muller(known);
            let inside = aim >= left && aim <= right;
            if (inside && (aim - time).abs() <= close) || right - left <= close {
                return Ok((if inside { aim } else { time }, found.1));
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
        self.look_around();
        Ok(self.scratch.time)
    }
}

/// Whether the force of a contact rises: at the contact's very begin its rate is zero, or negative
/// by rounding.
fn rises<S: Scalar>(at: &ContactRates<S>) -> bool {
    at.force_rate > S::zero() || (at.force <= S::zero() && at.rate > S::zero())
}

/// Where between 0 and `width` the cubic with these values and rates at its ends is largest; the
/// first rate is above zero, the last is not.
fn summit_between<S: Scalar>(width: S, values: [S; 2], rates: [S; 2]) -> S {
    let number = |n: i64| S::ratio(n, 1);
    let mean = (values[1] - values[0]) / width;
    let sum = rates[0] + rates[1];
    // the rate is rates[0] + 2 half s + bend s²
    let half = number(3) * mean - sum - rates[0];
    let bend = number(3) * (sum - mean - mean);
    let root = (half * half - bend * rates[0]).max(S::zero()).sqrt();
    width * (rates[0] / (root - half))
}

/// The zero next to the first of three places of the parabola through them: times (s) and values,
/// which fall from the left to the right.
fn muller<S: Scalar>([a, b, c]: [(S, S); 3]) -> S {
    let slope = |p: (S, S), q: (S, S)| (q.1 - p.1) / (q.0 - p.0);
    let (near, far) = (slope(a, b), slope(b, c));
    let bend = (far - near) / (c.0 - a.0);
    let slope = near + bend * (a.0 - b.0);
    let inner = slope * slope - S::ratio(4, 1) * bend * a.1;
    let root = inner.max(S::zero()).sqrt();
    a.0 - (a.1 + a.1) / (slope - root)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_look_is_exact_for_cubics() {
        let cubic = |s: f64| 2.0 + s * (3.0 - s * (1.0 + 4.0 * s));
        let rate = |s: f64| 3.0 - s * (2.0 + 12.0 * s);
        let (left, width) = (0.1, 0.7);
        let ends = [left, left + width];
        let found = left + summit_between(width, ends.map(cubic), ends.map(rate));
        assert!(rate(found).abs() < 1e-14, "{found}: {}", rate(found));
    }

    #[test]
    fn the_first_look_is_exact_for_parabolas() {
        let found = summit_between(1.0, [0.0, 0.3], [0.9, -0.3]);
        assert!((found - 0.75).abs() < 1e-15, "{found}");
    }

    #[test]
    fn the_iteration_finds_the_zero_of_a_cosine() {
        let rate = f64::cos;
        let mut known = [1.5, 1.0, 2.0].map(|t| (t, rate(t)));
        for _ in 0..4 {
            let aim = muller(known);
            known = [(aim, rate(aim)), known[0], known[1]];
        }
        let found = known[0].0;
        assert!((found - std::f64::consts::FRAC_PI_2).abs() < 1e-15, "{found}");
    }
}
