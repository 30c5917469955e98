//! Joints, loads and courses of every kind, each against what is known of it in advance: problems
//! solved twice in 40 digits and more (`tests/data/problems`), closed forms, and mechanisms that are
//! the same though they are described otherwise. On both engines, and in 71 digits.

mod simulated;

use freeplay::mechanism::{BodyObservation, Observation};
use freeplay::model::Owner;
use freeplay::run::{Event, EventKind};
use simulated::{Kept, case, case_of, root, simulate};
use std::f64::consts::PI;

const ENGINES: [&str; 2] = ["solver.engine=\"explicit\"", "solver.engine=\"ida\""];

/// What is compared: a column of the problem and the same of a sample.
type Column = (&'static str, fn(&Observation) -> f64);

/// Rows of a problem: its columns by name.
fn problem(name: &str) -> Vec<Vec<(String, f64)>> {
    let path = root().join("tests/data/problems").join(name).with_extension("csv");
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
    let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let row = |row: csv::StringRecord| {
        names.iter().cloned().zip(row.iter().map(|value| value.parse().unwrap())).collect()
    };
    reader.records().map(|record| row(record.unwrap())).collect()
}

fn value(row: &[(String, f64)], name: &str) -> f64 {
    row.iter().find(|(known, _)| known == name).unwrap_or_else(|| panic!("no column {name}")).1
}

/// Holds a run against a problem: each column to `within` of its largest value.
fn assert_solves(kept: &Kept, name: &str, columns: &[Column], within: f64) {
    let rows = problem(name);
    let end = kept.last().time;
    let rows: Vec<_> =
        rows.iter().filter(|row| value(row, "time_s") <= end * (1.0 + 1e-12)).collect();
    assert!(rows.len() > 20, "{} rows of {name}", rows.len());
    for (column, of) in columns {
        let size = rows.iter().map(|row| value(row, column).abs()).fold(0.0, f64::max);
        for row in &rows {
            let time = value(row, "time_s");
            let near = |a: &&Observation, b: &&Observation| {
                (a.time - time).abs().total_cmp(&(b.time - time).abs())
            };
            let sample = kept.samples.iter().min_by(near).unwrap();
            assert!((sample.time - time).abs() <= 1e-12 * end, "{name} has no sample at {time}");
            let off = (of(sample) - value(row, column)).abs();
            assert!(
                off <= within * size,
                "{name} {column} at {time} s: off by {off:e} of {size:e}"
            );
        }
    }
}

fn body(sample: &Observation, k: usize) -> BodyObservation {
    sample.bodies[k]
}

#[test]
fn a_slider_crank_without_freedom_has_the_forces_of_the_closed_form() {
    let columns: [Column; 12] = [
        ("slider_x", |s| body(s, 2).position[0]),
        ("slider_vx", |s| body(s, 2).velocity[0]),
        ("slider_ax", |s| body(s, 2).acceleration[0]),
        ("rod_angle", |s| body(s, 1).angle),
        ("rod_rate", |s| body(s, 1).angular_velocity),
        ("rod_accel", |s| body(s, 1).angular_acceleration),
        ("A0_x", |s| s.joints[0].force[0]),
        ("A0_y", |s| s.joints[0].force[1]),
        ("A_x", |s| s.joints[1].force[0]),
        ("B_y", |s| s.joints[2].force[1]),
        ("guide_y", |s| s.joints[3].force[1]),
        ("drive_torque", |s| s.drive_torques[0]),
    ];
    let kept = simulate(&case("tests/kinds/slider-crank.toml", &[]));
    assert_solves(&kept, "slider-crank-ideal", &columns, 1e-14);
}

#[test]
fn a_slider_crank_with_clearance_at_the_wrist_pin_follows_the_truth() {
    let columns: [Column; 7] = [
        ("rod_angle", |s| body(s, 1).angle),
        ("rod_rate", |s| body(s, 1).angular_velocity),
        ("slider_x", |s| body(s, 2).position[0]),
        ("slider_v", |s| body(s, 2).velocity[0]),
        ("clearance_x", |s| s.clearances[0].offset[0]),
        ("clearance_y", |s| s.clearances[0].offset[1]),
        ("normal_force", |s| s.clearances[0].normal_force),
    ];
    for (engine, within) in ENGINES.into_iter().zip([1e-9, 1e-7]) {
        let kept = simulate(&case("tests/kinds/slider-crank-wrist-pin.toml", &[engine]));
        assert_solves(&kept, "slider-crank-wrist-pin", &columns, within);
        for (row, contact) in problem("slider-crank-wrist-pin-contacts").iter().zip(&kept.contacts)
        {
            for (column, ours) in [
                ("begin_s", contact.begin),
                ("end_s", contact.end),
                ("impact_rate", contact.impact_rate),
                ("peak_force_N", contact.peak_force),
                ("peak_force_time_s", contact.peak_time),
                ("peak_penetration_m", contact.peak_penetration),
            ] {
                let known = value(row, column);
                assert!((ours - known).abs() <= 10.0 * within * known, "{column}: {ours} {known}");
            }
        }
    }
}

#[test]
fn a_scotch_yoke_has_the_forces_of_the_closed_form() {
    let columns: [Column; 9] = [
        ("yoke_x", |s| body(s, 1).position[0]),
        ("yoke_vx", |s| body(s, 1).velocity[0]),
        ("yoke_ax", |s| body(s, 1).acceleration[0]),
        // the crank's pin is the second of the slot's points
        ("slot_force_on_yoke_x", |s| -s.joints[1].force[0]),
        ("guide_y", |s| s.joints[2].force[1]),
        ("guide_moment_about_yoke_centre", |s| s.joints[2].moment),
        ("A0_x", |s| s.joints[0].force[0]),
        ("A0_y", |s| s.joints[0].force[1]),
        ("drive_torque", |s| s.drive_torques[0]),
    ];
    let kept = simulate(&case("tests/kinds/scotch-yoke.toml", &[]));
    assert_solves(&kept, "scotch-yoke", &columns, 1e-13);
}

#[test]
fn masses_on_springs_and_gears_follow_the_truth() {
    let block: [Column; 2] = [("x", |s| body(s, 0).position[0]), ("v", |s| body(s, 0).velocity[0])];
    let gears: [Column; 6] = [
        ("theta1", |s| body(s, 0).angle),
        ("rate1", |s| body(s, 0).angular_velocity),
        ("theta2", |s| body(s, 1).angle),
        ("rate2", |s| body(s, 1).angular_velocity),
        ("theta3", |s| body(s, 2).angle),
        ("rate3", |s| body(s, 2).angular_velocity),
    ];
    let problems: [(&str, &[Column]); 3] =
        [("duffing", &block), ("spring-damper", &block), ("gears", &gears)];
    for (name, columns) in problems {
        for (engine, within) in ENGINES.into_iter().zip([3e-11, 1e-8]) {
            let kept = simulate(&case(&format!("tests/kinds/{name}.toml"), &[engine]));
            assert_solves(&kept, name, columns, within);
            let energy = kept.largest(|s| s.energy.kinetic);
            assert!(kept.largest(|s| s.energy.residual) <= within * energy, "{name}, {engine}");
        }
    }
}

#[test]
fn seventy_one_digits_know_every_kind() {
    for (name, end) in [("duffing", "0.2"), ("gears", "0.4")] {
        let until = format!("run.duration={end}");
        let octuple =
            [ENGINES[0], "solver.precision=71", "solver.reference_tolerance=1e-40", &until];
        let exact = simulate(&case(&format!("tests/kinds/{name}.toml"), &octuple));
        let block: [Column; 1] = [("x", |s| body(s, 0).position[0])];
        let gears: [Column; 1] = [("theta3", |s| body(s, 2).angle)];
        let columns = if name == "gears" { gears } else { block };
        let rows = problem(name).len();
        assert!(rows > 20);
        let last = exact.last();
        let row = problem(name);
        let row = row.iter().find(|row| (value(row, "time_s") - last.time).abs() < 1e-12).unwrap();
        let (column, of) = columns[0];
        let off = (of(last) - value(row, column)).abs();
        assert!(off <= 4e-16 * value(row, column).abs().max(1e-3), "{name}: {off:e}");
    }
}

/// A case of one body, and whatever else.
fn with_body(rest: &str) -> String {
    format!(
        "name = \"kind\"\n[ground]\npoints = {{ O = [0.0, 0.0], P = [0.3, 0.1] }}\n\
         [bodies.rod]\nmass = 0.5\ninertia = 0.015\n\
         points = {{ O = [-0.3, 0.0], C = [0.0, 0.0], E = [0.3, 0.0] }}\n{rest}\n\
         [run]\nduration = 0.5\nsample_interval = 0.01\n\
         [solver]\nrelative_tolerance = 1e-12\nabsolute_tolerance = \"scaled\"\n"
    )
}

const GRAVITY: &str = "[loads.g]\nkind = \"gravity\"\nacceleration = [0.0, -9.81]\n";
const PIVOT: &str = "[joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"rod.O\"]\n";

fn runs(rest: &str) -> [Kept; 2] {
    ENGINES.map(|engine| simulate(&case_of(&with_body(rest), &[engine])))
}

/// Holds a quantity of every sample against a function of time.
fn assert_is(
    kept: &Kept,
    what: &str,
    of: impl Fn(&Observation) -> f64,
    known: impl Fn(f64) -> f64,
) {
    let size = kept.samples.iter().map(|s| known(s.time).abs()).fold(1e-3, f64::max);
    for sample in &kept.samples {
        let off = (of(sample) - known(sample.time)).abs();
        assert!(off <= 3e-8 * size, "{what} at {} s: off by {off:e} of {size:e}", sample.time);
    }
}

#[test]
fn a_body_on_a_massless_link_through_its_centre_is_a_simple_pendulum() {
    let link = "[joints.link]\nkind = \"distance\"\nbetween = [\"ground.O\", \"rod.C\"]\n\
                length = 0.25\n[start]\nrod = { x = 0.25, y = 0.0, fixed = true }\n";
    for kept in runs(&format!("{link}{GRAVITY}")) {
        let off = |s: &Observation| body(s, 0).position[0].hypot(body(s, 0).position[1]) - 0.25;
        assert!(kept.largest(off) < 1e-12);
        // from the horizontal: v² = 2 g h, and the tension is 3 m g h/L
        for sample in &kept.samples {
            let at = body(sample, 0);
            let fallen = -at.position[1];
            let square = at.velocity[0].powi(2) + at.velocity[1].powi(2);
            assert!((square - 2.0 * 9.81 * fallen).abs() < 1e-7, "{square} {fallen}");
            let tension = 3.0 * 0.5 * 9.81 * fallen / 0.25;
            let [x, y] = sample.joints[0].force;
            let along = -(x * at.position[0] + y * at.position[1]) / 0.25;
            assert!((along - tension).abs() < 1e-6, "{along} {tension}");
        }
        assert_is(&kept, "angle", |s| body(s, 0).angle, |_| 0.0);
    }
}

#[test]
fn bodies_that_are_welded_are_one_body() {
    // half of the rod on each side of its centre, at an angle that the points make up for
    let halves = "[bodies.left]\nmass = 0.25\ninertia = 0.001875\n\
        points = { O = [-0.15, 0.0], W = [0.15, 0.0] }\n\
        [bodies.right]\nmass = 0.25\ninertia = 0.001875\npoints = { W = [0.0, 0.15] }\n\
        [joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"left.O\"]\n\
        [joints.weld]\nkind = \"fixed\"\nbetween = [\"left.W\", \"right.W\"]\n\
        angle = 1.5707963267948966192313216916397514420985846996875529\n\
        [start]\nleft = { angle = 0.0, fixed = true }\n";
    let text = with_body(&format!("{halves}{GRAVITY}"));
    let begin = text.find("[bodies.rod]").unwrap();
    let end = text.find("[bodies.left]").unwrap();
    let text = format!("{}{}", &text[..begin], &text[end..]);
    let whole = format!("{PIVOT}{GRAVITY}[start]\nrod = {{ angle = 0.0, fixed = true }}\n");
    let [explicit, _] = runs(&whole);
    for engine in ENGINES {
        let welded = simulate(&case_of(&text, &[engine]));
        for (one, two) in explicit.samples.iter().zip(&welded.samples) {
            assert!((body(one, 0).angle - body(two, 0).angle).abs() < 1e-8);
            let off = body(two, 1).angle - body(two, 0).angle - PI / 2.0;
            assert!(off.abs() < 1e-12, "{off:e}");
            let [a, b] = [one.joints[0].force, two.joints[0].force];
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-6, "{a:?} {b:?}");
        }
        // the weld carries the weight of the right half at rest: force and moment at its point
        let first = &welded.samples[0].joints[1];
        assert!(first.force[1].abs() > 0.1 && first.moment.abs() > 1e-3, "{first:?}");
    }
}

