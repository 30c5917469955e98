//! When one curve flattens another, and what is done about it.

use super::decimate::Point;

/// Share of its time in which a curve is no larger than its usual size.
const USUALLY: f64 = 0.95;
/// An axis that is this many times as long as the usual size of a curve leaves nothing of it to see.
pub(super) const FLAT: f64 = 20.0;
/// What is so many times smaller than the rest is rounding errors, or of no account beside it.
const NOTHING: f64 = 1e-5;

/// The value beyond which an axis for all these curves is to be logarithmic: the power of ten
/// nearest to the usual size of the flattest. `None` if none is flat.
pub(super) fn bends_at<'a>(curves: impl IntoIterator<Item = &'a [Point]>) -> Option<f64> {
    let (mut largest, mut sizes) = (0.0_f64, Vec::new());
    for points in curves {
        let values = points.iter().map(|point| point[1].abs()).filter(|value| value.is_finite());
        largest = values.fold(largest, f64::max);
        sizes.extend(usual(
            points.windows(2).map(|pair| (pair[0][1].abs(), (pair[1][0] - pair[0][0]).abs())),
        ));
    }
    let seen = sizes.into_iter().filter(|size| *size > NOTHING * largest);
    let least = seen.reduce(f64::min).filter(|least| FLAT * least < largest)?;
    Some(10_f64.powi(least.log10().round() as i32))
}

/// What sizes, each with its weight, are not beyond for most of the weight; those that are zero are
/// left out. `None` if nothing is left.
pub(super) fn usual(sizes: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let mut sizes: Vec<(f64, f64)> =
        sizes.filter(|(size, weight)| size.is_finite() && *size > 0.0 && *weight > 0.0).collect();
    sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f64 = sizes.iter().map(|(_, weight)| weight).sum();
    let mut passed = 0.0;
    let reached = sizes.iter().find(|(_, weight)| {
        passed += weight;
        passed >= USUALLY * whole
    });
    reached.map(|(size, _)| *size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(values: &[f64]) -> Vec<Point> {
        values.iter().zip(0..).map(|(value, k)| [f64::from(k), *value]).collect()
    }

    /// A curve of this size with a single peak.
    fn peaked(size: f64, peak: f64) -> Vec<Point> {
        let mut values = vec![-size; 100];
        values[50] = peak;
        curve(&values)
    }

    #[test]
    fn a_curve_is_flat_where_it_is_a_twentieth_of_the_axis_for_most_of_its_time() {
        let ideal = curve(&[9.0; 100]);
        for (run, bends) in [
            (peaked(9.0, 170.0), None),
            (peaked(9.0, -190.0), Some(10.0)),
            (peaked(50.0, 190.0), Some(10.0)),
            (peaked(0.02, 9.5), Some(0.01)),
            (peaked(0.0, 170.0), None),
            (peaked(1e-9, 10.0), None),
        ] {
            assert_eq!(bends_at([&run[..], &ideal]), bends);
        }
        assert_eq!(bends_at([&curve(&[0.0, f64::NAN, 0.0])[..]]), None);
        assert_eq!(bends_at([]), None);
    }

    #[test]
    fn samples_count_by_the_time_that_they_stand_for() {
        // A hundred samples in a thousandth of the time.
        let mut points = curve(&[1.0; 50]);
        points.extend((0..100).map(|k| [49.0 + 5e-4 * f64::from(k), 100.0]));
        assert_eq!(bends_at([&points[..]]), Some(1.0));
    }
}
