//! Smooth motion: an oscillator, a pendulum.

use super::systems::{Oscillators, Pendulum};
use super::*;
use crate::dae::Direction;
use crate::engine::testing::Relaxing;
use crate::scalar::F256;

/// Largest error of an oscillator of ω = 2 after some periods, sampled within every step.
fn oscillator_error<S: Scalar>(options: Options) -> f64 {
    let omega = number::<S>("2");
    let system = Oscillators::new(3, omega, S::zero(), Direction::Off);
    let mut engine = started(system, options, vec![S::one(); 3], vec![S::zero(); 3]);
    let mut at = engine.now().clone();
    let mut error: f64 = 0.0;
    let end = number::<S>("7.3");
    while engine.now().time < end {
        engine.step(end).unwrap();
        let (began, now) = (engine.began(), engine.now().time);
        for part in ["0.01", "0.3", "0.77", "1"] {
            let time = (began + (now - began) * number(part)).min(now);
            engine.within(time, &mut at).unwrap();
            let (sin, cos) = (omega * time).sin_cos();
            error = error.max((at.q[2] - cos).abs().to_f64());
            error = error.max((at.v[2] + omega * sin).abs().to_f64() / 2.0);
        }
    }
    error
}

#[test]
fn an_oscillator_keeps_its_digits_in_doubles() {
    for method in [Method::RungeKutta, Method::Extrapolation] {
        for tolerance in [1e-8, 1e-11, 1e-14] {
            let options = Options { method: Some(method), ..options(tolerance, 1e-3) };
            let error = oscillator_error::<f64>(options);
            assert!(error < 30.0 * tolerance, "{method:?} at {tolerance:e}: {error:e}");
        }
    }
}

#[test]
fn an_oscillator_keeps_its_digits_in_71() {
    for tolerance in [1e-30, 1e-50, 1e-60] {
        let error = oscillator_error::<F256>(options(tolerance, 1e-3));
        assert!(error < 10.0 * tolerance, "at {tolerance:e}: {error:e}");
    }
}

#[test]
fn looks_into_a_step_are_as_true_as_it_and_take_four_right_hand_sides_together() {
    let system = Oscillators::new(3, 2.0, 0.0, Direction::Off);
    let mut engine = started(system, options(1e-12, 1e-3), vec![1.0; 3], vec![0.0; 3]);
    let mut at = engine.now().clone();
    let sides = |engine: &Explicit<f64, Oscillators<f64>>| {
        engine.counts().iter().find(|count| count.name == "right_hand_sides").unwrap().value
    };
    while engine.now().time < 7.3 {
        engine.step(7.3).unwrap();
        let before = sides(&engine);
        let (began, now) = (engine.began(), engine.now().time);
        for part in [0.05, 0.3, 0.5, 0.77, 0.95] {
            engine.glance(began + (now - began) * part, 1e-18, &mut at).unwrap();
            let (sin, cos) = (2.0 * at.time).sin_cos();
            let error = (at.q[2] - cos).abs().max((at.v[2] + 2.0 * sin).abs() / 2.0);
            assert!(error < 30e-12, "{error:e} at {}", at.time);
        }
        assert_eq!(sides(&engine) - before, 4);
    }
}

/// Half period of the pendulum from one radian, from one passage through the vertical to the
/// next: π / agm(1, cos ½).
const HALF_PERIOD: &str =
    "3.34998783218522635635060568958050771361403816448688815704019639348894044279";

fn half_period<S: Scalar>(cartesian: bool, options: Options) -> f64 {
    let system = Pendulum::new(cartesian);
    let q = system.at(S::one());
    let v = vec![S::zero(); q.len()];
    let mut engine = started(system, options, q, v);
    let mut passages = Vec::new();
    for _ in 0..2 {
        assert_eq!(go(&mut engine, number("20")), Advance::Event);
        assert_eq!(engine.fired(), [true]);
        passages.push(engine.now().time);
        let now = engine.now().clone();
        engine.restart(&now).unwrap();
    }
    let half: S = (passages[1] - passages[0]) * number("0.5");
    apart(half, number(HALF_PERIOD))
}

#[test]
fn a_pendulum_swings_as_the_mean_says() {
    for cartesian in [false, true] {
        for tolerance in [1e-10, 1e-14] {
            let error = half_period::<f64>(cartesian, options(tolerance, 1e-3));
            assert!(error < 30.0 * tolerance, "cartesian {cartesian}: {error:e}");
        }
        let error = half_period::<F256>(cartesian, options(1e-60, 1e-3));
        assert!(error < 1e-58, "cartesian {cartesian}: {error:e}");
    }
}

/// Largest error of a force that remembers over two seconds, sampled within every step.
fn relaxing_error<S: Scalar>(options: Options) -> f64 {
    let mut engine = started(Relaxing::<S>::new(), options, vec![S::zero()], vec![S::one()]);
    let mut at = engine.now().clone();
    let mut error: f64 = 0.0;
    let end = number::<S>("2");
    while engine.now().time < end {
        engine.step(end).unwrap();
        let (began, now) = (engine.began(), engine.now().time);
        for part in ["0", "0.3", "0.8", "1"] {
            let time = (began + (now - began) * number(part)).min(now);
            engine.within(time, &mut at).unwrap();
            let exact = Relaxing::at(time);
            for (found, exact) in [at.q[0], at.v[0], at.z[0]].into_iter().zip(exact) {
                error = error.max((found - exact).abs().to_f64());
            }
        }
        let here = engine.now().clone();
        engine.restart(&here).unwrap();
    }
    error
}

#[test]
fn what_a_force_remembers_keeps_its_digits_in_both_arithmetics() {
    for tolerance in [1e-8, 1e-13] {
        let error = relaxing_error::<f64>(options(tolerance, 1e-3));
        assert!(error < 30.0 * tolerance, "at {tolerance:e}: {error:e}");
    }
    let error = relaxing_error::<F256>(options(1e-50, 1e-3));
    assert!(error < 1e-48, "{error:e}");
}