#[test]
fn a_crank_that_swings_has_the_torque_of_newton_and_euler() {
    let drive = "[drives.d]\njoint = \"O\"\nkind = \"harmonic\"\nmean = 0.4\namplitude = 0.7\n\
                 angular_frequency = 21.0\nphase = 0.3\n";
    let inertia = 0.015 + 0.5 * 0.09;
    for kept in runs(&format!("{PIVOT}{drive}")) {
        let angle = |t: f64| 0.4 + 0.7 * (21.0 * t + 0.3).cos();
        let bend = |t: f64| -0.7 * 441.0 * (21.0 * t + 0.3).cos();
        let rate = |t: f64| -0.7 * 21.0 * (21.0 * t + 0.3).sin();
        assert_is(&kept, "angle", |s| body(s, 0).angle, angle);
        assert_is(&kept, "acceleration", |s| body(s, 0).angular_acceleration, bend);
        assert_is(&kept, "torque", |s| s.drive_torques[0], |t| inertia * bend(t));
        assert_is(&kept, "x", |s| body(s, 0).position[0], |t| 0.3 * angle(t).cos());
        let x_bend = |t: f64| -0.3 * (bend(t) * angle(t).sin() + rate(t).powi(2) * angle(t).cos());
        assert_is(&kept, "ẍ", |s| body(s, 0).acceleration[0], x_bend);
        assert_is(&kept, "force", |s| s.joints[0].force[0], |t| 0.5 * x_bend(t));
        assert_is(&kept, "balance", |s| s.energy.residual, |_| 0.0);
    }
}

#[test]
fn a_ramp_ends_at_its_speed_and_the_work_is_the_energy() {
    let drive = "[drives.d]\njoint = \"O\"\nkind = \"ramp\"\nspeed_rpm = 600.0\ntime = 0.213\n\
                 angle = 0.1\n";
    let speed = 600.0 * PI / 30.0;
    for kept in runs(&format!("{PIVOT}{drive}")) {
        let x = |t: f64| (t / 0.213).min(1.0);
        let rate = |t: f64| speed * x(t).powi(3) * (10.0 - 15.0 * x(t) + 6.0 * x(t).powi(2));
        assert_is(&kept, "rate", |s| body(s, 0).angular_velocity, rate);
        let angle = |t: f64| {
            let gone = x(t).powi(4) * (2.5 - 3.0 * x(t) + x(t).powi(2));
            0.1 + speed * (0.213 * gone + (t - 0.213).max(0.0))
        };
        assert_is(&kept, "angle", |s| body(s, 0).angle, angle);
        let energy = |t: f64| 0.5 * (0.015 + 0.045) * rate(t).powi(2);
        assert_is(&kept, "work", |s| s.energy.drive_work, energy);
        assert_eq!(kept.events, [changes(0.213, Owner::Drive(0))]);
    }
}

/// The event that a course's corner is.
fn changes(time: f64, owner: Owner) -> Event {
    Event { time, owner, kind: EventKind::CourseChanges, rate: 0.0 }
}

#[test]
fn corners_of_what_is_prescribed_are_events_of_its_drive_or_load() {
    // a wheel that a torque turns, beside a rod that a drive turns
    let rest = "[bodies.wheel]\nmass = 1.0\ninertia = 0.02\npoints = { C = [0.0, 0.0] }\n\
        [joints.W]\nkind = \"revolute\"\nbetween = [\"ground.P\", \"wheel.C\"]\n\
        [loads.steady]\nkind = \"torque\"\nbody = \"wheel\"\ntorque = 0.1\n\
        [loads.growing]\nkind = \"torque\"\nbody = \"wheel\"\n\
        torque = { kind = \"table\", times = [0.0, 0.02, 0.04, 0.1, 0.2, 0.3, 8.0, 9.0, 10.0], \
        values = [0.0, 0.0, 0.1, 0.1, 0.4, 0.2, 0.1, 0.0, 0.0] }\n\
        [start]\nwheel = { angle = 0.0, fixed = true }\n\
        [drives.d]\njoint = \"O\"\nkind = \"ramp\"\nspeed_rpm = 60.0\ntime = 0.05\n";
    for kept in runs(&format!("{PIVOT}{rest}")) {
        let knots = [0.1, 0.2, 0.3].map(|time| changes(time, Owner::Load(1)));
        let mut expected = vec![changes(0.05, Owner::Drive(0))];
        expected.extend(knots.iter().filter(|knot| knot.time < kept.last().time));
        assert!(expected.len() > 2);
        assert_eq!(kept.events, expected);
    }
}

