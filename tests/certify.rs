//! Certificates of the paper's four-bar: known in advance are its trajectories with 25 true digits,
//! `tests/data/truth`, which no claim may exceed.

mod simulated;

use freeplay::case::Case;
use freeplay::certify::{self, Certificate, Reference};
use freeplay::run::Progress;
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
            assert!(apart < 0.5, "{name}: {growth:e} for {exact:e} at {time:e} s");
        }
        assert!(tangent.growth.last() > Some(&100.0), "errors grow in {name}");
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
