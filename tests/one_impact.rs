//! A mass against a wall, which is a journal that flies through the centre of its bearing to and
//! fro. Known in advance, for each law F = F_e(δ) (1 + a δ̇/v0): the rebound ratio e, root of
//! a (1 + e) = ln((1 + a)/(1 − a e)), and from the first integral of the impact its greatest depth,
//! its greatest force and what it dissipates; of the cylinder laws from the formulas as they are
//! printed, which tell depths by forces.

mod simulated;

use freeplay::contact::Impact;
use freeplay::model::Model;
use freeplay::run::Contact;
use simulated::{Kept, case_of, simulate};

const MASS: f64 = 0.05;
/// The paper's K (N/m^1.5).
const STIFFNESS: f64 = 1.043_715_536_510_028_3e10;
const TOLERANCE: f64 = 1e-12;

/// A law, its restitution, its damping weight a, and its rebound ratio where it is known.
type Law = (&'static str, f64, f64, Option<f64>);

const LAWS: [Law; 15] = [
    ("hertz", 1.0, 0.0, Some(1.0)),
    ("lankarani-nikravesh", 0.9, 0.75 * 0.19, Some(0.913_176_677_805_581)),
    ("lankarani-nikravesh", 0.5, 0.75 * 0.75, Some(0.725_241_114_010_197)),
    ("lankarani-nikravesh", 0.7, 0.75 * 0.51, None),
    ("lankarani-nikravesh", 0.99, 0.75 * 0.0199, None),
    ("hunt-crossley", 0.8, 1.5 * 0.2, None),
    ("herbert-mcwhannell", 0.8, 1.2 / 3.36, None),
    ("lee-wang", 0.8, 0.75 * 0.2, None),
    ("gonthier", 0.8, 0.36 / 0.8, None),
    ("zhiying-qishao", 0.8, 0.27 * 1.491_824_697_641_270_3, None),
    ("flores", 0.8, 1.6 * 0.2 / 0.8, None),
    ("flores", 0.9, 8.0 * 0.1 / 4.5, None),
    ("hu-guo", 0.75, 1.5 * 0.25 / 0.75, None),
    ("carvalho-martins", 0.8, 0.3 * 10.2 / 8.2, None),
    ("exact", 0.8, 0.37314620336505366, Some(0.8)),
];

/// To and fro at a speed (m/s) with a law, until some impacts have been.
fn to_and_fro(law: &Law, exponent: f64, speed: f64) -> Kept {
    let (name, restitution, _, _) = law;
    let restitution = match *name {
        "hertz" => String::new(),
        _ => format!("restitution = {restitution:?}, "),
    };
    to_and_fro_with(name, &restitution, exponent, speed)
}

fn to_and_fro_with(name: &str, restitution: &str, exponent: f64, speed: f64) -> Kept {
    let normal = format!(
        r#"law = "{name}", {restitution}stiffness = {STIFFNESS:?}, exponent = {exponent:?}"#
    );
    simulate(&case_of(&flight(&normal, speed), &[]))
}

/// The case of a journal that flies to and fro at a speed (m/s), with a table of its normal force.
fn flight(normal: &str, speed: f64) -> String {
    let duration = 0.025 / speed;
    format!(
        r#"
        [ground]
        points = {{ O = [0.1, -0.2] }}
        [bodies.journal]
        mass = {MASS}
        inertia = 2e-6
        points = {{ C = [0.0, 0.0] }}
        [joints.O]
        kind = "revolute"
        between = ["ground.O", "journal.C"]
        [joints.O.clearance]
        bearing_radius = 0.01
        radial = 0.001
        normal = {{ {normal} }}
        [start.journal]
        x = 0.1
        y = -0.2
        angle = 0.0
        velocity_x = {speed:?}
        velocity_y = 0.0
        angular_velocity = 3.0
        fixed = true
        [run]
        duration = {duration:?}
        sample_interval = {duration:?}
        [solver]
        absolute_tolerance = "scaled"
        "#
    )
}

/// Root e of a (1 + e) = ln((1 + a)/(1 − a e)) beside 1.
fn rebound_ratio(a: f64) -> f64 {
    if a == 0.0 {
        return 1.0;
    }
    let off = |e: f64| a * (1.0 + e) - (a.ln_1p() - (-a * e).ln_1p());
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if off(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}

/// Depth (m) at which the rate is u times that of the impact: the first integral.
fn depth(a: f64, n: f64, speed: f64, u: f64) -> f64 {
    let integral = match a {
        0.0 => 0.5 * (1.0 - u * u),
        _ => (1.0 - u) / a - (a.ln_1p() - (a * u).ln_1p()) / (a * a),
    };
    ((n + 1.0) * MASS * speed * speed / STIFFNESS * integral).powf(1.0 / (n + 1.0))
}

/// Greatest force (N) of an impact, by golden sections over the rate.
fn greatest_force(a: f64, n: f64, speed: f64) -> f64 {
    let force = |u: f64| STIFFNESS * depth(a, n, speed, u).powf(n) * (1.0 + a * u);
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut left, mut right) = (0.0, 1.0);
    while right - left > 1e-9 {
        let width = golden * (right - left);
        let (low, high) = (right - width, left + width);
        if force(low) < force(high) { left = low } else { right = high }
    }
    force(0.5 * (left + right))
}

fn assert_near(what: &str, found: f64, exact: f64) {
    let allowed = 1e3 * TOLERANCE * exact;
    assert!((found - exact).abs() <= allowed, "{what}: {found:e}, exact {exact:e}");
}

#[test]
fn every_law_of_the_menu_is_here() {
    for (word, _) in freeplay::contact::Damping::ALL {
        assert!(LAWS.iter().any(|law| law.0 == *word), "{word}");
    }
    let viscous = viscous_laws();
    for kind in freeplay::contact::viscous::KINDS {
        assert!(viscous.iter().any(|law| law.0 == kind.word), "{}", kind.word);
    }
}

#[test]
fn each_rebound_has_the_ratio_of_its_law_whatever_the_speed_and_the_exponent() {
    for law in &LAWS {
        let (name, _, a, known) = *law;
        let exact = rebound_ratio(a);
        if let Some(known) = known {
            assert!((exact - known).abs() < 1e-13, "{name}: {exact}, known {known}");
        }
        for (exponent, speed) in [(1.5, 1.0), (1.5, 0.05), (1.5, 7.0), (1.2, 1.0), (2.0, 0.3)] {
            let kept = to_and_fro(law, exponent, speed);
            let rates: Vec<f64> = kept.contacts.iter().map(|contact| contact.impact_rate).collect();
            assert!(rates.len() >= 5, "{name}: {} impacts", rates.len());
            assert_near("the first impact", rates[0], speed);
            for pair in rates.windows(2) {
                assert_near(&format!("{name}, rebound"), pair[1] / pair[0], exact);
            }
        }
    }
}

#[test]
fn an_impact_rebounds_at_what_was_asked_for() {
    for (name, achieved) in [("lankarani-nikravesh", 0.9), ("flores", 0.4), ("lee-wang", 0.75)] {
        let asked = format!("achieved_restitution = {achieved:?}, ");
        let kept = to_and_fro_with(name, &asked, 1.5, 1.0);
        let rates: Vec<f64> = kept.contacts.iter().map(|contact| contact.impact_rate).collect();
        assert!(rates.len() >= 3, "{name}: {} impacts", rates.len());
        for pair in rates.windows(2) {
            assert_near(&format!("{name}, asked for"), pair[1] / pair[0], achieved);
        }
    }
}

/// The contacts of a run that have ended.
fn ended(kept: &Kept) -> impl Iterator<Item = &Contact> {
    kept.contacts.iter().filter(|contact| !contact.end.is_nan())
}

#[test]
fn each_impact_has_the_depth_force_and_dissipation_of_its_first_integral() {
    for law in &LAWS {
        let (name, _, a, _) = *law;
        for exponent in [1.5, 1.2, 2.0] {
            let kept = to_and_fro(law, exponent, 1.0);
            assert!(ended(&kept).count() >= 4, "{name}");
            for contact in ended(&kept) {
                let speed = contact.impact_rate;
                let deepest = depth(a, exponent, speed, 0.0);
                assert_near("depth", contact.peak_penetration, deepest);
                assert_near("force", contact.peak_force, greatest_force(a, exponent, speed));
                let energy = 0.5 * MASS * speed * speed;
                let lost = energy * (1.0 - rebound_ratio(a).powi(2));
                let off = (contact.dissipated - lost).abs();
                assert!(off <= 1e3 * TOLERANCE * energy, "{name}: {off:e} of {energy:e} J");
            }
        }
    }
}

#[test]
fn a_hertz_impact_lasts_as_long_and_goes_as_deep_as_hertz_found() {
    let kept = to_and_fro(&LAWS[0], 1.5, 1.0);
    for contact in ended(&kept) {
        assert_near("depth", contact.peak_penetration, 3.242_792_408_213_991_6e-5);
        assert_near("force", contact.peak_force, 1_927.351_249_549_232);
        let duration = 2.943_275_184_324_7 * contact.peak_penetration / contact.impact_rate;
        assert_near("duration", contact.end - contact.begin, duration);
        let half = 0.5 * duration;
        // at a maximum the time has half the digits that the value has
        assert!((contact.peak_time - contact.begin - half).abs() <= 1e-6 * half);
    }
}

#[test]
fn nothing_but_the_head_on_motion_changes() {
    let kept = to_and_fro(&LAWS[1], 1.5, 1.0);
    let journal = &kept.last().bodies[0];
    assert_eq!(journal.angular_velocity, 3.0);
    assert!((journal.position[1] + 0.2).abs() <= 1e-15 && journal.velocity[1].abs() <= 1e-12);
    let residual = kept.largest(|sample| sample.energy.residual);
    assert!(residual <= 1e3 * TOLERANCE * 0.5 * MASS, "{residual:e} J");
    // every flight is the width of the bearing at the speed of the last rebound
    for pair in kept.contacts.windows(2) {
        let flight = pair[1].begin - pair[0].end;
        assert_near("flight", flight, 2e-3 / pair[1].impact_rate);
    }
}

const ENGINES: [&str; 2] = ["solver.engine=\"ida\"", "solver.engine=\"explicit\""];

/// A cylinder law as it is printed: a depth (m) by the force (N), or a force by the depth.
enum Printed {
    Depth(fn(f64) -> f64),
    Force(fn(f64) -> f64),
}

/// c and L (m), and the modulus E* (Pa) of steel on steel, of the case.
const RADIAL: f64 = 0.001;
const LENGTH: f64 = 0.015;
const MODULUS: f64 = 207e9 / (2.0 * (1.0 - 0.3 * 0.3));

const CYLINDERS: [(&str, Printed); 6] = [
    ("johnson", Printed::Depth(|f| share(f) * ((4.0 * RADIAL / (share(f))).ln() - 1.0))),
    (
        "radzimovsky",
        Printed::Depth(|f| {
            let (bearing, journal) = (0.01, 0.01 - RADIAL);
            let half_width = (4.0 * share(f) * bearing * journal / RADIAL).sqrt();
            let ratio = |radius: f64| (4.0 * radius / (2.0 * half_width)).ln();
            share(f) * (2.0 / 3.0 + ratio(bearing) + ratio(journal))
        }),
    ),
    (
        "dubowsky-freudenstein",
        Printed::Depth(|f| {
            let curvature = RADIAL / (0.01 * (0.01 - RADIAL));
            share(f) * ((LENGTH * LENGTH * curvature / share(f)).ln() + 1.0)
        }),
    ),
    ("esdu-78035", Printed::Depth(|f| share(f) * ((4.0 * RADIAL / share(f)).ln() + 1.0))),
    (
        "liu",
        Printed::Force(|d| {
            0.5 * std::f64::consts::PI * MODULUS * LENGTH * d * (d / (2.0 * (RADIAL + d))).sqrt()
        }),
    ),
    (
        "pereira",
        Printed::Force(|d| {
            // mm, N, MPa
            let (c, length, modulus) = (1e3 * RADIAL, 1e3 * LENGTH, 1e-6 * MODULUS);
            let exponent = (0.0151 * c + 1.151) * c.powf(-0.005);
            (0.965 * c + 0.0965) * length * modulus / c * (1e3 * d).powf(exponent)
        }),
    ),
];

/// F σ/L = F/(π E* L) (m).
fn share(force: f64) -> f64 {
    force / (std::f64::consts::PI * MODULUS * LENGTH)
}

/// ∫₀^end f, by tanh–sinh quadrature.
fn area(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    let step = 0.05;
    let term = |k: i32| {
        let s = f64::from(k) * step;
        let lean = std::f64::consts::FRAC_PI_2 * s.sinh();
        let weight = std::f64::consts::FRAC_PI_2 * s.cosh() / lean.cosh().powi(2);
        let x = end / (1.0 + (-2.0 * lean).exp());
        if weight > 1e-300 && x > 0.0 { weight * f(x) } else { 0.0 }
    };
    0.5 * end * step * (-80..=80).map(term).sum::<f64>()
}

/// The depth (m) at which a law as printed has stored an energy (J).
fn printed_depth(law: &Printed, energy: f64) -> f64 {
    let at = |p: f64| match law {
        // ∫F dδ = F δ − ∫δ dF
        Printed::Depth(depth) => (p * depth(p) - area(depth, p), depth(p)),
        Printed::Force(force) => (area(force, p), p),
    };
    let (mut low, mut high) = match law {
        Printed::Depth(_) => (0.0, 1e5),
        Printed::Force(_) => (0.0, 5e-4),
    };
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if at(middle).0 < energy { low = middle } else { high = middle }
    }
    at(low).1
}

