//! The engine against closed forms, and against systems that misbehave.

use super::*;
use crate::dae::{Direction, Fault, System, Watch};
use crate::engine::testing::{Constraint, Formulas, Relaxing, Sample};
use std::error::Error as _;
use std::f64::consts::PI;
use std::panic::{AssertUnwindSafe, catch_unwind};

const RTOL: f64 = 1e-12;

fn engine<F: Formulas>(formulas: F) -> Ida<Sample<F>> {
    Ida::new(Sample::new(formulas), Options::default()).unwrap()
}

fn snapshot(time: f64, q: &[f64], v: &[f64], integrals: &[f64]) -> Snapshot<f64> {
    Snapshot { time, q: q.to_vec(), v: v.to_vec(), z: Vec::new(), integrals: integrals.to_vec() }
}

/// Steps to an end or to the first event.
fn advance<F: Formulas>(engine: &mut Ida<Sample<F>>, end: f64) -> Result<Advance, Error> {
    while engine.now().time < end {
        if engine.step(end)? == Advance::Event {
            return Ok(Advance::Event);
        }
    }
    Ok(Advance::Stepped)
}

fn count<F: Formulas>(engine: &Ida<Sample<F>>, name: &str) -> u64 {
    engine.counts().iter().find(|count| count.name == name).unwrap().value
}

/// q̈ = −ω² q. The event function is q itself.
struct Oscillator {
    omega: f64,
    direction: Direction,
}

impl Oscillator {
    fn new(omega: f64) -> Self {
        Oscillator { omega, direction: Direction::Off }
    }
}

impl Formulas for Oscillator {
    fn scales(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![1.0], vec![self.omega])
    }
    fn forces(&mut self, _t: f64, q: &[f64], _v: &[f64], f: &mut [f64]) -> Result<(), Fault> {
        f[0] = -self.omega.powi(2) * q[0];
        Ok(())
    }
    fn integrals(&self) -> usize {
        1
    }
    fn powers(&self, _t: f64, q: &[f64], v: &[f64], powers: &mut [f64]) {
        powers[0] = -self.omega.powi(2) * q[0] * v[0];
    }
    fn watches(&self) -> Vec<Watch> {
        vec![Watch { direction: self.direction, power: 1.0 }]
    }
    fn events(&mut self, _t: f64, q: &[f64], _v: &[f64], g: &mut [f64]) -> Result<(), Fault> {
        g[0] = q[0];
        Ok(())
    }
}

#[test]
fn an_oscillator_follows_its_closed_form_and_its_spring_does_the_work_of_the_potential() {
    let omega = 3.0;
    for norm in [Norm::Ode15s, Norm::Wrms] {
        for absolute_tolerance in [AbsoluteTolerance::Scalar(1e-20), AbsoluteTolerance::Scaled] {
            let options = Options { norm, absolute_tolerance, ..Options::default() };
            let mut engine = Ida::new(Sample::new(Oscillator::new(omega)), options).unwrap();
            engine.restart(&snapshot(0.0, &[1.0], &[0.0], &[0.5])).unwrap();
            advance(&mut engine, 10.0).unwrap();
            let now = engine.now();
            assert_eq!(now.time, 10.0);
            // Some thousand steps, each allowed to be off by the tolerance.
            let allowed = 1e4 * RTOL;
            assert!((now.q[0] - (omega * 10.0).cos()).abs() < allowed, "{now:?}");
            assert!((now.v[0] + omega * (omega * 10.0).sin()).abs() < allowed * omega, "{now:?}");
            let work = -0.5 * omega.powi(2) * (now.q[0].powi(2) - 1.0);
            assert!((now.integrals[0] - 0.5 - work).abs() < allowed, "{} {work}", now.integrals[0]);
        }
    }
}

#[test]
fn what_a_force_remembers_follows_its_closed_form_at_steps_and_within() {
    for norm in [Norm::Ode15s, Norm::Wrms] {
        let options = Options { norm, ..Options::default() };
        let mut engine = Ida::new(Relaxing::new(), options).unwrap();
        let start = Snapshot { z: vec![0.0], ..snapshot(0.0, &[0.0], &[1.0], &[]) };
        engine.restart(&start).unwrap();
        let mut at = start.clone();
        while engine.now().time < 2.0 {
            engine.step(2.0).unwrap();
            let (began, now) = (engine.began(), engine.now().time);
            for time in [began, began + 0.3 * (now - began), now] {
                engine.within(time, &mut at).unwrap();
                for (found, exact) in
                    [at.q[0], at.v[0], at.z[0]].into_iter().zip(Relaxing::at(time))
                {
                    assert!((found - exact).abs() < 1e3 * RTOL, "{norm:?} at {time}: {at:?}");
                }
            }
        }
    }
}

