//! Where runs start. Known in advance: the start is the same in every arithmetic, to the last
//! places of each; rates near a dead centre from the triangle of the links; a disc that rests on
//! the wall of its bearing slides along it as a pendulum swings, or leaves it, as its load tells.

mod simulated;

use freeplay::case::Case;
use freeplay::case::Changes;
use freeplay::clearance::Mode;
use freeplay::digits::{Scales, Sizes};
use freeplay::mechanism::{Mechanism, Observation};
use freeplay::record::{Dimension, ResultFile};
use freeplay::scalar::{F256, Scalar};
use freeplay::simulate::{Simulation, assemble};
use simulated::{Kept, case, case_of, root, simulate, told};

/// Every case file of the project.
fn all_cases() -> Vec<(String, Case)> {
    let files = ["cases", "tests/cases"].into_iter().flat_map(|folder| {
        let entries = std::fs::read_dir(root().join(folder)).unwrap();
        entries
            .map(move |entry| format!("{folder}/{}", entry.unwrap().file_name().to_str().unwrap()))
    });
    files.map(|path| (path.clone(), case(&path, &[]))).collect()
}

/// Digits that the start in doubles has, in the scales of certificates.
fn digits_of_start(case: &Case) -> f64 {
    let doubles: Mechanism<f64> = told(assemble(case));
    let exact: Mechanism<F256> = told(assemble(case));
    let sizes = Sizes::of(&doubles);
    let [doubles, exact] = [
        doubles.observe(0.0, &doubles.start().integrals),
        exact.observe(0.0, &exact.start().integrals),
    ];
    let scales = Scales::of(std::slice::from_ref(&exact), &sizes);
    -scales.differences(&doubles, &exact).state.log10()
}

#[test]
fn starts_in_doubles_have_all_digits_of_those_in_71() {
    for (path, case) in all_cases() {
        let digits = digits_of_start(&case);
        println!("{path}: {digits:.2}");
        assert!(digits >= 14.5, "{path}: {digits}");
    }
}

#[test]
fn starts_tell_how_accurate_they_are() {
    for (path, case) in all_cases() {
        let doubles = told(assemble::<f64>(&case)).start_accuracy();
        let exact = told(assemble::<F256>(&case)).start_accuracy();
        println!("{path}: {doubles:.1e} {exact:.1e}");
        assert!(doubles < 1e-10 && exact < 1e-64, "{path}: {doubles:e}, {exact:e}");
    }
}

/// The four-bar of case c near the dead centre in which coupler and follower are stretched: its
/// bearing in the ground is nearer than the links are long together by `short`.
fn stretched(short: &str, named: &[&str]) -> Case {
    let far = 0.27 - short.parse::<f64>().unwrap();
    let ground = format!("ground.points.B0=[{far:.12}, 0.0]");
    let set = [&[ground.as_str(), "drives.crank.angle=3.141592653589793"], named].concat();
    case("cases/four-bar-c.toml", &set)
}

/// Rates of coupler and follower (rad/s) from the triangle A B B0, bent as the mechanism is.
fn rates_of_triangle<S: Scalar>(mechanism: &Mechanism<S>, far: &str) -> [S; 2] {
    let number = |literal: &str| S::parse(literal).unwrap();
    let (a, b) = (number("0.18"), number("0.12"));
    let (sin, cos) = number("3.141592653589793").sin_cos();
    let [ax, ay] = [number("0.03") * cos, number("0.03") * sin];
    let (dx, dy) = (number(far) - ax, -ay);
    let d2 = dx * dx + dy * dy;
    // the coupler's part along the line from A to B0, and across it
    let along = (d2 + a * a - b * b) / (d2 + d2);
    let across = (a * a / d2 - along * along).sqrt();
    let coupler = mechanism.start().q[2];
    let (sin, cos) = coupler.sin_cos();
    let across = if dx * sin - dy * cos > S::zero() { across } else { -across };
    let [ux, uy] = [along * dx - across * dy, along * dy + across * dx];
    let [wx, wy] = [ux - dx, uy - dy];
    let rate = number("5000") * S::pi() / number("30");
    let [vx, vy] = [-(rate * ay), rate * ax];
    let twist = ux * wy - uy * wx;
    [-(vx * wx + vy * wy) / twist, -(vx * ux + vy * uy) / twist]
}

