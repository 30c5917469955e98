//! Constraints that follow from others. Known in advance: the motion in closed form, or that of the same
//! mechanism without what is too much; forces by Newton and Euler; and that of all forces that do the same
//! those of least norm are told.

mod simulated;

use freeplay::case::{Case, Changes};
use freeplay::simulate::Simulation;
use simulated::{case, case_of, root, simulate, told, words};
use std::f64::consts::TAU;

const ENGINES: [&str; 2] = ["solver.engine=explicit", "solver.engine=ida"];
const CRANKS: &str = "cases/parallel-cranks.toml";
const FREE: &str = "tests/kinds/parallel-cranks-free.toml";

fn assert_near(what: &str, found: f64, exact: f64, within: f64) {
    assert!((found - exact).abs() <= within, "{what}: {found:e}, it is {exact:e}");
}

#[test]
fn a_platform_on_three_cranks_goes_in_circles_with_forces_of_least_norm() {
    let octuple = ["solver.engine=explicit", "solver.precision=71"];
    for set in [&ENGINES[..1], &ENGINES[1..], &octuple] {
        let short = ["run.duration=0.25", "run.sample_interval=5e-3"];
        let kept = simulate(&case(CRANKS, &[set, &short].concat()));
        for sample in &kept.samples {
            let turn = 0.6 + TAU * 5.0 * sample.time;
            let (sin, cos) = turn.sin_cos();
            let platform = sample.bodies[3];
            assert_near("x", platform.position[0], 0.15 + 0.1 * cos, 2e-15);
            assert_near("y", platform.position[1], 0.05 + 0.1 * sin, 2e-15);
            assert_near("angle", platform.angle, 0.0, 1e-15);
            // what cranks put on the platform moves it
            let force = |k: usize| sample.joints[k].force;
            let pins = [(3, [-0.15, -0.05]), (4, [0.15, -0.05]), (5, [0.0, 0.15])];
            let (mut sum, mut moment) = ([0.0, -9.81 * 1.5], 0.0);
            for (joint, [x, y]) in pins {
                let [fx, fy] = force(joint);
                sum = [sum[0] + fx, sum[1] + fy];
                moment += x * fy - y * fx;
            }
            let going = platform.acceleration;
            assert_near("force x", sum[0], 1.5 * going[0], 1e-11);
            assert_near("force y", sum[1], 1.5 * going[1], 1e-11);
            assert_near("moment", moment, 0.0, 1e-11);
            // cranks that pull each other along themselves change nothing: no part of that is in the
            // forces. The first crank's own bearing is no constraint, for its motor prescribes it
            let along = |k: usize| force(k)[0] * cos + force(k)[1] * sin;
            let arm = |[x, y]: [f64; 2]| x * sin - y * cos;
            let arms = pins.map(|(_, pin)| arm(pin));
            let pull = [arms[1] - arms[2], arms[2] - arms[0], arms[0] - arms[1]];
            let part = along(3) * pull[0]
                + (along(4) + along(1)) * pull[1]
                + (along(5) + along(2)) * pull[2];
            assert_near("idle part", part, 0.0, 1e-11);
        }
    }
}

