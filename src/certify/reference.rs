//! Reference trajectories: two runs of the explicit engine in 71-digit arithmetic, side by side,
//! at tolerances some decades apart.
//!
//! The looser run is wrong by about the difference of the two, the tighter one by some decades
//! less: what both agree on, the tighter one certifies. The first pair is as loose as may do;
//! where it parts too early, the rate at which it parted tells how tight the next must be.

use crate::case::{self, Case};
use crate::digits::{self, Parting, Parts, Scales, Sizes};
use crate::mechanism::{Mechanism, Observation};
use crate::run::{Contact, Event, Peak, Progress, Recorder, Schedule, Trajectory};
use crate::scalar::F256;
use crate::simulate::{self, assemble};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exponent of the tightest tolerance that 71 digits serve.
const TIGHTEST: f64 = 63.0;
/// Decades between the tolerances of a pair.
const APART: f64 = 5.0;
/// Decades that a pair is tighter than the growth of errors asks for.
const TO_SPARE: f64 = 3.0;
/// The first pair: exponent of its looser tolerance.
const FIRST: f64 = 24.0;
/// By how much a pair is tighter than one of which a run stopped: the next is not, as a rule, in its way.
const OTHERS: [f64; 3] = [1.0, 4.0, 7.0];
/// Change of the start that shows what no double-precision run can know.
const DOUBLE_PRECISION: f64 = 1e-16;
/// Scaled changes are linear in the change of the start up to here.
const LINEAR: f64 = 1e-3;
/// Scaled distances larger than this are told by doubles and their remainders.
const VISIBLE: f64 = 1e-30;
/// A change smaller than this is no change: a mechanism without freedom cannot be disturbed.
const NOTHING: f64 = 1e-9 * DOUBLE_PRECISION;
/// Exponent of the tolerance of the run with a changed start.
const CHANGED: f64 = 24.0;

/// Two runs of a case, and how far they agree.
#[derive(Debug)]
pub struct Pair {
    /// The tighter run; the reference.
    pub tight: Trajectory,
    /// Scaled differences of the two at each sample of the tighter one that both have.
    pub apart: Vec<Parts<f64>>,
    /// Distance (s) of each event of the tighter one to its like in the looser; infinite where there is
    /// none.
    pub events_apart: Vec<f64>,
    /// Tolerances of the tighter and of the looser run.
    pub tolerances: [f64; 2],
    /// What the start, which both share, may be off by, over its size.
    pub start: f64,
    /// Scales of the tighter run.
    pub scales: Scales,
    /// The first event that only one of the two has, over the samples that both have.
    pub parting: Option<Parting>,
    /// Why one of the runs stopped short, if one did.
    pub stopped: Option<Stopped>,
}

/// A word of progress of a reference run.
#[derive(Debug, Clone, Copy)]
pub struct Stage {
    /// Tolerance of the run.
    pub tolerance: f64,
    /// Simulated time (s).
    pub time: f64,
}

/// Who watches: is told of progress from several threads, and may stop everything.
pub type Watch<'a> = &'a (dyn Fn(Stage) -> ControlFlow<()> + Sync);

/// Why there is no reference.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A reference run stopped before there was anything to certify.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The two runs differ from their start on.
    #[error(
        "the reference runs at tolerances of {:e} and {:e} do not start with the same contacts",
        tolerances[0], tolerances[1]
    )]
    DifferentStarts {
        /// Tolerances of the tighter and of the looser run.
        tolerances: [f64; 2],
    },
    /// The case cannot be assembled in 71 digits.
    #[error(transparent)]
    Case(#[from] case::Error),
    /// Whoever watched asked to stop.
    #[error("interrupted")]
    Interrupted,
}

/// A reference run that did not come to its end.
#[derive(Debug, thiserror::Error)]
#[error("the reference run at a tolerance of {tolerance:e} stopped")]
pub struct Stopped {
    /// Its tolerance.
    pub tolerance: f64,
    /// Why.
    pub source: simulate::Error<Infallible>,
}

/// One of two runs that are compared while they go.
struct Side<'a> {
    kept: Trajectory,
    both: &'a Mutex<[Vec<Observation>; 2]>,
    which: usize,
    /// Set once the two have parted.
    parted: &'a AtomicBool,
    least: f64,
    sizes: &'a Sizes,
}

impl Side<'_> {
    /// Compares the newest sample that both have, with scales as they are so far.
    fn compare(&self) {
        let Ok(mut both) = self.both.lock() else { return };
        both[self.which].extend(self.kept.samples.last().cloned());
        let newest = both[0].len().min(both[1].len());
        let Some(newest) = newest.checked_sub(1) else { return };
        let scales = Scales::of(&both[0][newest..=newest], self.sizes);
        let difference = scales.differences(&both[0][newest], &both[1][newest]);
        if !(difference.state < self.least) {
            self.parted.store(true, Ordering::Relaxed);
        }
    }
}

