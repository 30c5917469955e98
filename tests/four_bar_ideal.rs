//! The paper's four-bar with ideal joints. Known in advance (closed form): its largest forces,
//! torques and angular accelerations, and every value at crank angle 0; here besides, at every
//! sample, all motion from the closing loop and all forces from Newton and Euler.

mod simulated;

use freeplay::dae::{State, System};
use freeplay::mechanism::{Mechanism, Observation};
use freeplay::model::Model;
use simulated::{Kept, case, simulate};
use std::f64::consts::PI;

const SPEED: f64 = 5000.0 * 2.0 * PI / 60.0;
const DEGREES_PER_SECOND: f64 = 30_000.0;

const CRANK: usize = 0;
const COUPLER: usize = 1;
const FOLLOWER: usize = 2;
const A0: usize = 0;
const A: usize = 1;
const B: usize = 2;
const B0: usize = 3;

type Pair = [f64; 2];

fn plus(a: Pair, b: Pair) -> Pair {
    [a[0] + b[0], a[1] + b[1]]
}

fn minus(a: Pair, b: Pair) -> Pair {
    [a[0] - b[0], a[1] - b[1]]
}

fn times(k: f64, a: Pair) -> Pair {
    [k * a[0], k * a[1]]
}

fn cross(a: Pair, b: Pair) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn turned(a: Pair) -> Pair {
    [-a[1], a[0]]
}

/// a x + b y = c for x and y.
fn solve(a: Pair, b: Pair, c: Pair) -> Pair {
    [cross(c, b) / cross(a, b), cross(a, c) / cross(a, b)]
}

/// Acceleration of the far end of a rod seen from its near end.
fn swing(rod: Pair, rate: f64, acceleration: f64) -> Pair {
    plus(times(acceleration, turned(rod)), times(-rate * rate, rod))
}

/// The mechanism at a crank angle, by trigonometry and Newton–Euler.
struct ClosedForm {
    angles: [f64; 3],
    rates: [f64; 3],
    accelerations: [f64; 3],
    centres: [Pair; 3],
    velocities: [Pair; 3],
    centre_accelerations: [Pair; 3],
    /// On the second body of each joint.
    forces: [Pair; 4],
    torque: f64,
}

impl ClosedForm {
    fn at(crank_angle: f64) -> ClosedForm {
        let ground = [0.2, 0.0];
        let (crank_length, coupler_length, follower_length): (f64, f64, f64) = (0.03, 0.18, 0.12);
        let crank = [crank_length * crank_angle.cos(), crank_length * crank_angle.sin()];
        // the triangle A, B, B0, on the branch with B above
        let diagonal = minus(ground, crank);
        let reach = diagonal[0].hypot(diagonal[1]);
        let cosine = (coupler_length.powi(2) + reach.powi(2) - follower_length.powi(2))
            / (2.0 * coupler_length * reach);
        let coupler_angle = diagonal[1].atan2(diagonal[0]) + cosine.acos();
        let coupler = [coupler_length * coupler_angle.cos(), coupler_length * coupler_angle.sin()];
        let follower = minus(plus(crank, coupler), ground);
        let follower_angle = follower[1].atan2(follower[0]);
        // crank + coupler = ground + follower, differentiated once and twice
        let towards = [turned(coupler), times(-1.0, turned(follower))];
        let [coupler_rate, follower_rate] =
            solve(towards[0], towards[1], times(-SPEED, turned(crank)));
        let bias = plus(
            times(SPEED.powi(2), crank),
            minus(times(coupler_rate.powi(2), coupler), times(follower_rate.powi(2), follower)),
        );
        let [coupler_turn, follower_turn] = solve(towards[0], towards[1], bias);

        let half = |rod: Pair| times(0.5, rod);
        let end_acceleration = swing(crank, SPEED, 0.0);
        let centre_accelerations = [
            half(end_acceleration),
            plus(end_acceleration, half(swing(coupler, coupler_rate, coupler_turn))),
            half(swing(follower, follower_rate, follower_turn)),
        ];
        let (coupler_inertial, follower_inertial) =
            (times(0.0737, centre_accelerations[1]), times(0.049, centre_accelerations[2]));
        // moments of the follower about B0 and of the coupler about A give the force in B
        let follower_moment = 6.19e-5 * follower_turn + cross(half(follower), follower_inertial);
        let coupler_moment = 2.02e-4 * coupler_turn + cross(half(coupler), coupler_inertial);
        let columns = [[-follower[1], coupler[1]], [follower[0], -coupler[0]]];
        let in_b = solve(columns[0], columns[1], [follower_moment, coupler_moment]);
        let in_a = plus(coupler_inertial, in_b);
        let in_a0 = plus(times(0.3, centre_accelerations[0]), in_a);
        ClosedForm {
            angles: [crank_angle, coupler_angle, follower_angle],
            rates: [SPEED, coupler_rate, follower_rate],
            accelerations: [0.0, coupler_turn, follower_turn],
            centres: [half(crank), plus(crank, half(coupler)), plus(ground, half(follower))],
            velocities: [
                times(0.5 * SPEED, turned(crank)),
                plus(times(SPEED, turned(crank)), times(0.5 * coupler_rate, turned(coupler))),
                times(0.5 * follower_rate, turned(follower)),
            ],
            centre_accelerations,
            forces: [in_a0, in_a, in_b, minus(follower_inertial, in_b)],
            torque: cross(crank, in_a),
        }
    }
}

