//! One trial: its certificate, held against the truth.

use super::number::pi;
use super::truth::{Aimed, Event, State};
use freeplay::case::{Case, Changes};
use freeplay::certify::{self, Error, Reference, Stage};
use freeplay::digits::digits;
use freeplay::mechanism::Observation;
use freeplay::model::Owner;
use freeplay::run::{EventKind, Progress};
use freeplay::scalar::{F256, Scalar};
use freeplay::simulate::Simulation;
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeVal;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

/// CPU (s) of all threads after which a certificate is cut, and after which it hangs, however busy
/// the machine.
const TOO_LONG: f64 = 120.0;
const HANGS: f64 = 240.0;
/// An event so near to the end, as a share of the time, may be on either side of it.
const LATE: f64 = 1e-12;

/// What fell: its kind, and the words.
pub struct Fall {
    pub kind: &'static str,
    pub words: String,
}

/// What came of a trial.
#[derive(Default)]
pub struct Verdict {
    pub falls: Vec<Fall>,
    /// Whether there is a certificate.
    pub certified: bool,
    /// Samples, events and peaks held against the truth.
    pub judged: usize,
    /// Least digits claimed of the state where the truth is known.
    pub least: f64,
}

impl Verdict {
    fn fall(&mut self, kind: &'static str, words: String) {
        self.falls.push(Fall { kind, words });
    }
}

/// What certifying came to.
enum Came {
    /// A reference, why the run in doubles stopped, and how many pairs were run.
    Certified(Box<Reference>, Option<String>, usize),
    /// The case is refused before anything runs.
    NoCase(String),
    Refused(String, usize),
    Cut,
}

/// CPU (s) of this process so far.
pub fn cpu() -> f64 {
    let usage = getrusage(UsageWho::RUSAGE_SELF).expect("the usage of this process");
    let seconds = |time: TimeVal| time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64;
    seconds(usage.user_time()) + seconds(usage.system_time())
}

/// An error with its causes.
fn words(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        words = format!("{words}: {error}");
        cause = error.source();
    }
    words
}

