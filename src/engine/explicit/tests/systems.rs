//! Systems whose motion is known in closed form.

use crate::dae::{Course, Direction, Fault, State, System, Turn, Watch};
use crate::scalar::Scalar;

/// A watch of power one.
fn watch(direction: Direction) -> Watch {
    Watch { direction, power: 1.0 }
}

/// The course of a function of value, rate and second derivative g (1, 1/s, 1/s²), beside what
/// third derivative the differences of the latter tell of.
fn course<S: Scalar>(g: [S; 3]) -> Course {
    let [value, rate, bend] = g.map(S::to_f64);
    Course { value, rate, bend: Some(bend), grain: 1.0, noise: 1e3 * S::EPSILON, ..Course::NONE }
}

/// Oscillators q̈ = −ω² q, side by side; an event where the first passes `level`.
pub struct Oscillators<S> {
    pub square: S,
    pub level: S,
    pub watches: Vec<Watch>,
    scales: (Vec<f64>, Vec<f64>),
    accelerations: Vec<S>,
    first: [S; 2],
}

impl<S: Scalar> Oscillators<S> {
    pub fn new(count: usize, omega: S, level: S, direction: Direction) -> Self {
        Oscillators {
            square: omega * omega,
            level,
            watches: vec![watch(direction)],
            scales: (vec![1.0; count], vec![omega.to_f64(); count]),
            accelerations: vec![S::zero(); count],
            first: [S::zero(); 2],
        }
    }
}

impl<S: Scalar> System<S> for Oscillators<S> {
    fn coordinates(&self) -> usize {
        self.accelerations.len()
    }
    fn multipliers(&self) -> usize {
        0
    }
    fn integrals(&self) -> usize {
        0
    }
    fn scales(&self) -> (&[f64], &[f64]) {
        (&self.scales.0, &self.scales.1)
    }
    fn evaluate(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        for (a, q) in self.accelerations.iter_mut().zip(state.q) {
            *a = -(self.square * *q);
        }
        self.first = [state.q[0], state.v[0]];
        Ok(())
    }
    fn accelerations(&self) -> &[S] {
        &self.accelerations
    }
    fn lambda(&self) -> &[S] {
        &[]
    }
    fn powers(&self) -> &[S] {
        &[]
    }
    fn watches(&self) -> &[Watch] {
        &self.watches
    }
    fn event_values(&mut self, state: State<'_, S>, values: &mut [S]) -> Result<(), Fault> {
        values[0] = state.q[0] - self.level;
        Ok(())
    }
    fn event_rate(&self, _: usize) -> S {
        self.first[1]
    }
    fn course(&self, _: usize) -> Course {
        let [q, v] = self.first;
        let [size, rate] = [q, v].map(|x| (self.square * x).abs().to_f64());
        let square = self.square.to_f64();
        let twist = [rate, square * size, square * rate];
        Course { twist, ..course([q - self.level, v, self.accelerations[0]]) }
    }
    fn project(&mut self, _: S, _: &mut [S], _: &mut [S]) -> Result<f64, Fault> {
        Ok(0.0)
    }
    fn turns(&self) -> usize {
        0
    }
    fn turn_angles(&self, _: S, _: &[S], _: &mut [S]) {}
    fn turn_rates(&self, _: S, _: &[S], _: &mut [S]) {}
}

/// A pendulum of length one in gravity one, by its angle through a turning frame, or by
/// Cartesian coordinates and a multiplier. The event is its passage through the vertical.
pub struct Pendulum<S> {
    pub cartesian: bool,
    accelerations: Vec<S>,
    lambda: Vec<S>,
    first: [S; 2],
}

impl<S: Scalar> Pendulum<S> {
    pub fn new(cartesian: bool) -> Self {
        let n = if cartesian { 2 } else { 1 };
        Pendulum {
            cartesian,
            accelerations: vec![S::zero(); n],
            lambda: vec![S::zero(); n - 1],
            first: [S::zero(); 2],
        }
    }

    /// Coordinates at an angle from the vertical.
    pub fn at(&self, angle: S) -> Vec<S> {
        let (sin, cos) = angle.sin_cos();
        if self.cartesian { vec![sin, -cos] } else { vec![angle] }
    }
}

