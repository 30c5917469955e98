//! Mechanisms of other shapes. Known in advance: a double pendulum from Lagrange's equations in its
//! two angles; flights of free bodies; what joints without friction conserve; for every mechanism
//! Newton's and Euler's laws body by body, the balance of energy, and joints that stay closed.

mod simulated;

use freeplay::case::Case;
use freeplay::mechanism::{BodyObservation, Observation};
use freeplay::model::{GROUND, Model};
use freeplay::plane::Vector;
use simulated::drift::largest_drift;
use simulated::{Kept, case, case_of, root, simulate};
use std::f64::consts::PI;

const TOLERANCE: f64 = 1e-12;

/// Mechanisms in `tests/cases`, all of them moving.
const LINKAGES: [&str; 8] = [
    "double-pendulum",
    "elbow-drive",
    "crank-on-crank",
    "loose-motor",
    "six-bar",
    "chain",
    "two-discs",
    "rubbing-pendulum",
];

fn linkage(name: &str, set: &[&str]) -> Case {
    case(&format!("tests/cases/{name}.toml"), set)
}

#[test]
fn the_list_has_every_case_there_is() {
    let entries = std::fs::read_dir(root().join("tests/cases")).unwrap();
    assert_eq!(entries.count(), LINKAGES.len());
}

/// A point of a body, from its mass centre, in the fixed frame (m).
fn arm(body: &BodyObservation, s: Vector<f64>) -> Vector<f64> {
    let (sin, cos) = body.angle.sin_cos();
    Vector::new(cos * s.x - sin * s.y, sin * s.x + cos * s.y)
}

fn vector([x, y]: [f64; 2]) -> Vector<f64> {
    Vector::new(x, y)
}

/// Force (N) and moment about the mass centre (N m) on each body, from what a sample tells of the
/// joints and drives, and gravity.
fn loads(
    model: &Model<f64>,
    gravity: Vector<f64>,
    sample: &Observation,
) -> Vec<(Vector<f64>, f64)> {
    let mut loads: Vec<(Vector<f64>, f64)> =
        model.masses().iter().map(|mass| (gravity * *mass, 0.0)).collect();
    let mut put = |body: usize, s: Vector<f64>, force: Vector<f64>, moment: f64| {
        if body != GROUND {
            loads[body].0 += force;
            loads[body].1 += arm(&sample.bodies[body - 1], s).cross(force) + moment;
        }
    };
    for (joint, observed) in model.joints().iter().zip(&sample.joints) {
        let (pair, force) = (&joint.ends.pair, vector(observed.force));
        let on_bearing = |k: usize| {
            -model.clearances()[k].bearing_radius * sample.clearances[k].tangential_force
        };
        let on_bearing = joint.clearances.clone().map(on_bearing).sum();
        put(pair.j, pair.s_j, force, observed.moment);
        put(pair.i, pair.s_i, -force, on_bearing);
    }
    for (drive, torque) in model.drives().iter().zip(&sample.drive_torques) {
        let pair = &model.joints()[drive.joint].ends.pair;
        put(pair.j, pair.s_j, Vector::zero(), *torque);
        put(pair.i, pair.s_i, Vector::zero(), -torque);
    }
    loads
}

fn gravity(case: &Case) -> Vector<f64> {
    let falls = case.description.loads.iter().filter_map(|load| load.gravity()).map(vector);
    falls.fold(Vector::zero(), |sum, g| sum + g)
}

#[test]
fn every_body_obeys_newton_and_euler_at_every_sample() {
    for name in LINKAGES {
        let case = linkage(name, &[]);
        let model = Model::<f64>::new(&case.description).unwrap();
        let kept = simulate(&case);
        let gravity = gravity(&case);
        let mut largest = (0.0_f64, 0.0_f64);
        let mut off = (0.0_f64, 0.0_f64);
        for sample in &kept.samples {
            let loads = loads(&model, gravity, sample);
            for (body, (force, moment)) in loads.into_iter().enumerate().skip(1) {
                let observed = &sample.bodies[body - 1];
                let inertial = vector(observed.acceleration) * model.masses()[body];
                let spin = model.inertias()[body] * observed.angular_acceleration;
                largest.0 = largest.0.max(inertial.norm()).max(force.norm());
                largest.1 = largest.1.max(spin.abs()).max(moment.abs());
                off.0 = off.0.max((inertial - force).norm());
                off.1 = off.1.max((spin - moment).abs());
            }
        }
        assert!(off.0 <= 1e-12 * largest.0, "{name}: {:e} of {:e} N", off.0, largest.0);
        assert!(off.1 <= 1e-12 * largest.1.max(0.01 * largest.0), "{name}: {:e} N m", off.1);
        assert!(largest.0 > 0.0, "{name}");
    }
}

