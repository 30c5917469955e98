//! Every law of the menu in the paper's case c, on both engines: every pair of an elastic law, a damping
//! and a friction law; with `FREEPLAY_EVERY_LAW` in the environment all triples on each engine. Known in advance: the formulas of
//! the friction laws that go by the slip alone, written here once more; that the energy balance closes;
//! that two engines which share no step agree while errors are small.

mod simulated;

use freeplay::contact::{Damping, elastic, viscous};
use freeplay::friction;
use freeplay::mechanism::Observation;
use freeplay::parameter::Kind;
use simulated::{Kept, case, simulate};

const ENGINES: [&str; 2] = ["ida", "explicit"];

/// The table of each friction law's own example.
fn frictions() -> Vec<(&'static str, &'static str)> {
    let table = |kind: &freeplay::parameter::Kind| {
        let (_, table) = kind.example.split_once("friction = ").expect("an example of friction");
        (kind.word, table.trim())
    };
    friction::KINDS.iter().map(|kind| table(kind)).collect()
}

/// F_T/F_N by the formula, at a slip (m/s), of the laws that remember nothing; with the numbers of
/// their examples.
fn ratio(law: &str, slip: f64) -> Option<f64> {
    let (v, sign) = (slip.abs(), if slip == 0.0 { 0.0 } else { slip.signum() });
    let share = match law {
        "ambrosio" => 0.1 * ((v - 1e-3) / (1e-2 - 1e-3)).clamp(0.0, 1.0),
        "tanh" => 0.1 * (v / 1e-3).tanh(),
        "threlfall" if v <= 1e-3 => 0.1 * (1.0 - (-3.0 * v / 1e-3).exp()),
        "threlfall" => 0.095,
        "brown-mcphee" => {
            let x = v / 1e-3;
            0.1 * (4.0 * x).tanh() + 0.05 * x / (0.25 * x * x + 0.75).powi(2)
        }
        "bengisu-akay" if v <= 1e-3 => 0.15 * (1.0 - ((v - 1e-3) / 1e-3).powi(2)),
        "bengisu-akay" => 0.1 + 0.05 * (-50.0 * (v - 1e-3)).exp(),
        "stribeck" => (0.1 + 0.05 * (-(v / 1e-2).powi(2)).exp()) * (v / 1e-3).tanh(),
        _ => return None,
    };
    Some(-share * sign)
}

/// The table of a normal force: the example of the elastic law with another damping.
fn normal(damping: &str, elastic: &Kind) -> String {
    let restitution = if damping == "hertz" { "" } else { "restitution = 0.5, " };
    let (_, rest) =
        elastic.example.split_once("elastic = ").expect("an example of the elastic law");
    format!("{{ law = \"{damping}\", {restitution}elastic = {}", rest.trim())
}

/// The table of a law with a damping of its own, as its example has it.
fn own(kind: &Kind) -> String {
    let (_, table) = kind.example.split_once("normal = ").expect("an example of the law");
    table.trim().to_owned()
}

/// Case c with tables of friction and normal force in all its joints, for some ms.
fn run(engine: &str, friction: &str, normal: &str, duration: &str) -> Kept {
    let mut set = vec![format!("solver.engine={engine}"), format!("run.duration={duration}")];
    set.push("run.sample_interval=1e-5".to_owned());
    for joint in ["A", "B", "B0"] {
        set.push(format!("joints.{joint}.clearance.friction={friction}"));
        set.push(format!("joints.{joint}.clearance.normal={normal}"));
    }
    let set: Vec<&str> = set.iter().map(String::as_str).collect();
    simulate(&case("cases/four-bar-c.toml", &set))
}

fn assert_balanced(kept: &Kept, what: &str) {
    let scale = kept.largest(|sample| sample.energy.kinetic);
    let off = kept.largest(|sample| sample.energy.residual) / scale;
    assert!(off < 1e-6, "{what}: energy is off by {off:e}");
    assert!(kept.contacts.len() > 10, "{what}: {} contacts", kept.contacts.len());
}

