//! The equations as the steppers see them: one vector y, one independent variable τ.
//!
//! ```text
//! y = (q, v, z, cos and sin of the turning frames, offsets, t, σ of each root carried, integrals)
//! ```
//!
//! While a contact with |δ|^p forces lasts, the solution is not analytic in t at either end of it,
//! but in a root σ = g^(1/d) of the event function g. So σ is carried as a component, the force is
//! computed from it ([`System::evaluate_with_roots`]), and the independent variable is paced by it:
//!
//! ```text
//! dt/dτ  = w = ∏ σᵢ^(dᵢ − 1)          (1 without roots: τ is the time)
//! dσᵢ/dτ = ġᵢ/dᵢ · ∏ σⱼ^(dⱼ − 1), j ≠ i
//! d·/dτ  = w · d·/dt                  for everything else
//! ```
//!
//! All of it is analytic in τ and y, from σ = 0 through the deepest point to σ = 0 again, for any
//! number of contacts at once. Where two roots are zero together the flow stands still, and it
//! creeps where they tend to zero together; the engine steps over both.

use crate::dae::{Carried, Course, Direction, Fault, State, System, Watch};
use crate::plane::Vector;
use crate::scalar::Scalar;

/// A root σ that is carried: the event function `function` is σ^degree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Root<S> {
    /// Index of the event function.
    pub function: usize,
    /// Degree d, two or more.
    pub degree: u32,
    /// 1/d.
    pub reciprocal: S,
}

impl<S: Scalar> Root<S> {
    /// A root of an event function.
    pub fn new(function: usize, degree: u32) -> Self {
        Root { function, degree, reciprocal: S::ratio(1, i64::from(degree)) }
    }
}

/// How the approach to an event is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Gauge {
    /// Not watched.
    Off,
    /// By the event function itself, with the sign that makes it rise towards the event.
    Function {
        /// Whether the event is a fall of the function.
        falling: bool,
    },
    /// By −σ of the root in this slot.
    Root {
        /// Index among the roots carried.
        slot: usize,
    },
}

/// A system, with the bookkeeping of the vector y.
pub(super) struct Flow<S, Y> {
    /// The system.
    pub system: Y,
    /// Right-hand sides evaluated.
    pub evaluations: u64,
    coordinates: usize,
    inner_states: usize,
    frames: usize,
    integrals: usize,
    roots: Vec<Root<S>>,
    gauges: Vec<Gauge>,
    root_values: Vec<Option<S>>,
    root_rates: Vec<S>,
    pace: S,
    turn_rates: Vec<S>,
    angles: Vec<S>,
    offsets: Vec<Vector<S>>,
    offset_rates: Vec<Vector<S>>,
    values: Vec<S>,
}

impl<S: Scalar, Y: System<S>> Flow<S, Y> {
    /// A flow without roots, that carries offsets if it is to be `exact`. Numbers of many digits
    /// need none, and errors of the tolerance are not to part them from the coordinates.
    pub fn new(system: Y, exact: bool) -> Self {
        let (frames, functions) = (system.turns(), system.watches().len());
        let offsets = if exact && S::EPSILON >= f64::EPSILON { system.offsets() } else { 0 };
        Flow {
            coordinates: system.coordinates(),
            inner_states: system.inner_states(),
            integrals: system.integrals(),
            frames,
            roots: Vec::new(),
            gauges: vec![Gauge::Off; functions],
            root_values: vec![None; functions],
            root_rates: vec![S::zero(); functions],
            pace: S::one(),
            turn_rates: vec![S::zero(); frames],
            angles: vec![S::zero(); frames],
            offsets: vec![Vector::zero(); offsets],
            offset_rates: vec![Vector::zero(); offsets],
            values: vec![S::zero(); functions],
            evaluations: 0,
            system,
        }
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.coordinates
    }

    /// Index of the first cosine, behind q, v and z.
    pub fn first_turn(&self) -> usize {
        2 * self.coordinates + self.inner_states
    }

    /// Index of the first offset.
    pub fn first_offset(&self) -> usize {
        self.first_turn() + 2 * self.frames
    }

    /// Index of the time.
    pub fn time(&self) -> usize {
        self.first_offset() + 2 * self.offsets.len()
    }

    /// Index of the root in `slot`.
    pub fn root(&self, slot: usize) -> usize {
        self.time() + 1 + slot
    }

    /// Number of components whose error is controlled: all but the integrals, which follow them.
    pub fn controlled(&self) -> usize {
        self.time() + 1 + self.roots.len()
    }

    /// Number of components.
    pub fn len(&self) -> usize {
        self.controlled() + self.integrals
    }

    /// The largest number of components there can be.
    pub fn capacity(&self) -> usize {
        self.time() + 1 + self.gauges.len() + self.integrals
    }

    /// The roots carried.
    pub fn roots(&self) -> &[Root<S>] {
        &self.roots
    }

    /// How the approach to each event is measured.
    pub fn gauges(&self) -> &[Gauge] {
        &self.gauges
    }

