//! Mechanisms that IDA once went wrong on: it flew through walls, gave up in smooth contacts, crawled.
//!
//! Known in advance: where a freely turning rotor first meets its bearing, by closed form; what the
//! explicit engine, which shares no integration with IDA, makes of the others.

mod simulated;

use freeplay::run::EventKind;
use simulated::{Kept, case_of, root, simulate};

/// A body pinned to the ground in a bearing of 10 mm.
fn pinned(body: &str, clearance: &str, start: &str, gravity: bool, duration: f64) -> String {
    let gravity = match gravity {
        true => "[loads.gravity]\nkind = \"gravity\"\nacceleration = [0.0, -9.81]\n",
        false => "",
    };
    format!(
        "[ground]\npoints = {{ O = [0.0, 0.0] }}\n[bodies.body]\n{body}\n[joints.O]\nkind = \
         \"revolute\"\nbetween = [\"ground.O\", \"body.O\"]\n[joints.O.clearance]\nbearing_radius \
         = 0.01\n{clearance}\n{gravity}{start}\n[run]\nduration = {duration:?}\nsample_interval = \
         {duration:?}\n"
    )
}

fn rod(friction: &str, stiffness: f64, duration: f64) -> String {
    pinned(
        "mass = 0.5\ninertia = 0.005\npoints = { O = [-0.2, 0.0] }",
        &format!(
            "radial = 1e-4\nnormal = {{ law = \"lankarani-nikravesh\", restitution = 0.9, \
             stiffness = {stiffness:?} }}\n{friction}"
        ),
        "[start]\nbody = { angle = -1.2, angular_velocity = 0.0, fixed = true }",
        true,
        duration,
    )
}

fn friction(v0: f64) -> String {
    format!("friction = {{ law = \"ambrosio\", coefficient = 0.1, v0 = {v0:?}, v1 = 1e-2 }}")
}

/// A run on each engine.
fn on_both(text: &str, set: &[&str]) -> [Kept; 2] {
    ["solver.engine=ida", "solver.engine=explicit"]
        .map(|engine| simulate(&case_of(text, &[set, &[engine]].concat())))
}

/// Begins and ends of contacts (s).
fn touches(run: &Kept) -> Vec<f64> {
    let ends = [EventKind::ContactBegins, EventKind::ContactEnds];
    run.events.iter().filter(|e| ends.contains(&e.kind)).map(|e| e.time).collect()
}

/// The first so many begins and ends are the same in both runs.
fn agree([ida, explicit]: &[Kept; 2], number: usize, within: f64) {
    let (ours, theirs) = (touches(ida), touches(explicit));
    assert!(ours.len() >= number && theirs.len() >= number, "{ours:?} {theirs:?}");
    for (a, b) in ours.iter().zip(&theirs).take(number) {
        assert!((a - b).abs() < within, "{a:e} {b:e}");
    }
}

#[test]
fn a_rotor_that_turns_many_times_in_a_step_meets_its_bearing_when_the_closed_form_says() {
    let text = pinned(
        "mass = 0.5\ninertia = 1e-3\npoints = { O = [0.0003, 0.0] }",
        "radial = 1e-3\nnormal = { law = \"lankarani-nikravesh\", restitution = 0.9, stiffness = 1e9 }",
        "[start]\nbody = { x = 0.0, y = 0.0, angle = 0.0, velocity_x = 0.01, velocity_y = 0.0, \
         angular_velocity = 300.0, fixed = true }",
        false,
        0.09,
    );
    // |(0.01 t + 0.0003 cos 300 t, 0.0003 sin 300 t)| = 0.001 for the first time, by bisection
    let depth = |t: f64| {
        let (s, c) = (300.0 * t).sin_cos();
        (0.01 * t + 3e-4 * c).hypot(3e-4 * s) - 1e-3
    };
    let (mut low, mut high) = (0.079, 0.0805);
    assert!(depth(low) < 0.0 && depth(high) > 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if depth(middle) > 0.0 { high = middle } else { low = middle }
    }
    for tolerance in ["1e-2", "1e-6", "1e-12"] {
        let run = simulate(&case_of(
            &text,
            &[
                &format!("solver.relative_tolerance={tolerance}"),
                "solver.absolute_tolerance=scaled",
            ],
        ));
        let first = run.contacts[0].begin;
        assert!((first - high).abs() < 1e-10, "at {tolerance}: {first} {high}");
    }
}

#[test]
fn a_ring_on_an_eccentric_shaft_is_struck_as_often_as_it_should() {
    let text = r#"
        [ground]
        points = { O = [0.0, 0.0] }
        [bodies.shaft]
        mass = 0.3
        inertia = 1e-4
        points = { O = [0.0, 0.0], P = [0.0004, 0.0] }
        [bodies.ring]
        mass = 0.1
        inertia = 2e-5
        points = { P = [0.0, 0.0] }
        [joints.O]
        kind = "revolute"
        between = ["ground.O", "shaft.O"]
        [joints.P]
        kind = "revolute"
        between = ["ring.P", "shaft.P"]
        [joints.P.clearance]
        bearing_radius = 0.01
        radial = 0.001
        normal = { law = "hertz", stiffness = 1e9 }
        [drives.shaft]
        joint = "O"
        speed_rpm = 3000.0
        angle = 0.0
        [start]
        ring = { x = 7e-4, y = 0.0, angle = 0.0, velocity_x = 0.0, velocity_y = 0.0, angular_velocity = 0.0, fixed = true }
        [run]
        duration = 0.06
        sample_interval = 0.06
    "#;
    let both = on_both(text, &[]);
    assert_eq!([both[0].contacts.len(), both[1].contacts.len()], [6, 6]);
    agree(&both, 12, 1e-9);
}

