//! The vector operations of IDA's inner loops, on slices.
//!
//! IDA spends most of its time here, not in the model: with a dozen unknowns the stock operations
//! of SUNDIALS cost more in dispatch and branches than in arithmetic. Which operations these are
//! was found with a profiler; IDA calls no others while it steps.

/// z = a x + b y.
#[inline(always)]
pub(super) fn linear_sum(a: f64, x: &[f64], b: f64, y: &[f64], z: &mut [f64]) {
    for ((z, x), y) in z.iter_mut().zip(x).zip(y) {
        *z = a * x + b * y;
    }
}

/// z = a z + b y.
#[inline(always)]
pub(super) fn linear_sum_in_place(a: f64, z: &mut [f64], b: f64, y: &[f64]) {
    for (z, y) in z.iter_mut().zip(y) {
        *z = a * *z + b * y;
    }
}

/// z = c x.
#[inline(always)]
pub(super) fn scale(c: f64, x: &[f64], z: &mut [f64]) {
    for (z, x) in z.iter_mut().zip(x) {
        *z = c * x;
    }
}

/// z = c z.
#[inline(always)]
pub(super) fn scale_in_place(c: f64, z: &mut [f64]) {
    for z in z {
        *z *= c;
    }
}

/// z = Σ c_j x_j, each x_j as long as z.
#[inline(always)]
pub(super) fn linear_combination<const K: usize>(c: [f64; K], x: [&[f64]; K], z: &mut [f64]) {
    let length = z.len();
    let x = x.map(|x| &x[..length]);
    for (i, z) in z.iter_mut().enumerate() {
        let mut sum = c[0] * x[0][i];
        for j in 1..K {
            sum += c[j] * x[j][i];
        }
        *z = sum;
    }
}

/// Number of sums that are carried side by side.
const LANES: usize = 4;

/// The largest |x w|; infinite if one of them is undefined, for IDA takes an undefined norm for a
/// small one.
#[inline(always)]
pub(super) fn largest(x: &[f64], w: &[f64]) -> f64 {
    let mut largest = [0.0_f64; LANES];
    let mut sum = [0.0; LANES];
    let (x, x_rest) = x.as_chunks::<LANES>();
    let (w, w_rest) = w.as_chunks::<LANES>();
    let mut take = |lane: usize, product: f64| {
        let size = product.abs();
        largest[lane] = if size > largest[lane] { size } else { largest[lane] };
        sum[lane] += size;
    };
    for (x, w) in x.iter().zip(w) {
        for lane in 0..LANES {
            take(lane, x[lane] * w[lane]);
        }
    }
    for (lane, (x, w)) in x_rest.iter().zip(w_rest).enumerate() {
        take(lane, x * w);
    }
    if sum.iter().sum::<f64>().is_nan() {
        return f64::INFINITY;
    }
    largest.into_iter().fold(0.0, f64::max)
}

/// √(Σ (x w)² / number); infinite if undefined.
#[inline(always)]
pub(super) fn root_mean_square(x: &[f64], w: &[f64]) -> f64 {
    let mut sum = [0.0; LANES];
    let number = x.len() as f64;
    let (x, x_rest) = x.as_chunks::<LANES>();
    let (w, w_rest) = w.as_chunks::<LANES>();
    for (x, w) in x.iter().zip(w) {
        for lane in 0..LANES {
            let product = x[lane] * w[lane];
            sum[lane] += product * product;
        }
    }
    for (lane, (x, w)) in x_rest.iter().zip(w_rest).enumerate() {
        sum[lane] += (x * w) * (x * w);
    }
    let norm = (sum.iter().sum::<f64>() / number).sqrt();
    if norm.is_nan() { f64::INFINITY } else { norm }
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 7] = [1.0, -2.0, 3.0, -4.0, 5.0, -6.0, 7.0];
    const Y: [f64; 7] = [0.5, 0.25, -0.5, 2.0, 1.0, -1.0, 4.0];

    #[test]
    fn sums_and_multiples_are_those_of_each_component() {
        let mut z = [0.0; 7];
        linear_sum(2.0, &X, -3.0, &Y, &mut z);
        let expected: [f64; 7] = std::array::from_fn(|i| 2.0 * X[i] - 3.0 * Y[i]);
        assert_eq!(z, expected);

        let mut z = X;
        linear_sum_in_place(2.0, &mut z, -3.0, &Y);
        assert_eq!(z, expected);

        linear_combination([2.0, -3.0, 0.0], [&X, &Y, &X], &mut z);
        assert_eq!(z, expected);

        scale(0.5, &X, &mut z);
        assert_eq!(z, X.map(|x| 0.5 * x));
        scale_in_place(4.0, &mut z);
        assert_eq!(z, X.map(|x| 2.0 * x));
    }

    #[test]
    fn norms_of_known_vectors() {
        assert_eq!(largest(&X, &Y), 28.0);
        assert_eq!(largest(&X[..6], &Y[..6]), 8.0);
        let squares: f64 = X.iter().zip(&Y).map(|(x, y)| (x * y).powi(2)).sum();
        let expected = (squares / 7.0).sqrt();
        assert!((root_mean_square(&X, &Y) - expected).abs() < 4.0 * f64::EPSILON * expected);
    }

    #[test]
    fn an_undefined_component_makes_a_norm_infinite_wherever_it_stands() {
        for place in 0..7 {
            let mut x = X;
            x[place] = f64::NAN;
            assert_eq!(largest(&x, &Y), f64::INFINITY, "at {place}");
            assert_eq!(root_mean_square(&x, &Y), f64::INFINITY, "at {place}");
        }
    }
}
