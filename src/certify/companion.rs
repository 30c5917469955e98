//! What goes along with a run to find its horizon.
//!
//! A companion is the explicit engine in dual numbers, at a tolerance of its own. Its
//! derivative by a change of the start says how much an error made there has grown, and so what
//! double precision leaves of any run. Its distance from the run says what the run's own errors
//! have come to. A run has the fewer of both digits, and never more than it had before: an error
//! that is small for a moment is no truth won back.
//!
//! This is an estimate and no certificate: two runs may err alike.

use super::horizon::{Digits, Horizon, LEAST_DIGITS};
use super::tangent::{DOUBLE, Tangent};
use crate::case::{Case, EngineName, Precision, SolverPlan};
use crate::digits::{Largest, MOST_DIGITS, Parts, Scales, Sizes, digits};
use crate::mechanism::Observation;
use crate::record::{Attribute, Dimension, Series, Values};
use crate::run::{Contact, Event, Peak, Progress, Recorder, Schedule, Watcher};
use crate::scalar::F256;
use crate::simulate::{self, run_tangent};
use std::cell::Cell;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::slice;
use std::sync::atomic::{AtomicU64, Ordering};

/// Samples of a run that its companion looks at: of those so far one more where as many have gone by
/// as this part of them, so that a horizon is known to a part of itself and memory stays bounded.
const DENSITY: usize = 256;
/// Steps of a companion over those of the run, from which on it is lost: in a storm of events, say.
const MORE_STEPS: u64 = 20;
/// Steps that are few for any run.
const FEW_STEPS: u64 = 2000;
/// Contacts that it looks at, at most.
const MOST_CONTACTS: usize = 1 << 16;
/// Samples from which on no digits are written for each.
const MOST_SERIES: usize = 1 << 20;
/// Growth of an error of double precision, in its scale, behind which nothing is left to be seen.
const GONE: f64 = 1e3;
/// By how much further it goes: the scale of the whole run may be larger than that seen so far.
const FURTHER: f64 = 1e3;
/// The same for those who ask how errors grow to the end: numbers end there.
const OVERFLOWING: f64 = 1e250;
/// The loosest tolerance that the companion works to.
const LOOSEST: f64 = 1e-9;
/// The tightest.
const TIGHTEST: f64 = 1e-15;
/// How much looser a companion works than its run, so as to cost less. Of a run by the same engine it
/// has an error that is the larger by as much, which is then their distance; one of IDA errs far more
/// than a companion does even so.
const LOOSER: f64 = 10.0;
/// How much tighter it works where that were too loose.
const TIGHTER: f64 = 1e-2;
/// Scaled distance of run and companion from which on they have parted, so that no part of it may be
/// said to be the run's.
const PARTED: f64 = 0.5;
/// Error of a trajectory over the tolerance of its steps: some tens.
const ERROR_OF_STEPS: f64 = 100.0;
/// By how much more a run may be off before it is odd, where this many digits should be left.
const ODD: (f64, f64) = (10.0, 3.0);

/// Number of the sample that is kept next.
fn next_kept(kept: usize) -> usize {
    // as long as the one before has less than this part of its number behind it
    let mut next = kept + (kept / DENSITY).max(1);
    while next - kept < next / DENSITY {
        next += 1;
    }
    next
}

/// What a companion must know of a run: the sizes of its quantities, and samples to be held
/// against. Of a long run fewer and fewer are kept, so that memory stays bounded.
#[derive(Debug)]
pub struct Witness {
    sizes: Sizes,
    largest: Largest,
    /// Samples kept, each with its number.
    kept: Vec<(usize, Observation)>,
    /// The last sample, where it is not among them.
    last: Option<(usize, Observation)>,
    samples: usize,
    /// Contacts, by clearance.
    contacts: Vec<Vec<Contact>>,
}

