//! What error a step may make.
//!
//! IDA multiplies an error x by weights w and compares a norm of the products with one. With the
//! relative tolerance r and the absolute tolerances a:
//!
//! | norm      | w                  | ‖x‖                  |
//! |-----------|--------------------|----------------------|
//! | `Ode15s`  | 1 / max(r·\|y\|, a) | max \|x w\|           |
//! | `Wrms`    | 1 / (r·\|y\| + a)   | √(Σ (x w)² / number) |
//!
//! The multipliers λ follow from (q, v) and carry no error of their own from step to step: their
//! weight is zero, so no norm sees them. (With tolerances of 1e-12 they would stop every run: they
//! jump by more than that at the begin of a contact.)
//!
//! No tolerance can mean less than rounding makes. A coordinate is right to ε|q|, ε the rounding of
//! doubles, and no better than what moves by itself in the rounding of the time, ½ ulp(t) times its
//! speed: eight seconds on that is the larger part. Through the forces (∂v̇/∂q, which is c/m times larger in a contact of stiffness c) and
//! through the multipliers a step of length 1/c_j makes of it an error of
//!
//! ```text
//! v:  (Σ |∂v̇/∂q| ε|q| + Σ |∂v̇/∂z| ε|z| + Σ |∂v̇/∂λ| (ε|λ| + δλ)) / c_j      but at most ε|q| c_j
//! q:  that of v / c_j
//! z:  ε (Σ |∂ż/∂q| |q| + Σ |∂ż/∂v| |v|) / c_j
//! ```
//!
//! with what a multiplier must change by, Φ_q M⁻¹ Φ_qᵀ taken by its diagonal, where the velocities of
//! which IDA takes differences are rounded: a body that only translates between others that turn has
//! no other rate than this.
//!
//! ```text
//! δλ = ε c_j Σ |Φ_q| |v| / (Φ_q M⁻¹ Φ_qᵀ)
//! ```
//!
//! Where a and r|y| ask for less, as for a velocity that dies away under an absolute tolerance of
//! 1e-20, that error is allowed, and the step counted; else steps would shrink with the velocity.

use super::Error;
use super::matrix::Columns;
use std::ops::Range;

/// The smallest absolute tolerance: with it, squares of weighted numbers stay below 1e300.
const SMALLEST_ABSOLUTE: f64 = 1e-100;

/// The norm in which a step's error is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Norm {
    /// The largest weighted component, as MATLAB's `ode15s` takes it.
    Ode15s,
    /// Weighted root mean square, IDA's own.
    Wrms,
}

/// The error below which a component does not count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AbsoluteTolerance {
    /// One number for all coordinates (m, rad) and velocities (m/s, rad/s).
    Scalar(f64),
    /// A hundredth of the relative tolerance times the typical size of each component, from
    /// [`System::scales`](crate::dae::System::scales) and
    /// [`System::inner_scales`](crate::dae::System::inner_scales).
    Scaled,
}

/// Weights of the unknowns (q, v, z, λ).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weights {
    relative: f64,
    /// Of q, v and z; none for λ.
    absolute: Vec<f64>,
    norm: Norm,
    /// Typical sizes of q.
    sizes: Vec<f64>,
    /// Typical sizes of v.
    speeds: Vec<f64>,
    /// What rounding makes of q, v and z in a step.
    floor: Vec<f64>,
    balances: Balances,
    /// How often an error below the floor was asked for.
    floored: u64,
}

impl Weights {
    /// Weights for a system with these typical sizes of q and v, and of z.
    pub(super) fn new(
        relative: f64,
        absolute: AbsoluteTolerance,
        norm: Norm,
        scales: (&[f64], &[f64]),
        inner: &[f64],
    ) -> Result<Weights, Error> {
        if !(relative > f64::EPSILON && relative < 1.0) {
            return Err(Error::Option {
                name: "relative_tolerance",
                value: relative,
                must: "lie between 2.3e-16, the rounding of the arithmetic, and 1",
            });
        }
        let own = scales.0.to_vec();
        let sizes = scales.0.iter().chain(scales.1).chain(inner);
        let absolute: Vec<f64> = match absolute {
            AbsoluteTolerance::Scalar(a) => sizes.map(|_| a).collect(),
            AbsoluteTolerance::Scaled => sizes.map(|size| 0.01 * relative * size).collect(),
        };
        match absolute.iter().find(|a| !(**a >= SMALLEST_ABSOLUTE && a.is_finite())) {
            Some(&value) => Err(Error::Option {
                name: "absolute_tolerance",
                value,
                must: "be at least 1e-100 and finite, for every coordinate, velocity and inner state",
            }),
            None => {
                let floor = vec![0.0; absolute.len()];
                let speeds = scales.1.to_vec();
                let balances = Balances::default();
                Ok(Weights {
                    relative,
                    absolute,
                    norm,
                    sizes: own,
                    speeds,
                    floor,
                    balances,
                    floored: 0,
                })
            }
        }
    }

    /// How many steps asked for less error than rounding makes.
    pub(super) fn floored(&self) -> u64 {
        self.floored
    }

