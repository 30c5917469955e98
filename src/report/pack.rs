//! Columns of numbers made small enough for a page.
//!
//! ```text
//! value ─ round to a power of ten ─ second difference ─ zigzag u32 ─ byte shuffle ─ gzip ─ base64
//! ```
//! Smooth columns have small second differences, whose upper bytes are zero and lie together
//! after the shuffle. `page/unpack.js` goes the same way back. Integers are never wrapped: where
//! a second difference would need more than 32 bits, the rounding is made coarser.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::read::GzEncoder;
use serde::Serialize;
use std::io::{self, Read};

/// Decimal digits of a column's largest value that are kept; the quantum is the same everywhere
/// in the column.
pub(super) const VALUE_DIGITS: i32 = 7;

/// The same for times, where the differences matter.
pub(super) const TIME_DIGITS: i32 = 12;

/// A column as the page gets it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Packed {
    /// A value is a whole number of `10^exponent`.
    exponent: i32,
    /// Places that hold no finite number, as `[first, count]`.
    gaps: Vec<[usize; 2]>,
    /// The whole numbers, packed.
    bytes: String,
}

/// Packs a column with so many digits of its largest value.
///
/// # Errors
/// None but what the compressor reports.
pub(super) fn pack(values: &[f64], digits: i32) -> io::Result<Packed> {
    let largest = values.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut exponent = match largest > 0.0 {
        true => (largest.log10().floor() as i32 + 1 - digits).max(-300),
        false => 0,
    };
    let words = loop {
        match second_differences(values, exponent) {
            Some(words) => break words,
            None => exponent += 1,
        }
    };
    let mut compressed = Vec::new();
    GzEncoder::new(&shuffled(&words)[..], Compression::best()).read_to_end(&mut compressed)?;
    Ok(Packed { exponent, gaps: gaps(values), bytes: STANDARD.encode(compressed) })
}

/// Zigzag of the second differences; `None` where one does not fit. A value that is not finite
/// counts as the one before it.
fn second_differences(values: &[f64], exponent: i32) -> Option<Vec<u32>> {
    let (mut last, mut slope) = (0_i64, 0_i64);
    let word = |&value: &f64| {
        let whole = if value.is_finite() { quanta(value, exponent) } else { last };
        let difference = whole.checked_sub(last)?;
        let second = difference.checked_sub(slope)?;
        (last, slope) = (whole, difference);
        u32::try_from((second << 1 ^ second >> 63) as u64).ok().filter(|_| second.abs() < 1 << 31)
    };
    values.iter().map(word).collect()
}

/// A value in whole numbers of `10^exponent`.
fn quanta(value: f64, exponent: i32) -> i64 {
    let scaled = match exponent < 0 {
        true => value * 10_f64.powi(-exponent),
        false => value / 10_f64.powi(exponent),
    };
    scaled.round() as i64
}

/// All lowest bytes, then all second ones, and so on.
fn shuffled(words: &[u32]) -> Vec<u8> {
    (0..4).flat_map(|byte| words.iter().map(move |word| (word >> (8 * byte)) as u8)).collect()
}

fn gaps(values: &[f64]) -> Vec<[usize; 2]> {
    let mut gaps: Vec<[usize; 2]> = Vec::new();
    for (place, _) in values.iter().enumerate().filter(|(_, value)| !value.is_finite()) {
        match gaps.last_mut() {
            Some([first, count]) if *first + *count == place => *count += 1,
            _ => gaps.push([place, 1]),
        }
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::GzDecoder;

    /// What `page/unpack.js` does.
    fn unpack(packed: &Packed) -> Vec<f64> {
        let compressed = STANDARD.decode(&packed.bytes).unwrap();
        let mut bytes = Vec::new();
        GzDecoder::new(&compressed[..]).read_to_end(&mut bytes).unwrap();
        let count = bytes.len() / 4;
        let (mut whole, mut slope) = (0_i64, 0_i64);
        let mut values: Vec<f64> = (0..count)
            .map(|k| {
                let word = (0..4).fold(0, |w, b| w | u32::from(bytes[b * count + k]) << (8 * b));
                slope += i64::from((word >> 1) as i32 ^ -((word & 1) as i32));
                whole += slope;
                match packed.exponent < 0 {
                    true => whole as f64 / 10_f64.powi(-packed.exponent),
                    false => whole as f64 * 10_f64.powi(packed.exponent),
                }
            })
            .collect();
        for [first, count] in &packed.gaps {
            values[*first..first + count].fill(f64::NAN);
        }
        values
    }

    #[test]
    fn what_is_unpacked_is_what_was_packed_to_half_a_quantum() {
        let columns: [Vec<f64>; 6] = [
            (0..5000).map(|k| 31.4 * (f64::from(k) * 1e-3).sin()).collect(),
            (0..5000).map(|k| if k % 97 == 0 { 13_582.0 } else { 0.0 }).collect(),
            vec![-1e-3, 1e-3, -1e-3, 1e-3, 0.0],
            vec![3e300, -3e300, 3e300],
            vec![2.5e-290, -1e-290],
            vec![7.0],
        ];
        for column in columns {
            let largest = column.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let back = unpack(&pack(&column, VALUE_DIGITS).unwrap());
            assert_eq!(back.len(), column.len());
            for (value, back) in column.iter().zip(back) {
                // The quantum is at most 1e-6 of the largest value.
                assert!((value - back).abs() <= 0.500_001e-6 * largest, "{value} came as {back}");
            }
        }
    }

    #[test]
    fn times_that_are_decimals_come_back_to_the_last_bit() {
        let grid: Vec<f64> = (0..6001).map(|k| f64::from(k) * 10.0 / 1e6).collect();
        assert_eq!(unpack(&pack(&grid, TIME_DIGITS).unwrap()), grid);
        // 100 s in a single step: 12 digits do not fit into 32 bits.
        let long = [0.0, 100.0, 250.0];
        assert_eq!(unpack(&pack(&long, TIME_DIGITS).unwrap()), long);
    }

    #[test]
    fn a_uniform_grid_costs_next_to_nothing() {
        let grid: Vec<f64> = (0..60_001).map(|k| f64::from(k) / 1e6).collect();
        assert!(pack(&grid, TIME_DIGITS).unwrap().bytes.len() < 1000);
    }

    #[test]
    fn values_that_are_not_finite_come_back_as_gaps() {
        let nan = f64::NAN;
        let column = [nan, 1.0, nan, f64::INFINITY, 4.0, nan];
        let packed = pack(&column, VALUE_DIGITS).unwrap();
        assert_eq!(packed.gaps, [[0, 1], [2, 2], [5, 1]]);
        let back = unpack(&packed);
        assert_eq!((back[1], back[4]), (1.0, 4.0));
        assert!([0, 2, 3, 5].iter().all(|&k: &usize| back[k].is_nan()));
        assert!(unpack(&pack(&[nan, nan], VALUE_DIGITS).unwrap()).iter().all(|v| v.is_nan()));
        assert_eq!(unpack(&pack(&[], VALUE_DIGITS).unwrap()), Vec::<f64>::new());
    }

    #[test]
    fn smooth_columns_pack_well_below_two_bytes_a_value() {
        let angle: Vec<f64> = (0..60_001).map(|k| (f64::from(k) * 5e-4).sin()).collect();
        let packed = pack(&angle, VALUE_DIGITS).unwrap();
        assert!(packed.bytes.len() < 60_001, "{} bytes", packed.bytes.len());
    }
}