impl Witness {
    /// Of a run of a mechanism of this size.
    pub fn new(sizes: Sizes) -> Self {
        let contacts = vec![Vec::new(); sizes.clearances.len()];
        let largest = Largest::default();
        Witness { sizes, largest, kept: Vec::new(), last: None, samples: 0, contacts }
    }

    /// Takes note of a sample.
    pub fn take(&mut self, sample: &Observation) {
        self.largest = self.largest.or(&Largest::of(slice::from_ref(sample)));
        let number = self.samples;
        if self.kept.last().is_none_or(|(kept, _)| number >= next_kept(*kept)) {
            self.kept.push((number, sample.clone()));
            self.last = None;
        } else {
            self.last = Some((number, sample.clone()));
        }
        self.samples += 1;
    }

    /// Takes note of a contact.
    pub fn take_contact(&mut self, contact: Contact) {
        if let Some(contacts) = self.contacts.get_mut(contact.clearance)
            && contacts.len() < MOST_CONTACTS
        {
            contacts.push(contact);
        }
    }

    /// The samples that the companion is to take, with their numbers.
    fn to_follow(&self) -> impl Iterator<Item = &(usize, Observation)> {
        let kept = self.kept.last().map(|(number, _)| *number);
        self.kept.iter().chain(self.last.iter().filter(move |(number, _)| Some(*number) > kept))
    }

    /// The scales that digits are counted in.
    fn scales(&self) -> Scales {
        Scales::new(&self.sizes, &self.largest)
    }
}

/// Until when something holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Until {
    /// Not even at the start.
    Never,
    /// Until this time (s).
    Time(f64),
    /// To the end of the run.
    End,
}

/// What a companion tells of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Companion {
    /// Growth of errors, at the samples that were looked at.
    pub tangent: Tangent,
    /// Digits of the run at these samples, as far as they are known.
    pub digits: Vec<Digits>,
    /// Time of the run's last sample (s).
    pub end: f64,
    /// Why the companion stopped before it came to know the horizon, if it did.
    pub stopped: Option<String>,
    /// When (s) run and companion part although errors have not grown that much, if they do: one
    /// of them may have missed an event.
    pub parts_early: Option<f64>,
    /// How many samples the run has.
    samples: usize,
    /// Numbers of those that were looked at.
    places: Vec<usize>,
}

/// How far a companion goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reach {
    /// To the end of the run, and not only to where its numbers mean nothing any more.
    pub to_the_end: bool,
    /// Steps that the run took: a companion that takes far more is lost.
    pub run_steps: u64,
}

impl Reach {
    /// Steps that a companion may take.
    pub fn most_steps(&self) -> u64 {
        self.run_steps.saturating_mul(MORE_STEPS).saturating_add(FEW_STEPS)
    }
}

/// Growth of an error of double precision from which on nothing is to be learnt.
fn enough(to_the_end: bool) -> f64 {
    if to_the_end { OVERFLOWING } else { GONE }
}

/// Sends a companion after a run of a case that is done. A companion that fails, or that whoever
/// watches asks to stop, says so in what it tells.
pub fn companion(
    case: &Case,
    schedule: &Schedule,
    witness: &Witness,
    reach: Reach,
    watch: Watcher<'_>,
) -> Companion {
    let times: Vec<f64> = witness.to_follow().map(|(_, sample)| sample.time).collect();
    let most_steps = AtomicU64::new(reach.most_steps());
    let errand = Errand { times, to_the_end: reach.to_the_end, most_steps: &most_steps };
    errand.walk(case, schedule, &witness.sizes, watch).beside(case, witness, reach)
}

/// Times (s) at which a companion can go along while its run goes on, where they are known
/// beforehand: those of the samples that a [`Witness`] of the whole run will have.
pub fn times_to_follow(schedule: &Schedule) -> Option<Vec<f64>> {
    let last = usize::try_from(schedule.len()).ok()?.checked_sub(1)?;
    if schedule.is_adaptive() {
        return None;
    }
    let kept = std::iter::successors(Some(0), |kept| Some(next_kept(*kept)).filter(|n| *n <= last));
    let mut numbers: Vec<usize> = kept.collect();
    numbers.extend(Some(last).filter(|last| numbers.last() != Some(last)));
    Some(numbers.into_iter().map(|number| schedule.time(number as u64)).collect())
}

