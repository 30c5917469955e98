//! The explicit engine on the paper's mechanisms: known in advance are their trajectories with 25
//! true digits, tests/data/truth, and that two runs in 71 digits, one tighter than the other, tell
//! the error of the looser one.

mod simulated;

use freeplay::clearance::{EventSlot, Mode};
use freeplay::dae::{Advance, Engine, Snapshot, System};
use freeplay::engine::explicit::{Explicit, Options};
use freeplay::mechanism::Mechanism;
use freeplay::model::Model;
use freeplay::scalar::{F256, Scalar};
use simulated::truth::{Table, digits, scaled, scaled_truth};
use simulated::{case, root, simulate};
use std::collections::HashMap;

const IN_DOUBLES: [&str; 2] = ["solver.engine=\"explicit\"", "solver.relative_tolerance=1e-14"];
const IN_71_DIGITS: [&str; 3] =
    ["solver.engine=\"explicit\"", "solver.precision=71", "solver.reference_tolerance=1e-36"];

/// From one tolerance to the next the digits at a time differ by half a one, as chance has it.
#[test]
fn doubles_keep_their_digits_in_case_a() {
    let set = ["run.duration=0.024", "run.sample_interval=1e-4"];
    let kept = simulate(&case("cases/four-bar-a.toml", &[&IN_DOUBLES[..], &set].concat()));
    let truth = Table::read("four-bar-a");
    for (time, least) in [(1e-3, 12.5), (2e-3, 11.5), (5e-3, 12.0), (12e-3, 10.3), (24e-3, 10.0)] {
        let found = digits(&scaled(kept.at(time)), &scaled_truth(truth.at(time), &["A"]));
        assert!(found >= least, "{found:.1} digits at {time:e} s");
    }
}

/// Digits of a run in doubles at some times, against one in 71 digits.
fn check_against_71_digits(name: &str, until: &str, least: &[(f64, f64)]) {
    let path = format!("cases/{name}.toml");
    let until = format!("run.duration={until}");
    let set = [until.as_str(), "run.sample_interval=1e-3"];
    let run = simulate(&case(&path, &[&IN_DOUBLES[..], &set].concat()));
    let reference = simulate(&case(&path, &[&IN_71_DIGITS[..], &set].concat()));
    for (time, least) in least {
        let found = digits(&scaled(run.at(*time)), &scaled(reference.at(*time)));
        assert!(found >= *least, "{name}: {found:.1} digits at {time:e} s");
    }
}

#[test]
fn doubles_keep_their_digits_in_case_b() {
    let least = [(1e-3, 12.5), (2e-3, 12.2), (5e-3, 9.3), (12e-3, 7.5), (24e-3, 5.4)];
    check_against_71_digits("four-bar-b", "0.024", &least);
}

#[test]
fn doubles_keep_their_digits_in_case_c() {
    let least = [(1e-3, 12.8), (2e-3, 11.8), (5e-3, 10.0), (12e-3, 6.4)];
    check_against_71_digits("four-bar-c", "0.012", &least);
}

/// Switches the modes of what fired, as a run does.
fn switch(engine: &mut Explicit<F256, Mechanism<F256>>) {
    let mut now = engine.now().clone();
    let fired = engine.fired().to_vec();
    let system = engine.system();
    system.project(now.time, &mut now.q, &mut now.v).unwrap();
    system.evaluate(now.state()).unwrap();
    for slot in (0..fired.len()).filter(|slot| fired[*slot]) {
        let Some((clearance, what)) = system.slot(slot) else { continue };
        if system.modes()[clearance] != Mode::Flight || what == EventSlot::Depth {
            system.switch(slot);
        }
    }
    engine.restart(&now).unwrap();
}

