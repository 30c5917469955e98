//! What a run can see of its own errors: modes that contradict the geometry, energy from nowhere.
//!
//! The engines prove that they miss no event. This does not rely on it: a journal deep in the wall
//! without a contact, a contact far from the wall, a contact that begins while journal and bearing
//! part, friction that is not that of the slip, or energy that comes from nowhere, end a run,
//! whatever let them pass.

use crate::friction::{Friction, FrictionLaw, Ramp};
use crate::mechanism::{ClearanceObservation, Observation};
use crate::scalar::Scalar;

/// Depths (m) that are rounding, whatever the tolerance.
const ROUNDING: f64 = 1e-12;
/// What a state may be off by, in units of the tolerance times the size of the mechanism.
const ERRORS: f64 = 1e3;
/// What a slip may be off by, over the speed of the mechanism, however tight the tolerance, and
/// however loose.
const SLIP: [f64; 2] = [1e-8, 1e-2];
/// Share of v1 that an edge lies lower on the way down, and more.
const EDGE: f64 = 1e-5;
/// Share of all energy seen that the balance may be off by.
const ENERGY: f64 = 0.25;

/// What cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Contradiction {
    /// Flight inside the wall.
    #[error(
        "what touches in {clearance} is {depth:.3e} m beyond its wall at t = {time:e} s, and no contact has begun: the engine has missed one; a smaller relative_tolerance or \
         max_step may help"
    )]
    InTheWall {
        /// Key of the joint.
        clearance: String,
        /// Penetration (m).
        depth: f64,
        /// Time (s).
        time: f64,
    },
    /// A contact without touch.
    #[error(
        "what touches in {clearance} is {gap:.3e} m off its wall at t = {time:e} s, and its contact has not ended: the engine has missed that; a smaller relative_tolerance or \
         max_step may help"
    )]
    OffTheWall {
        /// Key of the joint.
        clearance: String,
        /// Distance from the wall (m).
        gap: f64,
        /// Time (s).
        time: f64,
    },
    /// A contact that begins on the way out.
    #[error(
        "a contact of {clearance} begins at t = {time:e} s while the surfaces part at \
         {rate:.3e} m/s: its begin was missed; a smaller relative_tolerance or max_step may help"
    )]
    BeginsParting {
        /// Key of the joint.
        clearance: String,
        /// Speed at which they part (m/s).
        rate: f64,
        /// Time (s).
        time: f64,
    },
    /// Friction that is not that of the slip.
    #[error(
        "the slip in {clearance} is {slip:.3e} m/s at t = {time:e} s, off by {off:.3e} m/s from any \
         that has the friction which acts there: an edge of the friction law was passed unseen; a \
         smaller relative_tolerance or max_step may help"
    )]
    OtherSlip {
        /// Key of the joint.
        clearance: String,
        /// Slip (m/s).
        slip: f64,
        /// Distance (m/s) from the nearest slip that has this friction.
        off: f64,
        /// Time (s).
        time: f64,
    },
    /// Friction beyond what its law can give.
    #[error(
        "the friction in {clearance} is {ratio:.6} of the normal force at t = {time:e} s, and its \
         law gives {limit:.6} at the most: an edge of the law was passed unseen; a smaller \
         relative_tolerance or max_step may help"
    )]
    TooMuchFriction {
        /// Key of the joint.
        clearance: String,
        /// Magnitude of F_T/F_N.
        ratio: f64,
        /// The largest there can be.
        limit: f64,
        /// Time (s).
        time: f64,
    },
    /// Energy from nowhere, or to nowhere.
    #[error(
        "the energy balance is off by {residual:.3e} J at t = {time:e} s, where the largest energy \
         seen is {scale:.3e} J: the motion is none of this mechanism's any more; a smaller \
         relative_tolerance may help"
    )]
    Energy {
        /// Residual of the balance (J).
        residual: f64,
        /// Largest energy or work so far (J).
        scale: f64,
        /// Time (s).
        time: f64,
    },
    /// Time that runs backwards.
    #[error("a step led back in time, from t = {from:e} s to {to:e} s")]
    TimeGoesBack {
        /// Begin of the step (s).
        from: f64,
        /// Its end (s).
        to: f64,
    },
}

