//! Blocks in guides and pins in slots, with play. Known in advance: the first two impacts of a tumbling
//! block to 44 digits (`tests/data/problems`), a mass between two springs and a spinning pin in closed
//! form, momenta, forces by Newton's second law, and that nothing depends on how a guide is turned.

mod simulated;

use freeplay::case::{Case, Changes};
use freeplay::mechanism::Observation;
use simulated::{Kept, case, case_of, root, simulate, words};
use std::f64::consts::PI;
use std::path::Path;

const ENGINES: [&str; 2] = ["solver.engine=explicit", "solver.engine=ida"];
const GUIDES: [&str; 3] = [
    "cases/slider-crank-guide.toml",
    "cases/oscillating-cylinder.toml",
    "tests/kinds/slotted-lever.toml",
];

/// A contact as the problem has it.
struct Known {
    corner: usize,
    begin: f64,
    end: f64,
    impact_rate: f64,
    peak_force: f64,
    peak_time: f64,
    /// y, v_y, θ, ω at the end.
    after: [f64; 4],
}

fn known() -> Vec<Known> {
    let path = root().join("tests/data/problems/block-in-guide.csv");
    let mut reader = csv::Reader::from_path(path).unwrap();
    let names = reader.headers().unwrap().clone();
    let contact = |row: csv::StringRecord| {
        let of = |name: &str| -> f64 {
            row[names.iter().position(|known| known == name).unwrap()].parse().unwrap()
        };
        let signs = (of("corner_x_sign"), of("corner_y_sign"));
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        Known {
            corner: corners.iter().position(|corner| *corner == signs).unwrap(),
            begin: of("begin_s"),
            end: of("end_s"),
            impact_rate: of("impact_rate"),
            peak_force: of("peak_force_N"),
            peak_time: of("peak_time_s"),
            after: ["y_end", "vy_end", "theta_end", "omega_end"].map(of),
        }
    };
    reader.records().map(|row| contact(row.unwrap())).collect()
}

fn assert_near(what: &str, found: f64, exact: f64, within: f64) {
    assert!((found - exact).abs() <= within, "{what}: {found:e}, it is {exact:e}");
}

#[test]
fn a_tumbling_block_meets_its_walls_as_is_known_to_44_digits() {
    let octuple =
        ["solver.engine=explicit", "solver.precision=71", "solver.reference_tolerance=1e-30"];
    for (set, within) in [(&ENGINES[..1], 1e-11), (&ENGINES[1..], 2e-9), (&octuple, 1e-15)] {
        let known = known();
        let end = format!("run.duration={:e}", 1.0001 * known[1].end);
        let set = [set, &[&*end, "run.sample_interval=1e-4"]].concat();
        let kept = simulate(&case("cases/block-in-guide.toml", &set));
        assert_eq!(kept.contacts.len(), 2);
        for (contact, known) in kept.contacts.iter().zip(&known) {
            assert_eq!(contact.clearance, known.corner);
            for (what, found, exact) in [
                ("begin", contact.begin, known.begin),
                ("end", contact.end, known.end),
                ("impact rate", contact.impact_rate, known.impact_rate),
                ("peak force", contact.peak_force, known.peak_force),
                ("peak time", contact.peak_time, known.peak_time),
            ] {
                assert_near(what, found, exact, within * exact);
            }
        }
        // from the end on the block flies: back from the last sample
        let last = kept.last();
        let (body, [y, vy, theta, omega]) = (last.bodies[0], known[1].after);
        let late = last.time - known[1].end;
        assert_near("y", body.position[1], y + vy * late - 4.905 * late * late, 5e-4 * within);
        assert_near("v_y", body.velocity[1], vy - 9.81 * late, 0.1 * within);
        assert_near("angle", body.angle, theta + omega * late, 1e-2 * within);
        assert_near("rate", body.angular_velocity, omega, 5.0 * within);
    }
}

