//! Certificates. Known in advance are 25 true digits of the paper's four-bar, `tests/data/truth`,
//! which no claim may exceed; and that whatever is certified must be what IDA finds as far as its
//! digits go, and what a third run in 71 digits finds, far tighter and with other steps.

mod simulated;

use freeplay::case::Case;
use freeplay::certify::{self, Certificate, Reference};
use freeplay::run::{Event, EventKind, Progress};
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
    let kinds = |events: &[Event]| -> Vec<(EventKind, usize)> {
        events.iter().map(|event| (event.kind, event.clearance)).collect()
    };
    assert_eq!(kinds(&trajectory.events), kinds(&finer.events), "{set:?}");
    let parting = certificate.parting;
    assert!(parting.is_none(), "{set:?}: {}", parting.map_or(0.0, |parting| parting.time()));
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
    assert!(whole.reference_holds_to_the_end(10.0));
    assert!(whole.words(names, 10.0, None).contains("to the end, 0.800 ms"));
    let mut early = whole.clone();
    early.reference.complete = false;
    early.reference.stopped = Some("the reference run stopped".into());
    assert!(!early.reference_holds_to_the_end(10.0));
    let words = early.words(names, 10.0, None);
    assert!(words.contains("until 0.800 ms; cannot certify beyond"), "{words}");
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
