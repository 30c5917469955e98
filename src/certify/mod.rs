//! Certified digits: a run against references in 71-digit arithmetic.
//!
//! What is claimed is on the safe side: a reference is said to be wrong by twice what its looser
//! companion is off, and by what it loses when written as doubles; a run by its distance from the
//! reference and what the reference is wrong by. The time of an event that grazes may be known to
//! fewer digits than the state around it, and has a bound of its own.

mod companion;
mod cross;
mod growth;
mod horizon;
mod json;
mod reference;
mod report;
mod stored;
mod tangent;

pub use companion::{Companion, Errand, Reach, Until, Walk, Witness, companion, times_to_follow};
pub use cross::{CrossCheck, Disagreement, check_run, cross_check};
pub use horizon::{Digits, Horizon, LEAST_DIGITS, ONE_DRAW, ms};
pub use reference::{Error, Growth, Stage, Stopped, Watch};
pub use report::Told;
pub use stored::NotAReference;
pub use tangent::{Tangent, tangent};

use crate::case::Case;
use crate::digits::{self, Parting, Parts, Scales, digits};
use crate::record::ResultFile;
use crate::run::{Event, EventKind, Peak, Schedule, Trajectory, Watcher};
use crate::simulate::{self, Simulation, Statistics};
use std::convert::Infallible;
use std::f64::consts::LOG10_E;

/// What a certificate says of each sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claim {
    /// Digits to which the reference is true.
    pub reference: Parts<f64>,
    /// Digits to which the run is; NaN where it did not come.
    pub run: Parts<f64>,
}

/// A certified reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// The trajectory, as doubles with their remainders.
    pub trajectory: Trajectory,
    /// What it may be wrong by, scaled, at each sample.
    pub wrong: Vec<Parts<f64>>,
    /// What the time of each event may be wrong by (s); NaN where it is not known, as in files of
    /// older programs.
    pub event_times_wrong: Vec<f64>,
    /// Scales of the errors.
    pub scales: Scales,
    /// Tolerances of the two runs behind it.
    pub tolerances: [f64; 2],
    /// How a small change of the start grows.
    pub growth: Growth,
    /// The end that was asked for (s).
    pub until: f64,
    /// Whether it goes to that end.
    pub complete: bool,
    /// Why it does not, if a run behind it stopped.
    pub stopped: Option<String>,
}

/// What a run has of an event of the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Time of the run's event less that of the reference (s); `None` if the run has none.
    pub late: Option<f64>,
    /// Whether it counts: behind the end of doubles what is matched is matched by chance, and in the
    /// last instants it may come just behind the end.
    pub counts: bool,
}

/// What a run has of the peaks of the reference, as far as doubles follow it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Peaks {
    /// How many the reference has.
    pub of: usize,
    /// How many of them the run has.
    pub found: usize,
    /// Largest error of the force of one that it has, over the scale of forces.
    pub error: f64,
}

/// A run held against a certified reference.
#[derive(Debug, Clone)]
pub struct Certificate {
    /// The reference.
    pub reference: Reference,
    /// Claims, at each sample of the reference.
    pub claims: Vec<Claim>,
    /// What the run has of each event of the reference.
    pub events: Vec<Match>,
    /// The first event that only one of the two has, as far as doubles follow the case.
    pub parting: Option<Parting>,
    /// What the run has of each contact's peaks.
    pub peaks: Peaks,
    /// Why the run under test stopped, if it did.
    pub run_failure: Option<String>,
    /// What the run under test counted.
    pub statistics: Statistics,
}

/// Makes a certified reference of a case, to at least `digits` digits as far as 71-digit arithmetic
/// reaches.
///
/// # Errors
/// See [`Error`].
pub fn reference(
    case: &Case,
    schedule: &Schedule,
    digits: f64,
    watch: Watch<'_>,
) -> Result<Reference, Error> {
    let pair = reference::references(case, schedule, digits, watch)?;
    let growth = reference::growth(case, schedule, &pair, watch)?;
    // what the start is off by, which no two runs from it show, grows along with them
    let mut grown: f64 = 1.0;
    let mut factors = growth.factors.iter();
    let shared: Vec<f64> = (pair.apart.iter())
        .map(|_| {
            grown = factors.next().map_or(grown, |factor| grown.max(*factor));
            pair.start * grown
        })
        .collect();
    let event_times_wrong = event_times_wrong(&pair, &shared);
    let scales = pair.scales;
    let wrong = (pair.tight.samples.iter().zip(&pair.apart).zip(&shared))
        .map(|((sample, apart), shared)| {
            scales.rounding(sample).zip(*apart, |lost, apart| lost + 2.0 * apart + shared)
        })
        .collect::<Vec<_>>();
    let whole = wrong.len() as u64 >= schedule.len();
    let stopped = match (&pair.stopped, &pair.parting) {
        (Some(stopped), _) => Some(chain(stopped)),
        (None, Some(parting)) => {
            Some(format!("the two runs have different events from {:e} s on", parting.event.time))
        }
        (None, None) => None,
    };
    let mut reference = Reference {
        trajectory: pair.tight,
        wrong,
        event_times_wrong,
        scales,
        tolerances: pair.tolerances,
        growth,
        until: schedule.duration(),
        complete: whole,
        stopped,
    };
    if !whole {
        reference.cut(reference.wrong.len());
    }
    Ok(reference)
}

