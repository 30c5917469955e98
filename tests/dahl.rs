//! Dahl's friction in whole runs. Known in advance: along a way slipped in one direction the
//! deflection of the bristles and the work of the friction are closed forms of the way alone,
//! whatever the speed, and so is where a wheel turns back.

mod simulated;

use freeplay::case::Case;
use freeplay::mechanism::Observation;
use freeplay::run::EventKind;
use simulated::{Kept, case, case_of, simulate};

const RADIUS: f64 = 0.01;
const INERTIA: f64 = 1e-4;
const COEFFICIENT: f64 = 0.2;
const STIFFNESS: f64 = 1e4;
/// µ/σ0 (m).
const REACH: f64 = COEFFICIENT / STIFFNESS;
/// K δ (N).
const NORMAL: f64 = 1e7 * 1e-5;
const SPEED: f64 = 6.0;

/// A wheel on an ideal pivot, whose journal stands in the wall of a bearing beside it, by 10 µm; it
/// turns freely, or as a motor tells.
fn wheel(turns: &str, set: &[&str]) -> Case {
    let text = format!(
        "[ground]\npoints = {{ O = [0.0, 0.0], W = [-0.00101, 0.0] }}\n\
         [bodies.wheel]\nmass = 0.3\ninertia = 1e-4\npoints = {{ O = [0.0, 0.0] }}\n\
         [joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"wheel.O\"]\n\
         [joints.W]\nkind = \"revolute\"\nbetween = [\"ground.W\", \"wheel.O\"]\n\
         [joints.W.clearance]\nbearing_radius = 0.011\nradial = 0.001\n\
         normal = {{ law = \"hertz\", stiffness = 1e7, exponent = 1.0 }}\n\
         friction = {{ law = \"dahl\", coefficient = 0.2, stiffness = 1e4 }}\n\
         [start]\nwheel = {{ angle = 0.0, angular_velocity = {turns}, fixed = true }}\n\
         [run]\nduration = 0.02\nsample_interval = 1e-5\n\
         [solver]\nabsolute_tolerance = \"scaled\"\n"
    );
    case_of(&text, set)
}

/// Slip in one direction `s` from a way x (m) with the deflection z (m) and the kinetic energy (J)
/// there.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    s: f64,
    x: f64,
    z: f64,
    energy: f64,
}

impl Stretch {
    fn decay(&self, x: f64) -> f64 {
        -(self.s * (x - self.x) / REACH)
    }

    /// z = s ℓ + (z₀ − s ℓ) e^(−s (x − x₀)/ℓ)
    fn deflection(&self, x: f64) -> f64 {
        // (1 − e) and e apart, so that a small deflection keeps its digits
        -self.s * REACH * self.decay(x).exp_m1() + self.z * self.decay(x).exp()
    }

    /// What is left of the kinetic energy, less N σ0 ∫ z dx.
    fn energy(&self, x: f64) -> f64 {
        let full = self.s * REACH;
        let work = full * (x - self.x) - (self.z - full) * full * self.decay(x).exp_m1();
        self.energy - NORMAL * STIFFNESS * work
    }

    /// The stretch back from where nothing is left.
    fn turn_back(&self) -> Stretch {
        let (mut near, mut far) = (self.x + self.s * 1e-9, self.x + self.s * 1e-3);
        assert!(self.energy(near) > 0.0 && self.energy(far) < 0.0);
        for _ in 0..200 {
            let middle = near.midpoint(far);
            if self.energy(middle) > 0.0 { near = middle } else { far = middle }
        }
        Stretch { s: -self.s, x: near, z: self.deflection(near), energy: 0.0 }
    }
}

fn slipped(sample: &Observation) -> f64 {
    RADIUS * sample.bodies[0].angle
}

fn is_kink(kind: EventKind) -> bool {
    kind == EventKind::FrictionKink
}

