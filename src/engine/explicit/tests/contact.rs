//! Balls against walls: the power law at both ends of a contact.

use super::systems::Balls;
use super::*;
use crate::dae::Direction;
use crate::scalar::F256;

/// 2/(n + 1) · B(1/(n + 1), 1/2) for n = 3/2 and 4/3: the duration of an elastic impact in units of
/// δ_max / v₀.
const DURATIONS: [(&str, &str); 2] = [
    ("3/2", "2.94327518432470465738178730008292272619987715421397915007876943181282881538"),
    ("4/3", "3.0011053075070410236005366957722795181710201639662589465109301208413837228"),
];
/// The rebound of a (1 + e) = ln((1 + a)/(1 − a e)) for a = ¾ (1 − c_e²) at c_e = 0.9 and 0.5.
const REBOUNDS: [(&str, &str); 2] = [
    ("0.1425", "0.913176677805581049489536913728229337081996527319677108689110091708606386579"),
    ("0.5625", "0.725241114010197266873057472977591119116740012982192863153352680657656643018"),
];

/// Switches every ball that fired, and restarts.
fn switch<S: Scalar>(engine: &mut Explicit<S, Balls<S>>) {
    let now = engine.now().clone();
    let fired = engine.fired().to_vec();
    let system = engine.system();
    for ball in (0..fired.len()).filter(|ball| fired[*ball]) {
        let impact = match system.impact[ball] {
            None => Some(now.v[ball]),
            Some(_) => None,
        };
        system.switch(ball, impact);
    }
    engine.restart(&now).unwrap();
}

/// One impact from the flight of 1 mm at `speed`: begin, end, rebound speed, lost energy.
fn impact<S: Scalar>(damping: &str, speed: &str, tolerance: f64) -> [S; 4] {
    let system = Balls::new(1, number("2e11"), number(damping));
    impact_of(system, speed, tolerance)
}

fn impact_of<S: Scalar>(system: Balls<S>, speed: &str, tolerance: f64) -> [S; 4] {
    let start = vec![number("-1e-3")];
    let mut engine = started(system, options(tolerance, 1e-6), start, vec![number(speed)]);
    let end = number("10");
    assert_eq!(go(&mut engine, end), Advance::Event);
    let begin = engine.now().time;
    switch(&mut engine);
    assert_eq!(go(&mut engine, end), Advance::Event);
    [begin, engine.now().time, -engine.now().v[0], engine.now().integrals[0]]
}

/// Begin, duration and rebound of an elastic impact under K δⁿ, n = 1 + 1/d, against
/// 2/(n + 1) · B(1/(n + 1), 1/2) · δ_max/v₀ with δ_max^(n + 1) = (n + 1)/2 · m v₀²/K.
fn check_duration<S: Scalar>(degree: i64, speed: &str, tolerance: f64, allowed: f64) {
    let stiffness: S = number("2e9");
    let mut system = Balls::new(1, stiffness, S::zero());
    system.degree = degree as u32;
    let [begin, end, rebound, _] = impact_of(system, speed, tolerance);
    let v = number::<S>(speed);
    let (_, duration) = DURATIONS[degree as usize - 2];
    let power = S::ratio(2 * degree + 1, 2 * degree) * v * v / stiffness;
    let deepest = power.powf(S::ratio(degree, 2 * degree + 1));
    let exact = number::<S>(duration) * deepest / v;
    let flight = number::<S>("1e-3") / v;
    let errors = [apart(begin, flight), apart(end - begin, exact), apart(rebound, v)];
    assert!(errors.iter().all(|error| *error < allowed), "{degree}, {speed}: {errors:?}");
}

#[test]
fn an_elastic_impact_lasts_as_long_as_the_beta_function_says() {
    for degree in [2, 3] {
        for speed in ["1e-3", "0.3", "7"] {
            check_duration::<f64>(degree, speed, 1e-14, 1e-12);
            check_duration::<F256>(degree, speed, 1e-60, 1e-57);
        }
    }
}

