//! Adaptive sampling: which of many observations straight lines need.
//!
//! Between two samples every force curve is drawn as a straight line. A window gathers
//! observations, one at least for each step in contact, and when it closes it lets go those that
//! a line from sample to sample does not miss by more than 1 % of the neighbouring force peaks.

use crate::mechanism::Observation;

/// What a straight line may miss of a force peak.
const MISS: f64 = 0.01;
/// Times that are no farther apart than this, relative, are one: some ulps.
const SAME_TIME: f64 = 64.0 * f64::EPSILON;
/// A window is closed at this many observations, wherever it stands.
const MOST: usize = 1024;

/// Whether a time (s) is that of an earlier one, but for its rounding.
pub(super) fn is_same_time(earlier: f64, time: f64) -> bool {
    time - earlier <= SAME_TIME * time.abs()
}

/// Observations that wait for their window to close.
#[derive(Debug)]
pub(super) struct Window {
    waiting: Vec<(Observation, bool)>,
    /// Whether the first that waits is the last sample of the window before.
    carried: bool,
    /// By clearance: the last force peak of the present contact (N).
    last_peaks: Vec<f64>,
    /// Time of the last observation before the first that waits (s).
    seen_until: f64,
}

impl Window {
    /// A window that opens behind a time (s).
    pub fn new(clearances: usize, seen_until: f64) -> Self {
        let last_peaks = vec![f64::INFINITY; clearances];
        Window { waiting: Vec::new(), carried: false, last_peaks, seen_until }
    }

    /// Time of the last observation (s).
    pub fn seen_until(&self) -> f64 {
        self.waiting.last().map_or(self.seen_until, |(last, _)| last.time)
    }

    /// Adds an observation; `keep` has it sampled in any case. One at the time of the last, or so
    /// little later that rounding is most of the difference, is the same.
    pub fn push(&mut self, observation: Observation, keep: bool) {
        match self.waiting.last_mut() {
            Some((last, kept)) if is_same_time(last.time, observation.time) => *kept |= keep,
            None if is_same_time(self.seen_until, observation.time) => {}
            _ => self.waiting.push((observation, keep)),
        }
    }

    /// Whether the window should close for its size.
    pub fn is_full(&self) -> bool {
        self.waiting.len() >= MOST
    }

    /// A contact has begun: what was a peak before is none of its own.
    pub fn forget_peaks(&mut self, clearance: usize) {
        self.last_peaks[clearance] = f64::INFINITY;
    }

    /// Closes the window at its last observation, where the next one begins; `peaks` are the
    /// force peaks (clearance, N) that it ends with. Returns the samples.
    pub fn close(&mut self, peaks: &[(usize, f64)]) -> Vec<Observation> {
        let allowed: Vec<f64> = (self.last_peaks.iter().enumerate())
            .map(|(k, last)| {
                let forces = self.waiting.iter().map(|(o, _)| o.clearances[k].normal_force.abs());
                let here = peaks.iter().filter(|(at, _)| *at == k).map(|(_, force)| force.abs());
                MISS * here.fold(last.min(forces.fold(0.0, f64::max)), f64::min)
            })
            .collect();
        for (k, force) in peaks {
            self.last_peaks[*k] = force.abs();
        }
        if let Some((_, keep)) = self.waiting.last_mut() {
            *keep = true;
        }
        let chosen = chosen(&self.waiting, &allowed);
        let carried = self.waiting.last().cloned();
        let skipped = usize::from(std::mem::replace(&mut self.carried, carried.is_some()));
        let mut waiting: Vec<_> =
            std::mem::take(&mut self.waiting).into_iter().map(|(o, _)| Some(o)).collect();
        self.waiting.extend(carried);
        chosen.into_iter().skip(skipped).filter_map(|place| waiting[place].take()).collect()
    }
}