#[test]
fn a_slide_that_is_driven_takes_the_force_of_newton() {
    let slide = "[joints.g]\nkind = \"prismatic\"\nbetween = [\"ground.P\", \"rod.C\"]\n\
                 axis = [3.0, 4.0]\nangle = 0.2\n[start]\nrod = { x = 0.36, y = 0.18, angle = 0.2 }\n\
                 [drives.d]\njoint = \"g\"\nkind = \"harmonic\"\nmean = 0.1\namplitude = 0.05\n\
                 angular_frequency = 30.0\n";
    for kept in runs(slide) {
        let travel = |t: f64| 0.1 + 0.05 * (30.0 * t).cos();
        let bend = |t: f64| -45.0 * (30.0 * t).cos();
        assert_is(&kept, "x", |s| body(s, 0).position[0], |t| 0.3 + 0.6 * travel(t));
        assert_is(&kept, "y", |s| body(s, 0).position[1], |t| 0.1 + 0.8 * travel(t));
        assert_is(&kept, "angle", |s| body(s, 0).angle, |_| 0.2);
        assert_is(&kept, "force", |s| s.drive_torques[0], |t| 0.5 * bend(t));
        assert_is(&kept, "balance", |s| s.energy.residual, |_| 0.0);
    }
    let steady = slide.replace(
        "kind = \"harmonic\"\nmean = 0.1\namplitude = 0.05\nangular_frequency = 30.0\n",
        "velocity = 0.7\nposition = 0.1\n",
    );
    for kept in runs(&steady) {
        assert_is(&kept, "x", |s| body(s, 0).position[0], |t| 0.3 + 0.6 * (0.1 + 0.7 * t));
    }
}

#[test]
fn torques_and_forces_do_the_work_that_their_bodies_have() {
    let torque = "[loads.m]\nkind = \"torque\"\nbody = \"rod\"\n\
        torque = { kind = \"harmonic\", amplitude = 0.8, angular_frequency = 11.0 }\n";
    let inertia = 0.015 + 0.5 * 0.09;
    for kept in runs(&format!("{PIVOT}{torque}[start]\nrod = {{ angle = 0.0, fixed = true }}\n")) {
        let rate = |t: f64| 0.8 / inertia / 11.0 * (11.0 * t).sin();
        assert_is(&kept, "rate", |s| body(s, 0).angular_velocity, rate);
        assert_is(
            &kept,
            "angle",
            |s| body(s, 0).angle,
            |t| 0.8 / inertia / 121.0 * (1.0 - (11.0 * t).cos()),
        );
        let energy = |t: f64| 0.5 * inertia * rate(t).powi(2);
        assert_is(&kept, "work", |s| s.energy.load_work, energy);
    }
    // a force that turns with its body, across the arm: a constant torque about the pivot
    let along = "[loads.f]\nkind = \"force\"\nat = \"rod.E\"\nframe = \"body\"\n\
        direction = [0.0, 5.0]\nmagnitude = 0.25\n";
    let start = "[start]\nrod = { angle = 0.0, fixed = true }\n";
    for kept in runs(&format!("{PIVOT}{along}{start}")) {
        let bend = 0.25 * 0.6 / inertia;
        assert_is(&kept, "angle", |s| body(s, 0).angle, |t| 0.5 * bend * t * t);
        assert_is(&kept, "balance", |s| s.energy.residual, |_| 0.0);
    }
    // the same twice: fixed in space, on a free body, written as a whole
    let fixed = "[loads.f]\nkind = \"force\"\nat = \"rod.C\"\nforce = [0.3, -0.4]\n\
        [start]\nrod = { x = 0.0, y = 0.0, fixed = true }\n";
    for kept in runs(fixed) {
        assert_is(&kept, "x", |s| body(s, 0).position[0], |t| 0.3 * t * t);
        assert_is(&kept, "y", |s| body(s, 0).position[1], |t| -0.4 * t * t);
    }
}

#[test]
fn what_does_not_belong_to_a_kind_is_told_with_its_key() {
    let gear = "[bodies.b]\nmass = 1.0\ninertia = 1.0\n[joints.m]\nkind = \"gear\"\n\
                between = [\"rod\", \"b\"]\nratio = -1.0\n";
    let cases: [(String, &str); 9] = [
        (
            "[joints.s]\nkind = \"distance\"\nbetween = [\"ground.O\", \"rod.C\"]\nlength = 0\n"
                .into(),
            "joints.s.length: must be positive (m), is 0",
        ),
        (
            "[joints.s]\nkind = \"prismatic\"\nbetween = [\"ground.O\", \"rod.C\"]\n".into(),
            "joints.s.axis: is missing",
        ),
        (
            "[joints.s]\nkind = \"pin-slot\"\nbetween = [\"ground.O\", \"rod.C\"]\naxis = [0, 0]\n"
                .into(),
            "joints.s.axis: must be positive in length, is 0",
        ),
        (format!("{gear}ratio2 = 1\n"), "joints.m.ratio2: unknown key (did you mean \"ratio\"?)"),
        (
            format!("{gear}[drives.d]\njoint = \"m\"\nspeed_rpm = 1\n"),
            "drives.d.joint: joint \"m\" is \"gear\", which has nothing to drive",
        ),
        (
            format!("{PIVOT}[drives.d]\njoint = \"O\"\nvelocity = 1\n"),
            "drives.d.speed_rpm: is missing",
        ),
        (
            "[loads.t]\nkind = \"torque\"\nbody = \"rot\"\ntorque = 1\n".into(),
            "loads.t.body: there is no body \"rot\" (did you mean \"rod\"?)",
        ),
        (
            "[loads.t]\nkind = \"force\"\nat = \"rod.C\"\nmagnitude = 1\n".into(),
            "loads.t.direction: is missing beside `magnitude`",
        ),
        (
            "[loads.t]\nkind = \"torque\"\nbody = \"rod\"\ntorque = { kind = \"harmonie\" }\n"
                .into(),
            "loads.t.torque.kind: must be one of",
        ),
    ];
    for (rest, told) in cases {
        let path = std::path::Path::new("case.toml");
        let changes = freeplay::case::Changes::default();
        let read = freeplay::case::Case::from_text(path, &with_body(&rest), &changes);
        let mut words = String::new();
        let mut cause: Option<&dyn std::error::Error> = read.as_ref().err().map(|error| error as _);
        while let Some(error) = cause {
            words = format!("{words}\n{error}");
            cause = error.source();
        }
        assert!(words.contains(told), "{rest}\n{words}");
    }
}

#[test]
fn windows_of_samples_show_the_same_run() {
    let wrist = "tests/kinds/slider-crank-wrist-pin.toml";
    let window =
        "run.window=[{from=0.0011,to=0.0013,interval=1e-7},{from=0.002,to=0.0021,interval=3e-7}]";
    for engine in ENGINES {
        let set = [engine, "run.duration=0.003", "run.sample_interval=1e-5"];
        let plain = simulate(&case(wrist, &set));
        for sampling in ["run.sampling=uniform", "run.sampling=adaptive"] {
            let windowed = simulate(&case(wrist, &[&set[..], &[window, sampling]].concat()));
            assert!(windowed.samples.windows(2).all(|pair| pair[0].time < pair[1].time));
            for k in 11_000..=13_000 {
                let sample = windowed.at(format!("{k}e-7").parse().unwrap());
                let of_grid = (k % 100 == 0).then(|| plain.at(sample.time));
                assert!(of_grid.is_none_or(|same| same.bodies == sample.bodies), "{k}");
            }
            for k in 6667..=7000 {
                windowed.at(format!("{}e-7", 3 * k).parse().unwrap());
            }
            let outside = |s: &&Observation| s.time < 0.0011;
            if sampling == "run.sampling=uniform" {
                assert_eq!(windowed.samples.iter().filter(outside).count(), 110);
                assert_eq!(windowed.samples.len(), 301 + 2001 - 21 + 334 - 11 + 1);
            }
        }
    }
}

/// Numbers as an array of TOML.
fn array(numbers: impl Iterator<Item = f64>) -> String {
    format!("[{}]", numbers.map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", "))
}

const INERTIA: f64 = 0.015 + 0.5 * 0.09;

