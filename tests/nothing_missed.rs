//! Contacts, events and starts that were once missed, in silence. Known in advance is what each
//! mechanism does: from a closed form, or from `scripts/independent.py CASE`, an integration with
//! other equations, another method and another search for events.

mod simulated;

use freeplay::case::Case;
use freeplay::certify;
use freeplay::dae::System;
use freeplay::mechanism::Observation;
use freeplay::run::{Contact, Progress, Trajectory};
use freeplay::scalar::{F256, Scalar};
use freeplay::simulate::{Simulation, assemble};
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeVal;
use simulated::{case, root, told};
use std::error::Error;
use std::ops::ControlFlow;
use std::sync::mpsc;
use std::time::Duration;

const ENGINES: [&str; 2] = ["ida", "explicit"];
/// CPU (s) of a run that takes a few seconds at most.
const PATIENCE: f64 = 60.0;
/// Wall clock (s) after which a run that says nothing hangs, however busy the machine.
const HANGS: u64 = 900;

/// A mechanism of `tests/nothing_missed`, on an engine at a tolerance.
fn mechanism(name: &str, engine: &str, tolerance: f64, set: &[&str]) -> Case {
    from(&format!("tests/nothing_missed/{name}.toml"), engine, tolerance, set)
}

fn from(path: &str, engine: &str, tolerance: f64, set: &[&str]) -> Case {
    let engine = format!("solver.engine={engine}");
    let tolerance = format!("solver.relative_tolerance={tolerance:e}");
    case(path, &[&[engine.as_str(), tolerance.as_str()], set].concat())
}

/// A run to its end, or the words in which it gave up, or that it did not get there in time.
fn run(case: &Case) -> Result<Trajectory, String> {
    let (send, receive) = mpsc::channel();
    let case = case.clone();
    std::thread::spawn(move || {
        let mut kept = Trajectory::default();
        let mut watch = |_: &Progress| match cpu() > PATIENCE {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let ran = Simulation::new(&case)
            .map_err(|error| words(&error))
            .and_then(|ready| ready.run(&mut kept, &mut watch).1.map_err(|error| words(&error)));
        let _ = send.send(ran.map(|()| kept));
    });
    let ran = receive.recv_timeout(Duration::from_secs(HANGS));
    ran.unwrap_or_else(|_| Err(format!("it hangs: it said nothing for {HANGS} s")))
}

/// CPU (s) of this thread so far.
fn cpu() -> f64 {
    let usage = getrusage(UsageWho::RUSAGE_THREAD).unwrap();
    let seconds = |time: TimeVal| time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64;
    seconds(usage.user_time()) + seconds(usage.system_time())
}

/// A run that must get to its end and see its own contacts.
fn sound(case: &Case, what: &str) -> Trajectory {
    let kept = run(case).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_sound(&kept, what);
    kept
}

fn words(error: &dyn Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        words = format!("{words}: {error}");
        cause = error.source();
    }
    words
}

/// Whether journals in flight are inside their clearances, and contacts are contacts: each begins
/// inwards and ends after it began, and the next of its clearance later still.
fn assert_sound(kept: &Trajectory, what: &str) {
    for sample in &kept.samples {
        for clearance in sample.clearances.iter().filter(|clearance| !clearance.in_contact) {
            let depth = clearance.penetration;
            assert!(depth <= 1e-12, "{what}: {depth:e} m deep in flight at {:e} s", sample.time);
        }
    }
    let clearances = kept.samples[0].clearances.len();
    let mut ended = vec![f64::NEG_INFINITY; clearances];
    for contact in &kept.contacts {
        let begin = contact.begin;
        assert!(contact.impact_rate >= -1e-9, "{what}: a contact begins outwards at {begin:e} s");
        assert!(begin >= ended[contact.clearance], "{what}: two contacts at once at {begin:e} s");
        assert!(!(contact.end < begin), "{what}: a contact ends before its begin, {begin:e} s");
        ended[contact.clearance] = if contact.end.is_nan() { f64::INFINITY } else { contact.end };
    }
    for pair in kept.events.windows(2) {
        assert!(pair[0].time <= pair[1].time, "{what}: time goes back at {:e} s", pair[1].time);
    }
}