impl<S: Scalar> System<S> for Pendulum<S> {
    fn coordinates(&self) -> usize {
        self.accelerations.len()
    }
    fn multipliers(&self) -> usize {
        self.lambda.len()
    }
    fn integrals(&self) -> usize {
        0
    }
    fn scales(&self) -> (&[f64], &[f64]) {
        let n = self.accelerations.len();
        (&[1.0; 2][..n], &[1.0; 2][..n])
    }
    fn evaluate(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        let (q, v) = (state.q, state.v);
        self.first = [q[0], v[0]];
        if self.cartesian {
            let square = q[0] * q[0] + q[1] * q[1];
            let lambda = (v[0] * v[0] + v[1] * v[1] - q[1]) / square;
            self.lambda[0] = lambda;
            self.accelerations[0] = -(lambda * q[0]);
            self.accelerations[1] = -S::one() - lambda * q[1];
        } else {
            let turn = state.carried.map_or_else(|| turn_of(q[0]), |carried| carried.turns[0]);
            self.accelerations[0] = -turn[1];
        }
        Ok(())
    }
    fn accelerations(&self) -> &[S] {
        &self.accelerations
    }
    fn lambda(&self) -> &[S] {
        &self.lambda
    }
    fn powers(&self) -> &[S] {
        &[]
    }
    fn watches(&self) -> &[Watch] {
        const FALLING: Watch = Watch { direction: Direction::Falling, power: 1.0 };
        &[FALLING]
    }
    fn event_values(&mut self, state: State<'_, S>, values: &mut [S]) -> Result<(), Fault> {
        values[0] = state.q[0];
        Ok(())
    }
    fn event_rate(&self, _: usize) -> S {
        self.first[1]
    }
    fn course(&self, _: usize) -> Course {
        let [q, v] = self.first;
        course([q, v, self.accelerations[0]])
    }
    fn project(&mut self, _: S, _: &mut [S], _: &mut [S]) -> Result<f64, Fault> {
        Ok(0.0)
    }
    fn turns(&self) -> usize {
        usize::from(!self.cartesian)
    }
    fn turn_angles(&self, _: S, q: &[S], angles: &mut [S]) {
        angles.copy_from_slice(&q[..angles.len()]);
    }
    fn turn_rates(&self, _: S, v: &[S], rates: &mut [S]) {
        rates.copy_from_slice(&v[..rates.len()]);
    }
}

fn turn_of<S: Scalar>(angle: S) -> Turn<S> {
    let (sin, cos) = angle.sin_cos();
    [cos, sin]
}

/// Balls in free flight along one line each, and a wall at depth zero that pushes with
/// K δ^(1 + 1/d) (1 + a δ̇ / v₀) once touched; the event functions are depth over `length`.
/// Integrals: what each wall has dissipated.
pub struct Balls<S> {
    pub stiffness_by_mass: S,
    /// The degree d: two for Hertz's law.
    pub degree: u32,
    /// The weight a of the damping.
    pub damping: S,
    /// Constant acceleration towards the wall (m/s²).
    pub gravity: S,
    /// Speed at impact of each ball in contact.
    pub impact: Vec<Option<S>>,
    watches: Vec<Watch>,
    length: f64,
    scales: (Vec<f64>, Vec<f64>),
    accelerations: Vec<S>,
    powers: Vec<S>,
    depths: Vec<S>,
    rates: Vec<S>,
}

impl<S: Scalar> Balls<S> {
    /// Balls in flight.
    pub fn new(count: usize, stiffness_by_mass: S, damping: S) -> Self {
        let length = 1e-3;
        Balls {
            stiffness_by_mass,
            degree: 2,
            damping,
            gravity: S::zero(),
            impact: vec![None; count],
            watches: vec![watch(Direction::Rising); count],
            length,
            scales: (vec![length; count], vec![1.0; count]),
            accelerations: vec![S::zero(); count],
            powers: vec![S::zero(); count],
            depths: vec![S::zero(); count],
            rates: vec![S::zero(); count],
        }
    }

    /// Length that the event functions are scaled by (m).
    pub fn length(&self) -> S {
        S::from_f64(self.length)
    }

    /// Switches the mode of a ball: `Some(speed at impact)` in contact.
    pub fn switch(&mut self, ball: usize, impact: Option<S>) {
        self.impact[ball] = impact;
        self.watches[ball] = match impact {
            None => watch(Direction::Rising),
            Some(_) => Watch { direction: Direction::Falling, power: 1.0 / f64::from(self.degree) },
        };
    }

    fn root(&self, depth: S) -> S {
        match self.degree {
            2 => depth.sqrt(),
            _ if depth == S::zero() => depth,
            degree => depth.powf(S::ratio(1, i64::from(degree))),
        }
    }

    fn push(&mut self, ball: usize, depth: S, root: S, rate: S) {
        self.rates[ball] = rate;
        let (mut push, mut lost) = (S::zero(), S::zero());
        if let Some(impact) = self.impact[ball] {
            let elastic = self.stiffness_by_mass * depth * root;
            let damping = elastic * self.damping * rate / impact;
            push = elastic + damping;
            lost = damping * rate;
        }
        self.accelerations[ball] = self.gravity - push;
        self.powers[ball] = lost;
    }
}

