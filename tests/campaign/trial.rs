//! One mechanism on both engines at three tolerances, and what falls.

use super::generator::{Drawn, Friction};
use freeplay::case::{Case, Changes};
use freeplay::certify;
use freeplay::mechanism::Observation;
use freeplay::run::{Contact, Event, Peak, Progress, Recorder};
use freeplay::simulate::{Error, Simulation};
use nix::sys::resource::{UsageWho, getrusage};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::time::Duration;

pub const TOLERANCES: [f64; 3] = [1e-6, 1e-9, 1e-12];
const ENGINES: [&str; 2] = ["explicit", "ida"];
/// Steps of the explicit engine at 1e-9 that end a mechanism's time.
const MOST_STEPS: u64 = 3000;
/// A run is slow if it takes so many times what the explicit engine does at the same tolerance…
const SLOW: f64 = 100.0;
/// … and more than this (s of CPU).
const QUICK: f64 = 1.0;
/// CPU (s) that no run may take.
const TOO_LONG: f64 = 30.0;
/// Wall clock (s) after which a run that says nothing hangs, however busy the machine.
const HANGS: u64 = 600;
/// Penetration (m) that flight may have.
const IN_THE_WALL: f64 = 1e-12;
/// Distance, over the clearance, that a contact may be off the wall.
const IN_THE_AIR: f64 = 1e-6;
/// Digits up to which the engines are held to each other.
const DIGITS: f64 = 3.0;

/// What fell: its kind, and the words.
pub struct Fall {
    pub kind: &'static str,
    pub words: String,
    /// The keys that make the case that run.
    pub set: Vec<String>,
}

/// What came of a mechanism.
pub struct Verdict {
    pub falls: Vec<Fall>,
    pub runs: usize,
    pub contacts: usize,
    pub samples: usize,
    /// Contacts that the engines were held to each other by.
    pub compared: usize,
}

/// Watches a run: keeps its contacts, looks at each sample and lets it go.
struct Watch {
    frictions: Vec<Option<Friction>>,
    tolerance: f64,
    samples: usize,
    wall: Worst,
    air: Worst,
    slip: Worst,
    storm: Worst,
    contacts: Vec<Contact>,
    last_event: f64,
    energy: Energy,
}

/// The largest of something, and when (s).
#[derive(Clone, Copy, Default)]
struct Worst {
    size: f64,
    time: f64,
    count: usize,
}

impl Worst {
    fn take(&mut self, size: f64, time: f64) {
        self.count += 1;
        if size > self.size {
            (self.size, self.time) = (size, time);
        }
    }
}

/// Largest residual and energies (J).
#[derive(Clone, Copy, Default)]
struct Energy {
    residual: f64,
    scale: f64,
}

impl Recorder for Watch {
    type Error = Infallible;

    fn sample(&mut self, sample: &Observation) -> Result<(), Infallible> {
        self.samples += 1;
        let time = sample.time;
        let fastest = sample.bodies.iter().map(|body| body.velocity[0].hypot(body.velocity[1]));
        let fastest = fastest.fold(0.0, f64::max);
        for (clearance, friction) in sample.clearances.iter().zip(&self.frictions) {
            if !clearance.in_contact && clearance.penetration > IN_THE_WALL {
                self.wall.take(clearance.penetration, time);
            }
            let width = clearance.eccentricity - clearance.penetration;
            if clearance.in_contact && clearance.penetration < -IN_THE_AIR * width {
                self.air.take(-clearance.penetration / width, time);
            }
            let Some(law) = friction else { continue };
            let (normal, slip) = (clearance.normal_force, clearance.slip_velocity.abs());
            if normal > 0.0 {
                let width = law.v1 - law.v0;
                let share = ((slip - law.v0) / width).clamp(0.0, 1.0);
                let off =
                    (clearance.tangential_force.abs() / normal / law.coefficient - share).abs();
                // an edge lies a little lower on the way down, and slip is as good as the run
                let allowed = 1e-6 * law.v1 / width + 1e3 * self.tolerance * fastest / width;
                if off > allowed + 1e-6 {
                    self.slip.take(off, time);
                }
            }
        }
        let energy = &sample.energy;
        let sizes = [energy.kinetic, energy.elastic, energy.dissipated, energy.drive_work];
        self.energy.scale = sizes.iter().fold(self.energy.scale, |most, e| most.max(e.abs()));
        self.energy.residual = self.energy.residual.max(energy.residual.abs());
        Ok(())
    }

    fn event(&mut self, event: Event) -> Result<(), Infallible> {
        if event.time < self.last_event {
            self.storm.take(self.last_event - event.time, event.time);
        }
        self.last_event = event.time;
        Ok(())
    }