/// Whether the contacts are those that are known, each begin (s) to a relative accuracy.
fn assert_begins(contacts: &[Contact], known: &[f64], accuracy: f64, what: &str) {
    let begins: Vec<f64> = contacts.iter().map(|contact| contact.begin).collect();
    assert_eq!(begins.len(), known.len(), "{what}: contacts begin at {begins:?} s");
    for (begin, known) in begins.iter().zip(known) {
        let off = (begin - known).abs();
        assert!(off <= accuracy * known, "{what}: a contact begins at {begin:e}, not {known:e} s");
    }
}

/// Largest energy residual over the largest energy of any kind.
fn energy_off(kept: &Trajectory) -> f64 {
    let largest = |of: &dyn Fn(&Observation) -> f64| {
        kept.samples.iter().map(of).map(f64::abs).fold(0.0, f64::max)
    };
    let sizes = [
        largest(&|sample| sample.energy.kinetic),
        largest(&|sample| sample.energy.elastic),
        largest(&|sample| sample.energy.dissipated),
        largest(&|sample| sample.energy.drive_work),
    ];
    largest(&|sample| sample.energy.residual) / sizes.into_iter().fold(f64::MIN_POSITIVE, f64::max)
}

/// First time (s) at which a journal that flies freely is 1 mm from the bearing's centre: at `fall`
/// (m/s²) downwards, at a speed (m/s) to the right, turning at a rate (rad/s) on an arm (m) from an
/// angle (rad) on:
/// (v t + r cos(φ + ω t))² + (r sin(φ + ω t) − g t²/2)² = c².
fn strikes([speed, fall]: [f64; 2], [arm, angle, rate]: [f64; 3]) -> f64 {
    let beyond = |t: f64| {
        let (sin, cos) = (angle + rate * t).sin_cos();
        (speed * t + arm * cos).hypot(arm * sin - 0.5 * fall * t * t) - 1e-3
    };
    let mut inside = 0.0;
    while beyond(inside + 1e-6) < 0.0 {
        inside += 1e-6;
    }
    let mut outside = inside + 1e-6;
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        *(if beyond(middle) < 0.0 { &mut inside } else { &mut outside }) = middle;
    }
    outside
}

#[test]
fn a_rotor_that_turns_often_before_it_strikes_is_not_let_through_the_wall() {
    let strikes = strikes([0.01, 0.0], [3e-4, 0.0, 300.0]);
    assert!((strikes - 0.080_457_513_881_85).abs() < 1e-14);
    for engine in ENGINES {
        for tolerance in [1e-2, 1e-4, 1e-6, 1e-9, 1e-12, 1e-14] {
            let what = format!("{engine} at {tolerance:e}");
            let kept = sound(&mechanism("eccentric-rotor", engine, tolerance, &[]), &what);
            assert_begins(&kept.contacts[..1], &[strikes], tolerance.max(1e-11), &what);
            if tolerance <= 1e-6 {
                let known = [strikes, 0.094_569_623_428_94];
                assert_begins(&kept.contacts, &known, 1e2 * tolerance.max(1e-10), &what);
            }
        }
    }
}

#[test]
fn a_ring_at_rest_is_struck_by_the_pin_that_circles_in_it() {
    let known = [
        7.149010414083e-3,
        1.732813970467e-2,
        2.529277676387e-2,
        3.294437677544e-2,
        4.071698927097e-2,
        4.943761620773e-2,
    ];
    for engine in ENGINES {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let what = format!("{engine} at {tolerance:e}");
            let kept = sound(&mechanism("shaft-in-ring", engine, tolerance, &[]), &what);
            assert_begins(&kept.contacts, &known, 1e3 * tolerance.max(1e-11), &what);
        }
    }
}

