//! Flight or contact: what a clearance joint remembers, and the events that change it.
//!
//! The force follows the mode, never the sign of δ: in flight it is zero even at δ > 0 (the last
//! places before an event), in contact δ < 0 counts as 0. At δ = 0 the force is zero on both
//! sides, so nothing jumps but the mode.

use super::{Clearance, Gap, GapRates};
use crate::contact::Penetration;
use crate::dae::{Direction, Watch};
use crate::friction::{Branch, FrictionLaw, Inner, MOST_INNER, Sloped};
use crate::scalar::{Scalar, bits};
use serde::{Deserialize, Serialize};

/// Edges that inner states may be beyond, one after the other.
const MOST_CROSSINGS: usize = 8;

/// What a contact remembers of its begin and of its present branch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "S: Scalar", deserialize = "S: Scalar"))]
pub struct Contact<S> {
    /// Penetration rate at the begin (m/s), as it was.
    #[serde(with = "bits")]
    pub impact_rate: S,
    /// One over the rate that scales the damping (s/m): the impact rate, raised to the smallest
    /// one allowed.
    #[serde(with = "bits")]
    pub inverse_impact_rate: S,
    /// Branch of the friction law, if there is friction.
    pub branch: Option<Branch>,
    /// Whether the normal law gives a negative force.
    pub pulling: bool,
}

/// The discrete mode of a clearance joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "S: Scalar", deserialize = "S: Scalar"))]
pub enum Mode<S> {
    /// No contact, no force.
    Flight,
    /// Contact.
    Contact(Contact<S>),
}

/// What an event function of a clearance joint watches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventSlot {
    /// δ/c.
    Depth,
    /// The slip above the lower edge of its branch, in units of the law's own.
    LowerEdge,
    /// The slip below the upper edge of its branch, in units of the law's own.
    UpperEdge,
    /// An edge of the branch in which the inner states of the friction have a say, by number.
    InnerEdge(u8),
    /// Negative where the law pulls: 1 + a δ̇/δ̇⁽⁻⁾, or what other laws have for it.
    Pull,
}

impl<S: Scalar> Clearance<S> {
    /// The event functions this joint has, whatever its mode.
    pub fn event_slots(&self) -> Vec<EventSlot> {
        let mut slots = vec![EventSlot::Depth];
        if let Some(friction) = &self.friction {
            slots.extend([EventSlot::LowerEdge, EventSlot::UpperEdge]);
            slots.extend((0..friction.inner_edges()).map(EventSlot::InnerEdge));
        }
        // pulling changes the force where tension is cut, and ends friction in any case
        let matters = self.cut_tension || self.friction.is_some();
        if matters && self.normal.can_pull() {
            slots.push(EventSlot::Pull);
        }
        slots
    }

    /// A contact that begins at a depth (m), a rate (m/s) and a slip (m/s), with the slip's acceleration
    /// (m/s²).
    pub fn begin(&self, depth: S, rate: S, slip: S, slip_acceleration: S) -> Contact<S> {
        self.begun_at(rate, depth, rate, slip, slip_acceleration)
    }

    /// A contact that began at a rate (m/s), at the depth (m), the rate and the slip (m/s) that it has
    /// come to, with the slip's acceleration (m/s²).
    pub fn begun_at(
        &self,
        impact_rate: S,
        depth: S,
        rate: S,
        slip: S,
        slip_acceleration: S,
    ) -> Contact<S> {
        let inverse_impact_rate = S::one() / impact_rate.max(self.minimum_impact_rate);
        let pressing = self.normal.pressing(Penetration { depth, rate, inverse_impact_rate });
        Contact {
            impact_rate,
            inverse_impact_rate,
            branch: self.friction.map(|friction| friction.branch(slip, slip_acceleration)),
            pulling: pressing < S::zero(),
        }
    }

    /// Brings the branch of the friction of a contact that has gone on for a while in line with its slip
    /// (m/s) and with what it remembers: edges beyond which these are have been crossed.
    pub fn recall(&self, contact: &mut Contact<S>, slip: S, inner: Inner<S>) {
        let Some(friction) = self.friction else { return };
        for _ in 0..MOST_CROSSINGS {
            let Some(branch) = contact.branch else { return };
            let beyond = |edge: &u8| {
                let away = friction.inner_edge(branch, *edge, slip, inner);
                away.is_some_and(|away| away.value < S::zero())
            };
            let Some(edge) = (0..friction.inner_edges()).find(beyond) else { return };
            contact.branch = Some(friction.across(branch, edge));
        }
    }

    /// How an event function is watched in a mode.
    pub fn watch(&self, mode: &Mode<S>, slot: EventSlot) -> Watch {
        let (direction, power) = match (mode, slot) {
            (Mode::Flight, EventSlot::Depth) => (Direction::Rising, 1.0),
            (Mode::Flight, _) => (Direction::Off, 1.0),
            (Mode::Contact(_), EventSlot::Depth) => {
                (Direction::Falling, self.normal.smooth_power())
            }
            (Mode::Contact(contact), EventSlot::Pull) if contact.pulling => {
                (Direction::Rising, 1.0)
            }
            (Mode::Contact(_), EventSlot::Pull) => (Direction::Falling, 1.0),
            (Mode::Contact(contact), EventSlot::InnerEdge(edge)) => {
                match self.inner_edge(contact, edge, S::zero(), [S::zero(); MOST_INNER]) {
                    Some(_) => (Direction::Falling, 1.0),
                    None => (Direction::Off, 1.0),
                }
            }
            (Mode::Contact(contact), edge) => match self.edge(contact, edge) {
                Some(_) => (Direction::Falling, 1.0),
                None => (Direction::Off, 1.0),
            },
        };
        Watch { direction, power }
    }

