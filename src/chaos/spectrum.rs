//! From the growth of each lap to exponents with their intervals, the dimension, and the zeros.

use crate::mechanism::Mechanism;
use crate::scalar::Scalar;

/// Batches that a motion is cut into, at most.
const BATCHES: usize = 20;

/// Quantiles of Student's distribution that leave 5 % on both sides together, by degrees of freedom
/// from 1 to 19.
const STUDENT: [f64; BATCHES - 1] = [
    12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281, 2.2010,
    2.1788, 2.1604, 2.1448, 2.1314, 2.1199, 2.1098, 2.1009, 2.0930,
];

/// An exponent, or a sum of some.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponent {
    /// E-folds a lap.
    pub per_lap: f64,
    /// Half the width of its 95 % interval, of the same unit; `None` of a single lap.
    pub half_width: Option<f64>,
}

impl Exponent {
    /// The mean of what laps came to, with an interval by batch means (B. Schmeiser 1982): laps are cut
    /// into at most twenty batches of one length, whose means are taken to be independent.
    pub(super) fn of(laps: &[f64]) -> Exponent {
        let mean = |laps: &[f64]| laps.iter().sum::<f64>() / laps.len() as f64;
        let batches = batches(laps.len());
        let means: Vec<f64> = batches.map(|batch| mean(&laps[batch])).collect();
        Exponent { per_lap: mean(laps), half_width: half_width(&means) }
    }
}

/// Where batches lie among so many laps; what does not fill one is left out at the begin.
fn batches(laps: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
    let count = laps.min(BATCHES);
    let length = laps / count.max(1);
    let first = laps - count * length;
    (0..count).map(move |k| first + k * length..first + (k + 1) * length)
}

/// Half the width of the 95 % interval of the mean of independent numbers.
fn half_width(numbers: &[f64]) -> Option<f64> {
    let count = numbers.len() as f64;
    let student = STUDENT.get(numbers.len().checked_sub(2)?)?;
    let mean = numbers.iter().sum::<f64>() / count;
    let squares: f64 = numbers.iter().map(|x| (x - mean) * (x - mean)).sum();
    Some(student * (squares / (count - 1.0) / count).sqrt())
}

/// The dimension that Kaplan and Yorke conjectured of an attractor: how many exponents can be added,
/// the largest first, before the sum is negative, with what the next leaves of it as a fraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dimension {
    /// The dimension, in the states at one time: that of a stroboscopic section of a driven motion.
    pub value: f64,
    /// Half the width of its 95 % interval, by leaving out one batch after the other (jackknife).
    pub half_width: Option<f64>,
}

/// That of exponents in falling order.
fn kaplan_yorke(exponents: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (k, exponent) in exponents.iter().enumerate() {
        if sum + exponent < 0.0 {
            return k as f64 + sum / -exponent;
        }
        sum += exponent;
    }
    exponents.len() as f64
}

/// Exponents in falling order, and what they are the means of.
pub(super) struct Spectrum {
    pub growth: Vec<Vec<f64>>,
    pub exponents: Vec<Exponent>,
}

impl Spectrum {
    /// From the growth of laps, by direction.
    pub fn of(growth: Vec<Vec<f64>>) -> Spectrum {
        let mut all: Vec<(Exponent, Vec<f64>)> =
            growth.into_iter().map(|laps| (Exponent::of(&laps), laps)).collect();
        // short motions may have them in another order
        all.sort_by(|(a, _), (b, _)| b.per_lap.total_cmp(&a.per_lap));
        let (exponents, growth) = all.into_iter().unzip();
        Spectrum { growth, exponents }
    }

    /// The sum of all.
    pub fn sum(&self) -> Exponent {
        let laps = self.growth.first().map_or(0, Vec::len);
        let sums: Vec<f64> =
            (0..laps).map(|lap| self.growth.iter().map(|laps| laps[lap]).sum()).collect();
        Exponent::of(&sums)
    }

    /// The Kaplan–Yorke dimension.
    pub fn dimension(&self) -> Dimension {
        let all: Vec<f64> = self.exponents.iter().map(|exponent| exponent.per_lap).collect();
        let laps = self.growth.first().map_or(0, Vec::len);
        let value = kaplan_yorke(&all);
        let without: Vec<f64> = batches(laps)
            .map(|batch| {
                let left = |laps: &Vec<f64>| {
                    let kept = laps[..batch.start].iter().chain(&laps[batch.end..]);
                    kept.sum::<f64>() / (laps.len() - batch.len()) as f64
                };
                let mut exponents: Vec<f64> = self.growth.iter().map(left).collect();
                exponents.sort_by(|a, b| b.total_cmp(a));
                kaplan_yorke(&exponents)
            })
            .collect();
        // n - 1 times the spread of the means that leave one out
        let more = without.len().saturating_sub(1) as f64;
        Dimension { value, half_width: half_width(&without).map(|width| more * width) }
    }
}