/// What a companion is sent for.
#[derive(Debug)]
pub struct Errand<'a> {
    /// When it is to look (s).
    pub times: Vec<f64>,
    /// Whether it goes to the end of the run, and not only to where numbers mean nothing any more.
    pub to_the_end: bool,
    /// Steps that it may take; may become fewer while it goes.
    pub most_steps: &'a AtomicU64,
}

impl Errand<'_> {
    /// Goes, as far as there is something to be learnt.
    pub fn walk(self, case: &Case, schedule: &Schedule, sizes: &Sizes, watch: Watcher<'_>) -> Walk {
        let (gone, steps) = (Cell::new(false), Cell::new(0));
        let mut walker = Walker {
            sizes,
            largest: Largest::default(),
            kept: Walk::default(),
            enough: FURTHER * enough(self.to_the_end),
            steps: &steps,
            gone: &gone,
        };
        let mut lost = false;
        let mut watch = |progress: &Progress| {
            steps.set(progress.steps);
            lost = progress.steps > self.most_steps.load(Ordering::Relaxed);
            if gone.get() || lost { ControlFlow::Break(()) } else { watch(progress) }
        };
        let ran = match self.times.is_empty() {
            true => Ok(()),
            false => follow(case, &schedule.clone().at(self.times), &mut walker, &mut watch),
        };
        let mut walk = walker.kept;
        walk.steps_in_all = steps.get();
        walk.stopped = match ran {
            Ok(()) => None,
            Err(simulate::Error::Interrupted { .. }) if gone.get() || lost => None,
            Err(simulate::Error::Interrupted { .. }) => Some("it was interrupted".to_owned()),
            Err(error) => Some(super::chain(&error)),
        };
        walk
    }
}

/// What a companion has seen by itself.
#[derive(Debug, Default)]
pub struct Walk {
    samples: Vec<Observation>,
    /// Steps it had taken at each.
    steps: Vec<u64>,
    steps_in_all: u64,
    contacts: Vec<Contact>,
    /// Why it stopped before there was nothing to be learnt any more, if it did.
    stopped: Option<String>,
}

impl Walk {
    /// Holds what the companion has seen against its run, sample by sample.
    pub fn beside(self, case: &Case, witness: &Witness, reach: Reach) -> Companion {
        let scales = witness.scales();
        let (enough, most_steps) = (enough(reach.to_the_end), reach.most_steps());
        let (mut lengths, mut apart, mut times) = (Vec::new(), Vec::new(), Vec::new());
        let (mut gone, mut lost) = (false, self.steps_in_all > most_steps);
        for ((_, run), (ours, steps)) in
            witness.to_follow().zip(self.samples.iter().zip(&self.steps))
        {
            if *steps > most_steps {
                lost = true;
                break;
            }
            let length = scales.beyond(ours);
            let bare = |sample: &Observation| Observation { beyond: Vec::new(), ..sample.clone() };
            apart.push(scales.differences(&bare(run), &bare(ours)));
            lengths.push(length);
            times.push(run.time);
            gone = !(DOUBLE * length < enough);
            if gone {
                break;
            }
        }
        let stopped = match (gone, lost) {
            (true, _) => None,
            (false, true) => Some(format!("it took more than {most_steps} steps")),
            (false, false) => self.stopped,
        };
        let peaks_apart = peaks_apart(&self.contacts, &witness.contacts, scales.force);
        let apart = with_peaks(apart, &times, peaks_apart);
        let tangent = Tangent::new(times, lengths);
        let digits = estimate(case, &tangent, &apart);
        Companion {
            parts_early: parts_early(case, &tangent, &digits),
            tangent,
            digits,
            end: witness.to_follow().last().map_or(0.0, |(_, sample)| sample.time),
            stopped,
            samples: witness.samples,
            places: witness.to_follow().map(|(number, _)| *number).collect(),
        }
    }
}