#[test]
fn near_a_dead_centre_rates_are_those_of_the_triangle() {
    for named in [&[][..], &["start.coupler.angular_velocity=0.0"][..]] {
        for short in ["1e-6", "1e-7", "1e-8", "1e-9", "1e-10"] {
            let case = stretched(short, named);
            let far = format!("{:.12}", 0.27 - short.parse::<f64>().unwrap());
            let exact: Mechanism<F256> = told(assemble(&case));
            let rates = rates_of_triangle(&exact, &far);
            for (found, rate) in [exact.start().v[2], exact.start().v[5]].into_iter().zip(rates) {
                let off = ((found - rate) / rate).abs().to_f64();
                println!(
                    "{short} {named:?}: {} off {off:.1e} of {:.1e}",
                    found.to_f64(),
                    exact.start_accuracy()
                );
                assert!(off <= exact.start_accuracy() && off < 1e-50, "{short}: {off:e}");
            }
            match assemble::<f64>(&case) {
                Ok(doubles) => {
                    for (found, rate) in
                        [doubles.start().v[2], doubles.start().v[5]].into_iter().zip(rates)
                    {
                        let off = ((F256::from(found) - rate) / rate).abs().to_f64();
                        println!(
                            "   doubles {found} off {off:.1e} of {:.1e}",
                            doubles.start_accuracy()
                        );
                        assert!(off <= doubles.start_accuracy(), "{short}: {off:e}");
                    }
                }
                Err(error) => println!("   {error}"),
            }
        }
    }
}

#[test]
fn a_dead_centre_is_refused_in_every_arithmetic() {
    for name in ["a", "b", "c"] {
        // crank and coupler lie in one line with the follower
        let case = case(&format!("cases/four-bar-{name}.toml"), &["ground.points.B0=[0.33, 0.0]"]);
        for refused in [assemble::<f64>(&case).err(), assemble::<F256>(&case).err()] {
            let words = refused.expect("a dead centre").to_string();
            assert!(words.contains("dead centre"), "{words}");
        }
    }
}

/// A plate in bearings of the ground, all with clearance.
fn plate(ground: &str, plate: &str, start: &str, radial: &str) -> Case {
    let joint = |name: &str| {
        format!(
            "[joints.{name}]\nkind = \"revolute\"\nbetween = [\"ground.{name}\", \"plate.{name}\"]\n\
             [joints.{name}.clearance]\nbearing_radius = 0.2\nradial = {radial}\n\
             normal = {{ law = \"hertz\", stiffness = 1e9 }}\n"
        )
    };
    let joints: String =
        ["P", "Q"].into_iter().filter(|name| plate.contains(name)).map(joint).collect();
    let text = format!(
        "[ground]\npoints = {{ {ground} }}\n[bodies.plate]\nmass = 0.3\ninertia = 1e-3\n\
         points = {{ {plate} }}\n{joints}[start]\nplate = {{ {start} }}\n\
         [run]\nduration = 1e-3\nsample_interval = 1e-3\n"
    );
    case_of(&text, &[])
}

#[test]
fn where_journals_cannot_be_centred_their_eccentricities_are_least_in_every_arithmetic() {
    // three millimetres too long for its bearings, so that its middle is theirs
    let long = plate(
        "P = [0.1, 0.2], Q = [0.42, 0.44]",
        "P = [-0.2015, 0.01], Q = [0.2015, 0.01]",
        "angle = 0.5",
        "0.01",
    );
    // held beside its bearing, it points there
    let held =
        plate("P = [0.05, 0.02]", "P = [0.03, 0.0]", "x = 0.0, y = 0.0, fixed = true", "0.001");
    let cases = [&long, &held];
    let doubles: Vec<f64> =
        cases.iter().flat_map(|case| told(assemble::<f64>(case)).start().q.clone()).collect();
    let exact: Vec<F256> =
        cases.iter().flat_map(|case| told(assemble::<F256>(case)).start().q.clone()).collect();
    let number = |literal: &str| F256::parse(literal).unwrap();
    let origin = told(assemble::<F256>(&long)).model().origin();
    // tan of the angles is 3/4 and 2/5, and the middle of the plate's points lies off its centre
    let known = [
        (exact[0] + origin.x - (number("0.26") + number("0.006"))),
        (exact[1] + origin.y - (number("0.32") - number("0.008"))),
        {
            let (sin, cos) = exact[2].sin_cos();
            sin * number("4") - cos * number("3")
        },
        {
            let (sin, cos) = exact[5].sin_cos();
            sin * number("5") - cos * number("2")
        },
    ];
    for off in known {
        assert!(off.abs().to_f64() < 1e-68, "{:e}", off.to_f64());
    }
    for (double, exact) in doubles.iter().zip(&exact) {
        let off = (F256::from(*double) - *exact).to_f64();
        assert!(off.abs() < 4e-16, "{off:e}");
    }
}

#[test]
fn unnamed_rates_are_those_of_least_energy() {
    // the rod hangs in a journal that moves: it turns as its inertia about its mass centre tells
    let case = case("tests/cases/crank-on-crank.toml", &[]);
    let exact = told(assemble::<F256>(&case));
    let [x, y, turn] = [exact.start().v[0], exact.start().v[1], exact.start().v[2]];
    let number = |literal: &str| F256::parse(literal).unwrap();
    let (sin, cos) = exact.start().q[2].sin_cos();
    // the freedom is to turn about Q: ẋ and ẏ follow from θ̇ by the arm from Q to the mass centre
    let arm = [number("0.05") * cos, number("0.05") * sin];
    let slope = number("0.1") * (arm[0] * y - arm[1] * x) + number("6e-5") * turn;
    assert!(slope.abs().to_f64() < 1e-68, "{:e}", slope.to_f64());
}

