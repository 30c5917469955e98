//! The horizon of a run: until when its numbers are the mechanism's, and not those of its errors.
//!
//! A companion goes along: the explicit engine in dual numbers, at a tolerance of its own. Its
//! derivative by a change of the start says how much an error made there has grown, and so what
//! double precision leaves of any run. Its distance from the run says what the run's own errors
//! have come to. A run has the fewer of both digits, and never more than it had before: an error
//! that is small for a moment is no truth won back.
//!
//! This is an estimate and no certificate: two runs may err alike.

use super::tangent::Tangent;
use crate::case::{Case, EngineName, Precision, SolverPlan};
use crate::digits::{Largest, MOST_DIGITS, Parts, Scales, Sizes, digits};
use crate::mechanism::Observation;
use crate::record::{self, Attribute, Dimension, ResultFile, Series, Values};
use crate::run::{Contact, Event, Peak, Progress, Recorder, Schedule, Watcher};
use crate::scalar::F256;
use crate::simulate::{self, run_tangent};
use std::cell::Cell;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::slice;

/// Digits with which numbers still mean something: errors below a tenth of their scale.
pub const LEAST_DIGITS: f64 = 1.0;
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
/// The same for those who ask how errors grow to the end: numbers end there.
const OVERFLOWING: f64 = 1e250;
/// The loosest tolerance that the companion works to.
const LOOSEST: f64 = 1e-9;
/// The tightest.
const TIGHTEST: f64 = 1e-15;
/// How much looser the companion of a run by the same engine works: its own error, which is the
/// larger by as much, is then their distance, and costs fewer steps than that of a tighter one.
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
        let gone_by = self.kept.last().map(|(kept, _)| number - kept);
        if gone_by.is_none_or(|gone_by| gone_by >= number / DENSITY) {
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

/// Digits of a run at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Digits {
    /// Of angles, rates, velocities and clearance vectors.
    pub state: f64,
    /// Of forces and torques, and so of their peaks.
    pub forces: f64,
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

/// Sends a companion along a run of a case that is done. A companion that fails, or that whoever
/// watches asks to stop, says so in what it tells.
pub fn companion(
    case: &Case,
    schedule: &Schedule,
    witness: &Witness,
    reach: Reach,
    watch: Watcher<'_>,
) -> Companion {
    let samples: Vec<&Observation> = witness.to_follow().map(|(_, sample)| sample).collect();
    let times: Vec<f64> = samples.iter().map(|sample| sample.time).collect();
    let end = times.last().copied().unwrap_or(0.0);
    let (gone, lost) = (Cell::new(false), Cell::new(false));
    let mut follower = Follower {
        scales: witness.scales(),
        samples,
        contacts: &witness.contacts,
        lengths: Vec::new(),
        apart: Vec::new(),
        peaks_apart: Vec::new(),
        met: vec![0; witness.contacts.len()],
        enough: if reach.to_the_end { OVERFLOWING } else { GONE },
        gone: &gone,
    };
    let most_steps = reach.run_steps.saturating_mul(MORE_STEPS).saturating_add(FEW_STEPS);
    let mut watch = |progress: &Progress| {
        lost.set(progress.steps > most_steps);
        if gone.get() || lost.get() { ControlFlow::Break(()) } else { watch(progress) }
    };
    let ran = match times.is_empty() {
        true => Ok(()),
        false => follow(case, &schedule.clone().at(times.clone()), &mut follower, &mut watch),
    };
    let Follower { lengths, apart, peaks_apart, .. } = follower;
    let stopped = match ran {
        Ok(()) => None,
        Err(simulate::Error::Interrupted { .. }) if gone.get() => None,
        Err(simulate::Error::Interrupted { .. }) if lost.get() => {
            Some(format!("it took more than {most_steps} steps"))
        }
        Err(simulate::Error::Interrupted { .. }) => Some("it was interrupted".to_owned()),
        Err(error) => Some(super::chain(&error)),
    };
    let tangent = Tangent::new(times[..lengths.len()].to_vec(), lengths);
    let apart = with_peaks(apart, &tangent.times, peaks_apart);
    let digits = estimate(case, &tangent, &apart);
    Companion {
        parts_early: parts_early(case, &tangent, &digits),
        tangent,
        digits,
        end,
        stopped,
        samples: witness.samples,
        places: witness.to_follow().map(|(number, _)| *number).collect(),
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
    follower: &mut Follower<'_>,
    watch: Watcher<'_>,
) -> Result<(), simulate::Error<Infallible>> {
    let solver = &case.plan.solver;
    let tolerance = companion_tolerance(solver);
    let (_, ran) = match solver.precision {
        Precision::Octuple => run_tangent::<F256, _>(case, schedule, tolerance, follower, watch),
        Precision::Double => run_tangent::<f64, _>(case, schedule, tolerance, follower, watch),
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
        (EngineName::Ida, _) => solver.relative_tolerance.clamp(TIGHTEST, LOOSEST),
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

/// Holds the companion against the run, sample by sample.
struct Follower<'a> {
    scales: Scales,
    samples: Vec<&'a Observation>,
    /// Contacts of the run, by clearance.
    contacts: &'a [Vec<Contact>],
    /// Scaled lengths of the tangent.
    lengths: Vec<f64>,
    apart: Vec<Parts<f64>>,
    /// What the largest forces of contacts are apart, scaled, with their times (s).
    peaks_apart: Vec<(f64, f64)>,
    /// Contacts met so far, by clearance.
    met: Vec<usize>,
    /// Scaled length of an error of double precision from which on nothing is to be learnt.
    enough: f64,
    gone: &'a Cell<bool>,
}

impl Recorder for Follower<'_> {
    type Error = Infallible;

    fn sample(&mut self, observation: &Observation) -> Result<(), Infallible> {
        let Some(run) = self.samples.get(self.lengths.len()) else { return Ok(()) };
        let length = self.scales.beyond(observation);
        let bare = Observation { beyond: Vec::new(), ..observation.clone() };
        let run = Observation { beyond: Vec::new(), ..(*run).clone() };
        self.apart.push(self.scales.differences(&run, &bare));
        self.lengths.push(length);
        if !(super::tangent::DOUBLE * length < self.enough) {
            self.gone.set(true);
        }
        Ok(())
    }

    fn event(&mut self, _: Event) -> Result<(), Infallible> {
        Ok(())
    }

    /// Holds the largest force of a contact against that of the run's: the same one in the order
    /// of its clearance.
    fn contact(&mut self, contact: Contact) -> Result<(), Infallible> {
        let number = self.met[contact.clearance];
        self.met[contact.clearance] += 1;
        // one that the companion has not seen to its end may yet come to its largest force
        let run = self.contacts[contact.clearance].get(number);
        if let Some(run) = run.filter(|run| run.end.is_nan() || !contact.end.is_nan()) {
            let off = (run.peak_force - contact.peak_force).abs() / self.scales.force;
            self.peaks_apart.push((run.peak_time.min(contact.peak_time), off));
        }
        Ok(())
    }

    fn peak(&mut self, _: Peak) -> Result<(), Infallible> {
        Ok(())
    }
}

/// The horizon of a run as its result file tells it.
#[derive(Debug, Clone, PartialEq)]
pub struct Horizon {
    /// Until when angles, rates, velocities and clearance vectors mean something (s).
    pub state: f64,
    /// Until when forces, torques, accelerations and their peaks do (s).
    pub forces: f64,
    /// Until when any double-precision run of the case does (s), where it is known.
    pub doubles: Option<f64>,
    /// Digits at the end of the run, where they are known; none beyond the horizon.
    pub at_end: Option<Digits>,
    /// Time of the last sample (s).
    pub end: f64,
    /// Whether it is certified, not estimated.
    pub certified: bool,
    /// Why what is beyond is not known, where it is not.
    pub stopped: Option<String>,
}

/// What a number beyond the horizon is.
pub const ONE_DRAW: &str = "one draw from the distribution that chaos makes of it";

impl Horizon {
    /// Of a result file; `None` where it tells none. A certified reference has that of its
    /// certificate.
    ///
    /// # Errors
    /// What reading the file meets.
    pub fn of(file: &ResultFile) -> Result<Option<Horizon>, record::Error> {
        let times = file.times()?;
        let Some(&end) = times.last() else { return Ok(None) };
        let estimated = file.number("horizon").zip(file.number("horizon_forces"));
        if let Some((state, forces)) = estimated {
            let at_end = file.number("digits_at_end").zip(file.number("digits_at_end_forces"));
            return Ok(Some(Horizon {
                state,
                forces,
                doubles: file.number("horizon_doubles"),
                at_end: at_end.map(|(state, forces)| Digits { state, forces }),
                end,
                certified: false,
                stopped: file.text("horizon_stopped").map(str::to_owned),
            }));
        }
        let certified = file.along(Dimension::Time, "reference_digits")?;
        let of = |name: &str| file.along(Dimension::Time, name);
        let Some(state) = certified.clone().map_or_else(|| of("digits_left"), |of| Ok(Some(of)))?
        else {
            return Ok(None);
        };
        let mut forces = state.clone();
        for name in ["reference_digits_forces", "reference_digits_torque"] {
            for (least, digits) in forces.iter_mut().zip(of(name)?.unwrap_or_default()) {
                *least = if digits.is_nan() { digits } else { least.min(digits) };
            }
        }
        let until = |digits: &[f64]| {
            let held = digits.iter().take_while(|digits| **digits >= LEAST_DIGITS).count();
            held.checked_sub(1).and_then(|last| times.get(last)).copied().unwrap_or(0.0)
        };
        let last = state.last().zip(forces.last());
        Ok(Some(Horizon {
            state: until(&state),
            forces: until(&forces),
            doubles: file.number("double_precision_ends"),
            at_end: last.map(|(state, forces)| Digits { state: *state, forces: *forces }),
            end,
            certified: certified.is_some(),
            stopped: None,
        }))
    }

    /// Whether the whole run lies within it.
    pub fn is_whole(&self) -> bool {
        self.state.min(self.forces) >= self.end
    }

    /// One sentence about a result file that can be quoted: what made it, from what, and how far
    /// it is true.
    pub fn sentence(&self, file: &ResultFile) -> String {
        let text = |name: &str| file.text(name).unwrap_or("unknown");
        let engine = match (file.text("engine"), self.certified) {
            (Some("ida"), false) => format!("SUNDIALS IDA {}", text("sundials_version")),
            _ => "explicit engine".to_owned(),
        };
        let tolerance = file.attribute("relative_tolerance");
        let tolerance = tolerance.map_or(String::new(), |value| {
            if self.certified {
                ", 71-digit arithmetic".to_owned()
            } else {
                format!(", relative tolerance {value}")
            }
        });
        let how = match (self.certified, file.text("engine")) {
            (true, _) => "certified against a second 71-digit run",
            (false, Some("ida")) => "by comparison with a run of an independent integrator",
            (false, _) => "by comparison with a run at another tolerance",
        };
        format!(
            "Simulated with {} ({engine}{tolerance}) from the case file with SHA-256 {}; {how}, {}.",
            text("source"),
            text("case_sha256"),
            self.holds()
        )
    }

    /// How far the run is true, in words.
    pub fn holds(&self) -> String {
        const STATE: &str = "angles, rates, velocities and clearance vectors";
        const FORCES: &str = "forces, torques and their peaks";
        let whole = |until: f64| until >= self.end;
        let of = |what: &str, until: f64, digits: Option<f64>| match (whole(until), digits) {
            (true, Some(digits)) => {
                let digits = (digits * 10.0).floor() / 10.0;
                format!("{what} are true to {digits:.1} digits to its end at {}", ms(self.end))
            }
            (true, None) => format!("{what} mean something to its end at {}", ms(self.end)),
            (false, _) if until <= 0.0 => format!("{what} are true to no digit"),
            (false, _) => format!("{what} are true to a digit or more until {}", ms(until)),
        };
        let digits = self.at_end;
        let state = of(STATE, self.state, digits.map(|digits| digits.state));
        let forces = of(FORCES, self.forces, digits.map(|digits| digits.forces));
        let beyond = match (self.is_whole(), &self.stopped) {
            (true, _) => String::new(),
            (false, None) => format!("; a number beyond is {ONE_DRAW}"),
            (false, Some(_)) => "; how far numbers beyond are true is not known".to_owned(),
        };
        format!("{state}, {forces}{beyond}")
    }
}

/// A time in milliseconds, to four digits.
pub fn ms(time: f64) -> String {
    let time = time * 1e3;
    if time == 0.0 {
        return "0 ms".to_owned();
    }
    let decimals = (3 - time.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{time:.decimals$} ms")
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
    fn a_peak_that_is_off_counts_from_the_next_sample_on() {
        let none = vec![Parts::all(0.0); 3];
        let apart = with_peaks(none, &[0.0, 1.0, 2.0], vec![(0.5, 0.25), (5.0, 1.0)]);
        let forces: Vec<f64> = apart.iter().map(|apart| apart.forces).collect();
        assert_eq!(forces, [0.0, 0.25, 0.0]);
    }
}