/// What the largest forces of contacts are apart, scaled, with their times (s): of the same one in
/// the order of its clearance. `runs` are the contacts of the run, by clearance.
fn peaks_apart(ours: &[Contact], runs: &[Vec<Contact>], scale: f64) -> Vec<(f64, f64)> {
    let mut met = vec![0; runs.len()];
    let mut apart = Vec::new();
    for contact in ours {
        let number = met[contact.clearance];
        met[contact.clearance] += 1;
        // one that the companion has not seen to its end may yet come to its largest force
        let run = runs[contact.clearance].get(number);
        if let Some(run) = run.filter(|run| run.end.is_nan() || !contact.end.is_nan()) {
            let off = (run.peak_force - contact.peak_force).abs() / scale;
            apart.push((run.peak_time.min(contact.peak_time), off));
        }
    }
    apart
}

/// Keeps what a companion sees, and notices when errors have grown so far that nothing is left.
struct Walker<'a> {
    sizes: &'a Sizes,
    largest: Largest,
    kept: Walk,
    /// Scaled length of an error of double precision from which on nothing is to be learnt.
    enough: f64,
    steps: &'a Cell<u64>,
    gone: &'a Cell<bool>,
}

impl Recorder for Walker<'_> {
    type Error = Infallible;

    fn sample(&mut self, observation: &Observation) -> Result<(), Infallible> {
        self.largest = self.largest.or(&Largest::of(slice::from_ref(observation)));
        let length = Scales::new(self.sizes, &self.largest).beyond(observation);
        if !(DOUBLE * length < self.enough) {
            self.gone.set(true);
        }
        self.kept.samples.push(observation.clone());
        self.kept.steps.push(self.steps.get());
        Ok(())
    }

    fn event(&mut self, _: Event) -> Result<(), Infallible> {
        Ok(())
    }

    fn contact(&mut self, contact: Contact) -> Result<(), Infallible> {
        if self.kept.contacts.len() < MOST_CONTACTS * self.sizes.clearances.len() {
            self.kept.contacts.push(contact);
        }
        Ok(())
    }

    fn peak(&mut self, _: Peak) -> Result<(), Infallible> {
        Ok(())
    }
}

/// When a run loses its last digit although the growth of errors leaves it some.
fn parts_early(case: &Case, tangent: &Tangent, digits: &[Digits]) -> Option<f64> {
    let lost = digits.iter().position(|digits| digits.state < LEAST_DIGITS)?;
    let (more, left) = ODD;
    let expected = tangent.digits_of(case.plan.solver.relative_tolerance * ERROR_OF_STEPS * more);
    (expected[lost] >= left).then(|| tangent.times[lost])
}

/// Differences at samples, with those of peaks (s, scaled) at the first sample behind them.
fn with_peaks(
    mut apart: Vec<Parts<f64>>,
    times: &[f64],
    peaks: Vec<(f64, f64)>,
) -> Vec<Parts<f64>> {
    for (time, off) in peaks {
        if let Some(here) = apart.get_mut(times.partition_point(|sample| *sample < time)) {
            here.forces = if off.is_nan() { f64::INFINITY } else { here.forces.max(off) };
        }
    }
    apart
}

/// Runs the companion in the arithmetic and at the tolerance that suit the run.
fn follow(
    case: &Case,
    schedule: &Schedule,
    walker: &mut Walker<'_>,
    watch: Watcher<'_>,
) -> Result<(), simulate::Error<Infallible>> {
    let solver = &case.plan.solver;
    let tolerance = companion_tolerance(solver);
    let (_, ran) = match solver.precision {
        Precision::Octuple => run_tangent::<F256, _>(case, schedule, tolerance, walker, watch),
        Precision::Double => run_tangent::<f64, _>(case, schedule, tolerance, walker, watch),
    };
    ran
}