/// A disc of 50 g in a bearing of 1 mm clearance, at rest at a place (m), under a load (m/s²).
fn resting(place: [&str; 2], load: [&str; 2], duration: f64, engine: &str) -> Case {
    let ([x, y], [gx, gy]) = (place, load);
    let text = format!(
        r#"
        [ground]
        points = {{ O = [0.0, 0.0] }}
        [bodies.disc]
        mass = 0.05
        inertia = 2e-6
        points = {{ C = [0.0, 0.0] }}
        [joints.O]
        kind = "revolute"
        between = ["ground.O", "disc.C"]
        [joints.O.clearance]
        bearing_radius = 0.01
        radial = 0.001
        normal = {{ law = "hertz", stiffness = 1e12 }}
        [loads.gravity]
        kind = "gravity"
        acceleration = [{gx}, {gy}]
        [start.disc]
        x = {x}
        y = {y}
        angle = 0.0
        velocity_x = 0.0
        velocity_y = 0.0
        angular_velocity = 0.0
        fixed = true
        [run]
        duration = {duration:?}
        sample_interval = 1e-4
        [solver]
        engine = "{engine}"
        absolute_tolerance = "scaled"
        "#
    );
    case_of(&text, &[])
}

/// c/√2 to the places that 71-digit floats have.
const DIAGONAL: &str =
    "0.000707106781186547524400844362104849039284835937688474036588339868995366239231053519425";
/// Places on the wall, and loads along it: down from the right, down from the left, sideways from
/// the top, along the wall at 45°, and with the least pull away from the wall.
fn along_the_wall() -> [([&'static str; 2], [&'static str; 2]); 5] {
    [
        (["0.001", "0.0"], ["0.0", "-9.81"]),
        (["-0.001", "0.0"], ["0.0", "-9.81"]),
        (["0.0", "0.001"], ["9.81", "0.0"]),
        ([DIAGONAL, DIAGONAL], ["6.937", "-6.937"]),
        (["0.001", "0.0"], ["-1e-15", "-9.81"]),
    ]
}

#[test]
fn a_disc_at_rest_on_the_wall_with_its_load_along_it_slides_as_a_pendulum_swings() {
    for engine in ["ida", "explicit"] {
        for (place, load) in along_the_wall() {
            let number = |literal: &str| literal.parse::<f64>().unwrap();
            let [gx, gy] = load.map(number);
            let g = gx.hypot(gy);
            // half way through its swing, K(sin 45°) √(c/g), it is where the load points
            let half = 1.854_074_677_301_371_9 * (1e-3 / g).sqrt();
            let end = (1.5 * half * 1e4).round() / 1e4;
            let kept = simulate(&resting(place, load, end, engine));
            let what = format!("{engine} {place:?} {load:?}");
            // an engine may see the least pull lift the disc at first, by nothing that counts
            let sliding = kept.contacts.last().unwrap();
            assert!(sliding.begin <= 1e-5 && sliding.end.is_nan(), "{what}: {:?}", kept.contacts);
            assert!(kept.contacts.len() <= 2, "{what}: {:?}", kept.contacts);
            assert_eq!(kept.contacts[0].begin, 0.0, "{what}");
            let [x, y] = place.map(number);
            for sample in &kept.samples {
                let clearance = &sample.clearances[0];
                assert!(clearance.in_contact, "{what}: {} s", sample.time);
                assert!(clearance.penetration.abs() < 1e-7, "{what}: {}", clearance.penetration);
                let disc = &sample.bodies[0];
                let fallen = gx * (disc.position[0] - x) + gy * (disc.position[1] - y);
                let square = disc.velocity[0].powi(2) + disc.velocity[1].powi(2);
                assert!(
                    (0.5 * square - fallen).abs() <= 1e-4 * g * 1e-3,
                    "{what}: {} s",
                    sample.time
                );
            }
            let near = kept
                .samples
                .iter()
                .min_by(|a, b| (a.time - half).abs().total_cmp(&(b.time - half).abs()));
            let sample = near.unwrap();
            let [ex, ey] = sample.clearances[0].offset;
            let angle = ((ex * gy - ey * gx) / (ex * gx + ey * gy)).atan().abs();
            let rate = (2.0 * g / 1e-3).sqrt();
            let exact = rate * (sample.time - half).abs();
            assert!((angle - exact).abs() < 2e-3, "{what}: {angle}, {exact}");
        }
    }
}

