//! Normal-force laws, one file a law.
//!
//! Every law here is of the family
//! ```text
//! F_N = K δⁿ [ 1 + a δ̇/δ̇⁽⁻⁾ ]
//! ```
//! and its file says what the damping weight `a` is. δ is the penetration, δ̇ its rate (positive
//! while the bodies approach), δ̇⁽⁻⁾ the rate at which the contact began. One isolated impact
//! rebounds at e times its speed, with e the root of `a (1 + e) = ln((1 + a)/(1 − a e))`, whatever
//! K, m, n and the speed.

pub mod hertz;
pub mod lankarani_nikravesh;
pub mod stiffness;

use crate::scalar::Scalar;

/// How deep and how fast journal and bearing press into each other.
#[derive(Debug, Clone, Copy)]
pub struct Penetration<S> {
    /// Depth δ (m); positive while the surfaces overlap.
    pub depth: S,
    /// Rate δ̇ (m/s); positive while they approach.
    pub rate: S,
    /// One over the rate δ̇⁽⁻⁾ at which the contact began (s/m).
    pub inverse_impact_rate: S,
}

/// A normal force and its partial derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalForce<S> {
    /// The force F_N (N); positive pushes the bodies apart.
    pub value: S,
    /// Its elastic part K δⁿ (N).
    pub elastic: S,
    /// ∂F_N/∂δ (N/m).
    pub d_depth: S,
    /// ∂F_N/∂δ̇ (N s/m).
    pub d_rate: S,
}

impl<S: Scalar> NormalForce<S> {
    /// No force.
    pub fn none() -> Self {
        NormalForce { value: S::zero(), elastic: S::zero(), d_depth: S::zero(), d_rate: S::zero() }
    }
}

/// The exponent n of the penetration; Hertz's 3/2 needs no power function.
#[derive(Debug, Clone, Copy)]
enum Exponent<S> {
    ThreeHalves,
    Other(S),
}

/// A normal-force law of the family, with its parameters.
#[derive(Debug, Clone, Copy)]
pub struct NormalLaw<S> {
    stiffness: S,
    exponent: Exponent<S>,
    damping_weight: S,
}

impl<S: Scalar> NormalLaw<S> {
    /// A law with stiffness K (N/mⁿ), exponent n and damping weight a.
    pub fn new(stiffness: S, exponent: S, damping_weight: S) -> Self {
        let exponent = if exponent == S::ratio(3, 2) {
            Exponent::ThreeHalves
        } else {
            Exponent::Other(exponent)
        };
        NormalLaw { stiffness, exponent, damping_weight }
    }

    /// Stiffness K (N/mⁿ).
    pub fn stiffness(&self) -> S {
        self.stiffness
    }

    /// Exponent n.
    pub fn exponent(&self) -> S {
        match self.exponent {
            Exponent::ThreeHalves => S::ratio(3, 2),
            Exponent::Other(n) => n,
        }
    }

    /// Damping weight a.
    pub fn damping_weight(&self) -> S {
        self.damping_weight
    }

    /// K δⁿ and its derivative by δ, at positive depth.
    #[inline(always)]
    fn elastic(&self, depth: S) -> (S, S) {
        let k = self.stiffness;
        match self.exponent {
            Exponent::ThreeHalves => {
                let slope = k * depth.sqrt();
                (slope * depth, S::from_f64(1.5) * slope)
            }
            Exponent::Other(n) => {
                let force = k * depth.powf(n);
                (force, n * force / depth)
            }
        }
    }

    /// The force at a penetration; none at zero depth or less.
    #[inline(always)]
    pub fn force(&self, p: Penetration<S>) -> NormalForce<S> {
        if p.depth <= S::zero() {
            return NormalForce::none();
        }
        let (elastic, slope) = self.elastic(p.depth);
        let factor = self.factor(p);
        NormalForce {
            value: elastic * factor,
            elastic,
            d_depth: slope * factor,
            d_rate: elastic * self.damping_weight * p.inverse_impact_rate,
        }
    }

    /// 1 + a δ̇/δ̇⁽⁻⁾: where it is negative the law pulls.
    #[inline(always)]
    pub fn factor(&self, p: Penetration<S>) -> S {
        S::one() + self.damping_weight * p.rate * p.inverse_impact_rate
    }

    /// Energy (J) stored in the contact at a depth: K δⁿ⁺¹/(n + 1).
    pub fn energy(&self, depth: S) -> S {
        if depth <= S::zero() {
            return S::zero();
        }
        self.elastic(depth).0 * depth / (self.exponent() + S::one())
    }

    /// The power in which a trajectory is smooth beside δ = 0: solutions are analytic in δ^(1/q)
    /// where n is a multiple of 1/q. Exponents with a large q count as smooth, at a loss of order.
    pub fn smooth_power(&self) -> f64 {
        let n = self.exponent().to_f64();
        (1..=6)
            .find(|q| (n * f64::from(*q) - (n * f64::from(*q)).round()).abs() < 1e-12)
            .map_or(1.0, |q| 1.0 / f64::from(q))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual64;
    use proptest::prelude::*;

    fn law<S: Scalar>(exponent: f64) -> NormalLaw<S> {
        let a = lankarani_nikravesh::damping_weight(S::parse("0.9").unwrap());
        NormalLaw::new(S::from_f64(1.04e10), S::from_f64(exponent), a)
    }

    proptest! {
        #[test]
        fn partial_derivatives_are_those_of_dual_numbers(
            depth in 1e-9..1e-3f64, rate in -5.0..5.0f64, impact in 1e-3..5.0f64, n in 1.0..2.5f64,
        ) {
            for n in [n, 1.5] {
                let real = law::<f64>(n).force(
                    Penetration { depth, rate, inverse_impact_rate: 1.0 / impact });
                let along = |ddepth, drate| law::<Dual64>(n).force(Penetration {
                    depth: Dual64::new(depth, ddepth),
                    rate: Dual64::new(rate, drate),
                    inverse_impact_rate: Dual64::from_f64(1.0 / impact),
                }).value.eps;
                let scale = real.elastic.abs() * (1.0 + rate.abs() / impact);
                prop_assert!((along(1.0, 0.0) - real.d_depth).abs() < 1e-12 * scale / depth);
                prop_assert!((along(0.0, 1.0) - real.d_rate).abs() < 1e-12 * scale / impact);
            }
        }

        #[test]
        fn the_elastic_force_is_the_slope_of_the_stored_energy(depth in 1e-8..1e-3f64) {
            let energy = law::<Dual64>(1.5).energy(Dual64::new(depth, 1.0));
            let force = law::<f64>(1.5).force(
                Penetration { depth, rate: 0.0, inverse_impact_rate: 1.0 });
            prop_assert!((energy.eps - force.elastic).abs() < 1e-13 * force.elastic);
        }
    }

    #[test]
    fn without_depth_there_is_no_force() {
        let p = Penetration { depth: -1e-9, rate: 3.0, inverse_impact_rate: 1.0 };
        assert_eq!(law::<f64>(1.5).force(p), NormalForce::none());
    }

    #[test]
    fn hertz_contacts_are_smooth_in_the_square_root() {
        assert_eq!(law::<f64>(1.5).smooth_power(), 0.5);
        assert_eq!(law::<f64>(1.0).smooth_power(), 1.0);
        assert_eq!(law::<f64>(10.0 / 9.0).smooth_power(), 1.0);
    }
}
