//! Integrals along the trajectory: works and dissipated energies.
//!
//! They are not among IDA's unknowns, for there they would take part in its error control. The
//! powers are known at the end of each step; the polynomial through the latest of them is
//! integrated over the latest step. Six nodes make it as accurate as a BDF method of order five;
//! three Gauss points integrate it exactly.
//!
//! The powers carry the noise of the tolerance from step to step. Nodes that lie close together,
//! measured by the length of the newest step, would only turn it into large differences, so they
//! are left out: after a restart, while steps double, and behind a step cut short by an end time.
//!
//! IDA's steps are as long as the trajectory lets them be, which in free flight is far too long
//! for powers that turn with a crank. Over a step in which anything turns noticeably, the powers
//! are therefore asked for inside it; and where powers change of which the trajectory tells nothing,
//! in panels that are halved until it makes no difference.

/// Most nodes that the polynomial goes through.
const NODES: usize = 6;

/// A node nearer than this to the one after it, in lengths of the newest step, is left out.
///
/// The weights' magnitudes then sum up to 4 lengths while steps double (167 with all nodes), to 17
/// at most while they grow by less, and to 2.3 while they are equal.
const NEAREST: f64 = 0.25;

/// A step in which the system turns further than this (rad) is looked into, ...
const NOTICEABLE_TURN: f64 = 1e-2;

/// ... in panels in which it turns no further than this (rad).
const PANEL_TURN: f64 = 5e-2;

/// Abscissas and weights of Gauss–Legendre quadrature over (−1, 1), exact to degree five.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Integrals over a panel that differ by less, over the largest, are the same.
const ALIKE: f64 = 1e-13;

/// Powers at the end of one step.
#[derive(Debug, Clone)]
struct Node {
    /// Time (s).
    time: f64,
    /// Powers (W).
    powers: Vec<f64>,
}

/// Integrates powers from step to step.
#[derive(Debug)]
pub(super) struct Quadrature {
    /// The newest first; `used` of them hold something.
    nodes: [Node; NODES],
    used: usize,
    /// Integrals (J) at the begin of the latest step.
    before: Vec<f64>,
    /// Integrals (J) at its end.
    totals: Vec<f64>,
    /// What rounding took from `totals` so far (J).
    lost: Vec<f64>,
    /// Typical rate at which the system turns (rad/s).
    turning: f64,
}

impl Quadrature {
    /// Space for a number of integrals of a system that typically turns at a rate (rad/s).
    pub(super) fn new(integrals: usize, turning: f64) -> Self {
        let zeros = vec![0.0; integrals];
        let node = Node { time: 0.0, powers: zeros.clone() };
        Quadrature {
            nodes: std::array::from_fn(|_| node.clone()),
            used: 0,
            before: zeros.clone(),
            totals: zeros.clone(),
            lost: zeros,
            turning,
        }
    }

    /// Whether powers are wanted inside a step of this length (s).
    pub(super) fn wants_looks(&self, length: f64) -> bool {
        !self.totals.is_empty() && length * self.turning > NOTICEABLE_TURN
    }

    /// Panels (s) from one time to another, the last first.
    pub(super) fn panels(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let panels = ((to - from) * self.turning / PANEL_TURN).ceil().max(1.0);
        let at = |panel: u64| from + (to - from) * (panel as f64 / panels);
        (0..panels as u64).rev().map(|panel| [at(panel), at(panel + 1)]).collect()
    }

    /// Whether two integrals (J) over a panel are the same, as far as the totals can tell.
    pub(super) fn agree(&self, whole: &[f64], halves: &[f64]) -> bool {
        let sizes = self.totals.iter().chain(halves);
        let size = sizes.fold(0.0_f64, |size, energy| size.max(energy.abs()));
        whole.iter().zip(halves).all(|(a, b)| (a - b).abs() <= ALIKE * size)
    }

    /// Replaces what the latest step added by these integrals over it (J).
    pub(super) fn correct(&mut self, gained: &[f64]) {
        for ((total, before), gained) in self.totals.iter_mut().zip(&self.before).zip(gained) {
            *total = before + gained;
        }
        self.lost.fill(0.0);
    }

    /// Integrals (J) at the begin of the latest step.
    pub(super) fn before(&self) -> &[f64] {
        &self.before
    }

    /// Begins anew at a time (s) with these powers (W) and integrals (J).
    pub(super) fn restart(&mut self, time: f64, powers: &[f64], integrals: &[f64]) {
        if self.totals != integrals {
            self.totals.copy_from_slice(integrals);
            self.lost.fill(0.0);
        }
        self.before.copy_from_slice(integrals);
        self.nodes[0].time = time;
        self.nodes[0].powers.copy_from_slice(powers);
        self.used = 1;
    }