#[test]
fn a_disc_that_touches_at_rest_with_its_weight_along_the_wall_slides_down_it() {
    let (c, g, s) = (1e-3, 9.81, 0.5_f64.sqrt());
    let starts = [
        ([c, 0.0], [0.0, -g]),
        ([-c, 0.0], [0.0, -g]),
        ([0.0, c], [g, 0.0]),
        ([c * s, c * s], [g * s, -g * s]),
        ([c, 0.0], [-1e-15, -g]),
    ];
    // across the weight and along it (m), at 10 and 30 ms
    let known = [
        (0.01, [8.847709746880e-4, 4.676758034260e-4]),
        (0.03, [-9.635784280440e-4, 2.694908862856e-4]),
    ];
    for ([x, y], [gx, gy]) in starts {
        let [along_x, along_y] = [gx / g, gy / g];
        let at = format!(
            "start.disc={{x={x:?}, y={y:?}, angle=0.0, velocity_x=0.0, velocity_y=0.0, \
             angular_velocity=0.0, fixed=true}}"
        );
        let pull = format!("loads.gravity.acceleration=[{gx:?}, {gy:?}]");
        for engine in ENGINES {
            let what = format!("{engine} from ({x:e}, {y:e})");
            let set = [at.as_str(), pull.as_str()];
            let kept = sound(&mechanism("disc-at-the-wall", engine, 1e-12, &set), &what);
            assert!(kept.contacts[0].begin < 1e-4, "{what}: {:?}", kept.contacts[0]);
            for (time, [across, along]) in known {
                let sample = kept.samples.iter().find(|sample| sample.time == time).unwrap();
                let [px, py] = sample.clearances[0].offset;
                let found = [(px * x + py * y) / c, px * along_x + py * along_y];
                let off = (found[0] - across).hypot(found[1] - along);
                assert!(off <= 1e-6 * c, "{what}: {off:e} m off at {time} s");
            }
        }
    }
}

/// The crank on a crank, with a small clearance in Q and its cranks at other speeds.
const SHORT_HOPS: [&str; 7] = [
    "joints.Q.clearance={bearing_radius=0.01, radial=5.324e-05, normal={law=\"hertz\", stiffness=8.018e9}}",
    "drives.first.speed_rpm=-52.265",
    "drives.first.angle=2.338",
    "drives.second.speed_rpm=2314.147",
    "drives.second.angle=2.12",
    "run.duration=0.0065",
    "run.sample_interval=1e-6",
];
const CRANK_ON_CRANK: &str = "tests/cases/crank-on-crank.toml";

/// At looser tolerances the run is another one by then.
#[test]
fn a_short_hop_of_a_driven_rod_ends_where_it_lands() {
    for engine in ENGINES {
        for tolerance in [1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13] {
            let what = format!("{engine} at {tolerance:e}");
            let kept = sound(&from(CRANK_ON_CRANK, engine, tolerance, &SHORT_HOPS), &what);
            let last = &kept.contacts[kept.contacts.len() - 3..];
            if tolerance <= 1e-9 {
                let known = [5.871379131921e-3, 6.066127041936e-3, 6.366676505343e-3];
                assert_eq!(kept.contacts.len(), 21, "{what}");
                assert_begins(last, &known, 1e6 * tolerance.max(1e-11), &what);
            }
        }
    }
}

/// A hundred neighbours of the same: a hop that is over before the flight's second step was missed
/// in one of ten.
#[test]
fn short_hops_end_where_they_land_wherever_the_second_crank_begins() {
    for place in 0..100 {
        let angle = format!("drives.second.angle={:.5}", 2.115 + 1e-4 * f64::from(place));
        let set = [&SHORT_HOPS[..], &[&angle, "run.sample_interval=1e-5"]].concat();
        let of = |engine: &str, tolerance: f64| {
            let what = format!("{engine} at {tolerance:e}, {angle}");
            sound(&from(CRANK_ON_CRANK, engine, tolerance, &set), &what)
        };
        for tolerance in [1e-6, 1e-9] {
            of("explicit", tolerance);
        }
        let [ida, explicit] = ENGINES.map(|engine| of(engine, 1e-12));
        let begins: Vec<f64> = explicit.contacts.iter().map(|contact| contact.begin).collect();
        assert_begins(&ida.contacts, &begins, 1e-3, &angle);
    }
}