/// Tolerance that a companion works to.
fn companion_tolerance(solver: &SolverPlan) -> f64 {
    match (solver.engine, solver.precision) {
        (EngineName::Explicit, Precision::Octuple) => solver.reference_tolerance,
        (EngineName::Explicit, Precision::Double) => {
            let looser = solver.relative_tolerance * LOOSER;
            let tighter = solver.relative_tolerance * TIGHTER;
            if looser <= LOOSEST { looser } else { tighter.min(LOOSEST) }.max(TIGHTEST)
        }
        (EngineName::Ida, _) => (LOOSER * solver.relative_tolerance).clamp(TIGHTEST, LOOSEST),
    }
}

/// By how much the companion's error exceeds that of the run it is the distance from, where both
/// are of one engine: as their tolerances do.
fn excess(solver: &SolverPlan) -> f64 {
    match (solver.engine, solver.precision) {
        (EngineName::Explicit, Precision::Double) => {
            (companion_tolerance(solver) / solver.relative_tolerance).max(1.0)
        }
        _ => 1.0,
    }
}

/// Digits of the run, from the growth of errors and from its distance to the companion. A run in
/// 71 digits has the same companion: what is known of it is the tolerance of its steps.
fn estimate(case: &Case, tangent: &Tangent, apart: &[Parts<f64>]) -> Vec<Digits> {
    let solver = &case.plan.solver;
    let in_doubles = solver.precision == Precision::Double;
    let of_steps = tangent.digits_of(solver.reference_tolerance * ERROR_OF_STEPS);
    let left = if in_doubles { tangent.digits_left() } else { of_steps };
    let mut least = Digits { state: MOST_DIGITS, forces: MOST_DIGITS };
    let excess = excess(solver);
    let own = |apart: f64| if excess > 1.0 && apart >= PARTED { 1.0 } else { apart / excess };
    let digits_of = |difference: f64| digits(own(difference)).max(0.0);
    let known = left.iter().zip(apart).map(|(left, apart)| {
        let Parts { state, forces, torque } = apart.map(digits_of);
        least.state = least.state.min(*left).min(state);
        least.forces = least.forces.min(least.state).min(forces).min(torque);
        least
    });
    known.collect()
}

impl Companion {
    /// Until when the run has so many digits of its state.
    pub fn state_until(&self, least: f64) -> Until {
        self.until(self.digits.iter().map(|digits| digits.state >= least))
    }

    /// Until when the run has so many digits of forces, torques and their peaks.
    pub fn forces_until(&self, least: f64) -> Until {
        self.until(self.digits.iter().map(|digits| digits.forces >= least))
    }

    /// Until when a double-precision run of this case, however accurate, means something.
    pub fn doubles_until(&self) -> Until {
        self.until(self.tangent.digits_left().iter().map(|left| *left >= LEAST_DIGITS))
    }

    fn until(&self, mut holds: impl ExactSizeIterator<Item = bool>) -> Until {
        let known = holds.len();
        let times = &self.tangent.times;
        match holds.position(|holds| !holds) {
            Some(0) => Until::Never,
            Some(k) => Until::Time(times[k - 1]),
            None if known == 0 => Until::Never,
            None if times[known - 1] >= self.end => Until::End,
            None => Until::Time(times[known - 1]),
        }
    }

    /// The horizon as a result file tells it.
    pub fn horizon(&self) -> Horizon {
        let time = |until: Until| match until {
            Until::Never => 0.0,
            Until::Time(time) => time,
            Until::End => self.end,
        };
        let whole = self.tangent.times.last().is_some_and(|time| *time >= self.end);
        let at_end = self.digits.last().filter(|_| whole);
        let none = Digits { state: 0.0, forces: 0.0 };
        Horizon {
            state: time(self.state_until(LEAST_DIGITS)),
            forces: time(self.forces_until(LEAST_DIGITS)),
            doubles: Some(time(self.doubles_until())),
            at_end: Some(at_end.copied().unwrap_or(none)),
            end: self.end,
            certified: false,
            stopped: self.stopped.clone(),
        }
    }