#[test]
fn cylinder_laws_rebound_and_give_way_as_their_formulas_say_on_both_engines() {
    let known: Vec<&str> = CYLINDERS.iter().map(|(word, _)| *word).collect();
    let all = freeplay::contact::elastic::KINDS.iter().map(|kind| kind.word);
    assert_eq!(all.filter(|word| *word != "power").collect::<Vec<_>>(), known);
    let (damping, a) = ("law = \"flores\", restitution = 0.8", 0.4);
    for (word, printed) in &CYLINDERS {
        let normal = format!(
            "{damping}, elastic = \"{word}\", young = 207e9, poisson = 0.3, length = {LENGTH:?}"
        );
        for engine in ENGINES {
            let case = case_of(&flight(&normal, 1.0), &[engine]);
            let law = Model::<f64>::new(&case.description).unwrap().clearances()[0].normal;
            let kept = simulate(&case);
            let what = format!("{word}, {engine}");
            let rates: Vec<f64> = kept.contacts.iter().map(|contact| contact.impact_rate).collect();
            for pair in rates.windows(2) {
                assert_near(&format!("{what}, rebound"), pair[1] / pair[0], rebound_ratio(a));
            }
            assert!(ended(&kept).count() >= 4, "{what}");
            for contact in ended(&kept) {
                let impact = Impact::of(&law, MASS, contact.impact_rate);
                let fallen = 1.0 / a - a.ln_1p() / (a * a);
                let energy = MASS * contact.impact_rate * contact.impact_rate * fallen;
                let deepest = printed_depth(printed, energy);
                assert_near(&format!("{what}, depth"), contact.peak_penetration, deepest);
                assert_near(&format!("{what}, told depth"), impact.depth, deepest);
                assert_near(&format!("{what}, force"), contact.peak_force, impact.force);
                let duration = contact.end - contact.begin;
                assert_near(&format!("{what}, duration"), duration, impact.duration);
                let lost =
                    0.5 * MASS * contact.impact_rate.powi(2) * (1.0 - rebound_ratio(a).powi(2));
                assert_near(&format!("{what}, loss"), contact.dissipated, lost);
            }
            let residual = kept.largest(|sample| sample.energy.residual);
            assert!(residual <= 1e3 * TOLERANCE * 0.5 * MASS, "{what}: {residual:e} J");
        }
    }
}

