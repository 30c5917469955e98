//! What journal and bearing put on each other in contact (paper, eq. 1, 4–13).
//!
//! The normal force pushes the journal along −n, the tangential force acts on it along t; on each
//! body at its own contact point, R_j n and R_b n from the centres, as the paper's moments do.
//! The arms differ by δ, so angular momentum is kept only to δ F_T. Before a wall both bodies are
//! touched at the point itself, R from its centre where it is a pin's, and angular momentum is kept.
//!
//! Eq. 10 takes F_N as pressing the surfaces together. Where the normal law pulls there is no
//! friction: a negative F_N in eq. 10 would drive the slip.

use super::{Clearance, Contact, Gap, GapRates, GapSlopes};
use crate::contact::{NormalForce, Penetration};
use crate::friction::{FrictionLaw, Inner, MOST_INNER, Sloped};
use crate::plane::{Vector, Wrench};
use crate::scalar::Scalar;

/// The forces of one contact.
#[derive(Debug, Clone, Copy)]
pub struct ContactForce<S> {
    /// Normal force F_N (N) as applied, and its partial derivatives.
    pub normal: NormalForce<S>,
    /// Tangential force F_T (N) on the journal, along t.
    pub tangential: S,
    /// F_T/F_N.
    ratio: Sloped<S>,
    /// Force on the journal (N), fixed frame.
    pub on_journal: Vector<S>,
}

/// Changes of the wrenches on both bodies with one coordinate or velocity.
#[derive(Debug, Clone, Copy)]
pub struct ForceSlopes<S> {
    /// On body `i`.
    pub bearing: Wrench<S>,
    /// On body `j`.
    pub journal: Wrench<S>,
}

impl<S: Scalar> ContactForce<S> {
    /// ∂F_T/∂z (N over the unit of z), by the inner states of the friction.
    pub fn tangential_slopes(&self) -> Inner<S> {
        self.ratio.d_inner.map(|slope| slope * self.normal.value)
    }
}

impl<S: Scalar> Clearance<S> {
    /// Depth and rate as the normal law wants them.
    #[inline(always)]
    pub fn penetration(&self, contact: &Contact<S>, gap: &Gap<S>, rate: S) -> Penetration<S> {
        Penetration { depth: gap.depth, rate, inverse_impact_rate: contact.inverse_impact_rate }
    }

    /// The forces of a contact, whose friction may have `inner` states; from the root of the
    /// depth, where that is known
    /// ([`NormalLaw::force_from_root`](crate::contact::NormalLaw::force_from_root)).
    #[inline(always)]
    pub fn force(
        &self,
        contact: &Contact<S>,
        gap: &Gap<S>,
        rates: &GapRates<S>,
        inner: Inner<S>,
        root: Option<S>,
    ) -> ContactForce<S> {
        let penetration = self.penetration(contact, gap, rates.rate);
        let mut normal = match root {
            Some(root) => self.normal.force_from_root(penetration, root),
            None => self.normal.force(penetration),
        };
        if contact.pulling && self.cut_tension {
            normal = NormalForce { elastic: normal.elastic, ..NormalForce::none() };
        }
        let ratio = match (&self.friction, contact.branch) {
            (Some(friction), Some(branch)) if !contact.pulling => {
                friction.ratio(branch, rates.slip, inner)
            }
            _ => Sloped::none(),
        };
        let tangential = ratio.value * normal.value;
        let on_journal = rates.tangent * tangential - rates.normal * normal.value;
        ContactForce { normal, tangential, ratio, on_journal }
    }

    /// The wrenches of a contact on bodies `i` and `j`.
    #[inline(always)]
    pub fn wrenches(&self, gap: &Gap<S>, force: &ContactForce<S>) -> [Wrench<S>; 2] {
        let f = force.on_journal;
        let mut bearing = Wrench::at(gap.arm_i, -f);
        let mut journal = Wrench::at(gap.arm_j, f);
        bearing.moment -= self.bearing_radius * force.tangential;
        journal.moment += self.journal_radius * force.tangential;
        [bearing, journal]
    }

    /// Changes of the wrenches, from those of the gap.
    pub fn force_slopes(
        &self,
        gap: &Gap<S>,
        rates: &GapRates<S>,
        force: &ContactForce<S>,
        slopes: &GapSlopes<S>,
    ) -> ForceSlopes<S> {
        let d_normal = force.normal.d_depth * slopes.depth + force.normal.d_rate * slopes.rate;
        let d_tangential =
            force.ratio.value * d_normal + force.ratio.d_slip * force.normal.value * slopes.slip;
        let turn = slopes.direction;
        let df = rates.tangent * (d_tangential - force.normal.value * turn)
            - rates.normal * (d_normal + force.tangential * turn);
        let mut changed = self.changed(gap, df, d_tangential);
        let [arm_i, arm_j] = slopes.arms;
        changed.bearing.moment -= arm_i.cross(force.on_journal);
        changed.journal.moment += arm_j.cross(force.on_journal);
        changed
    }

    /// Changes of the wrenches with one inner state of the friction, by number.
    pub fn inner_slopes(
        &self,
        gap: &Gap<S>,
        rates: &GapRates<S>,
        force: &ContactForce<S>,
        inner: usize,
    ) -> ForceSlopes<S> {
        let d_tangential = force.tangential_slopes()[inner];
        self.changed(gap, rates.tangent * d_tangential, d_tangential)
    }

    /// Changes of the wrenches, from those of the journal's force and of F_T, where no arm turns.
    fn changed(&self, gap: &Gap<S>, force: Vector<S>, tangential: S) -> ForceSlopes<S> {
        let mut bearing = Wrench::at(gap.arm_i, -force);
        let mut journal = Wrench::at(gap.arm_j, force);
        bearing.moment -= self.bearing_radius * tangential;
        journal.moment += self.journal_radius * tangential;
        ForceSlopes { bearing, journal }
    }

    /// ż of the friction's inner states in a contact; zero where it has none.
    #[inline(always)]
    pub fn inner_rates(
        &self,
        contact: &Contact<S>,
        rates: &GapRates<S>,
        inner: Inner<S>,
    ) -> [Sloped<S>; MOST_INNER] {
        match (&self.friction, contact.branch) {
            (Some(friction), Some(branch)) => friction.inner_rates(branch, rates.slip, inner),
            _ => [Sloped::none(); MOST_INNER],
        }
    }
}
