//! Normal-force laws, one file a law.
//!
//! Nearly every law here is of the family
//! ```text
//! F_N = F_e(δ) [ 1 + a δ̇/δ̇⁽⁻⁾ ]
//! ```
//! The file of its elastic part says what F_e is, that of its damping what the weight `a` is; any goes
//! with any. δ is the penetration, δ̇ its rate (positive while the bodies approach), δ̇⁽⁻⁾ the rate at
//! which the contact began. One isolated impact rebounds at e times its speed, with e the root of
//! `a (1 + e) = ln((1 + a)/(1 − a e))`, whatever F_e, the mass and the speed.
//!
//! Laws with a damping of their own, F_N = K δⁿ + c δ^p δ̇, stand in `viscous`.

mod damping;
pub mod elastic;
mod impact;
pub mod stiffness;
pub mod viscous;
mod viscous_impact;

pub use damping::{About, Damping};
pub use impact::{Impact, depth_under, force_loop};

use crate::scalar::Scalar;
use elastic::{Elastic, ElasticLaw};
use viscous::Viscous;

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
    /// Its elastic part F_e (N).
    pub elastic: S,
    /// ∂F_N/∂δ (N/m).
    pub d_depth: S,
    /// ∂F_N/∂δ̇ (N s/m).
    pub d_rate: S,
    /// The stiffness (N/m) that the contact swings on: ∂F_N/∂δ, but for a damping that grows with δ
    /// by itself.
    pub swing: S,
}

impl<S: Scalar> NormalForce<S> {
    /// No force.
    pub fn none() -> Self {
        let zero = S::zero();
        NormalForce { value: zero, elastic: zero, d_depth: zero, d_rate: zero, swing: zero }
    }
}

/// Damping weights below this have a rebound that its series tells better than its equation.
const SMALL_WEIGHT: f64 = 1e-3;