#[test]
fn what_is_too_much_changes_no_motion() {
    // two cranks as heavy as three, and nothing too much
    let two = [
        "bodies.first.mass=0.3",
        "bodies.first.inertia=6e-4",
        "bodies.second.mass=0.3",
        "bodies.second.inertia=6e-4",
        "solver.relative_tolerance=1e-12",
    ];
    let text = std::fs::read_to_string(root().join(FREE)).unwrap();
    let table = |name: &str| {
        let begin = text.find(&format!("[{name}]")).unwrap();
        let end = begin + text[begin..].find("\n\n").unwrap() + 2;
        text[begin..end].to_owned()
    };
    let mut less = text.clone();
    for name in ["bodies.third", "joints.C0", "joints.C"] {
        less = less.replace(&table(name), "");
    }
    let less = less.replace("third    = { angle = 0.3 }\n", "");
    for engine in ENGINES {
        let three = simulate(&case(FREE, &[engine, "solver.relative_tolerance=1e-12"]));
        let two = simulate(&case_of(&less, &[&two[..], &[engine]].concat()));
        assert!(three.contacts.len() >= 3, "{}", three.contacts.len());
        assert_eq!(three.contacts.len(), two.contacts.len());
        for (a, b) in three.contacts.iter().zip(&two.contacts) {
            assert_near("begin", a.begin, b.begin, 1e-8);
            assert_near("peak", a.peak_force, b.peak_force, 1e-5 * b.peak_force);
        }
        for (a, b) in three.samples.iter().zip(&two.samples) {
            for body in [0, 1] {
                assert_near("angle", a.bodies[body].angle, b.bodies[body].angle, 1e-9);
            }
            assert_near("rod", a.bodies[4].angle, b.bodies[3].angle, 1e-7);
        }
        let energy = three.largest(|sample| sample.energy.kinetic);
        assert!(three.largest(|sample| sample.energy.residual) < 1e-9 * energy);
    }
    let [explicit, ida] = ENGINES.map(|engine| simulate(&case(FREE, &[engine])));
    for (a, b) in explicit.samples.iter().zip(&ida.samples) {
        assert_near("angle", a.bodies[0].angle, b.bodies[0].angle, 1e-9);
        for (a, b) in a.joints.iter().zip(&b.joints).take(6) {
            assert_near("force", a.force[0], b.force[0], 1e-5);
        }
    }
}

#[test]
fn two_guides_in_line_bear_half_each() {
    let text = "[ground]\npoints = { O = [0.0, 0.0] }\n[bodies.block]\nmass = 2.0\ninertia = 0.01\n\
                points = { C = [0.05, 0.0] }\n\
                [joints.one]\nkind = \"prismatic\"\nbetween = [\"ground.O\", \"block.C\"]\naxis = [1.0, 0.0]\n\
                [joints.other]\nkind = \"prismatic\"\nbetween = [\"ground.O\", \"block.C\"]\naxis = [1.0, 0.0]\n\
                [loads.gravity]\nkind = \"gravity\"\nacceleration = [0.5, -9.81]\n\
                [run]\nduration = 0.5\nsample_interval = 0.05\n";
    for engine in ENGINES {
        let case = case_of(text, &[engine, "solver.absolute_tolerance=\"scaled\""]);
        let mechanism = told(Simulation::new(&case));
        assert_eq!((mechanism.mechanism().redundant(), mechanism.mechanism().freedoms()), (2, 1));
        let kept = simulate(&case);
        for sample in &kept.samples {
            let time = sample.time;
            assert_near("x", sample.bodies[0].position[0], 0.25 * time * time, 1e-11);
            for joint in &sample.joints {
                assert_near("force", joint.force[1], 9.81, 1e-12);
                // about the joint's point, 50 mm ahead of the weight
                assert_near("moment", joint.moment, -0.05 * 9.81, 1e-12);
            }
        }
    }
}

#[test]
fn what_does_not_agree_or_hangs_on_undetermined_forces_is_refused() {
    let cases: [(&[&str], &str); 3] = [
        (&["bodies.third.points.P=[0.051, 0.0]"], "joints"),
        (&["ground.points.C0=[0.1505, 0.2]"], "joints"),
        (
            &[
                "loads.rub={kind=\"joint-friction\",joint=\"B\",friction={law=\"tanh\",coefficient=0.1,transition=1e-3},pin_radius=0.01}",
            ],
            "loads.rub: hangs on a force that is not determined: B0, C0, A, B, C hold each other",
        ),
    ];
    for (set, expected) in cases {
        let set = set.iter().map(|change| change.parse().unwrap()).collect();
        let case = told(Case::read(&root().join(CRANKS), &Changes { set, ideal: false }));
        let Err(refused) = Simulation::new(&case) else { panic!("{expected} is not refused") };
        let refused = words(&refused);
        assert!(refused.contains(expected), "{refused}");
    }
}