#[test]
fn a_crank_that_follows_a_table_has_the_torque_of_newton_and_euler() {
    // a polynomial of the fifth degree is its own spline
    let angle = |t: f64| 0.3 + t * (2.0 + t * (-3.0 + t * (10.0 + t * (-30.0 + t * 24.0))));
    let rate = |t: f64| 2.0 + t * (-6.0 + t * (30.0 + t * (-120.0 + t * 120.0)));
    let bend = |t: f64| -6.0 + t * (60.0 + t * (-360.0 + t * 480.0));
    let times = || (0..=13).map(|k| -0.05 + 0.6 * f64::from(k) / 13.0);
    let drive = format!(
        "{PIVOT}[drives.d]\njoint = \"O\"\nkind = \"table\"\ntimes = {}\nvalues = {}\n",
        array(times()),
        array(times().map(angle))
    );
    for kept in runs(&drive) {
        assert_is(&kept, "angle", |s| body(s, 0).angle, angle);
        assert_is(&kept, "rate", |s| body(s, 0).angular_velocity, rate);
        assert_is(&kept, "torque", |s| s.drive_torques[0], |t| INERTIA * bend(t));
        assert_is(&kept, "balance", |s| s.energy.residual, |_| 0.0);
    }
}

#[test]
fn a_torque_by_a_table_keeps_its_ends() {
    // 0.4 until 0.1 s, then a line to −0.2 at 0.3 s
    let load = "[loads.m]\nkind = \"torque\"\nbody = \"rod\"\n\
        torque = { kind = \"table\", times = [0.1, 0.3], values = [0.4, -0.2] }\n\
        [start]\nrod = { angle = 0.0, fixed = true }\n";
    let gone = |t: f64| [t - 0.1, t - 0.3].map(|t| t.max(0.0));
    let rate = |t: f64| {
        let [from, to] = gone(t);
        (0.4 * t - 1.5 * (from.powi(2) - to.powi(2))) / INERTIA
    };
    let angle = |t: f64| {
        let [from, to] = gone(t);
        (0.2 * t * t - 0.5 * (from.powi(3) - to.powi(3))) / INERTIA
    };
    for kept in runs(&format!("{PIVOT}{load}")) {
        assert_is(&kept, "rate", |s| body(s, 0).angular_velocity, rate);
        assert_is(&kept, "angle", |s| body(s, 0).angle, angle);
        assert_is(&kept, "work", |s| s.energy.load_work, |t| 0.5 * INERTIA * rate(t).powi(2));
    }
    let octuple = [
        ENGINES[0],
        "solver.precision=71",
        "solver.reference_tolerance=1e-40",
        "run.sample_interval=0.1",
    ];
    let exact = simulate(&case_of(&with_body(&format!("{PIVOT}{load}")), &octuple));
    let off = body(exact.last(), 0).angle / angle(0.5) - 1.0;
    assert!(off.abs() < 1e-15, "{off:e}");
}

#[test]
fn a_table_stands_in_a_file_beside_the_case_or_in_the_case() {
    let folder = tempfile::tempdir().unwrap();
    let beside = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let text = with_body(&format!(
        "{PIVOT}[drives.d]\njoint = \"O\"\nkind = \"table\"\nfile = \"motion.csv\"\n"
    ));
    let path = beside("case.toml", &text);
    let read = |set: &[&str]| {
        let set = set.iter().map(|change| change.parse().unwrap()).collect();
        freeplay::case::Case::read(&path, &freeplay::case::Changes { set, ideal: false })
    };
    let told = || read(&[]).unwrap_err().to_string();
    assert!(told().contains("drives.d.file: cannot read"), "{}", told());
    for (wrong, words) in [
        ("0, 1\n2, x\n", "drives.d.file: line 2 of motion.csv must be 2 numbers, times and values"),
        ("t, f\n0, 1\n# none\n1; 2; 3\n", "line 4 of motion.csv"),
        ("0, 1\n1, 2\n0.5, 1\n", "drives.d.times: must increase, number 3 is 0.5"),
        ("0, 1\n", "drives.d.times: must be two or more, are 1"),
        ("0, 0\n0.2, 1\n", "drives.d.times: end at 0.2 s, and the run ends at 0.5 s"),
        ("0.1, 0\n0.7, 1\n", "drives.d.times: begin at 0.1 s"),
    ] {
        beside("motion.csv", wrong);
        assert!(told().contains(words), "{wrong:?}: {}", told());
    }
    beside(
        "motion.csv",
        "time,angle\n# s, rad\n0,.5\n +0.25 ; 1.\n\n1e0\t2.000000000000000000001\n",
    );
    let case = read(&[]).unwrap();
    assert!(case.text.contains("2.000000000000000000001") && !case.text.contains("motion.csv"));
    // what was run needs no file
    let again = case_of(&case.text, &[]);
    assert_eq!(again.description, case.description);
    beside("other.csv", "0 0\n1 3\n");
    let other = simulate(&read(&["drives.d.file=other.csv"]).unwrap());
    assert_is(&other, "angle", |s| body(s, 0).angle, |t| 3.0 * t);
    beside("case.toml", &text.replace("file =", "times = [0, 1]\nfile ="));
    assert!(told().contains("drives.d.file: times are given too"), "{}", told());
}

/// The rod's centre on a pin of 20 mm, and friction there.
fn rubbing(joint: &str, friction: &str) -> String {
    format!(
        "[joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"rod.{joint}\"]\n\
         [loads.rub]\nkind = \"joint-friction\"\njoint = \"O\"\npin_radius = 0.02\n{friction}\n"
    )
}

const DRY: &str = "friction = { law = \"tanh\", coefficient = 0.1, transition = 1e-3 }";

#[test]
fn a_rotor_on_a_dry_pin_slows_down_evenly() {
    for (preload, extra) in [(0.0, ""), (3.0, "preload = 3.0")] {
        let start = "[start]\nrod = { angle = 0.0, angular_velocity = 20.0, fixed = true }\n";
        let text = format!("{}{GRAVITY}{start}", rubbing("C", &format!("{DRY}\n{extra}")));
        let normal = (0.5_f64 * 9.81).hypot(preload);
        let rate = |t: f64| 20.0 - 0.1 * 0.02 * normal / 0.015 * t;
        for kept in runs(&text) {
            assert_is(&kept, "rate", |s| body(s, 0).angular_velocity, rate);
            let lost = |t: f64| 0.5 * 0.015 * (400.0 - rate(t).powi(2));
            assert_is(&kept, "dissipated", |s| s.energy.dissipated, lost);
            assert_is(&kept, "balance", |s| s.energy.residual, |_| 0.0);
            // the friction is no force of the joint
            assert_is(&kept, "moment", |s| s.joints[0].moment, |_| 0.0);
        }
    }
}

#[test]
fn friction_that_makes_the_force_which_makes_it_is_solved_with_it() {
    // without weight: N = m a √(ω⁴ + ω̇²),  I ω̇ = −μ r N
    let share = 0.1 * 0.02 * 0.5 * 0.3 / INERTIA;
    let share = share / (1.0_f64 - share * share).sqrt();
    let start = "[start]\nrod = { angle = 0.0, angular_velocity = 20.0, fixed = true }\n";
    let text = format!("{}{start}", rubbing("O", DRY));
    let rate = |t: f64| 20.0 / (1.0 + share * 20.0 * t);
    for kept in runs(&text) {
        assert_is(&kept, "rate", |s| body(s, 0).angular_velocity, rate);
        let bend = |t: f64| -share * rate(t).powi(2);
        assert_is(&kept, "acceleration", |s| body(s, 0).angular_acceleration, bend);
        assert!(kept.largest(|s| s.energy.residual) < 1e-10 * 12.0);
    }
    let octuple = [ENGINES[0], "solver.precision=71", "solver.reference_tolerance=1e-40"];
    let exact = simulate(&case_of(&with_body(&text), &octuple));
    let off = body(exact.last(), 0).angular_velocity / rate(0.5) - 1.0;
    assert!(off.abs() < 1e-15, "{off:e}");
    // a drive bears the friction too: 2π rad/s, whatever the angle
    let drive = "[drives.d]\njoint = \"O\"\nspeed_rpm = 60.0\n";
    let turning = 2.0 * PI;
    let normal = 0.5 * 0.3 * turning * turning;
    for kept in runs(&format!("{}{drive}", rubbing("O", DRY))) {
        assert_is(&kept, "torque", |s| s.drive_torques[0], |_| 0.1 * 0.02 * normal);
        assert_is(&kept, "work", |s| s.energy.dissipated, |t| 0.1 * 0.02 * normal * turning * t);
        assert_is(&kept, "balance", |s| s.energy.residual, |_| 0.0);
    }
    // and where it makes more force than bears it, it jams
    let jammed = text.replace("pin_radius = 0.02", "pin_radius = 5.0");
    for engine in ENGINES {
        let case = case_of(&with_body(&jammed), &[engine]);
        let told = freeplay::simulate::Simulation::new(&case).map(|_| ());
        let told = told.map_err(|error| simulated::words(&error)).unwrap_err();
        assert!(told.contains("jams"), "{told}");
    }
}