    /// The slot of the root of an event function, if it is carried.
    pub fn slot(&self, function: usize) -> Option<usize> {
        self.roots.iter().position(|root| root.function == function)
    }

    /// Takes these roots, and the system's present watches.
    pub fn carry(&mut self, roots: Vec<Root<S>>) {
        self.roots = roots;
        self.root_values.fill(None);
        for (k, watch) in self.system.watches().iter().enumerate() {
            let slot = self.roots.iter().position(|root| root.function == k);
            self.gauges[k] = match (watch.direction, slot) {
                (Direction::Off, _) => Gauge::Off,
                (_, Some(slot)) => Gauge::Root { slot },
                (direction, None) => Gauge::Function { falling: direction == Direction::Falling },
            };
        }
    }

    /// Sets cosines and sines from the angles.
    pub fn reset_turns(&mut self, y: &mut [S]) {
        let (n, first) = (self.coordinates, self.first_turn());
        self.system.turn_angles(y[self.time()], &y[..n], &mut self.angles);
        for (j, angle) in self.angles.iter().enumerate() {
            let (sin, cos) = angle.sin_cos();
            y[first + 2 * j] = cos;
            y[first + 2 * j + 1] = sin;
        }
    }

    /// Sets the offsets from coordinates and turns.
    pub fn reset_offsets(&mut self, y: &mut [S]) {
        let first = self.first_offset();
        let mut state = self.state(y);
        if let Some(carried) = &mut state.carried {
            carried.offsets = &[];
        }
        self.system.offsets_at(state, &mut self.offsets);
        for (offset, pair) in self.offsets.iter().zip(y[first..].chunks_exact_mut(2)) {
            pair.copy_from_slice(&[offset.x, offset.y]);
        }
    }