/// Whether a joint or drive pushes at each of three samples alike, so that all is smooth there.
fn smooth(samples: &[Observation]) -> bool {
    let flies = |o: &Observation| o.clearances.iter().all(|clearance| !clearance.in_contact);
    samples.iter().all(flies)
}

/// Simpson's rule over two intervals. It sees no impacts, so flights are looked at alone.
#[test]
fn rates_are_the_integrals_of_accelerations_and_positions_those_of_rates() {
    for name in LINKAGES {
        let kept = simulate(&linkage(name, &["run.sample_interval=2e-5", "run.duration=0.05"]));
        let mut looked = 0;
        for samples in kept.samples.windows(3).filter(|samples| smooth(samples)) {
            let third = (samples[2].time - samples[0].time) / 6.0;
            for body in 0..samples[0].bodies.len() {
                let at = |k: usize| &samples[k].bodies[body];
                let simpson = |of: &dyn Fn(&BodyObservation) -> f64| {
                    third * (of(at(0)) + 4.0 * of(at(1)) + of(at(2)))
                };
                let grown = |of: &dyn Fn(&BodyObservation) -> f64| of(at(2)) - of(at(0));
                type Of<'a> = &'a dyn Fn(&BodyObservation) -> f64;
                let pairs: [(Of<'_>, Of<'_>, f64); 4] = [
                    (&|b| b.angle, &|b| b.angular_velocity, 1.0),
                    (&|b| b.angular_velocity, &|b| b.angular_acceleration, 100.0),
                    (&|b| b.position[1], &|b| b.velocity[1], 0.1),
                    (&|b| b.velocity[0], &|b| b.acceleration[0], 10.0),
                ];
                for (whole, rate, size) in pairs {
                    let off = (grown(whole) - simpson(rate)).abs();
                    assert!(
                        off <= 1e-9 * size,
                        "{name}, body {body}, {} s: {off:e}",
                        samples[1].time
                    );
                }
            }
            looked += 1;
        }
        assert!(looked > 100, "{name}: {looked} flights of three samples");
    }
}

#[test]
fn energy_is_balanced_and_joints_stay_closed() {
    for name in LINKAGES {
        let case = linkage(name, &[]);
        let kept = simulate(&case);
        let kinetic = kept.largest(|sample| sample.energy.kinetic);
        let residual = kept.largest(|sample| sample.energy.residual);
        assert!(residual <= 1e-9 * kinetic, "{name}: {residual:e} of {kinetic:e} J");
        let model = Model::<f64>::new(&case.description).unwrap();
        if model.joints().iter().any(|joint| !joint.is_loose()) {
            let drift = largest_drift(&case);
            assert!(drift <= 1e-11, "{name}: {drift:e} m");
        }
    }
}

#[test]
fn closed_loops_with_several_clearances_have_contacts_in_each() {
    for (name, clearances) in [("six-bar", 2), ("chain", 2)] {
        let kept = simulate(&linkage(name, &[]));
        for k in 0..clearances {
            let contacts = kept.contacts.iter().filter(|contact| contact.clearance == k);
            assert!(contacts.count() >= 3, "{name}, clearance {k}");
        }
        assert!(kept.last().energy.dissipated > 0.0, "{name}");
    }
}