/// What is known of a motion beforehand that makes exponents zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Known {
    /// Nothing in it depends on the time: no drive, no load with a course of time.
    pub autonomous: bool,
    /// It has come to rest.
    pub rests: bool,
    /// Nothing has been dissipated.
    pub keeps_energy: bool,
}

/// Exponents that are zero, as far as so many laps tell.
#[derive(Debug, Clone, PartialEq)]
pub struct Zeros {
    /// Numbers, from 0, of those that are.
    pub found: Vec<usize>,
    /// What is known.
    pub known: Known,
}

impl Zeros {
    /// Those among exponents. What grows with a power of the time has a mean of (ln n)/n in n laps, so
    /// that nothing smaller than (ln(1 + n))/n and its interval is told from zero.
    pub(super) fn of(exponents: &[Exponent], laps: u64, known: Known) -> Zeros {
        let power = (laps as f64).ln_1p() / laps as f64;
        let zero = |exponent: &Exponent| {
            exponent.per_lap.abs() <= power + exponent.half_width.unwrap_or(0.0)
        };
        let found = (0..exponents.len()).filter(|k| zero(&exponents[*k])).collect();
        Zeros { found, known }
    }

    /// How many must be zero: one along the flow of a motion that does not rest and does not depend on
    /// the time, and one across the surfaces of its energy, if that is kept.
    pub fn expected(&self) -> usize {
        let Known { autonomous, rests, keeps_energy } = self.known;
        usize::from(autonomous && !rests) + usize::from(autonomous && !rests && keeps_energy)
    }
}

/// Whether nothing in a mechanism depends on the time.
pub(super) fn is_autonomous<S: Scalar>(mechanism: &Mechanism<S>) -> bool {
    let model = mechanism.model();
    let mut courses = model.loads().iter().filter_map(|load| load.course());
    model.drives().is_empty() && courses.all(|course| course.fastest() == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_students_of_batch_means() {
        // 41 laps: twenty batches of two, whose means are 0 and 1 in turn, and one lap before them
        let laps: Vec<f64> = (0..41).map(|lap| f64::from((lap + 1) / 2 % 2)).collect();
        let exponent = Exponent::of(&laps);
        let deviation = (20.0 * 0.25 / 19.0_f64).sqrt();
        let expected = 2.0930 * deviation / 20.0_f64.sqrt();
        assert!((exponent.half_width.unwrap() - expected).abs() < 1e-12);
        assert_eq!(exponent.per_lap, 20.0 / 41.0);
        assert_eq!(Exponent::of(&[3.0]), Exponent { per_lap: 3.0, half_width: None });
    }

    #[test]
    fn the_dimension_is_where_the_sum_of_exponents_comes_to_zero() {
        // Lorenz's attractor, with exponents as Wolf and others (1985) print them
        let lorenz = kaplan_yorke(&[2.16, 0.0, -32.4]);
        assert!((lorenz - (2.0 + 2.16 / 32.4)).abs() < 1e-15);
        assert_eq!(kaplan_yorke(&[-1.0, -2.0]), 0.0);
        assert_eq!(kaplan_yorke(&[1.0, -1.0]), 2.0);
        assert_eq!(kaplan_yorke(&[0.0, -1.0]), 1.0);
    }

    #[test]
    fn the_jackknife_of_a_mean_is_its_own_interval() {
        // two exponents of which the second is -1 always: the dimension is 1 + λ1
        let first: Vec<f64> = (0..20).map(|lap| 0.1 + 0.01 * f64::from(lap % 5)).collect();
        let spectrum = Spectrum::of(vec![first.clone(), vec![-1.0; 20]]);
        let (dimension, exponent) = (spectrum.dimension(), Exponent::of(&first));
        assert!((dimension.value - 1.0 - exponent.per_lap).abs() < 1e-15);
        let apart = dimension.half_width.unwrap() - exponent.half_width.unwrap();
        assert!(apart.abs() < 1e-14, "{apart:e}");
    }
}