impl Recorder for Side<'_> {
    type Error = Infallible;

    fn sample(&mut self, observation: &Observation) -> Result<(), Infallible> {
        self.kept.sample(observation)?;
        self.compare();
        Ok(())
    }

    fn event(&mut self, event: Event) -> Result<(), Infallible> {
        self.kept.event(event)
    }

    fn contact(&mut self, contact: Contact) -> Result<(), Infallible> {
        self.kept.contact(contact)
    }

    fn peak(&mut self, peak: Peak) -> Result<(), Infallible> {
        self.kept.peak(peak)
    }
}

/// References that agree to `digits` (and a little more) to the end of the schedule, or as far as
/// 71-digit arithmetic reaches. Where a run stops, pairs at other tolerances are tried.
///
/// # Errors
/// See [`Error`].
pub fn references(
    case: &Case,
    schedule: &Schedule,
    digits: f64,
    watch: Watch<'_>,
) -> Result<Pair, Error> {
    let least = 10f64.powf(-digits - 1.0);
    let run = |loose| pair(case, schedule, loose, least, watch);
    let pair = search(run, digits, schedule.len(), schedule.duration())?;
    match pair {
        Pair { stopped: Some(stopped), apart, .. } if apart.is_empty() => {
            Err(Error::Stopped(stopped))
        }
        Pair { apart, tolerances, .. } if apart.is_empty() => {
            Err(Error::DifferentStarts { tolerances })
        }
        pair => Ok(pair),
    }
}

/// The first of some pairs that agrees to `digits` at all of so many samples over a duration (s), or
/// the one that agrees furthest. `pair` runs one, by the exponent of its looser tolerance.
fn search(
    mut pair: impl FnMut(f64) -> Result<Pair, Error>,
    digits: f64,
    samples: u64,
    duration: f64,
) -> Result<Pair, Error> {
    let least = 10f64.powf(-digits - 1.0);
    let mut furthest: Option<Pair> = None;
    let mut others = OTHERS.iter();
    let mut loose = FIRST.max(digits + 6.0);
    loop {
        let pair = pair(loose)?;
        let agreed = pair.agreed_until(least);
        let tightest = loose + APART >= TIGHTEST;
        if pair.failed() && agreed == pair.apart.len() {
            // as far as the run that stopped came, there was agreement
            let further = pair.or_further(furthest.take(), least);
            match others.next().filter(|_| !tightest) {
                None => return Ok(further),
                Some(more) => loose = (loose + more).min(TIGHTEST - APART),
            }
            furthest = Some(further);
            continue;
        }
        let whole = pair.apart.len() as u64 >= samples;
        if (whole && agreed == pair.apart.len()) || tightest {
            return Ok(pair.or_further(furthest.take(), least));
        }
        let time = pair.tight.samples.get(agreed.saturating_sub(1)).map_or(0.0, |s| s.time);
        let lost = (loose - digits) / time.max(1e-300);
        let needed = digits + TO_SPARE + lost * duration;
        loose = needed.max(loose + 4.0).min(TIGHTEST - APART).ceil();
    }
}

impl Pair {
    /// Whether a run stopped, or the two have different events.
    fn failed(&self) -> bool {
        self.stopped.is_some() || self.parting.is_some()
    }

    /// This pair, or another that agreed further.
    fn or_further(self, other: Option<Pair>, least: f64) -> Pair {
        match other {
            Some(other) if other.agreed_until(least) > self.agreed_until(least) => other,
            _ => self,
        }
    }

    /// Number of leading samples at which the two differ by less than `least`.
    pub fn agreed_until(&self, least: f64) -> usize {
        self.apart.iter().take_while(|apart| apart.state < least).count()
    }
}