#[test]
fn a_step_can_be_read_within_and_meets_its_ends() {
    let omega = 2.0;
    let mut engine = engine(Oscillator::new(omega));
    let mut at = Snapshot::new(1, 0, 1);
    engine.restart(&snapshot(0.0, &[1.0], &[0.0], &[0.0])).unwrap();
    engine.within(0.0, &mut at).unwrap();
    assert_eq!(&at, engine.now());
    for _ in 0..2000 {
        let before = engine.now().clone();
        engine.step(5.0).unwrap();
        assert_eq!(engine.began(), before.time);
        engine.within(before.time, &mut at).unwrap();
        assert_eq!(at, before);
        let now = engine.now().clone();
        assert_eq!(engine.system().accelerations()[0], -omega.powi(2) * now.q[0]);
        engine.within(now.time, &mut at).unwrap();
        assert_eq!(at, now);
        let time = before.time + 0.3 * (now.time - before.time);
        engine.within(time, &mut at).unwrap();
        assert!((at.q[0] - (omega * time).cos()).abs() < 1e4 * RTOL, "at {time}: {at:?}");
        let work = -0.5 * omega.powi(2) * (at.q[0].powi(2) - 1.0);
        assert!((at.integrals[0] - work).abs() < 1e4 * RTOL, "at {time}: {at:?} {work}");
    }
    let (began, now) = (engine.began(), engine.now().time);
    assert!(matches!(engine.within(now + 1e-3, &mut at), Err(Error::Outside { .. })));
    assert!(matches!(engine.within(began - 1e-3, &mut at), Err(Error::Outside { .. })));
}

#[test]
fn no_step_goes_beyond_its_end_and_ends_may_come_as_they_like() {
    let mut engine = engine(Oscillator::new(1.0));
    engine.restart(&snapshot(0.3, &[1.0], &[0.0], &[0.0])).unwrap();
    assert!(matches!(engine.step(0.2), Err(Error::Backwards { .. })));
    for end in [0.31, 0.31 + 1e-16, 0.31 + 1e-14, 0.5, 0.5, 0.75, 0.750_000_001] {
        while engine.now().time < end {
            engine.step(end).unwrap();
            assert!(engine.now().time <= end);
        }
        assert_eq!(engine.step(end).unwrap(), Advance::Stepped);
        assert_eq!(engine.now().time, end);
        assert!((engine.now().q[0] - (end - 0.3).cos()).abs() < 1e3 * RTOL);
        let work = -0.5 * (engine.now().q[0].powi(2) - 1.0);
        assert!((engine.now().integrals[0] - work).abs() < 1e3 * RTOL);
    }
    engine.step(0.9).unwrap();
    let between = engine.now().time + 1e-9;
    advance(&mut engine, between).unwrap();
    assert_eq!(engine.now().time, between);
}

#[test]
fn events_fire_in_their_direction_only() {
    let omega = 5.0;
    let crossings = |direction| {
        let mut engine = engine(Oscillator { omega, direction });
        engine.restart(&snapshot(0.0, &[1.0], &[0.0], &[0.0])).unwrap();
        let mut times = Vec::new();
        // Without a restart after the event: the engine begins anew by itself.
        while advance(&mut engine, 2.0 * PI / omega).unwrap() == Advance::Event {
            assert_eq!(engine.fired(), [true]);
            times.push(engine.now().time);
        }
        assert_eq!(engine.fired(), [false]);
        (times, count(&engine, "restarts"))
    };
    let quarter = 0.5 * PI / omega;
    for (direction, expected) in [
        (Direction::Off, None),
        (Direction::Falling, Some(quarter)),
        (Direction::Rising, Some(3.0 * quarter)),
    ] {
        let (times, restarts) = crossings(direction);
        assert_eq!(times.len(), usize::from(expected.is_some()), "{direction:?}: {times:?}");
        assert_eq!(restarts, 1 + times.len() as u64);
        for (time, expected) in times.iter().zip(expected) {
            assert!((time - expected).abs() < 1e3 * RTOL, "{direction:?}: {time} {expected}");
        }
    }
}

