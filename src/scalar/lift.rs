//! Numbers of one arithmetic as numbers of a richer one.

use super::{Dual, Scalar};

/// An arithmetic that has the numbers of `S` among its own: `S` itself, and dual numbers over it,
/// three deep. Formulas that are written over it can be evaluated, and differentiated up to three
/// times.
pub trait Lift<S>: Scalar {
    /// The number `x`, as a constant.
    fn lift(x: S) -> Self;

    /// This times the number `x`: the product with a constant, without its zeros.
    fn times(self, x: S) -> Self;
}

impl<S: Scalar> Lift<S> for S {
    #[inline(always)]
    fn lift(x: S) -> Self {
        x
    }

    #[inline(always)]
    fn times(self, x: S) -> Self {
        self * x
    }
}

impl<S: Scalar> Lift<S> for Dual<S> {
    #[inline(always)]
    fn lift(x: S) -> Self {
        Dual::from_re(x)
    }

    #[inline(always)]
    fn times(self, x: S) -> Self {
        Dual::new(self.re * x, self.eps * x)
    }
}

impl<S: Scalar, const N: usize> Lift<S> for Dual<S, [S; N]> {
    #[inline(always)]
    fn lift(x: S) -> Self {
        Dual::from_re(x)
    }

    #[inline(always)]
    fn times(self, x: S) -> Self {
        Dual::new(self.re * x, self.eps.map(|eps| eps * x))
    }
}

impl<S: Scalar> Lift<S> for Dual<Dual<S>> {
    #[inline(always)]
    fn lift(x: S) -> Self {
        Dual::from_re(Dual::from_re(x))
    }

    #[inline(always)]
    fn times(self, x: S) -> Self {
        Dual::new(self.re.times(x), self.eps.times(x))
    }
}

impl<S: Scalar> Lift<S> for Dual<Dual<Dual<S>>> {
    #[inline(always)]
    fn lift(x: S) -> Self {
        Dual::from_re(Dual::from_re(Dual::from_re(x)))
    }

    #[inline(always)]
    fn times(self, x: S) -> Self {
        Dual::new(self.re.times(x), self.eps.times(x))
    }
}
