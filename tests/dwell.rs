//! Friction with dwell time in whole runs. Known in advance: under a steady slip the deflection of the
//! bristles and the dwell are closed forms of time, and so is when the force comes to its limit; in
//! fast slip a wheel has Coulomb's friction; where a wheel swings, the law's formulas integrated in
//! steps so short that their kinks do not matter.

mod simulated;

use freeplay::case::Case;
use freeplay::mechanism::Observation;
use freeplay::run::EventKind;
use simulated::{Kept, case_of, simulate};

const RADIUS: f64 = 0.01;
const SLIDING: f64 = 0.1;
const RESTING: f64 = 0.15;
const STIFFNESS: f64 = 1e4;
const DAMPING: f64 = 10.0;
const STRIBECK: f64 = 1e-2;
const DWELL: f64 = 2e-3;
const TRANSITION: f64 = 1.5e-2;
/// K δ (N).
const NORMAL: f64 = 1e7 * 1e-5;

/// A start that is the wheel's, whatever the bearing says.
const HELD: &str = "[start]\nwheel = { x = 0.0, y = 0.0, fixed = true }\n";

/// A wheel on an ideal pivot, whose journal stands in the wall of a bearing beside it, by 10 µm, with
/// a drive or a start. Another wheel stands still, so that there is something to integrate.
fn wheel(turns: &str, set: &[&str]) -> Case {
    let text = format!(
        "[ground]\npoints = {{ O = [0.0, 0.0], W = [-0.00101, 0.0], P = [1.0, 0.0] }}\n\
         [bodies.other]\nmass = 0.3\ninertia = 1e-4\npoints = {{ P = [0.0, 0.0] }}\n\
         [joints.P]\nkind = \"revolute\"\nbetween = [\"ground.P\", \"other.P\"]\n\
         [bodies.wheel]\nmass = 0.3\ninertia = 1e-4\npoints = {{ O = [0.0, 0.0] }}\n\
         [joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"wheel.O\"]\n\
         [joints.W]\nkind = \"revolute\"\nbetween = [\"ground.W\", \"wheel.O\"]\n\
         [joints.W.clearance]\nbearing_radius = 0.011\nradial = 0.001\n\
         normal = {{ law = \"hertz\", stiffness = 1e7, exponent = 1.0 }}\n\
         friction = {{ law = \"gonthier\", coefficient = 0.1, static = 0.15, stiffness = 1e4, damping = 10.0, \
         stribeck = 1e-2, dwell_time = 2e-3, transition = 1.5e-2 }}\n\
         {turns}\n\
         [run]\nduration = 0.02\nsample_interval = 1e-5\n\
         [solver]\nabsolute_tolerance = \"scaled\"\nrelative_tolerance = 1e-12\n"
    );
    case_of(&text, set)
}

fn ratio(sample: &Observation) -> f64 {
    let seen = &sample.clearances[0];
    let off = (seen.normal_force / NORMAL - 1.0).abs();
    assert!(off < 1e-10, "{off:e}");
    seen.tangential_force / seen.normal_force
}

fn stick(slip: f64) -> f64 {
    (-(slip / STRIBECK).powi(2)).exp()
}

fn direction(slip: f64) -> f64 {
    let u = (slip / TRANSITION).clamp(-1.0, 1.0);
    0.5 * u * (3.0 - u * u)
}

/// ż and ẇ.
fn rates(slip: f64, [z, w]: [f64; 2]) -> [f64; 2] {
    let s = stick(slip);
    let slid = (SLIDING * direction(slip) - STIFFNESS * z) / DAMPING;
    let pace = if s >= w { 1.0 / DWELL } else { STIFFNESS / DAMPING };
    [s * slip + (1.0 - s) * slid, (s - w) * pace]
}

/// F_T/F_N.
fn force(slip: f64, at: [f64; 2]) -> f64 {
    let bristles = STIFFNESS * at[0] + DAMPING * rates(slip, at)[0];
    let most = SLIDING + (RESTING - SLIDING) * at[1];
    -bristles.clamp(-most, most)
}

fn kinks(kept: &Kept) -> Vec<f64> {
    let kinks = kept.events.iter().filter(|event| event.kind == EventKind::FrictionKink);
    kinks.map(|event| event.time).collect()
}

/// z and w at a time under a steady slip.
fn steady(slip: f64, time: f64) -> [f64; 2] {
    let s = stick(slip);
    let bent = (SLIDING * direction(slip) + s * slip * DAMPING / (1.0 - s)) / STIFFNESS;
    let pace = (1.0 - s) * STIFFNESS / DAMPING;
    [-bent * (-pace * time).exp_m1(), -s * (-time / DWELL).exp_m1()]
}

