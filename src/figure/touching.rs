//! Histories of a joint with clearance, with the events and extremes that lie between samples.
//!
//! A contact may be as short as a few samples. Its curves go through the samples, both its ends and
//! its largest forces, all of them exact. Between those the square of the eccentricity, which is
//! smooth even where the journal passes the bearing's centre, is the cubic that has its rates; and
//! the force, to the power 2/3 in which Hertz contact is smooth, is a cubic without extrema of its
//! own (M. Steffen, Astron. Astrophys. 239, 443, 1990).

use super::Error;
use super::decimate::Point;
use super::runs::Run;
use crate::model::Owner;
use crate::record::Dimension;
use crate::run::{Contact, Event, EventKind, Peak};

/// Samples within a contact below which its course between them is unknown.
const KNOWN: usize = 3;
/// Steps in which a contact's depth is passed at its largest rate, at least.
const STEPS_OF_DEPTH: f64 = 20.0;
/// Steps in which the radial clearance is passed in flight, at least.
const STEPS_OF_CLEARANCE: f64 = 60.0;
/// Steps in which the largest rate is lost or won, at least.
const STEPS_OF_RATE: f64 = 20.0;
/// Most parts into which the time between two states is cut.
const MOST: f64 = 32.0;

/// State of a clearance at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    /// Time (s).
    pub time: f64,
    /// Penetration (m), negative in flight.
    pub depth: f64,
    /// Rate of the penetration (m/s).
    pub rate: f64,
    /// Normal force (N).
    pub force: f64,
}

/// Index of a joint's clearance in a run.
pub(super) fn clearance(run: &Run, joint: &str) -> Option<usize> {
    run.index(Dimension::Clearance, joint)
}

/// The contacts of a clearance, in order of time.
pub(super) fn contacts(run: &Run, clearance: usize) -> Vec<Contact> {
    let mut contacts: Vec<Contact> =
        run.contacts.iter().filter(|contact| contact.clearance == clearance).copied().collect();
    contacts.sort_by(|a, b| a.begin.total_cmp(&b.begin));
    contacts
}

/// Normal force (N) over the horizontal axis, with every local maximum.
pub(super) fn normal_force(run: &Run, clearance: usize) -> Result<Vec<Point>, Error> {
    let history = history(run, clearance)?;
    let mut points: Vec<Point> = history.iter().map(|moment| [moment.time, moment.force]).collect();
    let peaks = peaks(run, clearance).filter(|peak| run.shows(peak.time));
    points.extend(peaks.map(|peak| [peak.time, peak.force]));
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Ok(points.into_iter().map(|[time, force]| [run.place(time), force]).collect())
}

fn peaks(run: &Run, clearance: usize) -> impl Iterator<Item = &Peak> {
    run.peaks.iter().filter(move |peak| peak.clearance == clearance)
}

/// Whether a contact is as old as the first sample: then its begin is no passage through zero.
pub(super) fn began_before(run: &Run, contact: &Contact) -> bool {
    run.times.first().is_some_and(|first| contact.begin <= *first)
}