/// What the time of each event of a pair may be wrong by (s); `shared` is what the state may be at
/// each sample for the start that both share, scaled. Such an error moves an event by the time that
/// the wall, or the mechanism as it turns, takes to make up for it.
fn event_times_wrong(pair: &reference::Pair, shared: &[f64]) -> Vec<f64> {
    let Scales { clearances, angular_velocity, .. } = &pair.scales;
    let samples = &pair.tight.samples;
    (pair.tight.events.iter().zip(&pair.events_apart))
        .map(|(event, apart)| {
            let next = samples.partition_point(|sample| sample.time < event.time);
            let shared = shared.get(next).or(shared.last()).copied().unwrap_or(0.0);
            let turning = 1.0 / angular_velocity;
            let slowness = match event.kind {
                EventKind::ContactBegins | EventKind::ContactEnds => {
                    let clearance = clearances.get(event.owner.index()).copied().unwrap_or(0.0);
                    turning.max(clearance / event.rate.abs())
                }
                EventKind::FrictionKink | EventKind::Tension => turning,
                // it is where the case has it
                EventKind::CourseChanges => 0.0,
                EventKind::Singular => turning,
            };
            // a start without an error moves nothing, however long an event takes
            let moved = if shared > 0.0 { shared * slowness } else { 0.0 };
            let rounded = event.time.abs().next_up() - event.time.abs();
            2.0 * apart + moved + rounded
        })
        .collect()
}

/// An error with all its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        words.push_str(": ");
        words.push_str(&cause.to_string());
        source = cause.source();
    }
    words
}

/// A certified reference that was kept, as far as the duration that the case asks for.
///
/// # Errors
/// The file holds no certificate, or one that is not sealed or was changed since, or that of
/// another case.
pub fn stored(case: &Case, file: &ResultFile) -> Result<Reference, NotAReference> {
    stored::read(case, file)
}

/// Runs a case as its plan says and holds it against a reference, at the times of the reference.
///
/// # Errors
/// See [`simulate::Error`]; that the run stops is none.
pub fn certify(
    simulation: Simulation<'_>,
    reference: Reference,
    watch: Watcher<'_>,
) -> Result<Certificate, simulate::Error<Infallible>> {
    let times = reference.trajectory.samples.iter().map(|sample| sample.time).collect();
    let mut run = Trajectory::default();
    let (statistics, ran) = simulation.sampled_at(times).run(&mut run, watch);
    let run_failure = match ran {
        Ok(()) => None,
        Err(simulate::Error::Interrupted { time }) => {
            return Err(simulate::Error::Interrupted { time });
        }
        Err(error) => Some(chain(&error)),
    };
    let claims = claims(&run, &reference);
    let until = reference.followed_until();
    let (events, parting) = events(&run.events, &reference.trajectory.events, until);
    let peaks = peaks(&run.peaks, &reference, until);
    Ok(Certificate { reference, claims, events, parting, peaks, run_failure, statistics })
}

/// What a run has of each event of a reference, up to a time (s), and where the two part.
fn events(run: &[Event], reference: &[Event], until: f64) -> (Vec<Match>, Option<Parting>) {
    let likes = digits::events(run, reference, until);
    let mut lone = likes.only_reference.iter().peekable();
    let matches =
        reference.iter().zip(&likes.of_reference).enumerate().map(|(k, (event, like))| {
            let like = like.filter(|_| event.time <= until);
            let is_lone = lone.next_if(|lone| **lone == k).is_some();
            Match {
                late: like.map(|like| run[like].time - event.time),
                counts: is_lone || like.is_some(),
            }
        });
    (matches.collect(), likes.parting(run, reference))
}

