//! Friction with dwell time: bristles whose break-away force grows with the time at rest.
//! ```text
//! F_T   = −F_N {sat(F_br, F_max) + σ2 v_T}
//! F_br  = σ0 z + σ1 ż
//! ż     = s v_T + (1 − s) [μ_c d(v_T) − σ0 z]/σ1,   s = exp[−(v_T/v_s)²]
//! F_max = μ_c + (μ_s − μ_c) w
//! ẇ     = (s − w)/τ_d     s ≥ w: at rest the contact grows stronger
//! ẇ     = (s − w) σ0/σ1   s < w: slip breaks it up
//! d     = v_T/v_ε [3 − (v_T/v_ε)²]/2, or ±1 beyond |v_T| = v_ε
//! ```
//! | symbol   | key                     | unit | meaning                                             |
//! |----------|-------------------------|------|-----------------------------------------------------|
//! | z        |                         | m    | mean deflection of the bristles                     |
//! | w        |                         | –    | dwell: 0 while the surfaces slip, 1 after long rest |
//! | σ0       | `stiffness`             | 1/m  | stiffness of the bristles over the normal force     |
//! | σ1, σ2   | `damping`, `viscous`    | s/m  | their damping, and viscous friction, likewise       |
//! | μ_c, μ_s | `coefficient`, `static` | –    | coefficients of sliding, and of rest after long rest|
//! | v_s      | `stribeck`              | m/s  | Stribeck's velocity                                 |
//! | τ_d      | `dwell_time`            | s    | time in which rest makes the contact stronger       |
//! | v_ε      | `transition`            | m/s  | slip at which the direction is certain              |
//!
//! (Y. Gonthier, J. McPhee, C. Lange, J.-C. Piedbœuf, A regularized contact model with asymmetric
//! damping and dwell-time dependent friction, Multibody Syst. Dyn. 11:209–233, 2004, doi
//! 10.1023/B:MUBO.0000029392.21648.bc, in the plane, written by the ratio F_T/F_N. The print was not
//! seen; the limits of sliding and sticking, the curve of steady slip and the growth of the
//! break-away force were derived and are tested.)
//!
//! Put in, F_br = s (σ0 z + σ1 v_T) + (1 − s) μ_c d: fast slip has Coulomb's friction at once, rest
//! has a spring and a damper. The saturation is on the force: bristles bend on behind it, so that
//! after a long slow slip a reversal finds them far bent.
//!
//! Where sat begins and ends, where ẇ changes its time, and at |v_T| = v_ε the law has kinks: edges
//! between its branches. A branch is left this much beyond an inner edge (h the law's hysteresis):
//! ```text
//! h √(s² + w² + h)
//! ```
//! which in fast slip, where all that the edges compare goes to zero, is no more than √h h.
//! Bristles are straight and the contact has not dwelt when it begins; where the normal law pulls
//! both go on with the slip, and hold nothing.

use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, MOST_INNER, Sloped, rest_holds};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "gonthier",
    title: "bristles with a break-away force that grows with the time at rest",
    source: "Gonthier, McPhee, Lange, Piedbœuf 2004, Multibody Syst. Dyn. 11:209–233, doi 10.1023/B:MUBO.0000029392.21648.bc",
    example: r#"[joints.A.clearance]
friction = { law = "gonthier", coefficient = 0.1, static = 0.15, stiffness = 1e4, damping = 10.0, stribeck = 1e-2, dwell_time = 1e-3, transition = 1e-2 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("static", Takes::Number(Range::NotNegative), "", "coefficient μ_s of rest after long rest, not less than `coefficient`"),
        Key::new("stiffness", Takes::Number(Range::Positive), "1/m", "stiffness σ0 of the bristles over the normal force"),
        Key::new("damping", Takes::Number(Range::Positive), "s/m", "damping σ1 of the bristles over the normal force"),
        Key::new("viscous", Takes::Number(Range::NotNegative), "s/m", "viscous friction σ2 over the normal force").or("0.0"),
        Key::new("stribeck", Takes::Number(Range::Positive), "m/s", "Stribeck's velocity v_s, below which surfaces stick"),
        Key::new("dwell_time", Takes::Number(Range::Positive), "s", "time τ_d in which rest makes the contact stronger"),
        Key::new("transition", Takes::Number(Range::Positive), "m/s", "slip v_ε from which on the direction of sliding friction is that of the slip"),
    ],
    also: Some(rest_holds),
};

