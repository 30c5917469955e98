//! Elasto-plastic friction: LuGre's bristles, which do not creep below break-away.
//! ```text
//! F_T = −F_N (σ0 z + σ1 ż + σ2 v_T)
//! ż   = v_T (1 − α z s/z_ss),   s = v_T/|v_T|,   z_ss = {μ_d + (μ_s − μ_d) exp[−(v_T/v_s)²]}/σ0
//! α   = 0                                                         s z ≤ z_ba
//! α   = ½ + ½ sin{π [s z − (z_ss + z_ba)/2]/(z_ss − z_ba)}         z_ba < s z < z_ss
//! α   = 1                                                         z_ss ≤ s z
//! ```
//! | symbol   | key                     | unit | meaning                                               |
//! |----------|-------------------------|------|-------------------------------------------------------|
//! | z        |                         | m    | mean deflection of the bristles                       |
//! | σ0       | `stiffness`             | 1/m  | stiffness of the bristles over the normal force       |
//! | σ1, σ2   | `damping`, `viscous`    | s/m  | their damping, and viscous friction, likewise         |
//! | μ_d, μ_s | `coefficient`, `static` | –    | coefficients of sliding and of rest                   |
//! | v_s      | `stribeck`              | m/s  | Stribeck's velocity                                   |
//! | z_ba     | `elastic_share`         | m    | that share of μ_d/σ0: bristles bend elastically so far|
//!
//! (P. Dupont, V. Hayward, B. Armstrong, F. Altpeter, Single state elastoplastic friction models, IEEE
//! Trans. Automat. Control 47(5):787–792, 2002, doi 10.1109/TAC.2002.1000274, written by the ratio
//! F_T/F_N. A public code leaves out |z| inside the sine and the rule of signs, and has a constant for
//! z_ss; here both are as the paper is quoted elsewhere. The print was not seen.)
//!
//! Where s z ≤ z_ba the bristles follow the slip, z = ∫v_T dt: a load that swings below σ0 z_ba makes
//! no way, where Dahl's and LuGre's law creep. Sliding steadily it is LuGre's law.
//!
//! ż has a kink at v_T = 0, which is the edge between two branches. At z_ba and z_ss its slope is
//! steady and its second derivative jumps; steps are controlled across that. In 71 digits they become
//! so many that a certificate of case a ends at 3.08 ms (`docs/laws.md`). Bristles are straight when a contact begins; where the normal law pulls they bend as
//! before, and hold nothing.

use super::{Branch, COEFFICIENT, Ends, FrictionLaw, Inner, MOST_INNER, Sloped, rest_holds};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "elasto-plastic",
    title: "bristles that bend elastically below break-away: a load at rest makes no way",
    source: "Dupont, Hayward, Armstrong, Altpeter 2002, IEEE Trans. Automat. Control 47(5):787–792, doi 10.1109/TAC.2002.1000274",
    example: r#"[joints.A.clearance]
friction = { law = "elasto-plastic", coefficient = 0.1, static = 0.15, stiffness = 1e4, damping = 10.0, stribeck = 1e-2, elastic_share = 0.7 }"#,
    keys: &[
        COEFFICIENT,
        Key::new("static", Takes::Number(Range::NotNegative), "", "coefficient μ_s of rest, not less than `coefficient`"),
        Key::new("stiffness", Takes::Number(Range::Positive), "1/m", "stiffness σ0 of the bristles over the normal force"),
        Key::new("damping", Takes::Number(Range::NotNegative), "s/m", "damping σ1 of the bristles over the normal force").or("0.0"),
        Key::new("viscous", Takes::Number(Range::NotNegative), "s/m", "viscous friction σ2 over the normal force").or("0.0"),
        Key::new("stribeck", Takes::Number(Range::Positive), "m/s", "Stribeck's velocity v_s"),
        Key::new("elastic_share", Takes::Number(Range::Positive), "", "share of the deflection μ_d/σ0 up to which bristles bend elastically, less than 1").or("0.7"),
    ],
    also: Some(breaks_away),
};

/// Bristles yield before they slide, and friction of rest is no less than that of sliding.
fn breaks_away(values: &Values) -> Vec<(&'static str, String)> {
    let share = values.decimal("elastic_share").filter(|share| share.to_f64() >= 1.0);
    let mut wrong = rest_holds(values);
    wrong.extend(share.map(|share| ("elastic_share", format!("must be less than 1, is {share}"))));
    wrong
}

const BACKWARD: Branch = Branch(0);
const FORWARD: Branch = Branch(1);

/// The law and its parameters.
#[derive(Debug, Clone, Copy)]
pub struct ElastoPlastic<S> {
    /// μ_d/σ0 and (μ_s − μ_d)/σ0 (m).
    sliding: S,
    more: S,
    /// z_ba (m).
    elastic: S,
    stiffness: S,
    damping: S,
    viscous: S,
    stribeck: S,
    hysteresis: S,
}

