//! One journal in a bearing that does not move. Known in advance: it circles for ever, rests under
//! its weight at a given depth, flies in straight lines whose ends are roots of a quadratic, and
//! slows down under friction first in proportion to time and then exponentially.

mod simulated;

use freeplay::run::EventKind;
use simulated::{Kept, case, case_of, simulate};
use std::f64::consts::PI;

const TOLERANCE: f64 = 1e-12;
const CLEARANCE: f64 = 1e-3;
/// The paper's K (N/m^1.5).
const STIFFNESS: f64 = 1.043_715_536_510_028_3e10;

/// A journal of 0.05 kg with a law and a start; `more` are further tables.
fn journal(law: &str, start: &str, more: &str, duration: f64, interval: f64) -> Kept {
    let text = format!(
        r#"
        [ground]
        points = {{ O = [0.0, 0.0], P = [0.0011, 0.0] }}
        [bodies.journal]
        mass = 0.05
        inertia = 2e-6
        points = {{ C = [0.0, 0.0] }}
        [joints.O]
        kind = "revolute"
        between = ["ground.O", "journal.C"]
        [joints.O.clearance]
        bearing_radius = 0.01
        radial = 0.001
        {law}
        [start.journal]
        {start}
        fixed = true
        [run]
        duration = {duration:?}
        sample_interval = {interval:?}
        [solver]
        relative_tolerance = 1e-12
        absolute_tolerance = "scaled"
        {more}
        "#
    );
    simulate(&case_of(&text, &[]))
}

const HERTZ: &str =
    r#"normal = { law = "hertz", stiffness = "hertz-printed", young = 207e9, poisson = 0.3 }"#;

const GRAVITY: &str = r#"
    [loads.gravity]
    kind = "gravity"
    acceleration = [0.0, -9.81]
    "#;

#[test]
fn a_journal_on_its_circle_circles_for_ever() {
    let (depth, speed, force) =
        (1.200_247_193_643_541e-6, 0.524_227_223_559_306, 13.724_236_619_547_414);
    let rate = 5000.0 * 2.0 * PI / 60.0;
    let kept = simulate(&case("cases/journal-in-bearing.toml", &[]));
    assert_eq!(kept.samples.len(), 6001);
    assert_eq!((kept.events.len(), kept.contacts.len()), (1, 1));
    assert!(kept.contacts[0].end.is_nan());
    assert!(kept.peaks.is_empty(), "a steady force has no maxima: {:?}", kept.peaks);
    // each step may err by the tolerance
    let error = kept.count("steps") as f64 * TOLERANCE;
    for sample in &kept.samples {
        let (journal, clearance) = (&sample.bodies[0], &sample.clearances[0]);
        let allowed = error * CLEARANCE;
        assert!((clearance.penetration - depth).abs() <= allowed, "{}", clearance.penetration);
        let slope = 1.5 * force / depth;
        assert!((clearance.normal_force - force).abs() <= slope * allowed);
        let found = journal.velocity[0].hypot(journal.velocity[1]);
        assert!((found - speed).abs() <= error * speed, "{found}");
        // an error of the speed goes on to grow on the way, through all 10π rad of it
        let (sin, cos) = (rate * sample.time).sin_cos();
        let radius = CLEARANCE + depth;
        let off = (journal.position[0] - radius * cos).hypot(journal.position[1] - radius * sin);
        assert!(off <= 10.0 * PI * error * radius, "{off:e} m at {} s", sample.time);
    }
    let residual = kept.largest(|sample| sample.energy.residual);
    let kinetic = 0.5 * 0.05 * speed * speed;
    assert!(residual <= error * kinetic, "{residual:e} of {kinetic:e} J");
}

#[test]
fn fixed_keys_of_the_start_hold_to_the_last_place_where_a_journal_cannot_be_centred() {
    let kept = simulate(&case("cases/journal-in-bearing.toml", &["run.duration=1e-5"]));
    let start = &kept.samples[0].bodies[0];
    // as the case file has them
    let number = |literal: &str| literal.parse::<f64>().unwrap();
    assert_eq!(start.position, [number("0.00100120024719364354106"), 0.0]);
    assert_eq!(start.velocity, [0.0, number("0.524227223559305926")]);
}