/// The same block, its guide turned and its own frame turned in that.
fn turned(by: f64, frame: f64) -> Case {
    let (sin, cos) = by.sin_cos();
    let [axis, velocity, gravity] =
        [[cos, sin], [-0.1 * sin, 0.1 * cos], [9.81 * sin, -9.81 * cos]];
    let start = format!(
        "start.block={{x=0.0,y=0.0,angle={:?},velocity_x={:?},velocity_y={:?},angular_velocity=-3.0,fixed=true}}",
        0.002 + frame,
        velocity[0],
        velocity[1]
    );
    let set = [
        format!("joints.slide.axis={axis:?}"),
        format!("joints.slide.angle={frame:?}"),
        format!("loads.gravity.acceleration={gravity:?}"),
        start,
        "run.duration=0.02".to_owned(),
        ENGINES[0].to_owned(),
    ];
    let set: Vec<&str> = set.iter().map(|key| &**key).collect();
    case("cases/block-in-guide.toml", &set)
}

#[test]
fn nothing_depends_on_how_a_guide_and_a_block_are_turned() {
    let plain = simulate(&turned(0.0, 0.0));
    assert!(plain.contacts.len() >= 3);
    for (by, frame) in [(0.7, 0.0), (0.0, 2.0), (-2.5, 0.4)] {
        let other = simulate(&turned(by, frame));
        assert_eq!(plain.contacts.len(), other.contacts.len());
        for (one, two) in plain.contacts.iter().zip(&other.contacts) {
            assert_eq!(one.clearance, two.clearance);
            assert_near("begin", two.begin, one.begin, 1e-10 * one.begin);
            assert_near("peak", two.peak_force, one.peak_force, 1e-8 * one.peak_force);
        }
        for (one, two) in plain.samples.iter().zip(&other.samples) {
            for (a, b) in one.clearances.iter().zip(&two.clearances) {
                assert_near("eccentricity", b.eccentricity, a.eccentricity, 5e-12);
                assert_near("rate", b.penetration_rate, a.penetration_rate, 1e-8);
                // along the wall's normal
                let length = b.offset[0].hypot(b.offset[1]);
                assert_near("offset", length, b.eccentricity.abs(), 1e-18 + 1e-14 * length);
            }
        }
    }
}

#[test]
fn a_guide_puts_on_its_block_what_moves_it() {
    for engine in ENGINES {
        let kept = simulate(&case("cases/block-in-guide.toml", &[engine]));
        let pressed = kept.largest(|sample| sample.joints[0].force[1]);
        assert!(pressed > 50.0, "{pressed}");
        for sample in &kept.samples {
            let (body, joint) = (sample.bodies[0], sample.joints[0]);
            assert_near("force", joint.force[1], 0.14 * (body.acceleration[1] + 9.81), 1e-9);
            assert_near("moment", joint.moment, 1.4e-4 * body.angular_acceleration, 1e-11);
        }
        assert!(kept.largest(|sample| sample.energy.residual) < 1e-11);
    }
}

#[test]
fn both_engines_agree_where_guides_and_slots_move() {
    for path in GUIDES {
        let set =
            ["run.duration=0.008", "run.sample_interval=1e-5", "solver.relative_tolerance=1e-12"];
        let [one, two] =
            ENGINES.map(|engine| simulate(&case(path, &[&set[..], &[engine]].concat())));
        assert!(!one.contacts.is_empty(), "{path}");
        assert_eq!(one.contacts.len(), two.contacts.len(), "{path}");
        for (a, b) in one.contacts.iter().zip(&two.contacts) {
            assert_eq!(a.clearance, b.clearance, "{path}");
            assert_near(path, b.begin, a.begin, 1e-8 * a.begin);
            assert_near(path, b.peak_force, a.peak_force, 1e-6 * a.peak_force);
        }
        for (a, b) in one.samples.iter().zip(&two.samples) {
            for (a, b) in a.bodies.iter().zip(&b.bodies) {
                assert_near(path, b.angle, a.angle, 1e-9);
                assert_near(path, b.velocity[0], a.velocity[0], 1e-7);
            }
        }
        for kept in [one, two] {
            let energy = kept.largest(|sample| sample.energy.kinetic);
            let off = kept.largest(|sample| sample.energy.residual);
            assert!(off < 1e-9 * energy, "{path}: {off:e} of {energy:e}");
        }
    }
}