/// The rod begins where the case says: its joints leave its angle free.
const HARD_AND_BACKWARD: [&str; 5] = [
    "joints.Q.clearance={bearing_radius=0.01, radial=3e-4, normal={law=\"hertz\", stiffness=1e9}}",
    "drives.second.speed_rpm=-6000.0",
    "start.rod={angle=0.1951, angular_velocity=457.5006, fixed=true}",
    "run.duration=0.007",
    "run.sample_interval=1e-5",
];

/// Both references once skipped the contact at 3 ms, and agreed.
#[test]
fn what_both_references_would_skip_is_not_certified() {
    let known = [
        1.386642326590e-4,
        6.412084534419e-4,
        1.025021907140e-3,
        1.620787899494e-3,
        1.978077513581e-3,
        2.396106051709e-3,
        2.996163736697e-3,
        3.271431155394e-3,
        3.833763342872e-3,
        4.085345033873e-3,
        4.636323141081e-3,
        4.862918673117e-3,
        5.042304609337e-3,
        5.464198293998e-3,
        5.925622145742e-3,
        6.362137569348e-3,
        6.765957584006e-3,
        6.965017460528e-3,
    ];
    let case = from(CRANK_ON_CRANK, "ida", 1e-13, &HARD_AND_BACKWARD);
    let simulation = told(Simulation::new(&case));
    let go_on = |_| ControlFlow::Continue(());
    let reference = told(certify::reference(&case, simulation.schedule(), 10.0, &go_on));
    assert_sound(&reference.trajectory, "the reference");
    assert_begins(&reference.trajectory.contacts, &known, 1e-9, "the reference");
    let mut go_on = |_: &Progress| ControlFlow::Continue(());
    let certificate = told(certify::certify(simulation, reference, &mut go_on));
    assert!(certificate.run_failure.is_none() && certificate.parting.is_none());
    for engine in ENGINES {
        let kept = sound(&from(CRANK_ON_CRANK, engine, 1e-13, &HARD_AND_BACKWARD), engine);
        assert_begins(&kept.contacts, &known, 1e-6, engine);
    }
}

/// Whether a start in doubles is that in 71 digits.
fn assert_starts_alike(path: &str, set: &[&str]) {
    let case = case(path, set);
    let (doubles, exact) = (told(assemble::<f64>(&case)), told(assemble::<F256>(&case)));
    let (of_q, of_v) = doubles.scales();
    let pairs = |a: &[f64], b: &[F256], scales: &[f64]| -> f64 {
        let off = a.iter().zip(b).zip(scales);
        off.map(|((a, b), scale)| (*a - b.to_f64()).abs() / scale).fold(0.0, f64::max)
    };
    let (a, b) = (doubles.start(), exact.start());
    let off = pairs(&a.q, &b.q, of_q).max(pairs(&a.v, &b.v, of_v));
    let digits = -off.log10();
    assert!(digits >= 14.5, "{path}: {digits:.1} digits at t = 0");
}

#[test]
fn every_start_in_doubles_is_that_of_its_certificate() {
    let mut paths = Vec::new();
    for folder in ["cases", "tests/cases", "tests/nothing_missed"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            paths.push(format!("{folder}/{name}"));
        }
    }
    assert!(paths.len() > 15, "{paths:?}");
    for path in paths {
        assert_starts_alike(&path, &[]);
    }
}