    /// What the companion adds to the attributes of a result file.
    pub fn attributes(&self) -> Vec<(String, Attribute)> {
        let Horizon { state, forces, doubles, at_end, stopped, .. } = self.horizon();
        let at_end = at_end.map(|digits| [digits.state, digits.forces]).unwrap_or_default();
        let numbers = [
            ("horizon", state),
            ("horizon_forces", forces),
            ("horizon_doubles", doubles.unwrap_or(state)),
            ("digits_at_end", at_end[0]),
            ("digits_at_end_forces", at_end[1]),
        ];
        let numbers =
            numbers.into_iter().map(|(name, value)| (name.to_owned(), Attribute::from(value)));
        let stopped = stopped.map(|why| ("horizon_stopped".to_owned(), Attribute::from(why)));
        let early = self.parts_early.map(|time| ("horizon_parts_early".to_owned(), time.into()));
        numbers.chain(stopped).chain(early).collect()
    }

    /// The datasets that the companion adds to a result file; none where samples are very many.
    pub fn series(&self) -> Vec<Series> {
        if self.samples > MOST_SERIES {
            return Vec::new();
        }
        let left = self.tangent.digits_left();
        // beyond a horizon there are no more digits than at it; of what nobody followed, none are known
        let beyond = |known: &[f64]| match self.stopped {
            Some(_) => f64::NAN,
            None => known.last().copied().unwrap_or(f64::NAN),
        };
        let digits = |of: fn(&Digits) -> f64| {
            let known: Vec<f64> = self.digits.iter().map(of).collect();
            self.at_samples(&known, true, beyond(&known))
        };
        [
            (
                "error_growth",
                "how much a small error of the start has grown, in the scales of digits; as far as \
                 it was followed",
                self.at_samples(&self.tangent.growth, false, f64::NAN),
            ),
            (
                "digits_left",
                "digits that errors of double precision leave",
                self.at_samples(&left, true, beyond(&left)),
            ),
            (
                "estimated_digits",
                "digits of angles, rates, velocities and clearance vectors of this run, estimated",
                digits(|digits| digits.state),
            ),
            (
                "estimated_digits_forces",
                "digits of forces, torques and their peaks of this run, estimated",
                digits(|digits| digits.forces),
            ),
        ]
        .into_iter()
        .map(|(name, long_name, values)| Series {
            name,
            unit: "1",
            long_name,
            stored: Values::Real,
            along: Dimension::Time,
            values,
        })
        .collect()
    }