fn check_rebound<S: Scalar>(tolerance: f64, allowed: f64) {
    for (damping, ratio) in REBOUNDS {
        let [_, _, rebound, lost] = impact::<S>(damping, "0.4", tolerance);
        let (v, e) = (number::<S>("0.4"), number::<S>(ratio));
        let error = apart(rebound / v, e);
        // half of v² (1 − e²), per unit mass
        let energy = v * v * (S::one() - e * e) * number("0.5");
        assert!(error < allowed, "{damping}: {error:e}");
        assert!(apart(lost, energy) < 10.0 * allowed, "{damping}: energy");
    }
}

#[test]
fn the_rebound_is_that_of_the_first_integral() {
    check_rebound::<f64>(1e-14, 1e-13);
    check_rebound::<F256>(1e-60, 1e-58);
}

/// Speed after so many bounces under gravity, without damping: that of the first impact.
fn bounces<S: Scalar>(tolerance: f64, count: usize) -> (f64, f64) {
    let mut system = Balls::new(1, number("2e11"), S::zero());
    let g: S = number("9.81");
    system.gravity = g;
    let height = number::<S>("-0.01");
    let mut engine = started(system, options(tolerance, 1e-6), vec![height], vec![S::zero()]);
    let mut speeds = Vec::new();
    let mut at = engine.now().clone();
    let mut energy_error: f64 = 0.0;
    while speeds.len() < count {
        let advance = engine.step(number("10")).unwrap();
        let (began, now) = (engine.began(), engine.now().time);
        engine.within((began + now) * number("0.5"), &mut at).unwrap();
        let depth = at.q[0].max(S::zero());
        let energy = at.v[0] * at.v[0] * number("0.5") - g * at.q[0]
            + number::<S>("8e10") * depth * depth * depth.sqrt();
        energy_error = energy_error.max(apart(energy, -(g * height)));
        if advance == Advance::Event {
            speeds.push(engine.now().v[0].abs());
            switch(&mut engine);
        }
    }
    (apart(speeds[count - 1], speeds[0]), energy_error)
}

#[test]
fn a_ball_without_damping_bounces_for_ever() {
    // a few tolerances a bounce
    let (speed, energy) = bounces::<f64>(1e-14, 200);
    assert!(speed < 5.0 * 200.0 * 1e-14 && energy < 5.0 * 200.0 * 1e-14, "{speed:e}, {energy:e}");
    // what stands within the steps comes from the dense output here
    let (speed, energy) = bounces::<f64>(1e-9, 20);
    assert!(speed < 5.0 * 20.0 * 1e-9 && energy < 5.0 * 20.0 * 1e-9, "{speed:e}, {energy:e}");
    let (speed, energy) = bounces::<F256>(1e-60, 6);
    assert!(speed < 1e-57 && energy < 1e-57, "{speed:e}, {energy:e}");
}

/// Energy error (relative) and steps of a ball that swings on the wall, never to leave it.
fn swing(tolerance: f64, until: f64) -> (f64, u64) {
    let (stiffness, g) = (2e11, 9.81);
    let mut system = Balls::new(1, stiffness, 0.0);
    system.gravity = g;
    system.switch(0, Some(1.0));
    let at_rest = (g / stiffness).powf(2.0 / 3.0);
    let energy = |q: f64, v: f64| 0.5 * v * v - g * q + 0.4 * stiffness * q * q * q.sqrt();
    let start = 1.7 * at_rest;
    let mut engine = started(system, options(tolerance, 1e-6), vec![start], vec![0.0]);
    while engine.now().time < until {
        assert_eq!(engine.step(until).unwrap(), Advance::Stepped);
    }
    let now = engine.now();
    let error = (energy(now.q[0], now.v[0]) - energy(start, 0.0)) / (g * at_rest);
    (error.abs(), engine.counts()[0].value)
}