#[test]
fn a_disc_on_the_wall_that_is_pulled_inward_starts_in_flight() {
    for engine in ["ida", "explicit"] {
        for (place, load) in [
            (["0.001", "0.0"], ["-9.81", "0.0"]),
            (["0.0", "0.001"], ["0.0", "-1e-15"]),
            ([DIAGONAL, DIAGONAL], ["-6.9", "-6.9"]),
            ([DIAGONAL, DIAGONAL], ["-1e-15", "-1e-15"]),
            (["0.001", "0.0"], ["0.0", "0.0"]),
        ] {
            let kept: Kept = simulate(&resting(place, load, 2e-3, engine));
            let what = format!("{engine} {place:?} {load:?}");
            assert!(kept.contacts.is_empty(), "{what}: {:?}", kept.contacts);
            assert_eq!(kept.largest(|sample| sample.clearances[0].normal_force), 0.0, "{what}");
            for sample in &kept.samples {
                let t = sample.time;
                for c in 0..2 {
                    let [x, g] = [place[c], load[c]].map(|literal| literal.parse::<f64>().unwrap());
                    let off = (sample.bodies[0].position[c] - (x + 0.5 * g * t * t)).abs();
                    assert!(off <= 1e-14, "{what}: {off:e} at {t} s");
                }
            }
        }
    }
}

/// Digits beyond double precision, for a moment.
#[test]
fn in_71_digits_too_the_disc_slides_along_the_wall() {
    for (place, load) in along_the_wall() {
        let mut case = resting(place, load, 1e-4, "explicit");
        case.plan.solver.precision = freeplay::case::Precision::Octuple;
        case.plan.solver.reference_tolerance = 1e-20;
        let kept = simulate(&case);
        let what = format!("{place:?} {load:?}");
        let sliding = kept.contacts.last().unwrap();
        assert!(sliding.begin <= 1e-9 && sliding.end.is_nan(), "{what}: {:?}", kept.contacts);
        let depth = kept.last().clearances[0].penetration;
        assert!(depth > 0.0 && depth < 1e-9, "{what}: {depth:e}");
    }
}

#[test]
fn first_modes_are_the_same_in_every_arithmetic() {
    for (place, load) in along_the_wall().into_iter().take(4) {
        let case = resting(place, load, 1e-3, "explicit");
        let touches = |modes: bool| assert!(modes, "{place:?} {load:?}");
        touches(matches!(told(assemble::<f64>(&case)).modes()[0], Mode::Contact(_)));
        touches(matches!(told(assemble::<F256>(&case)).modes()[0], Mode::Contact(_)));
    }
    // in 71 digits the least pull inward is seen
    let (place, load) = along_the_wall()[4];
    let case = resting(place, load, 1e-3, "explicit");
    assert!(matches!(told(assemble::<f64>(&case)).modes()[0], Mode::Contact(_)));
    assert_eq!(told(assemble::<F256>(&case)).modes()[0], Mode::Flight);
}

/// Numbers that look like chance, in [0, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[test]
fn from_any_rough_pose_doubles_start_as_accurately_as_they_say() {
    let mut numbers = Numbers(15);
    let (mut starts, mut worst) = (0, 0.0_f64);
    for _ in 0..40 {
        for (name, bodies) in [
            ("tests/cases/chain", &["one", "two", "three", "four", "five"][..]),
            ("tests/cases/six-bar", &["coupler", "rocker", "link", "lever"]),
            ("tests/cases/crank-on-crank", &["rod"]),
            ("cases/four-bar-a", &["coupler", "follower"]),
        ] {
            let mut set: Vec<String> = Vec::new();
            for body in bodies {
                set.push(format!("start.{body}.angle={:.3}", 6.0 * numbers.next() - 3.0));
                if numbers.next() < 0.5 {
                    let rate = 100.0 * numbers.next() - 50.0;
                    set.push(format!("start.{body}.angular_velocity={rate:.3}"));
                }
            }
            let set: Vec<&str> = set.iter().map(String::as_str).collect();
            let case = case(&format!("{name}.toml"), &set);
            let (Ok(doubles), Ok(exact)) = (assemble::<f64>(&case), assemble::<F256>(&case)) else {
                let refused = (assemble::<f64>(&case).err(), assemble::<F256>(&case).err());
                println!("{set:?}: {refused:?}");
                assert!(refused.0.is_some() && refused.1.is_some(), "{set:?}: {refused:?}");
                continue;
            };
            let digits = digits_of_start(&case);
            let (said, more) = (doubles.start_accuracy(), exact.start_accuracy());
            println!("{name}: {digits:.2} {:.2} {more:.1e}", -said.log10());
            worst = worst.max(10f64.powf(-digits) / said);
            starts += 1;
            assert!(more < 1e-50, "{set:?}: {more:e}");
        }
    }
    println!("{starts} starts, {worst:.2} of what was said");
    assert!(starts > 100 && worst < 1.0, "{starts}, {worst}");
}

/// Runs `freeplay` in a folder; its exit code and what it said.
fn freeplay(folder: &std::path::Path, arguments: &[&str]) -> (i32, String) {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_freeplay"));
    let output = command.args(arguments).current_dir(folder).output().unwrap();
    let said = [output.stdout, output.stderr].map(|said| String::from_utf8(said).unwrap()).concat();
    (output.status.code().unwrap_or(-1), said)
}