fn run(set: &[&str]) -> Kept {
    simulate(&case("cases/four-bar-ideal.toml", set))
}

fn force(observation: &Observation, joint: usize) -> f64 {
    let [x, y] = observation.joints[joint].force;
    x.hypot(y)
}

/// A quantity along a run beside its closed form.
type Compared = (&'static str, fn(&Observation) -> Vec<f64>, fn(&ClosedForm) -> Vec<f64>);

#[test]
fn motion_and_forces_are_those_of_the_closed_form_at_every_sample() {
    let kept = run(&["run.sample_interval=7e-6"]);
    let quantities: [Compared; 8] = [
        (
            "angles",
            |o| o.bodies[COUPLER..].iter().map(|b| b.angle).collect(),
            |c| c.angles[COUPLER..].to_vec(),
        ),
        (
            "angular rates",
            |o| o.bodies.iter().map(|b| b.angular_velocity).collect(),
            |c| c.rates.to_vec(),
        ),
        (
            "angular accelerations",
            |o| o.bodies.iter().map(|b| b.angular_acceleration).collect(),
            |c| c.accelerations.to_vec(),
        ),
        (
            "mass centres",
            |o| o.bodies.iter().flat_map(|b| b.position).collect(),
            |c| c.centres.concat(),
        ),
        (
            "velocities",
            |o| o.bodies.iter().flat_map(|b| b.velocity).collect(),
            |c| c.velocities.concat(),
        ),
        (
            "accelerations",
            |o| o.bodies.iter().flat_map(|b| b.acceleration).collect(),
            |c| c.centre_accelerations.concat(),
        ),
        ("forces", |o| o.joints.iter().flat_map(|j| j.force).collect(), |c| c.forces.concat()),
        ("torque", |o| o.drive_torques.clone(), |c| vec![c.torque]),
    ];
    assert_eq!(kept.samples.len(), 8573);
    for (name, of_sample, of_form) in quantities {
        let (mut largest, mut off) = (0.0_f64, 0.0_f64);
        for sample in &kept.samples {
            // whole turns taken off, so that no place of the angle is lost
            let crank_angle = (sample.time * 5000.0 / 60.0).fract() * 2.0 * PI;
            let form = of_form(&ClosedForm::at(crank_angle));
            let told = of_sample(sample);
            assert_eq!(told.len(), form.len());
            for (told, form) in told.iter().zip(&form) {
                largest = largest.max(form.abs());
                off = off.max((told - form).abs());
            }
        }
        assert!(off <= 1e-12 * largest, "{name}: off by {off:e} of {largest:e}");
    }
}

#[test]
fn the_crank_turns_at_its_speed_and_its_angle_goes_on() {
    let kept = run(&[]);
    for sample in &kept.samples {
        let angle = SPEED * sample.time;
        let off = (sample.bodies[CRANK].angle - angle).abs();
        assert!(off <= 4.0 * f64::EPSILON * angle.max(1.0), "{off:e} at {} s", sample.time);
    }
}

#[test]
fn values_at_crank_angle_zero() {
    let kept = run(&[]);
    let start = &kept.samples[0];
    let near = |name: &str, value: f64, exact: f64| {
        assert!((value - exact).abs() <= 1e-13 * exact.abs(), "{name}: {value:e}, {exact:e}");
    };
    let [coupler, follower] = [&start.bodies[COUPLER], &start.bodies[FOLLOWER]];
    near("coupler angle", coupler.angle, 0.697_671_973_323_959_9);
    near("follower angle", follower.angle, 1.841_237_772_019_259_4);
    near("coupler rate", coupler.angular_velocity, -92.399_783_929_111_57);
    near("follower rate", follower.angular_velocity, -92.399_783_929_111_57);
    let [x, y] = start.joints[A].force;
    let sign = -x.signum();
    near("force in A along x", sign * x, -659.250_046_286_129_9);
    near("force in A along y", sign * y, -343.766_091_505_429_6);
    near("torque", start.drive_torques[0], -10.312_982_745_162_888);
}

/// The mechanism at any time near a sample.
struct Near<'a> {
    mechanism: Mechanism<f64>,
    sample: &'a Observation,
}

impl Near<'_> {
    fn at(&mut self, time: f64) -> Observation {
        let bodies = &self.sample.bodies[COUPLER..];
        let mut q: Vec<f64> =
            bodies.iter().flat_map(|b| [b.position[0], b.position[1], b.angle]).collect();
        let mut v = vec![0.0; q.len()];
        self.mechanism.project(time, &mut q, &mut v).unwrap();
        let state = State { time, q: &q, v: &v, z: &[], carried: None };
        self.mechanism.evaluate(state).unwrap();
        self.mechanism.observe(time, &[0.0])
    }
}