/// Case c with B0 a hair η short of where coupler and follower are stretched: with the crank in line
/// both turn at ω a/d, d = 0.3 m − η. Six passes of assembly left 2e-4 rad/s at η = 1e-7 m, in both
/// runs of a certificate.
#[test]
fn a_reference_starts_right_beside_a_dead_centre() {
    let number = |literal: &str| F256::parse(literal).unwrap();
    for rate in ["", ", angular_velocity=0.0"] {
        for hair in 5..=18 {
            let b0 = format!("0.26{}", "9".repeat(hair - 2));
            let point = format!("ground.points.B0=[{b0}, 0.0]");
            let start =
                format!("start={{coupler={{angle=0.7{rate}}}, follower={{angle=1.84{rate}}}}}");
            let angle = "drives.crank.angle=\
                         3.14159265358979323846264338327950288419716939937510582097494459";
            let set = [point.as_str(), angle, start.as_str()];
            let mechanism = told(assemble::<F256>(&case("cases/four-bar-c.toml", &set)));
            let crank = F256::ratio(5000, 30) * <F256 as Scalar>::pi() * number("0.03");
            let known = crank / (number(&b0) + number("0.03"));
            for body in [0, 1] {
                let found = mechanism.start().v[3 * body + 2];
                let off = Scalar::abs((found - known) / known).to_f64();
                assert!(off < 1e-16, "η = 1e-{hair} m: {:e}, off by {off:e}", found.to_f64());
            }
        }
    }
}

/// So does a run in doubles, or it says that it cannot.
#[test]
fn doubles_start_right_beside_a_dead_centre_or_say_that_they_cannot() {
    let angle = "drives.crank.angle=3.14159265358979323846264338327950288419717";
    let mut started = 0;
    for hair in 5..=18 {
        let b0 = format!("0.26{}", "9".repeat(hair - 2));
        let point = format!("ground.points.B0=[{b0}, 0.0]");
        let case = case("cases/four-bar-c.toml", &[&point, angle]);
        match assemble::<f64>(&case) {
            Ok(mechanism) => {
                started += 1;
                let known = 5.0 * std::f64::consts::PI / (b0.parse::<f64>().unwrap() + 0.03);
                for body in [0, 1] {
                    let found = mechanism.start().v[3 * body + 2];
                    assert!((found / known - 1.0).abs() < 1e-4, "η = 1e-{hair} m: {found} rad/s");
                }
            }
            Err(error) => assert!(words(&error).contains("dead centre"), "{}", words(&error)),
        }
    }
    assert!((5..14).contains(&started), "{started} of 14");
}

#[test]
fn a_disc_dropped_at_the_tolerance_of_the_literature_comes_to_rest_before_patience_ends() {
    for engine in ENGINES {
        let kept = sound(&mechanism("dropped-disc", engine, 1e-12, &[]), engine);
        let last = kept.samples.last().unwrap();
        let depth = (0.05 * 9.81 / 1.043_715_536_510_028_3e10_f64).powf(2.0 / 3.0);
        let off = (last.clearances[0].penetration - depth).abs();
        assert!(last.time == 0.5 && off < 1e-3 * depth, "{engine}: {off:e} m of {depth:e}");
    }
}

const GRAVITY: &str = "loads.gravity={kind=\"gravity\", acceleration=[0.0, -9.81]}";

/// Steps that IDA takes of a case.
fn steps(path: &str, set: &[&str]) -> u64 {
    simulated::simulate(&case(path, set)).count("steps")
}

#[test]
fn an_absolute_tolerance_below_rounding_costs_no_more_than_rounding_asks_for() {
    let still =
        ["drives.crank.speed_rpm=0.0", GRAVITY, "run.duration=0.3", "run.sample_interval=1e-3"];
    let falling = ["run.duration=0.25"];
    for (path, set) in [
        ("cases/four-bar-a.toml", &still[..]),
        ("tests/nothing_missed/dropped-disc.toml", &falling[..]),
    ] {
        let literature = steps(path, set);
        let scaled = steps(path, &[set, &["solver.absolute_tolerance=scaled"]].concat());
        assert!(literature <= 4 * scaled, "{path}: {literature} steps, {scaled} if scaled");
    }
}