/// Lagrange's equations of the double pendulum, in its two angles: accelerations of both.
fn double_pendulum([upper, lower]: [f64; 2], [upper_rate, lower_rate]: [f64; 2]) -> [f64; 2] {
    let (m1, i1, l1, m2, i2, l2, g) = (0.7, 0.009, 0.2, 0.4, 0.004, 0.15, 9.81);
    let (sin, cos) = (upper - lower).sin_cos();
    let length = 2.0 * l1;
    let (a, b, c) =
        (i1 + m1 * l1 * l1 + m2 * length * length, m2 * length * l2 * cos, i2 + m2 * l2 * l2);
    let (p, q) = (
        -m2 * length * l2 * sin * lower_rate * lower_rate
            - (m1 * l1 + m2 * length) * g * upper.cos(),
        m2 * length * l2 * sin * upper_rate * upper_rate - m2 * l2 * g * lower.cos(),
    );
    let determinant = a * c - b * b;
    [(p * c - b * q) / determinant, (a * q - b * p) / determinant]
}

/// The double pendulum after a time (s), by the classical Runge–Kutta method in small steps.
fn swung(mut x: [f64; 4], time: f64) -> [f64; 4] {
    let steps = (time / 1e-5).round() as usize;
    let h = time / steps as f64;
    let slope = |x: [f64; 4]| {
        let [a, b] = double_pendulum([x[0], x[1]], [x[2], x[3]]);
        [x[2], x[3], a, b]
    };
    let along = |x: [f64; 4], k: [f64; 4], h: f64| {
        [x[0] + h * k[0], x[1] + h * k[1], x[2] + h * k[2], x[3] + h * k[3]]
    };
    for _ in 0..steps {
        let first = slope(x);
        let second = slope(along(x, first, 0.5 * h));
        let third = slope(along(x, second, 0.5 * h));
        let fourth = slope(along(x, third, h));
        for k in 0..4 {
            x[k] += h / 6.0 * (first[k] + 2.0 * second[k] + 2.0 * third[k] + fourth[k]);
        }
    }
    x
}

#[test]
fn a_double_pendulum_swings_as_lagrange_s_equations_in_two_angles_tell() {
    let kept = simulate(&linkage("double-pendulum", &[]));
    let mut x = [0.5, -0.8, 2.0, -3.0];
    for pair in kept.samples.windows(101).step_by(100) {
        let sample = &pair[100];
        x = swung(x, sample.time - pair[0].time);
        let [upper, lower] = [&sample.bodies[0], &sample.bodies[1]];
        let found = [upper.angle, lower.angle, upper.angular_velocity, lower.angular_velocity];
        for (found, exact) in found.iter().zip(x) {
            let off = (found - exact).abs();
            assert!(off <= 1e4 * TOLERANCE * 10.0, "{off:e} at {} s", sample.time);
        }
        let exact = double_pendulum([x[0], x[1]], [x[2], x[3]]);
        for (body, exact) in [upper, lower].into_iter().zip(exact) {
            assert!((body.angular_acceleration - exact).abs() <= 1e5 * TOLERANCE * 100.0);
        }
    }
}

#[test]
fn a_free_body_falls_on_a_parabola_and_spins_evenly() {
    let text = r#"
        [bodies.stone]
        mass = 0.7
        inertia = 0.02
        [loads.gravity]
        kind = "gravity"
        acceleration = [0.5, -9.81]
        [start.stone]
        x = 1.0
        y = 2.0
        angle = 0.3
        velocity_x = 3.0
        velocity_y = 8.0
        angular_velocity = -12.0
        fixed = true
        [run]
        duration = 1.7
        sample_interval = 0.01
        [solver]
        absolute_tolerance = "scaled"
        "#;
    let kept = simulate(&case_of(text, &[]));
    for sample in &kept.samples {
        let (t, stone) = (sample.time, &sample.bodies[0]);
        let exact = [
            (stone.position[0], 1.0 + 3.0 * t + 0.25 * t * t),
            (stone.position[1], 2.0 + 8.0 * t - 0.5 * 9.81 * t * t),
            (stone.angle, 0.3 - 12.0 * t),
            (stone.velocity[0], 3.0 + 0.5 * t),
            (stone.velocity[1], 8.0 - 9.81 * t),
        ];
        for (found, exact) in exact {
            assert!((found - exact).abs() <= 1e3 * TOLERANCE * 10.0, "{found}, {exact} at {t} s");
        }
        assert_eq!(stone.angular_velocity, -12.0);
        assert_eq!((stone.acceleration, stone.angular_acceleration), ([0.5, -9.81], 0.0));
    }
}

