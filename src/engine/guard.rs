//! No event is missed: proof that an event function keeps its sign over a step, or its first rise
//! through zero.
//!
//! At a place an engine knows of a function g its value, rate and, for most, second derivative,
//! and the system bounds how fast the latter may change ([`Course`]). From a place a on, and
//! likewise back from the next place b,
//! ```text
//! g(a + x) ≤ g(a) + g'(a) x + g''(a) x²/2 + T x³/6,   T ≥ |g'''| between a and b
//! ```
//! Where the larger of both bounds, each over its half of the way, stays below zero, so does g.
//! Where it does not the way is parted and looked at between, left half first: the rise found is
//! the first, and its bracket is one in which g' > 0 by the same bounds, so that it holds one zero
//! and no more. T is what turning arms and the change of the second derivative from a to b come to,
//! the latter doubled for what it may do between them.

use crate::dae::Course;

/// Looks that one step may take.
const MOST_LOOKS: usize = 400;
/// What the third derivative may be, over what it is on the mean.
const SPARE: f64 = 2.0;
/// The same where second derivatives are taken from values and rates.
const MORE_TO_SPARE: f64 = 4.0;
/// A split leaves this share of the way at least on each side.
const LEAST_SHARE: f64 = 0.05;
/// How far beyond its expected place a rise is looked for, so as to have it in a bracket.
const BEYOND: f64 = 1.1;

/// An event function at a place, with the sign that makes it rise towards its event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// The place (s, or the engine's own variable, in which rates are then meant).
    pub at: f64,
    /// What is known of the function there.
    pub course: Course,
}

/// What came of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Found {
    /// The function keeps its sign.
    Nothing,
    /// The function rises once between these two, and not before.
    Rise(Look, Look),
    /// The function was below zero wherever it was looked at, but no bound settles all of the way.
    Unproven,
}

/// Whether two looks are enough to tell that a function stays below zero between them.
#[inline(always)]
pub fn stays_below(begin: Look, end: Look) -> bool {
    Panel::new(begin, end).stays_below()
}

/// The first rise of a function through zero between two places, the later of which is not before
/// the earlier. `look` tells of the function near a place between, and where that is.
///
/// # Errors
/// Those of `look`.
pub fn first_rise<E>(
    begin: Look,
    end: Look,
    mut look: impl FnMut(f64) -> Result<Look, E>,
) -> Result<Found, E> {
    let (mut from, mut waiting) = (begin, vec![end]);
    let mut looks = 0;
    let mut proven = true;
    while let Some(&to) = waiting.last() {
        let panel = Panel::new(from, to);
        if panel.stays_below() {
            from = to;
            waiting.pop();
            continue;
        }
        let risen = to.course.value > to.course.noise;
        if risen && panel.rises_only() {
            return Ok(Found::Rise(from, to));
        }
        let middle = panel.split();
        if looks >= MOST_LOOKS || panel.is_a_point(middle) {
            if risen {
                return Ok(Found::Rise(from, to));
            }
            proven &= panel.is_a_point(middle);
            from = to;
            waiting.pop();
            continue;
        }
        looks += 1;
        let between = look(middle)?;
        if between.at > from.at && between.at < to.at {
            waiting.push(between);
        } else {
            looks = MOST_LOOKS;
        }
    }
    Ok(if proven { Found::Nothing } else { Found::Unproven })
}

/// The way from one place to the next.
struct Panel {
    from: Look,
    to: Look,
    length: f64,
    /// Second derivatives at both ends.
    bends: [f64; 2],
    /// Bound of the third derivative.
    twist: f64,
}

impl Panel {
    fn new(from: Look, to: Look) -> Panel {
        let length = to.at - from.at;
        let (a, b) = (&from.course, &to.course);
        let known = a.twist_within(length).max(b.twist_within(length));
        let (bends, twist) = match (a.bend, b.bend) {
            (Some(left), Some(right)) => {
                ([left, right], known + SPARE * (right - left).abs() / length)
            }
            _ => {
                // of the cubic through values and rates
                let mean = (b.value - a.value) / length;
                let left = (6.0 * mean - 4.0 * a.rate - 2.0 * b.rate) / length;
                let right = (4.0 * b.rate + 2.0 * a.rate - 6.0 * mean) / length;
                let change = (right - left).abs().max(0.25 * left.abs().max(right.abs()));
                ([left, right], known + MORE_TO_SPARE * change / length)
            }
        };
        Panel { from, to, length, bends, twist }
    }