    /// The state in y, with what is carried.
    #[inline(always)]
    fn state<'a>(&self, y: &'a [S]) -> State<'a, S> {
        let n = self.coordinates;
        let (first_turn, first_offset, time) =
            (self.first_turn(), self.first_offset(), self.time());
        let carried = Carried {
            turns: y[first_turn..first_offset].as_chunks().0,
            offsets: y[first_offset..time].as_chunks().0,
        };
        let (q, v, z) = (&y[..n], &y[n..2 * n], &y[2 * n..first_turn]);
        State { time: y[time], q, v, z, carried: Some(carried) }
    }

    /// Evaluates the system at q, v, t and the turns of y alone, for its event rates.
    pub fn evaluate_without_roots(&mut self, y: &[S]) -> Result<(), Fault> {
        self.evaluations += 1;
        self.system.evaluate(self.state(y))
    }

    /// Evaluates the system at y; everything below answers for it.
    pub fn evaluate(&mut self, y: &[S]) -> Result<(), Fault> {
        self.evaluations += 1;
        let state = self.state(y);
        self.system.turn_rates(state.time, state.v, &mut self.turn_rates);
        if self.roots.is_empty() {
            self.pace = S::one();
            self.system.evaluate(state)?;
            self.system.offset_rates(&mut self.offset_rates);
            return Ok(());
        }
        let first = self.time() + 1;
        for (root, sigma) in self.roots.iter().zip(&y[first..]) {
            self.root_values[root.function] = Some(*sigma);
        }
        self.system.evaluate_with_roots(state, &self.root_values)?;
        self.system.offset_rates(&mut self.offset_rates);
        self.pace = self.pace_at(y);
        for slot in 0..self.roots.len() {
            let root = self.roots[slot];
            let rate = self.system.event_rate(root.function) * root.reciprocal;
            self.root_rates[slot] = rate * self.product(y, Some(slot));
        }
        Ok(())
    }

    /// ∏ σ^(d − 1) over all roots but the one left out.
    fn product(&self, y: &[S], left_out: Option<usize>) -> S {
        let first = self.time() + 1;
        let mut product = S::one();
        let mut bare = true;
        for (slot, root) in self.roots.iter().enumerate() {
            if Some(slot) == left_out {
                continue;
            }
            for _ in 1..root.degree {
                let sigma = y[first + slot];
                product = if bare { sigma } else { product * sigma };
                bare = false;
            }
        }
        product
    }

    /// dt/dτ at y, evaluated or not.
    pub fn pace_at(&self, y: &[S]) -> S {
        self.product(y, None)
    }

    /// d²t/dτ² at y, the place last evaluated.
    pub fn pace_rate(&self, y: &[S]) -> S {
        let first = self.time() + 1;
        let mut sum = S::zero();
        for (slot, root) in self.roots.iter().enumerate() {
            let mut term = self.root_rates[slot] * self.product(y, Some(slot));
            for _ in 2..root.degree {
                term *= y[first + slot];
            }
            sum += term * S::from_f64(f64::from(root.degree - 1));
        }
        sum
    }

    /// Hands out `scale` · dy/dτ: each component with its place in `to`.
    #[inline(always)]
    fn spread(&self, y: &[S], scale: S, to: &mut [S], put: impl Fn(&mut S, S)) {
        let n = self.coordinates;
        let paced = if self.roots.is_empty() { scale } else { scale * self.pace };
        let (positions, to) = to.split_at_mut(n);
        let (velocities, to) = to.split_at_mut(n);
        let (inner, to) = to.split_at_mut(self.inner_states);
        let (turns, to) = to.split_at_mut(2 * self.frames);
        let (offsets, to) = to.split_at_mut(2 * self.offset_rates.len());
        let (time, to) = to.split_at_mut(1);
        let (roots, integrals) = to.split_at_mut(self.roots.len());
        let each = |to: &mut [S], rates: &[S]| {
            to.iter_mut().zip(rates).for_each(|(to, rate)| put(to, paced * *rate));
        };
        each(positions, &y[n..]);
        each(velocities, self.system.accelerations());
        each(inner, self.system.inner_rates());
        let carried = y[self.first_turn()..].as_chunks().0.iter().zip(&self.turn_rates);
        for ([cos, sin], ([own_cos, own_sin], rate)) in
            turns.as_chunks_mut().0.iter_mut().zip(carried)
        {
            let rate = paced * *rate;
            put(cos, -(rate * *own_sin));
            put(sin, rate * *own_cos);
        }
        let offsets = offsets.as_chunks_mut().0;
        for ([x, y], rate) in offsets.iter_mut().zip(&self.offset_rates) {
            put(x, paced * rate.x);
            put(y, paced * rate.y);
        }
        put(&mut time[0], paced);
        roots.iter_mut().zip(&self.root_rates).for_each(|(to, rate)| put(to, scale * *rate));
        each(integrals, self.system.powers());
    }

    /// dy/dτ at y, the place last evaluated.
    pub fn rates_here(&self, y: &[S], rates: &mut [S]) {
        self.spread(y, S::one(), rates, |to, rate| *to = rate);
    }

    /// dy/dτ at y.
    pub fn rates(&mut self, y: &[S], rates: &mut [S]) -> Result<(), Fault> {
        self.evaluate(y)?;
        self.rates_here(y, rates);
        Ok(())
    }

    /// Adds `step` · dy/dτ at y to `sum`.
    pub fn add_rates(&mut self, y: &[S], step: S, sum: &mut [S]) -> Result<(), Fault> {
        self.evaluate(y)?;
        self.spread(y, step, sum, |to, rate| *to += rate);
        Ok(())
    }

    /// Event functions at y, as the system has them.
    pub fn event_values(&mut self, y: &[S]) -> Result<&[S], Fault> {
        self.system.event_values(self.state(y), &mut self.values)?;
        Ok(&self.values)
    }

    /// The approach to each event at y: it rises through zero at the event. Zero for those that
    /// are not watched.
    pub fn approaches(&mut self, y: &[S], approaches: &mut [S]) -> Result<(), Fault> {
        if self.gauges.iter().any(|gauge| matches!(gauge, Gauge::Function { .. })) {
            self.event_values(y)?;
        }
        let first = self.time() + 1;
        for (k, gauge) in self.gauges.iter().enumerate() {
            approaches[k] = match *gauge {
                Gauge::Off => S::zero(),
                Gauge::Function { falling: false } => self.values[k],
                Gauge::Function { falling: true } => -self.values[k],
                Gauge::Root { slot } => -y[first + slot],
            };
        }
        Ok(())
    }

    /// Rate of the approach (per unit of τ) to event `k` at the place last evaluated.
    pub fn approach_rate(&self, k: usize) -> S {
        match self.gauges[k] {
            Gauge::Off => S::zero(),
            Gauge::Function { falling } => {
                let rate = self.system.event_rate(k) * self.pace;
                if falling { -rate } else { rate }
            }
            Gauge::Root { slot } => -self.root_rates[slot],
        }
    }

    /// The course of the approach to event `k` at y, the place last evaluated: by time, that of a
    /// root by τ.
    pub fn course(&self, y: &[S], k: usize) -> Course {
        match self.gauges[k] {
            Gauge::Off => Course::NONE,
            Gauge::Function { falling: false } => self.system.course(k),
            Gauge::Function { falling: true } => self.system.course(k).reversed(),
            Gauge::Root { slot } => Course {
                value: -y[self.root(slot)].to_f64(),
                rate: -self.root_rates[slot].to_f64(),
                grain: 1.0,
                ..Course::NONE
            },
        }
    }

    /// The degree of the root in which the solution is analytic beside the end of what is watched
    /// here, if there is one: a falling function, and a power that is one over an integer.
    pub fn degree(watch: Watch) -> Option<u32> {
        let degree = (1.0 / watch.power).round();
        let whole = (degree * watch.power - 1.0).abs() < 1e-9 && (2.0..=16.0).contains(&degree);
        (watch.direction == Direction::Falling && whole).then_some(degree as u32)
    }
}