#[test]
fn a_step_that_ended_at_an_event_can_be_read_within() {
    let mut engine = engine(Oscillator { omega: 1.0, direction: Direction::Falling });
    engine.restart(&snapshot(0.0, &[1.0], &[0.0], &[0.0])).unwrap();
    assert_eq!(advance(&mut engine, 3.0).unwrap(), Advance::Event);
    let (began, now) = (engine.began(), engine.now().clone());
    assert!(now.q[0] <= 0.0, "an event has been crossed: {}", now.q[0]);
    let mut at = Snapshot::new(1, 0, 1);
    for part in [0.1, 0.5, 0.999] {
        let time = began + part * (now.time - began);
        engine.within(time, &mut at).unwrap();
        assert!((at.q[0] - time.cos()).abs() < 1e4 * RTOL);
        assert!((at.integrals[0] - 0.5 * time.sin().powi(2)).abs() < 1e4 * RTOL);
    }
}

#[test]
fn counts_go_on_through_restarts() {
    let mut engine = engine(Oscillator::new(1.0));
    let mut steps = 0;
    let mut last: Vec<u64> = vec![0; engine.counts().len()];
    for i in 0..3 {
        engine.restart(&snapshot(f64::from(i), &[1.0], &[0.0], &[0.0])).unwrap();
        for _ in 0..50 {
            engine.step(f64::from(i + 1)).unwrap();
            steps += 1;
            let counts: Vec<u64> = engine.counts().iter().map(|count| count.value).collect();
            assert!(counts.iter().zip(&last).all(|(count, last)| count >= last), "{counts:?}");
            last = counts;
        }
    }
    assert_eq!(count(&engine, "steps"), steps);
    assert_eq!(count(&engine, "restarts"), 3);
    assert!(count(&engine, "residual_evaluations") >= steps);
    assert!(count(&engine, "nonlinear_iterations") >= steps);
    assert!(count(&engine, "jacobian_evaluations") > 10);
}

/// A unit mass on a massless rod: x² + y² = l², gravity along −y. The event function is x / l.
struct Pendulum {
    length: f64,
    gravity: f64,
}

impl Formulas for Pendulum {
    fn scales(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![self.length; 2], vec![(self.gravity * self.length).sqrt(); 2])
    }
    fn forces(&mut self, _t: f64, _q: &[f64], _v: &[f64], f: &mut [f64]) -> Result<(), Fault> {
        f.copy_from_slice(&[0.0, -self.gravity]);
        Ok(())
    }
    fn constraint(&self, q: &[f64], v: &[f64]) -> Option<Constraint> {
        Some(Constraint {
            value: 0.5 * (q[0].powi(2) + q[1].powi(2) - self.length.powi(2)),
            gradient: q.to_vec(),
            bias: -(v[0].powi(2) + v[1].powi(2)),
        })
    }
    fn watches(&self) -> Vec<Watch> {
        vec![Watch { direction: Direction::Falling, power: 1.0 }]
    }
    fn events(&mut self, _t: f64, q: &[f64], _v: &[f64], g: &mut [f64]) -> Result<(), Fault> {
        g[0] = q[0] / self.length;
        Ok(())
    }
}

