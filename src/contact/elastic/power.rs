//! Power law: Hertz's contact of two spheres for n = 3/2, a spring for n = 1.
//! ```text
//! F_e = K δⁿ
//! ```
//! | symbol | key         | unit | meaning                                                        |
//! |--------|-------------|------|----------------------------------------------------------------|
//! | K      | `stiffness` | N/mⁿ | a number, or from radii and materials ([`super::super::stiffness`]) |
//! | n      | `exponent`  | –    | 3/2 unless given, at least 1                                   |
//!
//! (H. Hertz, Über die Berührung fester elastischer Körper, Journal für die reine und angewandte
//! Mathematik 92, 1882, 156–171.) With `"hertz-internal"` and n from 1 to 3/2 this is what papers on
//! clearance joints call Lankarani's and Nikravesh's law for cylinders: K is that of spheres, and
//! knows no length.

use super::super::stiffness::{hertz_internal, hertz_printed};
use super::{ElasticLaw, Ends, POISSON, YOUNG, materials};
use crate::parameter::{Key, Kind, Otherwise, Range, Takes, Value, Values, in_brackets};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "power",
    title: "F_e = K δⁿ: Hertz's contact of spheres for n = 1.5, a spring for n = 1",
    source: "Hertz 1882, J. reine angew. Math. 92:156–171",
    example: r#"[joints.A.clearance]
normal = { law = "lankarani-nikravesh", restitution = 0.9, elastic = "power", stiffness = "hertz-printed", young = 207e9, poisson = 0.3 }"#,
    keys: &[
        Key::new("stiffness", Takes::NumberOr(Range::Positive, &["hertz-printed", "hertz-internal"]), "N/mⁿ", "K: by the paper's equation 5, of a journal inside its bearing, or a number; of a corner or a pin on a plane both words are the same"),
        Key { otherwise: Otherwise::Absent, ..YOUNG },
        Key { otherwise: Otherwise::Absent, ..POISSON },
        Key::new("exponent", Takes::Number(Range::AtLeastOne), "", "exponent n of the depth").or("1.5"),
    ],
    also: Some(material_where_it_is_used),
};

/// A stiffness from materials needs each constant, one given as a number takes none.
fn material_where_it_is_used(values: &Values) -> Vec<(&'static str, String)> {
    let complaint = |key: &super::Key| match (values.get("stiffness")?, values.get(key.name)) {
        (Value::Number(_), Some(_)) => Some("is not used where stiffness is a number".to_owned()),
        (Value::Text(word), None) if !word.is_empty() => {
            Some(format!("is missing{}; stiffness {word:?} needs it", in_brackets(key.unit)))
        }
        _ => None,
    };
    [YOUNG, POISSON].iter().filter_map(|key| Some((key.name, complaint(key)?))).collect()
}

/// The largest q for which contacts are followed in the q-th root of their depth.
const LARGEST_DEGREE: u32 = 10;
/// The most factors that a power is multiplied together of.
const MOST_FACTORS: f64 = 100.0;

/// The exponent n of the penetration; Hertz's 3/2 and whole ones need no power function.
#[derive(Debug, Clone, Copy)]
enum Exponent<S> {
    Whole(u32),
    ThreeHalves,
    Other(S),
}

/// K δⁿ.
#[derive(Debug, Clone, Copy)]
pub struct Power<S> {
    stiffness: S,
    exponent: Exponent<S>,
    /// (q, n q), where n is a multiple of 1/q.
    fraction: Option<(u32, u32)>,
}