#[test]
fn a_journal_at_rest_under_gravity_stays_at_rest() {
    let depth = 1.302_280_613_939_605_5e-7;
    let start = "x = 0.0\ny = -0.00100013022806139396055\nangle = 0.0\n\
                 velocity_x = 0.0\nvelocity_y = 0.0\nangular_velocity = 0.0";
    let kept = journal(HERTZ, start, GRAVITY, 0.1, 1e-4);
    assert_eq!((kept.contacts.len(), kept.events.len()), (1, 1));
    for sample in &kept.samples {
        let clearance = &sample.clearances[0];
        let allowed = 1e3 * TOLERANCE * CLEARANCE;
        assert!((clearance.penetration - depth).abs() <= allowed, "{}", clearance.penetration);
        let slope = 1.5 * 0.05 * 9.81 / depth;
        assert!((clearance.normal_force - 0.05 * 9.81).abs() <= slope * allowed);
        assert_eq!(clearance.offset[0], 0.0);
    }
}

/// The bounces grow shorter and shorter, and end in a contact that does not.
#[test]
fn a_journal_that_falls_comes_to_rest_at_the_depth_of_its_weight() {
    let law = r#"normal = { law = "lankarani-nikravesh", restitution = 0.5, stiffness = "hertz-printed", young = 207e9, poisson = 0.3 }"#;
    let start = "x = 0.0\ny = 0.0\nangle = 0.0\n\
                 velocity_x = 0.0\nvelocity_y = 0.0\nangular_velocity = 0.0";
    let kept = journal(law, start, GRAVITY, 0.25, 1e-4);
    let last = kept.last();
    let depth = (0.05 * 9.81 / STIFFNESS).powf(2.0 / 3.0);
    let found = last.clearances[0].penetration;
    assert!((found - depth).abs() <= 1e-6 * depth, "{found:e} m, exact {depth:e} m");
    assert!(last.clearances[0].in_contact && kept.contacts.len() > 5);
    assert!(kept.contacts.last().unwrap().end.is_nan());
    let fallen = 0.05 * 9.81 * (CLEARANCE + depth);
    let lost = last.energy.dissipated + last.energy.elastic;
    assert!((lost - fallen).abs() <= 1e3 * TOLERANCE * fallen, "{lost:e} of {fallen:e} J");
}

#[test]
fn flights_are_straight_and_end_at_the_root_of_a_quadratic() {
    for (x, y, vx, vy) in [
        (0.0, 0.0, 0.3, 0.4),
        (5e-4, 0.0, 0.0, 1.0),
        (-3e-4, 8e-4, 0.7, -0.2),
        (9.5e-4, 1e-4, -2.0, 0.5),
    ] {
        let start = format!(
            "x = {x:?}\ny = {y:?}\nangle = 0.5\n\
             velocity_x = {vx:?}\nvelocity_y = {vy:?}\nangular_velocity = -20.0"
        );
        let kept = journal(HERTZ, &start, "", 0.02, 1e-5);
        // |p + v t| = c
        let (vv, pv, pp) = (vx * vx + vy * vy, x * vx + y * vy, x * x + y * y);
        let root = (pv * pv - vv * (pp - CLEARANCE * CLEARANCE)).sqrt();
        let first = (root - pv) / vv;
        let begin = kept.contacts[0].begin;
        assert!((begin - first).abs() <= 10.0 * TOLERANCE * first, "{begin:e}, exact {first:e} s");
        for sample in kept.samples.iter().take_while(|sample| sample.time < first) {
            let journal = &sample.bodies[0];
            let t = sample.time;
            for (found, exact) in journal.position.iter().zip([x + vx * t, y + vy * t]) {
                assert!((found - exact).abs() <= 10.0 * TOLERANCE * CLEARANCE);
            }
            assert_eq!(journal.velocity, [vx, vy]);
            assert!((journal.angle - (0.5 - 20.0 * t)).abs() <= 10.0 * TOLERANCE);
        }
        // an elastic contact without friction keeps speed and swing: every chord is the same
        let chord = 2.0 * root / vv;
        assert!(kept.contacts.len() >= 4);
        for pair in kept.contacts.windows(2) {
            let flight = pair[1].begin - pair[0].end;
            assert!((flight - chord).abs() <= 1e4 * TOLERANCE * chord, "{flight:e}, {chord:e} s");
        }
        let swing = 0.05 * (x * vy - y * vx);
        let about_centre = |s: &freeplay::mechanism::Observation| {
            let journal = &s.bodies[0];
            let ([x, y], [vx, vy]) = (journal.position, journal.velocity);
            0.05 * (x * vy - y * vx)
        };
        let off = kept.largest(|sample| about_centre(sample) - swing);
        assert!(off <= 1e3 * TOLERANCE * 0.05 * CLEARANCE * vv.sqrt(), "{off:e}");
        assert_eq!(kept.last().bodies[0].angular_velocity, -20.0);
    }
}

