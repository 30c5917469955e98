//! How long a contact lasts, and how deep it goes, as far as that is known before any run.
//! ```text
//! ½ m v² = ∫ F_e dδ              elastic impact at v
//! 1/m = largest eigenvalue of Σ (1/M + (s⊥ s⊥ᵀ)/I)   over the two bodies, joints left out
//! ```
//! The other joints of a body make it heavier there, so that contacts last no less than this.

use super::Turn;
use crate::contact::{Impact, NormalLaw, depth_under};
use crate::mechanism::Mechanism;

/// Speed (m/s) of an impact where nothing tells one.
const SOME_SPEED: f64 = 0.01;

/// A contact of one clearance, as it is to be expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Index of the clearance.
    pub clearance: usize,
    /// Mass that journal and bearing meet with (kg).
    pub mass: f64,
    /// Speed that it is told for (m/s): the clearance times the fastest turn, or a fall through it.
    pub speed: f64,
    /// How long an impact at that speed lasts (s).
    pub duration: f64,
    /// How deep it goes (m).
    pub depth: f64,
    /// What it rebounds at, over its speed.
    pub rebound: f64,
    /// The largest force (N) that the ideal mechanism has there, and how deep it presses (m);
    /// `None` where that is not known.
    pub pressed: Option<(f64, f64)>,
}

/// The contacts to be expected of each clearance; those between bodies that only drives move are
/// left out.
pub fn touches(mechanism: &Mechanism<f64>, turn: &Turn) -> Vec<Touch> {
    (0..mechanism.modes().len()).filter_map(|k| touch(mechanism, turn, k)).collect()
}

fn touch(mechanism: &Mechanism<f64>, turn: &Turn, k: usize) -> Option<Touch> {
    let model = mechanism.model();
    let clearance = &model.clearances()[k];
    let mass = effective_mass(mechanism, k)?;
    let speed = speed(mechanism, clearance.radial);
    let elastic = clearance.normal.elastic();
    let Impact { depth, duration, .. } = Impact::of(&NormalLaw::new(*elastic, 0.0), mass, speed);
    let force = turn.force_in(&model.names().joints[model.names().loose[k]]);
    Some(Touch {
        clearance: k,
        mass,
        speed,
        duration,
        depth,
        rebound: Impact::of(&clearance.normal, mass, speed).rebound,
        pressed: force.map(|force| (force, depth_under(elastic, force))),
    })
}

/// A typical speed of impacts (m/s).
fn speed(mechanism: &Mechanism<f64>, radial: f64) -> f64 {
    let turning = radial * fastest_turn(mechanism);
    let fields = mechanism.model().loads().iter().filter_map(|load| load.field());
    let gravity = fields.map(|acceleration| acceleration.norm());
    let fall = (2.0 * radial * gravity.fold(0.0, f64::max)).sqrt();
    let speed = turning.max(fall);
    if speed > 0.0 { speed } else { SOME_SPEED }
}

fn fastest_turn(mechanism: &Mechanism<f64>) -> f64 {
    let start = mechanism.observe(0.0, &mechanism.start().integrals);
    start.bodies.iter().map(|body| body.angular_velocity.abs()).fold(0.0, f64::max)
}

/// The mass (kg) that journal and bearing meet with, where it is smallest; `None` where neither
/// moves freely.
fn effective_mass(mechanism: &Mechanism<f64>, k: usize) -> Option<f64> {
    let model = mechanism.model();
    let pair = &model.clearances()[k].pair;
    let start = mechanism.observe(0.0, &mechanism.start().integrals);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (body, arm) in [(pair.i, pair.s_i), (pair.j, pair.s_j)] {
        if body == crate::model::GROUND || mechanism.is_driven(body - 1) {
            continue;
        }
        let (sin, cos) = start.bodies[body - 1].angle.sin_cos();
        let across = [-(arm.x * sin + arm.y * cos), arm.x * cos - arm.y * sin];
        let (mass, inertia) = (model.masses()[body], model.inertias()[body]);
        xx += 1.0 / mass + across[0] * across[0] / inertia;
        xy += across[0] * across[1] / inertia;
        yy += 1.0 / mass + across[1] * across[1] / inertia;
    }
    let largest = (xx + yy) / 2.0 + ((xx - yy) / 2.0).hypot(xy);
    (largest > 0.0).then(|| 1.0 / largest)
}