#[test]
fn a_journal_deeper_than_its_elastic_law_goes_stops_the_run() {
    let normal =
        "law = \"hertz\", elastic = \"johnson\", young = 1e6, poisson = 0.3, length = 0.015";
    let case = case_of(&flight(normal, 7.0), &[]);
    let mut kept = freeplay::run::Trajectory::default();
    let mut go_on = |_: &freeplay::run::Progress| std::ops::ControlFlow::Continue(());
    let simulation = freeplay::simulate::Simulation::new(&case).unwrap();
    let error = simulation.run(&mut kept, &mut go_on).1.unwrap_err();
    let mut words = error.to_string();
    let mut cause = std::error::Error::source(&error);
    while let Some(error) = cause {
        words = format!("{words}: {error}");
        cause = error.source();
    }
    // 4 c/e²
    let told = "beyond 5.4134e-4 m, where the formula of its elastic part ends";
    assert!(words.contains(told), "{words}");
}

/// ζ that an impact with a spring and a damper rebounds at e with, where it ends at δ = 0.
fn damping_ratio(e: f64) -> f64 {
    -e.ln() / (e.ln().powi(2) + std::f64::consts::PI.powi(2)).sqrt()
}

/// What it rebounds at where the contact ends with its force: Schwager and Pöschel, 2007.
fn rebound_without_tension(ratio: f64) -> f64 {
    let left = (1.0 - ratio * ratio).sqrt();
    let turned = std::f64::consts::PI - (2.0 * ratio * left).atan2(1.0 - 2.0 * ratio * ratio);
    (-ratio / left * turned).exp()
}

