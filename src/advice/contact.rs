//! How long a contact lasts, and how deep it goes, as far as that is known before any run.
//! ```text
//! ½ m v² = K δ^(n+1)/(n+1)        elastic impact at v
//! T = 2 δ/v · ∫₀¹ dx/√(1 − x^(n+1))   (2.943 δ/v for n = 1.5)
//! 1/m = largest eigenvalue of Σ (1/M + (s⊥ s⊥ᵀ)/I)   over the two bodies, joints left out
//! ```
//! The other joints of a body make it heavier there, so that contacts last no less than this.

use super::Turn;
use crate::mechanism::Mechanism;

/// Speed (m/s) of an impact where nothing tells one.
const SOME_SPEED: f64 = 0.01;
/// Parts of the integral over a contact.
const PARTS: u32 = 400;

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
    let (stiffness, exponent) = (clearance.normal.stiffness(), clearance.normal.exponent());
    let speed = speed(mechanism, clearance.radial);
    let power = exponent + 1.0;
    let depth = (power / 2.0 * mass * speed * speed / stiffness).powf(1.0 / power);
    let force = turn.force_in(&model.names().clearances[k]);
    Some(Touch {
        clearance: k,
        mass,
        speed,
        duration: 2.0 * depth / speed * passage(power),
        depth,
        pressed: force.map(|force| (force, (force / stiffness).powf(1.0 / exponent))),
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

/// ∫₀¹ dx/√(1 − x^power), with x = 1 − u² so that nothing is singular.
fn passage(power: f64) -> f64 {
    let part = 1.0 / f64::from(PARTS);
    let at = |k: u32| {
        let u = (f64::from(k) + 0.5) * part;
        2.0 * u / (1.0 - (1.0 - u * u).powf(power)).sqrt()
    };
    (0..PARTS).map(at).sum::<f64>() * part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_impact_lasts_as_long_as_its_closed_form_says() {
        // closed form: 2.9432751843247 δ/v for n = 1.5; half a period of a spring for n = 1
        assert!((2.0 * passage(2.5) - 2.943_275_184_324_7).abs() < 1e-4);
        assert!((2.0 * passage(2.0) - std::f64::consts::PI).abs() < 1e-4);
    }
}
