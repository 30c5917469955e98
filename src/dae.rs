//! What an engine must know of a system, and what a run must know of an engine.
//!
//! A system is an index-1 DAE for coordinates q, velocities v, inner states z and multipliers λ,
//! with discrete modes that change only at events:
//!
//! ```text
//! q̇ − v                                   = 0
//! v̇ + M⁻¹ (Φ_qᵀ λ − Q(q, v, z, t; modes))  = 0
//! ż − f(q, v, z, t; modes)                 = 0
//! Φ_q v̇ − γ(q, v, t)                       = 0
//! ```
//!
//! Inner states are what forces remember: the deflection of the bristles of a friction law, say.
//! Most systems have none.
//!
//! Between two events the modes stand still and everything here is smooth, but for the power law
//! that [`Watch::power`] tells of.

use crate::plane::Vector;
use crate::scalar::{Scalar, bits};
use serde::{Deserialize, Serialize};
use std::error::Error;

/// Why a system could not be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The state is out of reach of the formulas; a state nearer to the last good one may do.
    #[error("{0}")]
    TryShorterStep(String),
    /// No step length will help.
    #[error(transparent)]
    Fatal(Box<dyn Error + Send + Sync>),
}

/// Cosine and sine of the angle of one turning frame of the system.
pub type Turn<S> = [S; 2];

/// A state at which a system is evaluated.
#[derive(Debug, Clone, Copy)]
pub struct State<'a, S> {
    /// Time (s).
    pub time: S,
    /// Coordinates, n of them (m, rad).
    pub q: &'a [S],
    /// Velocities, n of them (m/s, rad/s).
    pub v: &'a [S],
    /// Inner states, each in its own unit. Where neither forces nor event functions are asked for they
    /// do not matter.
    pub z: &'a [S],
    /// What an engine carries along; `None` has the system compute it from time and coordinates.
    pub carried: Option<Carried<'a, S>>,
}

/// Functions of time and coordinates that an engine may carry along with the state, as components
/// with rates of their own.
#[derive(Debug, Clone, Copy)]
pub struct Carried<'a, S> {
    /// Cosines and sines of the turning frames.
    pub turns: &'a [Turn<S>],
    /// The offsets (m), by x and y: small differences of large coordinates, which keep the places that
    /// the difference loses. Empty where the system is to take the differences.
    pub offsets: &'a [[S; 2]],
}

/// The way through zero at which an event function is an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Not watched in the present mode.
    Off,
    /// From below zero to above.
    Rising,
    /// From above zero to below.
    Falling,
}

/// How an event function is to be watched in the present mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watch {
    /// The way through zero that counts.
    pub direction: Direction,
    /// The solution is analytic in |g|^power beside the zero of the event function g, on the
    /// side where the function is positive: ½ for Hertz contact, 1 where nothing is lost and the
    /// equations go on smoothly beyond the zero, 0 where no power helps.
    pub power: f64,
}

/// What is known of the course of an event function g near a state.
///
/// It may be that of another function with the same sign, smoother than g: of the square of a
/// distance in place of the distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    /// Its value.
    pub value: f64,
    /// Its rate (1/s).
    pub rate: f64,
    /// Its second derivative by time (1/s²), where the system knows it.
    pub bend: Option<f64>,
    /// What turning arms and relative speeds make of its third derivative at the most: the
    /// coefficients, by powers of the time (s) from the state (1/s³, 1/s⁴, 1/s⁵). What forces add
    /// is not in it.
    pub twist: [f64; 3],
    /// What a relative error of the state makes of the value.
    pub grain: f64,
    /// The value counts as zero below this: rounding.
    pub noise: f64,
}

impl Course {
    /// Nothing to be told of.
    pub const NONE: Course =
        Course { value: 0.0, rate: 0.0, bend: None, twist: [0.0; 3], grain: 0.0, noise: 0.0 };

    /// Bound of the third derivative within a time (s) of the state.
    pub fn twist_within(&self, span: f64) -> f64 {
        let [at, first, second] = self.twist;
        at + span * (first + span * second)
    }

    /// The course of −g.
    pub fn reversed(self) -> Course {
        let bend = self.bend.map(|bend| -bend);
        Course { value: -self.value, rate: -self.rate, bend, ..self }
    }
}

/// A mechanical system, as an engine sees it.
pub trait System<S: Scalar> {
    /// Number n of coordinates, and of velocities.
    fn coordinates(&self) -> usize;