#[test]
fn a_mechanism_far_from_the_origin_does_not_crawl() {
    let linkage = |a: &str, coupler: &str, b: &str| {
        let a0 = format!("ground.points.A0=[{a}, 0.0]");
        let b0 = format!("ground.points.B0=[{b}, 0.0]");
        let start =
            format!("start={{coupler={{x={coupler}, angle=0.7}}, follower={{x={b}, angle=1.84}}}}");
        steps("cases/four-bar-a.toml", &[&a0, &b0, &start, "run.duration=0.005"])
    };
    let (near, far) = (linkage("0.0", "0.09", "0.2"), linkage("1000.0", "1000.09", "1000.2"));
    assert!(far * 10 <= near * 11, "{far} steps a kilometre away, {near} at the origin");
}

#[test]
fn a_loose_motor_backward_passes_through_its_contact() {
    let set = [
        "drives.motor.speed_rpm=-762.0",
        "joints.O.clearance.radial=6.3e-5",
        "run.duration=0.003",
        "run.sample_interval=1e-6",
    ];
    for engine in ENGINES {
        for tolerance in [1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14] {
            let what = format!("{engine} at {tolerance:e}");
            let kept = sound(&from("tests/cases/loose-motor.toml", engine, tolerance, &set), &what);
            assert_begins(&kept.contacts, &[2.203458587829e-3], 1e2 * tolerance.max(1e-11), &what);
            let end = kept.contacts[0].end;
            assert!(
                (end - 2.327064343486e-3).abs() < 1e3 * tolerance.max(1e-11) * end,
                "{what}: it ends at {end:e} s"
            );
        }
    }
}

#[test]
fn a_motor_on_its_own_clearance_runs_at_every_tolerance() {
    for point in ["[-0.004, 0.0]", "[0.0, 0.0]"] {
        let point = format!("bodies.rotor.points.O={point}");
        for engine in ENGINES {
            for tolerance in [1e-6, 1e-9, 1e-12] {
                let what = format!("{point}, {engine} at {tolerance:e}");
                let set = [point.as_str(), "run.sample_interval=1e-5"];
                sound(&from("tests/cases/loose-motor.toml", engine, tolerance, &set), &what);
            }
        }
    }
}

#[test]
fn rotors_that_spin_and_drop_land_on_every_event() {
    for turn in 0..18 {
        let angle = 0.349 * f64::from(turn);
        let start = format!(
            "start.rotor={{x=0.0, y=0.0, angle={angle:.3}, velocity_x=0.0, velocity_y=0.0, \
             angular_velocity=1000.0, fixed=true}}"
        );
        let set =
            ["bodies.rotor.points.J=[0.0001, 0.0]", start.as_str(), GRAVITY, "run.duration=0.06"];
        let strikes = strikes([0.0, 9.81], [1e-4, angle, 1000.0]);
        for engine in ENGINES {
            let what = format!("{engine}, {start}");
            let kept = sound(&mechanism("eccentric-rotor", engine, 1e-12, &set), &what);
            assert_begins(&kept.contacts[..1], &[strikes], 1e-11, &what);
            assert!(kept.contacts.len() > 1, "{what}: {} contacts", kept.contacts.len());
        }
    }
}

/// Without friction the rod would swing the same; with its law through zero it is slowed from the
/// first instant of slip on.
#[test]
fn friction_without_a_still_region_holds_from_the_first_slip_on() {
    let known = [
        4.515236409858e-3,
        6.268995653997e-3,
        1.097479472093e-2,
        1.321268394469e-2,
        1.638896607309e-2,
        1.967878793973e-2,
    ];
    for v0 in ["0.0", "1e-9"] {
        let edge = format!("joints.O.clearance.friction.v0={v0}");
        for engine in ENGINES {
            let what = format!("{engine}, v0 = {v0}");
            let kept = sound(&mechanism("hung-rod", engine, 1e-12, &[&edge]), &what);
            assert_begins(&kept.contacts, &known, 1e-7, &what);
            let late = kept.samples.iter().find(|sample| sample.time == 0.015).unwrap();
            let off = (late.bodies[0].angle + 1.201576045072).abs();
            assert!(off <= 1e-9, "{what}: the angle is {off:e} rad off at 15 ms");
            assert_friction(&kept, &what);
        }
    }
}