/// A law of viscous damping: its table, and what its impacts rebound at with tension and without,
/// where that is known.
fn viscous_laws() -> Vec<(&'static str, String, Option<[f64; 2]>)> {
    let known = |e: f64| Some([e, rebound_without_tension(damping_ratio(e))]);
    let mut laws = Vec::new();
    for e in [0.9, 0.5, 0.3] {
        let stiffness = 1e7;
        let damping = 2.0 * damping_ratio(e) * f64::sqrt(stiffness * MASS);
        let table = format!("damping = {damping:?}, stiffness = {stiffness:?}, exponent = 1.0");
        laws.push(("kelvin-voigt", table, known(e)));
        let table = format!("restitution = {e:?}, mass = {MASS:?}, stiffness = {STIFFNESS:?}");
        laws.push(("tsuji", table, known(e)));
    }
    for damping in [1e3, 1e5, 5e5] {
        let table = format!("damping = {damping:?}, stiffness = {STIFFNESS:?}");
        laws.push(("kuwabara-kono", table, None));
    }
    laws
}

#[test]
fn viscous_laws_rebound_and_give_way_as_their_closed_forms_say_on_both_engines() {
    // the values that a review of these laws would have
    for (e, told) in [(0.9, 0.9020), (0.5, 0.5503), (0.3, 0.3971)] {
        assert!((rebound_without_tension(damping_ratio(e)) - told).abs() < 1e-4);
    }
    for (word, table, known) in viscous_laws() {
        let normal = format!("law = \"{word}\", {table}");
        for engine in ENGINES {
            let case = case_of(&flight(&normal, 1.0), &[engine]);
            let law = Model::<f64>::new(&case.description).unwrap().clearances()[0].normal;
            let kept = simulate(&case);
            let what = format!("{word}, {table}, {engine}");
            let ended: Vec<&Contact> = ended(&kept).collect();
            assert!(ended.len() >= 2, "{what}");
            for (contact, next) in ended.iter().zip(&kept.contacts[1..]) {
                let impact = Impact::of(&law, MASS, contact.impact_rate);
                let ratio = next.impact_rate / contact.impact_rate;
                assert_near(&format!("{what}, told rebound"), ratio, impact.rebound);
                if let Some([rebound, _]) = known {
                    assert_near(&format!("{what}, rebound"), ratio, rebound);
                }
                assert_near(&format!("{what}, depth"), contact.peak_penetration, impact.depth);
                assert_near(&format!("{what}, force"), contact.peak_force, impact.force);
                let duration = contact.end - contact.begin;
                assert_near(&format!("{what}, duration"), duration, impact.duration);
            }
            let residual = kept.largest(|sample| sample.energy.residual);
            assert!(residual <= 1e3 * TOLERANCE * 0.5 * MASS, "{what}: {residual:e} J");
        }
    }
}

#[test]
fn a_viscous_law_without_tension_lets_go_where_its_force_ends() {
    for (word, table, known) in viscous_laws() {
        let Some([_, rebound]) = known else { continue };
        let normal = format!("law = \"{word}\", {table}");
        let text =
            flight(&normal, 1.0).replace("radial = 0.001\n", "radial = 0.001\ntension = \"cut\"\n");
        for engine in ENGINES {
            let kept = simulate(&case_of(&text, &[engine]));
            let rates: Vec<f64> = kept.contacts.iter().map(|contact| contact.impact_rate).collect();
            assert!(rates.len() >= 3, "{word}: {rates:?}");
            for pair in rates.windows(2) {
                assert_near(&format!("{word}, {table}, {engine}"), pair[1] / pair[0], rebound);
            }
        }
    }
}