/// Runs a pair side by side until its end or until it has parted by `least`.
fn pair(
    case: &Case,
    schedule: &Schedule,
    loose: f64,
    least: f64,
    watch: Watch<'_>,
) -> Result<Pair, Error> {
    let tolerances = [loose + APART, loose].map(|exponent| 10f64.powf(-exponent));
    let mechanism: Mechanism<F256> = assemble(case)?;
    let start = mechanism.start_accuracy();
    let sizes = Sizes::of(&mechanism);
    let both = Mutex::new([Vec::new(), Vec::new()]);
    let parted = AtomicBool::new(false);
    let side = |which: usize| {
        let mut side = Side {
            kept: Trajectory::default(),
            both: &both,
            which,
            parted: &parted,
            least,
            sizes: &sizes,
        };
        let tolerance = tolerances[which];
        let ran = run(case, mechanism.clone(), schedule, tolerance, &mut side, &parted, watch);
        match ran {
            Ok(()) => Ok((side.kept, None)),
            Err(Error::Stopped(stopped)) => Ok((side.kept, Some(stopped))),
            Err(error) => Err(error),
        }
    };
    let (tight, loose) = std::thread::scope(|scope| {
        let loose = scope.spawn(|| side(1));
        let tight = side(0);
        (tight, loose.join())
    });
    let loose = loose.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    let ((tight, tight_stopped), (loose, loose_stopped)) = (tight?, loose?);
    let scales = Scales::of(&tight.samples, &sizes);
    let mut apart: Vec<Parts<f64>> = (tight.samples.iter().zip(&loose.samples))
        .map(|(tight, loose)| scales.differences(tight, loose))
        .collect();
    let stopped = tight_stopped.or(loose_stopped);
    let until = apart.len().checked_sub(1).map_or(0.0, |last| tight.samples[last].time);
    let likes = digits::events(&loose.events, &tight.events, until);
    let parting = likes.parting(&loose.events, &tight.events);
    if let Some(parting) = parting {
        let before = |sample: &Observation| sample.time < parting.event.time;
        apart.truncate(tight.samples.partition_point(before));
    }
    let events_apart = (tight.events.iter().zip(&likes.of_reference))
        .map(|(event, like)| {
            like.map_or(f64::INFINITY, |like| (loose.events[like].time - event.time).abs())
        })
        .collect();
    Ok(Pair { tight, apart, events_apart, tolerances, start, scales, parting, stopped })
}

/// One run; that the runs of a pair have parted is no error.
fn run<R: Recorder<Error = Infallible>>(
    case: &Case,
    mechanism: Mechanism<F256>,
    schedule: &Schedule,
    tolerance: f64,
    recorder: &mut R,
    parted: &AtomicBool,
    watch: Watch<'_>,
) -> Result<(), Error> {
    let mut interrupted = false;
    let mut told = |progress: &Progress| {
        interrupted = watch(Stage { tolerance, time: progress.time }).is_break();
        match interrupted || parted.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    };
    let (_, ran) =
        simulate::run_reference(case, mechanism, schedule, tolerance, recorder, &mut told);
    match ran {
        Err(simulate::Error::Interrupted { .. }) if interrupted => Err(Error::Interrupted),
        Ok(()) | Err(simulate::Error::Interrupted { .. }) => Ok(()),
        Err(source) => Err(Error::Stopped(Stopped { tolerance, source })),
    }
}

/// How a small change of the start grows, in exact arithmetic.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Growth {
    /// Scaled change at each sample over that at the start, as far as it can be told; nothing where a change of the start changes nothing.
    pub factors: Vec<f64>,
    /// Time (s) at which a change by 1e-16 has grown to a tenth of the scale: no double-precision
    /// run means anything beyond.
    pub double_precision_ends: Option<f64>,
}

/// Runs the case from a start that is changed by 1e-16, against its reference, until a tenth of
/// the scale lies between them. Where that is no longer linear the factors go on with the distance
/// between the two runs of the pair, which has long turned into the direction that grows most.
///
/// # Errors
/// See [`Error`].
pub fn growth(
    case: &Case,
    schedule: &Schedule,
    reference: &Pair,
    watch: Watch<'_>,
) -> Result<Growth, Error> {
    let mut mechanism: Mechanism<F256> = assemble(case)?;
    let share = F256::from(DOUBLE_PRECISION);
    mechanism.disturb_start(share).map_err(|complaints| case.reject(complaints))?;
    let parted = AtomicBool::new(false);
    let mut against = Against { reference, growth: Growth::default(), parted: &parted };
    let tolerance = 10f64.powf(-CHANGED);
    match run(case, mechanism, schedule, tolerance, &mut against, &parted, watch) {
        // it tells what it came to know
        Ok(()) | Err(Error::Stopped(_)) => {}
        Err(error) => return Err(error),
    }
    let mut growth = against.growth;
    growth.go_on(&reference.apart);
    growth.begin_with_one();
    Ok(growth)
}