/// Whether slip beyond the ramp has the whole friction, of 0.1.
fn assert_friction(kept: &Trajectory, what: &str) {
    let clearances = kept.samples.iter().map(|sample| (sample.time, sample.clearances[0]));
    for (time, clearance) in clearances.filter(|(_, clearance)| clearance.normal_force > 1.0) {
        let share = (clearance.slip_velocity.abs() / 1e-2).min(1.0);
        let off = (clearance.tangential_force.abs() / clearance.normal_force - 0.1 * share).abs();
        assert!(off < 1e-5, "{what}: friction is {off:e} of the force off at {time:e} s");
    }
}

/// IDA at 1e-3 once had the friction of another region at 70 samples of 60 ms.
#[test]
fn friction_keeps_its_law_at_the_loosest_tolerances() {
    let set = ["run.duration=0.015", "run.sample_interval=1e-6"];
    let (coefficient, v0, v1) = (0.1, 1e-3, 1e-2);
    for engine in ENGINES {
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let what = format!("{engine} at {tolerance:e}");
            let kept = run(&from("cases/four-bar-a-friction.toml", engine, tolerance, &set));
            let kept = kept.unwrap_or_else(|error| panic!("{what}: {error}"));
            let contacts = kept.samples.iter().map(|sample| (sample.time, sample.clearances[0]));
            let mut pressed = 0;
            for (time, contact) in contacts.filter(|(_, contact)| contact.normal_force > 0.0) {
                let share = ((contact.slip_velocity.abs() - v0) / (v1 - v0)).clamp(0.0, 1.0);
                let ratio = contact.tangential_force.abs() / contact.normal_force / coefficient;
                assert!((ratio - share).abs() < 1e-6, "{what}: {ratio} for {share} at {time:e} s");
                pressed += 1;
            }
            assert!(pressed > 1000, "{what}: {pressed} samples in contact");
        }
    }
}

#[test]
fn steep_ramps_of_friction_are_passed() {
    for (v0, v1) in [("1e-3", "1.0000001e-3"), ("1e-6", "2e-6"), ("0.0", "1e-6")] {
        let edges = [
            format!("joints.O.clearance.friction.v0={v0}"),
            format!("joints.O.clearance.friction.v1={v1}"),
        ];
        for engine in ENGINES {
            let what = format!("{engine}, ramp from {v0} to {v1} m/s");
            let set = [edges[0].as_str(), edges[1].as_str()];
            sound(&mechanism("hung-rod", engine, 1e-9, &set), &what);
        }
    }
}

#[test]
fn a_rod_on_a_soft_bearing_stays_in_it_at_loose_tolerances_too() {
    let set = [
        "joints.O.clearance={bearing_radius=0.01, radial=1e-4, normal={law=\"hertz\", stiffness=1e8}}",
        "run.duration=1.0",
        "run.sample_interval=1e-4",
    ];
    for engine in ENGINES {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let what = format!("{engine} at {tolerance:e}");
            let kept = sound(&mechanism("hung-rod", engine, tolerance, &set), &what);
            let off = energy_off(&kept);
            assert!(off <= (1e3 * tolerance).max(1e-6), "{what}: energy is off by {off:e}");
            let deepest = kept.contacts.iter().map(|contact| contact.peak_penetration);
            let deepest = deepest.fold(0.0, f64::max);
            assert!(deepest < 1e-3, "{what}: {deepest:e} m deep");
        }
    }
}