/// The states of a clearance in order of time: all samples, both ends of each contact, and as many
/// states between them as a smooth curve needs.
pub(super) fn history(run: &Run, clearance: usize) -> Result<Vec<Moment>, Error> {
    let [depths, rates, forces] = ["penetration", "penetration_rate", "normal_force"]
        .map(|dataset| run.samples(dataset).map(|samples| samples.column(clearance)));
    let (depths, rates, forces) = (depths?, rates?, forces?);
    let sample = |k: usize| Moment {
        time: run.times[k],
        depth: depths[k],
        rate: rates[k],
        force: forces[k],
    };
    let play = run.radial_clearance(clearance)?.unwrap_or(f64::NAN);
    let names = run.names(Dimension::Clearance);
    let radial = names.get(clearance).is_some_and(|name| run.is_journal(name)).then_some(play);
    let in_flight = |states: Vec<Moment>| smooth(&states, radial, play / STEPS_OF_CLEARANCE, &[]);
    let mut peaks: Vec<Peak> = peaks(run, clearance).copied().collect();
    peaks.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut moments = Vec::with_capacity(run.times.len());
    let mut next = 0;
    let mut left: Option<Moment> = None;
    for contact in contacts(run, clearance) {
        let old = began_before(run, &contact);
        let end = if contact.end.is_nan() { f64::INFINITY } else { contact.end };
        let first = run.times.partition_point(|time| *time <= contact.begin).max(next);
        let first = if old { next } else { first };
        let last = run.times.partition_point(|time| *time < end).max(first);
        let begins = !old && run.shows(contact.begin);
        let begin = begins.then(|| zero(contact.begin, contact.impact_rate));
        let flight = left.into_iter().chain((next..first).map(sample)).chain(begin);
        moments.extend(in_flight(flight.collect()));
        let end = run.shows(contact.end).then(|| zero(contact.end, end_rate(run, &contact)));
        let inside: Vec<Moment> = (first..last).map(sample).collect();
        match (begin, end) {
            (Some(begin), Some(end)) if inside.len() < KNOWN => {
                moments.extend(outline(&contact, begin, end));
            }
            _ => {
                let states: Vec<Moment> = begin.into_iter().chain(inside).chain(end).collect();
                let step = contact.peak_penetration / STEPS_OF_DEPTH;
                moments.extend(smooth(&states, radial, step, &peaks_of(&contact, &peaks)));
            }
        }
        (next, left) = (last, end);
    }
    let rest = left.into_iter().chain((next..run.times.len()).map(sample));
    moments.extend(in_flight(rest.collect()));
    moments.dedup();
    Ok(moments)
}

fn zero(time: f64, rate: f64) -> Moment {
    Moment { time, depth: 0.0, rate, force: 0.0 }
}

fn end_rate(run: &Run, contact: &Contact) -> f64 {
    let ends = |event: &&Event| {
        event.owner == Owner::Clearance(contact.clearance)
            && event.kind == EventKind::ContactEnds
            && event.time == contact.end
    };
    let from = run.events.partition_point(|event| event.time < contact.end);
    let mut same = run.events[from..].iter().take_while(|event| event.time <= contact.end);
    same.find(ends).map_or(f64::NAN, |event| event.rate)
}

/// Local maxima of the force in a contact, its largest among them, in order of time.
fn peaks_of(contact: &Contact, peaks: &[Peak]) -> Vec<Point> {
    let end = if contact.end.is_nan() { f64::INFINITY } else { contact.end };
    let peaks = within(peaks, contact.begin, end, |peak| peak.time);
    let mut points: Vec<Point> = peaks.iter().map(|peak| [peak.time, peak.force]).collect();
    if contact.begin < contact.peak_time && contact.peak_time < end {
        points.push([contact.peak_time, contact.peak_force]);
    }
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// What is known of a contact with hardly a sample in it: its ends, and its largest penetration and
/// force, taken together.
fn outline(contact: &Contact, begin: Moment, end: Moment) -> [Moment; 3] {
    let (time, depth, force) = (contact.peak_time, contact.peak_penetration, contact.peak_force);
    [begin, Moment { time, depth, rate: 0.0, force }, end]
}

/// Puts states between others, so many that from none to the next the penetration changes by more
/// than `step` (m), nor its rate by more than a share of the largest.
fn smooth(states: &[Moment], radial: Option<f64>, step: f64, peaks: &[Point]) -> Vec<Moment> {
    let force = Monotone::through(states, peaks);
    let largest = states.iter().map(|state| state.rate.abs()).fold(0.0, f64::max);
    let mut moments = Vec::with_capacity(states.len());
    for pair in states.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        moments.push(from);
        let way = from.rate.abs().max(to.rate.abs()) * (to.time - from.time);
        let turn = (to.rate - from.rate).abs() / largest * STEPS_OF_RATE;
        let parts = (way / step).max(turn).ceil();
        if !(parts >= 2.0 && step > 0.0) {
            continue;
        }
        let parts = parts.min(MOST) as usize;
        let part = (to.time - from.time) / parts as f64;
        let mut times: Vec<f64> = (1..parts).map(|k| from.time + part * k as f64).collect();
        let tips = within(peaks, from.time, to.time, |peak| peak[0]);
        times.extend(tips.iter().map(|peak| peak[0]));
        times.sort_by(f64::total_cmp);
        times.dedup();
        moments.extend(times.into_iter().map(|time| {
            let (depth, rate) = between([from, to], radial, time);
            Moment { time, depth, rate, force: force.at(time) }
        }));
    }
    moments.extend(states.last());
    moments
}

