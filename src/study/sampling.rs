//! Points of the unit cube, and what they stand for.
//!
//! Random numbers are those of ChaCha8 for the seed, and so the same everywhere.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;
use sobol::Sobol;
use sobol::params::JoeKuoD6;
use statrs::distribution::{ContinuousCDF, Normal};

/// How points are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Method {
    /// Each by itself.
    Random,
    /// In each dimension one in each of as many equal parts as there are points (McKay, Beckman,
    /// Conover 1979).
    LatinHypercube,
    /// Sobol's sequence with the direction numbers of Joe and Kuo (2008), shifted as a whole by a
    /// random vector (Cranley, Patterson 1976).
    Sobol,
}

/// `count` points in (0, 1) to the power of `dimensions`: the coordinates by dimension.
pub(super) fn draw(method: Method, count: u64, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut unit = || -> f64 { random.random::<f64>() };
    match method {
        Method::Random => {
            let mut points = vec![Vec::new(); dimensions];
            for _ in 0..count {
                points.iter_mut().for_each(|of| of.push(inside(unit())));
            }
            points
        }
        Method::LatinHypercube => (0..dimensions)
            .map(|_| {
                let mut parts: Vec<f64> = (0..count).map(|part| part as f64).collect();
                parts.shuffle(&mut random);
                let place = |part| inside((part + random.random::<f64>()) / count as f64);
                parts.into_iter().map(place).collect()
            })
            .collect(),
        Method::Sobol => {
            let shift: Vec<f64> = (0..dimensions).map(|_| unit()).collect();
            let mut points = vec![Vec::new(); dimensions];
            let sequence = Sobol::<f64>::new(dimensions, &JoeKuoD6::standard());
            for point in sequence.take(count as usize) {
                for (k, (of, place)) in points.iter_mut().zip(point).enumerate() {
                    of.push(inside((place + shift[k]).fract()));
                }
            }
            points
        }
    }
}

/// A place that is neither 0 nor 1, where a normal distribution has no value.
fn inside(place: f64) -> f64 {
    place.clamp(f64::EPSILON / 2.0, 1.0 - f64::EPSILON / 2.0)
}

/// What a sampled variable is drawn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Spread {
    /// Evenly between two numbers.
    Uniform([f64; 2]),
    /// Evenly between their logarithms.
    LogUniform([f64; 2]),
    /// From a normal distribution.
    Normal {
        /// Its mean.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
}

impl Spread {
    /// The value below which lies this share of the distribution.
    pub fn at(self, share: f64) -> f64 {
        match self {
            Spread::Uniform([low, high]) => low + (high - low) * share,
            Spread::LogUniform([low, high]) => low * (high / low).powf(share),
            Spread::Normal { mean, deviation } => match Normal::new(mean, deviation) {
                Ok(normal) => normal.inverse_cdf(share),
                Err(_) => f64::NAN,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const METHODS: [Method; 3] = [Method::Random, Method::LatinHypercube, Method::Sobol];

    #[test]
    fn a_seed_gives_its_points_and_another_gives_others() {
        for method in METHODS {
            assert_eq!(draw(method, 100, 3, 7), draw(method, 100, 3, 7));
            assert_ne!(draw(method, 100, 3, 7), draw(method, 100, 3, 8));
        }
    }

    #[test]
    fn a_latin_hypercube_has_a_point_in_every_part_of_every_dimension() {
        for of in draw(Method::LatinHypercube, 64, 4, 1) {
            let mut parts: Vec<usize> = of.iter().map(|x| (x * 64.0) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..64).collect::<Vec<_>>());
        }
    }

    /// The error of the mean of x y over [0, 1]², which is 1/4, falls like 1/n for Sobol's points.
    #[test]
    fn sobol_points_are_more_even_than_random_ones() {
        let error = |method| {
            let points = draw(method, 4096, 2, 3);
            let sum: f64 = points[0].iter().zip(&points[1]).map(|(x, y)| x * y).sum();
            (sum / 4096.0 - 0.25).abs()
        };
        assert!(error(Method::Sobol) < 2e-4, "{}", error(Method::Sobol));
        assert!(error(Method::Random) > 5.0 * error(Method::Sobol));
    }

    #[test]
    fn shares_of_a_normal_distribution_are_those_of_tables() {
        let normal = Spread::Normal { mean: 2.0, deviation: 0.5 };
        for (share, deviations) in [(0.5, 0.0), (0.841_344_746, 1.0), (0.025, -1.959_963_985)] {
            assert!((normal.at(share) - (2.0 + 0.5 * deviations)).abs() < 1e-8);
        }
        assert!(normal.at(inside(0.0)).is_finite() && normal.at(inside(1.0)).is_finite());
    }
}
