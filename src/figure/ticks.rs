//! Where an axis has its ticks, and what stands beside them.

/// Steps of degrees that people count in, and the minor steps between them (deg).
const DEGREES: [[f64; 2]; 8] = [
    [1.0, 0.2],
    [2.0, 0.5],
    [5.0, 1.0],
    [10.0, 2.0],
    [30.0, 10.0],
    [45.0, 15.0],
    [90.0, 30.0],
    [180.0, 45.0],
];

/// Ticks of an axis, in the unit of its labels.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Ticks {
    /// Ticks with labels.
    pub major: Vec<f64>,
    /// Ticks between them.
    pub minor: Vec<f64>,
    /// What stands beside the major ticks.
    pub labels: Vec<String>,
}

impl Ticks {
    /// Ticks at 1, 2 or 5 times a power of ten, at most `most` major ones unless that leaves a
    /// single one, which would tell no scale.
    pub fn decimal(range: [f64; 2], most: usize) -> Self {
        let span = range[1] - range[0];
        let rough = span / most.max(2) as f64;
        let power = rough.log10().floor();
        if !power.is_finite() {
            return Ticks::default();
        }
        let steps = [(1.0, 5.0), (2.0, 4.0), (5.0, 5.0), (10.0, 5.0), (20.0, 4.0)];
        let count = |(step, _): &(f64, f64)| count(range, step * 10_f64.powf(power));
        let fits = steps.iter().position(|step| count(step) <= most.max(2)).unwrap_or(4);
        let (step, parts) =
            if count(&steps[fits]) < 2 { steps[fits.saturating_sub(1)] } else { steps[fits] };
        let power = power as i32;
        let (step, power) = if step >= 10.0 { (step / 10.0, power + 1) } else { (step, power) };
        Ticks::every(range, |k| times_power(step * k, power), step * 10_f64.powi(power), parts)
            .labelled(power)
    }

    /// Ticks at degrees that people count in: 90, 180, 360 and their like.
    pub fn degrees(range: [f64; 2], most: usize) -> Self {
        let turns = (0..15).flat_map(|power| {
            [[1.0, 4.0], [2.0, 4.0], [5.0, 5.0]].map(|[turns, parts]| {
                let step = 360.0 * turns * 10_f64.powi(power);
                [step, step / parts]
            })
        });
        let mut steps = DEGREES.into_iter().chain(turns);
        let [step, minor] =
            steps.find(|[step, _]| count(range, *step) <= most.max(2)).unwrap_or([360.0, 90.0]);
        if count(range, step) > 100 || count(range, step) < 2 {
            return Ticks::decimal(range, most);
        }
        Ticks::every(range, |k| step * k, step, (step / minor).round()).labelled(0)
    }

    /// Ticks at zero and at powers of ten times a value, of both signs; every so many of them that
    /// they are `apart` decades from each other at least.
    pub fn bent([low, high]: [f64; 2], beyond: f64, apart: f64) -> Self {
        const MOST: i32 = 40;
        let step = apart.ceil().clamp(1.0, f64::from(MOST)) as usize;
        let within = |value: &f64| (low..=high).contains(value);
        let decades = (0..MOST).map(|decade| times_power(beyond, decade));
        let both = |sizes: Vec<f64>| -> Vec<f64> {
            sizes.into_iter().flat_map(|size| [-size, size]).filter(within).collect()
        };
        let mut major = both(decades.clone().step_by(step).collect());
        major.extend(Some(0.0).filter(within));
        major.sort_by(f64::total_cmp);
        let between = decades.flat_map(|decade| (2..=10).map(move |k| decade * f64::from(k)));
        let near = |place: &f64| major.iter().any(|tick| (tick - place).abs() < 1e-6 * place.abs());
        let mut minor = both(between.collect());
        minor.retain(|place| !near(place));
        let labels = major.iter().map(|tick| signed(&written(*tick))).collect();
        Ticks { major, minor, labels }
    }

    fn every(range: [f64; 2], tick: impl Fn(f64) -> f64, step: f64, parts: f64) -> Self {
        let ticks = |step: f64, tick: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let (first, last) = whole(range, step);
            let count = (last - first).clamp(-1.0, 10_000.0) as i64;
            (0..=count).map(|k| tick(first + k as f64)).collect()
        };
        let major = ticks(step, &tick);
        let near = |place: &f64| major.iter().any(|tick| (tick - place).abs() < 0.1 * step / parts);
        let minor = ticks(step / parts, &|k| k * step / parts);
        let minor = minor.into_iter().filter(|place| !near(place)).collect();
        Ticks { major, minor, labels: Vec::new() }
    }

    /// Labels with as many decimals as ticks of this power of ten need.
    fn labelled(mut self, power: i32) -> Self {
        let decimals = usize::try_from(-power).unwrap_or(0);
        self.labels = self.major.iter().map(|tick| signed(&format!("{tick:.decimals$}"))).collect();
        self
    }
}

/// `value · 10^power`, correctly rounded for the small numbers of ticks.
fn times_power(value: f64, power: i32) -> f64 {
    if power < 0 { value / 10_f64.powi(-power) } else { value * 10_f64.powi(power) }
}