#[test]
fn a_contact_that_lasts_keeps_its_root_with_its_depth() {
    let (error, steps) = swing(1e-12, 0.5);
    assert!(error < 1e-12 * steps as f64, "{error:e} in {steps} steps");
}

#[test]
fn two_tolerances_agree_to_the_digits_of_the_looser() {
    let [_, loose, ..] = impact::<F256>("0.1425", "0.4", 1e-50);
    let [_, tight, ..] = impact::<F256>("0.1425", "0.4", 1e-60);
    let error = apart(loose, tight);
    assert!(error < 1e-49, "{error:e}");
}

/// Two balls that strike `apart` (m) after one another, with equal speeds: both ends of each.
fn pair<S: Scalar>(behind: &str, tolerance: f64) -> Vec<(Vec<bool>, S)> {
    let system = Balls::new(2, number("2e11"), number("0.1425"));
    let start = vec![number::<S>("-1e-5"), number::<S>("-1e-5") - number(behind)];
    let mut engine = started(system, options(tolerance, 1e-6), start, vec![S::one(); 2]);
    let mut events = Vec::new();
    while go(&mut engine, number("1e-3")) == Advance::Event {
        events.push((engine.fired().to_vec(), engine.now().time));
        switch(&mut engine);
    }
    events
}

fn check_pair<S: Scalar>(behind: &str, tolerance: f64, allowed: f64) {
    let events = pair::<S>(behind, tolerance);
    let times = |ball: usize| -> Vec<S> {
        events.iter().filter(|(fired, _)| fired[ball]).map(|(_, time)| *time).collect()
    };
    let (first, second) = (times(0), times(1));
    assert_eq!((first.len(), second.len()), (2, 2), "{behind}: {events:?}");
    for (a, b) in first.iter().zip(&second) {
        let error = ((*b - *a) - number(behind)).abs().to_f64();
        assert!(error < allowed, "{behind}: {error:e}");
    }
}

#[test]
fn two_contacts_at_once_do_not_hold_each_other() {
    for behind in ["0", "1e-12", "1e-9", "3e-6", "8e-6"] {
        check_pair::<f64>(behind, 1e-13, 1e-18);
        check_pair::<F256>(behind, 1e-60, 1e-60);
    }
}

#[test]
fn a_contact_that_begins_at_rest_sinks_in() {
    let mut system = Balls::new(1, 2e11, 0.0);
    system.gravity = 9.81;
    system.switch(0, Some(1.0));
    let mut engine = started(system, options(1e-12, 1e-6), vec![0.0], vec![0.0]);
    let mut deepest: f64 = 0.0;
    while engine.now().time < 1e-2 && engine.step(1e-2).unwrap() == Advance::Stepped {
        deepest = deepest.max(engine.now().q[0]);
    }
    // g δ = 2/5 K δ^{5/2}
    let exact = (2.5 * 9.81 / 2e11_f64).powf(2.0 / 3.0);
    assert!(apart(deepest, exact) < 1e-2, "{deepest:e} {exact:e}");
}

#[test]
fn a_touch_at_rest_under_load_is_a_contact_at_once() {
    let mut system = Balls::new(1, 2e11, 0.0);
    system.gravity = 9.81;
    let mut engine = started(system, options(1e-12, 1e-6), vec![0.0], vec![0.0]);
    assert_eq!(engine.step(1.0).unwrap(), Advance::Event);
    assert_eq!(engine.now().time, 0.0);
}

#[test]
fn events_that_change_nothing_are_not_repeated_for_ever() {
    let system = Balls::new(1, 2e11, 0.0);
    let mut engine = started(system, options(1e-12, 1e-6), vec![-1e-3], vec![1.0]);
    assert_eq!(go(&mut engine, 1.0), Advance::Event);
    let now = engine.now().clone();
    engine.restart(&now).unwrap();
    // still in flight, beyond the wall: it has passed, and nothing more happens
    assert_eq!(go(&mut engine, 2e-3), Advance::Stepped);
    assert_eq!(engine.system().watches()[0].direction, Direction::Rising);
}