    fn contact(&mut self, contact: Contact) -> Result<(), Infallible> {
        if contact.end < contact.begin || contact.impact_rate < -1e-6 {
            self.storm.take(contact.impact_rate.abs(), contact.begin);
        }
        self.contacts.push(contact);
        Ok(())
    }

    fn peak(&mut self, _: Peak) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A run, as far as it came.
struct Ran {
    watch: Watch,
    /// How it ended.
    end: End,
    /// CPU (s).
    cpu: f64,
    /// Simulated time it came to (s).
    time: f64,
    /// Steps, as it last told of them.
    steps: u64,
}

enum End {
    Complete,
    /// By the limit of steps or of CPU.
    Cut,
    Failed(String),
}

/// A limit of a run.
#[derive(Clone, Copy)]
struct Limit {
    steps: u64,
    /// CPU (s).
    cpu: f64,
}

/// CPU (s) of this thread so far.
fn cpu() -> f64 {
    let usage = getrusage(UsageWho::RUSAGE_THREAD).expect("the usage of this thread");
    let seconds =
        |time: nix::sys::time::TimeVal| time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64;
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

fn case(drawn: &Drawn, set: &[String]) -> Result<Case, String> {
    let set = set.iter().map(|change| change.parse().expect("KEY=VALUE")).collect();
    let changes = Changes { set, ideal: false };
    Case::from_text(Path::new("drawn.toml"), &drawn.text, &changes).map_err(|e| words(&e))
}

/// Runs a case on a thread of its own; `None` if it hangs.
fn run(drawn: &Drawn, case: &Case, limit: Limit) -> Option<Ran> {
    let (send, receive) = mpsc::channel();
    let enough = Arc::new(AtomicBool::new(false));
    let (case, frictions, stop) = (case.clone(), drawn.frictions.clone(), enough.clone());
    let work = move || {
        let mut watch = Watch {
            frictions,
            tolerance: case.plan.solver.relative_tolerance,
            samples: 0,
            wall: Worst::default(),
            air: Worst::default(),
            slip: Worst::default(),
            storm: Worst::default(),
            contacts: Vec::new(),
            last_event: 0.0,
            energy: Energy::default(),
        };
        let (began, mut time, mut steps) = (cpu(), 0.0, 0);
        let mut look = |progress: &Progress| {
            (time, steps) = (progress.time, progress.steps);
            let over = progress.steps >= limit.steps || cpu() - began > limit.cpu;
            match over || stop.load(Ordering::Relaxed) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let end = match Simulation::new(&case) {
            Err(error) => End::Failed(words(&error)),
            Ok(simulation) => match simulation.run(&mut watch, &mut look).1 {
                Ok(()) => End::Complete,
                Err(Error::Interrupted { .. }) => End::Cut,
                Err(error) => End::Failed(words(&error)),
            },
        };
        let cpu = cpu() - began;
        // nobody waits any more where the run took too long
        let _ = send.send(Ran { watch, end, cpu, time, steps });
    };
    std::thread::spawn(work);
    let ran = receive.recv_timeout(Duration::from_secs(HANGS)).ok();
    enough.store(true, Ordering::Relaxed);
    ran
}

/// Tries a mechanism, with so many samples a run; `None` if it is no mechanism.
pub fn trial(drawn: &Drawn, samples: u64) -> Option<Verdict> {
    let first = keys("explicit", 1e-9, None, samples);
    Simulation::new(&case(drawn, &first).ok()?).ok()?;
    let mut verdict = Verdict { falls: Vec::new(), runs: 0, contacts: 0, samples: 0, compared: 0 };
    let duration = affordable(drawn, MOST_STEPS, &mut verdict)?;
    let mut followed = Vec::new();
    for tolerance in TOLERANCES {
        let mut pair = Vec::new();
        let mut quick = f64::INFINITY;
        for engine in ENGINES {
            let set = keys(engine, tolerance, Some(duration), samples);
            let case = case(drawn, &set).ok()?;
            let allowed = (SLOW * quick).clamp(QUICK, TOO_LONG);
            let ran = run(drawn, &case, Limit { steps: u64::MAX, cpu: allowed });
            let what = format!("{engine} at {tolerance:e}");
            if let Some(ran) = &ran {
                if engine == "explicit" {
                    quick = ran.cpu;
                }
                judge(&mut verdict, ran, &what, tolerance, &set, quick);
            } else {
                verdict.fall("hangs", format!("{what}: it said nothing for {HANGS} s"), &set);
            }
            verdict.runs += 1;
            pair.extend(ran);
        }
        followed.push((tolerance, pair));
    }
    compare_engines(drawn, &followed, duration, &mut verdict);
    Some(verdict)
}

/// The text of a case that takes the explicit engine at 1e-9 so many steps at most; `None` if it is
/// no mechanism.
pub fn short(drawn: &Drawn, steps: u64) -> Option<String> {
    let mut verdict = Verdict { falls: Vec::new(), runs: 0, contacts: 0, samples: 0, compared: 0 };
    let duration = affordable(drawn, steps, &mut verdict)?;
    let set: Vec<String> = keys("ida", 1e-12, Some(duration), 100);
    Some(case(drawn, &set).ok()?.text)
}

/// The time (s) that a mechanism is followed for: what the explicit engine at 1e-9 does in a number
/// of steps.
fn affordable(drawn: &Drawn, steps: u64, verdict: &mut Verdict) -> Option<f64> {
    let set = keys("explicit", 1e-9, None, 2);
    let case = case(drawn, &set).ok()?;
    let all = case.plan.duration.to_f64();
    let ran = run(drawn, &case, Limit { steps, cpu: QUICK });
    let Some(ran) = ran else {
        verdict.fall("hangs", format!("explicit at 1e-9: it said nothing for {HANGS} s"), &set);
        return Some(all);
    };
    match ran.end {
        End::Cut if ran.time > 0.0 => Some(0.98 * ran.time),
        // a failure will be seen again, and be told then
        _ => Some(all),
    }
}

fn keys(engine: &str, tolerance: f64, duration: Option<f64>, samples: u64) -> Vec<String> {
    let mut set =
        vec![format!("solver.engine={engine}"), format!("solver.relative_tolerance={tolerance:e}")];
    if let Some(duration) = duration {
        // no more digits than a reader copies
        let duration: f64 = format!("{duration:.4e}").parse().expect("a number");
        let interval = (duration / samples as f64).max(1e-7).min(duration);
        set.push(format!("run.duration={duration:e}"));
        set.push(format!("run.sample_interval={interval:.4e}"));
    }
    set
}

impl Verdict {
    fn fall(&mut self, kind: &'static str, words: String, set: &[String]) {
        self.falls.push(Fall { kind, words, set: set.to_vec() });
    }
}

/// What a single run says of itself.
fn judge(verdict: &mut Verdict, ran: &Ran, what: &str, tolerance: f64, set: &[String], quick: f64) {
    let watch = &ran.watch;
    verdict.contacts += watch.contacts.len();
    verdict.samples += watch.samples;
    if watch.wall.count > 0 {
        let Worst { size, time, count } = watch.wall;
        verdict.fall(
            "in the wall",
            format!("{what}: {count} samples in flight, {size:e} m deep at {time:e} s"),
            set,
        );
    }
    if watch.air.count > 0 {
        let Worst { size, time, count } = watch.air;
        verdict.fall(
            "contact in the air",
            format!("{what}: {count} samples in contact, {size:e} of c off the wall at {time:e} s"),
            set,
        );
    }
    if watch.storm.count > 0 {
        let Worst { size, time, count } = watch.storm;
        verdict.fall(
            "time or rate back",
            format!("{what}: {count} events or contacts go back, by {size:e} at {time:e} s"),
            set,
        );
    }
    if watch.slip.count > 0 {
        let Worst { size, time, count } = watch.slip;
        verdict.fall(
            "friction off its law",
            format!("{what}: {count} samples, by {size:e} of its coefficient at {time:e} s"),
            set,
        );
    }
    let Energy { residual, scale } = watch.energy;
    // each step may be off by the tolerance
    let allowed = f64::max(1e-6, ran.steps as f64 * tolerance);
    if residual > allowed * scale {
        let kind = match tolerance {
            1e-12 => "energy at 1e-12",
            1e-9 => "energy at 1e-9",
            _ => "energy at 1e-6",
        };
        verdict.fall(kind, format!("{what}: residual {residual:e} of {scale:e} J"), set);
    }
    match &ran.end {
        End::Complete => {}
        // a bearing too soft for what it carries is refused, and rightly so
        End::Failed(words) if words.contains("(maximum_penetration)") => {
            verdict.fall("too deep", format!("{what}: {words}"), set)
        }
        End::Failed(words) => verdict.fall("fails", format!("{what}: {words}"), set),
        End::Cut => {
            let words = format!(
                "{what}: cut after {:.1} s of CPU at {:e} s; explicit took {quick:.3} s",
                ran.cpu, ran.time
            );
            verdict.fall("slow", words, set);
        }
    }
}

/// How far errors have grown along a mechanism: times (s) and what a start off by one, scaled, has
/// become at most, from wherever it was smallest.
struct Growth {
    times: Vec<f64>,
    most: Vec<f64>,
}

impl Growth {
    fn of(drawn: &Drawn, duration: f64) -> Option<Growth> {
        let case = case(drawn, &keys("explicit", 1e-12, Some(duration), 1000)).ok()?;
        let (send, receive) = mpsc::channel();
        std::thread::spawn(move || {
            let Ok(simulation) = Simulation::new(&case) else { return };
            let began = cpu();
            let mut watch = |_: &Progress| match cpu() - began > TOO_LONG {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let _ = send.send(certify::tangent(&case, simulation.schedule(), &mut watch).ok());
        });
        let tangent = receive.recv_timeout(Duration::from_secs(HANGS)).ok()??;
        let (mut least, mut most) = (1.0_f64, 1.0_f64);
        let grown = tangent.growth.iter().map(|growth| {
            least = least.min(*growth);
            most = most.max(growth / least);
            most * tangent.at_start.max(1.0)
        });
        Some(Growth { most: grown.collect(), times: tangent.times })
    }

    /// Scaled error at a time (s) of a run at a tolerance.
    fn error(&self, time: f64, tolerance: f64) -> f64 {
        let place = self.times.partition_point(|t| *t < time);
        let most = self.most.get(place).or(self.most.last()).copied().unwrap_or(f64::INFINITY);
        100.0 * tolerance * most
    }
}

/// Contacts that one engine has and the other has not, while both have digits.
fn compare_engines(
    drawn: &Drawn,
    followed: &[(f64, Vec<Ran>)],
    duration: f64,
    verdict: &mut Verdict,
) {
    let Some(growth) = Growth::of(drawn, duration) else { return };
    let widths: Vec<f64> = {
        let Ok(case) = case(drawn, &keys("explicit", 1e-12, None, 2)) else { return };
        let Ok(simulation) = Simulation::new(&case) else { return };
        simulation.mechanism().model().clearances().iter().map(|c| c.radial).collect()
    };
    for (tolerance, pair) in followed {
        let [a, b] = &pair[..] else { continue };
        let until = [a, b].map(|ran| match ran.end {
            End::Complete => f64::INFINITY,
            _ => ran.time,
        });
        let until = until[0].min(until[1]);
        for (ours, theirs, has, lacks) in [(a, b, 0, 1), (b, a, 1, 0)] {
            let (fell, compared) =
                unmatched(&ours.watch.contacts, &theirs.watch.contacts, &widths, |time| {
                    let error = growth.error(time, *tolerance);
                    (time < until && error < 10f64.powf(-DIGITS)).then_some(error)
                });
            verdict.compared += compared;
            if let Some((contact, error)) = fell {
                let words = format!(
                    "at {tolerance:e}: {} has a contact of clearance {} at {:e} s, {:e} m deep, \
                     and {} has not; scaled errors are about {error:.0e}",
                    ENGINES[has],
                    contact.clearance,
                    contact.begin,
                    contact.peak_penetration,
                    ENGINES[lacks]
                );
                let set = keys(ENGINES[lacks], *tolerance, Some(duration), 2000);
                verdict.fall("contact of one engine", words, &set);
            }
        }
    }
}

/// The first contact that has no counterpart, with the error there, and how many were held to one.
/// A counterpart is in contact for half the time, give or take what the error moves a wall by; a
/// contact shallower than the error need have none.
fn unmatched(
    ours: &[Contact],
    theirs: &[Contact],
    widths: &[f64],
    error: impl Fn(f64) -> Option<f64>,
) -> (Option<(Contact, f64)>, usize) {
    let mut compared = 0;
    for contact in ours {
        let end = if contact.end.is_nan() { f64::INFINITY } else { contact.end };
        let (Some(at_begin), Some(at_peak)) = (error(contact.begin), error(contact.peak_time))
        else {
            break;
        };
        let off = 10.0 * at_begin.max(at_peak) * widths[contact.clearance];
        if contact.peak_penetration <= off || error(end.min(1e9)).is_none() && end.is_finite() {
            continue;
        }
        compared += 1;
        let late = off / contact.impact_rate.abs().max(1e-9);
        let same = theirs.iter().filter(|other| other.clearance == contact.clearance);
        let covered: f64 = same
            .map(|other| {
                let other_end = if other.end.is_nan() { f64::INFINITY } else { other.end };
                (end.min(other_end + late) - contact.begin.max(other.begin - late)).max(0.0)
            })
            .sum();
        if end.is_finite() && covered < 0.5 * (end - contact.begin) || covered == 0.0 {
            return (Some((*contact, at_peak)), compared);
        }
    }
    (None, compared)
}
