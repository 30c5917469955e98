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

use super::Error;

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
    /// [`System::scales`](crate::dae::System::scales).
    Scaled,
}

/// Weights of the unknowns (q, v, λ).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weights {
    relative: f64,
    /// Of q and v; none for λ.
    absolute: Vec<f64>,
    norm: Norm,
}

impl Weights {
    /// Weights for a system with these typical sizes of q and v.
    pub(super) fn new(
        relative: f64,
        absolute: AbsoluteTolerance,
        norm: Norm,
        scales: (&[f64], &[f64]),
    ) -> Result<Weights, Error> {
        if !(relative > f64::EPSILON && relative < 1.0) {
            return Err(Error::Option {
                name: "relative_tolerance",
                value: relative,
                must: "lie between 2.3e-16, the rounding of the arithmetic, and 1",
            });
        }
        let sizes = scales.0.iter().chain(scales.1);
        let absolute: Vec<f64> = match absolute {
            AbsoluteTolerance::Scalar(a) => sizes.map(|_| a).collect(),
            AbsoluteTolerance::Scaled => sizes.map(|size| 0.01 * relative * size).collect(),
        };
        match absolute.iter().find(|a| !(**a >= SMALLEST_ABSOLUTE && a.is_finite())) {
            Some(&value) => Err(Error::Option {
                name: "absolute_tolerance",
                value,
                must: "be at least 1e-100 and finite, for every coordinate and velocity",
            }),
            None => Ok(Weights { relative, absolute, norm }),
        }
    }

    /// The norm that the weights are made for.
    pub(super) fn norm(&self) -> Norm {
        self.norm
    }

    /// Writes the weights at y = (q, v, λ).
    pub(super) fn fill(&self, y: &[f64], weights: &mut [f64]) {
        let (differential, algebraic) = weights.split_at_mut(self.absolute.len());
        let terms = differential.iter_mut().zip(y).zip(&self.absolute);
        match self.norm {
            Norm::Ode15s => {
                terms.for_each(|((w, y), a)| *w = 1.0 / (self.relative * y.abs()).max(*a));
            }
            Norm::Wrms => terms.for_each(|((w, y), a)| *w = 1.0 / (self.relative * y.abs() + a)),
        }
        algebraic.fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(norm: Norm, absolute: AbsoluteTolerance, y: &[f64]) -> Vec<f64> {
        let weights = Weights::new(1e-6, absolute, norm, (&[2.0], &[300.0])).unwrap();
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
            Weights::new(relative, absolute, Norm::Wrms, (&[1.0], &[0.0])).is_err()
        };
        assert!(refused(0.0, AbsoluteTolerance::Scalar(1e-20)));
        assert!(refused(f64::NAN, AbsoluteTolerance::Scalar(1e-20)));
        assert!(refused(1e-12, AbsoluteTolerance::Scalar(0.0)));
        assert!(refused(1e-12, AbsoluteTolerance::Scaled), "a typical size of zero");
        assert!(!refused(1e-12, AbsoluteTolerance::Scalar(1e-20)));
    }
}