/// What one isolated impact rebounds at, over its speed: the root e of
/// `a (1 + e) = ln((1 + a)/(1 − a e))` for a damping weight a (module's header).
pub fn rebound(a: f64) -> f64 {
    if a < SMALL_WEIGHT {
        return 1.0 - a * (2.0 / 3.0 - a * (4.0 / 9.0 - a * 44.0 / 135.0));
    }
    // above zero below the root, below it above
    let left = |e: f64| a * (1.0 + e) - a.ln_1p() + (-a * e).ln_1p();
    let (mut low, mut high) = (0.0, f64::min(1.0, 1.0 / a));
    for _ in 0..64 {
        let middle = f64::midpoint(low, high);
        if left(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}

/// What takes energy out of a contact.
#[derive(Debug, Clone, Copy)]
enum Loss<S> {
    /// The weight a of 1 + a δ̇/δ̇⁽⁻⁾.
    Weight(S),
    /// A damping that knows nothing of the impact.
    Viscous(Viscous<S>),
}

/// A normal-force law of any kind, with its parameters.
#[derive(Debug, Clone, Copy)]
pub struct NormalLaw<S> {
    elastic: Elastic<S>,
    loss: Loss<S>,
    /// The q such that the force is analytic in δ^(1/q), and q over that of the elastic part.
    degree: Option<(u32, u32)>,
}

impl<S: Scalar> NormalLaw<S> {
    /// A law with its elastic part and damping weight a.
    pub fn new(elastic: Elastic<S>, damping_weight: S) -> Self {
        let degree = elastic.degree().map(|q| (q, 1));
        NormalLaw { elastic, loss: Loss::Weight(damping_weight), degree }
    }

    /// A law with its elastic part and a viscous damping.
    pub fn viscous(elastic: Elastic<S>, viscous: Viscous<S>) -> Self {
        let q = viscous.degree();
        let degree = elastic.degree().filter(|own| q.is_multiple_of(*own)).map(|own| (q, q / own));
        NormalLaw { elastic, loss: Loss::Viscous(viscous), degree }
    }

    /// The elastic part F_e(δ).
    pub fn elastic(&self) -> &Elastic<S> {
        &self.elastic
    }

    /// Damping weight a; `None` of a law whose damping knows nothing of the impact.
    pub fn damping_weight(&self) -> Option<S> {
        match self.loss {
            Loss::Weight(a) => Some(a),
            Loss::Viscous(_) => None,
        }
    }

    /// The exponent of the power law that the damping goes with, if not with any elastic part.
    pub fn wanted_exponent(&self) -> Option<f64> {
        match &self.loss {
            Loss::Weight(_) => None,
            Loss::Viscous(viscous) => Some(viscous.exponent()),
        }
    }

    /// Whether the law can pull.
    pub fn can_pull(&self) -> bool {
        match &self.loss {
            Loss::Weight(a) => *a > S::zero(),
            Loss::Viscous(viscous) => viscous.damps(),
        }
    }

    /// The force at a penetration; none at zero depth or less. Only where the elastic part is smooth
    /// there does it go on below: a law must not lose that to a step beyond a contact's end.
    #[inline(always)]
    pub fn force(&self, p: Penetration<S>) -> NormalForce<S> {
        if p.depth <= S::zero() && !self.elastic.goes_on_below() {
            return NormalForce::none();
        }
        let elastic = self.elastic.force(p.depth);
        match &self.loss {
            Loss::Weight(a) => weighted(*a, p, elastic),
            Loss::Viscous(viscous) => damped(viscous.damping(p.depth), p, elastic),
        }
    }

    /// The depth δ = r^q of a root r.
    #[inline(always)]
    pub fn depth_from_root(&self, root: S) -> S {
        let q = self.degree.map_or(1, |(q, _)| q);
        (1..q).fold(root, |product, _| product * root)
    }

    /// The force at a penetration of depth δ = r^q, of which the root r is known with its sign; q
    /// is that of [`smooth_power`](Self::smooth_power). It is analytic in r and the rate, with no
    /// case for r < 0: an engine may look a little beyond a contact's end.
    #[inline(always)]
    pub fn force_from_root(&self, p: Penetration<S>, root: S) -> NormalForce<S> {
        let own = match self.degree {
            Some((_, times)) => (1..times).fold(root, |product, _| product * root),
            None => return self.force(p),
        };
        let Some(elastic) = self.elastic.force_from_root(own) else { return self.force(p) };
        match &self.loss {
            Loss::Weight(a) => weighted(*a, p, elastic),
            Loss::Viscous(viscous) => damped(viscous.damping_from_root(root), p, elastic),
        }
    }

    /// A number that is positive where the law presses and negative where it pulls, one at the begin
    /// of an impact: 1 + a δ̇/δ̇⁽⁻⁾, or of a viscous damping (F_e/(c δ^p) + δ̇)/δ̇⁽⁻⁾.
    #[inline(always)]
    pub fn pressing(&self, p: Penetration<S>) -> S {
        match &self.loss {
            Loss::Weight(a) => S::one() + *a * p.rate * p.inverse_impact_rate,
            Loss::Viscous(viscous) => {
                (self.lead(viscous, p.depth).0 + p.rate) * p.inverse_impact_rate
            }
        }
    }

    /// The rate (1/s) of that number, from δ̈ (m/s²).
    pub fn pressing_rate(&self, p: Penetration<S>, second: S) -> S {
        match &self.loss {
            Loss::Weight(a) => *a * second * p.inverse_impact_rate,
            Loss::Viscous(viscous) => {
                (self.lead(viscous, p.depth).1 * p.rate + second) * p.inverse_impact_rate
            }
        }
    }

    /// What a change of the rate (m/s) makes of that number (s/m).
    pub fn pressing_slope(&self, inverse_impact_rate: S) -> S {
        match &self.loss {
            Loss::Weight(a) => *a * inverse_impact_rate,
            Loss::Viscous(_) => inverse_impact_rate,
        }
    }

    /// F_e/(c δ^p) (m/s) and its slope (1/s): the rate at which the law would be without force.
    fn lead(&self, viscous: &Viscous<S>, depth: S) -> (S, S) {
        if depth <= S::zero() {
            return (S::zero(), S::zero());
        }
        let ((elastic, slope), (damping, bend)) =
            (self.elastic.force(depth), viscous.damping(depth));
        let lead = elastic / damping;
        (lead, (slope - lead * bend) / damping)
    }

    /// Energy (J) stored in the contact at a depth: the integral of the elastic part.
    pub fn energy(&self, depth: S) -> S {
        if depth <= S::zero() {
            return S::zero();
        }
        self.elastic.energy(depth)
    }

    /// The power in which a trajectory is smooth beside δ = 0: solutions are analytic in δ^(1/q)
    /// where the force is. Zero where no q is of use.
    pub fn smooth_power(&self) -> f64 {
        self.degree.map_or(0.0, |(q, _)| 1.0 / f64::from(q))
    }
}

/// F_e (1 + a δ̇/δ̇⁽⁻⁾), from F_e and its slope.
#[inline(always)]
fn weighted<S: Scalar>(a: S, p: Penetration<S>, (elastic, slope): (S, S)) -> NormalForce<S> {
    let factor = S::one() + a * p.rate * p.inverse_impact_rate;
    NormalForce {
        value: elastic * factor,
        elastic,
        d_depth: slope * factor,
        d_rate: elastic * a * p.inverse_impact_rate,
        swing: slope * factor,
    }
}

/// F_e + c δ^p δ̇, from both with their slopes.
#[inline(always)]
fn damped<S: Scalar>(
    (damping, bend): (S, S),
    p: Penetration<S>,
    (elastic, slope): (S, S),
) -> NormalForce<S> {
    NormalForce {
        value: elastic + damping * p.rate,
        elastic,
        d_depth: slope + bend * p.rate,
        d_rate: damping,
        swing: slope,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual64;
    use elastic::Power;
    use proptest::prelude::*;

    fn law<S: Scalar>(exponent: f64) -> NormalLaw<S> {
        let a = Damping::LankaraniNikravesh.weight(S::parse("0.9").unwrap());
        let power = Power::with(S::from_f64(1.04e10), S::from_f64(exponent));
        NormalLaw::new(Elastic::Power(power), a)
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
    fn the_force_from_a_root_is_that_of_its_depth_and_goes_on_below_zero() {
        for n in [1.0, 1.3, 4.0 / 3.0, 1.5, 2.0] {
            let law = law::<f64>(n);
            let q = (1.0 / law.smooth_power()).round();
            let at = |root: f64| {
                let p = Penetration { depth: root.powf(q), rate: -0.3, inverse_impact_rate: 2.0 };
                (law.force(p), law.force_from_root(p, root))
            };
            let (depth, root) = at(2e-2);
            for (x, y) in [
                (depth.value, root.value),
                (depth.elastic, root.elastic),
                (depth.d_depth, root.d_depth),
                (depth.d_rate, root.d_rate),
            ] {
                assert!((x - y).abs() < 1e-13 * x.abs(), "n = {n}: {x} {y}");
            }
            let mirrored = law.force_from_root(
                Penetration { depth: 0.0, rate: -0.3, inverse_impact_rate: 2.0 },
                -2e-2,
            );
            let sign = if (n * q).round() % 2.0 == 0.0 { 1.0 } else { -1.0 };
            assert_eq!(mirrored.value, sign * root.value, "n = {n}");
        }
    }

    #[test]
    fn lankarani_nikravesh_rebounds_faster_than_its_restitution() {
        // found by integrating the impact
        for (restitution, exact) in [(0.9, 0.913177), (0.5, 0.725241), (0.3, 0.684225)] {
            let found = rebound(Damping::LankaraniNikravesh.weight(restitution));
            assert!((found - exact).abs() < 5e-7, "{restitution}: {found}");
        }
        assert_eq!(rebound(Damping::Hertz.weight(0.5)), 1.0);
    }

    #[test]
    fn series_and_equation_of_the_rebound_meet() {
        let [below, above] = [0.999_999, 1.000_001].map(|share| rebound(share * SMALL_WEIGHT));
        assert!((below - above - 2.0 / 3.0 * 2e-6 * SMALL_WEIGHT).abs() < 1e-10, "{below} {above}");
    }

    #[test]
    fn hertz_contacts_are_smooth_in_the_square_root() {
        assert_eq!(law::<f64>(1.5).smooth_power(), 0.5);
        assert_eq!(law::<f64>(1.0).smooth_power(), 1.0);
        assert_eq!(law::<f64>(1.3).smooth_power(), 0.1);
        assert_eq!(law::<f64>(1.37).smooth_power(), 0.0);
    }
}