/// Those of some things in order of time that lie between two times.
fn within<T>(things: &[T], from: f64, to: f64, time: impl Fn(&T) -> f64) -> &[T] {
    let first = things.partition_point(|thing| time(thing) <= from);
    let last = things.partition_point(|thing| time(thing) < to).max(first);
    &things[first..last]
}

/// Penetration (m) and its rate (m/s) between two states: of a journal, by its radial clearance, the
/// square of the eccentricity is a cubic, before a straight wall the penetration itself.
fn between([from, to]: [Moment; 2], radial: Option<f64>, time: f64) -> (f64, f64) {
    let Some(radial) = radial else {
        let knot = |state: Moment| Knot { time: state.time, value: state.depth, slope: state.rate };
        return cubic([knot(from), knot(to)], time);
    };
    let square = |state: Moment| {
        let eccentricity = radial + state.depth;
        Knot {
            time: state.time,
            value: eccentricity.powi(2),
            slope: 2.0 * eccentricity * state.rate,
        }
    };
    let (square, slope) = cubic([square(from), square(to)], time);
    let eccentricity = square.max(0.0).sqrt();
    let rate = if eccentricity > 0.0 { 0.5 * slope / eccentricity } else { 0.0 };
    (eccentricity - radial, rate)
}

/// A known value of a cubic, and its slope there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Knot {
    /// Where it is (s).
    pub time: f64,
    /// The value.
    pub value: f64,
    /// The slope (1/s).
    pub slope: f64,
}

/// Value and slope of the cubic through two knots.
pub(super) fn cubic([from, to]: [Knot; 2], time: f64) -> (f64, f64) {
    let span = to.time - from.time;
    let s = (time - from.time) / span;
    let rise = to.value - from.value;
    let (a, b) = (from.slope * span, to.slope * span);
    // value = value_0 + a s + (3 rise − 2 a − b) s² + (a + b − 2 rise) s³
    let (square, cube) = (3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise);
    let value = from.value + s * (a + s * (square + s * cube));
    (value, (a + s * (2.0 * square + 3.0 * s * cube)) / span)
}

/// A force over time without extrema between those known.
struct Monotone {
    knots: Vec<Knot>,
}

impl Monotone {
    fn through(states: &[Moment], peaks: &[Point]) -> Self {
        let known = states.iter().map(|state| [state.time, state.force]);
        let mut points: Vec<Point> = known.chain(peaks.iter().copied()).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        points.dedup_by(|later, earlier| later[0] <= earlier[0]);
        let points: Vec<Point> = points
            .into_iter()
            .map(|[time, force]| [time, signed_power(force, 2.0 / 3.0)])
            .collect();
        let knot =
            |k: usize| Knot { time: points[k][0], value: points[k][1], slope: slope(&points, k) };
        Monotone { knots: (0..points.len()).map(knot).collect() }
    }

    fn at(&self, time: f64) -> f64 {
        let right = self.knots.partition_point(|knot| knot.time <= time);
        let (Some(from), Some(to)) =
            (right.checked_sub(1).map(|k| self.knots[k]), self.knots.get(right))
        else {
            return f64::NAN;
        };
        signed_power(cubic([from, *to], time).0, 1.5)
    }
}

