//! N four-bars in a row, all links of 1 m and 1 kg. Known in advance: all cranks turn alike, so that
//! energy alone tells how fast at each angle,
//! ```text
//! ½ ((N + 1)/3 + N) θ̇² + g ((N + 1)/2 + N) sin θ = const,
//! ```
//! and a quadrature when; and that work beside the number of bodies is the same for any N.

mod simulated;

use freeplay::mechanism::Observation;
use freeplay::model::Owner;
use freeplay::run::{EventKind, Progress, Trajectory};
use freeplay::simulate::Simulation;
use simulated::{Kept, case_of, simulate, words};
use std::ops::ControlFlow;
use std::process::Command;

const GRAVITY: f64 = 9.81;

/// The text of a case of so many four-bars, as the program writes it.
fn four_bars(count: usize) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chain.toml");
    let mut new = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    new.args(["new", "four-bars", "--count", &count.to_string(), "-o"]).arg(&path);
    assert!(new.output().unwrap().status.success());
    std::fs::read_to_string(path).unwrap()
}

/// θ̇² (rad²/s²) of N four-bars that stood upright at 1 rad/s, at the angle θ (rad).
fn rate_squared(count: usize, angle: f64) -> f64 {
    let n = count as f64;
    1.0 + 2.0 * GRAVITY * ((n + 1.0) / 2.0 + n) / ((n + 1.0) / 3.0 + n) * (1.0 - angle.sin())
}

