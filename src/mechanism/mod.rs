//! The checked mechanism as a system of equations: residual, Jacobian, event functions,
//! accelerations, consistent start.

mod balance;
mod dae;
mod layout;
mod ledger;
mod measure;
mod modes;
mod observation;
mod observe;
mod place;
mod project;
mod redundant;
mod rub;
mod start;
mod system;

pub use ledger::Ledger;
pub use measure::{Measure, Measures};
pub use observation::*;
pub use project::OpenJoint;
pub use rub::Jammed;
pub use system::{ContactRates, SingularPosition};

use crate::clearance::{Clearance, ContactForce, EventSlot, Gap, GapRates, Mode};
use crate::dae::{Direction, Snapshot, State, Watch};
use crate::friction::{FrictionLaw, Inner, MOST_INNER};
use crate::joint::{Arms, Blocks, MOST_BODIES, Relation};
use crate::linear::Symmetric;
use crate::load::Load;
use crate::model::{Complaint, Model, Owner};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::Scalar;
use layout::{Layout, Role};
use measure::ForceSource;
use redundant::Idle;
use rub::{Rubbed, Rubbing};
use std::ops::Range;

/// A mechanism with its modes, evaluated at one state at a time.
#[derive(Debug, Clone)]
pub struct Mechanism<S> {
    model: Model<S>,
    layout: Layout<S>,
    ledger: Ledger,
    /// One over mass and inertia, by place in v.
    inverse_masses: Vec<S>,
    modes: Vec<Mode<S>>,
    slots: Vec<(usize, EventSlot)>,
    /// Loads with two event functions each, behind those of the clearances.
    gates: Vec<usize>,
    /// Event function of the depth, by clearance.
    depth_slots: Vec<usize>,
    /// c^power, by clearance: δ^power over the root of the event function δ/c.
    radial_roots: Vec<S>,
    watches: Vec<Watch>,
    start: Snapshot<S>,
    start_energy: S,
    start_accuracy: f64,
    /// Where journals, blocks and pins are to start, by joint with clearance: what Φ of the ideal joint
    /// is to be (m, rad); empty for the middle.
    wished_offsets: Vec<[S; 2]>,
    coordinate_scales: Vec<f64>,
    velocity_scales: Vec<f64>,
    /// Places in z of the inner states of each clearance's friction.
    inner_places: Vec<Range<usize>>,
    /// Place in z of what each load remembers, where it does.
    load_places: Vec<Option<usize>>,
    inner_scales: Vec<f64>,
    length: f64,
    /// Where the force of each joint stands.
    force_sources: Vec<ForceSource>,
    /// Friction in ideal joints.
    rubbings: Vec<Rubbing<S>>,
    /// Mobility of each clearance along and across the line of centres (1/kg); `None` before a wall,
    /// where it changes.
    mobilities: Vec<Option<[f64; 2]>>,
    /// Square of the fastest pace (rad²/s²) that loads and courses give.
    given_pace: f64,
    /// How many constraint rows follow from the others.
    redundant: usize,
    /// What makes a force of each row's multiplier (1/m of angles); found where rows follow from others.
    row_lengths: Vec<f64>,
    now: Evaluation<S>,
}

/// A contact as it was evaluated.
#[derive(Debug, Clone, Copy)]
struct Touch<S> {
    gap: Gap<S>,
    rates: GapRates<S>,
    force: ContactForce<S>,
}

/// Everything known at the state last evaluated. Lists by body have the ground first.
#[derive(Debug, Clone)]
struct Evaluation<S> {
    time: S,
    poses: Vec<Pose<S>>,
    motions: Vec<Motion<S>>,
    /// Offsets of the journals, by clearance, where an engine carries them; else empty.
    offsets: Vec<Vector<S>>,
    accelerations: Vec<Motion<S>>,
    /// Loads, contact forces and, once solved, joint forces, by body.
    wrenches: Vec<Wrench<S>>,
    /// By clearance; `None` in flight.
    touches: Vec<Option<Touch<S>>>,
    /// v̇ by place in v.
    v_dot: Vec<S>,
    /// Inner states, and their rates.
    z: Vec<S>,
    z_dot: Vec<S>,
    /// The fastest relaxation of an inner state (1/s).
    relaxation: f64,
    lambda: Vec<S>,
    powers: Vec<S>,
    /// Arms of each constraint's points.
    arms: Vec<Arms<S>>,
    /// Φ_q by row: its blocks for the bodies of the constraint.
    jacobian: Vec<Blocks<S>>,
    /// Φ_q M⁻¹ Φ_qᵀ, later its factors.
    matrix: Symmetric<S>,
    /// Directions in which multipliers do nothing, as last factored.
    idle: Idle<S>,
    /// Friction in ideal joints, once evaluated.
    rubbed: Vec<Rubbed<S>>,
    /// Force and torque of each driven body's joint and drive on that body.
    driving: Vec<(Vector<S>, S)>,
}