#[test]
fn a_touch_at_rest_under_a_load_along_the_wall_becomes_a_contact() {
    for [x, y, gx, gy] in [[1.0, 0.0, 0.0, -9.81], [-1.0, 0.0, 0.0, -9.81], [0.0, 1.0, 9.81, 0.0]] {
        let text = pinned(
            "mass = 0.05\ninertia = 2e-6\npoints = { O = [0.0, 0.0] }",
            "radial = 1e-3\nnormal = { law = \"hertz\", stiffness = 1e9 }",
            &format!(
                "[loads.gravity]\nkind = \"gravity\"\nacceleration = [{gx:?}, {gy:?}]\n[start]\n\
                 body = {{ x = {:?}, y = {:?}, angle = 0.0, velocity_x = 0.0, velocity_y = 0.0, \
                 angular_velocity = 0.0, fixed = true }}",
                1e-3 * x,
                1e-3 * y
            ),
            false,
            0.02,
        );
        let both = on_both(&text, &["solver.absolute_tolerance=scaled"]);
        assert!(!both[0].contacts.is_empty());
        let depth = |run: &Kept| run.last().clearances[0].penetration;
        let [ours, theirs] = [depth(&both[0]), depth(&both[1])];
        assert!((ours - theirs).abs() < 1e-8, "{ours:e} {theirs:e}");
    }
}

#[test]
fn a_contact_that_begins_without_slip_has_the_friction_of_the_slip_that_follows() {
    let both = on_both(&rod(&friction(0.0), 1e10, 0.02), &[]);
    let almost = simulate(&case_of(&rod(&friction(1e-9), 1e10, 0.02), &[]));
    let angle = |run: &Kept| run.last().bodies[0].angle;
    let [ours, theirs, almost] = [angle(&both[0]), angle(&both[1]), angle(&almost)];
    assert!((ours - theirs).abs() < 1e-9, "{ours} {theirs}");
    assert!((ours - almost).abs() < 1e-7, "{ours} {almost}");
}

#[test]
fn a_soft_rod_swings_to_its_end_with_and_without_friction() {
    for friction in [String::new(), friction(0.0)] {
        let both = on_both(&rod(&friction, 1e8, 0.2), &["solver.absolute_tolerance=scaled"]);
        agree(&both, 4, 1e-8);
        let scale = both[0].largest(|sample| sample.energy.kinetic);
        let residual = both[0].largest(|sample| sample.energy.residual);
        assert!(residual < 1e-7 * scale, "{residual:e} of {scale:e}");
    }
}

#[test]
fn a_drive_on_its_own_clearance_does_not_lose_its_torque_in_flight() {
    let text = std::fs::read_to_string(root().join("tests/cases/loose-motor.toml")).unwrap();
    for tolerance in ["1e-9", "1e-12"] {
        let set = format!("solver.relative_tolerance={tolerance}");
        let set = ["bodies.rotor.points.O=[0.0, 0.0]", "run.duration=0.1", &set];
        let both = on_both(&text, &set);
        agree(&both, 8, 1e-6);
        assert_eq!(both[0].contacts.len(), both[1].contacts.len());
        assert_eq!(both[0].count("recoveries"), 0);
    }
}

#[test]
fn a_disc_that_comes_to_rest_takes_no_more_steps_than_a_moving_one() {
    let text = pinned(
        "mass = 0.05\ninertia = 2.025e-6\npoints = { O = [0.0, 0.0] }",
        "radial = 1e-3\nnormal = { law = \"lankarani-nikravesh\", restitution = 0.9, stiffness = \
         \"hertz-printed\", young = 207e9, poisson = 0.3 }",
        "",
        true,
        0.5,
    );
    let run = simulate(&case_of(&text, &[]));
    assert!(run.count("steps") < 150_000, "{}", run.count("steps"));
    assert!(run.count("steps_at_rounding") > 1000);
    // it lies on K δ^1.5 = m g
    let depth = run.last().clearances[0].penetration;
    let exact = (0.05_f64 * 9.81 / 1.043_715_536_510_028_3e10).powf(2.0 / 3.0);
    assert!((depth / exact - 1.0).abs() < 1e-6, "{depth:e} {exact:e}");
}

#[test]
fn a_mechanism_a_kilometre_away_takes_no_more_steps() {
    let path = root().join("cases/four-bar-a.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let steps = |set: &[&str]| {
        let set = [set, &["run.duration=0.003", "run.sample_interval=0.003"]].concat();
        simulate(&case_of(&text, &set)).count("steps")
    };
    let far = [
        "ground.points.A0=[1000.0, 1000.0]",
        "ground.points.B0=[1000.2, 1000.0]",
        "start.coupler.x=1000.0",
        "start.coupler.y=1000.0",
        "start.follower.x=1000.2",
        "start.follower.y=1000.0",
    ];
    let (near, far) = (steps(&[]), steps(&far));
    assert!(far * 10 < 11 * near, "{far} {near}");
}