    /// Takes in a step that ended at a time (s) with these powers (W).
    pub(super) fn advance(&mut self, time: f64, powers: &[f64]) {
        if self.totals.is_empty() {
            return;
        }
        self.make_room(time);
        self.nodes[0].time = time;
        self.nodes[0].powers.copy_from_slice(powers);
        self.before.copy_from_slice(&self.totals);
        let weights = self.weights(time);
        let nodes = &self.nodes[..self.used];
        for (k, (total, lost)) in self.totals.iter_mut().zip(&mut self.lost).enumerate() {
            // Compensated summation: a run has up to a million steps.
            let increment = weigh(&weights, nodes, k) - *lost;
            let sum = *total + increment;
            *lost = (sum - *total) - increment;
            *total = sum;
        }
    }

    /// Integrals (J) at the end of the latest step.
    pub(super) fn totals(&self) -> &[f64] {
        &self.totals
    }

    /// Integrals (J) at a time (s) within the latest step.
    pub(super) fn within(&self, time: f64, integrals: &mut [f64]) {
        if self.used < 2 || integrals.is_empty() {
            integrals.copy_from_slice(&self.totals);
            return;
        }
        let weights = self.weights(time);
        let nodes = &self.nodes[..self.used];
        for (k, (integral, before)) in integrals.iter_mut().zip(&self.before).enumerate() {
            *integral = before + weigh(&weights, nodes, k);
        }
    }

    /// Frees the first node for a step that ended at a time (s), and forgets the nodes that lie too
    /// close together for a step of that length.
    fn make_room(&mut self, time: f64) {
        let nearest = NEAREST * (time - self.nodes[0].time);
        let mut kept = 1;
        for next in 1..self.used {
            if self.nodes[kept - 1].time - self.nodes[next].time >= nearest {
                self.nodes.swap(kept, next);
                kept += 1;
            }
        }
        self.used = (kept + 1).min(NODES);
        self.nodes.rotate_right(1);
    }

    /// Weights (s) of the powers at the nodes in the integral from the begin of the latest step to
    /// a time (s) within it.
    fn weights(&self, time: f64) -> [f64; NODES] {
        match self.used {
            2 => self.weights_of::<2>(time),
            3 => self.weights_of::<3>(time),
            4 => self.weights_of::<4>(time),
            5 => self.weights_of::<5>(time),
            _ => self.weights_of::<NODES>(time),
        }
    }

    /// The same where N nodes hold something.
    fn weights_of<const N: usize>(&self, time: f64) -> [f64; NODES] {
        let (end, length) = (self.nodes[0].time, self.nodes[0].time - self.nodes[1].time);
        let x: [f64; N] = std::array::from_fn(|j| (self.nodes[j].time - end) / length);
        let mut weights = [0.0; NODES];
        let half = 0.5 * ((time - end) / length + 1.0);
        for (abscissa, gauss) in GAUSS {
            let at = half * (1.0 + abscissa) - 1.0;
            // before[j] = Π (at − x_i) over i < j; the products over i > j follow backwards.
            let mut before = [1.0; N];
            for j in 1..N {
                before[j] = before[j - 1] * (at - x[j - 1]);
            }
            let mut after = 1.0;
            for j in (0..N).rev() {
                weights[j] += gauss * before[j] * after;
                after *= at - x[j];
            }
        }
        for j in 0..N {
            let mut others = 1.0;
            for i in 0..N {
                if i != j {
                    others *= x[j] - x[i];
                }
            }
            weights[j] *= half * length / others;
        }
        weights
    }
}

/// Times (s) and weights (s) of the powers wanted in a panel.
pub(super) fn looks([from, to]: [f64; 2]) -> [(f64, f64); 3] {
    let (middle, half) = (from.midpoint(to), 0.5 * (to - from));
    GAUSS.map(|(abscissa, weight)| (middle + half * abscissa, half * weight))
}

