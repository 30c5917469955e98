//! Small systems with known solutions, shared by the tests of the engines.

use crate::dae::{Course, Dae, Entries, Fault, State, System, Watch};
use crate::scalar::Scalar;

/// One constraint Φ(q) = 0 at a state.
pub(crate) struct Constraint {
    /// Φ.
    pub(crate) value: f64,
    /// Φ_q.
    pub(crate) gradient: Vec<f64>,
    /// γ in Φ_q v̇ = γ.
    pub(crate) bias: f64,
}

/// The formulas of a system of unit masses with at most one constraint.
pub(crate) trait Formulas {
    /// Typical sizes of coordinates and of velocities.
    fn scales(&self) -> (Vec<f64>, Vec<f64>);

    /// Forces Q, one a coordinate (N).
    fn forces(&mut self, t: f64, q: &[f64], v: &[f64], forces: &mut [f64]) -> Result<(), Fault>;

    /// The constraint, if there is one.
    fn constraint(&self, _q: &[f64], _v: &[f64]) -> Option<Constraint> {
        None
    }

    /// Number of integrals.
    fn integrals(&self) -> usize {
        0
    }

    /// Powers, one an integral (W).
    fn powers(&self, _t: f64, _q: &[f64], _v: &[f64], _powers: &mut [f64]) {}

    /// The event functions' watches in the present mode.
    fn watches(&self) -> Vec<Watch> {
        Vec::new()
    }

    /// The event functions.
    fn events(&mut self, _t: f64, _q: &[f64], _v: &[f64], _g: &mut [f64]) -> Result<(), Fault> {
        Ok(())
    }
}

/// A system made of formulas.
pub(crate) struct Sample<F> {
    pub(crate) formulas: F,
    scales: (Vec<f64>, Vec<f64>),
    multipliers: usize,
    accelerations: Vec<f64>,
    lambda: Vec<f64>,
    powers: Vec<f64>,
    watches: Vec<Watch>,
    courses: Vec<Course>,
}

/// Time (s) over which the rates of event functions are taken.
const MOMENT: f64 = 1e-6;

impl<F: Formulas> Sample<F> {
    pub(crate) fn new(formulas: F) -> Self {
        let scales = formulas.scales();
        let n = scales.0.len();
        let multipliers = usize::from(formulas.constraint(&scales.0, &scales.1).is_some());
        Sample {
            multipliers,
            accelerations: vec![0.0; n],
            lambda: vec![0.0; multipliers],
            powers: vec![0.0; formulas.integrals()],
            watches: formulas.watches(),
            courses: vec![Course::NONE; formulas.watches().len()],
            scales,
            formulas,
        }
    }

    /// Values and rates of the event functions: at a state, and a moment before and after it.
    fn chart(&mut self, State { time, q, v, .. }: State<'_, f64>) -> Result<(), Fault> {
        let mut values = [-MOMENT, 0.0, MOMENT].map(|_| vec![0.0; self.courses.len()]);
        for (moment, values) in [-MOMENT, 0.0, MOMENT].into_iter().zip(&mut values) {
            let along = |x: &[f64], rates: &[f64]| -> Vec<f64> {
                x.iter().zip(rates).map(|(x, rate)| x + moment * rate).collect()
            };
            let (q, v) = (along(q, v), along(v, &self.accelerations));
            self.formulas.events(time + moment, &q, &v, values)?;
        }
        let [before, now, after] = values;
        for (k, course) in self.courses.iter_mut().enumerate() {
            let rate = (after[k] - before[k]) / (2.0 * MOMENT);
            *course = Course { value: now[k], rate, grain: 1.0, noise: 1e-13, ..Course::NONE };
        }
        Ok(())
    }

