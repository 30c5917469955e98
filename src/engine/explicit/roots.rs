//! Which roots the explicit engine carries, and when they are set anew.

use super::Explicit;
use super::events::Standing;
use super::flow::{Flow, Root};
use crate::dae::{Fault, System};
use crate::scalar::Scalar;

/// Steps between two looks at the roots carried.
const REVISION: u64 = 32;
/// A root is set anew where it is off its function by so many times the tolerance, and the
/// function larger than that by as much again.
const DISAGREEMENT: f64 = 1e3;

impl<S: Scalar, Y: System<S>> Explicit<S, Y> {
    /// The roots to carry from here on, with their values: a root that was carried goes on where
    /// it still is one, a function that stands at zero begins at zero, others from their values.
    /// None where the function does not get away from zero at a rate of its own.
    pub(super) fn roots_from_here(&mut self, goes_on: bool) -> Result<Vec<(Root<S>, S)>, Fault> {
        let carried: Vec<(usize, S)> = if goes_on {
            let slots = self.flow.roots().iter().enumerate();
            slots.map(|(slot, root)| (root.function, self.here.y[self.flow.root(slot)])).collect()
        } else {
            Vec::new()
        };
        let values = self.flow.event_values(&self.here.y)?.to_vec();
        let mut roots = Vec::new();
        for (k, watch) in self.flow.system.watches().iter().enumerate() {
            let Some(degree) = Flow::<S, Y>::degree(*watch) else { continue };
            let before = carried.iter().find(|(function, _)| *function == k);
            let sigma = match before {
                Some((_, sigma)) if !self.fired[k] => Some(*sigma),
                _ => self.first_root(k, degree, values[k], goes_on && self.fired[k]),
            };
            roots.extend(sigma.map(|sigma| (Root::new(k, degree), sigma)));
        }
        Ok(roots)
    }

    /// Value of a root that has not been carried so far; the system stands evaluated here.
    fn first_root(&self, k: usize, degree: u32, value: S, fired: bool) -> Option<S> {
        let rate = self.flow.system.event_rate(k).to_f64();
        let noise = self.noise(rate);
        let away = rate * self.options.initial_step > noise;
        if fired || value.to_f64() <= noise {
            return away.then(S::zero);
        }
        let enough = away || value.to_f64() > 1e4 * noise;
        enough.then(|| root_of(value, degree))
    }

    /// Roots that are zero together would hold the flow: they are set to where they come to be
    /// after a time too short to matter.
    pub(super) fn part_roots(&self, roots: &mut [(Root<S>, S)]) {
        if roots.iter().filter(|(_, sigma)| *sigma == S::zero()).count() < 2 {
            return;
        }
        let moment = S::from_f64(self.options.tolerance * self.options.initial_step);
        for (root, sigma) in roots.iter_mut().filter(|(_, sigma)| *sigma == S::zero()) {
            let rate = self.flow.system.event_rate(root.function);
            *sigma = root_of(rate * moment, root.degree);
        }
    }

    /// Changes the roots carried; q, v, z, t and integrals of `here` stay.
    pub(super) fn carry(&mut self, roots: Vec<(Root<S>, S)>) {
        let old = self.flow.controlled()..self.flow.len();
        let integrals: Vec<(S, S)> = old.map(|i| (self.here.y[i], self.here.low[i])).collect();
        let (roots, values): (Vec<Root<S>>, Vec<S>) = roots.into_iter().unzip();
        let kept: Vec<(usize, S, S)> = (0..self.flow.roots().len())
            .map(|slot| (slot, self.flow.root(slot)))
            .map(|(slot, i)| (self.flow.roots()[slot].function, self.here.y[i], self.here.low[i]))
            .collect();
        for root in &roots {
            if self.flow.slot(root.function).is_none() {
                self.deepest[root.function] = 0.0;
            }
        }
        self.flow.carry(roots);
        for (slot, value) in values.into_iter().enumerate() {
            let (i, function) = (self.flow.root(slot), self.flow.roots()[slot].function);
            let same = kept.iter().find(|(k, y, _)| *k == function && *y == value);
            self.here.y[i] = value;
            self.here.low[i] = same.map_or(S::zero(), |(_, _, low)| *low);
        }
        let first = self.flow.controlled();
        for (i, (value, low)) in integrals.into_iter().enumerate() {
            self.here.y[first + i] = value;
            self.here.low[first + i] = low;
        }
    }

    /// The root to carry of function `k` here: that which is carried, unless it no longer agrees
    /// with its function; or a first one, once the function has come away from zero.
    fn revised_root(&self, k: usize, degree: u32, value: S) -> Option<S> {
        let Some(slot) = self.flow.slot(k) else {
            let away = value.to_f64() > 1e4 * self.noise(0.0);
            return away.then(|| root_of(value, degree));
        };
        let sigma = self.here.y[self.flow.root(slot)];
        let power = (1..degree).fold(sigma, |power, _| power * sigma);
        let off = (power - value).to_f64().abs();
        let stale = off > DISAGREEMENT * (self.options.tolerance + S::EPSILON);
        let telling = value.to_f64() > DISAGREEMENT * off;
        Some(if stale && telling { root_of(value, degree) } else { sigma })
    }

    /// Now and then, looks whether the roots carried are still the right ones.
    pub(super) fn revise_roots(&mut self) -> Result<(), Fault> {
        let mut powers = self.flow.system.watches().iter().enumerate();
        let waiting =
            powers.any(|(k, w)| Flow::<S, Y>::degree(*w).is_some() && self.flow.slot(k).is_none());
        let due = self.tally.steps.is_multiple_of(REVISION) && !self.flow.roots().is_empty();
        if !(waiting || due) {
            return Ok(());
        }
        let values = self.flow.event_values(&self.here.y)?.to_vec();
        let mut roots = Vec::new();
        for (k, watch) in self.flow.system.watches().iter().enumerate() {
            let Some(degree) = Flow::<S, Y>::degree(*watch) else { continue };
            let sigma = self.revised_root(k, degree, values[k]);
            roots.extend(sigma.map(|sigma| (Root::new(k, degree), sigma)));
        }
        let same = |(root, sigma): &(Root<S>, S)| {
            let slot = self.flow.slot(root.function);
            slot.is_some_and(|slot| self.here.y[self.flow.root(slot)] == *sigma)
        };
        if !roots.iter().all(same) {
            for (root, _) in &roots {
                self.standing[root.function] = Standing::Below;
            }
            self.carry(roots);
            self.arrive()?;
        }
        Ok(())
    }
}

/// The d-th root of a positive number.
fn root_of<S: Scalar>(value: S, degree: u32) -> S {
    if degree == 2 { value.sqrt() } else { value.powf(S::ratio(1, i64::from(degree))) }
}