#[test]
fn a_block_on_an_incline_with_dry_friction_slides_evenly() {
    let slide = "[joints.g]\nkind = \"prismatic\"\nbetween = [\"ground.O\", \"rod.C\"]\n\
        axis = [4.0, -3.0]\n[loads.rub]\nkind = \"joint-friction\"\njoint = \"g\"\n\
        friction = { law = \"tanh\", coefficient = 0.2, transition = 1e-3 }\n\
        [start]\nrod = { x = 0.0, y = 0.0, velocity_x = 1.6, fixed = true }\n";
    let pull = 9.81 * (0.6 - 0.2 * 0.8);
    for kept in runs(&format!("{slide}{GRAVITY}")) {
        assert_is(&kept, "x", |s| body(s, 0).position[0], |t| 0.8 * (2.0 * t + 0.5 * pull * t * t));
        assert_is(&kept, "balance", |s| s.energy.residual, |_| 0.0);
    }
}

#[test]
fn a_controlled_speed_follows_its_linear_equation() {
    let servo = "[joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"rod.C\"]\n\
        [loads.servo]\nkind = \"speed-controller\"\njoint = \"O\"\nspeed_rpm = 60.0\n\
        proportional = 0.2\nintegral = 3.0\n[start]\nrod = { angle = 0.0, fixed = true }\n";
    // e' = −(K_p e + K_i z)/I, z' = e
    let (speed, decay) = (2.0 * PI, 0.5 * 0.2 / 0.015);
    let swing = (3.0_f64 / 0.015 - decay * decay).sqrt();
    let off = |t: f64| {
        speed * (-decay * t).exp() * ((swing * t).cos() - decay / swing * (swing * t).sin())
    };
    for kept in runs(servo) {
        assert_is(&kept, "rate", |s| body(s, 0).angular_velocity, |t| speed - off(t));
        let energy = |t: f64| 0.5 * 0.015 * (speed - off(t)).powi(2);
        assert_is(&kept, "work", |s| s.energy.load_work, energy);
    }
    let octuple = [ENGINES[0], "solver.precision=71", "solver.reference_tolerance=1e-40"];
    let exact = simulate(&case_of(&with_body(servo), &octuple));
    let apart = body(exact.last(), 0).angular_velocity / (speed - off(0.5)) - 1.0;
    assert!(apart.abs() < 1e-15, "{apart:e}");
    // with a limit and no integral: sinh(u/L) falls as an exponential
    let limited = servo.replace("integral = 3.0", "limit = 0.1");
    let left = |t: f64| {
        let sinh = (0.2 * speed / 0.1).sinh() * (-0.2 / 0.015 * t).exp();
        0.1 * sinh.asinh() / 0.2
    };
    for kept in runs(&limited) {
        assert_is(&kept, "rate", |s| body(s, 0).angular_velocity, |t| speed - left(t));
    }
}

#[test]
fn a_piston_on_a_gas_whose_pressure_falls_evenly_swings() {
    let gas = "[joints.g]\nkind = \"prismatic\"\nbetween = [\"ground.O\", \"rod.C\"]\n\
        axis = [0.6, 0.8]\n[loads.gas]\nkind = \"gas-force\"\njoint = \"g\"\narea = 0.01\n\
        positions = [0.0, 0.1, 0.2, 0.25, 0.3, 0.5, 0.6, 0.7]\n\
        pressures = [1500.0, 1000.0, 500.0, 250.0, 0.0, -1000.0, -1500.0, -2000.0]\n\
        [start]\nrod = { x = 0.12, y = 0.16, velocity_x = 0.0, fixed = true }\n";
    // 0.5 ẍ = 0.01 (1500 − 5000 x)
    let travel = |t: f64| 0.3 - 0.1 * (10.0 * t).cos();
    for kept in runs(gas) {
        assert_is(&kept, "x", |s| body(s, 0).position[0], |t| 0.6 * travel(t));
        let energy = |t: f64| 0.25 * (10.0 * t).sin().powi(2);
        assert_is(&kept, "work", |s| s.energy.load_work, energy);
        assert_is(&kept, "balance", |s| s.energy.residual, |_| 0.0);
    }
}

#[test]
fn a_wheel_rolls_on_a_rack_with_the_inertia_of_both_motions() {
    let wheel = "[joints.rail]\nkind = \"pin-slot\"\nbetween = [\"ground.O\", \"rod.C\"]\n\
        axis = [1.0, 0.0]\n[joints.teeth]\nkind = \"rack\"\nbetween = [\"ground.O\", \"rod.C\"]\n\
        axis = [1.0, 0.0]\nradius = -0.2\ntravel = 0.05\n[loads.push]\nkind = \"force\"\n\
        at = \"rod.C\"\nforce = [1.5, 0.0]\n[start]\nrod = { x = 0.05, y = 0.0, angle = 0.0 }\n";
    let pull = 1.5 / (0.5 + 0.015 / 0.04);
    for kept in runs(wheel) {
        assert_is(&kept, "x", |s| body(s, 0).position[0], |t| 0.05 + 0.5 * pull * t * t);
        assert_is(&kept, "angle", |s| body(s, 0).angle, |t| -2.5 * pull * t * t);
        let force = |s: &Observation| s.joints[1].force[0] + 1.5 - 0.5 * pull;
        assert_is(&kept, "teeth", force, |_| 0.0);
    }
}

/// A case that `freeplay new` writes, without its clearances.
fn new_case(kind: &str, set: &[&str]) -> freeplay::case::Case {
    let path = root().join("cases").join(kind).with_extension("toml");
    let set = set.iter().map(|change| change.parse().unwrap()).collect();
    let ideal = freeplay::case::Changes { set, ideal: true };
    simulated::told(freeplay::case::Case::read(&path, &ideal))
}

#[test]
fn a_new_scotch_yoke_and_a_new_quick_return_move_by_their_closed_forms() {
    let yoke = simulate(&new_case("scotch-yoke", &[]));
    assert_is(&yoke, "x", |s| body(s, 1).position[0], |t| 0.05 * (20.0 * PI * t).cos());
    let quick = simulate(&new_case("quick-return", &[]));
    let pin = |t: f64| [0.05 * (2.0 * PI * t).cos(), 0.2 + 0.05 * (2.0 * PI * t).sin()];
    assert_is(&quick, "lever", |s| body(s, 0).angle, |t| pin(t)[1].atan2(pin(t)[0]));
    assert_is(&quick, "ram", |s| body(s, 2).position[0], |t| 0.4 * pin(t)[0] / pin(t)[1]);
    // forth and back take as long as the crank is beyond and within its tangents
    let [back, forth]: [Vec<_>; 2] = [1.0, -1.0]
        .map(|sign| quick.samples.iter().filter(|s| sign * body(s, 2).velocity[0] > 0.0).collect());
    let tangent = 0.25_f64.acos();
    let ratio = (PI - tangent) / tangent;
    let found = forth.len() as f64 / back.len() as f64;
    assert!((found / ratio - 1.0).abs() < 0.05, "{found} {ratio}");
}

#[test]
fn a_new_five_bar_closes_above_its_cranks() {
    let kept = simulate(&new_case("five-bar", &[]));
    let swing = |t: f64| PI / 2.0 + 0.4 * (4.0 * PI * t - PI / 2.0).cos();
    let closed = |t: f64| {
        let a = [0.1 * (4.0 * PI * t).cos(), 0.1 * (4.0 * PI * t).sin()];
        let b = [0.3 + 0.1 * swing(t).cos(), 0.1 * swing(t).sin()];
        let way = [b[0] - a[0], b[1] - a[1]];
        let half = 0.5 * way[0].hypot(way[1]);
        let up = (0.09 - half * half).sqrt() / (2.0 * half);
        [0.5 * (a[0] + b[0]) - up * way[1], 0.5 * (a[1] + b[1]) + up * way[0]]
    };
    let end = |s: &Observation, k: usize| {
        let BodyObservation { position: [x, y], angle, .. } = body(s, k);
        [x + 0.15 * angle.cos(), y + 0.15 * angle.sin()]
    };
    for axis in 0..2 {
        for rod in [2, 3] {
            assert_is(&kept, "C", |s| end(s, rod)[axis], |t| closed(t)[axis]);
        }
    }
    assert!(kept.largest(|s| s.energy.residual) < 1e-8 * kept.largest(|s| s.energy.kinetic));
}