/// Steffen's slope at a point: that of the parabola through its neighbours, unless that would make
/// an extremum.
fn slope(points: &[Point], k: usize) -> f64 {
    let secant = |k: usize| {
        let [from, to] = [points[k], points[k + 1]];
        (to[1] - from[1]) / (to[0] - from[0])
    };
    let last = points.len() - 1;
    match k {
        _ if last == 0 => 0.0,
        0 => secant(0),
        k if k == last => secant(k - 1),
        k => {
            let (left, right) = (secant(k - 1), secant(k));
            let (before, after) =
                (points[k][0] - points[k - 1][0], points[k + 1][0] - points[k][0]);
            let parabola = (left * after + right * before) / (before + after);
            let least = left.abs().min(right.abs()).min(0.5 * parabola.abs());
            (left.signum() + right.signum()) * least
        }
    }
}

fn signed_power(value: f64, power: f64) -> f64 {
    value.signum() * value.abs().powf(power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Radial clearance of the contacts tested (m).
    const RADIAL: f64 = 10.0;

    /// A contact whose penetration is half a sine, with a force δ^1.5.
    fn half_sine(samples: usize) -> Vec<Moment> {
        let last = samples + 1;
        (0..=last).map(|k| exact(k as f64 / last as f64)).collect()
    }

    fn exact(time: f64) -> Moment {
        let depth = (PI * time).sin().max(0.0);
        Moment { time, depth, rate: PI * (PI * time).cos(), force: depth.powf(1.5) }
    }

    #[test]
    fn a_contact_of_five_samples_is_drawn_to_a_hundredth_of_its_peak() {
        let moments = smooth(&half_sine(5), Some(RADIAL), 1.0 / STEPS_OF_DEPTH, &[[0.5, 1.0]]);
        assert!(moments.len() > 40, "{}", moments.len());
        for moment in &moments {
            let exact = exact(moment.time);
            assert!((moment.depth - exact.depth).abs() < 1e-3, "{moment:?} {exact:?}");
            assert!((moment.rate - exact.rate).abs() < 0.01 * PI, "{moment:?} {exact:?}");
            assert!((moment.force - exact.force).abs() < 0.01, "{moment:?} {exact:?}");
        }
    }

    #[test]
    fn forces_between_samples_never_pass_the_largest() {
        let moments = smooth(&half_sine(4), Some(RADIAL), 0.01, &[[0.5, 1.0]]);
        let largest = moments.iter().map(|moment| moment.force).fold(f64::MIN, f64::max);
        assert_eq!(largest, 1.0);
        assert!(moments.iter().all(|moment| moment.force >= 0.0));
    }

    #[test]
    fn a_flight_past_the_centre_is_drawn_as_it_is() {
        // A straight line past the centre at a distance of 0.1 m with 1 m/s, c = 1 m.
        let exact = |time: f64| {
            let eccentricity = 0.1_f64.hypot(time);
            Moment { time, depth: eccentricity - 1.0, rate: time / eccentricity, force: 0.0 }
        };
        let states: Vec<Moment> = (-1..=2).map(|k| exact(0.4 * f64::from(k) - 0.15)).collect();
        for moment in smooth(&states, Some(1.0), 0.01, &[]) {
            let exact = exact(moment.time);
            assert!((moment.depth - exact.depth).abs() < 1e-12, "{moment:?} {exact:?}");
            assert!((moment.rate - exact.rate).abs() < 1e-12, "{moment:?} {exact:?}");
        }
    }

    #[test]
    fn known_states_stay_as_they_are_and_close_ones_alone() {
        let states = half_sine(6);
        let moments = smooth(&states, Some(RADIAL), 0.05, &[[0.5, 1.0]]);
        assert!(states.iter().all(|state| moments.contains(state)));
        assert!(moments.windows(2).all(|pair| pair[0].time < pair[1].time));
        let many = half_sine(300);
        assert!(smooth(&many, Some(RADIAL), 0.05, &[]) == many);
        assert_eq!(smooth(&states, Some(f64::NAN), f64::NAN, &[]), states);
        assert!(smooth(&[], Some(RADIAL), 0.05, &[]).is_empty());
    }
}
