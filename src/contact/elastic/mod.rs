//! Elastic laws of the normal force, one file a law: F_e(δ), to which any damping comes.
//!
//! A law gives F_e and its slope at a penetration δ > 0; it is zero at δ = 0, rises with δ, and is
//! never negative. A new law is a file here and its line in the list of kinds.
//!
//! The cylinder laws are those of the line contact of two parallel cylinders, journal in bearing, of
//! a length L. They do not agree with each other: of the same joint one may be three times as soft as
//! another (`freeplay laws` tells by how much).

mod logarithmic;

use super::stiffness::Material;
use crate::parameter::{Key, Kind, Range, Takes, Values, kinds};
use crate::scalar::Scalar;

kinds! { $
    /// An elastic law of any kind.
    #[derive(Copy)]
    Elastic, each_elastic:
    Power in power,
    Johnson in johnson,
    Radzimovsky in radzimovsky,
    DubowskyFreudenstein in dubowsky_freudenstein,
    Esdu in esdu,
    Liu in liu,
    Pereira in pereira,
    #[cfg(test)]
    Scratch in scratch,
}

/// The kind of the power law, the default.
pub const POWER: &Kind = &power::KIND;

/// What a law is made of beside its values.
#[derive(Debug, Clone, Copy)]
pub struct Ends<S> {
    /// Radius of the bearing R_b (m); infinite where it is a plane.
    pub bearing: S,
    /// Radius of the journal R_j (m).
    pub journal: S,
}

impl<S: Scalar> Ends<S> {
    /// A corner or a pin of this radius (m) on a plane.
    pub fn on_a_plane(radius: S) -> Self {
        Ends { bearing: S::from_f64(f64::INFINITY), journal: radius }
    }

    /// Radial clearance c = R_b − R_j (m).
    fn radial(&self) -> S {
        self.bearing - self.journal
    }
}

/// What an elastic law tells.
pub trait ElasticLaw<S: Scalar> {
    /// F_e (N) and dF_e/dδ (N/m) at a positive depth (m); at any if the law goes on below zero.
    fn force(&self, depth: S) -> (S, S);

    /// Energy (J) stored at a positive depth (m): the integral of F_e from zero.
    fn energy(&self, depth: S) -> S;

    /// Whether the law goes on smoothly below zero depth.
    fn goes_on_below(&self) -> bool {
        false
    }

    /// The q such that F_e is a power series in δ^(1/q) from δ on; `None` where there is none that is
    /// of use.
    fn degree(&self) -> Option<u32> {
        None
    }

    /// F_e (N) and dF_e/dδ (N/m) at the depth r^q, from the root r with its sign, for the q of
    /// [`degree`](Self::degree): analytic in r, with no case for r < 0. `None` where the law has no
    /// degree.
    fn force_from_root(&self, root: S) -> Option<(S, S)> {
        let _ = root;
        None
    }

    /// The depth (m) at which the law ends; infinite where it does not.
    fn deepest(&self) -> f64 {
        f64::INFINITY
    }

    /// K (N/mⁿ) and n, where the law is K δⁿ.
    fn power(&self) -> Option<(S, S)> {
        None
    }

    /// Why the law says nothing about radii and materials like these.
    fn objection(&self) -> Option<String> {
        None
    }
}

impl<S: Scalar> ElasticLaw<S> for Elastic<S> {
    #[inline(always)]
    fn force(&self, depth: S) -> (S, S) {
        each_elastic!(self, law => law.force(depth))
    }

    fn energy(&self, depth: S) -> S {
        each_elastic!(self, law => law.energy(depth))
    }

    #[inline(always)]
    fn goes_on_below(&self) -> bool {
        each_elastic!(self, law => law.goes_on_below())
    }

    #[inline(always)]
    fn degree(&self) -> Option<u32> {
        each_elastic!(self, law => law.degree())
    }

    #[inline(always)]
    fn force_from_root(&self, root: S) -> Option<(S, S)> {
        each_elastic!(self, law => law.force_from_root(root))
    }

    fn deepest(&self) -> f64 {
        each_elastic!(self, law => law.deepest())
    }

    fn power(&self) -> Option<(S, S)> {
        each_elastic!(self, law => law.power())
    }

    fn objection(&self) -> Option<String> {
        each_elastic!(self, law => law.objection())
    }
}

/// Young's moduli of both materials, needed.
const YOUNG: Key = Key::new(
    "young",
    Takes::OfMaterials(Range::Positive),
    "Pa",
    "Young's modulus; one number for both materials, or two, the bearing's first",
);

/// Poisson's ratios of both materials, needed.
const POISSON: Key = Key::new(
    "poisson",
    Takes::OfMaterials(Range::PoissonRatio),
    "",
    "Poisson's ratio; one number for both materials, or two, the bearing's first",
);

/// The length of a line contact.
const LENGTH: Key = Key::new(
    "length",
    Takes::Number(Range::Positive),
    "m",
    "length L over which journal and bearing touch, along the axis",
);