/// Edges that the inner states have a say in: of the dwell, and of the saturation forward and
/// backward.
const DWELL: u8 = 0;
const FORWARD_FULL: u8 = 1;
const BACKWARD_FULL: u8 = 2;
const INNER_EDGES: u8 = 3;

/// What a branch is: a number with three digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Piece {
    /// Slip below −v_ε (0), between (1), above v_ε (2).
    region: u8,
    /// F_br below −F_max (0), between (1), above F_max (2).
    full: u8,
    /// Whether the contact grows stronger.
    dwelling: bool,
}

impl From<Branch> for Piece {
    #[inline(always)]
    fn from(Branch(number): Branch) -> Self {
        Piece { region: number % 3, full: number / 3 % 3, dwelling: number >= 9 }
    }
}

impl From<Piece> for Branch {
    fn from(piece: Piece) -> Self {
        Branch(piece.region + 3 * piece.full + 9 * u8::from(piece.dwelling))
    }
}

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Gonthier<S> {
    coefficient: S,
    /// μ_s − μ_c.
    more: S,
    stiffness: S,
    damping: S,
    viscous: S,
    stribeck: S,
    /// 1/τ_d and σ0/σ1 (1/s).
    dwelling: S,
    breaking: S,
    transition: S,
    hysteresis: S,
}

/// What only depends on the slip, with slopes by it.
struct Sliding<S> {
    /// s.
    stick: S,
    d_stick: S,
    /// d.
    direction: S,
    d_direction: S,
}

impl<S: Scalar> Gonthier<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let number = |key: &str| values.number::<S>(key);
        let coefficient = number("coefficient");
        let (stiffness, damping) = (number("stiffness"), number("damping"));
        Gonthier {
            coefficient,
            more: number("static") - coefficient,
            stiffness,
            damping,
            viscous: number("viscous"),
            stribeck: number("stribeck"),
            dwelling: S::one() / number("dwell_time"),
            breaking: stiffness / damping,
            transition: number("transition"),
            hysteresis: ends.hysteresis,
        }
    }

    #[inline(always)]
    fn sliding(&self, region: u8, slip: S) -> Sliding<S> {
        let x = slip / self.stribeck;
        let stick = (-(x * x)).exp();
        let (direction, d_direction) = match region {
            0 => (-S::one(), S::zero()),
            1 => {
                let u = slip / self.transition;
                let half = S::from_f64(0.5);
                let three = S::from_f64(3.0);
                (half * u * (three - u * u), half * (three - three * u * u) / self.transition)
            }
            _ => (S::one(), S::zero()),
        };
        Sliding { stick, d_stick: -(x + x) * stick / self.stribeck, direction, d_direction }
    }

    /// F_br.
    #[inline(always)]
    fn bristles(&self, sliding: &Sliding<S>, slip: S, z: S) -> Sloped<S> {
        let Sliding { stick, d_stick, direction, d_direction } = *sliding;
        let held = self.stiffness * z + self.damping * slip;
        let slid = self.coefficient * direction;
        let free = S::one() - stick;
        Sloped {
            value: stick * held + free * slid,
            d_slip: d_stick * (held - slid)
                + stick * self.damping
                + free * self.coefficient * d_direction,
            d_inner: [stick * self.stiffness, S::zero()],
        }
    }

    /// How far F_br is below F_max, in units of μ_s: from differences that do not cancel where s
    /// and w are small. `sign` is that of the slip in question.
    fn room(&self, region: u8, slip: S, [z, w]: Inner<S>, sign: S) -> Sloped<S> {
        let one = S::one();
        let Sliding { stick, d_stick, direction, d_direction } = self.sliding(region, slip);
        let held = self.stiffness * z + self.damping * slip - self.coefficient * direction;
        // μ_c (1 ∓ d) + (μ_s − μ_c) w ∓ s (σ0 z + σ1 v − μ_c d)
        let off = one - sign * direction;
        let unit = one / (self.coefficient + self.more);
        let held_slope = self.damping - self.coefficient * d_direction;
        Sloped {
            value: unit * (self.coefficient * off + self.more * w - sign * stick * held),
            d_slip: -sign
                * unit
                * (self.coefficient * d_direction + d_stick * held + stick * held_slope),
            d_inner: [-sign * unit * stick * self.stiffness, unit * self.more],
        }
    }

    /// The overlap of branches at an inner edge.
    fn overlap(&self, slip: S, w: S) -> Sloped<S> {
        let Sliding { stick, d_stick, .. } = self.sliding(1, slip);
        let root = (stick * stick + w * w + self.hysteresis).sqrt();
        let slope = self.hysteresis / root;
        Sloped {
            value: self.hysteresis * root,
            d_slip: slope * stick * d_stick,
            d_inner: [S::zero(), slope * w],
        }
    }
}