    /// Whether the function is below zero, or no further above it than rounding, all the way.
    fn stays_below(&self) -> bool {
        let (a, b) = (&self.from.course, &self.to.course);
        let noise = a.noise.max(b.noise);
        let half = 0.5 * self.length;
        // where there is no length there is nothing between
        if !(self.length > 0.0) {
            return b.value <= noise;
        }
        largest(a.value, a.rate, self.bends[0], self.twist, half) <= noise
            && largest(b.value, -b.rate, self.bends[1], self.twist, half) <= noise
    }

    /// Whether the function rises all the way.
    fn rises_only(&self) -> bool {
        let (a, b) = (&self.from.course, &self.to.course);
        let half = 0.5 * self.length;
        let least = |rate: f64, bend: f64| {
            let at_end = rate + half * (bend - 0.5 * self.twist * half);
            // a rate bent downwards is least at the end, as the parabola is
            rate.min(at_end)
        };
        least(a.rate, self.bends[0]) > 0.0 && least(b.rate, -self.bends[1]) > 0.0
    }

    /// Where to look next.
    fn split(&self) -> f64 {
        let (a, b) = (&self.from.course, &self.to.course);
        let h = self.length;
        let share = if b.value > b.noise {
            self.expected_rise().map_or(0.5, |share| BEYOND * share)
        } else if a.rate > 0.0 && b.rate < 0.0 {
            a.rate / (a.rate - b.rate)
        } else {
            0.5
        };
        self.from.at + h * share.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE)
    }

    /// Share of the way after which the parabola from the begin rises through zero.
    fn expected_rise(&self) -> Option<f64> {
        let a = &self.from.course;
        let (c, b, half) = (a.value.min(0.0), a.rate, 0.5 * self.bends[0]);
        let root = b * b - 4.0 * half * c;
        if !(root >= 0.0) {
            return None;
        }
        // of the two zeros the one with a rising slope
        let rise =
            if b > 0.0 { -2.0 * c / (b + root.sqrt()) } else { (root.sqrt() - b) / (2.0 * half) };
        Some(rise / self.length).filter(|share| *share > 0.0 && *share < 1.0)
    }

    /// Whether a place between is as good as one of the ends.
    fn is_a_point(&self, middle: f64) -> bool {
        let grain = 4.0 * f64::EPSILON * self.to.at.abs().max(self.from.at.abs());
        !(middle > self.from.at + grain && middle < self.to.at - grain)
    }
}