fn arithmetic_geometric_mean(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

#[test]
fn a_pendulum_on_a_rod_keeps_its_period_its_length_and_its_tension() {
    let (length, gravity, angle) = (0.7, 9.81, 2.0_f64);
    let mut engine = engine(Pendulum { length, gravity });
    let q = [length * angle.sin(), -length * angle.cos()];
    engine.restart(&snapshot(0.0, &q, &[0.0, 0.0], &[])).unwrap();
    let mean = arithmetic_geometric_mean(1.0, (0.5 * angle).cos());
    let period = 2.0 * PI / mean * (length / gravity).sqrt();
    for swing in 0..3 {
        assert_eq!(advance(&mut engine, 100.0).unwrap(), Advance::Event);
        let expected = (0.25 + f64::from(swing)) * period;
        let now = engine.now().clone();
        assert!((now.time / expected - 1.0).abs() < 1e4 * RTOL, "{} {expected}", now.time);
        // At the bottom: tension g + v²/l = g + 2 g (1 − cos θ0), and λ times the gradient's size.
        let tension = gravity * (3.0 - 2.0 * angle.cos());
        let lambda = engine.system().lambda()[0];
        assert!((lambda * length / tension - 1.0).abs() < 1e4 * RTOL, "{lambda}");
        let mut start = now;
        let off = engine.system().project(start.time, &mut start.q, &mut start.v).unwrap();
        assert!(off < 1e4 * RTOL * length, "{off}");
        engine.restart(&start).unwrap();
    }
}

/// A ball of 1 kg that meets a wall at x = 0 with the Lankarani–Nikravesh law, no gravity:
/// F = K δ^1.5 (1 + a δ̇ / v0), a = ¾ (1 − c_e²). The event function is δ / 1 mm.
struct Ball {
    stiffness: f64,
    damping: f64,
    impact_rate: Option<f64>,
}

impl Ball {
    fn factor(&self, v: f64) -> f64 {
        self.impact_rate.map_or(0.0, |impact_rate| 1.0 + self.damping * v / impact_rate)
    }
    fn elastic(&self, depth: f64) -> f64 {
        self.stiffness * depth.max(0.0).powf(1.5)
    }
}

impl Formulas for Ball {
    fn scales(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![1e-3], vec![1.0])
    }
    fn forces(&mut self, _t: f64, q: &[f64], v: &[f64], f: &mut [f64]) -> Result<(), Fault> {
        f[0] = -self.elastic(q[0]) * self.factor(v[0]);
        Ok(())
    }
    fn integrals(&self) -> usize {
        1
    }
    fn powers(&self, _t: f64, q: &[f64], v: &[f64], powers: &mut [f64]) {
        powers[0] = self.elastic(q[0]) * (self.factor(v[0]) - 1.0) * v[0];
        if self.impact_rate.is_none() {
            powers[0] = 0.0;
        }
    }
    fn watches(&self) -> Vec<Watch> {
        let direction = match self.impact_rate {
            None => Direction::Rising,
            Some(_) => Direction::Falling,
        };
        vec![Watch { direction, power: 0.5 }]
    }
    fn events(&mut self, _t: f64, q: &[f64], _v: &[f64], g: &mut [f64]) -> Result<(), Fault> {
        g[0] = q[0] / 1e-3;
        Ok(())
    }
}

#[test]
fn a_ball_rebounds_from_a_wall_by_the_closed_form_of_its_law() {
    let (impact_rate, restitution) = (2.0, 0.9_f64);
    let damping = 0.75 * (1.0 - restitution.powi(2));
    let mut engine = engine(Ball { stiffness: 1e10, damping, impact_rate: None });
    engine.restart(&snapshot(0.0, &[-1e-3], &[impact_rate], &[0.0])).unwrap();

    assert_eq!(advance(&mut engine, 1.0).unwrap(), Advance::Event);
    let begin = engine.now().clone();
    assert!((begin.time - 5e-4).abs() < 10.0 * RTOL * 5e-4, "{begin:?}");
    engine.system().switch(|ball| ball.impact_rate = Some(begin.v[0]));
    engine.restart(&begin).unwrap();

    assert_eq!(advance(&mut engine, 1.0).unwrap(), Advance::Event);
    let end = engine.now().clone();
    // From a (1 + e) = ln((1 + a) / (1 − a e)).
    let rebound = 0.913_176_677_805_581;
    // Some hundred steps, and a force that has only one and a half derivatives at either end.
    let allowed = 1e4 * RTOL;
    assert!((-end.v[0] / impact_rate - rebound).abs() < allowed, "{}", end.v[0] / impact_rate);
    let lost = 0.5 * impact_rate.powi(2) * (1.0 - rebound.powi(2));
    assert!((end.integrals[0] / lost - 1.0).abs() < 10.0 * allowed, "{:?} {lost}", end.integrals);

    engine.system().switch(|ball| ball.impact_rate = None);
    engine.restart(&end).unwrap();
    assert_eq!(advance(&mut engine, 1e-2).unwrap(), Advance::Stepped);
    assert_eq!(engine.now().v[0], end.v[0]);
    assert_eq!(engine.now().integrals, end.integrals);
}