/// The wheel slows down, turns back on its bristles and swings on them: way by way the closed form.
fn assert_wheel(kept: &Kept, within: f64, what: &str) {
    let kinks: Vec<f64> = kept.events.iter().filter(|e| is_kink(e.kind)).map(|e| e.time).collect();
    assert!((4..10).contains(&kinks.len()), "{what}: {kinks:?}");
    let whole = 0.5 * INERTIA * SPEED * SPEED;
    let mut stretch = Stretch { s: 1.0, x: 0.0, z: 0.0, energy: whole };
    let mut turned = 0;
    let mut off = [0.0_f64; 4];
    for sample in &kept.samples {
        while turned < kinks.len() && kinks[turned] < sample.time {
            stretch = stretch.turn_back();
            turned += 1;
        }
        let x = slipped(sample);
        let found = &sample.clearances[0];
        let force = -NORMAL * STIFFNESS * stretch.deflection(x);
        let energy = stretch.energy(x);
        off[0] = off[0].max((found.normal_force / NORMAL - 1.0).abs());
        off[1] = off[1].max((found.tangential_force - force).abs() / (COEFFICIENT * NORMAL));
        off[2] = off[2].max((sample.energy.kinetic - energy).abs() / whole);
        // all that is not in the motion counts as dissipated
        off[3] = off[3].max((sample.energy.dissipated - (whole - energy)).abs() / whole);
        off[3] = off[3].max(sample.energy.residual.abs() / whole);
    }
    let told = off.map(|off| format!("{off:.0e}")).join(", ");
    println!("{what}: {} kinks, off by {told}", kinks.len());
    assert!(turned >= 4 && off.iter().all(|off| *off < within), "{what}: {off:?}");
}

#[test]
fn a_wheel_is_braked_and_swings_as_the_closed_form_tells_on_both_engines() {
    for engine in ["ida", "explicit"] {
        let set = [&*format!("solver.engine={engine}"), "solver.relative_tolerance=1e-12"];
        assert_wheel(&simulate(&wheel("6.0", &set)), 1e-10, engine);
    }
}

#[test]
fn a_wheel_in_71_digits_is_braked_to_the_last_place_of_doubles() {
    let set = ["solver.engine=explicit", "solver.precision=71", "run.sample_interval=1e-4"];
    assert_wheel(&simulate(&wheel("6.0", &set)), 1e-13, "71 digits");
}

/// z = µ/σ0 (1 − e^(−σ0 x/µ)), from the very first of it.
#[test]
fn friction_begins_in_proportion_to_the_way_and_ends_full() {
    let kept = simulate(&wheel("600.0", &["run.duration=5e-5", "run.sample_interval=1e-7"]));
    for sample in &kept.samples[1..] {
        let exact = COEFFICIENT * (-slipped(sample) / REACH).exp_m1();
        let ratio = sample.clearances[0].tangential_force / sample.clearances[0].normal_force;
        assert!((ratio / exact - 1.0).abs() < 1e-10, "{ratio} {exact} at {:e}", sample.time);
    }
    let last = kept.last().clearances[0].tangential_force / NORMAL;
    assert!((last + COEFFICIENT).abs() < 1e-6, "{last}");
}

#[test]
fn a_rubbing_pendulum_swings_alike_on_both_engines() {
    let set = |engine| ["run.duration=0.012", "solver.relative_tolerance=1e-13", engine];
    let [ida, explicit] = ["solver.engine=ida", "solver.engine=explicit"]
        .map(|engine| simulate(&case("tests/cases/rubbing-pendulum.toml", &set(engine))));
    assert_eq!(ida.events.len(), explicit.events.len());
    let [a, b] = [&ida.events, &explicit.events];
    assert!(a.iter().zip(b).all(|(a, b)| a.kind == b.kind && (a.time - b.time).abs() < 1e-10));
    let scale = |of: fn(&Observation) -> f64| explicit.largest(of).max(1e-300);
    let quantities: [fn(&Observation) -> f64; 5] = [
        |o| o.bodies[0].angle,
        |o| o.bodies[0].angular_velocity,
        |o| o.clearances[0].offset[0],
        |o| o.clearances[0].tangential_force,
        |o| o.clearances[0].normal_force,
    ];
    for (number, of) in quantities.into_iter().enumerate() {
        let pairs = ida.samples.iter().zip(&explicit.samples);
        let off = pairs.map(|(a, b)| (of(a) - of(b)).abs()).fold(0.0, f64::max) / scale(of);
        println!("quantity {number}: {off:.1e}");
        assert!(off < 1e-10, "quantity {number} is off by {off:e}");
    }
}

/// Bristles are straight when a contact begins: the first friction of each is none.
#[test]
fn every_contact_begins_with_straight_bristles() {
    let set = ["run.duration=0.04", "run.sample_interval=1e-7"];
    let kept = simulate(&case("tests/cases/rubbing-pendulum.toml", &set));
    let begins = kept.contacts.iter().filter(|contact| contact.begin > 0.0);
    let mut looked = 0;
    for contact in begins {
        let after = kept.samples.iter().find(|sample| sample.time > contact.begin).unwrap();
        let seen = &after.clearances[0];
        if seen.normal_force > 0.0 {
            let way = (after.time - contact.begin) * seen.slip_velocity.abs() + 1e-9;
            assert!(seen.tangential_force.abs() <= 2.0 * 5e3 * way * seen.normal_force);
            looked += 1;
        }
    }
    assert!(looked >= 3, "{looked} contacts");
}