/// Runs a case of the project into a file of a folder, with keys set.
fn run_into(folder: &std::path::Path, case: &str, name: &str, set: &[&str]) -> ResultFile {
    let copy = folder.join(case.rsplit('/').next().unwrap());
    if !copy.exists() {
        std::fs::copy(root().join(case), &copy).unwrap();
    }
    let copy = copy.to_str().unwrap().to_owned();
    let mut arguments = vec!["run", &copy, "--quiet", "--no-tangent", "-o", name];
    arguments.extend(set.iter().flat_map(|set| ["--set", set]));
    let (code, said) = freeplay(folder, &arguments);
    assert_eq!(code, 0, "{said}");
    ResultFile::open(&folder.join(name)).unwrap()
}

/// Everything that tells where a sample stands: positions and velocities, by their bits.
fn state(sample: &Observation) -> Vec<u64> {
    let bodies = sample.bodies.iter().flat_map(|body| {
        let [[x, y], [u, v]] = [body.position, body.velocity];
        [x, y, body.angle, u, v, body.angular_velocity]
    });
    bodies.map(f64::to_bits).collect()
}

/// The largest distance of two samples, over angles, positions and rates of the sizes given.
fn distance(one: &Observation, other: &Observation, rate: f64) -> f64 {
    let pairs = one.bodies.iter().zip(&other.bodies);
    let off = pairs.flat_map(|(a, b)| {
        [
            (a.angle - b.angle).abs(),
            (a.position[0] - b.position[0]).abs(),
            (a.position[1] - b.position[1]).abs(),
            (a.angular_velocity - b.angular_velocity).abs() / rate,
            (a.velocity[0] - b.velocity[0]).abs() / rate,
            (a.velocity[1] - b.velocity[1]).abs() / rate,
        ]
    });
    off.fold(0.0, f64::max)
}

const BOTH: [&str; 2] = ["solver.engine=explicit", "solver.engine=ida"];

/// Samples at multiples of 1/8192 s, which doubles have exactly: so that no time is rounded.
const EIGHTS: &str = "run.sample_interval=1.220703125e-4";

#[test]
fn a_run_that_starts_where_another_stood_goes_on_as_it_did() {
    for engine in BOTH {
        for case in ["four-bar-a", "four-bar-b", "four-bar-c", "slider-crank"] {
            let folder = tempfile::tempdir().unwrap();
            let (folder, path) = (folder.path(), format!("cases/{case}.toml"));
            let tight = "solver.absolute_tolerance=scaled";
            let set = [engine, tight, EIGHTS, "run.sampling=uniform", "run.duration=3.90625e-3"];
            let whole = run_into(folder, &path, "whole.h5", &set);
            let rows = whole.length(Dimension::Time);
            let samples = whole.observations(0..rows).unwrap();
            // the first sample, one in flight, one in contact, and one before the end
            let touching = |sample: &&Observation| sample.clearances.iter().any(|c| c.in_contact);
            let in_contact = samples.iter().position(|sample| touching(&sample)).unwrap();
            let flying = samples[4..].iter().position(|sample| !touching(&sample)).map(|k| k + 4);
            for row in [0, flying.unwrap_or(1), in_contact, rows - 3] {
                let at = samples[row].time;
                let [from, at_key] = ["start.from=whole.h5".to_owned(), format!("start.at={at:?}")];
                let left = format!("run.duration={:?}", 3.90625e-3 - at);
                let set = [engine, tight, EIGHTS, "run.sampling=uniform", &from, &at_key, &left];
                let name = format!("from-{row}.h5");
                let rest = run_into(folder, &path, &name, &set);
                let rest = (rest.observations(0..rest.length(Dimension::Time)).unwrap(), rest);
                let ((told, rest), what) = (rest, format!("{case} with {engine} from {at} s"));
                assert_eq!(told.len(), rows - row, "{what}");
                assert_eq!(state(&told[0]), state(&samples[row]), "{what}");
                for (k, clearance) in samples[row].clearances.iter().enumerate() {
                    assert_eq!(told[0].clearances[k].in_contact, clearance.in_contact, "{what}");
                    let last = |file: &ResultFile, time: f64| {
                        let contacts = file.contacts().unwrap().into_iter();
                        let mut open = contacts.filter(|c| c.clearance == k && c.begin <= time);
                        open.next_back().map(|contact| contact.impact_rate.to_bits())
                    };
                    if clearance.in_contact {
                        assert_eq!(last(&rest, 0.0), last(&whole, at), "{what}");
                    }
                }
                // doubles lose up to seven digits a revolution of 12 ms there
                for (ours, theirs) in told.iter().zip(&samples[row..]) {
                    let off = distance(ours, theirs, 500.0);
                    assert!(off < 1e-7, "{what}: off by {off:e} at {} s", ours.time);
                }
            }
        }
    }
}