/// First and last whole multiple of a step in a range, a rounding error outside it included.
fn whole([low, high]: [f64; 2], step: f64) -> (f64, f64) {
    let slack = 1e-9 * (high - low) / step;
    ((low / step - slack).ceil(), (high / step + slack).floor())
}

fn count(range: [f64; 2], step: f64) -> usize {
    let (first, last) = whole(range, step);
    (last - first + 1.0).max(0.0) as usize
}

/// A power of ten without rounding errors of its own, or zero.
fn written(value: f64) -> String {
    let decimals = if value == 0.0 { 0.0 } else { -value.abs().log10().round() };
    format!("{value:.*}", decimals.max(0.0) as usize)
}

/// A number as printed: with a true minus sign, and no sign before zero.
pub(super) fn signed(number: &str) -> String {
    match number.strip_prefix('-') {
        Some(size) if size.chars().all(|c| c == '0' || c == '.') => size.to_owned(),
        Some(size) => format!("−{size}"),
        None => number.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ticks_are_round_numbers_with_the_decimals_they_need() {
        let ticks = Ticks::decimal([-0.43, 1.02], 8);
        assert_eq!(ticks.labels, ["−0.4", "−0.2", "0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(
            Ticks::decimal([0.0, 60.0], 7).labels,
            ["0", "10", "20", "30", "40", "50", "60"]
        );
        assert_eq!(Ticks::decimal([0.0, 11.5], 5).labels, ["0", "5", "10"]);
        assert_eq!(Ticks::decimal([0.0, 0.06], 4).labels, ["0.00", "0.02", "0.04", "0.06"]);
        assert_eq!(Ticks::decimal([9_500.0, 10_600.0], 3).labels, ["9500", "10000", "10500"]);
    }

    #[test]
    fn no_tick_stands_alone() {
        assert_eq!(Ticks::decimal([-3.5, 4.3], 3).labels, ["−2", "0", "2", "4"]);
        assert_eq!(Ticks::decimal([-0.9, 0.99], 2).labels, ["−0.5", "0.0", "0.5"]);
    }

    #[test]
    fn minor_ticks_lie_between_the_major_ones() {
        let ticks = Ticks::decimal([0.0, 1.0], 3);
        assert_eq!(ticks.labels, ["0.0", "0.5", "1.0"]);
        let expected = [0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9];
        assert_eq!(ticks.minor.len(), expected.len());
        for (minor, expected) in ticks.minor.iter().zip(expected) {
            assert!((minor - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn angles_are_counted_in_quarters_and_turns() {
        assert_eq!(Ticks::degrees([0.0, 360.0], 9).labels[..3], ["0", "45", "90"]);
        assert_eq!(Ticks::degrees([0.0, 1800.0], 7).labels[..3], ["0", "360", "720"]);
        assert_eq!(Ticks::degrees([0.0, 30_000.0], 10).labels[..2], ["0", "3600"]);
        assert_eq!(Ticks::degrees([-180.0, 180.0], 6).labels, ["−180", "−90", "0", "90", "180"]);
        assert_eq!(Ticks::degrees([0.0, 0.4], 5).labels[..2], ["0.0", "0.1"]);
    }

    #[test]
    fn powers_of_ten_stand_on_both_sides_of_zero() {
        let ticks = Ticks::bent([-30.0, 2000.0], 1.0, 0.9);
        assert_eq!(ticks.labels, ["−10", "−1", "0", "1", "10", "100", "1000"]);
        let ticks = Ticks::bent([-0.02, 2.0], 0.001, 1.2);
        assert_eq!(ticks.labels, ["−0.001", "0", "0.001", "0.1"]);
        assert!(ticks.minor.iter().any(|place| (place - 0.01).abs() < 1e-9));
        assert!(ticks.minor.iter().all(|place| (-0.02..=2.0).contains(place)));
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(["-0.0", "-0", "0.0", "-0.1"].map(signed), ["0.0", "0", "0.0", "−0.1"]);
    }

    #[test]
    fn what_is_no_range_has_no_ticks() {
        for range in [[1.0, 1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY], [2.0, 1.0]] {
            assert_eq!(Ticks::decimal(range, 5), Ticks::default(), "{range:?}");
            assert_eq!(Ticks::degrees(range, 5), Ticks::default(), "{range:?}");
        }
    }

    proptest! {
        #[test]
        fn ticks_lie_in_their_range_and_are_neither_too_many_nor_alone(
            low in -1e3..1e3_f64, span in 1e-3..1e4_f64, most in 3..12_usize,
        ) {
            let range = [low, low + span];
            let ticks = Ticks::decimal(range, most);
            prop_assert!((2..=most.max(5)).contains(&ticks.major.len()), "{:?}", ticks.major);
            prop_assert_eq!(ticks.major.len(), ticks.labels.len());
            for tick in ticks.major.iter().chain(&ticks.minor) {
                prop_assert!(*tick >= low - 1e-6 * span && *tick <= low + span * (1.0 + 1e-6));
            }
            for (tick, label) in ticks.major.iter().zip(&ticks.labels) {
                let read: f64 = label.replace('−', "-").parse().unwrap();
                prop_assert!((read - tick).abs() < 1e-9 * (1.0 + tick.abs()));
            }
        }
    }
}