#[test]
fn a_contact_that_begins_at_zero_depth_exactly_ends_once() {
    let mut engine = engine(Ball { stiffness: 1e10, damping: 0.0, impact_rate: Some(2.0) });
    engine.restart(&snapshot(0.0, &[0.0], &[2.0], &[0.0])).unwrap();
    assert_eq!(advance(&mut engine, 1e-2).unwrap(), Advance::Event);
    // Hertz: (n + 1) v² / (2 K) = δ_max^(n + 1), and the duration is 2.943275 δ_max / v.
    let deepest = (2.5 * 2.0_f64.powi(2) / (2.0 * 1e10)).powf(0.4);
    let duration = 2.943_275_184_324_3 * deepest / 2.0;
    let end = engine.now().clone();
    assert!((end.time / duration - 1.0).abs() < 1e4 * RTOL, "{} {duration}", end.time);
    assert!((end.v[0] / -2.0 - 1.0).abs() < 1e4 * RTOL, "{}", end.v[0]);
    engine.system().switch(|ball| ball.impact_rate = None);
    engine.restart(&Snapshot { q: vec![0.0], ..end }).unwrap();
    assert_eq!(advance(&mut engine, 1e-2).unwrap(), Advance::Stepped);
}

/// A free mass whose force does what a test wants.
struct Free<F>(F);

impl<F: FnMut(f64, f64, f64) -> Result<f64, Fault>> Formulas for Free<F> {
    fn scales(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![1.0], vec![1.0])
    }
    fn forces(&mut self, t: f64, q: &[f64], v: &[f64], f: &mut [f64]) -> Result<(), Fault> {
        f[0] = (self.0)(t, q[0], v[0])?;
        Ok(())
    }
}

/// A free mass under the force t², whose event function is what a test wants.
struct Watched {
    pressed: bool,
    event: fn(f64) -> f64,
}

impl Formulas for Watched {
    fn scales(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![1.0], vec![1.0])
    }
    fn forces(&mut self, t: f64, _q: &[f64], _v: &[f64], f: &mut [f64]) -> Result<(), Fault> {
        f[0] = if self.pressed { t * t } else { 0.0 };
        Ok(())
    }
    fn watches(&self) -> Vec<Watch> {
        vec![Watch { direction: Direction::Rising, power: 1.0 }]
    }
    fn events(&mut self, _t: f64, q: &[f64], _v: &[f64], g: &mut [f64]) -> Result<(), Fault> {
        g[0] = (self.event)(q[0]);
        Ok(())
    }
}

#[test]
fn an_event_that_is_over_at_the_end_of_its_step_is_found_and_is_the_first_of_them() {
    for (event, exact) in [
        ((|q| 1e-6 - (q - 0.3).powi(2)) as fn(f64) -> f64, 0.3 - 1e-3),
        (|q| (1e-8 - (q - 0.3).powi(2)).max(1e-8 - (q - 0.5).powi(2)), 0.3 - 1e-4),
    ] {
        let mut engine = engine(Watched { pressed: false, event });
        engine.restart(&snapshot(0.0, &[0.0], &[1.0], &[])).unwrap();
        assert_eq!(advance(&mut engine, 10.0).unwrap(), Advance::Event);
        let now = engine.now();
        assert!((now.time - exact).abs() < 1e-12, "{} {exact}", now.time);
        assert!(event(now.q[0]) > 0.0, "an event has been crossed");
        assert_eq!(engine.fired(), [true]);
    }
}

#[test]
fn a_function_that_is_zero_at_a_restart_and_rises_later_is_an_event() {
    let mut engine = engine(Watched { pressed: true, event: |q| q });
    engine.restart(&snapshot(0.0, &[0.0], &[0.0], &[])).unwrap();
    assert_eq!(advance(&mut engine, 1.0).unwrap(), Advance::Event);
    // q = t⁴/12 is noise until 1e-13
    assert!(engine.now().time < 2e-3, "{}", engine.now().time);
}