#[test]
fn a_new_planetary_gear_obeys_willis_and_its_spring() {
    // J r̈ + d ṙ + k r = −2 · 3/4 for the ring once the sun goes evenly
    let inertia = 5e-3 + 9.0 / 16.0 * (2e-3 + 0.3 * 0.04 * 0.04) + 2.25 * 6e-5;
    for engine in ENGINES {
        let set = [engine, "solver.absolute_tolerance=scaled", "run.sample_interval=1e-2"];
        let kept = simulate(&new_case("planetary-gear", &set));
        for sample in &kept.samples {
            let [sun, carrier, planet, ring] = [0, 1, 2, 3].map(|k| body(sample, k));
            let willis = 4.0 * carrier.angle - 3.0 * ring.angle - sun.angle;
            assert!(willis.abs() < 1e-11 * (1.0 + sun.angle), "{willis:e}");
            let rolling = planet.angle - 2.0 * carrier.angle + sun.angle;
            assert!(rolling.abs() < 1e-11 * (1.0 + sun.angle), "{rolling:e}");
            let pull = 40.0 * ring.angle + 0.05 * ring.angular_velocity + 1.5;
            if sample.time > 0.1 {
                let off = inertia * ring.angular_acceleration + pull;
                assert!(off.abs() < 1e-9, "{off:e} at {}", sample.time);
            }
        }
        assert!(kept.largest(|s| s.energy.residual) < 1e-9 * kept.largest(|s| s.energy.kinetic));
    }
}

#[test]
fn a_new_press_keeps_its_energy_and_its_geometry() {
    for engine in ENGINES {
        let set = [engine, "solver.absolute_tolerance=scaled"];
        let kept = simulate(&new_case("press", &set));
        for sample in &kept.samples {
            let (sin, cos) = body(sample, 0).angle.sin_cos();
            let off = body(sample, 2).position[1] - 0.08 * sin + (0.16 - 0.0064 * cos * cos).sqrt();
            assert!(off.abs() < 1e-12, "{off:e}");
        }
        assert!(kept.largest(|s| s.energy.load_work) > 10.0);
        assert!(kept.largest(|s| s.energy.dissipated) > 0.1);
        let kinetic = kept.largest(|s| s.energy.kinetic);
        assert!(kept.largest(|s| s.energy.residual) < 1e-8 * kinetic, "{engine}");
    }
}

#[test]
fn a_new_crank_comes_to_the_speed_that_its_controller_is_asked_for() {
    for engine in ENGINES {
        let set = [engine, "solver.absolute_tolerance=scaled", "run.duration=0.3"];
        let kept = simulate(&new_case("speed-controller", &set));
        let late: Vec<f64> = kept
            .samples
            .iter()
            .filter(|s| s.time > 0.26)
            .map(|s| body(s, 0).angular_velocity)
            .collect();
        let mean = late.iter().sum::<f64>() / late.len() as f64;
        assert!((mean / (50.0 * PI) - 1.0).abs() < 0.05, "{mean}");
        let kinetic = kept.largest(|s| s.energy.kinetic);
        assert!(kept.largest(|s| s.energy.residual) < 1e-8 * kinetic, "{engine}");
    }
}

#[test]
fn a_new_manipulator_stands_where_its_motors_have_it() {
    let with_clearance = case("cases/three-rrr.toml", &["run.duration=0.02"]);
    for (kept, allowed) in
        [(simulate(&new_case("three-rrr", &[])), 1e-12), (simulate(&with_clearance), 1.1e-4)]
    {
        let mut largest = 0.0_f64;
        for sample in &kept.samples {
            let BodyObservation { position: [x, y], angle, .. } = body(sample, 6);
            for leg in 0..3 {
                let crank = body(sample, 2 * leg);
                let elbow = [0, 1].map(|axis| {
                    let along = [crank.angle.cos(), crank.angle.sin()][axis];
                    crank.position[axis] + 0.06 * along
                });
                let place = angle + [7.0 / 6.0, -1.0 / 6.0, 0.5][leg] * PI;
                let joint = [x + 0.06 * place.cos(), y + 0.06 * place.sin()];
                let length = (joint[0] - elbow[0]).hypot(joint[1] - elbow[1]);
                largest = largest.max((length - 0.16).abs());
            }
        }
        // the case has the platform's points to 1e-6 m
        assert!(largest < allowed + 1e-6, "{largest:e}");
        assert!(allowed < 1e-6 || largest > 1e-5, "{largest:e}");
    }
}

#[test]
fn both_engines_agree_where_every_load_acts() {
    let [explicit, ida] =
        ENGINES.map(|engine| simulate(&case("tests/kinds/loads.toml", &[engine])));
    for (one, other) in explicit.samples.iter().zip(&ida.samples) {
        for (a, b) in one.bodies.iter().zip(&other.bodies) {
            let off = (a.angle - b.angle).abs() + (a.position[0] - b.position[0]).abs();
            assert!(off < 1e-9, "{off:e} at {}", one.time);
        }
    }
    let kinetic = explicit.largest(|s| s.energy.kinetic);
    for kept in [&explicit, &ida] {
        assert!(kept.largest(|s| s.energy.residual) < 1e-9 * kinetic);
    }
    let exact = [
        "solver.engine=explicit",
        "solver.precision=71",
        "run.duration=0.02",
        "run.sample_interval=0.01",
        "solver.reference_tolerance=1e-22",
    ];
    let exact = simulate(&case("tests/kinds/loads.toml", &exact));
    for (one, truth) in explicit.samples.iter().zip(&exact.samples) {
        for (a, b) in one.bodies.iter().zip(&truth.bodies) {
            assert!((a.angle - b.angle).abs() < 1e-12, "{} {}", a.angle, b.angle);
        }
    }
}

#[test]
fn journals_that_start_closed_lie_where_the_ideal_mechanism_presses_them() {
    let ideal = simulate(&case("cases/four-bar-ideal.toml", &["run.duration=1e-5"]));
    for joints in [vec![("four-bar-a", 1)], vec![("four-bar-b", 1), ("four-bar-b", 2)]] {
        let path = format!("cases/{}.toml", joints[0].0);
        for how in ["true", "\"pressed\""] {
            for engine in ENGINES {
                let closed = format!("start.closed={how}");
                let set = [engine, &closed, "run.duration=1e-5"];
                let kept = simulate(&case(&path, &set));
                for (k, (_, joint)) in joints.iter().enumerate() {
                    let [x, y] = ideal.samples[0].joints[*joint].force;
                    let size = x.hypot(y);
                    let journal = &kept.samples[0].clearances[k];
                    let along = -(journal.offset[0] * x + journal.offset[1] * y) / size;
                    let across = (journal.offset[0] * y - journal.offset[1] * x) / size;
                    assert!(across.abs() < 1e-12, "{path}, {how}: {across:e}");
                    if how == "true" {
                        assert!((along - 1e-3).abs() < 1e-12, "{path}: {along:e}");
                    } else {
                        let found = journal.normal_force / size;
                        assert!((found - 1.0).abs() < 1e-6, "{path}: {found}");
                        assert_eq!(kept.contacts[k].begin, 0.0);
                    }
                }
            }
        }
    }
    let path = std::path::Path::new("case.toml");
    for (wrong, told) in [
        ("closed = \"shut\"", "start.closed: must be true, false or \"pressed\", is \"shut\""),
        ("closd = true", "start.closd: must be a table, is true or false"),
    ] {
        let text = with_body(&format!("{PIVOT}[start]\n{wrong}\n"));
        let changes = freeplay::case::Changes::default();
        let error = freeplay::case::Case::from_text(path, &text, &changes).unwrap_err();
        assert!(error.to_string().contains(told), "{error}");
    }
}

/// A slider-crank with a point beside its rod's line, and what is observed of it.
const OBSERVED: [&str; 2] = [
    "bodies.rod.points.P=[0.03, 0.02]",
    "observe.points=[\"rod.P\", \"rod.A\", \"slider.B\", \"ground.O\"]",
];

/// Position, velocity and acceleration of rod.P: at 0.09 m along the rod from the crank's pin, 0.02 m
/// beside it.
fn beside_the_rod(t: f64) -> [[f64; 2]; 3] {
    let (r, l, w) = (0.05, 0.12, 5000.0 * PI / 30.0);
    let (sin, cos) = (w * t).sin_cos();
    // l sin φ = −r sin ωt, and its derivatives
    let (s, c) = ((-r / l * sin), (1.0 - (r / l * sin).powi(2)).sqrt());
    let rate = -r / l * w * cos / c;
    let bend = (r / l * w * w * sin + rate * rate * s) / c;
    let arm = [c * 0.09 - s * 0.02, s * 0.09 + c * 0.02];
    [
        [r * cos + arm[0], r * sin + arm[1]],
        [-r * w * sin - rate * arm[1], r * w * cos + rate * arm[0]],
        [
            -r * w * w * cos - bend * arm[1] - rate * rate * arm[0],
            -r * w * w * sin + bend * arm[0] - rate * rate * arm[1],
        ],
    ]
}