impl<S: Scalar> FrictionLaw<S> for Gonthier<S> {
    #[inline(always)]
    fn ratio(&self, branch: Branch, slip: S, inner: Inner<S>) -> Sloped<S> {
        let piece = Piece::from(branch);
        let most = self.coefficient + self.more * inner[1];
        let held = match piece.full {
            0 => Sloped {
                value: -most,
                d_slip: S::zero(),
                d_inner: [S::zero(), -self.more],
            },
            1 => self.bristles(&self.sliding(piece.region, slip), slip, inner[0]),
            _ => Sloped { value: most, d_slip: S::zero(), d_inner: [S::zero(), self.more] },
        };
        Sloped {
            value: -(held.value + self.viscous * slip),
            d_slip: -(held.d_slip + self.viscous),
            d_inner: held.d_inner.map(|slope| -slope),
        }
    }

    /// That of straight bristles which have not dwelt. Branches overlap by the hysteresis, where
    /// the slip's acceleration decides.
    fn branch(&self, slip: S, acceleration: S) -> Branch {
        let near = |edge: S| (slip - edge).abs() <= self.hysteresis * self.transition;
        let rises = acceleration > S::zero();
        let above = |edge: S| if near(edge) { rises } else { slip > edge };
        let region = u8::from(above(-self.transition)) + u8::from(above(self.transition));
        let beyond = |sign: S| {
            self.room(region, slip, [S::zero(); MOST_INNER], sign).value < S::zero()
        };
        let full = match (beyond(-S::one()), beyond(S::one())) {
            (true, _) => 0,
            (false, false) => 1,
            (false, true) => 2,
        };
        Piece { region, full, dwelling: true }.into()
    }

    fn edges(&self, branch: Branch) -> (S, S) {
        let far = S::from_f64(f64::INFINITY);
        let (at, over) = (self.transition, self.hysteresis * self.transition);
        match Piece::from(branch).region {
            0 => (-far, -at + over),
            1 => (-at - over, at + over),
            _ => (at - over, far),
        }
    }

    fn inner_edges(&self) -> u8 {
        INNER_EDGES
    }

    fn inner_edge(&self, branch: Branch, edge: u8, slip: S, inner: Inner<S>) -> Option<Sloped<S>> {
        let Piece { region, full, dwelling } = branch.into();
        let within = match edge {
            DWELL => {
                let Sliding { stick, d_stick, .. } = self.sliding(region, slip);
                let one = S::one();
                let grows = Sloped {
                    value: stick - inner[1],
                    d_slip: d_stick,
                    d_inner: [S::zero(), -one],
                };
                if dwelling { grows } else { grows.negative() }
            }
            FORWARD_FULL => match full {
                1 => self.room(region, slip, inner, S::one()),
                2 => self.room(region, slip, inner, S::one()).negative(),
                _ => return None,
            },
            BACKWARD_FULL => match full {
                1 => self.room(region, slip, inner, -S::one()),
                0 => self.room(region, slip, inner, -S::one()).negative(),
                _ => return None,
            },
            _ => return None,
        };
        let overlap = self.overlap(slip, inner[1]);
        Some(Sloped {
            value: within.value + overlap.value,
            d_slip: within.d_slip + overlap.d_slip,
            d_inner: [0, 1].map(|of| within.d_inner[of] + overlap.d_inner[of]),
        })
    }