/// What a run has of the peaks of a reference, up to a time (s).
fn peaks(run: &[Peak], reference: &Reference, until: f64) -> Peaks {
    let mut found = Peaks::default();
    for k in 0..reference.scales.clearances.len() {
        let of = |peaks: &[Peak]| -> Vec<Peak> {
            let counts = |peak: &&Peak| peak.clearance == k && peak.time <= until;
            peaks.iter().filter(counts).copied().collect()
        };
        let (theirs, true_peaks) = (of(run), of(&reference.trajectory.peaks));
        let times = |peaks: &[Peak]| peaks.iter().map(|peak| peak.time).collect::<Vec<_>>();
        let likes = digits::one_to_one(&times(&theirs), &times(&true_peaks), until);
        found.of += true_peaks.len();
        for (peak, like) in true_peaks.iter().zip(likes) {
            let Some(like) = like else { continue };
            let error = (theirs[like].force - peak.force).abs() / reference.scales.force;
            found.found += 1;
            found.error = if error.is_nan() { f64::INFINITY } else { found.error.max(error) };
        }
    }
    found
}

/// Claims at each sample of the reference; the run has the same sample times as far as it goes.
fn claims(run: &Trajectory, reference: &Reference) -> Vec<Claim> {
    let Reference { trajectory, wrong, scales, .. } = reference;
    let mut runs = run.samples.iter().peekable();
    (trajectory.samples.iter().zip(wrong))
        .map(|(sample, wrong)| {
            while runs.peek().is_some_and(|run| run.time < sample.time) {
                runs.next();
            }
            let same = runs.peek().filter(|run| run.time == sample.time);
            let of_run = same.map_or(Parts::all(f64::NAN), |run| {
                let apart = scales.differences(run, sample);
                apart.zip(*wrong, |apart, wrong| digits(apart + wrong))
            });
            Claim { reference: wrong.map(digits), run: of_run }
        })
        .collect()
}

impl Reference {
    /// Decades by which an error grows in a second: the slope of the straight line through the
    /// logarithms of the growth, over all of it that is known; `None` where there is nothing to grow.
    pub fn growth_rate(&self) -> Option<f64> {
        let times = self.trajectory.samples.iter().map(|sample| sample.time);
        growth::rate(times.zip(self.growth.factors.iter().copied())).map(|rate| rate * LOG10_E)
    }
}

impl Reference {
    /// Leaves the first samples only, and of everything else what lies before the last of them. A
    /// contact that has not ended by then is left out: its largest force may lie behind.
    fn cut(&mut self, samples: usize) {
        let Trajectory { samples: all, events, contacts, peaks, revolutions } =
            &mut self.trajectory;
        all.truncate(samples);
        self.wrong.truncate(samples);
        self.growth.factors.truncate(samples);
        let end = all.last().map_or(0.0, |sample| sample.time);
        events.retain(|event| event.time <= end);
        self.event_times_wrong.truncate(events.len());
        contacts.retain(|contact| contact.end <= end);
        peaks.retain(|peak| peak.time <= end);
        revolutions.retain(|revolution| revolution.end <= end);
        self.growth.double_precision_ends =
            self.growth.double_precision_ends.filter(|time| *time <= end);
    }

    /// Last time (s) of the reference at which a run in doubles can still be held against it.
    fn followed_until(&self) -> f64 {
        let last = self.trajectory.samples.last().map_or(0.0, |sample| sample.time);
        self.growth.double_precision_ends.map_or(last, |ends| ends.min(last))
    }

    /// What the least certain time of an event may be wrong by (s), up to a time (s), where that is
    /// known of all.
    pub fn event_times_known_to(&self, until: f64) -> Option<f64> {
        let within = self.trajectory.events.iter().zip(&self.event_times_wrong);
        let within = within.filter(|(event, _)| event.time <= until).map(|(_, wrong)| *wrong);
        let most = within.reduce(|a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) });
        most.filter(|most| most.is_finite())
    }

    /// Time (s) up to which the growth of errors is known, where that is not the end.
    pub fn growth_known_until(&self) -> Option<f64> {
        let known = self.growth.factors.len();
        let samples = &self.trajectory.samples;
        (known < samples.len()).then(|| Some(samples.get(known.checked_sub(1)?)?.time)).flatten()
    }
}