/// State, penetration (m) and normal force (N) of case a at every millisecond.
fn case_a(tolerance: f64, milliseconds: i64) -> Vec<(Snapshot<F256>, [F256; 2])> {
    let description = &case("cases/four-bar-a.toml", &[]).description;
    let mechanism = Mechanism::new(Model::new(description).unwrap()).unwrap();
    let mut at = mechanism.start().clone();
    let options = Options { tolerance, ..Options::default() };
    let mut engine = Explicit::new(mechanism, options).unwrap();
    engine.restart(&at).unwrap();
    let end = F256::ratio(milliseconds, 1000);
    let mut samples = Vec::new();
    while engine.now().time < end {
        let advance = engine.step(end).unwrap();
        loop {
            let time = F256::ratio(samples.len() as i64 + 1, 1000);
            if time > engine.now().time || time > end {
                break;
            }
            engine.within(time, &mut at).unwrap();
            let system = engine.system();
            system.project(time, &mut at.q, &mut at.v).unwrap();
            system.evaluate(at.state()).unwrap();
            let contact = system.contact_rates(0);
            let touch = contact.map_or([F256::ZERO; 2], |rates| [rates.depth, rates.force]);
            samples.push((at.clone(), touch));
        }
        if advance == Advance::Event {
            switch(&mut engine);
        }
    }
    samples
}

/// The named quantities of a sample of case a; the clearance vector from the geometry of the
/// paper.
fn quantities((at, [depth, force]): &(Snapshot<F256>, [F256; 2])) -> Vec<(&'static str, F256)> {
    let number = |literal: &str| F256::parse(literal).unwrap();
    let (q, v) = (&at.q, &at.v);
    let speed = number("5000") * F256::pi() / number("30");
    let (crank_sin, crank_cos) = Scalar::sin_cos(speed * at.time);
    let (sin, cos) = Scalar::sin_cos(q[2]);
    let (crank, half) = (number("0.03"), number("0.09"));
    let mut named = vec![
        ("coupler_x", q[0]),
        ("coupler_y", q[1]),
        ("coupler_angle", q[2]),
        ("follower_x", q[3]),
        ("follower_y", q[4]),
        ("follower_angle", q[5]),
        ("coupler_vx", v[0]),
        ("coupler_vy", v[1]),
        ("coupler_omega", v[2]),
        ("follower_vx", v[3]),
        ("follower_vy", v[4]),
        ("follower_omega", v[5]),
        ("A_clearance_x", q[0] - half * cos - crank * crank_cos),
        ("A_clearance_y", q[1] - half * sin - crank * crank_sin),
        ("A_normal_force", *force),
    ];
    if *depth > F256::ZERO {
        named.push(("A_penetration", *depth));
    }
    named
}

/// Half a unit of the last digit of a number as printed, with a little to spare for what the
/// number itself was rounded by.
fn half_of_last_digit(printed: &str) -> f64 {
    let (digits, power) = printed.split_once('e').unwrap_or((printed, "0"));
    let after_point = digits.split_once('.').map_or(0, |(_, after)| after.len());
    0.5001 * 10f64.powi(power.parse::<i32>().unwrap() - after_point as i32)
}

#[test]
fn in_71_digits_case_a_shows_every_printed_digit_and_forty_of_its_own() {
    let loose = std::thread::spawn(|| case_a(1e-50, 12));
    let tight = case_a(1e-60, 24);
    let loose = loose.join().unwrap();

    let text = std::fs::read_to_string(root().join("tests/data/truth/four-bar-a.csv")).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = lines.next().unwrap();
    let rows: Vec<HashMap<&str, &str>> =
        lines.map(|words| names.iter().copied().zip(words).collect()).collect();
    for (k, sample) in tight.iter().enumerate() {
        let row = &rows[10 * (k + 1)];
        for (name, value) in quantities(sample) {
            let off = (value - F256::parse(row[name]).unwrap()).abs().to_f64();
            assert!(off <= half_of_last_digit(row[name]), "{name} at {} ms: {off:e}", k + 1);
        }
    }

    let scales = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 15.7, 15.7, 523.6, 15.7, 15.7, 523.6, 1e-3, 1e-3];
    for (k, (a, b)) in loose.iter().zip(&tight).enumerate() {
        for (((name, x), (_, y)), scale) in quantities(a).iter().zip(quantities(b)).zip(scales) {
            let off = (*x - y).abs().to_f64() / scale;
            assert!(off < 1e-40, "{name} at {} ms: {off:e}", k + 1);
        }
    }
}