    fn across(&self, branch: Branch, edge: u8) -> Branch {
        let piece = Piece::from(branch);
        match edge {
            DWELL => Piece { dwelling: !piece.dwelling, ..piece },
            FORWARD_FULL => Piece { full: 3 - piece.full, ..piece },
            _ => Piece { full: 1 - piece.full, ..piece },
        }
        .into()
    }

    fn beyond(&self, branch: Branch, upward: bool, _: S) -> Branch {
        let piece = Piece::from(branch);
        let region = if upward { piece.region + 1 } else { piece.region - 1 };
        Piece { region, ..piece }.into()
    }

    fn slip_scale(&self) -> S {
        if self.transition < self.stribeck { self.transition } else { self.stribeck }
    }

    fn inner_scales(&self) -> Vec<f64> {
        vec![(self.coefficient / self.stiffness).to_f64(), 1.0]
    }

    #[inline(always)]
    fn inner_rates(&self, branch: Branch, slip: S, [z, w]: Inner<S>) -> [Sloped<S>; MOST_INNER] {
        let piece = Piece::from(branch);
        let sliding = self.sliding(piece.region, slip);
        let Sliding { stick, d_stick, direction, d_direction } = sliding;
        let free = S::one() - stick;
        let slid = (self.coefficient * direction - self.stiffness * z) / self.damping;
        let bend = Sloped {
            value: stick * slip + free * slid,
            d_slip: d_stick * (slip - slid)
                + stick
                + free * self.coefficient * d_direction / self.damping,
            d_inner: [-free * self.breaking, S::zero()],
        };
        let pace = if piece.dwelling { self.dwelling } else { self.breaking };
        let dwell = Sloped {
            value: (stick - w) * pace,
            d_slip: d_stick * pace,
            d_inner: [S::zero(), -pace],
        };
        [bend, dwell]
    }