/// The materials of bearing and journal, as the keys have them.
fn materials<S: Scalar>(values: &Values) -> [Material<S>; 2] {
    let [young, poisson] = ["young", "poisson"].map(|key| values.of_materials::<S>(key));
    [0, 1].map(|k| Material { young: young[k], poisson: poisson[k] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::Value;
    use crate::scalar::{Decimal, Dual64, F256};
    use proptest::prelude::*;

    /// Bearing 10 mm, journal 9.5 mm, length 15 mm, steel: the joint of the law comparison by which
    /// the formulas were checked.
    fn law<S: Scalar>(kind: &'static Kind) -> Elastic<S> {
        let number = |text: &str| S::parse(text).unwrap();
        let ends = Ends { bearing: number("0.010"), journal: number("0.0095") };
        law_of(kind, ends)
    }

    fn law_of<S: Scalar>(kind: &'static Kind, ends: Ends<S>) -> Elastic<S> {
        let number = |text: &str| Decimal::new(text).unwrap();
        let same = |text: &str| Value::Materials([number(text), number(text)]);
        let mut values = Values::new(kind);
        for key in kind.keys {
            let value = match key.name {
                "young" => same("207e9"),
                "poisson" => same("0.3"),
                "length" => Value::Number(number("0.015")),
                "stiffness" if kind.word == "power" => Value::Text("hertz-internal".into()),
                "stiffness" => Value::Number(number("1e7")),
                "depth" => Value::Number(number("1e-4")),
                "exponent" => Value::Number(number("1.5")),
                other => panic!("no value for {other}"),
            };
            values = values.with(key.name, value);
        }
        Elastic::new(&values, &ends).unwrap()
    }

    /// The depth (m) at which a law bears a force (N).
    fn depth_under<S: Scalar>(law: &Elastic<S>, force: S) -> S {
        let (mut low, mut high) = (S::zero(), S::from_f64(1e-4));
        for _ in 0..400 {
            let middle = (low + high) * S::ratio(1, 2);
            if law.force(middle).0 < force { low = middle } else { high = middle }
        }
        low
    }

    /// Depths (µm) under 1 kN, from the formulas solved with 30 digits apart from this program.
    #[test]
    fn each_law_is_pressed_in_as_far_as_its_formula_says() {
        for (word, expected) in [
            ("power", 6.116_791_4),
            ("johnson", 1.544_828_4),
            ("radzimovsky", 1.597_139_7),
            ("dubowsky-freudenstein", 1.820_204_0),
            ("esdu-78035", 1.917_984_0),
            ("liu", 5.201_053_9),
            ("pereira", 1.462_737_3),
        ] {
            let kind = KINDS.iter().find(|kind| kind.word == word).unwrap();
            let found = 1e6 * depth_under(&law::<f64>(kind), 1000.0);
            assert!((found - expected).abs() < 1e-7, "{word}: {found} µm, expected {expected}");
        }
    }

    proptest! {
        #[test]
        fn slopes_and_forces_are_derivatives_of_force_and_energy(exponent in -10.0..-4.5f64) {
            let depth = 10_f64.powf(exponent);
            for kind in KINDS {
                let (real, dual) = (law::<f64>(kind), law::<Dual64>(kind));
                let (force, slope) = real.force(depth);
                let along = dual.force(Dual64::new(depth, 1.0)).0;
                prop_assert!((along.re - force).abs() <= 1e-14 * force, "{}", kind.word);
                prop_assert!((along.eps - slope).abs() <= 1e-12 * slope, "{}: {} {slope}", kind.word, along.eps);
                let energy = dual.energy(Dual64::new(depth, 1.0));
                prop_assert!((energy.eps - force).abs() <= 1e-12 * force, "{}: {} {force}", kind.word, energy.eps);
            }
        }

        #[test]
        fn doubles_are_those_of_71_digits(exponent in -12.0..-4.0f64) {
            let depth = 10_f64.powf(exponent);
            for kind in KINDS {
                let (force, slope) = law::<f64>(kind).force(depth);
                let (f, s) = law::<F256>(kind).force(F256::from_f64(depth));
                prop_assert!((force / f.to_f64() - 1.0).abs() < 1e-14, "{}: {force}", kind.word);
                prop_assert!((slope / s.to_f64() - 1.0).abs() < 1e-14, "{}: {slope}", kind.word);
                let energy = law::<f64>(kind).energy(depth);
                let exact = law::<F256>(kind).energy(F256::from_f64(depth)).to_f64();
                prop_assert!((energy / exact - 1.0).abs() < 1e-14, "{}: {energy}", kind.word);
            }
        }
    }

    #[test]
    fn the_force_from_a_root_is_that_of_its_depth_and_goes_on_below_zero() {
        for kind in KINDS {
            let law = law::<f64>(kind);
            let Some(q) = law.degree() else {
                assert!(law.force_from_root(1e-3).is_none());
                continue;
            };
            let root = 1e-5_f64.powf(1.0 / f64::from(q));
            let (by_depth, by_root) = (law.force(1e-5), law.force_from_root(root).unwrap());
            assert!((by_depth.0 / by_root.0 - 1.0).abs() < 1e-14, "{}", kind.word);
            assert!((by_depth.1 / by_root.1 - 1.0).abs() < 1e-14, "{}", kind.word);
            let mirrored = law.force_from_root(-root).unwrap();
            assert!((mirrored.0.abs() / by_root.0 - 1.0).abs() < 1e-14, "{}", kind.word);
        }
    }

    #[test]
    fn a_fit_objects_to_clearances_that_it_was_not_made_for() {
        let kind = KINDS.iter().find(|kind| kind.word == "pereira").unwrap();
        let objection = |journal: f64| law_of(kind, Ends { bearing: 0.02, journal }).objection();
        assert_eq!(objection(0.0195), None);
        assert!(objection(0.0099).is_some() && objection(0.019996).is_some());
    }

    #[test]
    fn every_law_says_where_it_is_from() {
        for kind in KINDS.iter().filter(|kind| kind.word != "hardening") {
            assert!(!kind.title.is_empty() && !kind.source.is_empty(), "{}", kind.word);
        }
    }
}
