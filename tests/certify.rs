//! Certificates. Known in advance are 25 true digits of the paper's four-bar, `tests/data/truth`,
//! which no claim may exceed; and that whatever is certified must be what IDA finds as far as its
//! digits go, and what a third run in 71 digits finds, far tighter and with other steps.

mod compared;
mod simulated;

use compared::{Outcome, Trial};
use freeplay::case::Case;
use freeplay::certify::{self, Certificate, Reference, Told};
use freeplay::model::Owner;
use freeplay::run::{Event, EventKind, Peak, Progress};
use freeplay::simulate::Simulation;
use simulated::truth::{Table, digits, scaled, scaled_truth};
use simulated::{case, told};
use std::ops::ControlFlow;

/// Certificates measure velocities by the largest of the run, the tables by one that is fixed:
/// that moves a digit by less than this.
const SLACK: f64 = 0.15;

fn reference(case: &Case) -> Reference {
    let simulation = told(Simulation::new(case));
    told(certify::reference(case, simulation.schedule(), 10.0, &|_| ControlFlow::Continue(())))
}

fn certified(case: &Case, reference: Reference) -> Certificate {
    let mut go_on = |_: &Progress| ControlFlow::Continue(());
    told(certify::certify(told(Simulation::new(case)), reference, &mut go_on))
}

/// Whether no sample of a certificate claims more than a truth table allows.
fn assert_within_truth(name: &str, certificate: &Certificate, clearances: &[&str]) {
    let table = Table::read(name);
    let samples = &certificate.reference.trajectory.samples;
    for (claim, sample) in certificate.claims.iter().zip(samples) {
        let truth = scaled_truth(table.at(sample.time), clearances);
        let true_digits = digits(&scaled(sample), &truth);
        let (time, claimed) = (sample.time, claim.reference.state);
        assert!(claimed >= 13.0, "{name}: only {claimed:.1} digits certified at {time:e} s");
        assert!(claimed <= true_digits + SLACK, "{name}: {claimed} of {true_digits} at {time:e}");
    }
}

#[test]
fn no_claim_exceeds_the_truth() {
    for (name, duration, clearances) in [
        ("four-bar-a", "run.duration=0.006", &["A"][..]),
        ("four-bar-b", "run.duration=0.001", &["A", "B"]),
        ("four-bar-c", "run.duration=0.001", &["A", "B", "B0"]),
    ] {
        let case = case(&format!("cases/{name}.toml"), &[duration, "run.sample_interval=1e-4"]);
        let certificate = certified(&case, reference(&case));
        assert_within_truth(name, &certificate, clearances);
        let run = simulated::simulate(&case);
        let table = Table::read(name);
        for (claim, sample) in certificate.claims.iter().zip(&run.samples) {
            let truth = scaled_truth(table.at(sample.time), clearances);
            let true_digits = digits(&scaled(sample), &truth);
            assert!(claim.run.state <= true_digits + SLACK, "{name} at {:e} s", sample.time);
            assert!(
                claim.run.state >= true_digits.min(14.0) - 1.0,
                "{name} at {:e} s",
                sample.time
            );
        }
        assert!(certificate.parting.is_none());
        assert!(certificate.events.iter().all(|event| event.late.is_some()));
    }
}

