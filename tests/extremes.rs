//! Extremes by revolution, in memory: found while the run goes on, they must be those of the
//! trajectory, whatever its samples. Known in advance: nothing that the same run shows between its
//! samples, looked at densely, exceeds them; and each is what the run has at its time.

use freeplay::case::{Case, Changes};
use freeplay::digits::Sizes;
use freeplay::mechanism::{Measure, Observation};
use freeplay::run::{Revolution, Trajectory};
use freeplay::simulate::Simulation;
use std::ops::ControlFlow;
use std::path::Path;

/// What the search leaves out, and what rounding and drift off the constraints do beside it, over
/// the largest magnitude in the revolution; or what the inside of a step is known to, ten times the
/// tolerance of the run.
fn allowed(case: &Case) -> f64 {
    (10.0 * case.plan.solver.relative_tolerance).max(1e-7)
}

const MEASURES: [Measure; 7] = [
    Measure::AccelerationX,
    Measure::AccelerationY,
    Measure::AngularAcceleration,
    Measure::NormalForce,
    Measure::TangentialForce,
    Measure::DriveTorque,
    Measure::JointForce,
];

fn case(path: &str, set: &[&str]) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let set = set.iter().map(|change| change.parse().unwrap()).collect();
    Case::read(&path, &Changes { set, ideal: false }).unwrap()
}

fn trajectory(simulation: Simulation<'_>) -> Trajectory {
    let mut trajectory = Trajectory::default();
    let (_, ran) = simulation.run(&mut trajectory, &mut |_| ControlFlow::Continue(()));
    ran.unwrap();
    trajectory
}

/// A measure in an observation, by body, joint, clearance or drive.
fn observed(measure: Measure, observation: &Observation) -> Vec<f64> {
    let bodies = &observation.bodies;
    let clearances = &observation.clearances;
    match measure {
        Measure::AccelerationX => bodies.iter().map(|body| body.acceleration[0]).collect(),
        Measure::AccelerationY => bodies.iter().map(|body| body.acceleration[1]).collect(),
        Measure::AngularAcceleration => {
            bodies.iter().map(|body| body.angular_acceleration).collect()
        }
        Measure::NormalForce => clearances.iter().map(|gap| gap.normal_force).collect(),
        Measure::TangentialForce => clearances.iter().map(|gap| gap.tangential_force).collect(),
        Measure::DriveTorque => observation.drive_torques.clone(),
        Measure::JointForce => {
            observation.joints.iter().map(|joint| joint.force[0].hypot(joint.force[1])).collect()
        }
    }
}

/// Magnitudes of the measures of a revolution, by item.
fn magnitudes(revolution: &Revolution, measure: Measure) -> Vec<f64> {
    let largest = revolution.largest(measure).map(|found| found.value.abs());
    let mut magnitudes: Vec<f64> = largest.collect();
    for (magnitude, found) in magnitudes.iter_mut().zip(revolution.smallest(measure)) {
        *magnitude = magnitude.max(found.value.abs());
    }
    magnitudes
}

/// What is rounding of a measure in a revolution: a part of the largest magnitude of any item, and,
/// of angular accelerations, of the square of the rate at which the mechanism turns.
fn rounding(case: &Case, revolution: &Revolution, measure: Measure) -> f64 {
    let of_any = magnitudes(revolution, measure).into_iter().fold(0.0, f64::max);
    let rate = Sizes::of(Simulation::new(case).unwrap().mechanism()).rate;
    let least = if measure == Measure::AngularAcceleration { rate * rate } else { 0.0 };
    1e-12 * of_any.max(least)
}

/// By how much, over what is allowed, samples exceed the extremes of their revolution, at most.
fn worst_excess(case: &Case, revolutions: &[Revolution], samples: &[Observation]) -> (f64, String) {
    let (part, mut worst) = (allowed(case), (0.0, String::new()));
    for (k, revolution) in revolutions.iter().enumerate() {
        let begin = samples.partition_point(|sample| sample.time < revolution.begin);
        let inside = samples[begin..].iter().take_while(|sample| sample.time <= revolution.end);
        let inside: Vec<&Observation> = inside.collect();
        for measure in MEASURES {
            let magnitudes = magnitudes(revolution, measure);
            let rounding = rounding(case, revolution, measure);
            let largest: Vec<f64> = revolution.largest(measure).map(|found| found.value).collect();
            let smallest: Vec<f64> =
                revolution.smallest(measure).map(|found| found.value).collect();
            for sample in &inside {
                for (item, value) in observed(measure, sample).into_iter().enumerate() {
                    let below = smallest.get(item).map_or(0.0, |smallest| smallest - value);
                    let excess = (value - largest[item]).max(below);
                    let allowed = part * magnitudes[item] + rounding + f64::MIN_POSITIVE;
                    if excess / allowed > worst.0 {
                        let told = format!(
                            "{measure:?} {item} in revolution {k}: {value} at {}, not in {} to {}",
                            sample.time,
                            smallest.get(item).copied().unwrap_or(0.0),
                            largest[item]
                        );
                        worst = (excess / allowed, told);
                    }
                }
            }
        }
    }
    worst
}