/// A guide and its block, both free, and a pin in a slot: nothing else acts on them.
fn adrift(kind: &str, play: &str) -> String {
    format!(
        "[bodies.guide]\nmass = 0.4\ninertia = 3e-4\npoints = {{ P = [0.01, 0.02] }}\n\
         [bodies.block]\nmass = 0.2\ninertia = 1e-4\npoints = {{ C = [-0.01, 0.005] }}\n\
         [joints.slide]\nkind = \"{kind}\"\nbetween = [\"guide.P\", \"block.C\"]\naxis = [1.0, 0.3]\n\
         [joints.slide.clearance]\n{play}\n\
         normal = {{ law = \"lankarani-nikravesh\", restitution = 0.8, stiffness = 1e9 }}\n\
         friction = {{ law = \"ambrosio\", coefficient = 0.3, v0 = 1e-3, v1 = 1e-2 }}\n\
         [start]\nguide = {{ x = 0.0, y = 0.0, angle = 0.2, angular_velocity = 20.0 }}\n\
         block = {{ velocity_x = 0.5, angular_velocity = -5.0 }}\n\
         [run]\nduration = 0.02\nsample_interval = 1e-4\n"
    )
}

/// Linear momentum, and the angular one about the origin.
fn momenta(sample: &Observation) -> [f64; 3] {
    let bodies = [(0.4, 3e-4), (0.2, 1e-4)].into_iter().zip(&sample.bodies);
    bodies.fold([0.0; 3], |[px, py, l], ((mass, inertia), body)| {
        let ([x, y], [u, v]) = (body.position, body.velocity);
        let turning = mass * (x * v - y * u) + inertia * body.angular_velocity;
        [px + mass * u, py + mass * v, l + turning]
    })
}

#[test]
fn forces_in_guides_and_slots_are_equal_and_opposite_in_one_line() {
    let plays = [
        ("prismatic", "gap = 0.0003\nlength = 0.06\nheight = 0.02"),
        ("pin-slot", "gap = 0.0003\npin_radius = 0.004"),
    ];
    for (kind, play) in plays {
        for (engine, within) in [(ENGINES[0], 1e-13), (ENGINES[1], 1e-10)] {
            let set = [engine, "solver.relative_tolerance=1e-12"];
            let kept = simulate(&case_of(&adrift(kind, play), &set));
            assert!(kept.contacts.len() >= 2, "{kind}: {}", kept.contacts.len());
            let rubbed = kept
                .largest(|sample| sample.clearances.iter().map(|c| c.tangential_force.abs()).sum());
            assert!(rubbed > 1.0, "{kind}: {rubbed}");
            let first = momenta(&kept.samples[0]);
            for sample in &kept.samples {
                for (now, then) in momenta(sample).into_iter().zip(first) {
                    assert_near(kind, now, then, within);
                }
            }
        }
    }
}

/// A mass with a pin of 5 mm in a slot of the ground, 1 mm of play on each side.
fn pin(normal: &str, rest: &str) -> String {
    format!(
        "[ground]\npoints = {{ O = [0.0, 0.0] }}\n\
         [bodies.mass]\nmass = 0.5\ninertia = 1e-5\npoints = {{ C = [0.0, 0.0] }}\n\
         [joints.slot]\nkind = \"pin-slot\"\nbetween = [\"ground.O\", \"mass.C\"]\naxis = [1.0, 0.0]\n\
         [joints.slot.clearance]\ngap = 1e-3\npin_radius = 5e-3\nnormal = {normal}\n{rest}"
    )
}