#[test]
fn what_a_start_was_taken_from_stands_in_the_result_which_needs_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let set = [EIGHTS, "run.sampling=uniform", "run.duration=1.220703125e-3"];
    run_into(folder, "cases/four-bar-b.toml", "one.h5", &set);
    let from = |name: &'static str| [set[0], set[1], set[2], name];
    let two = run_into(folder, "cases/four-bar-b.toml", "two.h5", &from("start.from=one.h5"));
    let text = two.text("case_toml").unwrap();
    assert!(!text.contains("one.h5\"") && text.contains("clock = 0.001220703125"), "{text}");
    let elsewhere = tempfile::tempdir().unwrap();
    std::fs::write(elsewhere.path().join("again.toml"), text).unwrap();
    let (code, said) = freeplay(
        elsewhere.path(),
        &["run", "again.toml", "-o", "again.h5", "--no-tangent", "--quiet"],
    );
    assert_eq!(code, 0, "{said}");
    let again = ResultFile::open(&elsewhere.path().join("again.h5")).unwrap();
    assert_eq!(again.text("case_toml").unwrap(), text);
    for column in ["angle.follower", "velocity_x.coupler", "normal_force.A", "drive_torque.crank"] {
        assert_eq!(again.column(column).unwrap(), two.column(column).unwrap(), "{column}");
    }
    // and that of a run from there goes on with the time of the first
    let three = run_into(folder, "cases/four-bar-b.toml", "three.h5", &from("start.from=two.h5"));
    assert!(three.text("case_toml").unwrap().contains("clock = 0.00244140625"));
    let turned = three.column("angle.crank").unwrap()[0];
    assert_eq!(turned, two.column("angle.crank").unwrap().last().copied().unwrap());
    // a certificate is of the same start
    let (code, said) = freeplay(
        folder,
        &[
            "certify",
            "four-bar-b.toml",
            "--until",
            "2e-4",
            "--quiet",
            "--set",
            "start.from=one.h5",
            "--set",
            EIGHTS,
        ],
    );
    assert!(code == 0 && said.contains("digits"), "{said}");
    let taken = Changes { set: vec!["start.from=one.h5".parse().unwrap()], ideal: false };
    let taken = told(Case::read(&folder.join("four-bar-b.toml"), &taken));
    // a journal's offset is that of positions with the rounding of doubles, 3e-17 m each, over 1 mm; a start
    // that is chosen by its clearances has two digits more
    assert!(digits_of_start(&taken) > 13.0, "{}", digits_of_start(&taken));
}

#[test]
fn a_case_that_starts_from_another_run_can_be_set_to_another_time_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let set = [EIGHTS, "run.sampling=uniform", "run.duration=1.220703125e-3"];
    let one = run_into(folder, "cases/four-bar-b.toml", "one.h5", &set);
    let at = format!("start.at={:?}", one.times().unwrap()[3]);
    let text = std::fs::read_to_string(root().join("cases/four-bar-b.toml")).unwrap();
    let path = folder.join("again.toml");
    std::fs::write(&path, text.replace("[start]", "[start]\nfrom = \"one.h5\" #")).unwrap();
    let start = |set: &[&str]| {
        let set = set.iter().map(|change| change.parse().unwrap()).collect();
        let case = told(Case::read(&path, &Changes { set, ideal: false }));
        told(Simulation::new(&case)).mechanism().start().clone()
    };
    let (last, third) = (start(&[]), start(&[&at]));
    assert_eq!(third, start(&["start.from=one.h5", &at]));
    assert_ne!(third.q, last.q);
    let [time, x] = ["time", "position_x.coupler"].map(|column| one.column(column).unwrap());
    assert_eq!(time[3], one.times().unwrap()[3]);
    let origin = x[x.len() - 1] - last.q[0];
    assert!((third.q[0] + origin - x[3]).abs() < 1e-15);
}

#[test]
fn courses_go_on_where_they_stood() {
    let text = std::fs::read_to_string(root().join("cases/slider-crank-ideal.toml")).unwrap();
    let speed = "joint     = \"O\"\nspeed_rpm = 5000.0\n";
    assert!(text.contains(speed));
    let ramp = "joint = \"O\"\nkind = \"ramp\"\nspeed_rpm = 5000.0\ntime = 0.0078125\n";
    let swing = "joint = \"O\"\nkind = \"harmonic\"\namplitude = 0.3\nangular_frequency = 900.0\n";
    let times: Vec<f64> = (0..33).map(|k| f64::from(k) / 2048.0).collect();
    let values: Vec<f64> = times.iter().map(|t| 3e4 * t * t).collect();
    let table =
        format!("joint = \"O\"\nkind = \"table\"\ntimes = {times:?}\nvalues = {values:?}\n");
    for drive in [speed, ramp, swing, &table] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        std::fs::write(folder.join("case.toml"), text.replace(speed, drive)).unwrap();
        let run = |name: &str, set: &[&str]| run_into(folder, "case.toml", name, set);
        let whole = run("whole.h5", &[EIGHTS, "run.duration=0.0146484375"]);
        let whole = whole.observations(0..whole.length(Dimension::Time)).unwrap();
        let set =
            [EIGHTS, "start.from=whole.h5", "start.at=0.0048828125", "run.duration=9.765625e-3"];
        let rest = run("rest.h5", &set);
        let rest = rest.observations(0..rest.length(Dimension::Time)).unwrap();
        let begin = whole.iter().position(|sample| sample.time == 0.0048828125).unwrap();
        assert_eq!(rest.len(), whole.len() - begin);
        for (ours, theirs) in rest.iter().zip(&whole[begin..]) {
            let off = distance(ours, theirs, 500.0);
            assert!(off < 1e-13, "{drive} {off:e} at {}", ours.time);
            let torque = (ours.drive_torques[0] - theirs.drive_torques[0]).abs();
            assert!(torque < 1e-9, "{drive} {torque:e} N m at {}", ours.time);
        }
    }
}