#[test]
fn a_function_that_begins_beyond_zero_has_to_fall_before_it_is_an_event() {
    let mut engine = engine(Watched { pressed: false, event: |q| (q - 0.2) * (q - 0.6) });
    engine.restart(&snapshot(0.0, &[0.0], &[1.0], &[])).unwrap();
    assert_eq!(advance(&mut engine, 2.0).unwrap(), Advance::Event);
    assert!((engine.now().time - 0.6).abs() < 1e-12, "{}", engine.now().time);
}

#[test]
fn a_run_that_cannot_reach_its_end_is_given_up_with_advice() {
    let mut pace = Pace::default();
    let mut crawl = |step: f64| -> Result<u32, Error> {
        for i in 1..1_000_000 {
            pace.made(0.1 + f64::from(i) * step, 1.0, f64::INFINITY)?;
        }
        Ok(0)
    };
    assert!(crawl(1e-9).is_ok(), "a billion steps can be done");
    let error = crawl(1e-13).unwrap_err();
    assert!(matches!(error, Error::TooSlow { .. }), "{error:?}");
    assert!(error.to_string().contains("absolute_tolerance = \"scaled\""), "{error}");
}

#[test]
fn stock_and_own_vector_operations_lead_to_the_same_result() {
    for norm in [Norm::Ode15s, Norm::Wrms] {
        let run = |stock_vector_operations| {
            let options = Options { norm, stock_vector_operations, ..Options::default() };
            let mut engine = Ida::new(Sample::new(Oscillator::new(1.0)), options).unwrap();
            engine.restart(&snapshot(0.0, &[1.0], &[0.0], &[0.0])).unwrap();
            advance(&mut engine, 5.0).unwrap();
            (engine.now().q[0], count(&engine, "steps") as f64)
        };
        let ((own, own_steps), (stock, stock_steps)) = (run(false), run(true));
        assert!((own - stock).abs() < 1e4 * RTOL, "{own} {stock}");
        assert!((own_steps / stock_steps - 1.0).abs() < 0.05, "{own_steps} {stock_steps}");
    }
}

#[test]
fn a_panic_in_the_system_comes_back_whole_from_the_step() {
    let mut engine = engine(Free(|t, _, _| {
        assert!(t < 0.5, "no force is known after {} s", 0.5);
        Ok(0.0)
    }));
    engine.restart(&snapshot(0.0, &[0.0], &[1.0], &[])).unwrap();
    let caught = catch_unwind(AssertUnwindSafe(|| advance(&mut engine, 1.0))).unwrap_err();
    assert_eq!(caught.downcast_ref::<String>().unwrap(), "no force is known after 0.5 s");
    assert!(matches!(engine.step(1.0), Err(Error::NotStarted)));
}

#[derive(Debug, thiserror::Error)]
#[error("the spring broke")]
struct Broken;

#[test]
fn a_fatal_fault_comes_back_with_its_source_and_the_engine_can_begin_anew() {
    let mut engine = engine(Free(|t, _, _| match t {
        0.0..0.5 => Ok(1.0),
        _ => Err(Fault::Fatal(Box::new(Broken))),
    }));
    let start = snapshot(0.0, &[0.0], &[1.0], &[]);
    engine.restart(&start).unwrap();
    match advance(&mut engine, 1.0).unwrap_err() {
        Error::System { time, source: Fault::Fatal(source) } => {
            assert!((0.5..1.0).contains(&time));
            assert!(source.downcast_ref::<Broken>().is_some());
        }
        error => panic!("{error:?}"),
    }
    assert!(matches!(engine.step(1.0), Err(Error::NotStarted)));
    engine.restart(&start).unwrap();
    advance(&mut engine, 0.4).unwrap();
    assert!((engine.now().q[0] - (0.4 + 0.08)).abs() < 100.0 * RTOL);
}

#[test]
fn a_system_that_wants_shorter_steps_gets_them() {
    use std::cell::Cell;
    use std::rc::Rc;
    let reached = Rc::new(Cell::new(0.0));
    let (seen, complaints) = (reached.clone(), Rc::new(Cell::new(0)));
    let complained = complaints.clone();
    let mut engine = engine(Free(move |t: f64, q: f64, _| {
        if t - seen.get() > 2e-3 {
            complained.set(complained.get() + 1);
            return Err(Fault::TryShorterStep("too far ahead".into()));
        }
        Ok(-q)
    }));
    engine.restart(&snapshot(0.0, &[1.0], &[0.0], &[])).unwrap();
    while engine.now().time < 1.0 {
        engine.step(1.0).unwrap();
        reached.set(engine.now().time);
    }
    assert!(complaints.get() > 10, "{}", complaints.get());
    assert!((engine.now().q[0] - 1.0_f64.cos()).abs() < 1e4 * RTOL);
}