    /// Changes the mode that the formulas are in.
    pub(crate) fn switch(&mut self, change: impl FnOnce(&mut F)) {
        change(&mut self.formulas);
        self.watches = self.formulas.watches();
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl<F: Formulas> System<f64> for Sample<F> {
    fn coordinates(&self) -> usize {
        self.accelerations.len()
    }

    fn multipliers(&self) -> usize {
        self.multipliers
    }

    fn integrals(&self) -> usize {
        self.powers.len()
    }

    fn scales(&self) -> (&[f64], &[f64]) {
        (&self.scales.0, &self.scales.1)
    }

    fn evaluate(&mut self, state: State<'_, f64>) -> Result<(), Fault> {
        let State { time, q, v, .. } = state;
        self.formulas.forces(time, q, v, &mut self.accelerations)?;
        if let Some(Constraint { gradient, bias, .. }) = self.formulas.constraint(q, v) {
            let lambda = (dot(&gradient, &self.accelerations) - bias) / dot(&gradient, &gradient);
            self.accelerations.iter_mut().zip(&gradient).for_each(|(a, g)| *a -= lambda * g);
            self.lambda[0] = lambda;
        }
        self.formulas.powers(time, q, v, &mut self.powers);
        self.chart(state)
    }

    fn accelerations(&self) -> &[f64] {
        &self.accelerations
    }

    fn lambda(&self) -> &[f64] {
        &self.lambda
    }

    fn powers(&self) -> &[f64] {
        &self.powers
    }

    fn watches(&self) -> &[Watch] {
        &self.watches
    }

    fn event_values(&mut self, state: State<'_, f64>, values: &mut [f64]) -> Result<(), Fault> {
        self.formulas.events(state.time, state.q, state.v, values)
    }

    fn event_rate(&self, k: usize) -> f64 {
        self.courses[k].rate
    }

    fn course(&self, k: usize) -> Course {
        self.courses[k]
    }

    fn project(&mut self, _time: f64, q: &mut [f64], v: &mut [f64]) -> Result<f64, Fault> {
        let mut distance = 0.0_f64;
        for _ in 0..4 {
            let Some(Constraint { value, gradient, .. }) = self.formulas.constraint(q, v) else {
                break;
            };
            let square = dot(&gradient, &gradient);
            distance = distance.max((value / square.sqrt()).abs());
            q.iter_mut().zip(&gradient).for_each(|(q, g)| *q -= value * g / square);
            let rate = dot(&gradient, v);
            v.iter_mut().zip(&gradient).for_each(|(v, g)| *v -= rate * g / square);
        }
        Ok(distance)
    }

    fn turns(&self) -> usize {
        0
    }

    fn turn_angles(&self, _time: f64, _q: &[f64], _angles: &mut [f64]) {}

    fn turn_rates(&self, _time: f64, _v: &[f64], _rates: &mut [f64]) {}
}

impl<F: Formulas> Dae for Sample<F> {
    fn residual(&mut self, t: f64, y: &[f64], yp: &[f64], r: &mut [f64]) -> Result<(), Fault> {
        let n = self.coordinates();
        let (q, v) = (&y[..n], &y[n..2 * n]);
        self.formulas.forces(t, q, v, &mut r[n..2 * n])?;
        for i in 0..n {
            r[i] = yp[i] - v[i];
            r[n + i] = yp[n + i] - r[n + i];
        }
        if let Some(Constraint { gradient, bias, .. }) = self.formulas.constraint(q, v) {
            r[n..2 * n].iter_mut().zip(&gradient).for_each(|(r, g)| *r += y[2 * n] * g);
            r[2 * n] = dot(&gradient, &yp[n..2 * n]) - bias;
        }
        Ok(())
    }

    /// By central differences: enough for Newton's method, and not one formula more to get wrong.
    fn jacobian(
        &mut self,
        t: f64,
        y: &[f64],
        yp: &[f64],
        cj: f64,
        jacobian: &mut impl Entries,
    ) -> Result<(), Fault> {
        let (mut y, mut yp) = (y.to_vec(), yp.to_vec());
        let mut sides = [vec![0.0; y.len()], vec![0.0; y.len()]];
        let size = |j: usize| *self.scales.0.iter().chain(&self.scales.1).nth(j).unwrap_or(&1.0);
        let sizes: Vec<f64> = (0..y.len()).map(size).collect();
        for (j, size) in sizes.iter().enumerate() {
            let step = 1e-6 * size;
            let (kept, kept_rate) = (y[j], yp[j]);
            for (side, shift) in sides.iter_mut().zip([step, -step]) {
                y[j] = kept + shift;
                yp[j] = kept_rate + cj * shift;
                self.residual(t, &y, &yp, side)?;
            }
            (y[j], yp[j]) = (kept, kept_rate);
            for (i, (right, left)) in sides[0].iter().zip(&sides[1]).enumerate() {
                jacobian.add(i, j, (right - left) / (2.0 * step));
            }
        }
        Ok(())
    }
}

/// A unit mass held by a force that remembers, and its closed form from q = 0, v = 1, z = 0:
/// ```text
/// v̇ = −z,  ż = 2 v − 3 z;   v = 2 e^(−t) − e^(−2t),  z = −v̇
/// ```
pub(crate) struct Relaxing<S> {
    accelerations: [S; 1],
    inner_rates: [S; 1],
}

impl<S: Scalar> Relaxing<S> {
    pub(crate) fn new() -> Self {
        Relaxing { accelerations: [S::zero()], inner_rates: [S::zero()] }
    }

    /// q, v and z at a time (s).
    pub(crate) fn at(time: S) -> [S; 3] {
        let slow = (-time).exp();
        let fast = slow * slow;
        let two = S::from_f64(2.0);
        let q = two * (S::one() - slow) - (S::one() - fast) * S::from_f64(0.5);
        [q, two * slow - fast, two * (slow - fast)]
    }
}

impl<S: Scalar> System<S> for Relaxing<S> {
    fn coordinates(&self) -> usize {
        1
    }

    fn multipliers(&self) -> usize {
        0
    }

    fn integrals(&self) -> usize {
        0
    }

    fn scales(&self) -> (&[f64], &[f64]) {
        (&[1.0], &[1.0])
    }

    fn inner_states(&self) -> usize {
        1
    }

    fn inner_scales(&self) -> &[f64] {
        &[1.0]
    }

    fn evaluate(&mut self, State { v, z, .. }: State<'_, S>) -> Result<(), Fault> {
        self.accelerations = [-z[0]];
        self.inner_rates = [S::from_f64(2.0) * v[0] - S::from_f64(3.0) * z[0]];
        Ok(())
    }

    fn accelerations(&self) -> &[S] {
        &self.accelerations
    }

    fn inner_rates(&self) -> &[S] {
        &self.inner_rates
    }

    fn lambda(&self) -> &[S] {
        &[]
    }

    fn powers(&self) -> &[S] {
        &[]
    }

    fn watches(&self) -> &[Watch] {
        &[]
    }

    fn event_values(&mut self, _: State<'_, S>, _: &mut [S]) -> Result<(), Fault> {
        Ok(())
    }

    fn event_rate(&self, _: usize) -> S {
        S::zero()
    }

    fn course(&self, _: usize) -> Course {
        Course::NONE
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

impl Dae for Relaxing<f64> {
    fn residual(&mut self, _: f64, y: &[f64], yp: &[f64], r: &mut [f64]) -> Result<(), Fault> {
        r[0] = yp[0] - y[1];
        r[1] = yp[1] + y[2];
        r[2] = yp[2] - 2.0 * y[1] + 3.0 * y[2];
        Ok(())
    }

    fn jacobian(
        &mut self,
        _: f64,
        _: &[f64],
        _: &[f64],
        cj: f64,
        jacobian: &mut impl Entries,
    ) -> Result<(), Fault> {
        for (row, column, entry) in
            [(0, 1, -1.0), (1, 2, 1.0), (2, 1, -2.0), (0, 0, cj), (1, 1, cj), (2, 2, cj + 3.0)]
        {
            jacobian.add(row, column, entry);
        }
        Ok(())
    }
}
