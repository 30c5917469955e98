//! One kind of everything of one's own, as docs/extending.md adds them: one file and one line each, and
//! they run on both engines.

use crate::case::{Case, Changes};
use crate::contact::rebound;
use crate::run::{Progress, Trajectory};
use crate::simulate::Simulation;
use std::ops::ControlFlow;
use std::path::Path;

const ENGINES: [&str; 2] = ["solver.engine=explicit", "solver.engine=ida"];

fn run(text: &str, engine: &str) -> Trajectory {
    let changes = Changes { set: vec![engine.parse().unwrap()], ideal: false };
    let case = Case::from_text(Path::new("scratch.toml"), text, &changes).unwrap();
    let mut kept = Trajectory::default();
    let mut go_on = |_: &Progress| ControlFlow::Continue(());
    Simulation::new(&case).unwrap().run(&mut kept, &mut go_on).1.unwrap();
    kept
}

const BODY: &str = r#"
[ground]
points = { O = [0.0, 0.0] }
[bodies.rod]
mass = 0.5
inertia = 0.015
points = { O = [-0.3, 0.0], C = [0.0, 0.0], E = [0.3, 0.0] }
[run]
duration = 0.5
sample_interval = 0.05
[solver]
absolute_tolerance = "scaled"
"#;

#[test]
fn a_joint_of_one_s_own_holds() {
    let text = format!(
        r#"{BODY}
        [joints.p]
        kind = "parallel"
        between = ["ground.O", "rod.C"]
        angle = 0.3
        [loads.m]
        kind = "torque"
        body = "rod"
        torque = 2.0
        [start]
        rod = {{ x = 0.0, y = 0.0, angle = 0.3, velocity_x = 1.0, fixed = true }}"#
    );
    for engine in ENGINES {
        for sample in run(&text, engine).samples {
            assert!((sample.bodies[0].angle - 0.3).abs() < 1e-12);
            assert!((sample.bodies[0].position[0] - sample.time).abs() < 1e-10);
            assert!((sample.joints[0].moment + 2.0).abs() < 1e-10, "{:?}", sample.joints[0]);
        }
    }
}

#[test]
fn a_load_of_one_s_own_slows_a_body_down() {
    let text = format!(
        r#"{BODY}
        [loads.air]
        kind = "drag"
        at = "rod.C"
        damping = 0.2
        [start]
        rod = {{ x = 0.0, y = 0.0, velocity_x = 1.0, fixed = true }}"#
    );
    for engine in ENGINES {
        for sample in run(&text, engine).samples {
            let speed = (-0.4 * sample.time).exp();
            assert!((sample.bodies[0].velocity[0] - speed).abs() < 1e-9);
            let lost = 0.25 * (1.0 - speed * speed);
            assert!((sample.energy.dissipated - lost).abs() < 1e-9);
            assert!(sample.energy.residual.abs() < 1e-9);
        }
    }
}

#[test]
fn a_course_of_one_s_own_drives() {
    let text = format!(
        r#"{BODY}
        [joints.O]
        kind = "revolute"
        between = ["ground.O", "rod.O"]
        [drives.d]
        kind = "run-up"
        joint = "O"
        acceleration = 40.0"#
    );
    for engine in ENGINES {
        for sample in run(&text, engine).samples {
            assert!((sample.bodies[0].angle - 20.0 * sample.time * sample.time).abs() < 1e-12);
            assert!((sample.drive_torques[0] - 40.0 * (0.015 + 0.5 * 0.09)).abs() < 1e-11);
        }
    }
}

#[test]
fn an_elastic_law_of_one_s_own_gives_way_as_far_as_its_energy_says() {
    let text = format!(
        r#"{BODY}
        [joints.O]
        kind = "revolute"
        between = ["ground.O", "rod.C"]
        [joints.O.clearance]
        bearing_radius = 0.01
        radial = 0.001
        normal = {{ law = "hertz", elastic = "hardening", stiffness = 1e6, depth = 1e-4 }}
        [start]
        rod = {{ x = 0.0, y = 0.0, velocity_x = 0.1, fixed = true }}"#
    );
    for engine in ENGINES {
        let contacts = run(&text, engine).contacts;
        assert!(contacts.len() >= 10, "{}", contacts.len());
        for contact in contacts.iter().filter(|contact| !contact.end.is_nan()) {
            // ½ m v² = K δ² (½ + δ/3δ_1)
            let d = contact.peak_penetration;
            let energy = 1e6 * d * d * (0.5 + d / 3e-4);
            assert!((energy / 2.5e-3 - 1.0).abs() < 1e-8, "{energy}");
        }
    }
}

#[test]
fn laws_of_one_s_own_rebound_and_rub_as_they_say() {
    let text = r#"
        [ground]
        points = { O = [0.0, 0.0] }
        [bodies.ball]
        mass = 0.05
        inertia = 2e-6
        points = { C = [0.0, 0.0] }
        [joints.O]
        kind = "revolute"
        between = ["ground.O", "ball.C"]
        [joints.O.clearance]
        bearing_radius = 0.01
        radial = 0.001
        normal = { law = "straight", restitution = 0.6, stiffness = 1e10 }
        friction = { law = "thick", coefficient = 0.1, slip = 1.0 }
        [start]
        ball = { x = 0.0, y = 0.0, velocity_x = 1.0, fixed = true }
        [run]
        duration = 0.02
        sample_interval = 0.02
        [solver]
        absolute_tolerance = "scaled"
    "#;
    for engine in ENGINES {
        let contacts = run(text, engine).contacts;
        assert!(contacts.len() >= 4, "{}", contacts.len());
        for pair in contacts.windows(2) {
            let ratio = pair[1].impact_rate / pair[0].impact_rate;
            assert!((ratio - rebound(0.4)).abs() < 1e-8, "{ratio}");
        }
        // a spinning ball is slowed down by an impact along its normal
        let spin = text.replace("velocity_x = 1.0", "velocity_x = 1.0, angular_velocity = 100.0");
        let kept = run(&spin, engine);
        let [first, last] = [kept.samples[0].bodies[0], kept.samples[1].bodies[0]];
        assert!(last.angular_velocity.abs() < 0.99 * first.angular_velocity);
        assert!(kept.samples[1].energy.residual.abs() < 1e-9);
    }
}