#[test]
fn what_frictions_and_loads_remember_goes_on_as_it_was() {
    let laws = [
        "{law=\"dahl\", coefficient=0.1, stiffness=100.0}",
        "{law=\"lugre\", coefficient=0.08, static=0.12, stribeck=0.05, stiffness=100.0, damping=0.1, \
         viscous=0.0}",
        "{law=\"elasto-plastic\", coefficient=0.08, static=0.12, stribeck=0.05, stiffness=100.0, \
         damping=0.1, viscous=0.0, elastic_share=0.6}",
        "{law=\"gonthier\", coefficient=0.08, static=0.12, stribeck=0.05, stiffness=100.0, damping=0.1, \
         viscous=0.0, dwell_time=1e-3, transition=0.01}",
    ];
    let samples = |file: &ResultFile| file.observations(0..file.length(Dimension::Time)).unwrap();
    for law in laws {
        for engine in ["explicit", "ida"] {
            let folder = tempfile::tempdir().unwrap();
            let folder = folder.path();
            let (engine, law) =
                (format!("solver.engine={engine}"), format!("joints.A.clearance.friction={law}"));
            let run = |name: &str, set: &[&str]| {
                let set = [&["run.sample_interval=3.0517578125e-5", &law, &engine], set].concat();
                run_into(folder, "cases/four-bar-a.toml", name, &set)
            };
            let whole = run("whole.h5", &["run.duration=0.03125"]);
            let whole = samples(&whole);
            // where bristles are bent but not all that they can be, and the contact goes on for a while
            let bent = |k: &usize| {
                let lasts = whole[*k..].iter().take(3).all(|at| at.clearances[0].in_contact);
                let contact = &whole[*k].clearances[0];
                let slides = contact.tangential_force.abs() > 0.05 * contact.normal_force;
                lasts
                    && !slides
                    && contact.normal_force > 10.0
                    && whole[*k].memories[0].abs() > 1e-7
            };
            let begin = (1..whole.len() - 3).find(bent).unwrap();
            let at = format!("start.at={:?}", whole[begin].time);
            let left = format!("run.duration={:?}", whole[begin + 2].time - whole[begin].time);
            let rest = run("rest.h5", &["start.from=whole.h5", &at, &left]);
            assert_eq!(rest.memories()[0], "A.friction");
            let rest = samples(&rest);
            assert_eq!(rest[0].memories, whole[begin].memories);
            for (ours, theirs) in rest.iter().zip(&whole[begin..]) {
                let [ours, theirs] = [ours, theirs].map(|at| at.clearances[0].tangential_force);
                assert!((ours - theirs).abs() <= 1e-6 * theirs.abs(), "{law} {ours} {theirs}");
            }
            // what it remembers matters
            let text = ResultFile::open(&folder.join("rest.h5")).unwrap();
            std::fs::write(folder.join("rest.toml"), text.text("case_toml").unwrap()).unwrap();
            let straight = run_into(folder, "rest.toml", "straight.h5", &["start.memory=[]"]);
            let [ours, theirs] =
                [&samples(&straight)[0], &whole[begin]].map(|at| at.clearances[0].tangential_force);
            assert!((ours - theirs).abs() > 1e-3 * theirs.abs(), "{law} {ours} {theirs}");
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let set =
        ["run.duration=0.01953125", "run.sample_interval=1.220703125e-3", "run.sampling=uniform"];
    let whole = samples(&run_into(folder, "cases/speed-controller.toml", "whole.h5", &set));
    let set = [
        "start.from=whole.h5",
        "start.at=9.765625e-3",
        "run.duration=9.765625e-3",
        "run.sample_interval=1.220703125e-3",
        "run.sampling=uniform",
    ];
    let rest = run_into(folder, "cases/speed-controller.toml", "rest.h5", &set);
    assert_eq!(rest.memories(), ["servo.memory"]);
    let rest = samples(&rest);
    let begin = whole.iter().position(|sample| sample.time == 9.765625e-3).unwrap();
    assert!(whole[begin].memories[0] > 0.0 && rest[0].memories == whole[begin].memories);
    for (ours, theirs) in rest.iter().zip(&whole[begin..]) {
        let off = (ours.memories[0] - theirs.memories[0]).abs();
        assert!(off < 1e-9 * theirs.memories[0], "{off:e} at {}", ours.time);
    }
}

#[test]
fn what_no_run_can_start_from_is_told_with_its_key() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let set = [EIGHTS, "run.sampling=uniform", "run.duration=1.220703125e-3"];
    run_into(folder, "cases/four-bar-b.toml", "one.h5", &set);
    run_into(folder, "cases/four-bar-a.toml", "other.h5", &set);
    run_into(folder, "cases/pendulum.toml", "pendulum.h5", &[]);
    let bristles = "joints.A.clearance.friction={law=\"dahl\", coefficient=0.1, stiffness=1e4}";
    run_into(folder, "cases/four-bar-a.toml", "plain.h5", &[EIGHTS, "run.duration=6.103515625e-3"]);
    let plain = ResultFile::open(&folder.join("plain.h5")).unwrap();
    let samples = plain.observations(0..plain.length(Dimension::Time)).unwrap();
    let touching = samples.iter().find(|s| s.clearances[0].in_contact).unwrap().time;
    std::fs::write(folder.join("no.h5"), "nothing").unwrap();
    let at = format!("start.at={touching:?}");
    for (case, set, words) in [
        ("four-bar-b", vec!["start.from=none.h5"], vec!["start.from", "none.h5"]),
        ("four-bar-b", vec!["start.from=no.h5"], vec!["start.from", "HDF5"]),
        ("four-bar-b", vec!["start.from=pendulum.h5"], vec!["another mechanism", "no body"]),
        ("four-bar-b", vec!["start.from=other.h5"], vec!["no joint with clearance \"B\""]),
        ("four-bar-b", vec!["start.from=7"], vec!["start.from", "must be a string"]),
        ("four-bar-b", vec!["start.at=0.1"], vec!["start.at", "`from`"]),
        (
            "four-bar-b",
            vec!["start.from=one.h5", "start.at=1e-3"],
            vec!["start.at", "the nearest is 0.0009765625"],
        ),
        (
            "four-bar-b",
            vec!["start.from=one.h5", "start.crank={angle=1.0, fixed=true}"],
            vec!["start.crank", "is given too"],
        ),
        ("four-bar-b", vec!["start.from=one.h5", "start.closed=true"], vec!["start.closed"]),
        (
            "four-bar-b",
            vec!["start.from=one.h5", "drives.crank.speed_rpm=4000.0"],
            vec!["start.crank.angle", "the drives have it"],
        ),
        (
            "four-bar-b",
            vec!["start.from=one.h5", "ground.points.A0=[0.0, 0.01]"],
            vec!["start.crank"],
        ),
        (
            "four-bar-a",
            vec!["start.from=plain.h5", bristles, &at],
            vec!["start.from", "does not hold \"A.friction\""],
        ),
        (
            "four-bar-a",
            vec![bristles, "start.memory=[{of=\"B.friction\", value=0.0}]"],
            vec!["start.memory.1.of", "none of: A.friction"],
        ),
        (
            "four-bar-a",
            vec![bristles, "start.memory=[{of=\"A.friction\", value=nan}]"],
            vec!["start.memory.1.value", "finite"],
        ),
        (
            "four-bar-a",
            vec![bristles, "start.memory=[{of=\"A.friction\", value=1e-6}]"],
            vec!["start.memory", "\"A.friction\", but nothing touches there"],
        ),
        (
            "four-bar-a",
            vec!["start.memory=[{of=\"A.friction\", value=0.0}]"],
            vec!["start.memory.1.of", "nothing here remembers"],
        ),
    ] {
        let path = format!("{case}.toml");
        let mut arguments = vec!["run", &path, "-o", "new.h5", "--quiet"];
        arguments.extend(set.iter().flat_map(|set| ["--set", set]));
        let (code, said) = freeplay(folder, &arguments);
        assert_eq!(code, 2, "{set:?}: {said}");
        assert!(words.iter().all(|word| said.contains(word)), "{set:?}: {said}");
    }
    // a flight remembers nothing, whatever the friction
    let flight = [
        "run",
        "four-bar-a.toml",
        "-o",
        "new.h5",
        "--quiet",
        "--no-tangent",
        "--set",
        "start.from=plain.h5",
        "--set",
        "start.at=0",
        "--set",
        bristles,
        "--set",
        "run.duration=1e-4",
    ];
    let (code, said) = freeplay(folder, &flight);
    assert_eq!(code, 0, "{said}");
    // what is read is not written over
    let onto = [
        "run",
        "four-bar-b.toml",
        "-o",
        "one.h5",
        "--force",
        "--quiet",
        "--set",
        "start.from=one.h5",
    ];
    let (code, said) = freeplay(folder, &onto);
    assert!(code == 3 && said.contains("is an input"), "{code} {said}");
    for set in [
        "start.contact=[{joint=\"B0\", impact_rate=1.0}]",
        "start.contact=[{joint=\"Q\", impact_rate=1.0}]",
        "start.contact=[{joint=\"A\", impact_rate=1.0}]",
    ] {
        let (code, said) = freeplay(folder, &["check", "four-bar-b.toml", "--set", set]);
        assert!(code == 2 && said.contains("start.contact"), "{set}: {said}");
    }
}