impl Certificate {
    /// Last time (s) up to which the run holds this many digits of the state; `None` if it does
    /// not even at its start.
    pub fn run_holds(&self, digits: f64) -> Option<f64> {
        self.holds(digits, |claim| claim.run.state)
    }

    /// Last time (s) up to which the reference is certified to this many digits of the state.
    pub fn reference_holds(&self, digits: f64) -> Option<f64> {
        self.holds(digits, |claim| claim.reference.state)
    }

    /// Whether the reference is certified to this many digits to the end that was asked for.
    pub fn reference_holds_to_the_end(&self, digits: f64) -> bool {
        let held = self.claims.iter().all(|claim| claim.reference.state >= digits);
        self.reference.complete && held
    }

    fn holds(&self, digits: f64, of: fn(&Claim) -> f64) -> Option<f64> {
        let held = self.claims.iter().take_while(|claim| of(claim) >= digits).count();
        Some(self.reference.trajectory.samples[held.checked_sub(1)?].time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::Observation;
    use crate::model::Owner;
    use crate::run::Contact;

    fn event(time: f64) -> Event {
        Event { time, owner: Owner::default(), kind: EventKind::ContactBegins, rate: 1.0 }
    }

    /// Samples at 0, 1, … 4 s, and an event, a contact and a peak behind each.
    fn reference() -> Reference {
        let contact = |k: u32| Contact {
            clearance: 0,
            begin: f64::from(k) + 0.2,
            end: f64::from(k) + 0.8,
            impact_rate: 1.0,
            peak_penetration: 1e-6,
            peak_penetration_time: 0.0,
            peak_force: 1.0,
            peak_time: f64::from(k) + 0.5,
            dissipated: 0.0,
        };
        let peak = |k: u32| Peak { time: f64::from(k) + 0.5, clearance: 0, force: 10.0 };
        let sample = |k: u32| Observation { time: f64::from(k), ..Observation::default() };
        let sizes = digits::Sizes { mass: 1.0, length: 1.0, rate: 1.0, clearances: vec![1e-3] };
        let trajectory = Trajectory {
            samples: (0..5).map(sample).collect(),
            events: (0..5).map(|k| event(f64::from(k) + 0.2)).collect(),
            contacts: (0..5).map(contact).collect(),
            peaks: (0..5).map(peak).collect(),
            revolutions: Vec::new(),
        };
        Reference {
            scales: Scales::of(&trajectory.samples, &sizes),
            wrong: vec![Parts::all(1e-16); 5],
            event_times_wrong: vec![1e-16; 5],
            trajectory,
            tolerances: [1e-29, 1e-24],
            growth: Growth { factors: vec![1.0; 5], double_precision_ends: Some(3.5) },
            until: 4.0,
            complete: false,
            stopped: None,
        }
    }

    #[test]
    fn tables_end_with_the_last_sample() {
        let mut reference = reference();
        reference.cut(3);
        let Trajectory { samples, events, contacts, peaks, .. } = &reference.trajectory;
        let lengths = [samples.len(), events.len(), contacts.len(), peaks.len()];
        assert_eq!(lengths, [3, 2, 2, 2]);
        assert_eq!((reference.wrong.len(), reference.growth.factors.len()), (3, 3));
        assert_eq!(reference.event_times_wrong.len(), 2);
        assert_eq!(reference.growth.double_precision_ends, None);
    }

    #[test]
    fn what_is_matched_behind_the_end_of_doubles_does_not_count() {
        let reference = reference();
        let until = reference.followed_until();
        assert_eq!(until, 3.5);
        let run: Vec<Event> = [0.2, 1.21, 3.2, 3.6, 4.2].map(event).to_vec();
        let (matches, parting) = events(&run, &reference.trajectory.events, until);
        let late: Vec<bool> = matches.iter().map(|found| found.late.is_some()).collect();
        assert_eq!(late, [true, true, false, true, false]);
        let counts: Vec<bool> = matches.iter().map(|found| found.counts).collect();
        assert_eq!(counts, [true, true, true, true, false]);
        assert_eq!(parting.map(|parting| parting.event.time), Some(2.2));
    }

    #[test]
    fn peaks_are_found_and_their_largest_error_is_told() {
        let mut reference = reference();
        reference.scales.force = 100.0;
        let mut run = reference.trajectory.peaks.clone();
        run[1].force = 10.5;
        run.remove(0);
        let found = peaks(&run, &reference, 3.5);
        assert_eq!((found.of, found.found), (4, 3));
        assert!((found.error - 5e-3).abs() < 1e-15);
    }
}