/// Momenta of all bodies: linear (N s), and angular about the origin (N m s).
fn momenta(model: &Model<f64>, sample: &Observation) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (body, observed) in sample.bodies.iter().enumerate() {
        let (mass, inertia) = (model.masses()[body + 1], model.inertias()[body + 1]);
        let (at, velocity) = (vector(observed.position), vector(observed.velocity));
        sum[0] += mass * velocity.x;
        sum[1] += mass * velocity.y;
        sum[2] += mass * at.cross(velocity) + inertia * observed.angular_velocity;
    }
    sum
}

fn assert_kept(kept: &Kept, model: &Model<f64>, allowed: [f64; 3]) {
    let at_start = momenta(model, &kept.samples[0]);
    for (k, allowed) in allowed.into_iter().enumerate() {
        let off = kept.largest(|sample| momenta(model, sample)[k] - at_start[k]);
        assert!(off <= allowed, "momentum {k}: off by {off:e}, allowed {allowed:e}");
    }
}

#[test]
fn two_free_bodies_that_meet_keep_their_momenta_and_their_energy() {
    let case = linkage("two-discs", &[]);
    let model = Model::<f64>::new(&case.description).unwrap();
    let kept = simulate(&case);
    assert!(kept.contacts.len() > 20, "{} contacts", kept.contacts.len());
    // each contact may err by some tolerances of the momentum it exchanges
    let error = 100.0 * TOLERANCE * kept.contacts.len() as f64;
    let exchanged = 0.075 * 1.0;
    assert_kept(&kept, &model, [error * exchanged, error * exchanged, error * exchanged * 0.2]);
    assert_eq!(kept.largest(|sample| sample.energy.dissipated), 0.0);
    let spins = |sample: &Observation| sample.bodies[0].angular_velocity;
    assert!(spins(kept.last()) != spins(&kept.samples[0]), "the contacts turn the bodies");
}

/// With a damped law, head on along the line of the mass centres, two free bodies part like one
/// of their reduced mass that met a wall.
#[test]
fn two_free_bodies_part_at_the_rebound_ratio_of_their_law() {
    let set = [
        "bodies.ring.points.centre=[0.0, 0.0]",
        "bodies.disc.points.centre=[0.0, 0.0]",
        "joints.gap.clearance.normal.law=lankarani-nikravesh",
        "joints.gap.clearance.normal.restitution=0.5",
    ];
    let kept = simulate(&linkage("two-discs", &set));
    let rates: Vec<f64> = kept.contacts.iter().map(|contact| contact.impact_rate).collect();
    assert!(rates.len() >= 4, "{rates:?}");
    // root of a (1 + e) = ln((1 + a)/(1 − a e)) at a = ¾ (1 − 0.5²)
    let exact = 0.725_241_114_010_197;
    for pair in rates.windows(2) {
        let ratio = pair[1] / pair[0];
        assert!((ratio - exact).abs() <= 1e3 * TOLERANCE, "{ratio}, exact {exact}");
    }
    let reduced = 0.3 * 0.1 / 0.4;
    let first = kept.contacts[0];
    let lost = 0.5 * reduced * first.impact_rate.powi(2) * (1.0 - exact * exact);
    assert!((first.dissipated - lost).abs() <= 1e3 * TOLERANCE * lost);
}

#[test]
fn a_drive_between_moving_bodies_keeps_the_swing_about_the_pivot_and_turns_evenly() {
    let case = linkage("elbow-drive", &[]);
    let model = Model::<f64>::new(&case.description).unwrap();
    let kept = simulate(&case);
    let rate = -240.0 * 2.0 * PI / 60.0;
    let swing = |sample: &Observation| {
        let [x, y, about_origin] = momenta(&model, sample);
        about_origin - vector([0.1, -0.2]).cross(vector([x, y]))
    };
    let size = kept.largest(swing);
    let off = kept.largest(|sample| swing(sample) - swing(&kept.samples[0]));
    assert!(off <= 1e3 * TOLERANCE * size, "{off:e} of {size:e} N m s");
    for sample in &kept.samples {
        // the second body of the joint is the upper rod
        let [upper, lower] = [&sample.bodies[0], &sample.bodies[1]];
        let off = upper.angle - lower.angle - (0.3 + rate * sample.time);
        assert!(off.abs() <= 1e-11, "{off:e} rad");
        assert!((upper.angular_velocity - lower.angular_velocity - rate).abs() <= 1e-9);
    }
    assert!(kept.largest(|sample| sample.energy.drive_work) > 0.1);
}