#[test]
fn a_system_that_always_wants_shorter_steps_is_given_up_with_its_complaint() {
    let mut engine = engine(Free(|t, _, _| match t {
        0.0..0.5 => Ok(0.0),
        _ => Err(Fault::TryShorterStep("the surface ends here".into())),
    }));
    engine.restart(&snapshot(0.0, &[0.0], &[1.0], &[])).unwrap();
    let error = advance(&mut engine, 1.0).unwrap_err();
    assert!(matches!(error, Error::Stopped { .. } | Error::NoProgress { .. }), "{error:?}");
    assert_eq!(error.source().unwrap().to_string(), "the surface ends here");
}

#[test]
fn a_force_that_is_not_a_number_is_an_error_in_words() {
    let mut engine = engine(Free(|t: f64, _, _| Ok((0.5 - t).sqrt())));
    engine.restart(&snapshot(0.0, &[0.0], &[1.0], &[])).unwrap();
    let error = advance(&mut engine, 1.0).unwrap_err();
    assert!(matches!(error, Error::Stopped { .. } | Error::NoProgress { .. }), "{error:?}");
}

#[test]
fn a_force_without_any_smoothness_is_an_error_and_no_spin() {
    let mut engine = engine(Free(|t: f64, q: f64, v: f64| {
        let bits = t.to_bits() ^ q.to_bits().rotate_left(21) ^ v.to_bits().rotate_left(42);
        Ok(1e3 * (bits.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64 / (1_u64 << 53) as f64)
    }));
    engine.restart(&snapshot(1.0, &[1.0], &[1.0], &[])).unwrap();
    let error = advance(&mut engine, 2.0).unwrap_err();
    assert!(matches!(error, Error::Stopped { .. } | Error::NoProgress { .. }), "{error:?}");
    assert!(error.to_string().contains("not smooth"), "{error}");
    assert!(count(&engine, "steps") < 100_000);
}

#[test]
fn a_storm_of_events_at_one_time_is_an_error_and_no_spin() {
    let mut engine = engine(Oscillator { omega: 1.0, direction: Direction::Falling });
    let mut storm = || -> Result<(), Error> {
        // Each restart is put before the event again, within rounding.
        loop {
            engine.restart(&snapshot(1.0, &[1e-17], &[-1.0], &[0.0]))?;
            advance(&mut engine, 2.0)?;
        }
    };
    let error = storm().unwrap_err();
    assert!(matches!(error, Error::NoProgress { .. }), "{error:?}");
}

#[test]
fn options_that_mean_nothing_are_refused() {
    let refused = |options| Ida::new(Sample::new(Oscillator::new(1.0)), options).is_err();
    let sound = Options::default();
    assert!(!refused(sound));
    assert!(refused(Options { relative_tolerance: 0.0, ..sound }));
    assert!(refused(Options { absolute_tolerance: AbsoluteTolerance::Scalar(-1.0), ..sound }));
    assert!(refused(Options { initial_step: f64::INFINITY, ..sound }));
    assert!(refused(Options { initial_step: 0.0, ..sound }));
    assert!(refused(Options { max_step: f64::NAN, ..sound }));
}

#[test]
fn the_longest_step_is_kept() {
    let options = Options { max_step: 1e-3, relative_tolerance: 1e-3, ..Options::default() };
    let mut engine = Ida::new(Sample::new(Free(|_, _, _| Ok(0.0))), options).unwrap();
    engine.restart(&snapshot(0.0, &[0.0], &[1.0], &[])).unwrap();
    let mut longest = 0.0_f64;
    while engine.now().time < 0.1 {
        engine.step(0.1).unwrap();
        longest = longest.max(engine.now().time - engine.began());
    }
    assert!(longest <= 1e-3 * (1.0 + 1e-9), "{longest}");
    assert!(longest > 0.5e-3, "{longest}");
}

#[test]
fn the_library_is_the_one_that_the_program_was_built_for() {
    assert!(sundials_version().starts_with("6.4."), "{}", sundials_version());
}
