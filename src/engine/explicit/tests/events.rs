//! Events hit, grazed, missed and met together.

use super::systems::{Oscillators, Throw};
use super::*;
use crate::dae::Direction;
use crate::scalar::F256;

/// A point thrown from inside the unit circle leaves it at the root of a quadratic.
fn throw<S: Scalar>(options: Options) -> f64 {
    let (x, y) = (number::<S>("0.3"), number::<S>("-0.2"));
    let (u, w) = (number::<S>("0.7"), number::<S>("1.1"));
    let system = Throw::new([S::zero(), S::zero()]);
    let mut engine = started(system, options, vec![x, y], vec![u, w]);
    assert_eq!(go(&mut engine, number("10")), Advance::Event);
    let (a, b, c) = (u * u + w * w, x * u + y * w, x * x + y * y - S::one());
    let exact = ((b * b - a * c).sqrt() - b) / a;
    apart(engine.now().time, exact)
}

#[test]
fn a_flight_ends_on_the_circle() {
    let error = throw::<f64>(options(1e-14, 1e-2));
    assert!(error < 10.0 * f64::EPSILON, "{error:e}");
    let error = throw::<F256>(options(1e-60, 1e-2));
    assert!(error < 1e-60, "{error:e}");
}

/// An oscillator cos 2t, with an event where it rises through a level close to its top.
fn graze<S: Scalar>(level: &str, first_step: f64, tolerance: f64) -> (Advance, S) {
    let system = Oscillators::new(1, number("2"), number(level), Direction::Rising);
    let v = S::from_f64(2.0);
    let mut engine = started(system, options(tolerance, first_step), vec![S::zero()], vec![v]);
    // sin 2t, to just beyond its first top
    let advance = go(&mut engine, number("2"));
    (advance, engine.now().time)
}

#[test]
fn a_graze_within_one_step_is_found() {
    // above the level for acos(0.999999) = 1.4 ms
    let (advance, time) = graze::<f64>("0.999999", 1.0, 1e-10);
    assert_eq!(advance, Advance::Event);
    assert!((time - 0.999999f64.asin() / 2.0).abs() < 1e-6, "{time}");
    let (advance, time) = graze::<F256>("0.999999999999", 1.0, 1e-60);
    assert_eq!(advance, Advance::Event);
    let (sin, _) = (time + time).sin_cos();
    assert!((sin - number::<F256>("0.999999999999")).abs().to_f64() < 1e-58);
}

#[test]
fn a_near_miss_is_no_event() {
    assert_eq!(graze::<f64>("1.0000001", 1.0, 1e-10).0, Advance::Stepped);
    assert_eq!(graze::<F256>("1.0000000000000001", 1.0, 1e-60).0, Advance::Stepped);
}

#[test]
fn an_event_at_the_start_is_an_event_at_once() {
    let system = Oscillators::new(1, 2.0, 0.0, Direction::Rising);
    let mut engine = started(system, options(1e-12, 1e-3), vec![0.0], vec![2.0]);
    assert_eq!(engine.step(1.0).unwrap(), Advance::Event);
    assert_eq!(engine.now().time, 0.0);
    assert_eq!(engine.fired(), [true]);
}

#[test]
fn a_function_that_leaves_zero_the_other_way_is_no_event() {
    let system = Oscillators::new(1, 2.0, 0.0, Direction::Falling);
    let mut engine = started(system, options(1e-12, 1e-3), vec![0.0], vec![2.0]);
    assert_eq!(go(&mut engine, 2.0), Advance::Event);
    let error = apart(engine.now().time, std::f64::consts::FRAC_PI_2);
    assert!(error < 1e-11, "{error:e}");
}

#[test]
fn a_step_ends_where_it_is_told_to() {
    let system = Oscillators::new(1, 2.0, 0.0, Direction::Off);
    let mut engine = started(system, options(1e-12, 1e-3), vec![1.0], vec![0.0]);
    assert_eq!(go(&mut engine, 0.7), Advance::Stepped);
    assert_eq!(engine.now().time, 0.7);
    let mut at = engine.now().clone();
    let outside = engine.within(0.71, &mut at);
    assert!(matches!(outside, Err(ExplicitError::NotWithin { .. })), "{outside:?}");
}