/// Time (s) from upright down to the angle (rad): Gauss's rule of five points on short panels.
fn time_to(count: usize, angle: f64) -> f64 {
    let nodes = [
        (0.0, 128.0 / 225.0),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let upright = std::f64::consts::FRAC_PI_2;
    let half = (upright - angle) / 400.0;
    let panel = |k: usize| upright - (2 * k + 1) as f64 * half;
    let slowness = |angle: f64| rate_squared(count, angle).sqrt().recip();
    let sum = (0..200).flat_map(|k| {
        nodes.into_iter().map(move |(node, weight)| match node {
            0.0 => weight * slowness(panel(k)),
            _ => weight * (slowness(panel(k) + node * half) + slowness(panel(k) - node * half)),
        })
    });
    half * sum.sum::<f64>()
}

/// Holds the motion of a chain against the closed form, to this accuracy.
fn assert_falls(count: usize, kept: &Kept, accuracy: f64) {
    for sample in &kept.samples {
        let first = &sample.bodies[0];
        let exact = -rate_squared(count, first.angle).sqrt();
        for crank in &sample.bodies[..=count] {
            assert!((crank.angular_velocity - exact).abs() < accuracy, "{}", sample.time);
            assert!((crank.angle - first.angle).abs() < accuracy, "{}", sample.time);
        }
        let coupler = &sample.bodies[2 * count];
        assert!(coupler.angle.abs() < accuracy && coupler.angular_velocity.abs() < accuracy);
        let late = time_to(count, first.angle) - sample.time;
        assert!(late.abs() < accuracy, "{late:e} s at {} s", sample.time);
    }
}

#[test]
fn chains_fall_as_one_crank_does_with_small_matrices_and_with_large_ones() {
    for (count, engine, accuracy) in
        [(1, "explicit", 1e-11), (1, "ida", 1e-10), (40, "explicit", 1e-11), (40, "ida", 1e-10)]
    {
        let engine = format!("solver.engine={engine}");
        let kept = simulate(&case_of(&four_bars(count), &[&engine, "run.duration=0.5"]));
        assert_eq!(kept.samples.len(), 51);
        assert_falls(count, &kept, accuracy);
    }
}

#[test]
fn a_longer_chain_takes_no_more_steps_and_no_more_looks_into_them() {
    let counts = |count: usize, engine: &str| {
        let engine = format!("solver.engine={engine}");
        let case = case_of(&four_bars(count), &[&engine, "run.duration=0.2"]);
        let kept = simulate(&case);
        ["steps", if engine.ends_with("ida") { "residual_evaluations" } else { "right_hand_sides" }]
            .map(|name| kept.count(name))
    };
    for engine in ["explicit", "ida"] {
        let (short, long) = (counts(10, engine), counts(60, engine));
        for (short, long) in short.into_iter().zip(long) {
            assert!(long as f64 <= 1.3 * short as f64, "{engine}: {long} after {short}");
        }
    }
}

#[test]
fn a_hanging_chain_keeps_its_energy() {
    let keys = [
        "loads.gravity.acceleration=[0.0, 9.81]",
        "start.crank0.angular_velocity=-0.1",
        "run.duration=10.0",
        "run.sample_interval=0.1",
    ];
    for engine in ["explicit", "ida"] {
        let engine = format!("solver.engine={engine}");
        let kept = simulate(&case_of(&four_bars(40), &[&keys[..], &[&*engine]].concat()));
        let largest = kept.largest(|sample| sample.energy.kinetic);
        let energy = |sample: &Observation| sample.energy.kinetic + sample.energy.potential;
        let first = energy(&kept.samples[0]);
        let off = kept.largest(|sample| energy(sample) - first) / largest;
        assert!(off < 1e-9, "{engine}: {off:e}");
    }
}

#[test]
fn a_long_chain_is_assembled_from_rough_poses() {
    for count in [20, 60] {
        // poses off by centimetres, more in some places than in others
        let mut rough = String::new();
        for (number, line) in four_bars(count).lines().enumerate() {
            let line = match line.split_once("{ x = ") {
                Some((before, rest)) if !line.starts_with('#') => {
                    let (x, rest) = rest.split_once(',').unwrap();
                    let x = x.parse::<f64>().unwrap() + 0.03 * (number as f64).sin();
                    format!("{before}{{ x = {x},{rest}")
                }
                _ => line.to_owned(),
            };
            rough += &(line + "\n");
        }
        let case = case_of(&rough, &[]);
        let simulation = Simulation::new(&case).unwrap();
        let mechanism = simulation.mechanism();
        let q = &mechanism.start().q;
        for crank in 0..=count {
            assert!((q[3 * crank + 2] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        }
    }
}

/// Text of a chain of one four-bar with more in it.
fn chain_with(more: &str) -> String {
    four_bars(1).replace("[start]", &format!("{more}\n[start]"))
}

#[test]
fn chains_go_on_through_positions_in_which_all_links_lie_flat() {
    for (count, engine, accuracy) in
        [(1, "explicit", 1e-8), (1, "ida", 1e-7), (10, "explicit", 1e-8), (10, "ida", 1e-7)]
    {
        let engine = format!("solver.engine={engine}");
        let keys = [&*engine, "run.duration=10.0", "solver.relative_tolerance=1e-12"];
        let kept = simulate(&case_of(&four_bars(count), &keys));
        assert_eq!(kept.samples.len(), 1001);
        assert_falls(count, &kept, accuracy);
        let energy = |sample: &Observation| sample.energy.kinetic + sample.energy.potential;
        let largest = kept.largest(|sample| sample.energy.kinetic);
        let first = energy(&kept.samples[0]);
        let off = kept.largest(|sample| energy(sample) - first) / largest;
        assert!(off < 1e-10, "{engine}: {off:e}");
        assert_eq!(kept.events.len(), 10);
        for (k, event) in kept.events.iter().enumerate() {
            assert!(matches!(event.owner, Owner::Joint(_)));
            assert_eq!((event.kind, event.rate), (EventKind::Singular, 0.0));
            let late = event.time - time_to(count, -(k as f64) * std::f64::consts::PI);
            assert!(late.abs() < accuracy, "{engine}: {late:e}");
        }
    }
}

#[test]
fn a_longer_chain_goes_through_flat_positions_too() {
    for engine in ["solver.engine=explicit", "solver.engine=ida"] {
        let kept = simulate(&case_of(&four_bars(60), &[engine, "run.duration=1.5"]));
        assert_falls(60, &kept, 1e-7);
        assert_eq!(kept.events.len(), 2);
    }
}

#[test]
fn what_only_translates_costs_no_more_at_the_smallest_absolute_tolerance() {
    let steps = |absolute: &str| {
        let absolute = format!("solver.absolute_tolerance={absolute}");
        let keys = ["solver.engine=ida", "run.duration=0.5", &absolute];
        simulate(&case_of(&four_bars(2), &keys)).count("steps")
    };
    let (scaled, smallest) = (steps("\"scaled\""), steps("1e-20"));
    assert!(smallest < 3 * scaled, "{smallest} and {scaled}");
}

/// Assert that a chain stops where it lies flat first, and says so.
fn assert_stops(text: &str, word: &str, first: f64) {
    for engine in ["explicit", "ida"] {
        let engine = format!("solver.engine={engine}");
        let case = case_of(text, &[&engine, "run.duration=1.0"]);
        let mut go_on = |_: &Progress| ControlFlow::Continue(());
        let mut kept = Trajectory::default();
        let (_, ran) = Simulation::new(&case).unwrap().run(&mut kept, &mut go_on);
        let error = words(&ran.unwrap_err());
        assert!(error.contains(word), "{error}");
        let [event] = kept.events[..] else { panic!("{:?}", kept.events) };
        assert_eq!(event.kind, EventKind::Singular);
        assert!(matches!(event.owner, Owner::Joint(_)) && event.rate < 1e-10, "{event:?}");
        let told = error.split("t = ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
        assert!((told.parse::<f64>().unwrap() - first).abs() < 1e-3, "{error} {first}");
        assert!((event.time - first).abs() < 1e-3, "{event:?} {first}");
    }
}

#[test]
fn a_chain_whose_way_on_is_not_clear_stops_and_says_where_it_is_singular() {
    let flat = time_to(1, 0.0);
    // friction hangs on forces that have no bound there
    let friction = "[loads.rub]
kind = \"joint-friction\"
joint = \"L1\"
pin_radius = 1e-9
friction = { law = \"tanh\", coefficient = 0.1, transition = 1e-3 }
";
    assert_stops(&chain_with(friction), "singular position", flat);
    // a parallelogram but for less than doubles can tell: it would go over to the other branch
    for hair in ["0.50000000000000000000001", "0.5000000000001"] {
        let text = four_bars(1).replacen("R = [0.5, 0.0]", &format!("R = [{hair}, 0.0]"), 1);
        assert_ne!(text, four_bars(1));
        assert_stops(&text, "singular position", flat);
    }
}

#[test]
fn no_tolerance_is_so_loose_that_a_chain_is_led_over_a_way_that_is_not_clear() {
    let hair = "R = [0.50000000000000000000001, 0.0]";
    let text = four_bars(1).replacen("R = [0.5, 0.0]", hair, 1);
    for engine in ["explicit", "ida"] {
        for tolerance in ["1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8"] {
            let engine = format!("solver.engine={engine}");
            let tolerance = format!("solver.relative_tolerance={tolerance}");
            let case = case_of(&text, &[&engine, &tolerance, "run.duration=1.0"]);
            let mut go_on = |_: &Progress| ControlFlow::Continue(());
            let (_, ran) =
                Simulation::new(&case).unwrap().run(&mut Trajectory::default(), &mut go_on);
            let error = words(&ran.unwrap_err());
            assert!(error.contains("singular position"), "{engine}, {tolerance}: {error}");
        }
    }
}

#[test]
fn a_chain_that_misses_its_flat_position_by_a_hair_goes_over_to_the_other_branch() {
    // what doubles can tell: a nanometre, as 71 digits have it
    let text = four_bars(1).replacen("R = [0.5, 0.0]", "R = [0.500000001, 0.0]", 1);
    let at_end = |set: &[&str]| {
        let kept = simulate(&case_of(&text, &[set, &["run.duration=1.0"]].concat()));
        assert!(kept.events.is_empty());
        kept.last().bodies.iter().map(|body| body.angle).collect::<Vec<_>>()
    };
    let octuple = ["solver.engine=explicit", "solver.precision=71"];
    let truth = at_end(&[&octuple[..], &["solver.reference_tolerance=1e-40"]].concat());
    for engine in ["solver.engine=explicit", "solver.engine=ida"] {
        let found = at_end(&[engine, "solver.relative_tolerance=1e-9"]);
        for (found, truth) in found.iter().zip(&truth) {
            assert!((found - truth).abs() < 1e-6, "{engine}: {found} {truth}");
        }
    }
}