#[test]
fn observed_points_of_a_slider_crank_move_by_the_closed_form() {
    let kept = simulate(&case("tests/kinds/slider-crank.toml", &OBSERVED));
    let w = 5000.0 * PI / 30.0;
    for sample in &kept.samples {
        let [beside, pin, slider, ground] = *sample.points else { panic!("four points") };
        let of = |point: freeplay::mechanism::PointObservation| {
            [point.position, point.velocity, point.acceleration]
        };
        let size = [0.1, 0.1 * w, 0.1 * w * w];
        for ((found, exact), size) in
            of(beside).into_iter().zip(beside_the_rod(sample.time)).zip(size)
        {
            let off = (found[0] - exact[0]).abs().max((found[1] - exact[1]).abs());
            assert!(off <= 1e-13 * size, "{} s: {found:?}, not {exact:?}", sample.time);
        }
        // the rod's end of the crank's pin is the crank's
        let (sin, cos) = (w * sample.time).sin_cos();
        let exact = [0.05 * cos, 0.05 * sin];
        assert!((0..2).all(|k| (pin.position[k] - exact[k]).abs() <= 1e-14));
        assert!((0..2).all(|k| (pin.acceleration[k] + w * w * exact[k]).abs() <= 1e-13 * size[2]));
        // a point that is the mass centre moves as that
        let body = body(sample, 2);
        assert_eq!(of(slider), [body.position, body.velocity, body.acceleration]);
        assert_eq!(of(ground), [[0.0; 2]; 3]);
    }
}

#[test]
fn observed_velocities_and_accelerations_are_the_derivatives_of_positions_on_both_engines() {
    let points = "observe.points=[\"rod.P\"]";
    let [pin, free] = ["bodies.rod.points.P=[0.03, 0.02]", "run.sample_interval=1e-6"];
    for engine in ENGINES {
        let set = [engine, points, pin, free, "run.duration=2e-4"];
        let kept = simulate(&case("tests/kinds/slider-crank-wrist-pin.toml", &set));
        let middle = |k: usize| kept.samples.get(k - 1..k + 2);
        let rows = (1..kept.samples.len()).filter_map(middle);
        let mut looked_at = 0;
        for rows in rows.filter(|rows| rows.iter().all(|row| !row.clearances[0].in_contact)) {
            let span = rows[2].time - rows[0].time;
            let slope = |of: fn(&freeplay::mechanism::PointObservation) -> [f64; 2], k: usize| {
                (of(&rows[2].points[0])[k] - of(&rows[0].points[0])[k]) / span
            };
            let (w, h) = (5000.0 * PI / 30.0, 0.5 * span);
            // h²/6 times a third derivative, which is ω³ r and as many harmonics, and rounding
            let allowed = 10.0 * h * h * w.powi(3) * 0.1 + 1e-16 / h;
            for k in 0..2 {
                let point = &rows[1].points[0];
                let [v, a] = [slope(|p| p.position, k), slope(|p| p.velocity, k)];
                assert!((v - point.velocity[k]).abs() <= allowed, "{engine} {v} {point:?}");
                let off = (a - point.acceleration[k]).abs();
                assert!(off <= allowed * w * 10.0 + 1e-14 / h, "{engine} {a} {point:?} {off:e}");
            }
            looked_at += 1;
        }
        assert!(looked_at > 20, "{looked_at} rows in flight");
    }
}

#[test]
fn observed_points_stand_in_files_tables_and_comparisons() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, set: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_freeplay"));
        command.args(["run", "tests/kinds/slider-crank.toml", "-o"]).arg(folder.path().join(name));
        command.args(set.iter().flat_map(|set| ["--set", set]));
        let output = command.current_dir(root()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        freeplay::record::ResultFile::open(&folder.path().join(name)).unwrap()
    };
    let says = |arguments: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_freeplay"));
        let output = command.args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let points: Vec<&str> =
        OBSERVED.into_iter().filter(|set| !set.starts_with("observe")).collect();
    assert!(!points.is_empty());
    let plain = run("plain.h5", &points);
    assert!(plain.points().is_empty() && plain.dataset("point_position_x").is_err());
    assert!(!says(&["info", "plain.h5"]).contains("point"));
    let observed = run("observed.h5", &OBSERVED);
    assert_eq!(observed.points(), ["rod.P", "rod.A", "slider.B", "ground.O"]);
    let times = observed.times().unwrap();
    let column = observed.column("point_acceleration_y.rod.P").unwrap();
    let exact = |time: f64| beside_the_rod(time)[2][1];
    assert!(times.iter().zip(&column).all(|(t, a)| (a - exact(*t)).abs() <= 1e-13 * 3e4));
    // what is read back is what was told
    let samples = observed.observations(0..times.len()).unwrap();
    assert!(samples.iter().zip(&column).all(|(row, a)| row.points[0].acceleration[1] == *a));
    let table = says(&["export", "observed.h5", "--to", "csv", "-o", "table.csv"]);
    assert!(table.contains("table.csv"), "{table}");
    let table = std::fs::read_to_string(folder.path().join("table.csv")).unwrap();
    assert!(table.contains("point_velocity_x.rod.P"), "{}", table.lines().next().unwrap());
    let told = says(&["compare", "observed.h5", "observed.h5"]);
    assert!(told.contains("velocity of point"), "{told}");
    // a comparison with a run that observes nothing, or of a table of points alone
    says(&["compare", "plain.h5", "observed.h5", "--require-digits", "15"]);
    let theirs: String =
        times.iter().map(|t| format!("{t:e},{:e}\n", beside_the_rod(*t)[0][0])).collect();
    std::fs::write(folder.path().join("theirs.csv"), format!("t,x\n{theirs}")).unwrap();
    let map = "x=point_position_x.rod.P";
    says(&["compare", "theirs.csv", "observed.h5", "--map", map, "--require-digits", "12"]);
}

#[test]
fn points_that_cannot_be_observed_are_told_with_their_key() {
    for (points, word) in [
        ("[\"rod.Q\"]", "has no point"),
        ("[\"rood.A\"]", "did you mean \"rod\""),
        ("[\"rod\"]", "body.point"),
        ("[\"rod.A\", \"rod.A\"]", "twice"),
        ("\"rod.A\"", "an array of strings"),
    ] {
        let text = std::fs::read_to_string(root().join("tests/kinds/slider-crank.toml")).unwrap();
        let changes = freeplay::case::Changes {
            set: vec![format!("observe.points={points}").parse().unwrap()],
            ideal: false,
        };
        let path = std::path::Path::new("case.toml");
        let error = freeplay::case::Case::from_text(path, &text, &changes).unwrap_err().to_string();
        assert!(error.contains(word) && error.contains("observe.points"), "{points}: {error}");
    }
}

#[test]
fn revolutions_of_a_drive_that_swings_are_its_periods() {
    let text = std::fs::read_to_string(root().join("cases/five-bar.toml")).unwrap();
    let swapped =
        text.replace("[drives.one]", "[drives.later]").replace("[drives.two]", "[drives.one]");
    for (drive, turn) in [(&text, 0.5), (&swapped, 2.0 * PI / 12.566370614359172)] {
        let mut document = drive.parse::<toml_edit::DocumentMut>().unwrap();
        // the drive that swings first
        if drive != &text {
            let drives = document["drives"].as_table_mut().unwrap();
            let later = drives.remove("later").unwrap();
            drives.insert("later", later);
        }
        let case = case_of(&document.to_string(), &["run.revolutions=2.5"]);
        let duration = case.plan.duration.to_f64();
        assert!((duration / (2.5 * turn) - 1.0).abs() < 1e-15, "{duration}");
        let kept = simulate(&case);
        assert_eq!(kept.last().time, duration);
    }
    // what never comes round has none
    for drive in [
        "kind=\"ramp\"\nspeed_rpm=1.0\ntime=1.0",
        "kind=\"table\"\ntimes=[0.0, 9.0]\nvalues=[0.0, 1.0]",
    ] {
        let text = text
            .replace("joint     = \"O1\"\nspeed_rpm = 120.0", &format!("joint=\"O1\"\n{drive}"));
        let changes = freeplay::case::Changes {
            set: vec!["run.revolutions=2".parse().unwrap()],
            ideal: false,
        };
        let path = std::path::Path::new("case.toml");
        let error = freeplay::case::Case::from_text(path, &text, &changes).unwrap_err().to_string();
        assert!(error.contains("run.revolutions") && error.contains("harmonic"), "{error}");
    }
}