/// By how much, over what is allowed, an extreme differs from what the run has at its time.
fn worst_invention(case: &Case, revolutions: &[Revolution]) -> (f64, String) {
    let (duration, part) = (case.plan.duration.to_f64(), allowed(case));
    let mut times: Vec<f64> = (revolutions.iter())
        .flat_map(|revolution| revolution.largest.iter().chain(&revolution.smallest))
        .map(|found| found.time.min(duration))
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let simulation = Simulation::new(case).unwrap().sampled_at(times.clone());
    let samples = trajectory(simulation).samples;
    let mut worst = (0.0, String::new());
    for (k, revolution) in revolutions.iter().enumerate() {
        for measure in MEASURES {
            let rounding = rounding(case, revolution, measure);
            let magnitudes = magnitudes(revolution, measure);
            for found in [
                revolution.largest(measure).collect::<Vec<_>>(),
                revolution.smallest(measure).collect(),
            ] {
                for (item, found) in found.into_iter().enumerate() {
                    let place = times.partition_point(|time| *time < found.time.min(duration));
                    let here = observed(measure, &samples[place])[item];
                    let allowed = part * magnitudes[item] + rounding + f64::MIN_POSITIVE;
                    let off = (here - found.value).abs() / allowed;
                    if off > worst.0 {
                        let told = format!(
                            "{measure:?} {item} in revolution {k}: {found:?} where the run has {here}"
                        );
                        worst = (off, told);
                    }
                }
            }
        }
    }
    worst
}

/// Runs a case with two samples, and with as many as adaptive sampling and a fine grid make.
fn hold(path: &str, set: &[&str], interval: &str) {
    let coarse = case(path, &[set, &["run.sample_interval=1.0"]].concat());
    let found = trajectory(Simulation::new(&coarse).unwrap());
    assert!(found.samples.len() <= 3);
    let interval = format!("run.sample_interval={interval}");
    let fine = case(path, &[set, &[&*interval, "run.sampling=adaptive"]].concat());
    let seen = trajectory(Simulation::new(&fine).unwrap());
    let ends: Vec<[f64; 2]> = found.revolutions.iter().map(|r| [r.begin, r.end]).collect();
    assert!(ends.windows(2).all(|pair| pair[0][1] == pair[1][0]), "{ends:?}");
    let end = coarse.plan.duration.to_f64();
    assert_eq!((ends[0][0], ends[ends.len() - 1][1]), (0.0, end), "{ends:?}");
    let (worst, told) = worst_excess(&coarse, &found.revolutions, &seen.samples);
    println!("{path} {set:?}: {} samples, excess {worst:.3} ({told})", seen.samples.len());
    assert!(worst <= 1.0, "{path} {set:?}: {worst} times what is allowed: {told}");
    let (worst, told) = worst_invention(&coarse, &found.revolutions);
    println!("    invention {worst:.3} ({told})");
    assert!(worst <= 1.0, "{path} {set:?}: {worst} times what is allowed: {told}");
}

#[test]
fn the_extremes_of_every_shipped_case_hold_against_adaptive_sampling() {
    for (name, interval) in [
        ("four-bar-ideal", "1e-5"),
        ("four-bar-a", "5e-7"),
        ("four-bar-a-friction", "5e-7"),
        ("four-bar-b", "5e-7"),
        ("four-bar-c", "5e-7"),
        ("journal-in-bearing", "5e-6"),
        ("pendulum", "1e-3"),
    ] {
        hold(&format!("cases/{name}.toml"), &[], interval);
    }
}

/// Every case, shipped or for tests: what it is to be changed by, and how densely it is looked at (s).
const CASES: [(&str, &[&str], &str); 14] = [
    ("cases/four-bar-ideal", &[], "1e-5"),
    ("cases/four-bar-a", &["run.duration=0.024"], "1e-6"),
    ("cases/four-bar-a-friction", &["run.duration=0.012"], "5e-7"),
    ("cases/four-bar-b", &["run.duration=0.024"], "1e-6"),
    ("cases/four-bar-c", &["run.duration=0.012"], "5e-7"),
    ("cases/journal-in-bearing", &[], "5e-6"),
    ("cases/pendulum", &[], "1e-3"),
    ("tests/cases/chain", &["run.duration=0.03"], "2e-6"),
    ("tests/cases/crank-on-crank", &["run.duration=0.1"], "1e-5"),
    ("tests/cases/double-pendulum", &["run.duration=0.2", ELBOW], "1e-5"),
    ("tests/cases/elbow-drive", &[], "1e-4"),
    ("tests/cases/loose-motor", &["run.duration=0.05"], "5e-6"),
    ("tests/cases/six-bar", &["run.duration=0.02"], "1e-6"),
    ("tests/cases/two-discs", &[], "1e-5"),
];

