//! Lyapunov exponents. Known in advance: those of linear systems, from the roots of their
//! characteristic polynomials; that the sum of all is the mean divergence of the flow, which an impact
//! adds twice the logarithm of its rebound ratio to; those of an impact oscillator whose flights and impacts
//! are closed forms, iterated here; that a motion which keeps its energy has pairs of opposite sign and
//! two zeros, in doubles and in 71 digits alike.

mod simulated;

use freeplay::chaos::{Error, Lyapunov, Plan, Span, lyapunov};
use freeplay::contact::rebound;
use simulated::{case, case_of, simulate, told, words};
use std::f64::consts::TAU;
use std::num::NonZeroUsize;

const FAST: [&str; 2] = ["solver.engine=explicit", "solver.relative_tolerance=1e-11"];

fn plan(span: Span, discard: u64, exponents: Option<usize>) -> Plan {
    Plan { span, discard, exponents, jobs: NonZeroUsize::new(2).unwrap() }
}

fn found(text: &str, set: &[&str], plan: &Plan) -> Lyapunov {
    told(lyapunov(&case_of(text, set), plan, &mut |_, _| ()))
}

/// All exponents, in e-folds per second.
fn per_second(found: &Lyapunov) -> Vec<f64> {
    found.exponents.iter().map(|exponent| exponent.per_lap / found.lap).collect()
}

fn sum_per_second(found: &Lyapunov) -> f64 {
    found.sum.unwrap().per_lap / found.lap
}

/// A mass of 0.5 kg on a slide with a spring of 200 N/m and a damper (N s/m).
fn oscillator(damping: f64) -> String {
    format!(
        "[ground]\npoints = {{ P = [0.0, 0.0], S = [-1.0, 0.0] }}\n\
         [bodies.mass]\nmass = 0.5\ninertia = 0.01\npoints = {{ C = [0.0, 0.0] }}\n\
         [joints.rail]\nkind = \"prismatic\"\nbetween = [\"ground.P\", \"mass.C\"]\naxis = [1.0, 0.0]\n\
         [loads.spring]\nkind = \"spring\"\nbetween = [\"ground.S\", \"mass.C\"]\n\
         stiffness = 200.0\nfree_length = 0.9\ndamping = {damping:?}\n\
         [start]\nmass = {{ x = 0.05, velocity_x = 1.0, fixed = true }}\n\
         [run]\nduration = 2.0\nsample_interval = 0.1\n"
    )
}

#[test]
fn a_linear_oscillator_has_the_roots_of_its_characteristic_polynomial() {
    let (mass, stiffness) = (0.5, 200.0);
    // underdamped: both decay alike, turning as they go; what turns is bounded, and the sum is exact
    let both = found(&oscillator(4.0), &FAST, &plan(Span::Case, 0, None));
    assert_eq!((both.states, both.exponents.len()), (2, 2));
    assert!((sum_per_second(&both) + 4.0 / mass).abs() < 1e-8, "{both:?}");
    // a circle becomes an ellipse, of axes as unlike as √(k/m) and the ratio of the scales, and again a circle
    let apart = |exponent: f64| (exponent + 0.5 * 4.0 / mass).abs();
    assert!(per_second(&both).into_iter().all(|exponent| apart(exponent) < 4.0 / 2.0), "{both:?}");
    // overdamped: two directions, which tangents find as fast as they part
    let damping: f64 = 40.0;
    let root = (damping * damping - 4.0 * mass * stiffness).sqrt();
    let exact = [-(damping - root) / (2.0 * mass), -(damping + root) / (2.0 * mass)];
    let each = found(&oscillator(damping), &FAST, &plan(Span::Case, 10, None));
    for (exponent, exact) in per_second(&each).into_iter().zip(exact) {
        assert!((exponent - exact).abs() < 1e-7 * exact.abs(), "{exponent}, exact {exact}");
    }
    assert_eq!(each.dimension.unwrap().value, 0.0);
}

#[test]
fn the_sum_of_all_exponents_is_the_mean_divergence_of_a_damped_pendulum() {
    // θ̈ = −d θ̇/J − …: the divergence is −d/J wherever it is
    let damper = "[loads.damper]\nkind = \"torsion-spring\"\nbetween = [\"ground\", \"rod\"]\n\
                  stiffness = 0.0\ndamping = 0.03\n";
    let text = std::fs::read_to_string(simulated::root().join("cases/pendulum.toml")).unwrap();
    // from rest to rest: in between the scales of coordinates have areas breathe with the speed
    let found = found(&format!("{text}\n{damper}"), &FAST, &plan(Span::Time(80.0), 0, None));
    let exact = -0.03 / 0.06;
    let sum = sum_per_second(&found);
    assert!((sum - exact).abs() < 1e-7, "{sum} and {exact}");
    assert!(!found.zeros.known.keeps_energy && found.zeros.known.autonomous);
}