/// The largest value of c + b x + a x²/2 + t x³/6 for x from 0 to `reach`.
fn largest(c: f64, b: f64, a: f64, t: f64, reach: f64) -> f64 {
    let value = |x: f64| c + x * (b + x * (0.5 * a + x * t / 6.0));
    let most = value(0.0).max(value(reach));
    // its slope b + a x + t x²/2 falls through zero at the smaller of two roots
    let root = a * a - 2.0 * t * b;
    if !(root > 0.0) {
        return most;
    }
    let summit = if a > 0.0 {
        // bends upwards from the begin on: no summit behind it
        return most;
    } else {
        2.0 * b / (-a + root.sqrt())
    };
    if summit > 0.0 && summit < reach { most.max(value(summit)) } else { most }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// A function with three derivatives; `known` says whether the second one is told.
    fn search(
        g: impl Fn(f64) -> [f64; 3],
        twist: f64,
        from: f64,
        to: f64,
        known: bool,
    ) -> (Found, usize) {
        let mut looks = 0;
        let at = |at: f64| {
            let [value, rate, bend] = g(at);
            let course = Course {
                value,
                rate,
                bend: known.then_some(bend),
                twist: [twist, 0.0, 0.0],
                grain: 1.0,
                noise: 1e-13,
            };
            Look { at, course }
        };
        let found = first_rise(at(from), at(to), |x| {
            looks += 1;
            Ok::<_, Infallible>(at(x))
        });
        let Ok(found) = found;
        (found, looks)
    }

    #[test]
    fn far_below_zero_the_ends_are_enough() {
        let wave = |x: f64| [x.sin() - 3.0, x.cos(), -x.sin()];
        assert_eq!(search(wave, 1.0, 0.0, 1.0, true), (Found::Nothing, 0));
    }

    #[test]
    fn a_visit_between_two_ends_below_zero_is_found_whatever_the_step() {
        for turns in [0.5, 1.0, 3.0, 40.0] {
            let wave = |x: f64| [x.sin() - 0.99, x.cos(), -x.sin()];
            let (found, _) = search(wave, 1.0, -1.0, -1.0 + turns * std::f64::consts::TAU, true);
            let Found::Rise(a, b) = found else { panic!("{turns}: {found:?}") };
            let exact = 0.99f64.asin();
            assert!(a.at <= exact && exact <= b.at, "{turns}: {} {} {exact}", a.at, b.at);
        }
    }

    #[test]
    fn the_first_of_many_rises_is_the_one_found() {
        let wave = |x: f64| [(9.0 * x).sin() - 0.5, 9.0 * (9.0 * x).cos(), -81.0 * (9.0 * x).sin()];
        let (found, looks) = search(wave, 729.0, -0.1, 5.0, true);
        let Found::Rise(a, b) = found else { panic!("{found:?}") };
        let exact = 0.5f64.asin() / 9.0;
        assert!(a.at <= exact && exact <= b.at && looks < 40, "{} {} in {looks}", a.at, b.at);
    }

    #[test]
    fn a_graze_from_below_is_none_and_one_from_above_is() {
        for height in [1e-6, 1e-9, 1e-12] {
            let arch =
                |top: f64| move |x: f64| [top - (x - 0.3) * (x - 0.3), -2.0 * (x - 0.3), -2.0];
            let (below, looks) = search(arch(-height), 1.0, 0.0, 1.0, true);
            assert!(below == Found::Nothing && looks < 100, "{height}: {below:?} in {looks}");
            let (above, looks) = search(arch(height), 1.0, 0.0, 1.0, true);
            let Found::Rise(a, b) = above else { panic!("{height}: {above:?} in {looks}") };
            let exact = 0.3 - height.sqrt();
            assert!(a.at <= exact && exact <= b.at, "{height}: {} {}", a.at, b.at);
        }
    }

    #[test]
    fn a_function_that_leaves_zero_downwards_is_proven_below() {
        let hop = |x: f64| [-x * (1.0 - x) - 0.5 * x * x, -1.0 + x, 1.0];
        assert_eq!(search(hop, 0.1, 0.0, 0.9, true).0, Found::Nothing);
        let soft = |x: f64| [-0.5 * x * x, -x, -1.0];
        assert_eq!(search(soft, 0.1, 0.0, 1.0, true).0, Found::Nothing);
    }

    #[test]
    fn a_short_hop_lands_where_it_returns() {
        let hop = |x: f64| [x * (x - 1e-5), 2.0 * x - 1e-5, 2.0];
        let (found, looks) = search(hop, 1.0, 0.0, 1.0, true);
        let Found::Rise(a, b) = found else { panic!("{found:?}") };
        assert!(a.at <= 1e-5 && 1e-5 <= b.at && looks < 60, "{} {} in {looks}", a.at, b.at);
    }

    #[test]
    fn without_second_derivatives_a_bump_is_found_by_rates() {
        for top in [0.2, 1e-3, 1e-7] {
            let bump = |x: f64| [top - (x - 0.6) * (x - 0.6), -2.0 * (x - 0.6), f64::NAN];
            let (found, _) = search(bump, 0.0, 0.0, 1.0, false);
            assert!(matches!(found, Found::Rise(..)), "{top}: {found:?}");
        }
    }
}