    /// Forgets what rounding makes, for the steps will be of another length.
    pub(super) fn forget_rounding(&mut self) {
        self.floor.fill(0.0);
    }

    /// Takes in what rounding makes of a step with c_j (1/s) near the time t (s) and
    /// y = (q, v, z, λ), from the Jacobian there.
    pub(super) fn know_rounding(&mut self, t: f64, y: &[f64], cj: f64, jacobian: &impl Columns) {
        let (n, differential) = (self.sizes.len(), self.floor.len());
        self.balances.weigh(y, n, differential, jacobian);
        let (floor_q, floor_v) = self.floor.split_at_mut(n);
        floor_v.fill(0.0);
        let mut add = |column: usize, rounding: f64, rows: Range<usize>| {
            jacobian.each(column, rows, |row, entry| floor_v[row - n] += rounding * entry.abs());
        };
        let late = 0.5 * (t.abs().next_up() - t.abs());
        let rounding = |j: usize| {
            let own = f64::EPSILON * y[j].abs().max(self.sizes[j]);
            own.max(late * self.speeds[j])
        };
        for j in 0..n {
            add(j, rounding(j), n..differential);
        }
        if differential > 2 * n {
            for (j, v) in y.iter().enumerate().take(2 * n).skip(n) {
                add(j, f64::EPSILON * v.abs(), 2 * n..differential);
            }
        }
        for (k, z) in y.iter().enumerate().take(differential).skip(2 * n) {
            add(k, f64::EPSILON * z.abs(), n..2 * n);
        }
        let multipliers = y.iter().enumerate().skip(differential);
        for ((k, lambda), balance) in multipliers.zip(&self.balances.rows) {
            add(k, f64::EPSILON * (lambda.abs() + balance.share(cj)), n..2 * n);
        }
        let (floor_v, floor_z) = floor_v.split_at_mut(n);
        floor_z.iter_mut().for_each(|z| *z /= cj);
        for (j, (q, v)) in floor_q.iter_mut().zip(floor_v).enumerate() {
            // a step that is long for a stiff contact moves no further than rounding moves q
            *q = (*v / cj / cj).min(rounding(j));
            *v = *q * cj;
        }
    }

    /// The norm that the weights are made for.
    pub(super) fn norm(&self) -> Norm {
        self.norm
    }

    /// Writes the weights at y = (q, v, z, λ).
    pub(super) fn fill(&mut self, y: &[f64], weights: &mut [f64]) {
        let (differential, algebraic) = weights.split_at_mut(self.absolute.len());
        let mut below = false;
        for (((w, y), a), floor) in
            differential.iter_mut().zip(y).zip(&self.absolute).zip(&self.floor)
        {
            let relative = self.relative * y.abs();
            let allowed = match self.norm {
                Norm::Ode15s => relative.max(*a),
                Norm::Wrms => relative + a,
            };
            below |= allowed < *floor;
            *w = 1.0 / allowed.max(*floor);
        }
        self.floored += u64::from(below);
        algebraic.fill(0.0);
    }
}

/// What the constraints balance.
#[derive(Debug, Clone, PartialEq, Default)]
struct Balances {
    rows: Vec<Balance>,
    /// By velocity, the multipliers that act on it: which, and ∂v̇/∂λ.
    actions: Vec<Vec<(usize, f64)>>,
}

/// What one constraint balances, in an equation that c_j makes large.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Balance {
    /// c_j Σ |Φ_q| |v| (m/s², rad/s²).
    sum: f64,
    /// c_j times the diagonal entry of Φ_q M⁻¹ Φ_qᵀ (1/kg s).
    mobility: f64,
}

impl Balance {
    /// The multiplier that a relative error of the velocities comes to, for each 1/c_j.
    fn share(&self, cj: f64) -> f64 {
        let share = self.sum / self.mobility * cj;
        if share.is_finite() { share } else { 0.0 }
    }
}