/// What the friction of a clearance is held to.
#[derive(Debug, Clone, Copy)]
pub(super) enum Bounds {
    /// The slip has it.
    Slip(Ramp),
    /// It remembers; this is the largest |F_T/F_N|.
    Limit(f64),
}

impl Bounds {
    /// Those of a law.
    pub fn of<S: Scalar>(law: Friction<S>) -> Self {
        law.ramp().map_or_else(|| Bounds::Limit(law.limit().to_f64()), Bounds::Slip)
    }
}

/// Follows a run (see the module's header).
#[derive(Debug, Clone)]
pub(super) struct Witness {
    /// Keys of the joints with clearance.
    names: Vec<String>,
    /// Their friction, where there is any.
    frictions: Vec<Option<Bounds>>,
    /// What penetrations may be off by (m), rates, and slips (m/s).
    depth: f64,
    rate: f64,
    slip: f64,
    /// Share of full friction that there may be more of it.
    share: f64,
    /// Largest energy or work seen (J).
    pub energy: f64,
}

impl Witness {
    /// A witness of a mechanism of this length (m), speed (m/s) and mass (kg), solved to this
    /// tolerance; friction by clearance.
    pub fn new(
        names: Vec<String>,
        frictions: Vec<Option<Bounds>>,
        [length, speed, mass]: [f64; 3],
        tolerance: f64,
    ) -> Self {
        let errors = ERRORS * tolerance;
        Witness {
            names,
            frictions,
            depth: ROUNDING + errors * length,
            rate: errors * speed,
            slip: errors.clamp(SLIP[0], SLIP[1]) * speed,
            share: errors.clamp(SLIP[0], SLIP[1]),
            // of a mechanism at rest there is nothing but rounding
            energy: errors * mass * speed * speed,
        }
    }

    /// Looks at the mechanism at one time.
    pub fn see(&mut self, seen: &Observation) -> Result<(), Contradiction> {
        let time = seen.time;
        for (k, clearance) in seen.clearances.iter().enumerate() {
            let depth = clearance.penetration;
            if clearance.in_contact && -depth > self.depth {
                let clearance = self.names[k].clone();
                return Err(Contradiction::OffTheWall { clearance, gap: -depth, time });
            }
            if !clearance.in_contact && depth > self.depth {
                let clearance = self.names[k].clone();
                return Err(Contradiction::InTheWall { clearance, depth, time });
            }
            self.slips(k, clearance, time)?;
        }
        self.balance(seen)
    }

    /// Whether the friction of a contact is that of its slip.
    fn slips(&self, k: usize, seen: &ClearanceObservation, time: f64) -> Result<(), Contradiction> {
        let Some(bounds) = self.frictions[k].filter(|_| seen.normal_force > 0.0) else {
            return Ok(());
        };
        let slip = seen.slip_velocity;
        let ramp = match bounds {
            Bounds::Slip(ramp) => ramp,
            Bounds::Limit(limit) => {
                let ratio = (seen.tangential_force / seen.normal_force).abs();
                if ratio <= limit * (1.0 + self.share) {
                    return Ok(());
                }
                let clearance = self.names[k].clone();
                return Err(Contradiction::TooMuchFriction { clearance, ratio, limit, time });
            }
        };
        let off = ramp.off(slip, seen.tangential_force / seen.normal_force);
        if off > self.slip + EDGE * ramp.v1 {
            let clearance = self.names[k].clone();
            return Err(Contradiction::OtherSlip { clearance, slip, off, time });
        }
        Ok(())
    }

    fn balance(&mut self, seen: &Observation) -> Result<(), Contradiction> {
        let energy = &seen.energy;
        let parts = [
            energy.kinetic,
            energy.elastic,
            energy.dissipated,
            energy.drive_work,
            energy.load_work,
            // potentials count from anywhere: what they change by is in the other terms
            1e3 * f64::EPSILON * energy.potential,
        ];
        self.energy = parts.iter().fold(self.energy, |most, part| most.max(part.abs()));
        let residual = energy.residual;
        if residual.abs() > ENERGY * self.energy {
            return Err(Contradiction::Energy { residual, scale: self.energy, time: seen.time });
        }
        Ok(())
    }