/// Whether every claim of a certificate is confirmed by a run in 71 digits at a far tighter
/// tolerance with steps that are kept short, and by the events of a run of IDA.
fn assert_confirmed(path: &str, duration: &str, set: &[&str]) {
    let duration = format!("run.duration={duration}");
    let set = [&[duration.as_str(), "run.sample_interval=1e-4"], set].concat();
    let in_doubles = case(path, &[&set[..], &["solver.relative_tolerance=1e-13"]].concat());
    let certificate = certified(&in_doubles, reference(&in_doubles));
    let finer = [
        "solver.engine=explicit",
        "solver.precision=71",
        "solver.reference_tolerance=1e-42",
        "solver.max_step=3e-5",
    ];
    let finer = simulated::simulate(&case(path, &[&set[..], &finer].concat()));
    let Reference { trajectory, scales, complete, .. } = &certificate.reference;
    assert!(complete, "{set:?}");
    for ((claim, sample), same) in
        certificate.claims.iter().zip(&trajectory.samples).zip(&finer.samples)
    {
        let off = scales.differences(sample, same).state;
        let (time, claimed) = (sample.time, claim.reference.state);
        assert!(claimed > 12.0, "{set:?}: only {claimed:.1} digits at {time:e} s");
        assert!(off <= 10f64.powf(-claimed), "{set:?}: {claimed:.1} digits, off by {off:e}");
    }
    let kinds = |events: &[Event]| -> Vec<(EventKind, Owner)> {
        events.iter().map(|event| (event.kind, event.owner)).collect()
    };
    assert_eq!(kinds(&trajectory.events), kinds(&finer.events), "{set:?}");
    let parting = certificate.parting;
    assert!(parting.is_none(), "{set:?}: {}", parting.map_or(0.0, |parting| parting.event.time));
    assert!(!trajectory.events.is_empty(), "{set:?}: nothing happens");
}

const FRICTION: &str = "cases/four-bar-a-friction.toml";
const JOURNAL: &str = "cases/journal-in-bearing.toml";

/// Two runs that miss the same event agree: the edges of friction follow one another within a
/// single step of high order.
#[test]
fn no_edge_of_friction_is_missed() {
    assert_confirmed(FRICTION, "0.0012", &[]);
    let friction = |coefficient: &str, v0: &str, v1: &str| {
        format!(
            "joints.A.clearance.friction={{ law = \"ambrosio\", coefficient = {coefficient}, \
             v0 = {v0}, v1 = {v1} }}"
        )
    };
    assert_confirmed(FRICTION, "0.0016", &[&friction("0.3", "0.0", "0.01")]);
    assert_confirmed(FRICTION, "0.0016", &[&friction("0.05", "0.009", "0.01")]);
    let bristles =
        "joints.A.clearance.friction={ law = \"dahl\", coefficient = 0.1, stiffness = 1e4 }";
    assert_confirmed(FRICTION, "0.0016", &[bristles]);
    let soft = "joints.A.clearance.normal={ law = \"lankarani-nikravesh\", restitution = 0.1, \
                stiffness = \"hertz-printed\", young = 207e9, poisson = 0.3 }";
    assert_confirmed(FRICTION, "0.0025", &[soft, "joints.A.clearance.tension=cut"]);
}

/// Whole exponents, a multiple of a tenth, and one that is four thirds to doubles only.
#[test]
fn no_exponent_is_certified_beyond_what_is_true() {
    for (exponent, stiffness) in
        [("1", "1e7"), ("2", "1e12"), ("1.3", "1e9"), ("1.3333333333333333", "2e9")]
    {
        let normal = format!(
            "joints.A.clearance.normal={{ law = \"lankarani-nikravesh\", restitution = 0.9, \
             stiffness = {stiffness}, exponent = {exponent} }}"
        );
        assert_confirmed("cases/four-bar-a.toml", "0.0011", &[&normal]);
    }
}

#[test]
fn a_journal_that_rests_on_its_bearing_or_glides_along_it_at_first_is_certified_in_contact() {
    let normal = "joints.O.clearance.normal={ law = \"lankarani-nikravesh\", restitution = 0.9, \
                  stiffness = 1e8 }";
    let gravity = "loads.gravity={ kind = \"gravity\", acceleration = [0.0, -9.81] }";
    for start in ["velocity_x = 0.0", "velocity_x = 0.2"] {
        let start = format!(
            "start.journal={{ x = 0.0, y = -0.001, angle = 0.0, {start}, velocity_y = 0.0, \
             angular_velocity = 0.0, fixed = true }}"
        );
        assert_confirmed(JOURNAL, "0.002", &[normal, gravity, &start]);
    }
}

