//! True extrema of penetration and force within a step.
//!
//! A step may hold several: in many digits it may be longer than the contact swings. So it is
//! looked at in places that no contact can swing far between, and between two of them wherever the
//! parabola through what is known of the force's rate comes near zero.

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
/// Angle (rad) by which contacts may swing from one place to the next: two neighbouring extrema
/// are π apart.
const SWING: f64 = 2.0;
/// Places that one step is looked at in.
const MOST_PLACES: f64 = 1024.0;
/// Part of the smaller rate at two places that the rate between them must keep, or else is looked at.
const KEPT: f64 = 0.25;
/// Halvings of the stretch between two places.
const MOST_HALVINGS: usize = 6;

/// What a contact is at a time (s).
type Place<S> = (S, ContactRates<S>);

/// Every clearance at a time (s) within a step; `None` in flight.
type Look<S> = (S, Vec<Option<ContactRates<S>>>);

/// Whether the force rises. Where its rate is zero because the penetration is, the penetration tells.
fn rises<S: Scalar>(at: &ContactRates<S>) -> bool {
    let zero = S::zero();
    at.force_rate > zero || (at.force_rate == zero && at.depth <= zero && at.rate > zero)
}

impl<S, E, R> Run<'_, S, E, R>
where
    S: Scalar,
    E: Engine<S, System = Mechanism<S>>,
    R: Recorder + ?Sized,
{
    /// Follows every open contact through the last step: rates at its end, maxima inside it.
    /// Marks what adaptive sampling must not miss.
    pub(super) fn follow_contacts(&mut self) -> Outcome<(), S, E, R> {
        self.marks.clear();
        if self.touching.iter().all(Option::is_none) {
            return Ok(());
        }
        // all ends first: a look inside the step moves the system away from them
        let ends: Vec<Option<ContactRates<S>>> =
            (0..self.touching.len()).map(|k| self.engine.system().contact_rates(k)).collect();
        let inside = self.look_inside(&ends)?;
        for (k, end) in ends.into_iter().enumerate() {
            let Some((begin, end)) = self.touching[k].as_ref().map(|t| t.last).zip(end) else {
                continue;
            };
            let mut last = (self.engine.began(), begin);
            for (time, rates) in &inside {
                if let Some(rates) = rates[k] {
                    self.follow(k, last, (*time, rates), MOST_HALVINGS)?;
                    last = (*time, rates);
                }
            }
            self.follow(k, last, (self.engine.now().time, end), MOST_HALVINGS)?;
            self.mark_bend(&begin, &end);
            if let Some(touching) = self.touching[k].as_mut() {
                touching.last = end;
            }
        }
        Ok(())
    }

    /// Every contact at places within the last step that none of them can swing far between; none
    /// where it cannot swing far over the whole.
    fn look_inside(&mut self, ends: &[Option<ContactRates<S>>]) -> Outcome<Vec<Look<S>>, S, E, R> {
        let (from, to) = (self.engine.began(), self.engine.now().time);
        let length = (to - from).to_f64();
        let mut squares = 0.0;
        for (k, end) in ends.iter().enumerate() {
            if let Some((begin, end)) = self.touching[k].as_ref().map(|t| t.last).zip(*end) {
                let depth = deepest_between(&begin, &end, length);
                squares += self.engine.system().swing_squared(k, depth);
            }
        }
        let mut inside = Vec::new();
        if length * length * squares <= SWING * SWING {
            return Ok(inside);
        }
        let parts = (length * squares.sqrt() / SWING).ceil().min(MOST_PLACES);
        let mut last = from;
        for part in 1..parts as u32 {
            let aim = from + (to - from) * S::from_f64(f64::from(part) / parts);
            if aim > last {
                last = self.glance(aim, last, to)?;
                let system = self.engine.system();
                inside.push((last, (0..ends.len()).map(|k| system.contact_rates(k)).collect()));
            }
        }
        Ok(inside)
    }

    /// Follows a contact from one place to another within the last step.
    fn follow(
        &mut self,
        k: usize,
        begin: Place<S>,
        end: Place<S>,
        halvings: usize,
    ) -> Outcome<(), S, E, R> {
        let noise = self.noise(end.1.slope.to_f64());
        if halvings > 0 && may_turn_twice(&begin, &end, noise) {
            let middle = begin.0 + (end.0 - begin.0) * S::from_f64(0.5);
            if middle > begin.0 && middle < end.0 {
                let time = self.glance(middle, begin.0, end.0)?;
                if let Some(rates) = self.engine.system().contact_rates(k) {
                    self.follow(k, begin, (time, rates), halvings - 1)?;
                    return self.follow(k, (time, rates), end, halvings - 1);
                }
            }
        }
        if begin.1.rate > S::zero() && end.1.rate <= S::zero() {
            let (time, rates) = self.summit(k, begin, end, |at| (at.depth, at.rate))?;
            self.deepest(k, time.to_f64(), rates.depth.to_f64());
        }
        if rises(&begin.1) && !rises(&end.1) {
            let (time, rates) = self.summit(k, begin, end, |at| (at.force, at.force_rate))?;
            self.strongest(k, time.to_f64(), rates.force.to_f64());
            self.marks.push(Mark { time, peak: Some((k, rates.force.to_f64())) });
        }
        let (time, end) = end;
        self.deepest(k, time.to_f64(), end.depth.to_f64());
        self.hardest(k, time.to_f64(), end.force.to_f64());
        if let Some(touching) = self.touching[k].as_mut() {
            touching.pulled |= end.force < S::zero();
            touching.beside(time.to_f64(), end.force.to_f64(), noise);
            self.peaks.extend(touching.follow(end.force.to_f64(), noise));
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

    /// The time (s) between two places at which a quantity of contact `k` is largest, and what
    /// the contact is there: the zero of its rate by Muller's iteration, kept in a bracket.
    /// `of` gives the quantity and its rate.
    fn summit(
        &mut self,
        k: usize,
        (mut left, begin): Place<S>,
        (mut right, end): Place<S>,
        of: impl Fn(&ContactRates<S>) -> (S, S),
    ) -> Outcome<Place<S>, S, E, R> {
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
        if self.engine.show(aim, &mut self.scratch) {
            self.look_around();
            return Ok(aim);
        }
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

/// How deep (m) a contact may be between two places that are so far apart (s).
fn deepest_between<S: Scalar>(begin: &ContactRates<S>, end: &ContactRates<S>, length: f64) -> f64 {
    let reach = |at: &ContactRates<S>| at.depth.to_f64() + at.rate.to_f64().abs() * length;
    let ends = begin.depth.to_f64().max(end.depth.to_f64());
    reach(begin).min(reach(end)).max(ends).max(0.0)
}

/// Whether a force that rises, or falls, at two places may do the other between them, by more than
/// `noise` (N): its rate is taken for the parabola that has its values there, and its mean.
fn may_turn_twice<S: Scalar>(begin: &Place<S>, end: &Place<S>, noise: f64) -> bool {
    let rising = rises(&begin.1);
    if rising != rises(&end.1) {
        return false;
    }
    let sign = if rising { 1.0 } else { -1.0 };
    let length = (end.0 - begin.0).to_f64();
    let rates = [begin, end].map(|(_, at)| sign * at.force_rate.to_f64());
    let change = sign * (end.1.force - begin.1.force).to_f64();
    let middle = (6.0 * change / length - rates[0] - rates[1]) / 4.0;
    let least = rates[0].min(rates[1]).max(0.0);
    let matters = (rates[0].max(rates[1]).max(-middle)) * length > noise;
    matters && middle < KEPT * least
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

    /// A contact whose force is 1 + s³ − a s over the time s (s), at a time.
    fn cubic_place(s: f64, a: f64) -> Place<f64> {
        let (force, force_rate) = (1.0 + s * s * s - a * s, 3.0 * s * s - a);
        (s, ContactRates { depth: 1.0, rate: 0.0, force, force_rate, slope: 1.0 })
    }

    #[test]
    fn a_force_that_falls_and_rises_again_between_two_places_is_seen() {
        let may =
            |a: f64, noise: f64| may_turn_twice(&cubic_place(-1.0, a), &cubic_place(1.0, a), noise);
        assert!(may(0.1, 0.0), "two extrema");
        assert!(may(-0.01, 0.0), "nearly two");
        assert!(!may(-2.0, 0.0), "none");
        assert!(!may(0.1, 10.0), "a ripple");
        let falls = may_turn_twice(&cubic_place(-0.1, 1.0), &cubic_place(0.1, 1.0), 0.0);
        assert!(!falls, "falling all the time");
    }

    #[test]
    fn a_contact_that_begins_rises_though_its_force_has_no_rate() {
        let at = |depth: f64, rate: f64| ContactRates {
            depth,
            rate,
            force: 0.0,
            force_rate: 0.0,
            slope: 0.0,
        };
        assert!(rises(&at(0.0, 1.0)) && !rises(&at(0.0, -1.0)) && !rises(&at(1e-6, 1.0)));
    }

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