#[test]
fn a_mass_between_two_springs_goes_to_and_fro_as_in_closed_form() {
    let (stiffness, mass, speed, gap) = (1e6, 0.5, 0.1, 1e-3);
    let text = pin(
        "{ law = \"hertz\", stiffness = 1e6, exponent = 1.0 }",
        "[start]\nmass = { velocity_x = 0.7, velocity_y = 0.1, fixed = true }\n\
         [run]\nduration = 0.1\nsample_interval = 1e-3\n",
    );
    let omega: f64 = f64::sqrt(stiffness / mass);
    for (engine, within) in [(ENGINES[0], 1e-12), (ENGINES[1], 1e-9)] {
        let kept = simulate(&case_of(&text, &[engine, "solver.relative_tolerance=1e-12"]));
        assert!(kept.contacts.len() >= 4, "{}", kept.contacts.len());
        for (k, contact) in kept.contacts.iter().enumerate() {
            let begin = gap / speed + k as f64 * (PI / omega + 2.0 * gap / speed);
            assert_eq!(contact.clearance, k % 2);
            assert_near("begin", contact.begin, begin, within * begin);
            assert_near(
                "peak",
                contact.peak_force,
                speed * f64::sqrt(stiffness * mass),
                1e3 * within,
            );
            if !contact.end.is_nan() {
                assert_near("end", contact.end, begin + PI / omega, within * begin);
            }
        }
        assert!(kept.samples.iter().all(|s| (s.bodies[0].velocity[0] - 0.7).abs() < 1e-13));
    }
}

#[test]
fn a_spinning_pin_on_a_flank_rolls_off_as_in_closed_form() {
    let text = pin(
        "{ law = \"lankarani-nikravesh\", restitution = 0.9, stiffness = 1e9 }",
        "friction = { law = \"ambrosio\", coefficient = 0.2, v0 = 1e-4, v1 = 1e-3 }\n\
         [loads.gravity]\nkind = \"gravity\"\nacceleration = [0.0, -9.81]\n\
         [start]\nclosed = \"pressed\"\nmass = { angular_velocity = 50.0 }\n\
         [run]\nduration = 5e-3\nsample_interval = 1e-4\n",
    );
    let (mass, inertia, radius, friction): (f64, f64, f64, f64) =
        (0.5, 1e-5, 5e-3, 0.2 * 0.5 * 9.81);
    for (engine, within) in [(ENGINES[0], 1e-11), (ENGINES[1], 1e-8)] {
        let kept = simulate(&case_of(&text, &[engine, "solver.relative_tolerance=1e-12"]));
        let depth = (mass * 9.81 / 1e9_f64).powf(2.0 / 3.0);
        for sample in &kept.samples {
            let (body, time) = (sample.bodies[0], sample.time);
            let slip = body.velocity[0] + radius * body.angular_velocity;
            assert!(slip > 1e-2, "{slip} at {time}: no longer sliding");
            assert_near("y", body.position[1], -(1e-3 + depth), 1e-14 + 1e-3 * within);
            assert_near("v_x", body.velocity[0], -friction / mass * time, within);
            let rate = 50.0 - friction * radius / inertia * time;
            assert_near("rate", body.angular_velocity, rate, 50.0 * within);
            assert_near("slip", sample.clearances[1].slip_velocity, slip, 1e-13);
        }
    }
}

#[test]
fn what_is_pressed_against_its_guide_stays_there() {
    let gravity = "[loads.gravity]\nkind = \"gravity\"\nacceleration = [0.0, -9.81]\n";
    let block = |beside: f64| {
        format!(
            "[ground]\npoints = {{ O = [0.0, 0.0] }}\n[bodies.block]\nmass = 0.14\ninertia = 1.4e-4\n\
             points = {{ C = [{beside:?}, 0.0] }}\n[joints.slide]\nkind = \"prismatic\"\n\
             between = [\"ground.O\", \"block.C\"]\naxis = [1.0, 0.0]\n[joints.slide.clearance]\n\
             gap = 0.0005\nlength = 0.1\nheight = 0.05\n\
             normal = {{ law = \"lankarani-nikravesh\", restitution = 0.9, stiffness = 1e9 }}\n{gravity}\
             [start]\nclosed = \"pressed\"\n[run]\nduration = 0.01\nsample_interval = 1e-3\n"
        )
    };
    // on two corners below; on one below and one above, as the weight is beyond the block's end. The
    // forces are those of the ideal mechanism, whose block is not tilted: what that leaves is small
    let cases =
        [(0.01, [false, false, true, true], 1e-5), (-0.08, [false, true, false, true], 2e-3)];
    for (beside, corners, within) in cases {
        for engine in ENGINES {
            let set = [engine, "solver.relative_tolerance=1e-12"];
            let kept = simulate(&case_of(&block(beside), &set));
            for sample in &kept.samples {
                let touching: Vec<bool> = sample.clearances.iter().map(|c| c.in_contact).collect();
                assert_eq!(touching, corners, "{beside} at {}", sample.time);
                let body = sample.bodies[0];
                assert_near("velocity", body.velocity[1], 0.0, within);
                assert_near("rate", 0.1 * body.angular_velocity, 0.0, within);
            }
        }
    }
}

