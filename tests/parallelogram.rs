//! Parallelograms, which lie flat twice a turn: there the constraints depend on each other, and two branches
//! of motion cross. Known in advance: on the one branch both cranks turn alike, on the other
//! tan(φ/2) = −(d + a)/(d − a) tan(θ/2); what a motor needs does not feel the flat positions at all; and
//! energy.

mod simulated;

use freeplay::case::Case;
use freeplay::mechanism::Observation;
use freeplay::run::{EventKind, Progress, Trajectory};
use freeplay::simulate::Simulation;
use proptest::prelude::*;
use simulated::{Kept, case_of, root, simulate, words};
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

/// Angle of the cranks at the start (rad): π/80.
const START: &str = "0.03926990816987241548";
/// Weight of cranks and platform at the first crank's arm (N m).
const TORQUE: f64 = 9.81 * (2.0 * 0.2 * 0.05 + 1.5 * 0.1);

/// Two cranks of 0.1 m, 0.3 m apart, under a platform; with more keys, and the angles at which the second
/// and the platform start.
fn text(second: &str, platform: &str, more: &str) -> String {
    format!(
        "[ground]
points = {{ A0 = [0.0, 0.0], B0 = [0.3, 0.0] }}
[bodies.first]
mass = 0.2
inertia = 4e-4
points = {{ O = [-0.05, 0.0], P = [0.05, 0.0] }}
[bodies.second]
mass = 0.2
inertia = 4e-4
points = {{ O = [-0.05, 0.0], P = [0.05, 0.0] }}
[bodies.platform]
mass = 1.5
inertia = 0.03
points = {{ A = [-0.15, 0.0], B = [0.15, 0.0] }}
[joints.A0]
kind = \"revolute\"
between = [\"ground.A0\", \"first.O\"]
[joints.B0]
kind = \"revolute\"
between = [\"ground.B0\", \"second.O\"]
[joints.A]
kind = \"revolute\"
between = [\"first.P\", \"platform.A\"]
[joints.B]
kind = \"revolute\"
between = [\"second.P\", \"platform.B\"]
{more}
[loads.gravity]
kind = \"gravity\"
acceleration = [0.0, -9.81]
[start]
second = {{ angle = {second} }}
platform = {{ angle = {platform} }}
[run]
duration = 0.6
sample_interval = 1.25e-3
[solver]
absolute_tolerance = \"scaled\"
"
    )
}

/// A parallelogram whose first crank turns at 300 rpm: it lies flat at 79, 159, … samples.
fn driven() -> String {
    let drive = format!("[drives.motor]\njoint = \"A0\"\nspeed_rpm = 300.0\nangle = {START}");
    text(START, "0.0", &drive)
}

/// One that is thrown, on either branch.
fn thrown(second: &str, platform: &str) -> String {
    let first = "[start]\nfirst = { angle = 0.6, angular_velocity = 40.0, fixed = true }";
    text(second, platform, "").replace("[start]", first)
}

fn energy(sample: &Observation) -> f64 {
    sample.energy.kinetic + sample.energy.potential
}

fn flat_times(kept: &Kept) -> Vec<f64> {
    let flat = kept.events.iter().filter(|event| event.kind == EventKind::Singular);
    flat.map(|event| event.time).collect()
}

#[test]
fn a_driven_parallelogram_turns_on_through_its_flat_positions() {
    for digits in ["solver.precision=16", "solver.precision=71"] {
        let kept = simulate(&case_of(&driven(), &["solver.engine=explicit", digits]));
        let start: f64 = START.parse().unwrap();
        let flat = flat_times(&kept);
        assert_eq!(flat.len(), 6);
        for (k, time) in flat.iter().enumerate() {
            assert!((time - ((k + 1) as f64 * PI - start) / (10.0 * PI)).abs() < 1e-13, "{time}");
        }
        for sample in &kept.samples {
            let turned = start + TAU * 5.0 * sample.time;
            let [first, second, platform] = sample.bodies[..] else { panic!() };
            assert!((first.angle - turned).abs() < 1e-13 && (second.angle - turned).abs() < 1e-12);
            assert!(platform.angle.abs() < 1e-12);
            assert!((second.angular_velocity - 10.0 * PI).abs() < 1e-8);
            let off = (sample.drive_torques[0] - TORQUE * turned.cos()).abs();
            // at the position itself it is told a millionth of the passage beside it
            let at = flat.iter().any(|time| (time - sample.time).abs() < 1e-12);
            assert!(off < if at { 1e-4 } else { 1e-8 }, "{off:e} at {} s", sample.time);
            // that platform's weight has no other way to the ground: cranks in line hold it by forces
            // without bound
            let force = sample.joints[3].force;
            assert!(force[0].hypot(force[1]) > 1e6 || !at, "{force:?}");
        }
        let largest = kept.largest(|sample| sample.energy.kinetic);
        assert!(kept.largest(|sample| sample.energy.residual) < 1e-8 * largest);
    }
}

#[test]
fn thrown_cranks_stay_on_their_branch() {
    // (d + a)/(d − a) = 2
    let crossed = |angle: f64| -2.0 * (2.0 * (angle / 2.0).tan()).atan();
    let second = crossed(0.6);
    let height = 0.1 * (second.sin() - 0.6_f64.sin());
    let across = 0.3 + 0.1 * (second.cos() - 0.6_f64.cos());
    let (second, platform) = (second.to_string(), height.atan2(across).to_string());
    for engine in ["solver.engine=explicit", "solver.engine=ida"] {
        let keys = [engine, "run.duration=0.4", "solver.relative_tolerance=1e-12"];
        for (text, alike) in [(thrown("0.6", "0.0"), true), (thrown(&second, &platform), false)] {
            let kept = simulate(&case_of(&text, &keys));
            let turns = kept.last().bodies[0].angle / PI;
            assert!(turns > 2.0);
            let flat = kept.events.iter().filter(|event| event.kind == EventKind::Singular);
            assert_eq!(flat.count(), turns.floor() as usize);
            for sample in &kept.samples {
                let (first, second) = (sample.bodies[0].angle, sample.bodies[1].angle);
                let exact = if alike { first } else { crossed(first) };
                let off = ((second - exact) / 2.0).sin().abs();
                assert!(off < 1e-10, "{engine}: {off:e} at {} s, {alike}", sample.time);
            }
            let first = energy(&kept.samples[0]);
            let off = kept.largest(|sample| energy(sample) - first) / first.abs();
            assert!(off < 1e-9, "{engine}: {off:e}, {alike}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..Default::default() })]

    #[test]
    fn parallelograms_of_any_size_stay_on_their_branch_under_any_load(
        crank in 50_u32..300,
        longer in 1.3_f64..4.0,
        angle in 0.3_f64..2.8,
        rate in -30.0_f64..30.0,
        crossed in any::<bool>(),
        stiffness in 5.0_f64..200.0,
        masses in [0.1_f64..2.0, 0.1_f64..2.0, 0.1_f64..2.0],
    ) {
        // whole millimetres: lengths are alike to the last digit
        let base = (f64::from(crank) * longer).round();
        let (a, d) = (f64::from(crank) / 1e3, base / 1e3);
        let other = move |angle: f64| match crossed {
            true => -2.0 * ((d + a) / (d - a) * (angle / 2.0).tan()).atan(),
            false => angle,
        };
        let second = other(angle);
        let rise = a * (second.sin() - angle.sin());
        let across = d + a * (second.cos() - angle.cos());
        let [first, other_mass, platform] = masses;
        let text = format!(
            "[ground]
points = {{ A0 = [0.0, 0.0], B0 = [{base}e-3, 0.0], S = [0.1, 0.2] }}
[bodies.first]
mass = {first}
inertia = 1e-3
points = {{ O = [-0.01, 0.0], P = [{}e-3, 0.0] }}
[bodies.second]
mass = {other_mass}
inertia = 2e-3
points = {{ O = [0.0, 0.0], P = [{crank}e-3, 0.0] }}
[bodies.platform]
mass = {platform}
inertia = 0.01
points = {{ A = [-0.1, 0.05], B = [{}e-3, 0.05], C = [0.01, 0.02] }}
[joints.A0]
kind = \"revolute\"
between = [\"ground.A0\", \"first.O\"]
[joints.B0]
kind = \"revolute\"
between = [\"ground.B0\", \"second.O\"]
[joints.A]
kind = \"revolute\"
between = [\"first.P\", \"platform.A\"]
[joints.B]
kind = \"revolute\"
between = [\"second.P\", \"platform.B\"]
[loads.gravity]
kind = \"gravity\"
acceleration = [0.0, -9.81]
[loads.spring]
kind = \"spring\"
between = [\"ground.S\", \"platform.C\"]
stiffness = {stiffness}
free_length = 0.1
[start]
first = {{ angle = {angle}, angular_velocity = {rate}, fixed = true }}
second = {{ angle = {second} }}
platform = {{ angle = {} }}
[run]
duration = 0.6
sample_interval = 5e-3
[solver]
relative_tolerance = 1e-12
absolute_tolerance = \"scaled\"
",
            crank - 10,
            base - 100.0,
            rise.atan2(across),
        );
        for engine in ["solver.engine=explicit", "solver.engine=ida"] {
            let kept = simulate(&case_of(&text, &[engine]));
            for sample in &kept.samples {
                let (first, second) = (sample.bodies[0].angle, sample.bodies[1].angle);
                let off = ((second - other(first)) / 2.0).sin().abs();
                prop_assert!(off < 1e-9, "{engine}: {off:e} at {} s", sample.time);
            }
            let largest = kept.largest(|sample| sample.energy.kinetic);
            prop_assert!(kept.largest(|sample| sample.energy.residual) < 1e-9 * largest);
        }
    }
}

/// What a case says where it stops.
fn stops(case: &Case) -> String {
    let mut go_on = |_: &Progress| ControlFlow::Continue(());
    let mut kept = Trajectory::default();
    let (_, ran) = Simulation::new(case).unwrap().run(&mut kept, &mut go_on);
    words(&ran.unwrap_err())
}

#[test]
fn cranks_that_are_alike_but_for_a_hair_stop_where_the_arithmetic_cannot_tell_their_branch() {
    for hair in ["0.05000000000000000000000001", "0.0500000000000001"] {
        let text = driven().replacen("P = [0.05, 0.0]", &format!("P = [{hair}, 0.0]"), 1);
        let said = stops(&case_of(&text, &[]));
        assert!(said.contains("dead centre"), "{said}");
    }
}

#[test]
fn a_rod_with_play_hangs_on_a_parallelogram_that_passes() {
    // the platform of that case on two of its three cranks
    let whole = std::fs::read_to_string(root().join("tests/kinds/parallel-cranks-free.toml"));
    let third = ["[bodies.third]", "[joints.C0]", "[joints.C]"];
    let whole = whole.unwrap();
    let blocks = whole.split("\n\n").filter(|block| {
        let head = block.lines().find(|line| !line.starts_with('#'));
        !third.contains(&head.unwrap_or_default())
    });
    let text = blocks.collect::<Vec<_>>().join("\n\n");
    let text: Vec<&str> = text.lines().filter(|line| !line.starts_with("third")).collect();
    let runs = ["solver.engine=explicit", "solver.engine=ida"].map(|engine| {
        let keys = [engine, "run.duration=0.12", "solver.relative_tolerance=1e-12"];
        simulate(&case_of(&text.join("\n"), &keys))
    });
    let flat = runs.each_ref().map(flat_times);
    assert_eq!(flat[0].len(), 1);
    assert!((flat[0][0] - flat[1][0]).abs() < 1e-10, "{flat:?}");
    for (a, b) in runs[0].samples.iter().zip(&runs[1].samples) {
        for (a, b) in a.bodies.iter().zip(&b.bodies) {
            assert!((a.angle - b.angle).abs() < 1e-8, "{}", a.angle - b.angle);
        }
    }
}

#[test]
fn a_summary_does_not_call_forces_without_bound_known() {
    let folder = tempfile::tempdir().unwrap();
    let freeplay = |arguments: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_freeplay"));
        let output = command.args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    for (name, text, torque) in
        [("driven", driven(), Some("exact")), ("thrown", thrown("0.6", "0.0"), None)]
    {
        std::fs::write(folder.path().join(format!("{name}.toml")), text).unwrap();
        let case = format!("{name}.toml");
        freeplay(&["run", &case, "--no-tangent", "--quiet", "--set", "run.duration=0.15"]);
        let told = freeplay(&["summary", &format!("{name}.h5")]);
        let known = |of: &str| {
            let line = told.lines().find(|line| line.trim_start().starts_with(of));
            line.and_then(|line| line.split_whitespace().last()).map(str::to_owned)
        };
        assert_eq!(known("A ").as_deref(), Some("sample"), "{told}");
        assert_eq!(known("drive_torque.motor").as_deref(), torque, "{told}");
    }
}