/// A motor turns the wheel; the force comes to its limit once, and stays there.
fn assert_steady(engine: &str, slip: f64, more: &[&str], within: f64) {
    let rpm = slip / RADIUS * 60.0 / std::f64::consts::TAU;
    let turns =
        format!("[drives.motor]\njoint = \"O\"\nkind = \"speed\"\nspeed_rpm = {rpm:e}\n{HELD}");
    let engine_set = format!("solver.engine={engine}");
    let set = [&[engine_set.as_str()], more].concat();
    let kept = simulate(&wheel(&turns, &set));
    let over = |time: f64| {
        let at = steady(slip, time);
        let bristles = STIFFNESS * at[0] + DAMPING * rates(slip, at)[0];
        bristles.abs() - (SLIDING + (RESTING - SLIDING) * at[1])
    };
    let (mut before, mut after) = (0.0, 0.02);
    assert!(over(before) < 0.0 && over(after) > 0.0);
    for _ in 0..100 {
        let middle = f64::midpoint(before, after);
        if over(middle) < 0.0 { before = middle } else { after = middle }
    }
    let met = kinks(&kept);
    assert_eq!(met.len(), 1, "{engine}: {met:?}");
    // the branch is left that much beyond the edge
    assert!((met[0] - before).abs() < 1e-8, "{engine}: {} {before}", met[0]);
    for sample in &kept.samples[1..] {
        let exact = force(slip, steady(slip, sample.time));
        assert!((ratio(sample) - exact).abs() < within, "{engine}: {} {exact}", sample.time);
    }
    println!("{engine}: at its limit after {:e} s, known {before:e} s", met[0]);
}

#[test]
fn under_a_steady_slip_bristles_and_dwell_are_closed_forms_on_both_engines() {
    for slip in [8e-3, -1.1e-2] {
        assert_steady("ida", slip, &[], 1e-8);
        assert_steady("explicit", slip, &[], 1e-8);
    }
}

#[test]
fn in_71_digits_it_is_to_the_last_place_of_doubles() {
    let more = ["solver.precision=71", "run.sample_interval=1e-4"];
    assert_steady("explicit", 8e-3, &more, 1e-14);
}

#[test]
fn in_fast_slip_a_wheel_has_coulombs_friction() {
    let start = "[start]\nwheel = { angle = 0.0, angular_velocity = 20.0, fixed = true }\n";
    for engine in ["solver.engine=ida", "solver.engine=explicit"] {
        let kept = simulate(&wheel(start, &[engine, "run.duration=0.01"]));
        for sample in &kept.samples {
            let exact = 20.0 - SLIDING * NORMAL * RADIUS / 1e-4 * sample.time;
            let found = sample.bodies[1].angular_velocity;
            assert!((found - exact).abs() < 1e-10 * 20.0, "{engine}: {found} {exact}");
        }
    }
}

/// A motor swings the wheel about its axis, at rest in between: z and w by Runge's and Kutta's
/// method.
#[test]
fn a_swinging_wheel_rubs_as_the_formulas_integrated_on_both_engines() {
    let (amplitude, frequency) = (3e-2_f64, 100.0_f64);
    let turns = format!(
        "[drives.motor]\njoint = \"O\"\nkind = \"harmonic\"\nmean = 0.0\namplitude = {amplitude:e}\n\
         angular_frequency = {frequency:e}\nphase = 0.0\n{HELD}"
    );
    let slip = |time: f64| -RADIUS * amplitude * frequency * (frequency * time).sin();
    let parts = 2000;
    let h = 1e-5 / f64::from(parts);
    for engine in ["ida", "explicit"] {
        let set = [&*format!("solver.engine={engine}"), "run.duration=0.07"];
        let kept = simulate(&wheel(&turns, &set));
        let (mut at, mut off, mut step) = ([0.0; 2], 0.0_f64, 0_u32);
        for sample in &kept.samples {
            let until = (sample.time / h).round() as u32;
            while step < until {
                let time = f64::from(step) * h;
                let go = |k: [f64; 2], h: f64| [at[0] + h * k[0], at[1] + h * k[1]];
                let k1 = rates(slip(time), at);
                let k2 = rates(slip(time + 0.5 * h), go(k1, 0.5 * h));
                let k3 = rates(slip(time + 0.5 * h), go(k2, 0.5 * h));
                let k4 = rates(slip(time + h), go(k3, h));
                let sum = [0, 1].map(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
                at = go(sum, h);
                step += 1;
            }
            off = off.max((ratio(sample) - force(slip(sample.time), at)).abs());
        }
        let met = kinks(&kept).len();
        println!("{engine}: {met} kinks, off by {off:.1e}");
        // the limit, the dwell and both edges of the slip, forward and backward
        assert!((12..60).contains(&met), "{engine}: {met} kinks");
        assert!(off < 1e-8, "{engine}: {off:e}");
    }
}
