//! Gauss's collocation: functions of time as series of Legendre's polynomials, known from their values at
//! Gauss's nodes, with their integrals.
//!
//! On −1 ≤ x ≤ 1 and with s nodes x_j of weights w_j (Abramowitz, Stegun 1964, 25.4.29 and 22.10),
//!
//! ```text
//! f(x) = Σ f_k P_k(x),   f_k = (2k + 1)/2 Σ w_j P_k(x_j) f(x_j),   k < s
//! ∫ P_k = (P_{k+1} − P_{k−1})/(2k + 1) from −1 to x,   P_{−1} = −1
//! ```

use crate::scalar::Scalar;

/// Newton's iterations for a node: the first guess has three digits, each doubles them.
const ITERATIONS: usize = 8;

/// Gauss's rule of s points on −1 ≤ x ≤ 1.
#[derive(Debug, Clone)]
pub(super) struct Nodes<S> {
    /// The nodes, in their order.
    pub at: Vec<S>,
    /// P_0 … P_{s−1} at each node, times its weight.
    weighted: Vec<Vec<S>>,
}

impl<S: Scalar> Nodes<S> {
    /// The rule of so many points.
    pub fn new(count: usize) -> Self {
        let mut at = Vec::with_capacity(count);
        let mut weighted = Vec::with_capacity(count);
        for j in 0..count {
            let guess =
                std::f64::consts::PI * (count as f64 - j as f64 - 0.25) / (count as f64 + 0.5);
            let mut x = S::from_f64(guess.cos());
            for _ in 0..ITERATIONS {
                let [value, slope] = with_slope(count, x);
                let step = value / slope;
                x -= step;
                if step.abs().to_f64() <= S::EPSILON {
                    break;
                }
            }
            let [_, slope] = with_slope(count, x);
            let weight = S::from_f64(2.0) / ((S::one() - x * x) * slope * slope);
            weighted.push(legendre(count, x).iter().map(|p| *p * weight).collect());
            at.push(x);
        }
        Nodes { at, weighted }
    }
}

/// P_0 … P_{count−1} at x.
fn legendre<S: Scalar>(count: usize, x: S) -> Vec<S> {
    let mut all = Vec::with_capacity(count.max(2));
    all.extend([S::one(), x]);
    for k in 2..count {
        let number = |n: usize| S::from_f64(n as f64);
        all.push((number(2 * k - 1) * x * all[k - 1] - number(k - 1) * all[k - 2]) / number(k));
    }
    all.truncate(count);
    all
}

/// P_n and its slope at x, not at an end.
fn with_slope<S: Scalar>(n: usize, x: S) -> [S; 2] {
    let number = |n: usize| S::from_f64(n as f64);
    let (mut before, mut value) = (S::one(), x);
    for k in 2..=n {
        let next = (number(2 * k - 1) * x * value - number(k - 1) * before) / number(k);
        (before, value) = (value, next);
    }
    [value, number(n) * (x * value - before) / (x * x - S::one())]
}

/// What stands before the coefficients of a series at one place: P_k, or their integrals from −1.
#[derive(Debug, Clone)]
pub(super) struct Place<S> {
    value: Vec<S>,
    integral: Vec<S>,
    double: Vec<S>,
}

impl<S: Scalar> Place<S> {
    /// The place x for series of so many terms.
    pub fn new(count: usize, x: S) -> Self {
        let value = legendre(count + 2, x);
        let odd = |k: usize| S::from_f64((2 * k + 1) as f64);
        let behind = x + S::one();
        let integral: Vec<S> = (0..=count)
            .map(|k| match k {
                0 => behind,
                k => (value[k + 1] - value[k - 1]) / odd(k),
            })
            .collect();
        let double = (0..count)
            .map(|k| match k {
                0 => integral[1] + behind,
                k => (integral[k + 1] - integral[k - 1]) / odd(k),
            })
            .collect();
        Place { value, integral, double }
    }
}

/// Several functions on −1 ≤ x ≤ 1, as series.
#[derive(Debug, Clone)]
pub(super) struct Series<S> {
    /// By degree, the coefficients of each function.
    coefficients: Vec<Vec<S>>,
}

impl<S: Scalar> Series<S> {
    /// Those with these values at the nodes.
    pub fn through(nodes: &Nodes<S>, values: &[Vec<S>]) -> Self {
        let half = S::ratio(1, 2);
        let coefficients = (0..nodes.at.len()).map(|k| {
            let mut sums = vec![S::zero(); values[0].len()];
            for (weighted, values) in nodes.weighted.iter().zip(values) {
                sums.iter_mut().zip(values).for_each(|(sum, f)| *sum += weighted[k] * *f);
            }
            let factor = half * S::from_f64((2 * k + 1) as f64);
            sums.into_iter().map(|sum| sum * factor).collect()
        });
        Series { coefficients: coefficients.collect() }
    }

    /// The values at a place.
    pub fn value(&self, place: &Place<S>) -> Vec<S> {
        self.sum(&place.value)
    }

    /// The integrals from −1 to a place.
    pub fn integral(&self, place: &Place<S>) -> Vec<S> {
        self.sum(&place.integral)
    }

    /// The integrals of the integrals.
    pub fn double_integral(&self, place: &Place<S>) -> Vec<S> {
        self.sum(&place.double)
    }

    fn sum(&self, factors: &[S]) -> Vec<S> {
        let mut sums = vec![S::zero(); self.coefficients[0].len()];
        for (factor, terms) in factors.iter().zip(&self.coefficients) {
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += *factor * *term);
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::F256;

    fn off<S: Scalar>(count: usize) -> f64 {
        let nodes = Nodes::<S>::new(count);
        let cubed = |x: S| (x + S::one()) * (x + S::one()) * (x + S::one());
        let exponential = |x: S| x.exp();
        let values: Vec<Vec<S>> =
            nodes.at.iter().map(|x| vec![cubed(*x), exponential(*x)]).collect();
        let series = Series::through(&nodes, &values);
        [-1.0, -0.3, 0.0, 0.71, 1.0]
            .map(|x| {
                let x = S::from_f64(x);
                let place = Place::new(count, x);
                let (e, behind) = ((-S::one()).exp(), x + S::one());
                let [five, twenty] = [S::ratio(1, 4), S::ratio(1, 20)];
                let power = cubed(x) * behind;
                [
                    series.value(&place)[0] - cubed(x),
                    series.value(&place)[1] - exponential(x),
                    series.integral(&place)[0] - power * five,
                    series.integral(&place)[1] - (exponential(x) - e),
                    series.double_integral(&place)[0] - power * behind * twenty,
                    series.double_integral(&place)[1] - (exponential(x) - e - e * behind),
                ]
                .map(|off| off.abs().to_f64())
                .into_iter()
                .fold(0.0, f64::max)
            })
            .into_iter()
            .fold(0.0, f64::max)
    }

    #[test]
    fn series_and_their_integrals_are_those_of_the_function() {
        // of numbers up to sixteen
        assert!(off::<f64>(16) < 1e-13, "{:e}", off::<f64>(16));
        assert!(off::<F256>(46) < 1e-66, "{:e}", off::<F256>(46));
    }
}