    /// A value for each sample of the run: that of the last sample looked at, or of the next, if
    /// asked to look `ahead`; `beyond` where the companion did not come.
    fn at_samples(&self, values: &[f64], ahead: bool, beyond: f64) -> Vec<f64> {
        let mut place = 0;
        let at = |sample: usize| {
            while self.places.get(place).is_some_and(|number| *number < sample) {
                place += 1;
            }
            let exact = self.places.get(place) == Some(&sample);
            let here = if ahead || exact { place } else { place.saturating_sub(1) };
            values.get(here).copied().unwrap_or(beyond)
        };
        (0..self.samples).map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Changes;
    use std::path::Path;

    fn companion_of(lengths: &[f64], state: &[f64], end: f64) -> Companion {
        let times = (0..lengths.len()).map(|k| k as f64).collect();
        let digits = state.iter().map(|state| Digits { state: *state, forces: *state });
        Companion {
            tangent: Tangent::new(times, lengths.to_vec()),
            digits: digits.collect(),
            end,
            stopped: None,
            parts_early: None,
            samples: 5,
            places: vec![0, 2, 4],
        }
    }

    #[test]
    fn a_horizon_is_the_last_time_with_a_digit() {
        let companion = companion_of(&[1.0; 3], &[9.0, 2.0, 0.5], 2.0);
        assert_eq!(companion.state_until(1.0), Until::Time(1.0));
        assert_eq!(companion.state_until(9.5), Until::Never);
        assert_eq!(companion.forces_until(0.5), Until::End);
        // as far as it was followed
        assert_eq!(companion_of(&[1.0; 3], &[9.0; 3], 4.0).state_until(1.0), Until::Time(2.0));
        let horizon = companion.horizon();
        assert_eq!((horizon.state, horizon.forces, horizon.end), (1.0, 1.0, 2.0));
        assert!(horizon.holds().contains("until 1000 ms; a number beyond is"), "{horizon:?}");
    }

    #[test]
    fn samples_between_have_the_digits_of_the_next_that_was_looked_at() {
        let companion = companion_of(&[1.0; 3], &[9.0, 5.0, 2.0], 2.0);
        assert_eq!(companion.series()[2].values, [9.0, 5.0, 5.0, 2.0, 2.0]);
        assert_eq!(companion.series()[0].values, [1.0; 5]);
    }

    #[test]
    fn a_run_that_parts_before_errors_have_grown_is_odd() {
        let text = include_str!("../../cases/four-bar-a.toml");
        let case = Case::from_text(Path::new("a.toml"), text, &Changes::default()).unwrap();
        for (grown, expected) in [(100.0, Some(2.0)), (1e12, None)] {
            let Companion { tangent, digits, .. } =
                companion_of(&[100.0, 100.0, grown], &[9.0, 9.0, 0.5], 2.0);
            assert_eq!(parts_early(&case, &tangent, &digits), expected);
        }
    }

    #[test]
    fn of_many_samples_the_first_and_the_last_are_kept() {
        let sizes = Sizes { mass: 1.0, length: 1.0, rate: 1.0, clearances: Vec::new() };
        let mut witness = Witness::new(sizes);
        let many = 100 * DENSITY;
        for k in 0..many {
            witness.take(&Observation { time: k as f64, ..Observation::default() });
        }
        let numbers: Vec<usize> = witness.to_follow().map(|(number, _)| *number).collect();
        assert!(numbers.len() < 8 * DENSITY, "{}", numbers.len());
        assert!(numbers.windows(2).all(|two| two[0] < two[1]));
        assert!(numbers.windows(2).all(|two| two[1] - two[0] <= 1 + two[1] / DENSITY));
        assert_eq!(numbers[..DENSITY], (0..DENSITY).collect::<Vec<_>>());
        assert_eq!(numbers.last(), Some(&(many - 1)));
        assert!(witness.to_follow().all(|(number, sample)| sample.time == *number as f64));
    }

    #[test]
    fn a_companion_beside_a_run_looks_when_one_behind_it_would() {
        let sizes = Sizes { mass: 1.0, length: 1.0, rate: 1.0, clearances: Vec::new() };
        for (samples, interval) in [(1, "3.0"), (2, "1.0"), (300, "0.01"), (20_000, "1e-4")] {
            let [duration, interval] =
                ["2.0", interval].map(|text| crate::scalar::Decimal::new(text).unwrap());
            let schedule = Schedule::new(&duration, &interval);
            let mut witness = Witness::new(sizes.clone());
            for k in 0..schedule.len() {
                let time = schedule.time(k);
                witness.take(&Observation { time, ..Observation::default() });
            }
            let behind: Vec<f64> = witness.to_follow().map(|(_, sample)| sample.time).collect();
            assert_eq!(times_to_follow(&schedule).as_ref(), Some(&behind), "{samples} samples");
            assert_eq!(times_to_follow(&schedule.adaptive()), None);
        }
    }

    #[test]
    fn a_peak_that_is_off_counts_from_the_next_sample_on() {
        let none = vec![Parts::all(0.0); 3];
        let apart = with_peaks(none, &[0.0, 1.0, 2.0], vec![(0.5, 0.25), (5.0, 1.0)]);
        let forces: Vec<f64> = apart.iter().map(|apart| apart.forces).collect();
        assert_eq!(forces, [0.0, 0.25, 0.0]);
    }
}