impl<S: Scalar> System<S> for Balls<S> {
    fn coordinates(&self) -> usize {
        self.impact.len()
    }
    fn multipliers(&self) -> usize {
        0
    }
    fn integrals(&self) -> usize {
        self.impact.len()
    }
    fn scales(&self) -> (&[f64], &[f64]) {
        (&self.scales.0, &self.scales.1)
    }
    fn evaluate(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        self.depths.copy_from_slice(state.q);
        for (ball, (depth, rate)) in state.q.iter().zip(state.v).enumerate() {
            let depth = depth.max(S::zero());
            self.push(ball, depth, self.root(depth), *rate);
        }
        Ok(())
    }
    fn evaluate_with_roots(
        &mut self,
        state: State<'_, S>,
        roots: &[Option<S>],
    ) -> Result<(), Fault> {
        self.evaluate(state)?;
        let root_length = self.root(self.length());
        for (ball, sigma) in roots.iter().enumerate() {
            if let Some(sigma) = sigma {
                let root = *sigma * root_length;
                let depth = (1..self.degree).fold(root, |power, _| power * root);
                self.push(ball, depth, root, state.v[ball]);
            }
        }
        Ok(())
    }
    fn accelerations(&self) -> &[S] {
        &self.accelerations
    }
    fn lambda(&self) -> &[S] {
        &[]
    }
    fn powers(&self) -> &[S] {
        &self.powers
    }
    fn watches(&self) -> &[Watch] {
        &self.watches
    }
    fn event_values(&mut self, state: State<'_, S>, values: &mut [S]) -> Result<(), Fault> {
        let length = self.length();
        for (value, depth) in values.iter_mut().zip(state.q) {
            *value = *depth / length;
        }
        Ok(())
    }
    fn event_rate(&self, k: usize) -> S {
        self.rates[k] / self.length()
    }
    fn course(&self, k: usize) -> Course {
        course([self.depths[k], self.rates[k], self.accelerations[k]].map(|x| x / self.length()))
    }
    fn project(&mut self, _: S, _: &mut [S], _: &mut [S]) -> Result<f64, Fault> {
        Ok(0.0)
    }
    fn turns(&self) -> usize {
        0
    }
    fn turn_angles(&self, _: S, _: &[S], _: &mut [S]) {}
    fn turn_rates(&self, _: S, _: &[S], _: &mut [S]) {}
}

/// A point in free flight with constant acceleration, and a circle of radius one about the
/// origin: the event is where it passes out of it.
pub struct Throw<S> {
    pub acceleration: Vec<S>,
    watches: [Watch; 1],
    state: [[S; 2]; 2],
}

impl<S: Scalar> Throw<S> {
    pub fn new(acceleration: [S; 2]) -> Self {
        Throw {
            acceleration: acceleration.to_vec(),
            watches: [watch(Direction::Rising)],
            state: [[S::zero(); 2]; 2],
        }
    }
}

impl<S: Scalar> System<S> for Throw<S> {
    fn coordinates(&self) -> usize {
        2
    }
    fn multipliers(&self) -> usize {
        0
    }
    fn integrals(&self) -> usize {
        0
    }
    fn scales(&self) -> (&[f64], &[f64]) {
        (&[1.0, 1.0], &[1.0, 1.0])
    }
    fn evaluate(&mut self, state: State<'_, S>) -> Result<(), Fault> {
        self.state = [[state.q[0], state.q[1]], [state.v[0], state.v[1]]];
        Ok(())
    }
    fn accelerations(&self) -> &[S] {
        &self.acceleration
    }
    fn lambda(&self) -> &[S] {
        &[]
    }
    fn powers(&self) -> &[S] {
        &[]
    }
    fn watches(&self) -> &[Watch] {
        &self.watches
    }
    fn event_values(&mut self, state: State<'_, S>, values: &mut [S]) -> Result<(), Fault> {
        let q = state.q;
        values[0] = (q[0] * q[0] + q[1] * q[1]).sqrt() - S::one();
        Ok(())
    }
    fn event_rate(&self, _: usize) -> S {
        let [q, v] = self.state;
        dot(q, v) / dot(q, q).sqrt()
    }
    fn course(&self, _: usize) -> Course {
        let ([q, v], a) = (self.state, [self.acceleration[0], self.acceleration[1]]);
        let half = S::from_f64(0.5);
        course([half * (dot(q, q) - S::one()), dot(q, v), dot(v, v) + dot(q, a)])
    }
    fn project(&mut self, _: S, _: &mut [S], _: &mut [S]) -> Result<f64, Fault> {
        Ok(0.0)
    }
    fn turns(&self) -> usize {
        0
    }
    fn turn_angles(&self, _: S, _: &[S], _: &mut [S]) {}
    fn turn_rates(&self, _: S, _: &[S], _: &mut [S]) {}
}

fn dot<S: Scalar>(a: [S; 2], b: [S; 2]) -> S {
    a[0] * b[0] + a[1] * b[1]
}