#[test]
fn corners_that_strike_together_are_both_met() {
    for engine in ENGINES {
        for tolerance in ["1e-6", "1e-9", "1e-12"] {
            let tolerance = format!("solver.relative_tolerance={tolerance}");
            // later the tilt of rounding, which each impact makes larger, is as large as the play
            let set = [engine, &tolerance, "run.duration=0.012"];
            let kept = simulate(&case("tests/kinds/untilted-block.toml", &set));
            let count = |k: usize| kept.contacts.iter().filter(|c| c.clearance == k).count();
            assert!(count(0) + count(2) >= 5, "{engine} {tolerance}");
            assert_eq!([count(0), count(2)], [count(1), count(3)], "{engine} {tolerance}");
        }
    }
}

#[test]
fn what_is_wrong_with_a_guide_is_told_with_its_key() {
    let own = |set: &str| format!("joints.slide.clearance.{set}");
    let cases = [
        (
            own("normal={law=\"hertz\",stiffness=\"hertz-printed\",young=2e11,poisson=0.3}"),
            "clearance.normal.stiffness: \"hertz-printed\" needs clearance.corner_radius",
        ),
        (
            own("normal={law=\"hertz\",elastic=\"johnson\",length=0.1,young=2e11,poisson=0.3}"),
            "clearance.normal.elastic: is the law of a cylinder in a bearing",
        ),
        (own("gap=0"), "clearance.gap: must be positive (m), is 0"),
        (own("radial=1e-3"), "clearance.radial: unknown key"),
        (
            "joints.slide_3={kind=\"distance\",between=[\"ground.O\",\"block.C\"],length=1.0}"
                .to_owned(),
            "joints.slide: would give one of its walls the name \"slide_3\", which is taken",
        ),
        (
            "start.contact=[{joint=\"slide\",impact_rate=1.0}]".to_owned(),
            "start.contact.1.joint: joint \"slide\" touches in \"slide_1\" and others",
        ),
        ("joints.slide.kind=pin-slot".to_owned(), "clearance.pin_radius: is missing"),
    ];
    for (set, told) in cases {
        let changes = Changes { set: vec![set.parse().unwrap()], ideal: false };
        let path = root().join("cases/block-in-guide.toml");
        let words = words(&Case::read(Path::new(&path), &changes).expect_err(&set));
        assert!(words.contains(told), "{set}\n{words}");
    }
}

#[test]
fn contacts_of_a_guide_are_those_of_71_digits_until_chaos_parts_them() {
    let set = ["run.duration=0.008", "run.sample_interval=1e-4", ENGINES[0]];
    let octuple = ["solver.precision=71", "solver.reference_tolerance=1e-25"];
    for path in GUIDES {
        let doubles: Kept =
            simulate(&case(path, &[&set[..], &["solver.relative_tolerance=1e-13"]].concat()));
        let truth = simulate(&case(path, &[&set[..], &octuple].concat()));
        assert_eq!(doubles.contacts.len(), truth.contacts.len(), "{path}");
        assert!(!truth.contacts.is_empty(), "{path}");
        for (a, b) in doubles.contacts.iter().zip(&truth.contacts) {
            assert_near(path, a.begin, b.begin, 1e-9 * b.begin);
            assert_near(path, a.peak_force, b.peak_force, 1e-7 * b.peak_force);
        }
    }
}