#[test]
fn a_reference_that_ends_early_is_never_said_to_hold_to_the_end() {
    let case = case(FRICTION, &["run.duration=0.0008", "run.sample_interval=1e-4"]);
    let whole = certified(&case, reference(&case));
    let simulation = told(Simulation::new(&case));
    let names = simulation.mechanism().model().names();
    let told = Told { case: "a", case_sha256: "0", names, digits: 10.0, revolution: None };
    assert!(whole.reference_holds_to_the_end(10.0));
    assert!(whole.words(&told).contains("to the end, 0.800 ms"));
    let mut early = whole.clone();
    early.reference.complete = false;
    early.reference.stopped = Some("the reference run stopped".into());
    assert!(!early.reference_holds_to_the_end(10.0));
    let words = early.words(&told);
    assert!(
        words.contains("until 0.800 ms, of 0.800 ms asked for; cannot certify beyond"),
        "{words}"
    );
    assert!(words.contains("the reference run stopped"), "{words}");
}

#[test]
fn the_tangent_grows_as_a_changed_start_does() {
    let set = ["run.duration=0.006", "run.sample_interval=1e-4"];
    for name in ["four-bar-a", "four-bar-c"] {
        let case = case(&format!("cases/{name}.toml"), &set);
        let exact = reference(&case).growth.factors;
        let simulation = told(Simulation::new(&case));
        let mut go_on = |_: &Progress| ControlFlow::Continue(());
        let tangent = told(certify::tangent(&case, simulation.schedule(), &mut go_on));
        assert_eq!(tangent.growth.len(), exact.len());
        for ((growth, exact), time) in tangent.growth.iter().zip(&exact).zip(&tangent.times) {
            let apart = (growth / exact).log10().abs();
            assert!(apart < 0.01, "{name}: {growth:e} for {exact:e} at {time:e} s");
        }
        assert_eq!([tangent.growth[0], exact[0]], [1.0; 2], "errors grow from one");
        let most = tangent.growth.iter().copied().fold(0.0, f64::max);
        assert!(most > 10.0, "errors grow in {name}");
    }
}

#[test]
fn a_coarser_run_has_fewer_digits() {
    let set = ["run.duration=0.002", "run.sample_interval=1e-4"];
    let fine = case("cases/four-bar-c.toml", &set);
    let coarse =
        case("cases/four-bar-c.toml", &[&set[..], &["solver.relative_tolerance=1e-8"]].concat());
    let reference = reference(&fine);
    let digits = |case: &Case| {
        let certificate = certified(case, reference.clone());
        certificate.claims.iter().map(|claim| claim.run.state).fold(f64::INFINITY, f64::min)
    };
    let (fine, coarse) = (digits(&fine), digits(&coarse));
    assert!(fine > coarse + 2.0, "{fine:.1} and {coarse:.1} digits");
}

/// A certified reference of case a until 1.2 ms, with a sample every 0.1 ms: one contact begins in it
/// at 0.48 ms, and 9 events come until 2.1 ms.
fn certified_reference(trial: &Trial) -> Vec<String> {
    let file = trial.path("reference.h5").display().to_string();
    let interval = ["--set", "run.sample_interval=1e-4"];
    let made =
        trial.certify("four-bar-a", &[&["--until", "0.0012", "-o", &file], &interval[..]].concat());
    assert_eq!(made.code, 0, "{}", made.err);
    vec!["--reference".to_owned(), file]
}

fn against(trial: &Trial, reference: &[String], more: &[&str]) -> Outcome {
    let reference: Vec<&str> = reference.iter().map(String::as_str).collect();
    trial.certify("four-bar-a", &[&reference[..], more].concat())
}

