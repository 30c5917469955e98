//! Where a motion ends: after how many revolutions it repeats itself, and what touches all the time.

use crate::digits::Sizes;
use crate::mechanism::Observation;
use std::f64::consts::{PI, TAU};

/// When a motion counts as one that repeats itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttractorPlan {
    /// Distance of two states that counts as none: offsets of journals over their clearances,
    /// positions over the mechanism's length, angles over a radian, rates over the fastest drive's.
    pub tolerance: f64,
    /// Longest period that is looked for (revolutions).
    pub longest: u64,
}

impl AttractorPlan {
    /// Revolutions that it takes to tell: each of the last `longest` is held against one that lies a
    /// period before.
    pub fn needs(&self) -> u64 {
        2 * self.longest
    }
}

/// The state of a mechanism at the end of a revolution, over its sizes: offsets of journals over their
/// clearances; positions of bodies over the mechanism's length, angles over a radian and without whole
/// turns; rates over that of the fastest drive.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    lengths: Vec<f64>,
    angles: Vec<f64>,
}

impl Point {
    /// That of a sample.
    pub fn of(sample: &Observation, sizes: &Sizes) -> Point {
        let rate = if sizes.rate > 0.0 { sizes.rate } else { 1.0 };
        let length = sizes.length;
        let bodies = sample.bodies.iter().flat_map(|body| {
            let ([x, y], [u, v]) = (body.position, body.velocity);
            let speed = length * rate;
            [x / length, y / length, u / speed, v / speed, body.angular_velocity / rate]
        });
        let journals = sample.clearances.iter().zip(&sizes.clearances).flat_map(|(joint, c)| {
            let [x, y] = joint.offset;
            [x / c, y / c]
        });
        Point {
            lengths: bodies.chain(journals).collect(),
            angles: sample.bodies.iter().map(|body| body.angle).collect(),
        }
    }

    /// The largest difference of any component.
    fn distance(&self, other: &Point) -> f64 {
        let lengths = self.lengths.iter().zip(&other.lengths).map(|(a, b)| (a - b).abs());
        let turned = |(a, b): (&f64, &f64)| ((a - b + PI).rem_euclid(TAU) - PI).abs();
        let angles = self.angles.iter().zip(&other.angles).map(turned);
        lengths.chain(angles).fold(0.0, larger)
    }
}

/// The larger of two distances; what is no number is far from everything.
fn larger(most: f64, x: f64) -> f64 {
    if x > most || x.is_nan() { x } else { most }
}

/// A period (revolutions), 0 for none, and the largest distance of the points that are that far apart;
/// without a period the least there is of any.
pub(super) fn period(points: &[Point], plan: &AttractorPlan) -> (u64, f64) {
    let longest = plan.longest as usize;
    if points.len() < 2 * longest {
        return (0, f64::NAN);
    }
    let mut least = f64::INFINITY;
    for period in 1..=longest {
        let later = &points[points.len() - longest..];
        let earlier = &points[points.len() - longest - period..];
        let apart = later.iter().zip(earlier).map(|(a, b)| a.distance(b)).fold(0.0, larger);
        if apart <= plan.tolerance {
            return (period as u64, apart);
        }
        least = least.min(apart);
    }
    (0, least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(values: impl Iterator<Item = (f64, f64)>) -> Vec<Point> {
        values.map(|(x, angle)| Point { lengths: vec![x], angles: vec![angle] }).collect()
    }

    #[test]
    fn the_period_is_the_shortest_after_which_points_come_back() {
        let plan = AttractorPlan { tolerance: 1e-3, longest: 8 };
        for period in [1, 2, 3, 4, 8] {
            // a body that turns as well, by a whole turn each time
            let cycle = |k: usize| ((k % period) as f64, TAU * k as f64 + 0.3);
            let (found, apart) = super::period(&points((0..40).map(cycle)), &plan);
            assert_eq!(found, period as u64);
            assert!(apart < 1e-13);
        }
        let longer = points((0..40).map(|k| ((k % 9) as f64, 0.0)));
        assert_eq!(super::period(&longer, &plan).0, 0);
    }

    #[test]
    fn what_is_not_yet_there_or_moves_on_has_none() {
        let plan = AttractorPlan { tolerance: 1e-3, longest: 4 };
        // comes nearer to its end by a half each time: 2⁻⁸ apart at the last four points
        let (found, apart) = super::period(&points((0..12).map(|k| (0.5_f64.powi(k), 0.0))), &plan);
        assert_eq!((found, apart), (0, 0.5_f64.powi(8)));
        assert_eq!(super::period(&points((0..40).map(|k| (0.5_f64.powi(k), 0.0))), &plan).0, 1);
        let drifts = points((0..40).map(|k| (0.0, 0.1 * f64::from(k))));
        assert_eq!(super::period(&drifts, &plan).0, 0);
        let (found, apart) = super::period(&points((0..7).map(|_| (0.0, 0.0))), &plan);
        assert!(found == 0 && apart.is_nan(), "seven points do not tell");
        let lost = points((0..40).map(|_| (f64::NAN, 0.0)));
        assert_eq!(super::period(&lost, &plan).0, 0);
    }
}