/// A piston between gases whose pressure falls evenly from 0 to 0.7 m and is constant beyond: swings
/// with 10 rad/s about 0.3 m inside, parabolas outside.
const BEYOND: &str = "[joints.g]\nkind = \"prismatic\"\nbetween = [\"ground.O\", \"rod.C\"]\n\
    axis = [1.0, 0.0]\n[loads.gas]\nkind = \"gas-force\"\njoint = \"g\"\narea = 0.01\n\
    positions = [0.0, 0.1, 0.2, 0.25, 0.3, 0.5, 0.6, 0.7]\n\
    pressures = [1500.0, 1000.0, 500.0, 250.0, 0.0, -1000.0, -1500.0, -2000.0]\n";

/// Travel and velocity of that piston, which passes the middle at 5 m/s at t = 0.
fn beyond(time: f64) -> [f64; 2] {
    // it leaves at sin = 4/5 with 3 m/s, braked by 40 m/s², and at sin = −3/5 with 4 m/s by 30 m/s²
    let (up, down) = (0.8_f64.asin() / 10.0, 0.6_f64.asin() / 10.0);
    let spans = [up, 0.15, up + down, 8.0 / 30.0, down];
    let mut left = time % spans.iter().sum::<f64>();
    let swing = |phase: f64| [0.3 + 0.5 * phase.sin(), 5.0 * phase.cos()];
    let thrown = |x: f64, v: f64, a: f64, t: f64| [x + v * t + 0.5 * a * t * t, v + a * t];
    for (k, span) in spans.into_iter().enumerate() {
        if left <= span || k == 4 {
            return match k {
                0 => swing(10.0 * left),
                1 => thrown(0.7, 3.0, -40.0, left),
                2 => swing(PI - 10.0 * up + 10.0 * left),
                3 => thrown(0.0, -4.0, 30.0, left),
                _ => swing(2.0 * PI - 10.0 * down + 10.0 * left),
            };
        }
        left -= span;
    }
    unreachable!("the last span takes what is left")
}

#[test]
fn engines_begin_anew_where_a_piston_passes_a_knot_of_its_pressures() {
    let start = "[start]\nrod = { x = 0.3, velocity_x = 5.0, fixed = true }\n";
    let text = with_body(&format!("{BEYOND}{start}")).replace("duration = 0.5", "duration = 2.0");
    let truth = ["solver.engine=\"explicit\"", "solver.precision=71"];
    let slow = ["solver.reference_tolerance=1e-34", "run.sample_interval=0.1"];
    let sets = [vec![ENGINES[0]], vec![ENGINES[1]], [truth, slow].concat()];
    for (set, within) in sets.iter().zip([1e-10, 1e-8, 1e-15]) {
        let kept = simulate(&case_of(&text, set));
        for sample in &kept.samples {
            let [x, v] = beyond(sample.time);
            let body = body(sample, 0);
            let off = (body.position[0] - x).abs().max(0.1 * (body.velocity[0] - v).abs());
            // the closed form has the rounding of its times
            assert!(off <= within + 2e-14, "{set:?}: off by {off:e} at {} s", sample.time);
        }
        // knots are 0, 0.25, 0.3 and 0.7: six passages and two at the ends in each period
        assert!(kept.samples.iter().any(|sample| body(sample, 0).position[0] > 0.75));
        for event in &kept.events {
            assert_eq!(*event, changes(event.time, Owner::Load(0)));
            let [x, _] = beyond(event.time);
            let off = [0.0, 0.25, 0.3, 0.7].map(|knot: f64| (x - knot).abs());
            assert!(off.into_iter().fold(1.0, f64::min) < within + 2e-14, "{set:?}: {event:?}");
        }
        let restarts = kept.count("restarts");
        assert_eq!(kept.events.len() as u64 + 1, restarts, "{set:?}");
        let period = 0.15 + 8.0 / 30.0 + 0.2 * (0.8_f64.asin() + 0.6_f64.asin());
        let least = (8.0 * 2.0 / period).floor() as u64 - 1;
        assert!(restarts >= least && restarts <= 2 * least, "{set:?}: {restarts}, not {least}");
    }
}

#[test]
fn a_piston_that_starts_at_rest_on_a_knot_goes_to_the_side_it_is_drawn_to() {
    // at 0.7 m it is drawn inward by 40 m/s², at 0 by 30 m/s²; both knots are ends of the table
    for (at, first, amplitude) in [(0.7, -40.0, 0.4), (0.0, 30.0, -0.3)] {
        let start = format!("[start]\nrod = {{ x = {at:?}, velocity_x = 0.0, fixed = true }}\n");
        for kept in runs(&format!("{BEYOND}{start}")) {
            let early = |t: f64| 0.3 + amplitude * (10.0 * t).cos();
            for sample in kept.samples.iter().filter(|sample| sample.time < 0.2) {
                // the swing about 0.3 with 0.4 passes the other end at 0
                let x = early(sample.time);
                if x < 0.0 {
                    break;
                }
                let off = (body(sample, 0).position[0] - x).abs();
                assert!(off < 1e-8, "from {at}: off by {off:e} at {} s", sample.time);
            }
            assert!((kept.samples[0].bodies[0].acceleration[0] - first).abs() < 1e-9);
        }
    }
}

#[test]
fn a_shipped_slider_crank_is_braked_as_its_header_says() {
    let kept = simulate(&case("cases/slider-crank-ideal.toml", &[]));
    let slider = body(&kept.samples[0], 2);
    assert!((slider.position[0] - 0.17).abs() < 1e-16);
    assert!((slider.acceleration[0] + 19_419.360_511_402_68).abs() < 1e-9);
    assert!(kept.last().energy.drive_work.abs() < 1e-11 * kept.largest(|s| s.energy.kinetic));
}

#[test]
fn the_gas_of_the_shipped_compressor_works_as_its_piston_stands() {
    let case = case("cases/slider-crank-gas.toml", &["run.duration=0.012"]);
    let gas = &case.description.loads[0].part;
    let pressure = freeplay::course::Spline::<f64>::of(gas);
    let area: f64 = gas.number("area");
    // of a polynomial of the fifth degree three nodes between knots give the whole integral
    let nodes = [(-0.6_f64.sqrt(), 5.0), (0.0, 8.0), (0.6_f64.sqrt(), 5.0)];
    let work = |from: f64, to: f64| -> f64 {
        let inside = |x: &&f64| from.min(to) < **x && **x < from.max(to);
        let mut ends: Vec<f64> = pressure.knots().iter().filter(inside).copied().collect();
        ends.extend([from, to]);
        ends.sort_by(f64::total_cmp);
        let part = |pair: &[f64]| -> f64 {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            let of = |(node, weight): (f64, f64)| weight * pressure.at(middle + half * node)[0];
            half / 9.0 * nodes.into_iter().map(of).sum::<f64>()
        };
        area * ends.windows(2).map(part).sum::<f64>() * (to - from).signum()
    };
    for engine in ENGINES {
        let case = simulated::case("cases/slider-crank-gas.toml", &[engine, "run.duration=0.012"]);
        let kept = simulate(&case);
        let start = body(&kept.samples[0], 2).position[0];
        assert!(kept.largest(|s| s.energy.load_work) > 10.0);
        for sample in &kept.samples {
            let exact = work(start, body(sample, 2).position[0]);
            let off = (sample.energy.load_work - exact).abs();
            assert!(off < 1e-7, "{engine}: off by {off:e} J at {} s", sample.time);
        }
    }
}

#[test]
fn one_loose_joint_of_a_shipped_manipulator_costs_no_more_than_its_clearance() {
    let kept = simulate(&case("cases/three-rrr-one.toml", &["run.duration=0.02"]));
    let mut largest = [0.0_f64; 3];
    for sample in &kept.samples {
        for (leg, largest) in largest.iter_mut().enumerate() {
            let crank = body(sample, 2 * leg);
            let [x, y] = sample.points[leg].position;
            let elbow_x = crank.position[0] + 0.06 * crank.angle.cos();
            let elbow_y = crank.position[1] + 0.06 * crank.angle.sin();
            let off = ((x - elbow_x).hypot(y - elbow_y) - 0.16).abs();
            *largest = largest.max(off);
        }
    }
    assert!(largest[0] > 1e-5 && largest[0] < 1.1e-4, "{largest:?}");
    assert!(largest[1] < 1e-11 && largest[2] < 1e-11, "{largest:?}");
}
