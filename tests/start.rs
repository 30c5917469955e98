//! Where runs start. Known in advance: the start is the same in every arithmetic, to the last
//! places of each; rates near a dead centre from the triangle of the links; a disc that rests on
//! the wall of its bearing slides along it as a pendulum swings, or leaves it, as its load tells.

mod simulated;

use freeplay::case::Case;
use freeplay::clearance::Mode;
use freeplay::digits::{Scales, Sizes};
use freeplay::mechanism::Mechanism;
use freeplay::scalar::{F256, Scalar};
use freeplay::simulate::assemble;
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