#[test]
fn a_stored_reference_is_held_to_the_end_that_is_asked_for() {
    let trial = Trial::new();
    let reference = certified_reference(&trial);
    let whole = against(&trial, &reference, &["--until", "0.0012", "--digits", "10"]);
    assert_eq!(whole.code, 0, "{}", whole.err);
    assert!(whole.out.contains("digits of the state to the end, 1.200 ms"), "{}", whole.out);
    let longer = against(&trial, &reference, &["--until", "0.0018", "--digits", "10"]);
    assert_eq!(longer.code, 1, "{}", longer.out);
    assert!(longer.out.contains("until 1.200 ms, of 1.800 ms asked for"), "{}", longer.out);
    assert!(longer.err.contains("until 0.0018 s, only until 0.0012 s"), "{}", longer.err);
    let shorter = against(&trial, &reference, &["--until", "0.0006", "--digits", "10"]);
    assert_eq!(shorter.code, 0, "{}", shorter.err);
    assert!(shorter.out.contains("to the end, 0.600 ms"), "{}", shorter.out);
    assert!(shorter.out.contains("the run has 1 of 1"), "{}", shorter.out);
    assert!(shorter.out.contains("parting      none"), "{}", shorter.out);
    let nothing = against(&trial, &reference, &["--until", "0.00035", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&nothing.out).unwrap();
    assert_eq!(json["events"]["of"], 0);
    assert_eq!(json["times"].as_array().unwrap().len(), 4);
    assert!(json["sentence"].as_str().unwrap().contains(json["case_sha256"].as_str().unwrap()));
}

#[test]
fn a_run_with_other_sample_times_is_held_against_a_reference_at_its_own() {
    let trial = Trial::new();
    let reference = certified_reference(&trial);
    let json = |set: &[&str]| -> serde_json::Value {
        let arguments = [&["--until", "0.0012", "--json"], set].concat();
        let outcome = against(&trial, &reference, &arguments);
        serde_json::from_str(&outcome.out).unwrap_or_else(|_| panic!("{}", outcome.err))
    };
    let same = json(&["--set", "run.sample_interval=1e-4"]);
    let other = json(&["--set", "run.sample_interval=3e-5"]);
    assert_eq!(same["run_digits"], other["run_digits"]);
    assert_eq!(other["run_holds"][1]["until"], 0.0012);
}

#[test]
fn a_stored_reference_serves_the_same_numbers_however_they_are_written_and_no_others() {
    let trial = Trial::new();
    let reference = certified_reference(&trial);
    let speed = |speed: &str| {
        let set = format!("drives.crank.speed_rpm={speed}");
        against(&trial, &reference, &["--until", "0.0012", "--digits", "10", "--set", &set])
    };
    for same in ["5e3", "5_000", "5000.0"] {
        assert_eq!(speed(same).code, 0, "{}", speed(same).err);
    }
    let other = speed("5000.00000000000000001");
    assert_eq!(other.code, 2);
    assert!(other.err.contains("[drives] differs"), "{}", other.err);
}

#[test]
fn a_stored_reference_that_was_changed_or_is_not_sealed_is_refused() {
    let trial = Trial::new();
    let reference = certified_reference(&trial);
    let file = trial.path("reference.h5");
    let refused = |word: &str| {
        let outcome = against(&trial, &reference, &["--until", "0.0012"]);
        assert_eq!(outcome.code, 2, "{}", outcome.out);
        assert!(outcome.err.contains(word), "{}", outcome.err);
    };
    for (dataset, row) in [("velocity_x", 7), ("event_time", 0), ("reference_digits", 3)] {
        let mut old = 0.0;
        compared::change(&file, dataset, |values| old = std::mem::replace(&mut values[row], 1.5));
        refused("was changed after it was certified");
        compared::change(&file, dataset, |values| values[row] = old);
    }
    assert_eq!(against(&trial, &reference, &["--until", "0.0012"]).code, 0);
    compared::add_attribute(&file, "scale_position", 1.0);
    refused("was changed after it was certified");
    compared::remove_attribute(&file, "certificate_sha256");
    refused("is not sealed");
}

#[test]
fn scales_of_what_is_zero_are_no_rounding() {
    let case = case("cases/four-bar-a.toml", &["run.duration=0.0004", "run.sample_interval=1e-4"]);
    let certificate = certified(&case, reference(&case));
    let scales = &certificate.reference.scales;
    // in flight there is no torque but that of rounding; 0.42 kg, 0.09 m, 523.6/s
    assert!(scales.torque > 0.1 && scales.torque < 10.0, "{}", scales.torque);
    for claim in &certificate.claims {
        assert!(claim.run.torque > 10.0 && claim.run.forces > 8.0, "{claim:?}");
    }
}

#[test]
fn doubles_follow_a_pendulum_that_hangs_at_rest() {
    let set = [
        "start.rod={ angle = -1.5707963267948966, angular_velocity = 0.0, fixed = true }",
        "run.duration=0.5",
        "run.sample_interval=0.05",
    ];
    let case = case("cases/pendulum.toml", &set);
    let certificate = certified(&case, reference(&case));
    assert_eq!(certificate.reference.growth.double_precision_ends, None);
    for claim in &certificate.claims {
        assert!(claim.run.state > 10.0, "{claim:?}");
    }
}

/// Largest relative difference of forces of peaks that two runs have, one to one.
fn assert_same_peaks(run: &[Peak], other: &[Peak], relative: f64) {
    assert_eq!(run.len(), other.len());
    for (a, b) in run.iter().zip(other) {
        assert_eq!(a.clearance, b.clearance);
        assert!((a.force / b.force - 1.0).abs() < relative, "{a:?} and {b:?}");
        assert!((a.time - b.time).abs() < 1e-9, "{a:?} and {b:?}");
    }
}

/// Steps in many digits are longer than contacts swing: each has several maxima.
#[test]
fn a_reference_has_every_peak_that_a_run_with_short_steps_has() {
    let set = |more: &[&'static str]| {
        [&["run.duration=0.0078", "run.sample_interval=1e-3"], more].concat()
    };
    let short = ["solver.relative_tolerance=1e-13", "solver.max_step=1e-6"];
    let ida = simulated::simulate(&case("cases/four-bar-a.toml", &set(&short)));
    let digits =
        ["solver.engine=explicit", "solver.precision=71", "solver.reference_tolerance=1e-29"];
    let long = simulated::simulate(&case("cases/four-bar-a.toml", &set(&digits)));
    assert_same_peaks(&long.peaks, &ida.peaks, 1e-6);
    let missed = long.peaks.iter().find(|peak| (peak.time - 7.519489024e-3).abs() < 1e-11);
    assert!((missed.unwrap().force - 841.287).abs() < 1e-3, "{missed:?}");
}

/// At a loose tolerance a contact is a single step; nothing is known of its force but inside.
#[test]
fn a_contact_of_one_step_has_its_largest_force() {
    let set = [
        "run.duration=0.0263",
        "run.sample_interval=1e-6",
        "solver.engine=explicit",
        "solver.relative_tolerance=1e-4",
    ];
    let run = simulated::simulate(&case("cases/four-bar-a.toml", &set));
    assert!(run.contacts.len() > 10);
    for contact in &run.contacts {
        let within = |time: f64| time >= contact.begin && !(time > contact.end);
        let seen = run.samples.iter().filter(|sample| within(sample.time));
        let seen = seen.map(|s| s.clearances[contact.clearance].normal_force).fold(0.0, f64::max);
        assert!(contact.peak_force >= seen * (1.0 - 1e-3), "{contact:?}: a sample has {seen} N");
    }
}

#[test]
fn an_open_contact_has_its_largest_force_so_far() {
    // the first contact of case a begins at 0.4798 ms
    let run = simulated::simulate(&case(
        "cases/four-bar-a.toml",
        &["run.duration=0.000495", "run.sample_interval=5e-6"],
    ));
    let [contact] = &run.contacts[..] else { panic!("{:?}", run.contacts) };
    let force = run.last().clearances[0].normal_force;
    assert!(contact.end.is_nan() && force > 100.0);
    assert!(contact.peak_force >= force * (1.0 - 1e-9), "{contact:?} and {force} N at the end");
}

#[test]
fn the_other_engine_confirms_the_contacts_of_the_paper() {
    for name in ["four-bar-a", "four-bar-b", "four-bar-c", "four-bar-a-friction"] {
        let case = case(&format!("cases/{name}.toml"), &["run.duration=0.006"]);
        let check =
            told(certify::cross_check(&case, &mut |_: &Progress| ControlFlow::Continue(())));
        assert_eq!((&check.disagreement, &check.stopped), (&None, &None), "{name}");
        assert_eq!(check.until, 0.006, "{name}");
        assert!(check.events > 5 && check.farthest < 1e-7, "{name}: {check:?}");
    }
}

#[test]
fn a_run_is_checked_by_the_other_engine_where_asked() {
    let trial = Trial::new();
    let checked = trial.checked("four-bar-c", &["run.duration=0.003"]);
    assert_eq!(checked.code, 0, "{}", checked.err);
    assert!(checked.out.contains("ida and explicit have the same"), "{}", checked.out);
}