/// A case in 71 digits at a tolerance.
fn in_71_digits(path: &str, tolerance: f64, set: &[&str]) -> Case {
    let tolerance = format!("solver.reference_tolerance={tolerance:e}");
    let digits = ["solver.engine=explicit", "solver.precision=71", tolerance.as_str()];
    case(path, &[&digits[..], set].concat())
}

#[test]
fn edges_of_friction_within_a_step_stop_no_reference() {
    let set = ["run.duration=0.024", "run.sample_interval=1e-5"];
    for tolerance in [1e-20, 1e-24] {
        let case = in_71_digits("cases/four-bar-a-friction.toml", tolerance, &set);
        sound(&case, &format!("71 digits at {tolerance:e}"));
    }
}

#[test]
fn a_journal_whose_friction_has_no_still_region_lands_on_its_edges() {
    let friction =
        r#"joints.O.clearance.friction={law="ambrosio", coefficient=0.1, v0=0.0, v1=1e-4}"#;
    let set = [friction, "run.duration=0.01"];
    let path = "cases/journal-in-bearing.toml";
    for engine in ENGINES {
        sound(&from(path, engine, 1e-12, &set), engine);
    }
    sound(&in_71_digits(path, 1e-24, &set), "71 digits");
}

#[test]
fn contacts_that_begin_and_end_in_one_instant_do_not_stop_a_run() {
    let known = [
        ("bar-on-two-pins", 1.078377988378e-2, 2.912662883396e-2),
        ("two-journals", 1.048961349097e-2, 2.887421426448e-2),
    ];
    for (name, ends, again) in known {
        let begins = [(2.0 * 0.0005 / 9.81_f64).sqrt(), again].map(|begin| [begin; 2]).concat();
        let path = format!("tests/nothing_missed/{name}.toml");
        let mut runs: Vec<(String, Case)> =
            vec![("71 digits".into(), in_71_digits(&path, 1e-24, &[]))];
        runs.extend(ENGINES.map(|engine| (engine.into(), from(&path, engine, 1e-12, &[]))));
        for (engine, case) in runs {
            let what = format!("{name}, {engine}");
            let kept = sound(&case, &what);
            assert_begins(&kept.contacts, &begins, 1e-9, &what);
            let end = kept.contacts[0].end;
            assert!((end - ends).abs() < 1e-9 * ends, "{what}: the first end at {end:e} s");
        }
    }
}

#[test]
fn flight_begins_on_the_wall_however_loosely_its_contact_was_solved() {
    for engine in ENGINES {
        for tolerance in [1e-3, 1e-4, 1e-6, 1e-9] {
            let set = ["run.duration=0.03", "run.sample_interval=1.5e-6"];
            let links = mechanism("falling-links", engine, tolerance, &set);
            sound(&links, &format!("{engine} at {tolerance:e}"));
        }
    }
}

#[test]
fn where_tension_is_cut_the_energy_balance_closes() {
    for engine in ENGINES {
        for (tolerance, allowed) in [(1e-9, 1e-7), (1e-12, 1e-9)] {
            let set = ["run.duration=0.06", "run.sample_interval=3e-5"];
            let bar = mechanism("bar-let-go", engine, tolerance, &set);
            let kept = sound(&bar, &format!("{engine} at {tolerance:e}"));
            let off = energy_off(&kept);
            assert!(off < allowed, "{engine} at {tolerance:e}: {off:e}");
        }
    }
}

/// At 1e-6 a step goes so far beyond the end of one contact, whence time runs back, that it ends
/// before it began: nothing else is to be looked for there.
#[test]
fn beyond_the_end_of_a_contact_nothing_is_looked_for() {
    let set = ["run.duration=0.06", "run.sample_interval=3e-5"];
    let chain = mechanism("chain-of-four", "explicit", 1e-6, &set);
    let kept = sound(&chain, "explicit at 1e-6");
    assert!(kept.contacts.len() > 60, "{} contacts", kept.contacts.len());
}