impl<S: Scalar> Evaluation<S> {
    fn new(model: &Model<S>, layout: &Layout<S>, inner_states: usize) -> Self {
        let bodies = model.masses().len();
        let clearances = model.clearances().len();
        Evaluation {
            time: S::zero(),
            poses: vec![Pose::fixed(); bodies],
            motions: vec![Motion::rest(); bodies],
            offsets: Vec::with_capacity(clearances),
            accelerations: vec![Motion::rest(); bodies],
            wrenches: vec![Wrench::none(); bodies],
            touches: vec![None; clearances],
            v_dot: vec![S::zero(); layout.coordinates],
            z: vec![S::zero(); inner_states],
            z_dot: vec![S::zero(); inner_states],
            relaxation: 0.0,
            lambda: vec![S::zero(); layout.rows],
            powers: vec![S::zero(); Ledger::of(model).len()],
            arms: vec![[Vector::zero(); 2]; layout.constraints.len()],
            jacobian: vec![[[S::zero(); 3]; MOST_BODIES]; layout.rows],
            matrix: layout.matrix.clone(),
            idle: Idle::none(),
            rubbed: Vec::new(),
            driving: vec![(Vector::zero(), S::zero()); layout.driven.len()],
        }
    }
}

impl<S: Scalar> Evaluation<S> {
    /// The journal of clearance `k` in its bearing.
    #[inline(always)]
    fn gap(&self, k: usize, clearance: &Clearance<S>) -> Gap<S> {
        clearance.gap(&self.poses, &self.motions, self.offsets.get(k).copied())
    }
}

impl<S: Scalar> Mechanism<S> {
    /// Forms the equations of a model and assembles its start.
    ///
    /// # Errors
    /// Joints that hold too much, do not close, or stand in a singular position.
    pub fn new(model: Model<S>) -> Result<Self, Vec<Complaint>> {
        Mechanism::with_journals_at(model, &[])
    }

    /// The same with journals that start as near as can be to places in their bearings, by joint with
    /// clearance: what the two rows of the ideal joint's Φ are to be, offsets (m, fixed frame) of
    /// a journal, offset and tilt (m, rad) of a block; none for the middle.
    ///
    /// # Errors
    /// See [`Mechanism::new`].
    pub fn with_journals_at(model: Model<S>, offsets: &[[f64; 2]]) -> Result<Self, Vec<Complaint>> {
        let layout = Layout::new(&model)?;
        let mut inverse_masses = Vec::with_capacity(layout.coordinates);
        for (body, role) in layout.roles.iter().enumerate() {
            if let Role::Free(_) = role {
                let (mass, inertia) = (model.masses()[body], model.inertias()[body]);
                let inverse = S::one() / mass;
                inverse_masses.extend([inverse, inverse, S::one() / inertia]);
            }
        }
        let slots: Vec<(usize, EventSlot)> = (model.clearances().iter().enumerate())
            .flat_map(|(k, clearance)| {
                clearance.event_slots().into_iter().map(move |slot| (k, slot))
            })
            .collect();
        let (inner_places, load_places, inner_scales) = inner_places(&model);
        let depth_slots = (0..slots.len()).filter(|slot| slots[*slot].1 == EventSlot::Depth);
        let mut mechanism = Mechanism {
            depth_slots: depth_slots.collect(),
            radial_roots: model.clearances().iter().map(radial_root).collect(),
            now: Evaluation::new(&model, &layout, inner_scales.len()),
            start: Snapshot::new(layout.coordinates, inner_scales.len(), Ledger::of(&model).len()),
            ledger: Ledger::of(&model),
            start_energy: S::zero(),
            start_accuracy: 0.0,
            modes: vec![Mode::Flight; model.clearances().len()],
            slots,
            gates: (0..model.loads().len()).filter(|k| model.loads()[*k].has_gate()).collect(),
            watches: Vec::new(),
            inverse_masses,
            coordinate_scales: Vec::new(),
            velocity_scales: Vec::new(),
            wished_offsets: offsets.iter().map(|offset| offset.map(S::from_f64)).collect(),
            inner_places,
            load_places,
            inner_scales,
            length: 1.0,
            force_sources: measure::force_sources(&model, &layout),
            mobilities: measure::mobilities(&model, &layout),
            given_pace: measure::given_pace(&model, &layout),
            redundant: 0,
            row_lengths: Vec::new(),
            rubbings: rub::rubbings(&model, &layout),
            model,
            layout,
        };
        mechanism.start.z.copy_from_slice(mechanism.model.memories());
        mechanism.assemble()?;
        Ok(mechanism)
    }