fn assert_rubs_by_formula(kept: &Kept, law: &str) {
    let largest = kept.largest(|sample| sample.clearances[0].normal_force);
    let mut rubbed = 0;
    for sample in &kept.samples {
        for clearance in sample.clearances.iter().filter(|clearance| clearance.in_contact) {
            let Some(ratio) = ratio(law, clearance.slip_velocity) else { return };
            // a contact that pulls does not rub
            let expected = ratio * clearance.normal_force.max(0.0);
            let off = (clearance.tangential_force - expected).abs();
            // branches overlap by a little beyond their edges
            assert!(off <= 1e-6 * largest, "{law}: {clearance:?} is off by {off:e} N");
            rubbed += usize::from(clearance.tangential_force != 0.0);
        }
    }
    assert!(rubbed > 50, "{law}: {rubbed} samples with friction");
}

/// Every combination of a normal force and a friction law, with a number for each.
fn combinations() -> Vec<(usize, String, &'static str, &'static str)> {
    let mut all = Vec::new();
    for (j, (word, table)) in frictions().into_iter().enumerate() {
        for (i, (damping, _)) in Damping::ALL.iter().enumerate() {
            // all pairs are there, and with `every` all triples
            let chosen = (i + j) % elastic::KINDS.len();
            for (k, kind) in elastic::KINDS.iter().enumerate() {
                if k == chosen || every() {
                    all.push((i + j, normal(damping, kind), word, table));
                }
            }
        }
        for (i, kind) in viscous::KINDS.iter().enumerate() {
            all.push((i + j, own(kind), word, table));
        }
    }
    all
}

/// Whether all triples are asked for, on both engines each.
fn every() -> bool {
    std::env::var_os("FREEPLAY_EVERY_LAW").is_some()
}

/// Every pair of an elastic law, a damping and a friction law, and each of them on this engine.
fn every_law_on(engine: usize) {
    assert!(frictions().len() >= 9 && Damping::ALL.len() >= 11);
    assert!(elastic::KINDS.len() >= 7 && viscous::KINDS.len() >= 3);
    for (number, normal, word, table) in combinations() {
        if number % ENGINES.len() != engine && !every() {
            continue;
        }
        let kept = run(ENGINES[engine], table, &normal, "0.012");
        assert_balanced(&kept, &format!("{word} with {normal} on {}", ENGINES[engine]));
        assert_rubs_by_formula(&kept, word);
    }
}

#[test]
fn every_law_runs_case_c_on_ida() {
    every_law_on(0);
}

#[test]
fn every_law_runs_case_c_on_the_explicit_engine() {
    every_law_on(1);
}

/// Of the laws that remember nothing the formula is written here; the others are solved in their files.
#[test]
fn every_friction_law_has_a_formula_or_a_memory() {
    let remembers = ["dahl", "lugre", "elasto-plastic", "gonthier"];
    for (word, _) in frictions() {
        assert_eq!(ratio(word, 0.1).is_none(), remembers.contains(&word), "{word}");
    }
}

#[test]
fn both_engines_have_the_same_motion_with_every_law() {
    let ambrosio = "{ law = \"ambrosio\", coefficient = 0.1, v0 = 1e-3, v1 = 1e-2 }".to_owned();
    let hertz = normal("flores", elastic::KINDS[0]);
    let rubbing = frictions().into_iter().map(|(_, table)| (table.to_owned(), hertz.clone()));
    let elastics = elastic::KINDS.iter().map(|kind| normal("flores", kind));
    let normals = elastics.chain(viscous::KINDS.iter().map(|kind| own(kind)));
    let pressing = normals.map(|normal| (ambrosio.clone(), normal));
    for (friction, normal) in rubbing.chain(pressing) {
        let [a, b] = ENGINES.map(|engine| run(engine, &friction, &normal, "0.002"));
        let turned = |sample: &Observation| -> Vec<f64> {
            sample.bodies.iter().map(|body| body.angular_velocity).collect()
        };
        let (a, b) = (turned(a.last()), turned(b.last()));
        let fastest = a.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()));
        for (one, other) in a.iter().zip(&b) {
            let off = (one - other).abs() / fastest;
            assert!(off < 1e-6, "{friction}, {normal}: rates differ by {off:e} of the fastest");
        }
    }
}