/// Largest value of a quantity in one revolution, and the time (s) of it: the largest sample,
/// refined by golden sections.
fn largest(kept: &Kept, of: impl Fn(&Observation) -> f64) -> (f64, f64) {
    let revolution = || kept.samples.iter().filter(|sample| sample.time <= 0.012);
    let best = revolution().max_by(|a, b| of(a).total_cmp(&of(b))).unwrap();
    let model = Model::new(&case("cases/four-bar-ideal.toml", &[]).description).unwrap();
    let mut near = Near { mechanism: Mechanism::new(model).unwrap(), sample: best };
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut left, mut right) = (best.time - 1e-5, best.time + 1e-5);
    while right - left > 1e-11 {
        let width = golden * (right - left);
        let (low, high) = (right - width, left + width);
        if of(&near.at(low)) < of(&near.at(high)) { left = low } else { right = high }
    }
    let time = 0.5 * (left + right);
    (of(&near.at(time)), time)
}

#[test]
fn maxima_are_the_exact_ones_and_where_they_should_be() {
    let kept = run(&["run.duration=0.013"]);
    let turn = |o: &Observation, body: usize| o.bodies[body].angular_acceleration;
    type Quantity<'a> = (&'a str, &'a dyn Fn(&Observation) -> f64, f64, f64, f64);
    // value, crank angle, and how well the angle is known or can be found: a maximum is flat
    // (degrees)
    let known: [Quantity<'_>; 9] = [
        ("force in A", &|o| force(o, A), 892.919_148_289_516_8, 25.553_105_473_452_75, 1e-5),
        ("force in B", &|o| force(o, B), 270.866_700_169_031_97, 16.595_022_157_080_33, 1e-5),
        ("force in B0", &|o| force(o, B0), 221.253_366_195_472_56, 17.183_163_789_436_27, 1e-5),
        ("torque", &|o| o.drive_torques[0], 8.546_033_500_222_64, 67.811_635_885_928_51, 1e-5),
        (
            "torque backward",
            &|o| -o.drive_torques[0],
            10.728_744_092_094_293,
            353.674_427_452_615_2,
            1e-5,
        ),
        ("coupler", &|o| turn(o, COUPLER), 34_341.781_235_740_41, 97.026, 1e-3),
        ("coupler backward", &|o| -turn(o, COUPLER), 60_236.420_364_200_44, 307.240, 1e-3),
        ("follower", &|o| turn(o, FOLLOWER), 86_935.319_530_799_12, 27.481, 1e-3),
        ("follower backward", &|o| -turn(o, FOLLOWER), 57_437.471_891_476_07, 211.783, 1e-3),
    ];
    for (name, of, exact, angle, close) in known {
        let (value, time) = largest(&kept, of);
        assert!((value - exact).abs() <= 1e-13 * exact, "{name}: {value:e}, exact {exact:e}");
        let found = time * DEGREES_PER_SECOND;
        assert!((found - angle).abs() <= close, "{name}: at {found}, exact {angle} degrees");
    }
}

#[test]
fn the_loop_is_closed_at_every_sample() {
    let kept = run(&[]);
    let end = |o: &Observation, body: usize, along: f64| {
        let b = &o.bodies[body];
        [b.position[0] + along * b.angle.cos(), b.position[1] + along * b.angle.sin()]
    };
    for o in &kept.samples {
        let gaps = [
            minus(end(o, CRANK, -0.015), [0.0, 0.0]),
            minus(end(o, COUPLER, -0.09), end(o, CRANK, 0.015)),
            minus(end(o, FOLLOWER, 0.06), end(o, COUPLER, 0.09)),
            minus(end(o, FOLLOWER, -0.06), [0.2, 0.0]),
        ];
        for (joint, gap) in [A0, A, B, B0].into_iter().zip(gaps) {
            let off = gap[0].hypot(gap[1]);
            // the crank's angle itself is rounded, at 0.03 m from its centre
            let rounding = 4.0 * f64::EPSILON * (0.2 + 0.03 * o.bodies[CRANK].angle);
            assert!(off <= rounding, "joint {joint}: {off:e} m at {} s", o.time);
        }
    }
}

#[test]
fn the_work_of_the_drive_is_the_change_of_the_kinetic_energy() {
    let kept = run(&[]);
    let kinetic = kept.largest(|o| o.energy.kinetic);
    let residual = kept.largest(|o| o.energy.residual);
    assert!(residual <= 1e-13 * kinetic, "{residual:e} of {kinetic:e} J");
    let work = kept.largest(|o| o.energy.drive_work);
    assert!(work > 1e-2 * kinetic, "the work is not all zero: {work:e} J");
    assert!(kept.events.is_empty() && kept.contacts.is_empty() && kept.peaks.is_empty());
}