/// A mass that slides to and fro in a slot of 2 · 10 mm, which a harmonic drive shakes.
fn shaken(amplitude: f64, frequency: f64, normal: &str, velocity: f64) -> String {
    format!(
        "[ground]\npoints = {{ P = [0.0, 0.0] }}\n\
         [bodies.slot]\nmass = 1.0\ninertia = 0.01\npoints = {{ C = [0.0, 0.0] }}\n\
         [bodies.mass]\nmass = 0.05\ninertia = 1e-4\npoints = {{ C = [0.0, 0.0] }}\n\
         [joints.rail]\nkind = \"prismatic\"\nbetween = [\"ground.P\", \"slot.C\"]\naxis = [1.0, 0.0]\n\
         [joints.guide]\nkind = \"prismatic\"\nbetween = [\"slot.C\", \"mass.C\"]\naxis = [1.0, 0.0]\n\
         [joints.walls]\nkind = \"revolute\"\nbetween = [\"slot.C\", \"mass.C\"]\n\
         [joints.walls.clearance]\nbearing_radius = 0.1\nradial = 0.01\nnormal = {{ {normal} }}\n\
         [drives.shake]\njoint = \"rail\"\nkind = \"harmonic\"\namplitude = {amplitude:?}\n\
         angular_frequency = {frequency:?}\n\
         [start]\nmass = {{ x = {amplitude:?}, velocity_x = {velocity:?}, fixed = true }}\n\
         [run]\nduration = 0.5\nsample_interval = 0.5\n"
    )
}

#[test]
fn an_impact_shrinks_areas_by_the_square_of_its_rebound_ratio() {
    // nothing shakes: each impact has the ratio by itself, whatever its speed
    for (restitution, ratio) in [(0.9, 0.913_176_677_805_581_f64), (0.5, 0.725_241_114_010_197)] {
        let law = format!(
            "law = \"lankarani-nikravesh\", restitution = {restitution:?}, stiffness = 1e10"
        );
        let text = shaken(0.0, 200.0, &law, 1.3);
        let found = found(&text, &FAST, &plan(Span::Revolutions(9), 0, None));
        let end = format!("run.duration={:?}", 9.0 * found.lap);
        let set = [FAST[0], FAST[1], &end];
        let impacts = simulate(&case_of(&text, &set)).contacts.len() as f64;
        assert!(impacts > 5.0);
        let shrunk = found.sum.unwrap().per_lap * found.laps as f64;
        let exact = 2.0 * impacts * ratio.ln();
        assert!((shrunk - exact).abs() < 1e-6 * exact.abs(), "{shrunk}, exact {exact}");
    }
}

/// The same slot with hard walls: flights are straight lines, impacts turn the speed relative to the slot
/// into −ρ of it. Growth of a tangent in each period, and impacts in all.
fn hard_walls(
    amplitude: f64,
    frequency: f64,
    ratio: f64,
    velocity: f64,
    periods: u64,
) -> (Vec<f64>, u64) {
    let half_width = 0.01;
    let wall = |t: f64| amplitude * (frequency * t).cos();
    let wall_rate = |t: f64| -amplitude * frequency * (frequency * t).sin();
    let wall_bend = |t: f64| -amplitude * frequency * frequency * (frequency * t).cos();
    let (mut t, mut x, mut v) = (0.0, amplitude, velocity);
    let (mut dx, mut dv) = (1e-2, 1.0);
    let (mut growth, mut impacts) = (Vec::new(), 0);
    for period in 1..=periods {
        let end = TAU / frequency * period as f64;
        let before = f64::hypot(dx / 1e-2, dv);
        while t < end {
            // the first passage of a wall, in small strides and by halving
            let off = |s: f64| (x + v * (s - t) - wall(s)).abs() - half_width;
            let stride = 1e-3 * TAU / frequency;
            let mut low = t;
            while low < end && off((low + stride).min(end)) <= 0.0 {
                low += stride;
            }
            if low >= end {
                (x, dx, t) = (x + v * (end - t), dx + dv * (end - t), end);
                break;
            }
            let mut high = (low + stride).min(end);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if off(middle) > 0.0 { high = middle } else { low = middle }
            }
            // on the inner side of the wall
            (x, dx, t) = (x + v * (low - t), dx + dv * (low - t), low);
            let approach = v - wall_rate(t);
            dv = -ratio * dv - (1.0 + ratio) * wall_bend(t) * dx / approach;
            dx *= -ratio;
            v = wall_rate(t) - ratio * approach;
            impacts += 1;
        }
        let after = f64::hypot(dx / 1e-2, dv);
        growth.push((after / before).ln());
        (dx, dv) = (dx / after, dv / after);
    }
    (growth, impacts)
}