    /// Number m of multipliers.
    fn multipliers(&self) -> usize;

    /// Number of integrals that are carried along with the trajectory (works, dissipation).
    fn integrals(&self) -> usize;

    /// Typical sizes of the n coordinates (m, rad) and of the n velocities (m/s, rad/s).
    fn scales(&self) -> (&[f64], &[f64]);

    /// Number of inner states.
    fn inner_states(&self) -> usize {
        0
    }

    /// Typical sizes of the inner states, each in its own unit.
    fn inner_scales(&self) -> &[f64] {
        &[]
    }

    /// Evaluates the system at a state; the functions named `…` after this one answer for it.
    fn evaluate(&mut self, state: State<'_, S>) -> Result<(), Fault>;

    /// Evaluates the system at a state, as [`evaluate`](Self::evaluate) does, where an engine
    /// carries the root σ = g^[`power`](Watch::power) of some event functions g along with the
    /// state: `roots[k]`, with its sign, is that of function k. What the system computes from g
    /// it then takes from σ, with no look at the sign of g and none at that of σ, so that the
    /// accelerations are analytic in state and roots together. A system that has no power but one
    /// need not provide it.
    fn evaluate_with_roots(
        &mut self,
        state: State<'_, S>,
        roots: &[Option<S>],
    ) -> Result<(), Fault> {
        let _ = roots;
        self.evaluate(state)
    }

    /// v̇ at the state last evaluated (m/s², rad/s²).
    fn accelerations(&self) -> &[S];

    /// ż at the state last evaluated, each in its own unit over s.
    fn inner_rates(&self) -> &[S] {
        &[]
    }

    /// The fastest rate (1/s) at which an inner state goes to where it stays, at the state last
    /// evaluated.
    fn inner_relaxation(&self) -> f64 {
        0.0
    }

    /// λ at the state last evaluated (N, N m).
    fn lambda(&self) -> &[S];

    /// Time derivatives of the integrals at the state last evaluated (W).
    fn powers(&self) -> &[S];

    /// Whether a power changes while nothing in the motion tells of it, as where tension is cut:
    /// there elastic energy goes and no force does.
    fn powers_run_free(&self) -> bool {
        false
    }

    /// How each event function is watched in the present modes; their number never changes.
    fn watches(&self) -> &[Watch];

    /// The event functions at a state, scaled to order one; no accelerations are solved for.
    /// The value of one that is `Off` means nothing.
    fn event_values(&mut self, state: State<'_, S>, values: &mut [S]) -> Result<(), Fault>;

    /// Time derivative of event function `k` at the state last evaluated (1/s).
    fn event_rate(&self, k: usize) -> S;

    /// The course of event function `k` at the state last evaluated.
    fn course(&self, k: usize) -> Course;

    /// Moves q and v onto the constraints by the smallest mass-weighted change. Returns the
    /// largest distance (m) by which a constraint was off.
    fn project(&mut self, time: S, q: &mut [S], v: &mut [S]) -> Result<f64, Fault>;

    /// Number of turning frames.
    fn turns(&self) -> usize;

    /// Angles (rad) of the turning frames.
    fn turn_angles(&self, time: S, q: &[S], angles: &mut [S]);

    /// Angular rates (rad/s) of the turning frames.
    fn turn_rates(&self, time: S, v: &[S], rates: &mut [S]);

    /// Number of offsets that an engine may carry along.
    fn offsets(&self) -> usize {
        0
    }

    /// The offsets (m) at a state, from its coordinates and turns.
    fn offsets_at(&mut self, state: State<'_, S>, offsets: &mut [Vector<S>]) {
        let _ = (state, offsets);
    }

    /// Rates of the offsets (m/s) at the state last evaluated.
    fn offset_rates(&self, rates: &mut [Vector<S>]) {
        let _ = rates;
    }
}

/// A system that an implicit engine can solve: y = (q, v, z, λ) in double precision.
pub trait Dae: System<f64> {
    /// Residual of the four rows of the module's header at (t, y, ẏ).
    fn residual(
        &mut self,
        t: f64,
        y: &[f64],
        yp: &[f64],
        residual: &mut [f64],
    ) -> Result<(), Fault>;

    /// ∂F/∂y + c_j ∂F/∂ẏ, entry by entry.
    fn jacobian(
        &mut self,
        t: f64,
        y: &[f64],
        yp: &[f64],
        cj: f64,
        jacobian: &mut impl Entries,
    ) -> Result<(), Fault>;
}

/// A matrix that takes its entries one by one.
pub trait Entries {
    /// Adds to an entry, which is zero before.
    fn add(&mut self, row: usize, column: usize, entry: f64);
}

impl Entries for nalgebra::DMatrix<f64> {
    #[inline(always)]
    fn add(&mut self, row: usize, column: usize, entry: f64) {
        self[(row, column)] += entry;
    }
}

/// Where a step ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advance {
    /// At a time of the engine's choice, or at the end asked for.
    Stepped,
    /// At an event: [`Engine::fired`] tells which functions passed zero in their direction.
    Event,
}

/// q, v, z and the integrals at one time.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "S: Scalar", deserialize = "S: Scalar"))]
pub struct Snapshot<S> {
    /// Time (s).
    #[serde(with = "bits")]
    pub time: S,
    /// Coordinates (m, rad).
    #[serde(with = "bits::list")]
    pub q: Vec<S>,
    /// Velocities (m/s, rad/s).
    #[serde(with = "bits::list")]
    pub v: Vec<S>,
    /// Inner states, each in its own unit.
    #[serde(with = "bits::list")]
    pub z: Vec<S>,
    /// Integrals since the run began (J).
    #[serde(with = "bits::list")]
    pub integrals: Vec<S>,
}

impl<S: Clone> Clone for Snapshot<S> {
    fn clone(&self) -> Self {
        Snapshot {
            time: self.time.clone(),
            q: self.q.clone(),
            v: self.v.clone(),
            z: self.z.clone(),
            integrals: self.integrals.clone(),
        }
    }