    /// Looks at a contact of clearance `k` that begins at a rate (m/s).
    pub fn begins(&self, k: usize, rate: f64, time: f64) -> Result<(), Contradiction> {
        if rate < -self.rate {
            let clearance = self.names[k].clone();
            return Err(Contradiction::BeginsParting { clearance, rate: -rate, time });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{ClearanceObservation, EnergyObservation};

    fn witness() -> Witness {
        let ramp = Ramp { coefficient: 0.1, v0: 1e-3, v1: 1e-2 };
        let friction = Some(Bounds::Slip(ramp));
        Witness::new(vec!["A".into()], vec![friction], [0.1, 1.0, 1.0], 1e-12)
    }

    fn seen(penetration: f64, in_contact: bool) -> Observation {
        let clearance =
            ClearanceObservation { penetration, in_contact, ..ClearanceObservation::default() };
        Observation { time: 1.0, clearances: vec![clearance], ..Observation::default() }
    }

    #[test]
    fn flight_in_the_wall_and_contact_off_it_are_seen() {
        assert_eq!(witness().see(&seen(1e-13, false)), Ok(()));
        assert_eq!(witness().see(&seen(1e-5, true)), Ok(()));
        let found = witness().see(&seen(1e-8, false));
        assert!(matches!(found, Err(Contradiction::InTheWall { .. })), "{found:?}");
        let found = witness().see(&seen(-1e-8, true));
        assert!(matches!(found, Err(Contradiction::OffTheWall { .. })), "{found:?}");
    }

    #[test]
    fn friction_that_is_not_that_of_the_slip_is_seen() {
        let at = |slip_velocity, tangential_force, normal_force| {
            let contact = ClearanceObservation {
                in_contact: true,
                slip_velocity,
                normal_force,
                tangential_force,
                ..ClearanceObservation::default()
            };
            Observation { clearances: vec![contact], ..Observation::default() }
        };
        for right in [at(2e-2, -10.0, 100.0), at(-5.5e-3, 5.0, 100.0), at(5e-4, 0.0, 100.0)] {
            assert_eq!(witness().see(&right), Ok(()));
        }
        // where nothing presses there is no friction
        assert_eq!(witness().see(&at(2e-2, 0.0, 0.0)), Ok(()));
        for wrong in [at(2e-2, 10.0, 100.0), at(2e-2, -5.0, 100.0), at(2e-3, 0.0, 100.0)] {
            let found = witness().see(&wrong);
            assert!(matches!(found, Err(Contradiction::OtherSlip { .. })), "{found:?}");
        }
    }

    #[test]
    fn friction_beyond_full_friction_is_seen() {
        let limits = vec![Some(Bounds::Limit(0.1))];
        let mut witness = Witness::new(vec!["A".into()], limits, [0.1, 1.0, 1.0], 1e-12);
        let mut at = |tangential_force| {
            let contact = ClearanceObservation {
                in_contact: true,
                normal_force: 100.0,
                tangential_force,
                ..ClearanceObservation::default()
            };
            witness.see(&Observation { clearances: vec![contact], ..Observation::default() })
        };
        assert_eq!(at(-10.0), Ok(()));
        assert_eq!(at(7.0), Ok(()));
        assert!(matches!(at(10.1), Err(Contradiction::TooMuchFriction { .. })));
    }

    #[test]
    fn energy_from_nowhere_is_seen() {
        let at = |kinetic, residual| Observation {
            energy: EnergyObservation { kinetic, residual, ..EnergyObservation::default() },
            ..Observation::default()
        };
        assert_eq!(witness().see(&at(2.0, 1e-3)), Ok(()));
        let found = witness().see(&at(2.0, 1.0));
        assert!(matches!(found, Err(Contradiction::Energy { .. })), "{found:?}");
    }

    #[test]
    fn a_contact_begins_on_the_way_in() {
        assert_eq!(witness().begins(0, 1e-3, 1.0), Ok(()));
        let found = witness().begins(0, -1e-3, 1.0);
        assert!(matches!(found, Err(Contradiction::BeginsParting { .. })), "{found:?}");
    }
}