/// Integral `k`: the sum of its powers at the nodes, weighted.
fn weigh(weights: &[f64; NODES], nodes: &[Node], k: usize) -> f64 {
    nodes.iter().zip(weights).map(|(node, weight)| weight * node.powers[k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lengths of steps as IDA takes them after a restart: they begin at 1e-10 s, double until
    /// `longest`, and then stay or change a little.
    fn steps_after_a_restart(longest: f64, number: usize) -> Vec<f64> {
        let mut length = 0.5e-10;
        let step = |i: usize| {
            if i != 1 && length < longest {
                length *= 2.0;
            } else if i.is_multiple_of(17) {
                length *= 0.7;
            }
            length
        };
        (0..number).map(step).collect()
    }

    /// Largest error of two integrals at the ends of the steps and a third of a step before them.
    fn largest_error(
        lengths: &[f64],
        powers: impl Fn(f64) -> [f64; 2],
        integrals: impl Fn(f64) -> [f64; 2],
    ) -> f64 {
        let mut quadrature = Quadrature::new(2, 1.0);
        let mut time = 0.25;
        quadrature.restart(time, &powers(time), &integrals(time));
        let mut worst = 0.0_f64;
        let mut at = [0.0; 2];
        for length in lengths {
            let inside = time + length * 2.0 / 3.0;
            time += length;
            quadrature.advance(time, &powers(time));
            quadrature.within(inside, &mut at);
            for (found, exact) in quadrature.totals().iter().zip(integrals(time)) {
                worst = worst.max((found - exact).abs());
            }
            for (found, exact) in at.iter().zip(integrals(inside)) {
                worst = worst.max((found - exact).abs());
            }
        }
        worst
    }

    #[test]
    fn smooth_powers_are_integrated_to_the_last_digits_after_a_restart() {
        let lengths = steps_after_a_restart(1e-3, 2000);
        let error = largest_error(
            &lengths,
            |t| [(7.0 * t).cos(), (-2.0 * t).exp()],
            |t| [(7.0 * t).sin() / 7.0, -0.5 * (-2.0 * t).exp()],
        );
        assert!(error < 1e-12, "{error}");
    }

    #[test]
    fn polynomials_of_degree_five_are_exact_once_six_nodes_are_there() {
        let lengths = [0.1, 0.13, 0.08, 0.11, 0.2, 0.15, 0.1, 0.1];
        let mut quadrature = Quadrature::new(1, 1.0);
        let (power, integral) = (|t: f64| t.powi(5), |t: f64| t.powi(6) / 6.0);
        let mut time = 0.0;
        quadrature.restart(time, &[power(time)], &[0.0]);
        for (i, length) in lengths.iter().enumerate() {
            let began = time;
            time += length;
            quadrature.advance(time, &[power(time)]);
            let step = quadrature.totals()[0] - quadrature.before[0];
            let exact = integral(time) - integral(began);
            let error = ((step - exact) / integral(time)).abs();
            assert!(i < 4 || error < 16.0 * f64::EPSILON, "step {i}: {error}");
        }
    }

    #[test]
    fn noise_of_the_powers_is_not_amplified_by_close_nodes() {
        // A step cut short by an end time, 1e-9 of its neighbours, and doubling ones.
        let mut lengths = steps_after_a_restart(1e-4, 40);
        lengths.extend([1e-4, 1e-13, 1e-4, 1e-4, 1e-13, 1e-13, 2e-13, 1e-4]);
        let noise = 1e-6;
        let mut quadrature = Quadrature::new(1, 1.0);
        quadrature.restart(0.0, &[1.0], &[0.0]);
        let (mut time, mut sign) = (0.0, noise);
        for length in lengths {
            time += length;
            sign = -sign;
            quadrature.advance(time, &[1.0 + sign]);
            let step = quadrature.totals()[0] - quadrature.before[0];
            let error = (step / length - 1.0).abs();
            assert!(error < 17.0 * noise, "step {length} to {time}: {error}");
        }
    }

    #[test]
    fn the_ends_of_a_step_have_the_integrals_of_its_ends() {
        let mut quadrature = Quadrature::new(1, 1.0);
        quadrature.restart(1.0, &[3.0], &[10.0]);
        let mut at = [0.0];
        quadrature.within(1.0, &mut at);
        assert_eq!(at, [10.0]);
        quadrature.advance(1.5, &[4.0]);
        quadrature.advance(2.0, &[5.0]);
        assert_eq!(quadrature.totals(), [14.0]);
        quadrature.within(1.5, &mut at);
        assert_eq!(at, [11.75]);
        quadrature.within(2.0, &mut at);
        assert!((at[0] - 14.0).abs() < 1e-14);
    }

    #[test]
    fn small_increments_are_not_lost_in_a_large_sum() {
        let mut quadrature = Quadrature::new(1, 1.0);
        quadrature.restart(0.0, &[1.0], &[1e3]);
        let step = 2.0_f64.powi(-30);
        for i in 1..=100_000 {
            quadrature.advance(f64::from(i) * step, &[0.1]);
        }
        // The first step interpolates from 1 to 0.1; the second and third see that edge too.
        let mut same = Quadrature::new(1, 1.0);
        same.restart(0.0, &[1.0], &[0.0]);
        for i in 1..=100_000 {
            same.advance(f64::from(i) * step, &[0.1]);
        }
        let difference = (quadrature.totals()[0] - 1e3) - same.totals()[0];
        assert!(difference.abs() < 2.0 * f64::EPSILON * 1e3, "{difference}");
    }
}
