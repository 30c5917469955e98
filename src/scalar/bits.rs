//! Numbers in all their bits, for what is kept and must come back the same: with serde,
//! `#[serde(with = "bits")]` of a number and `#[serde(with = "bits::list")]` of a list of them.
//!
//! Decimals would do for doubles that are finite; these do for every number, in any arithmetic.

use super::Scalar;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Writes a number.
pub fn serialize<S: Scalar, T: Serializer>(x: &S, serializer: T) -> Result<T::Ok, T::Error> {
    x.to_bits_text().serialize(serializer)
}

/// Reads a number.
pub fn deserialize<'de, S: Scalar, D: Deserializer<'de>>(from: D) -> Result<S, D::Error> {
    read(&String::deserialize(from)?)
}

fn read<S: Scalar, E: Error>(text: &str) -> Result<S, E> {
    S::from_bits_text(text).ok_or_else(|| E::custom("not the bits of a number"))
}

/// The same of a list.
pub mod list {
    use super::{Deserialize, Deserializer, Scalar, Serializer, read};

    /// Writes the numbers of a list.
    pub fn serialize<S: Scalar, T: Serializer>(list: &[S], to: T) -> Result<T::Ok, T::Error> {
        to.collect_seq(list.iter().map(|x| x.to_bits_text()))
    }

    /// Reads the numbers of a list.
    pub fn deserialize<'de, S: Scalar, D: Deserializer<'de>>(from: D) -> Result<Vec<S>, D::Error> {
        Vec::<String>::deserialize(from)?.iter().map(|text| read(text)).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::scalar::{Dual, F256, Scalar, bits};
    use proptest::prelude::*;
    use serde::{Deserialize, Serialize};

    #[derive(Serialize, Deserialize)]
    #[serde(bound(serialize = "S: Scalar", deserialize = "S: Scalar"))]
    struct Kept<S> {
        #[serde(with = "bits")]
        one: S,
        #[serde(with = "bits::list")]
        many: Vec<S>,
    }

    fn comes_back<S: Scalar>(x: S) {
        let text = serde_json::to_string(&Kept { one: x, many: vec![S::one(), x] }).unwrap();
        let back: Kept<S> = serde_json::from_str(&text).unwrap();
        assert_eq!(back.one.to_bits_text(), x.to_bits_text());
        assert_eq!(back.many[1].to_bits_text(), x.to_bits_text());
        assert_eq!(back.many.len(), 2);
    }

    proptest! {
        #[test]
        fn every_number_comes_back_in_every_bit(bits in any::<u64>(), y in 1.0..2.0f64) {
            let x = f64::from_bits(bits);
            comes_back(x);
            comes_back(Dual::new(x, y));
            comes_back(F256::ONE / F256::from(y));
        }
    }

    #[test]
    fn what_are_no_bits_is_refused() {
        for text in ["", "12", "zz00000000000000", "ä", "00000000000000000"] {
            assert!(f64::from_bits_text(text).is_none(), "{text}");
            assert!(F256::from_bits_text(text).is_none(), "{text}");
            assert!(Dual::<f64>::from_bits_text(text).is_none(), "{text}");
        }
    }
}