/// The journal's centre is held by an ideal joint, 0.1 mm deep in the bearing's wall, where
/// K = 10⁸ N/m^1.5 presses with 100 N.
#[test]
fn a_journal_held_against_its_bearing_spins_down_as_friction_tells() {
    let law = r#"
        normal = { law = "hertz", stiffness = 1e8 }
        friction = { law = "ambrosio", coefficient = 0.1, v0 = 1e-3, v1 = 1e-2 }"#;
    let start = "x = 0.0011\ny = 0.0\nangle = 0.0\n\
                 velocity_x = 0.0\nvelocity_y = 0.0\nangular_velocity = 50.0";
    let hold = r#"
        [joints.hold]
        kind = "revolute"
        between = ["ground.P", "journal.C"]"#;
    let kept = journal(law, start, hold, 2e-3, 1e-5);
    let (radius, inertia, force, v0, v1): (f64, f64, f64, f64, f64) =
        (0.009, 2e-6, 10.0, 1e-3, 1e-2);
    let slowing = radius * force / inertia;
    let sliding_until = (50.0 - v1 / radius) / slowing;
    assert!((sliding_until - 1.086_419_753_086_42e-3).abs() < 1e-17);
    let decay = inertia * (v1 - v0) / (radius * radius * force);
    for sample in &kept.samples {
        let t = sample.time;
        let slip: f64 = match t < sliding_until {
            true => radius * (50.0 - slowing * t),
            false => v0 + (v1 - v0) * (-(t - sliding_until) / decay).exp(),
        };
        let found = sample.bodies[0].angular_velocity;
        assert!((found - slip / radius).abs() <= 1e3 * TOLERANCE * 50.0, "{found} at {t} s");
        assert!(
            (sample.clearances[0].slip_velocity - radius * found).abs() <= 1e-13 * radius * 50.0
        );
        // where slip is left at v0, friction is gone: the tangential force lies across the hold
        let tangential = -force * ((slip - v0) / (v1 - v0)).clamp(0.0, 1.0);
        let off = (sample.clearances[0].tangential_force - tangential).abs();
        assert!(off <= 1e3 * TOLERANCE * 50.0 * radius / (v1 - v0) * force, "{off:e} N at {t} s");
        let held = sample.joints[1].force;
        let clearance = &sample.clearances[0];
        assert!((held[0] - clearance.normal_force).abs() <= 1e-12 * 100.0);
        assert!((held[1] + clearance.tangential_force).abs() <= 1e-12 * 100.0);
        let spin = 0.5 * inertia * (50.0_f64.powi(2) - found.powi(2));
        assert!((sample.energy.dissipated - spin).abs() <= 1e3 * TOLERANCE * 2.5e-3);
    }
    let kinks: Vec<_> =
        kept.events.iter().filter(|event| event.kind == EventKind::FrictionKink).collect();
    // on the way down the edge lies lower by ten times the root of the rounding
    let late = 10.0 * f64::EPSILON.sqrt() * v1 / (radius * slowing);
    let off = (kinks[0].time - sliding_until - late).abs();
    assert!(off <= 1e2 * TOLERANCE * sliding_until, "{off:e} s");
    assert!((kinks[0].rate - v1).abs() <= 1e-6 * v1);
    // the slip decays onto v0 and makes no storm of events there
    assert!(kinks.len() <= 2, "{} kinks", kinks.len());
}