/// Places of the observations that are kept: those marked, and as few between them as keep
/// every straight line within `allowed` (N, by clearance) of what it passes.
fn chosen(waiting: &[(Observation, bool)], allowed: &[f64]) -> Vec<usize> {
    let mut chosen = Vec::new();
    let mut from = 0;
    for (place, (_, keep)) in waiting.iter().enumerate() {
        if place == 0 || *keep {
            between(waiting, allowed, from, place, &mut chosen);
            chosen.push(place);
            from = place;
        }
    }
    chosen.dedup();
    chosen
}

/// Splits the stretch from one kept observation to another at the worst miss, until none is left.
fn between(
    waiting: &[(Observation, bool)],
    allowed: &[f64],
    from: usize,
    to: usize,
    chosen: &mut Vec<usize>,
) {
    let (a, b) = (&waiting[from].0, &waiting[to].0);
    let mut worst = (1.0, from);
    for (place, (here, _)) in waiting.iter().enumerate().take(to).skip(from + 1) {
        let part = (here.time - a.time) / (b.time - a.time);
        for (k, allowed) in allowed.iter().enumerate() {
            let force = |o: &Observation| o.clearances[k].normal_force;
            let line = force(a) + part * (force(b) - force(a));
            let miss = (force(here) - line).abs() / allowed.max(f64::MIN_POSITIVE);
            if miss > worst.0 {
                worst = (miss, place);
            }
        }
    }
    if worst.1 > from {
        between(waiting, allowed, from, worst.1, chosen);
        chosen.push(worst.1);
        between(waiting, allowed, worst.1, to, chosen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::ClearanceObservation;

    fn at(time: f64, force: f64) -> Observation {
        let clearance = ClearanceObservation { normal_force: force, ..Default::default() };
        Observation { time, clearances: vec![clearance], ..Observation::default() }
    }

    #[test]
    fn straight_lines_stay_within_a_hundredth_of_the_peak() {
        let force = |t: f64| 1000.0 * (t * std::f64::consts::PI).sin().powf(1.5);
        let mut window = Window::new(1, f64::NEG_INFINITY);
        for k in 0..=400 {
            let t = f64::from(k) / 800.0;
            window.push(at(t, force(t)), false);
        }
        let samples = window.close(&[(0, force(0.5))]);
        assert!(samples.len() < 20, "{} samples for a rise", samples.len());
        for pair in samples.windows(2) {
            for part in [0.25, 0.5, 0.75] {
                let t = pair[0].time + part * (pair[1].time - pair[0].time);
                let [a, b] = [&pair[0], &pair[1]].map(|o| o.clearances[0].normal_force);
                let miss = (a + part * (b - a) - force(t)).abs();
                assert!(miss <= 1.05 * MISS * 1000.0, "{miss} N at {t}");
            }
        }
    }

    #[test]
    fn no_two_samples_are_a_few_ulps_apart() {
        let mut window = Window::new(1, f64::NEG_INFINITY);
        for (time, keep) in [(0.0, true), (0.3, true), (0.3 + 8e-17, true), (0.4, false)] {
            window.push(at(time, 0.0), keep);
        }
        let times: Vec<f64> = window.close(&[]).iter().map(|o| o.time).collect();
        assert_eq!(times, [0.0, 0.3, 0.4]);
    }

    #[test]
    fn what_is_marked_is_kept_and_times_increase() {
        let mut window = Window::new(1, f64::NEG_INFINITY);
        window.push(at(0.0, 0.0), true);
        window.push(at(1.0, 0.0), true);
        window.push(at(1.0, 0.0), false);
        window.push(at(2.0, 0.0), false);
        window.push(at(3.0, 0.0), false);
        let times: Vec<f64> = window.close(&[]).iter().map(|o| o.time).collect();
        assert_eq!(times, [0.0, 1.0, 3.0]);
        window.push(at(4.0, 0.0), false);
        let times: Vec<f64> = window.close(&[]).iter().map(|o| o.time).collect();
        assert_eq!(times, [4.0]);
    }
}