    fn limit(&self) -> S {
        let bounded = self.viscous == S::zero();
        if bounded { self.coefficient + self.more } else { S::from_f64(f64::INFINITY) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::Value;
    use crate::scalar::{Decimal, Dual64};
    use proptest::prelude::*;

    /// μ_c = 0.1, μ_s = 0.15, σ0 = 1e4 1/m, σ1 = 10 s/m, v_s = 1e-2 m/s, τ_d = 1 ms, v_ε = 1.5e-2 m/s.
    fn law<S: Scalar>() -> Gonthier<S> {
        let all = [
            ("coefficient", "0.1"),
            ("static", "0.15"),
            ("stiffness", "1e4"),
            ("damping", "10.0"),
            ("viscous", "0.3"),
            ("stribeck", "1e-2"),
            ("dwell_time", "1e-3"),
            ("transition", "1.5e-2"),
        ];
        let value = |text: &str| Value::Number(Decimal::new(text).unwrap());
        let values = all
            .iter()
            .fold(Values::new(&KIND), |values, (key, text)| values.with(key, value(text)));
        Gonthier::new(&values, &Ends { hysteresis: S::from_f64(1e-7) })
    }

    fn pieces() -> impl Iterator<Item = Piece> {
        (0..18).map(|number| Piece::from(Branch(number)))
    }

    fn all<S: Scalar>(branch: Branch, slip: S, inner: Inner<S>) -> Vec<Sloped<S>> {
        let law = law::<S>();
        let edges = (0..3).filter_map(|edge| law.inner_edge(branch, edge, slip, inner));
        let rates = law.inner_rates(branch, slip, inner);
        [law.ratio(branch, slip, inner)].into_iter().chain(rates).chain(edges).collect()
    }

    proptest! {
        #[test]
        fn slopes_are_those_of_dual_numbers(
            slip in -0.05..0.05f64, z in -2e-5..2e-5f64, w in 0.0..1.0f64,
        ) {
            let dual = |x: f64, seed: bool| Dual64::new(x, f64::from(seed));
            for branch in pieces().map(Branch::from) {
                let found = all(branch, slip, [z, w]);
                for seed in 0..3 {
                    let at = dual(slip, seed == 0);
                    let exact = all(branch, at, [dual(z, seed == 1), dual(w, seed == 2)]);
                    for (found, exact) in found.iter().zip(&exact) {
                        let slope = [found.d_slip, found.d_inner[0], found.d_inner[1]][seed];
                        let exact = exact.value.eps;
                        prop_assert!(
                            (slope - exact).abs() <= 1e-11 * (1e2 + exact.abs()),
                            "{branch:?} {seed}: {slope} {exact}"
                        );
                    }
                }
            }
        }

        /// Whichever edge is crossed, the force does not jump, and the way back is not open yet.
        #[test]
        fn a_branch_goes_over_into_the_next(slip in -0.03..0.03f64, z in -3e-5..3e-5f64, w in 0.0..1.0f64) {
            let law = law::<f64>();
            for branch in pieces().map(Branch::from) {
                for edge in 0..3 {
                    // moves the dwell onto the edge, where there is one
                    let at = |w: f64| law.inner_edge(branch, edge, slip, [z, w]);
                    let Some(first) = at(w) else { continue };
                    let mut on = w - first.value / first.d_inner[1];
                    for _ in 0..20 {
                        let Some(here) = at(on) else { break };
                        on -= here.value / here.d_inner[1];
                    }
                    if !(0.0..=1.0).contains(&on) {
                        continue;
                    }
                    let next = law.across(branch, edge);
                    prop_assert_ne!(next, branch);
                    prop_assert_eq!(law.across(next, edge), branch);
                    let back = law.inner_edge(next, edge, slip, [z, on]);
                    prop_assert!(back.is_some_and(|back| back.value > 1e-11));
                    let [here, there] =
                        [branch, next].map(|branch| law.ratio(branch, slip, [z, on]).value);
                    prop_assert!((here - there).abs() < 1e-7, "{here} {there}");
                    let [here, there] =
                        [branch, next].map(|branch| law.inner_rates(branch, slip, [z, on])[1].value);
                    prop_assert!((here - there).abs() < 1e-3, "{here} {there}");
                }
            }
        }
    }

    #[test]
    fn regions_of_the_slip_meet_smoothly_and_keep_the_other_digits() {
        let law = law::<f64>();
        for (piece, upward) in pieces().flat_map(|piece| [(piece, false), (piece, true)]) {
            let (lower, upper) = law.edges(piece.into());
            let at = if upward { upper } else { lower };
            if !at.is_finite() {
                continue;
            }
            let next = law.beyond(piece.into(), upward, at);
            assert_eq!((Piece::from(next).full, Piece::from(next).dwelling), (piece.full, piece.dwelling));
            let (lower, upper) = law.edges(next);
            assert!(lower < at && at < upper);
            let [here, there] = [piece.into(), next].map(|branch| law.ratio(branch, at, [5e-6, 0.3]));
            assert!((here.value - there.value).abs() < 1e-12);
            assert!((here.d_slip - there.d_slip).abs() < 1e-5);
        }
    }

    #[test]
    fn a_contact_begins_in_the_branch_of_its_slip() {
        let law = law::<f64>();
        for slip in [-0.4, -1.6e-2, -1.2e-2, -1e-3, 0.0, 2e-3, 1.1e-2, 1.4e-2, 2e-2, 3.0] {
            let branch = law.branch(slip, 1.0);
            let (lower, upper) = law.edges(branch);
            assert!(lower < slip && slip < upper, "{slip}");
            for edge in 0..3 {
                let within = law.inner_edge(branch, edge, slip, [0.0; 2]);
                assert!(within.is_none_or(|within| within.value > 0.0), "{slip}: {edge}");
            }
        }
        assert_eq!(Piece::from(law.branch(0.0, 1.0)), Piece { region: 1, full: 1, dwelling: true });
    }

    #[test]
    fn fast_slip_has_coulombs_friction_at_once() {
        let law = law::<f64>();
        for slip in [-2.0, -0.1, 0.1, 2.0] {
            let ratio = law.ratio(law.branch(slip, 0.0), slip, [0.0; 2]).value;
            assert!((ratio + 0.1_f64.copysign(slip) + 0.3 * slip).abs() < 1e-15);
        }
    }

    /// What bristles and dwell come to after a time at a steady slip, by Runge's and Kutta's method,
    /// the branch changed where an edge is crossed.
    fn after(time: f64, slip: f64, steps: u32) -> (Branch, Inner<f64>) {
        let law = law::<f64>();
        let (mut branch, mut at) = (law.branch(slip, 0.0), [0.0; 2]);
        let h = time / f64::from(steps);
        for _ in 0..steps {
            let rate = |at: Inner<f64>| law.inner_rates(branch, slip, at).map(|rate| rate.value);
            let go = |k: Inner<f64>, h: f64| [at[0] + h * k[0], at[1] + h * k[1]];
            let k1 = rate(at);
            let k2 = rate(go(k1, 0.5 * h));
            let k3 = rate(go(k2, 0.5 * h));
            let k4 = rate(go(k3, h));
            let sum = [0, 1].map(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
            at = go(sum, h);
            for edge in 0..3 {
                let within = law.inner_edge(branch, edge, slip, at);
                if within.is_some_and(|within| within.value < 0.0) {
                    branch = law.across(branch, edge);
                }
            }
        }
        (branch, at)
    }

    /// ż = ẇ = 0: σ0 z = μ_c d + s v σ1/(1 − s), w = s, and F_T = sat(σ0 z) + σ2 v.
    #[test]
    fn steady_slip_has_the_friction_of_its_curve() {
        let law = law::<f64>();
        for slip in [3e-3, 8e-3, 1.2e-2, 2e-2, -1.2e-2, -3e-2_f64] {
            let s = (-(slip / 1e-2).powi(2)).exp();
            let u = (slip / 1.5e-2).clamp(-1.0, 1.0);
            let bent = 0.1 * u * (3.0 - u * u) / 2.0 + s * slip * 10.0 / (1.0 - s);
            let most = 0.1 + 0.05 * s;
            let expected = -(bent.clamp(-most, most) + 0.3 * slip);
            // σ0/σ1 = 1000/s, slowed by 1 − s
            let (branch, at) = after(40e-3 / (1.0 - s), slip, 40_000);
            assert!((1e4 * at[0] - bent).abs() < 1e-9 * bent.abs(), "{slip}: {at:?}");
            assert!((at[1] - s).abs() < 1e-9, "{slip}: {at:?} {s}");
            let found = law.ratio(branch, slip, at).value;
            assert!((found - expected).abs() < 1e-9, "{slip}: {found} {expected}");
        }
    }

    #[test]
    fn at_rest_the_break_away_force_grows_with_the_dwell_time() {
        let law = law::<f64>();
        for time in [1e-4_f64, 1e-3, 3e-3] {
            let (branch, at) = after(time, 0.0, 2000);
            let grown = 1.0 - (-time / 1e-3).exp();
            assert!((at[1] - grown).abs() < 1e-12 && at[0] == 0.0);
            // pulled to its limit
            let room = law.inner_edge(branch, FORWARD_FULL, 0.0, [0.0, at[1]]).unwrap().value;
            assert!((0.15 * room - (0.1 + 0.05 * grown)).abs() < 1e-7, "{room}");
        }
    }

    #[test]
    fn held_bristles_are_a_spring_and_a_damper() {
        let law = law::<f64>();
        let branch = law.branch(0.0, 1.0);
        let force = law.ratio(branch, 0.0, [5e-6, 0.0]);
        assert_eq!(force.value, -1e4 * 5e-6);
        assert!((force.d_slip + 10.0 + 0.3).abs() < 1e-12);
        assert_eq!(law.inner_rates(branch, 0.0, [5e-6, 0.0])[0].value, 0.0);
    }
}