    /// The finite edge (m/s) of the present branch of friction on one side.
    fn edge(&self, contact: &Contact<S>, slot: EventSlot) -> Option<S> {
        let (lower, upper) = self.friction?.edges(contact.branch?);
        Some(if slot == EventSlot::LowerEdge { lower } else { upper }).filter(|e| e.is_finite())
    }

    /// How far the present branch of friction is from an edge in which inner states have a say.
    pub(super) fn inner_edge(
        &self,
        contact: &Contact<S>,
        edge: u8,
        slip: S,
        inner: Inner<S>,
    ) -> Option<Sloped<S>> {
        self.friction?.inner_edge(contact.branch?, edge, slip, inner)
    }

    /// Value of an event function, with the inner states of the friction. `rates` is asked for only in contact, where e > 0.
    #[inline(always)]
    pub fn event_value(
        &self,
        mode: &Mode<S>,
        slot: EventSlot,
        gap: &Gap<S>,
        inner: Inner<S>,
        rates: impl FnOnce() -> GapRates<S>,
    ) -> S {
        match (mode, slot) {
            (_, EventSlot::Depth) => gap.depth / self.radial,
            (Mode::Flight, _) => S::one(),
            (Mode::Contact(contact), EventSlot::Pull) => {
                self.normal.pressing(self.penetration(contact, gap, rates().rate))
            }
            (Mode::Contact(contact), EventSlot::InnerEdge(edge)) => {
                let within = self.inner_edge(contact, edge, rates().slip, inner);
                within.map_or(S::one(), |within| within.value)
            }
            (Mode::Contact(contact), edge) => match (self.edge(contact, edge), &self.friction) {
                (Some(at), Some(friction)) => {
                    let above = (rates().slip - at) / friction.slip_scale();
                    if edge == EventSlot::LowerEdge { above } else { -above }
                }
                _ => S::one(),
            },
        }
    }

    /// Time derivative (1/s) of the event function of the depth.
    #[inline(always)]
    pub fn depth_event_rate(&self, rates: &GapRates<S>) -> S {
        rates.rate / self.radial
    }

    /// Time derivative (1/s) of an event function, from δ̈ and v̇_T (m/s²), with the inner states of
    /// the friction.
    pub fn event_rate(
        &self,
        mode: &Mode<S>,
        slot: EventSlot,
        gap: &Gap<S>,
        inner: Inner<S>,
        rates: &GapRates<S>,
        second: (S, S),
    ) -> S {
        match (mode, slot) {
            (_, EventSlot::Depth) => self.depth_event_rate(rates),
            (Mode::Flight, _) => S::zero(),
            (Mode::Contact(contact), EventSlot::Pull) => {
                self.normal.pressing_rate(self.penetration(contact, gap, rates.rate), second.0)
            }
            (Mode::Contact(contact), EventSlot::InnerEdge(edge)) => {
                let bends = self.inner_rates(contact, rates, inner).map(|bend| bend.value);
                let within = self.inner_edge(contact, edge, rates.slip, inner);
                within.map_or(S::zero(), |within| within.rate(second.1, bends))
            }
            (Mode::Contact(contact), edge) => match (self.edge(contact, edge), &self.friction) {
                (Some(_), Some(friction)) => {
                    let above = second.1 / friction.slip_scale();
                    if edge == EventSlot::LowerEdge { above } else { -above }
                }
                _ => S::zero(),
            },
        }
    }

    /// The mode after an event function has fired at a state. `rates` is asked for only where
    /// e > 0; the acceleration of the slip (m/s²) comes with them.
    pub fn switched(
        &self,
        mode: &Mode<S>,
        slot: EventSlot,
        gap: &Gap<S>,
        rates: impl FnOnce() -> (GapRates<S>, S),
    ) -> Mode<S> {
        match (mode, slot) {
            (Mode::Flight, EventSlot::Depth) => {
                let (rates, slip_acceleration) = rates();
                Mode::Contact(self.begin(gap.depth, rates.rate, rates.slip, slip_acceleration))
            }
            (Mode::Contact(_), EventSlot::Depth) | (Mode::Flight, _) => Mode::Flight,
            (Mode::Contact(contact), EventSlot::Pull) => {
                Mode::Contact(Contact { pulling: !contact.pulling, ..*contact })
            }
            (Mode::Contact(contact), EventSlot::InnerEdge(edge)) => {
                let branch = contact.branch.zip(self.friction);
                let branch = branch.map(|(branch, law)| law.across(branch, edge));
                Mode::Contact(Contact { branch, ..*contact })
            }
            (Mode::Contact(contact), edge) => {
                let (slip, upward) = (rates().0.slip, edge == EventSlot::UpperEdge);
                let branch = (contact.branch.zip(self.friction))
                    .map(|(branch, law)| law.beyond(branch, upward, slip));
                Mode::Contact(Contact { branch, ..*contact })
            }
        }
    }
}