/// Every case with an engine, at tight and at loose tolerances.
fn hold_all(engine: &str) {
    let engine = format!("solver.engine={engine}");
    for (name, changes, interval) in CASES {
        for tolerance in ["1e-6", "1e-9", "1e-12"] {
            let tolerance = format!("solver.relative_tolerance={tolerance}");
            hold(&format!("{name}.toml"), &[changes, &[&*engine, &*tolerance]].concat(), interval);
        }
    }
}

#[test]
fn those_of_every_case_hold_by_the_explicit_engine_at_any_tolerance() {
    hold_all("explicit");
}

#[test]
fn those_of_every_case_hold_by_ida_at_any_tolerance() {
    hold_all("ida");
}

#[test]
fn so_do_those_of_ida_at_scaled_tolerances() {
    for tolerance in ["1e-4", "1e-7"] {
        let relative = format!("solver.relative_tolerance={tolerance}");
        let set = ["run.duration=0.024", &relative, "solver.absolute_tolerance=scaled"];
        hold("cases/four-bar-b.toml", &set, "5e-7");
    }
}

/// A double pendulum with a clearance in its elbow.
const ELBOW: &str = "joints.E.clearance={bearing_radius=0.01, radial=0.0005, \
                     normal={law=\"lankarani-nikravesh\", restitution=0.9, stiffness=1e9}}";
/// The same with much friction.
const RUBBING: &str = "joints.E.clearance={bearing_radius=0.01, radial=0.0005, \
                       normal={law=\"lankarani-nikravesh\", restitution=0.9, stiffness=1e9}, \
                       friction={law=\"ambrosio\", coefficient=0.5, v0=0.0, v1=8.0}}";

#[test]
fn impacts_of_a_double_pendulum_are_seen_in_every_joint_and_body() {
    let double = "tests/cases/double-pendulum.toml";
    for engine in ["ida", "explicit"] {
        let engine = format!("solver.engine={engine}");
        hold(double, &[ELBOW, &engine, "run.duration=0.3"], "2e-6");
        hold(double, &[RUBBING, &engine, "run.duration=0.2"], "2e-6");
    }
}

#[test]
fn a_step_over_many_turns_hides_no_extreme_of_a_flight() {
    // a shaft turns in flight, far faster than anything else moves
    let set = ["run.duration=0.05", "drives.first.speed_rpm=3000"];
    hold("tests/cases/crank-on-crank.toml", &set, "1e-5");
}

#[test]
fn a_contact_within_one_step_and_an_open_one_have_their_largest_force() {
    for (engine, tolerance) in [("explicit", "1e-3"), ("explicit", "1e-4"), ("ida", "1e-12")] {
        let set = [
            format!("solver.engine={engine}"),
            format!("solver.relative_tolerance={tolerance}"),
            // in the middle of a contact of the second revolution
            "run.duration=0.0262".to_owned(),
            "run.sample_interval=2e-7".to_owned(),
        ];
        let set: Vec<&str> = set.iter().map(String::as_str).collect();
        let case = case("cases/four-bar-a.toml", &set);
        let run = trajectory(Simulation::new(&case).unwrap());
        // 19 by then in truth; loose runs have others, and more short ones
        assert!(run.contacts.len() >= 19, "{engine} {tolerance}: {}", run.contacts.len());
        for contact in &run.contacts {
            let end = if contact.end.is_nan() { f64::INFINITY } else { contact.end };
            let inside = (run.samples.iter())
                .filter(|sample| sample.time > contact.begin && sample.time < end);
            let gap = |sample: &Observation| sample.clearances[contact.clearance];
            let (force, depth) = inside.fold((0.0_f64, 0.0_f64), |(force, depth), sample| {
                (force.max(gap(sample).normal_force), depth.max(gap(sample).penetration))
            });
            let told = format!("{engine} {tolerance}: {contact:?}, {force} N in {depth} m");
            assert!(contact.peak_force >= force * (1.0 - allowed(&case)), "{told}");
            assert!(contact.peak_penetration >= depth * (1.0 - allowed(&case)), "{told}");
            let time = contact.peak_penetration_time;
            assert!(time >= contact.begin && time <= end, "{told}");
        }
    }
}