#[test]
fn a_drive_on_a_joint_with_clearance_prescribes_the_angle_and_nothing_else() {
    let kept = simulate(&linkage("loose-motor", &[]));
    let rate = 600.0 * 2.0 * PI / 60.0;
    for sample in &kept.samples {
        let rotor = &sample.bodies[0];
        let off = rotor.angle - (0.2 + rate * sample.time);
        assert!(off.abs() <= 1e-11, "{off:e} rad at {} s", sample.time);
        assert!((rotor.angular_velocity - rate).abs() <= 1e-9 * rate);
        assert!(rotor.angular_acceleration.abs() <= 1e-9 * rate * rate);
    }
    assert!(kept.contacts.len() > 5 && kept.largest(|s| s.drive_torques[0]) > 0.0);
}

#[test]
fn driven_bodies_on_driven_bodies_move_as_prescribed() {
    let kept = simulate(&linkage("crank-on-crank", &[]));
    let [first_rate, second_rate] = [300.0, -1000.0].map(|rpm: f64| rpm * 2.0 * PI / 60.0);
    for sample in &kept.samples {
        let [first, second] = [&sample.bodies[0], &sample.bodies[1]];
        // the ground is the second body of the first joint, and turns against the crank
        let angle = -(0.4 + first_rate * sample.time);
        assert!((first.angle - angle).abs() <= 4.0 * f64::EPSILON * angle.abs());
        let relative = second.angle - first.angle;
        let exact = 1.1 + second_rate * sample.time;
        assert!((relative - exact).abs() <= 1e-14 * exact.abs().max(1.0), "{relative}, {exact}");
        assert_eq!(first.angular_velocity, -first_rate);
        // the pivot: the crank's point O is at the origin, its point P at the second crank's
        let pivot = vector(first.position) + arm(first, Vector::new(-0.05, 0.01));
        assert!(pivot.norm() <= 1e-16 * 100.0, "{pivot:?}");
        let gap = vector(first.position) + arm(first, Vector::new(0.06, 0.0))
            - vector(second.position)
            - arm(second, Vector::new(-0.03, 0.0));
        assert!(gap.norm() <= 1e-16 * 100.0, "{gap:?}");
    }
}

/// The second body of a driven joint may be the ground: everything is the same, but the torque and
/// the force in that joint, which act on the ground.
#[test]
fn a_joint_the_other_way_round_is_the_same_mechanism() {
    let path = "cases/four-bar-a.toml";
    let short = ["run.duration=2e-3", "run.sample_interval=1e-4"];
    let turned = [
        &short[..],
        &[
            r#"joints.A0.between=["crank.A0", "ground.A0"]"#,
            "drives.crank.speed_rpm=-5000.0",
            r#"joints.B0.between=["follower.B0", "ground.B0"]"#,
        ],
    ]
    .concat();
    let [plain, turned] = [simulate(&case(path, &short)), simulate(&case(path, &turned))];
    assert_eq!(plain.events.len(), turned.events.len());
    for (plain, turned) in plain.samples.iter().zip(&turned.samples) {
        let near = |a: f64, b: f64, size: f64| {
            assert!((a - b).abs() <= 1e-7 * size, "{a}, {b} at {} s", plain.time);
        };
        near(plain.bodies[1].angle, turned.bodies[1].angle, 1.0);
        near(plain.bodies[2].angular_velocity, turned.bodies[2].angular_velocity, 500.0);
        near(plain.drive_torques[0], -turned.drive_torques[0], 200.0);
        near(plain.joints[0].force[0], -turned.joints[0].force[0], 1e4);
        near(plain.joints[3].force[1], -turned.joints[3].force[1], 1e4);
        near(plain.joints[1].force[1], turned.joints[1].force[1], 1e4);
        near(plain.energy.drive_work, turned.energy.drive_work, 1.0);
    }
}
