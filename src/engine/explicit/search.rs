//! Where within a step a quantity known at both ends, with two derivatives, passes zero.

/// Root in [0, 1] of the quintic through value, first and second derivative at both ends, which
/// rises from below zero to above.
pub(super) fn quintic_root(begin: [f64; 3], end: [f64; 3]) -> f64 {
    let [a, b, half_c] = [begin[0], begin[1], 0.5 * begin[2]];
    let value = end[0] - a - b - half_c;
    let rate = end[1] - b - 2.0 * half_c;
    let bend = end[2] - 2.0 * half_c;
    let d = 10.0 * value - 4.0 * rate + 0.5 * bend;
    let e = -15.0 * value + 7.0 * rate - bend;
    let f = 6.0 * value - 3.0 * rate + 0.5 * bend;
    let quintic = |s: f64| a + s * (b + s * (half_c + s * (d + s * (e + s * f))));
    let slope = |s: f64| b + s * (2.0 * half_c + s * (3.0 * d + s * (4.0 * e + s * 5.0 * f)));
    let (mut low, mut high) = (0.0, 1.0);
    let mut s = (-a / (end[0] - a)).clamp(0.0, 1.0);
    for _ in 0..60 {
        let now = quintic(s);
        if now > 0.0 {
            high = s
        } else {
            low = s
        }
        let next = s - now / slope(s);
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - s).abs() <= 4.0 * f64::EPSILON {
            return next;
        }
        s = next;
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quintic_is_exact_for_quintics() {
        let f = |s: f64| s.powi(5) + s * s + s - 0.7;
        let root = quintic_root([f(0.0), 1.0, 2.0], [f(1.0), 8.0, 22.0]);
        assert!(f(root).abs() < 1e-15, "{root}");
    }
}