impl<S: Scalar> ElastoPlastic<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let number = |key: &str| values.number::<S>(key);
        let (coefficient, stiffness) = (number("coefficient"), number("stiffness"));
        let sliding = coefficient / stiffness;
        ElastoPlastic {
            sliding,
            more: (number("static") - coefficient) / stiffness,
            elastic: number("elastic_share") * sliding,
            stiffness,
            damping: number("damping"),
            viscous: number("viscous"),
            stribeck: number("stribeck"),
            hysteresis: ends.hysteresis * number("stribeck"),
        }
    }

    /// α at a deflection s z and z_ss, and its derivatives by both.
    #[inline(always)]
    fn yielding(&self, bent: S, steady: S) -> (S, S, S) {
        let (zero, one) = (S::zero(), S::one());
        if bent <= self.elastic {
            return (zero, zero, zero);
        }
        if bent >= steady {
            return (one, zero, zero);
        }
        let half = S::from_f64(0.5);
        let width = steady - self.elastic;
        let turn = S::pi() / width;
        let off = bent - half * (steady + self.elastic);
        let (sin, cos) = (turn * off).sin_cos();
        let slope = half * cos * turn;
        (half + half * sin, slope, -slope * (half + off / width))
    }

    /// ż and its slopes.
    #[inline(always)]
    fn bend(&self, branch: Branch, slip: S, z: S) -> Sloped<S> {
        let x = slip / self.stribeck;
        let rest = self.more * (-(x * x)).exp();
        let steady = self.sliding + rest;
        let steady_slope = -(x + x) * rest / self.stribeck;
        let sign = if branch == FORWARD { S::one() } else { -S::one() };
        let bent = sign * z;
        let (alpha, by_bent, by_steady) = self.yielding(bent, steady);
        let share = alpha * bent / steady;
        let share_slope = (by_steady * bent - share) / steady * steady_slope;
        Sloped::by_deflection(slip * (S::one() - share), S::one() - share - slip * share_slope, -slip * sign * (by_bent * bent + alpha) / steady)
    }
}

impl<S: Scalar> FrictionLaw<S> for ElastoPlastic<S> {
    #[inline(always)]
    fn ratio(&self, branch: Branch, slip: S, [z, _]: Inner<S>) -> Sloped<S> {
        let bend = self.bend(branch, slip, z);
        Sloped::by_deflection(-(self.stiffness * z + self.damping * bend.value + self.viscous * slip), -(self.damping * bend.d_slip + self.viscous), -(self.stiffness + self.damping * bend.d_inner[0]))
    }

    /// Branches overlap by the hysteresis, where the slip's acceleration decides.
    fn branch(&self, slip: S, acceleration: S) -> Branch {
        let towards = if slip.abs() > self.hysteresis { slip } else { acceleration };
        if towards > S::zero() { FORWARD } else { BACKWARD }
    }

    fn edges(&self, branch: Branch) -> (S, S) {
        let far = S::from_f64(f64::INFINITY);
        match branch {
            BACKWARD => (-far, self.hysteresis),
            _ => (-self.hysteresis, far),
        }
    }

    fn beyond(&self, _: Branch, upward: bool, _: S) -> Branch {
        if upward { FORWARD } else { BACKWARD }
    }

    fn slip_scale(&self) -> S {
        self.stribeck
    }

    fn inner_scales(&self) -> Vec<f64> {
        vec![self.sliding.to_f64()]
    }

    #[inline(always)]
    fn inner_rates(&self, branch: Branch, slip: S, [z, _]: Inner<S>) -> [Sloped<S>; MOST_INNER] {
        [self.bend(branch, slip, z), Sloped::none()]
    }