impl Balances {
    /// Weighs all at y = (q, v, z, λ), of n coordinates and with multipliers from the first on.
    fn weigh(&mut self, y: &[f64], n: usize, first: usize, jacobian: &impl Columns) {
        let size = y.len();
        self.rows.clear();
        self.rows.resize(size - first, Balance::default());
        self.actions.resize(n, Vec::new());
        self.actions.iter_mut().for_each(Vec::clear);
        for column in first..size {
            let actions = &mut self.actions;
            jacobian.each(column, n..2 * n, |row, entry| {
                if entry != 0.0 {
                    actions[row - n].push((column, entry));
                }
            });
        }
        for (j, (actions, v)) in self.actions.iter().zip(&y[n..]).enumerate() {
            let rows = &mut self.rows;
            jacobian.each(n + j, first..size, |row, entry| {
                let balance = &mut rows[row - first];
                balance.sum += (entry * v).abs();
                let acting = actions.iter().find(|(column, _)| *column == row);
                balance.mobility += acting.map_or(0.0, |(_, action)| (entry * action).abs());
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::matrix::Dense;
    use super::*;

    /// A matrix of two columns.
    fn dense(columns: &mut [f64; 4]) -> Dense<'_> {
        Dense { columns, size: 2 }
    }

    fn weights(norm: Norm, absolute: AbsoluteTolerance, y: &[f64]) -> Vec<f64> {
        let mut weights = Weights::new(1e-6, absolute, norm, (&[2.0], &[300.0]), &[]).unwrap();
        let mut w = vec![f64::NAN; y.len()];
        weights.fill(y, &mut w);
        w
    }

    #[test]
    fn ode15s_takes_the_larger_tolerance_and_wrms_their_sum() {
        let absolute = AbsoluteTolerance::Scalar(1e-8);
        assert_eq!(weights(Norm::Ode15s, absolute, &[-1.0, 1e-3]), [1.0 / 1e-6, 1.0 / 1e-8]);
        let expected = [1.0 / (1e-6 + 1e-8), 1.0 / (1e-6 * 1e-3 + 1e-8)];
        assert_eq!(weights(Norm::Wrms, absolute, &[-1.0, 1e-3]), expected);
    }

    #[test]
    fn no_tolerance_asks_for_less_than_rounding_makes() {
        for norm in [Norm::Ode15s, Norm::Wrms] {
            let tiny = AbsoluteTolerance::Scalar(1e-20);
            let mut weights = Weights::new(1e-12, tiny, norm, (&[2.0], &[300.0]), &[]).unwrap();
            let (y, cj, stiffness) = ([-3.0, 1e-15], 1e6, 1e8);
            let mut w = [f64::NAN; 2];
            weights.fill(&y, &mut w);
            assert!(w[1] > 1e19 && weights.floored() == 0);
            // Column by column: c_j, stiffness; −1, c_j.
            weights.know_rounding(0.0, &y, cj, &dense(&mut [cj, stiffness, -1.0, cj]));
            weights.fill(&y, &mut w);
            let expected = f64::EPSILON * 3.0 * stiffness / cj;
            assert!((w[1] * expected - 1.0).abs() < 1e-12, "{w:?}");
            assert!((w[0] * 3e-12 - 1.0).abs() < 1e-7, "q has no need of it: {w:?}");
            assert_eq!(weights.floored(), 1);
            // Steps longer than the contact vibrates move the coordinate by its rounding.
            weights.know_rounding(0.0, &y, 1e3, &dense(&mut [1e3, stiffness, -1.0, 1e3]));
            weights.fill(&y, &mut w);
            assert!((w[1] * f64::EPSILON * 3.0 * 1e3 - 1.0).abs() < 1e-12, "{w:?}");
            // Late in a run the rounding of the time moves it by more: 300 · ½ ulp(8.4).
            let late = 300.0 * f64::EPSILON * 4.0;
            weights.know_rounding(8.4, &y, cj, &dense(&mut [cj, stiffness, -1.0, cj]));
            weights.fill(&y, &mut w);
            assert!((w[1] * late * stiffness / cj - 1.0).abs() < 1e-12, "{w:?}");
            weights.forget_rounding();
            weights.fill(&y, &mut w);
            assert!(w[1] > 1e19 && weights.floored() == 3);
        }
    }

    #[test]
    fn the_scaled_tolerance_follows_the_typical_sizes() {
        let w = weights(Norm::Ode15s, AbsoluteTolerance::Scaled, &[0.0, 0.0]);
        assert_eq!(w, [1.0 / (0.01 * 1e-6 * 2.0), 1.0 / (0.01 * 1e-6 * 300.0)]);
    }

    #[test]
    fn multipliers_have_no_weight() {
        for norm in [Norm::Ode15s, Norm::Wrms] {
            let w = weights(norm, AbsoluteTolerance::Scalar(1e-20), &[1.0, 1.0, 1e5, 0.0]);
            assert_eq!(w[2..], [0.0, 0.0]);
        }
    }

    #[test]
    fn at_rest_the_smallest_tolerances_leave_every_weight_finite() {
        for norm in [Norm::Ode15s, Norm::Wrms] {
            for smallest in [1e-20, SMALLEST_ABSOLUTE] {
                let w = weights(norm, AbsoluteTolerance::Scalar(smallest), &[0.0, -0.0]);
                assert!(w.iter().all(|w| w.is_finite() && (w * 1e3).powi(2).is_finite()), "{w:?}");
            }
        }
    }

    #[test]
    fn tolerances_that_mean_nothing_are_refused() {
        let refused = |relative, absolute| {
            Weights::new(relative, absolute, Norm::Wrms, (&[1.0], &[0.0]), &[]).is_err()
        };
        assert!(refused(0.0, AbsoluteTolerance::Scalar(1e-20)));
        assert!(refused(f64::NAN, AbsoluteTolerance::Scalar(1e-20)));
        assert!(refused(1e-12, AbsoluteTolerance::Scalar(0.0)));
        assert!(refused(1e-12, AbsoluteTolerance::Scaled), "a typical size of zero");
        assert!(!refused(1e-12, AbsoluteTolerance::Scalar(1e-20)));
    }
}
