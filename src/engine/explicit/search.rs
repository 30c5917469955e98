//! Where within a step an approach may have risen through zero.
//!
//! Values are known exactly at the step's ends only, rates at its ends and, roughly, at a few
//! places between. The course sketched from them tells where to look; what it tells of the
//! places between is believed only after a partial step there.

/// A place of a course.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// As a fraction of the step.
    pub fraction: f64,
    /// Value of the approach.
    pub value: f64,
    /// Rate of the approach, per step.
    pub rate: f64,
}

/// The course of an approach over a step.
#[derive(Debug, Clone)]
pub(super) struct Course {
    places: Vec<Place>,
    /// What the values between the ends may be off by.
    doubt: f64,
}

/// A summit between two places that may rise above zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Summit {
    /// Where it is thought to be, as a fraction of the step.
    pub fraction: f64,
    /// The last place before it, with a rising rate.
    pub before: Place,
    /// The first place after it, with a falling rate.
    pub after: Place,
}

impl Course {
    /// From the ends, and (fraction, rate) at places between them in any order.
    pub fn new(begin: Place, end: Place, between: impl Iterator<Item = (f64, f64)>) -> Course {
        let mut places = vec![begin];
        places.extend(between.map(|(fraction, rate)| Place { fraction, value: 0.0, rate }));
        places.push(end);
        places.sort_by(|a, b| a.fraction.total_cmp(&b.fraction));
        let mut sum = begin.value;
        for i in 1..places.len() {
            let (a, b) = (places[i - 1], places[i]);
            sum += 0.5 * (a.rate + b.rate) * (b.fraction - a.fraction);
            places[i].value = sum;
        }
        let miss = end.value - sum;
        for place in &mut places {
            place.value += miss * place.fraction;
        }
        let rates = places.iter().map(|place| place.rate.abs());
        let doubt = miss.abs() + 0.02 * rates.fold(0.0, f64::max);
        Course { places, doubt }
    }

    /// Summits that are, or may be, above zero, in their order.
    pub fn summits(&self) -> impl Iterator<Item = Summit> {
        self.places.windows(2).filter_map(|pair| {
            let (before, after) = (pair[0], pair[1]);
            if before.rate <= 0.0 || after.rate >= 0.0 {
                return None;
            }
            let width = after.fraction - before.fraction;
            let share = before.rate / (before.rate - after.rate);
            let height = before.value + 0.5 * before.rate * share * width;
            let possible = height.max(before.value).max(after.value) + self.doubt > 0.0;
            let fraction = before.fraction + share * width;
            possible.then_some(Summit { fraction, before, after })
        })
    }

    /// Where the sketch first rises through zero before the fraction `limit`; the middle of what
    /// is left if it does not.
    pub fn first_rise(&self, limit: f64) -> f64 {
        for pair in self.places.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            if b.value > 0.0 && (a.value < 0.0 || a.rate < 0.0) {
                let fraction = rise(a, b);
                return if fraction < limit { fraction } else { 0.5 * limit };
            }
        }
        0.5 * limit
    }
}

/// Zero of the cubic through two places with values of different signs; where the first is zero
/// itself and falls, the zero after it.
fn rise(a: Place, b: Place) -> f64 {
    let width = b.fraction - a.fraction;
    let cubic = |s: f64| {
        let (r, one) = (1.0 - s, 1.0);
        (one + 2.0 * s) * r * r * a.value
            + s * r * r * a.rate * width
            + s * s * (3.0 - 2.0 * s) * b.value
            - s * s * r * b.rate * width
    };
    let (mut low, mut high) = (0.0, 1.0);
    if a.value >= 0.0 {
        while cubic(0.5 * high) > 0.0 && high > 1e-9 {
            high *= 0.5;
        }
        low = 0.5 * high;
    }
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if cubic(middle) > 0.0 { high = middle } else { low = middle }
    }
    a.fraction + 0.5 * (low + high) * width
}

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

    fn course(f: impl Fn(f64) -> f64, rate: impl Fn(f64) -> f64, between: &[f64]) -> Course {
        let place = |fraction| Place { fraction, value: f(fraction), rate: rate(fraction) };
        Course::new(place(0.0), place(1.0), between.iter().map(|&s| (s, rate(s))))
    }

    #[test]
    fn a_bump_between_two_negative_ends_is_suspected() {
        let bump = |s: f64| 0.01 - (s - 0.4) * (s - 0.4);
        let course = course(bump, |s| -2.0 * (s - 0.4), &[]);
        let summit = course.summits().next().unwrap();
        assert!((summit.fraction - 0.4).abs() < 1e-12, "{}", summit.fraction);
    }

    #[test]
    fn a_bump_far_below_zero_is_not() {
        let bump = |s: f64| -1.0 - (s - 0.4) * (s - 0.4);
        assert!(course(bump, |s| -2.0 * (s - 0.4), &[]).summits().next().is_none());
    }

    #[test]
    fn two_bumps_are_told_apart_by_rates_between_the_ends() {
        let waves = |s: f64| (12.0 * s).sin() - 0.5;
        let places: Vec<f64> = (1..16).map(|i| f64::from(i) / 16.0).collect();
        let course = course(waves, |s| 12.0 * (12.0 * s).cos(), &places);
        let found: Vec<f64> = course.summits().map(|summit| summit.fraction).collect();
        assert_eq!(found.len(), 2, "{found:?}");
        let rise = course.first_rise(1.0);
        assert!((rise - 0.5f64.asin() / 12.0).abs() < 0.01, "{rise}");
    }

    #[test]
    fn a_rise_after_a_fall_from_zero_is_the_later_root() {
        let hop = |s: f64| s * (s - 0.3);
        let rise = course(hop, |s| 2.0 * s - 0.3, &[]).first_rise(1.0);
        assert!((rise - 0.3).abs() < 1e-6, "{rise}");
    }

    #[test]
    fn the_quintic_is_exact_for_quintics() {
        let f = |s: f64| s.powi(5) + s * s + s - 0.7;
        let root = quintic_root([f(0.0), 1.0, 2.0], [f(1.0), 8.0, 22.0]);
        assert!(f(root).abs() < 1e-15, "{root}");
    }
}