impl<S: Scalar> Power<S> {
    /// The law that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let (bearing, journal) = (ends.bearing, ends.journal);
        let stiffness = match values.text("stiffness") {
            "hertz-printed" => hertz_printed(materials(values), bearing, journal),
            "hertz-internal" => hertz_internal(materials(values), bearing, journal),
            _ => values.number("stiffness"),
        };
        Power::with(stiffness, values.number("exponent"))
    }

    /// A law with stiffness K (N/mⁿ) and exponent n.
    pub fn with(stiffness: S, exponent: S) -> Self {
        let multiple = |q: u32| (exponent.to_f64() * f64::from(q)).round();
        // to rounding: in 71 digits 1.3333333333333333 is not four thirds
        let is_multiple = |q: u32| {
            let off = exponent * S::from_f64(f64::from(q)) - S::from_f64(multiple(q));
            multiple(q) <= MOST_FACTORS && off.to_f64().abs() <= 4.0 * S::EPSILON * multiple(q)
        };
        let fraction =
            (1..=LARGEST_DEGREE).find(|q| is_multiple(*q)).map(|q| (q, multiple(q) as u32));
        let exponent = match fraction {
            Some((1, whole)) if whole > 0 => Exponent::Whole(whole),
            Some((2, 3)) => Exponent::ThreeHalves,
            _ => Exponent::Other(exponent),
        };
        Power { stiffness, exponent, fraction }
    }

    fn exponent(&self) -> S {
        match self.exponent {
            Exponent::Whole(n) => S::from_f64(f64::from(n)),
            Exponent::ThreeHalves => S::ratio(3, 2),
            Exponent::Other(n) => n,
        }
    }
}

impl<S: Scalar> ElasticLaw<S> for Power<S> {
    #[inline(always)]
    fn force(&self, depth: S) -> (S, S) {
        let k = self.stiffness;
        match self.exponent {
            Exponent::Whole(n) => {
                let slope = (1..n).fold(k, |product, _| product * depth);
                (slope * depth, S::from_f64(f64::from(n)) * slope)
            }
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

    fn energy(&self, depth: S) -> S {
        self.force(depth).0 * depth / (self.exponent() + S::one())
    }

    #[inline(always)]
    fn goes_on_below(&self) -> bool {
        matches!(self.exponent, Exponent::Whole(_))
    }

    #[inline(always)]
    fn degree(&self) -> Option<u32> {
        self.fraction.map(|(q, _)| q)
    }

    #[inline(always)]
    fn force_from_root(&self, root: S) -> Option<(S, S)> {
        let (q, whole) = self.fraction?;
        let power = |k: u32| (0..k).fold(S::one(), |product, _| product * root);
        match (q, whole) {
            (2, 3) => {
                let slope = self.stiffness * root;
                Some((slope * (root * root), S::from_f64(1.5) * slope))
            }
            _ if whole >= q => {
                let slope = self.stiffness * power(whole - q);
                Some((slope * power(q), self.exponent() * slope))
            }
            _ => None,
        }
    }

    fn power(&self) -> Option<(S, S)> {
        Some((self.stiffness, self.exponent()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_without_sense_cost_no_more_than_others() {
        // four thousand million factors were multiplied together, whatever the exponent was beyond that
        for exponent in [101.0, 1e5, 4294967295.0, 9223372036854775807.0, 1e300] {
            let law = Power::<f64>::with(2.0, exponent);
            let (force, slope) = law.force(0.999);
            assert_eq!(force, 2.0 * 0.999_f64.powf(exponent));
            assert!((slope - exponent * force / 0.999).abs() <= 1e-12 * slope, "{exponent}");
            assert!(law.force_from_root(0.999).is_none());
        }
    }
    use crate::scalar::F256;

    #[test]
    fn fractions_of_small_denominators_are_found() {
        let degree = |n: f64| Power::with(1.04e10, n).degree();
        assert_eq!([1.5, 1.0, 1.3, 4.0 / 3.0].map(degree), [Some(2), Some(1), Some(10), Some(3)]);
        assert_eq!(degree(1.37), None);
        let octuple = Power::with(F256::one(), F256::from_f64(1.3));
        assert_eq!(octuple.degree(), None, "the double nearest to 1.3 is not 13/10");
    }
}