    /// The model.
    pub fn model(&self) -> &Model<S> {
        &self.model
    }

    /// The assembled start: coordinates, from [`Model::origin`], velocities and inner states at t = 0,
    /// integrals zero.
    pub fn start(&self) -> &Snapshot<S> {
        &self.start
    }

    /// Where each integral stands.
    pub fn ledger(&self) -> Ledger {
        self.ledger
    }

    /// Times (s) at which a derivative of what is prescribed jumps, in their order, each with whose it is:
    /// engines begin anew there.
    pub fn corners(&self) -> Vec<(S, Owner)> {
        let drives = self.model.drives().iter().enumerate();
        let drives = drives.map(|(k, drive)| (Owner::Drive(k), &drive.course));
        let loads = self.model.loads().iter().enumerate();
        let loads = loads.filter_map(|(k, load)| Some((Owner::Load(k), load.course()?)));
        let all = drives.chain(loads);
        let mut corners: Vec<(S, Owner)> = all
            .flat_map(|(owner, course)| course.corners().iter().map(move |time| (*time, owner)))
            .collect();
        corners.sort_by(|(a, _), (b, _)| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        corners
    }

    /// Mode of each clearance.
    pub fn modes(&self) -> &[Mode<S>] {
        &self.modes
    }

    /// Number of freedoms left by the ideal joints and drives (paper, eq. 16, less the driven
    /// bodies).
    pub fn freedoms(&self) -> usize {
        (self.layout.coordinates + self.redundant).saturating_sub(self.layout.rows)
    }

    /// Whether a body moves as the drives prescribe; bodies count from 0, without the ground.
    pub fn is_driven(&self, body: usize) -> bool {
        self.layout.roles[body + 1] == Role::Driven
    }

    /// Characteristic length of the mechanism (m): the largest distance of a joint's point from
    /// its body's mass centre.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Time (s) of a revolution, or of a period, of the first drive; `None` without one that comes
    /// round.
    pub fn revolution(&self) -> Option<f64> {
        self.model.drives().first().and_then(|drive| drive.course.period())
    }

    /// Whether friction hangs on the forces of ideal joints.
    pub fn rubs(&self) -> bool {
        !self.rubbings.is_empty()
    }

    /// The largest angular rate of any body at the state last evaluated, or of any drive later
    /// (rad/s); a travel counts over the mechanism's length.
    pub fn fastest_turn(&self) -> f64 {
        let bodies = self.now.motions.iter().map(|m| m.angular.abs().to_f64());
        let drives = self.model.drives().iter().map(|drive| {
            let turns = matches!(self.model.joints()[drive.joint].relation, Relation::Revolute(_));
            drive.course.fastest() / if turns { 1.0 } else { self.length }
        });
        bodies.chain(drives).fold(0.0, f64::max)
    }

    /// What event function `slot` watches: the clearance and what of it; `None` where it is the
    /// place at which a load changes its formula.
    pub fn slot(&self, slot: usize) -> Option<(usize, EventSlot)> {
        self.slots.get(slot).copied()
    }

    /// What event function `slot` belongs to.
    pub fn owner(&self, slot: usize) -> Owner {
        match self.slots.get(slot) {
            Some((k, _)) => Owner::Clearance(*k),
            None => Owner::Load(self.gates[(slot - self.slots.len()) / 2]),
        }
    }

    /// Its key.
    pub fn watched(&self, slot: usize) -> String {
        match self.owner(slot) {
            Owner::Load(load) => format!("loads.{}", self.model.load_name(load)),
            owner => owner.key(self.model.names()).to_string(),
        }
    }

    /// Puts loads whose formulas change at places between those where they stand, as placed. Where
    /// nothing is integrated they follow at each evaluation.
    pub fn pass_gates(&mut self) {
        if self.gates.is_empty() || (self.freedoms() == 0 && self.modes.is_empty()) {
            return;
        }
        for load in &self.gates {
            self.model.loads_mut()[*load].pass(&self.now.poses, &self.now.motions);
        }
        self.watch();
    }

    /// The same at a state.
    pub fn pass_gates_at(&mut self, state: State<'_, S>) {
        self.place(&state);
        self.pass_gates();
    }

    /// Value, rate (1/s) and size of the event function of a load's place.
    fn gate(&self, slot: usize) -> Option<(S, S, S)> {
        let (load, ahead) = (self.gates[slot / 2], slot % 2 == 1);
        let gate = self.model.loads()[load].gate(&self.now.poses, &self.now.motions)?;
        match ahead {
            false => gate.above.map(|value| (value, gate.rate, gate.reach)),
            true => gate.below.map(|value| (value, -gate.rate, gate.reach)),
        }
    }

    /// Sets the mode of a clearance.
    pub fn set_mode(&mut self, clearance: usize, mode: Mode<S>) {
        self.modes[clearance] = mode;
        self.watch();
    }

    /// Puts to zero what is remembered of contacts that have ended: bristles that nothing touches
    /// are straight.
    pub fn release(&self, z: &mut [S]) {
        for (mode, places) in self.modes.iter().zip(&self.inner_places) {
            if let Mode::Flight = mode {
                z[places.clone()].fill(S::zero());
            }
        }
    }

    /// Brings the watches in line with the modes.
    fn watch(&mut self) {
        let (model, modes) = (&self.model, &self.modes);
        let watch =
            |(k, slot): &(usize, EventSlot)| model.clearances()[*k].watch(&modes[*k], *slot);
        self.watches = self.slots.iter().map(watch).collect();
        let gates = (0..2 * self.gates.len()).map(|slot| match self.gate(slot) {
            Some(_) => Watch { direction: Direction::Falling, power: 1.0 },
            None => Watch { direction: Direction::Off, power: 1.0 },
        });
        let gates: Vec<Watch> = gates.collect();
        self.watches.extend(gates);
    }

    /// Switches the mode of the clearance that event function `slot` belongs to, as the state
    /// last evaluated has it; or has a load pass the
    /// place that it watches.
    pub fn switch(&mut self, slot: usize) {
        let Some((k, what)) = self.slot(slot) else {
            let gate = slot - self.slots.len();
            self.model.loads_mut()[self.gates[gate / 2]].pass_one(gate % 2 == 1);
            return self.watch();
        };
        let clearance = &self.model.clearances()[k];
        let gap = self.now.gap(k, clearance);
        let mode = clearance.switched(&self.modes[k], what, &gap, || {
            let (motions, accelerations) = (&self.now.motions, &self.now.accelerations);
            let rates = clearance.rates(&gap, motions);
            (rates, clearance.second_rates(&gap, &rates, motions, accelerations).1)
        });
        self.set_mode(k, mode);
    }
}

/// Places in z of the inner states of each clearance's friction and of each load, and the sizes of all
/// of them.
fn inner_places<S: Scalar>(model: &Model<S>) -> (Vec<Range<usize>>, Vec<Option<usize>>, Vec<f64>) {
    let mut sizes = Vec::new();
    let place = |clearance: &Clearance<S>| {
        let first = sizes.len();
        sizes.extend(clearance.friction.iter().flat_map(FrictionLaw::inner_scales));
        first..sizes.len()
    };
    let clearances = model.clearances().iter().map(place).collect();
    let place = |load: &Load<S>| {
        sizes.push(load.inner_scale()?);
        Some(sizes.len() - 1)
    };
    let loads = model.loads().iter().map(place).collect();
    (clearances, loads, sizes)
}

/// The inner states at some places in z; those that are not there are zero.
#[inline(always)]
fn inner_states<S: Scalar>(z: &[S], places: &Range<usize>) -> Inner<S> {
    let mut inner = [S::zero(); MOST_INNER];
    inner[..places.len()].copy_from_slice(&z[places.clone()]);
    inner
}

/// c^power, with the power in which the contact law is smooth.
fn radial_root<S: Scalar>(clearance: &Clearance<S>) -> S {
    match (1.0 / clearance.normal.smooth_power()).round() {
        q if q == 1.0 || q.is_infinite() => clearance.radial,
        2.0 => clearance.radial.sqrt(),
        q => clearance.radial.powf(S::one() / S::from_f64(q)),
    }
}
