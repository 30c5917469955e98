//! A pendulum of one rod. Known in advance: its half period by the arithmetic–geometric mean, the
//! force on its pivot at every angle, and that its energy stays.

mod simulated;

use freeplay::mechanism::Observation;
use simulated::drift::largest_drift;
use simulated::{Kept, case, simulate};
use std::f64::consts::{FRAC_PI_2, PI};

const MASS: f64 = 0.5;
const ARM: f64 = 0.3;
const INERTIA: f64 = 0.015 + MASS * ARM * ARM;
const GRAVITY: f64 = 9.81;

const CASE: &str = "cases/pendulum.toml";
const TOLERANCE: f64 = 1e-12;

fn agm(mut a: f64, mut b: f64) -> f64 {
    while (a - b).abs() > 2.0 * f64::EPSILON * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

/// Half a period (s) at an amplitude (rad).
fn half_period(amplitude: f64) -> f64 {
    PI / agm(1.0, (0.5 * amplitude).cos()) * (INERTIA / (MASS * GRAVITY * ARM)).sqrt()
}

/// Times (s) at which the rod comes to rest, after the start: between two samples the angular
/// rate is the cubic through its values and slopes there.
fn turning_points(kept: &Kept) -> Vec<f64> {
    let rod = |sample: &Observation| sample.bodies[0];
    let pairs = kept.samples.windows(2).skip(1);
    let crossing =
        pairs.filter(|pair| rod(&pair[0]).angular_velocity * rod(&pair[1]).angular_velocity < 0.0);
    crossing
        .map(|pair| {
            let [from, to] = [rod(&pair[0]), rod(&pair[1])];
            let span = pair[1].time - pair[0].time;
            let rate = |s: f64| {
                let r = 1.0 - s;
                r * r * (1.0 + 2.0 * s) * from.angular_velocity
                    + s * s * (1.0 + 2.0 * r) * to.angular_velocity
                    + span * s * r * (r * from.angular_acceleration - s * to.angular_acceleration)
            };
            let (mut left, mut right) = (0.0, 1.0);
            while right - left > 1e-12 {
                let middle = 0.5 * (left + right);
                let same = rate(middle) * from.angular_velocity > 0.0;
                if same { left = middle } else { right = middle }
            }
            pair[0].time + span * left
        })
        .collect()
}

#[test]
fn half_periods_are_those_of_the_arithmetic_geometric_mean() {
    assert!((half_period(FRAC_PI_2) - 0.748_777_369_362_992_2).abs() < 1e-15);
    for degrees in [10.0_f64, 90.0, 170.0] {
        let amplitude = degrees.to_radians();
        let start = format!("start.rod.angle={}", amplitude - FRAC_PI_2);
        let kept = simulate(&case(CASE, &[&start, "run.duration=4.5", "run.sample_interval=1e-4"]));
        let found = turning_points(&kept);
        let half = half_period(amplitude);
        assert_eq!(found.len(), (4.5 / half) as usize, "{degrees} degrees");
        for (k, time) in found.iter().enumerate() {
            let exact = (k + 1) as f64 * half;
            // what a step's error becomes over a few periods, and what the cubic leaves
            let allowed = 1e3 * TOLERANCE * exact;
            assert!((time - exact).abs() <= allowed, "{degrees} degrees: {time}, exact {exact}");
        }
    }
}

#[test]
fn at_the_bottom_the_pivot_carries_weight_and_swing() {
    let quarter = format!("run.duration={}", 0.5 * half_period(FRAC_PI_2));
    let bottom = simulate(&case(CASE, &[&quarter]));
    let [x, y] = bottom.last().joints[0].force;
    let exact = MASS * GRAVITY * (1.0 + 2.0 * MASS * ARM * ARM / INERTIA);
    assert!((exact - 12.2625).abs() < 1e-13);
    assert!((y - exact).abs() <= 100.0 * TOLERANCE * exact, "{y} N, exact {exact} N");
    assert!(x.abs() <= 100.0 * TOLERANCE * exact, "{x} N across");
    assert!((bottom.last().bodies[0].angle + FRAC_PI_2).abs() <= 100.0 * TOLERANCE);
}

#[test]
fn at_every_angle_rate_acceleration_and_force_follow_from_the_angle() {
    let kept = simulate(&case(CASE, &[]));
    let (heaviest, fastest) = (12.2625, (2.0 * MASS * GRAVITY * ARM / INERTIA).sqrt());
    for sample in &kept.samples {
        let rod = &sample.bodies[0];
        let (sin, cos) = rod.angle.sin_cos();
        let fallen = (-2.0 * MASS * GRAVITY * ARM * sin / INERTIA).max(0.0);
        let squared = rod.angular_velocity * rod.angular_velocity;
        assert!((squared - fallen).abs() <= 100.0 * TOLERANCE * fastest * fastest);

        let turn = -MASS * GRAVITY * ARM * cos / INERTIA;
        let exact_force = [
            MASS * ARM * (-turn * sin - squared * cos),
            MASS * ARM * (turn * cos - squared * sin) + MASS * GRAVITY,
        ];
        let close = |found: f64, exact: f64, size: f64| (found - exact).abs() <= 1e-13 * size;
        assert!(close(rod.angular_acceleration, turn, MASS * GRAVITY * ARM / INERTIA));
        let force = sample.joints[0].force;
        assert!(close(force[0], exact_force[0], heaviest), "{force:?}, {exact_force:?}");
        assert!(close(force[1], exact_force[1], heaviest), "{force:?}, {exact_force:?}");
        let centre = [ARM * cos, ARM * sin];
        assert!(close(rod.position[0], centre[0], ARM) && close(rod.position[1], centre[1], ARM));
    }
}

#[test]
fn energy_stays_and_so_does_the_rod_on_its_pivot() {
    let kept = simulate(&case(CASE, &["run.duration=10", "run.sample_interval=0.01"]));
    let swing = MASS * GRAVITY * ARM;
    let residual = kept.largest(|sample| sample.energy.residual);
    assert!(residual <= 1e3 * TOLERANCE * swing, "{residual:e} of {swing} J");
    assert_eq!(kept.largest(|s| s.energy.dissipated + s.energy.drive_work + s.energy.elastic), 0.0);
    let drift = largest_drift(&case(CASE, &["run.duration=1"]));
    assert!(drift <= 1e-11 && drift > 0.0, "{drift:e} m");
}