#[test]
fn an_impact_oscillator_has_the_exponents_of_its_closed_form() {
    let (amplitude, frequency, periods) = (0.02, 40.0, 400);
    let ratio = rebound(0.75 * (1.0 - 0.9 * 0.9));
    let law = "law = \"lankarani-nikravesh\", restitution = 0.9, stiffness = 1e10";
    let text = shaken(amplitude, frequency, law, 0.7);
    let found = found(&text, &FAST, &plan(Span::Revolutions(periods), 0, None));
    let (growth, impacts) = hard_walls(amplitude, frequency, ratio, 0.7, periods);
    let exact = growth.iter().sum::<f64>() / periods as f64;
    let largest = found.exponents[0];
    // chaotic: statistics agree, trajectories do not
    assert!(exact > 1.0, "{exact}");
    let apart = (largest.per_lap - exact).abs();
    assert!(apart < 2.0 * largest.half_width.unwrap(), "{largest:?} and {exact}");
    // what walls that give way for a ten thousandth of a second change
    let expected = 2.0 * ratio.ln() * impacts as f64 / periods as f64;
    let sum = found.sum.unwrap();
    assert!((sum.per_lap - expected).abs() < 0.02 * expected.abs(), "{sum:?} and {expected}");
    let dimension = found.dimension.unwrap().value;
    assert!((dimension - 1.0 - largest.per_lap / (largest.per_lap - sum.per_lap)).abs() < 1e-12);
    assert_eq!(found.zeros.expected(), 0);
    assert!(found.zeros.found.is_empty(), "{:?}", found.zeros);
}

#[test]
fn a_double_pendulum_has_pairs_and_two_zeros_in_two_arithmetics() {
    let of = |set: &[&str], time: f64| {
        let case = case("tests/cases/double-pendulum.toml", set);
        told(lyapunov(&case, &plan(Span::Time(time), 0, None), &mut |_, _| ()))
    };
    let doubles = of(&["solver.engine=explicit", "solver.relative_tolerance=1e-13"], 0.2);
    let digits = of(
        &["solver.engine=explicit", "solver.precision=71", "solver.reference_tolerance=1e-20"],
        0.2,
    );
    for (double, digits) in doubles.exponents.iter().zip(&digits.exponents) {
        let apart = (double.per_lap - digits.per_lap).abs();
        assert!(apart < 1e-9, "{double:?} and {digits:?}");
    }
    let long = of(&FAST, 60.0);
    assert!(long.zeros.known.keeps_energy && long.zeros.expected() == 2);
    assert_eq!(long.zeros.found, [1, 2], "{:?}", long.exponents);
    // Liouville: volumes stay, but that those in the scales of coordinates breathe with the speeds
    let sum = long.sum.unwrap().per_lap.abs();
    assert!(sum < 0.05 * long.exponents[0].per_lap, "{:?}", long.exponents);
    let [first, .., last] = long.exponents[..] else { panic!("four exponents") };
    assert!(first.per_lap > 1.0 && (first.per_lap + last.per_lap).abs() < 0.2 * first.per_lap);
}

#[test]
fn what_cannot_be_told_is_said() {
    let refused = |set: &[&str], plan: &Plan| -> Error {
        let case = case("cases/four-bar-a.toml", set);
        lyapunov(&case, plan, &mut |_, _| ()).unwrap_err()
    };
    let five = Span::Revolutions(5);
    for (error, part) in [
        (refused(&[], &plan(five, 0, Some(5))), "it has 4 exponents, twice its freedoms; 5 cannot"),
        (refused(&[], &plan(five, 5, Some(1))), "no revolution counts: it lasts 5, of which 5"),
        (refused(&[], &plan(Span::Time(1e-3), 0, Some(1))), "no revolution counts: it lasts 0"),
    ] {
        assert!(words(&error).contains(part), "{error}");
    }
    let pendulum = case("cases/pendulum.toml", &[]);
    let error = lyapunov(&pendulum, &plan(five, 0, Some(1)), &mut |_, _| ()).unwrap_err();
    assert!(matches!(error, Error::NoRevolutions));
    let ideal = case("cases/four-bar-ideal.toml", &[]);
    let error = lyapunov(&ideal, &plan(five, 0, Some(1)), &mut |_, _| ()).unwrap_err();
    assert!(matches!(error, Error::NoFreedom));
}