    /// None: damping and viscous friction grow with the slip.
    fn limit(&self) -> S {
        S::from_f64(f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::super::bristle;
    use super::*;
    use crate::parameter::Value;
    use crate::scalar::{Decimal, Dual64};
    use proptest::prelude::*;

    /// μ_d = 0.1, μ_s = 0.15, σ0 = 1e4 1/m, v_s = 1e-2 m/s, z_ba = 7 µm.
    fn law<S: Scalar>() -> ElastoPlastic<S> {
        let all = [
            ("coefficient", "0.1"),
            ("static", "0.15"),
            ("stiffness", "1e4"),
            ("damping", "10.0"),
            ("viscous", "0.3"),
            ("stribeck", "1e-2"),
            ("elastic_share", "0.7"),
        ];
        let value = |text: &str| Value::Number(Decimal::new(text).unwrap());
        let values = all
            .iter()
            .fold(Values::new(&KIND), |values, (key, text)| values.with(key, value(text)));
        ElastoPlastic::new(&values, &Ends { hysteresis: S::from_f64(1e-7) })
    }

    proptest! {
        #[test]
        fn slopes_are_those_of_dual_numbers(slip in -0.05..0.05f64, share in -2.0..2.0f64) {
            let z = share * 1e-5;
            for branch in [BACKWARD, FORWARD] {
                let by_slip = [
                    bristle(&law::<Dual64>(), (branch, Dual64::new(slip, 1.0), Dual64::from_re(z)))[0],
                    bristle(&law::<Dual64>(), (branch, Dual64::new(slip, 1.0), Dual64::from_re(z)))[1],
                ];
                let by_inner = [
                    bristle(&law::<Dual64>(), (branch, Dual64::from_re(slip), Dual64::new(z, 1.0)))[0],
                    bristle(&law::<Dual64>(), (branch, Dual64::from_re(slip), Dual64::new(z, 1.0)))[1],
                ];
                let found = [
                    bristle(&law::<f64>(), (branch, slip, z))[0], bristle(&law::<f64>(), (branch, slip, z))[1],
                ];
                for ((found, slip), inner) in found.iter().zip(&by_slip).zip(&by_inner) {
                    let (slip, inner) = (slip.value.eps, inner.value.eps);
                    prop_assert!((found.d_slip - slip).abs() <= 1e-12 * (1.0 + slip.abs()));
                    prop_assert!((found.d_inner[0] - inner).abs() <= 1e-12 * (1e4 + inner.abs()));
                }
            }
        }

        /// No more than the steady deflection, whatever the slip does.
        #[test]
        fn bristles_never_bend_further_than_they_do_in_steady_slip(slip in -0.1..0.1f64) {
            let law = law::<f64>();
            let branch = law.branch(slip, 0.0);
            let steady = 1e-5 + 5e-6 * (-(slip / 1e-2).powi(2)).exp();
            let full = steady.copysign(slip);
            prop_assert!(bristle(&law, (branch, slip, full))[1].value.abs() <= 1e-15);
            prop_assert!(bristle(&law, (branch, slip, 1.2 * full))[1].value * full <= 0.0);
        }
    }

    #[test]
    fn below_break_away_bristles_follow_the_slip_whichever_way_it_goes() {
        let law = law::<f64>();
        for z in [-6.9e-6, -1e-6, 0.0, 5e-6, 6.9e-6] {
            for (branch, slip) in [(FORWARD, 3e-3), (BACKWARD, -2e-2)] {
                assert_eq!(bristle(&law, (branch, slip, z))[1].value, slip);
            }
        }
        // bent the other way they spring back elastically from any deflection
        assert_eq!(bristle(&law, (BACKWARD, -1e-3, 1.4e-5))[1].value, -1e-3);
    }

    #[test]
    fn alpha_and_its_slope_are_steady_where_bristles_begin_to_yield_and_to_slide() {
        let law = law::<f64>();
        // the slope is 3e5/m between them
        for (at, value) in [(7e-6, 0.0), (1.2e-5, 1.0)] {
            for side in [-1e-12, 1e-12] {
                let (alpha, slope, _) = law.yielding(at + side, 1.2e-5);
                assert!((alpha - value).abs() < 1e-12 && slope.abs() < 1.0, "{alpha} {slope}");
            }
        }
    }

    /// At a steady slip dz/dx = 1 − α z/z_ss is a function of z alone, and the way x a quadrature.
    #[test]
    fn the_way_to_a_deflection_is_its_quadrature() {
        let (law, slip) = (law::<f64>(), 5e-3);
        let steady = 1e-5 + 5e-6 * (-0.25_f64).exp();
        let end = 0.99 * steady;
        let slope = |z: f64| {
            let alpha = match (z - 7e-6) / (steady - 7e-6) {
                u if u <= 0.0 => 0.0,
                u => 0.5 * (1.0 - (std::f64::consts::PI * u).cos()),
            };
            1.0 - alpha * z / steady
        };
        let parts = 200_000;
        let width = end / f64::from(parts);
        let way: f64 = (0..parts).map(|k| width / slope((f64::from(k) + 0.5) * width)).sum();
        // classical Runge–Kutta, in steps of that way
        let (steps, mut z) = (20_000, 0.0);
        let h = way / slip / f64::from(steps);
        let rate = |z: f64| bristle(&law, (FORWARD, slip, z))[1].value;
        for _ in 0..steps {
            let k1 = rate(z);
            let k2 = rate(z + 0.5 * h * k1);
            let k3 = rate(z + 0.5 * h * k2);
            let k4 = rate(z + h * k3);
            z += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        }
        assert!((z / end - 1.0).abs() < 1e-9, "{z:e} {end:e}");
    }
}