    /// Into the space that is there, which a derived one would give back first.
    fn clone_from(&mut self, source: &Self) {
        self.time.clone_from(&source.time);
        self.q.clone_from(&source.q);
        self.v.clone_from(&source.v);
        self.z.clone_from(&source.z);
        self.integrals.clone_from(&source.integrals);
    }
}

impl<S: Scalar> Snapshot<S> {
    /// Space for n coordinates, and as many inner states and integrals as asked for, all zero.
    pub fn new(coordinates: usize, inner_states: usize, integrals: usize) -> Self {
        Snapshot {
            time: S::zero(),
            q: vec![S::zero(); coordinates],
            v: vec![S::zero(); coordinates],
            z: vec![S::zero(); inner_states],
            integrals: vec![S::zero(); integrals],
        }
    }

    /// The state, with nothing carried along.
    pub fn state(&self) -> State<'_, S> {
        State { time: self.time, q: &self.q, v: &self.v, z: &self.z, carried: None }
    }
}

/// A count that an engine keeps of its work, with the name it has in result files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count {
    /// Name, in snake case: `steps`, `residual_evaluations`.
    pub name: &'static str,
    /// How many, since the engine was made.
    pub value: u64,
}

/// Carries a system from one event to the next.
pub trait Engine<S: Scalar> {
    /// The system it solves.
    type System: System<S>;
    /// What can stop it.
    type Error: Error + Send + Sync + 'static;

    /// The system; its modes may be changed before a restart, and only then.
    fn system(&mut self) -> &mut Self::System;

    /// Begins anew at `now`, whose q and v satisfy the constraints, in the system's present modes;
    /// the integrals go on from those given.
    fn restart(&mut self, now: &Snapshot<S>) -> Result<(), Self::Error>;

    /// One step, never beyond `end` (s): to a time of the engine's choice or to the first event.
    fn step(&mut self, end: S) -> Result<Advance, Self::Error>;

    /// State at the end of the last step, or of the restart.
    fn now(&self) -> &Snapshot<S>;

    /// Time (s) at which the last step began.
    fn began(&self) -> S;

    /// State at a time within the last step, to the accuracy of the engine.
    fn within(&mut self, time: S, at: &mut Snapshot<S>) -> Result<(), Self::Error>;

    /// State near a time within the last step, to a relative accuracy; `at.time` tells where it
    /// is. Cheaper than [`Engine::within`] where landing on a time takes work.
    fn glance(&mut self, time: S, accuracy: f64, at: &mut Snapshot<S>) -> Result<(), Self::Error> {
        let _ = accuracy;
        self.within(time, at)
    }

    /// Whether a glance takes as long as a step, as without an interpolant.
    fn glances_are_steps(&self) -> bool {
        false
    }

    /// Which event functions passed zero at the end of the last step; all false if none did.
    fn fired(&self) -> &[bool];

    /// What the engine counted so far.
    fn counts(&self) -> Vec<Count>;
}