fn certify(text: &str) -> Came {
    let case = match Case::from_text(Path::new("aimed.toml"), text, &Changes::default()) {
        Ok(case) => case,
        Err(error) => return Came::NoCase(words(&error)),
    };
    // where doubles cannot start there is a reference all the same
    let simulation = match Simulation::new(&case).map_err(|error| words(&error)) {
        Ok(simulation) => Some(simulation),
        Err(words) if words.contains("dead centre") => None,
        Err(words) => return Came::NoCase(words),
    };
    let schedule = case.plan.schedule();
    let began = cpu();
    let late = || match cpu() - began > TOO_LONG {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let tolerances = Mutex::new(BTreeSet::new());
    let watch = |stage: Stage| {
        tolerances.lock().expect("no thread panicked").insert(stage.tolerance.to_bits());
        late()
    };
    let reference = certify::reference(&case, &schedule, 10.0, &watch);
    // two of each pair; the run with a changed start has the tolerance of the first. Where nothing
    // is integrated nobody is told before the end
    let pairs = match text.contains("clearance]") {
        true => tolerances.into_inner().expect("no thread panicked").len() / 2,
        false => 4,
    };
    match reference {
        Ok(reference) => {
            let kept = reference.clone();
            let Some(simulation) = simulation else {
                return Came::Certified(Box::new(kept), None, pairs);
            };
            match certify::certify(simulation, reference, &mut |_: &Progress| late()) {
                Ok(certificate) => Came::Certified(Box::new(kept), certificate.run_failure, pairs),
                Err(_) => Came::Cut,
            }
        }
        Err(Error::Interrupted) => Came::Cut,
        Err(Error::Case(error)) => Came::NoCase(words(&error)),
        Err(error) => Came::Refused(words(&error), pairs),
    }
}

/// The solver of a trial.
pub const SOLVER: &str = "[solver]\nabsolute_tolerance = \"scaled\"\n";

/// Certifies a trial and judges the certificate.
pub fn judge(aimed: &Aimed) -> Verdict {
    let mut verdict = Verdict { least: 16.0, ..Verdict::default() };
    let (send, receive) = mpsc::channel();
    let text = aimed.text.clone() + SOLVER;
    let began = cpu();
    std::thread::spawn(move || send.send(certify(&text)));
    let came = loop {
        match receive.recv_timeout(Duration::from_secs(1)) {
            Err(RecvTimeoutError::Timeout) if cpu() - began <= HANGS => {}
            came => break came,
        }
    };
    match came {
        Err(_) => verdict.fall("hangs", format!("it said nothing for {HANGS} s of CPU")),
        Ok(Came::Cut) => verdict.fall("hangs", format!("cut after {TOO_LONG} s of CPU")),
        Ok(Came::NoCase(words)) => verdict.fall("no case", words),
        Ok(Came::Refused(words, pairs)) => verdict.refuse(words, pairs),
        Ok(Came::Certified(reference, run_failure, pairs)) => {
            verdict.certified = true;
            if pairs > 1 && reference.complete && aimed.text.contains("clearance]") {
                verdict.fall("takes another pair", format!("{pairs} pairs"));
            }
            if let Some(words) = run_failure {
                verdict.fall("the run in doubles stops", words);
            }
            if !reference.complete {
                let last = reference.trajectory.samples.last().map_or(0.0, |sample| sample.time);
                let why = reference.stopped.clone().unwrap_or_default();
                verdict.refuse(format!("from {last:e} s on: {why}"), pairs);
            }
            verdict.hold(aimed, &reference);
        }
    }
    verdict
}

impl Verdict {
    fn refuse(&mut self, words: String, pairs: usize) {
        let kind = if pairs > 1 { "refused" } else { "refused at once" };
        self.fall(kind, format!("after {pairs} pairs: {words}"));
    }

    fn hold(&mut self, aimed: &Aimed, reference: &Reference) {
        self.hold_samples(aimed, reference);
        let last = reference.trajectory.samples.last().map_or(0.0, |sample| sample.time);
        let until = aimed.known.to_f64().min(last);
        if let Some(events) = &aimed.events {
            self.hold_events(events, reference, until);
            self.hold_peaks(aimed, reference, until);
        }
    }

    fn hold_samples(&mut self, aimed: &Aimed, reference: &Reference) {
        let interval = Interval::of(&aimed.text);
        for (k, (sample, wrong)) in
            reference.trajectory.samples.iter().zip(&reference.wrong).enumerate()
        {
            let Some(truth) = (aimed.at)(interval.time(k)) else { continue };
            let [state, forces] = off(sample, &truth, reference);
            self.judged += 1;
            let claims = wrong.map(digits);
            self.least = self.least.min(claims.state);
            for (what, off, claim) in
                [("the state", state, claims.state), ("forces", forces, claims.forces)]
            {
                if !(off <= 10f64.powf(-claim) * (1.0 + 1e-6)) {
                    let (time, true_digits) = (sample.time, digits(off));
                    self.fall(
                        "claim above the truth",
                        format!(
                            "{what} at {time:e} s: {claim:.2} digits claimed, {true_digits:.2} true"
                        ),
                    );
                    return;
                }
            }
        }
    }

    /// Whether events are the same until a time (s), clearance by clearance, and their times as true
    /// as is said of each.
    fn hold_events(&mut self, truth: &[Event], reference: &Reference, until: f64) {
        let found = &reference.trajectory.events;
        let clearances = truth.iter().map(|event| event.clearance);
        let clearances =
            clearances.chain(found.iter().filter_map(|event| event.owner.clearance())).max();
        for clearance in 0..=clearances.unwrap_or(0) {
            // an event on the end itself may be on either side of it
            let edge = until * (1.0 - LATE);
            let mut truth: Vec<(EventKind, f64)> = truth
                .iter()
                .filter(|event| event.clearance == clearance)
                .map(|event| (event.kind, event.time.to_f64()))
                .filter(|(_, time)| *time <= until)
                .collect();
            truth.sort_by(|a, b| a.1.total_cmp(&b.1));
            let found: Vec<(EventKind, f64, f64)> = (found.iter())
                .zip(&reference.event_times_wrong)
                .filter(|(event, _)| event.owner == Owner::Clearance(clearance))
                .filter(|(event, _)| event.time <= until)
                .map(|(event, wrong)| (event.kind, event.time, *wrong))
                .collect();
            self.judged += truth.len();
            let same = (truth.iter().zip(&found))
                .all(|(truth, found)| truth.0 == found.0 && (truth.1 - found.1).abs() <= found.2);
            let all = truth.iter().filter(|event| event.1 < edge).count() <= found.len()
                && found.iter().filter(|event| event.1 < edge).count() <= truth.len();
            if !same || !all {
                self.fall(
                    "events not those of the truth",
                    format!("clearance {clearance}: certified {found:?}, true {truth:?}"),
                );
            }
        }
    }

    fn hold_peaks(&mut self, aimed: &Aimed, reference: &Reference, until: f64) {
        let contacts = reference.trajectory.contacts.iter().filter(|contact| contact.end <= until);
        for (contact, (_, force)) in contacts.zip(&aimed.peaks) {
            self.judged += 1;
            let force = force.to_f64();
            let off = (contact.peak_force - force).abs();
            if !(off <= 1e-9 * force.abs() + 1e-15 * reference.scales.force) {
                self.fall(
                    "peak not that of the truth",
                    format!("{} N of {force} N at {:e} s", contact.peak_force, contact.peak_time),
                );
            }
        }
    }
}

/// Sample times as decimals: the interval and the end of a case's text.
struct Interval {
    interval: F256,
    duration: F256,
}

impl Interval {
    fn of(text: &str) -> Interval {
        let number = |key: &str| {
            let line = text.lines().find_map(|line| line.strip_prefix(key)).expect("the key");
            F256::parse(line.trim()).expect("a number")
        };
        Interval { interval: number("sample_interval ="), duration: number("duration =") }
    }

    fn time(&self, k: usize) -> F256 {
        Scalar::min(F256::ratio(k as i64, 1) * self.interval, self.duration)
    }
}

/// Largest scaled errors of state and forces of what a file would hold, the lesser where two are true.
fn off(sample: &Observation, truth: &State, reference: &Reference) -> [f64; 2] {
    let one = off_from(sample, truth, reference);
    let other = truth.or.as_ref().map(|other| off_from(sample, other, reference));
    other.filter(|other| other[0] < one[0]).unwrap_or(one)
}

fn off_from(sample: &Observation, truth: &State, reference: &Reference) -> [f64; 2] {
    let scales = &reference.scales;
    let turn = F256::ratio(2, 1) * pi();
    let apart = |double: f64, truth: F256| Scalar::abs(F256::from_f64(double) - truth).to_f64();
    let mut state: f64 = 0.0;
    let mut take = |off: f64, scale: f64| {
        let scaled = off / scale;
        state = if scaled.is_nan() { f64::INFINITY } else { state.max(scaled) };
    };
    for (body, truth) in sample.bodies.iter().zip(&truth.bodies) {
        let [_, _, angle, vx, vy, rate] = *truth;
        // whole turns aside
        let turns = ((F256::from_f64(body.angle) - angle) / turn).round();
        take(apart(body.angle, angle + turns * turn), scales.angle);
        take(apart(body.velocity[0], vx), scales.velocity);
        take(apart(body.velocity[1], vy), scales.velocity);
        take(apart(body.angular_velocity, rate), scales.angular_velocity);
    }
    for (k, (clearance, truth)) in sample.clearances.iter().zip(&truth.offsets).enumerate() {
        take(apart(clearance.offset[0], truth[0]), scales.clearances[k]);
        take(apart(clearance.offset[1], truth[1]), scales.clearances[k]);
    }
    let normals = sample.clearances.iter().zip(&truth.normals);
    let forces = normals.filter_map(|(clearance, normal)| {
        Some(apart(clearance.normal_force, (*normal)?) / scales.force)
    });
    [state, forces.fold(0.0, f64::max)]
}