impl Growth {
    /// Goes on with distances that grow at the same rate, where the factors have come to the end
    /// of what is linear; over the samples before, the two are the same on the mean. Not where the
    /// runs of the pair are so tight that their distance there is not known: the factors then end.
    fn go_on(&mut self, apart: &[Parts<f64>]) {
        if self.double_precision_ends.is_none() {
            return;
        }
        let linear = self.factors.iter().take_while(|apart| **apart < LINEAR).count();
        let shared = (linear - linear / 4..linear).filter(|k| *k < apart.len());
        let ratios: Vec<f64> = shared
            .filter(|k| apart[*k].state > VISIBLE)
            .map(|k| (self.factors[k] / apart[k].state).ln())
            .collect();
        if ratios.is_empty() {
            return;
        }
        let ratio = (ratios.iter().sum::<f64>() / ratios.len() as f64).exp();
        self.factors.truncate(linear);
        self.factors.extend(apart.iter().skip(linear).map(|apart| ratio * apart.state));
    }

    fn begin_with_one(&mut self) {
        match self.factors.first().copied() {
            Some(first) if first > NOTHING => self.factors.iter_mut().for_each(|f| *f /= first),
            _ => self.factors.clear(),
        }
    }
}

/// Compares a run with the reference until a tenth of the scale lies between them.
struct Against<'a> {
    reference: &'a Pair,
    growth: Growth,
    parted: &'a AtomicBool,
}

impl Recorder for Against<'_> {
    type Error = Infallible;

    fn sample(&mut self, observation: &Observation) -> Result<(), Infallible> {
        let Pair { tight, scales, .. } = self.reference;
        let there = tight.samples.get(self.growth.factors.len());
        let apart = there.map(|there| scales.differences(observation, there).state);
        match apart {
            Some(apart) if apart < 0.1 => self.growth.factors.push(apart),
            Some(_) => {
                self.growth.double_precision_ends.get_or_insert(observation.time);
                self.parted.store(true, Ordering::Relaxed);
            }
            None => self.parted.store(true, Ordering::Relaxed),
        }
        Ok(())
    }

    fn event(&mut self, _: Event) -> Result<(), Infallible> {
        Ok(())
    }

    fn contact(&mut self, _: Contact) -> Result<(), Infallible> {
        Ok(())
    }

    fn peak(&mut self, _: Peak) -> Result<(), Infallible> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: u64 = 5;

    /// A pair at this tolerance with a sample every second, so many of which both runs have, and
    /// agree on.
    fn pair(loose: f64, samples: u64, stops: bool) -> Pair {
        let sample = |k: u64| Observation { time: k as f64, ..Observation::default() };
        let tight =
            Trajectory { samples: (0..samples).map(sample).collect(), ..Trajectory::default() };
        let sizes = Sizes { mass: 1.0, length: 1.0, rate: 1.0, clearances: Vec::new() };
        let tolerances = [loose + APART, loose].map(|exponent| 10f64.powf(-exponent));
        let source = simulate::Error::Interrupted { time: samples as f64 };
        Pair {
            apart: vec![Parts::all(1e-20); samples as usize],
            events_apart: Vec::new(),
            scales: Scales::of(&tight.samples, &sizes),
            tight,
            tolerances,
            start: 0.0,
            parting: None,
            stopped: stops.then_some(Stopped { tolerance: tolerances[0], source }),
        }
    }

    /// Runs a search over pairs of which one stops after so many samples; the exponents tried.
    fn tried(stops: impl Fn(usize) -> Option<u64>) -> (Pair, Vec<f64>) {
        let mut tried = Vec::new();
        let run = |loose| {
            let stops = stops(tried.len());
            tried.push(loose);
            Ok(pair(loose, stops.unwrap_or(SAMPLES), stops.is_some()))
        };
        let Ok(found) = search(run, 10.0, SAMPLES, 4.0) else { panic!("no run was interrupted") };
        (found, tried)
    }

    #[test]
    fn where_a_pair_stops_another_tolerance_is_tried_and_its_pair_taken() {
        let (found, exponents) = tried(|k| (k == 0).then_some(2));
        assert_eq!(exponents, [24.0, 25.0]);
        assert!(found.stopped.is_none() && found.apart.len() == 5);
        assert_eq!(found.tolerances, [30.0, 25.0].map(|exponent| 10f64.powf(-exponent)));
    }

    #[test]
    fn a_pair_that_stops_before_any_sample_is_no_end_either() {
        let (found, exponents) = tried(|k| (k < 2).then_some(0));
        assert_eq!(exponents, [24.0, 25.0, 29.0]);
        assert!(found.stopped.is_none() && found.apart.len() == 5);
    }

    #[test]
    fn where_every_pair_stops_the_one_that_came_furthest_is_taken() {
        let (found, exponents) = tried(|k| Some([2, 4, 3, 1][k]));
        assert_eq!(exponents, [24.0, 25.0, 29.0, 36.0]);
        assert!(found.stopped.is_some() && found.apart.len() == 4);
        assert_eq!(found.tolerances[1], 10f64.powf(-25.0));
    }
}
