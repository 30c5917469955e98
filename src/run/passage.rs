//! The way through a singular position.
//!
//! Where links come to lie in one line the constraints depend on each other, and two branches of motion
//! cross: a parallelogram may go on as one, or cross its cranks. Motion has a rate, and that rate is of one
//! branch alone; along it coordinates are as smooth as anywhere. Beside the position the equations tell
//! the accelerations of that branch as well as the arithmetic holds the share σ of the constraints that the
//! others leave (errors are like ε/σ), and only at the position itself they tell nothing.
//!
//! So the stretch of time about it is solved as a whole, by Gauss's collocation (Hairer, Nørsett, Wanner
//! 1993, II.7), whose nodes keep clear of the middle: accelerations are a polynomial through those at the
//! nodes, where position and velocity are put onto the constraints and the equations are solved. That is
//! done again with more nodes, until both agree. The way is clear where the iteration settles, the nodes
//! hold the constraints by themselves, and σ falls to zero and rises again like a straight line.
//!
//! What holds the branch may grow without bound: multipliers are then like P(t)/(t − t*), with a polynomial
//! P.

use super::collocation::{Nodes, Place, Series};
use crate::dae::{Direction, Snapshot, System};
use crate::mechanism::Mechanism;
use crate::model::Owner;
use crate::scalar::{F256, Scalar};

/// Nodes at first; their number is even, so that none is in the middle.
const FEWEST: usize = 8;
/// Nodes at most.
const MOST: usize = 80;
/// Rounds of the iteration.
const ROUNDS: usize = 60;
/// Times that the stretch is laid anew about the position.
const CENTRINGS: usize = 4;
/// Off the middle by no more than this share of half the stretch, the position is in it.
const CENTRED: f64 = 0.01;
/// The share of the constraints may rise by so much faster, or slower, between two nodes than over all.
const STRAIGHT: f64 = 4.0;
/// Multipliers that are this small a part of what a pole would make of them have none.
const NO_POLE: f64 = 1e-9;
/// The stretch in which its place is found, over half of all.
const LOOK: f64 = 0.15;
/// Looks for it.
const ZERO_LOOKS: usize = 12;
/// Nearer to a pole than this, over half the stretch, forces are told as they are there.
const BESIDE: f64 = 1e-6;
/// Farther from the middle than this, over half the stretch, the equations tell more than the series do.
const CLEAR: f64 = 0.3;
/// By no more than this may the nodes be off the constraints, over the sizes of the coordinates.
const HELD: f64 = 1e-6;
/// Half of a much shorter stretch, over half of all, in which that tells whether branches cross: in 71
/// digits, ...
const CLOSE: f64 = 1e-6;
/// ... with so many nodes, ...
const CLOSE_NODES: usize = 4;
/// ... which hold the constraints so well if they do. Branches that are h (of a length or an angle of order
/// one) apart keep a node off by h over its own distance.
const SHARP: f64 = 1e-26;
/// Two passages agree where they differ by no more than this, in tolerances, ...
const AGREE: f64 = 0.01;
/// ... or in roundings of the largest coordinate, which what the constraints leave at the nodes amplifies.
const NOISE: f64 = 1e4;
/// An event function of order one counts as beyond its zero from here on, in roundings.
const BEYOND: f64 = 1e3;

/// A stretch of time about a singular position, and the motion in it.
#[derive(Debug, Clone)]
pub(super) struct Passage<S> {
    /// State where it begins.
    pub from: Snapshot<S>,
    /// State where it ends.
    pub to: Snapshot<S>,
    /// Whose constraints depend on the others.
    pub owner: Owner,
    /// When they do, between −1 and 1.
    middle: S,
    /// Half its length (s).
    half: S,
    count: usize,
    accelerations: Series<S>,
    inner_rates: Series<S>,
    powers: Series<S>,
    multipliers: Series<S>,
    /// Whether multipliers have no bound.
    pub has_pole: bool,
}

/// What the equations give at a node.
struct Solved<S> {
    accelerations: Vec<S>,
    inner_rates: Vec<S>,
    powers: Vec<S>,
    multipliers: Vec<S>,
}

impl<S: Scalar> Passage<S> {
    /// The way from a state through a singular position that lies about half a span (s) ahead; `None`
    /// where it is not clear. Nodes amplify what rounding makes, the more the shorter the way is:
    /// `shortness` tells by how much it is shorter than it might be. The system stands evaluated anywhere.
    pub fn find(
        system: &mut Mechanism<S>,
        from: &Snapshot<S>,
        span: S,
        tolerance: f64,
        shortness: f64,
    ) -> Option<Self> {
        let mut from = from.clone();
        system.project(from.time, &mut from.q, &mut from.v).ok()?;
        let from = &from;
        let mut found = Self::over(system, from, span, FEWEST, HELD)?;
        for _ in 0..CENTRINGS {
            if found.middle.abs().to_f64() <= CENTRED {
                break;
            }
            let ahead = found.half * (S::one() + found.middle);
            found = Self::over(system, from, ahead + ahead, FEWEST, HELD)?;
        }
        let sizes = from.q.iter().zip(system.scales().0).map(|(q, size)| q.abs().to_f64() / size);
        let rounding = S::EPSILON * sizes.fold(1.0, f64::max);
        let allowed = (AGREE * tolerance).max(NOISE * rounding * shortness.max(1.0));
        let span = found.half + found.half;
        let mut last = f64::INFINITY;
        loop {
            // as few more as tell: the nearer the nodes, the more is noise
            let more = found.count + 2 * (found.count / 8).max(1);
            let finer = Self::over(system, from, span, more, HELD)?;
            let off = found.off(&finer, system);
            if off <= allowed {
                return finer.is_quiet(system).then_some(finer);
            }
            if !(off < 0.5 * last) || finer.count > MOST {
                return None;
            }
            (found, last) = (finer, off);
        }
    }

    /// Whether the branches cross, and do not pass each other by a hair that this arithmetic cannot see:
    /// motion would then go over from one to the other. `exact` is the same mechanism in 71 digits, at
    /// any start: that two branches cross is a matter of lengths alone.
    pub fn is_sharp(&self, exact: &mut Mechanism<F256>) -> bool {
        let close = S::from_f64(CLOSE);
        let x = self.middle - close;
        let mut beside = self.from.clone();
        self.place(x, &Place::new(self.count, x), &mut beside);
        let list = |from: &[S]| from.iter().map(|x| x.octuple()).collect::<Vec<_>>();
        let mut from = exact.start().clone();
        from.time = beside.time.octuple();
        (from.q, from.v) = (list(&beside.q), list(&beside.v));
        let span = (close * (self.half + self.half)).octuple();
        exact.project(from.time, &mut from.q, &mut from.v).is_ok()
            && Passage::over(exact, &from, span, CLOSE_NODES, SHARP).is_some()
    }

    /// When the mechanism is singular (s).
    pub fn time(&self) -> S {
        self.from.time + self.half * (S::one() + self.middle)
    }

    /// The same with so many nodes, which hold the constraints by themselves as well as that.
    fn over(
        system: &mut Mechanism<S>,
        from: &Snapshot<S>,
        span: S,
        count: usize,
        held: f64,
    ) -> Option<Self> {
        let half = span * S::ratio(1, 2);
        let nodes = Nodes::new(count);
        let places: Vec<Place<S>> = nodes.at.iter().map(|x| Place::new(count, *x)).collect();
        system.evaluate(from.state()).ok()?;
        let mut passage = Passage {
            from: from.clone(),
            to: from.clone(),
            owner: Owner::default(),
            middle: S::zero(),
            half,
            count,
            accelerations: Series::through(&nodes, &vec![system.accelerations().to_vec(); count]),
            inner_rates: Series::through(&nodes, &vec![system.inner_rates().to_vec(); count]),
            powers: Series::through(&nodes, &vec![system.powers().to_vec(); count]),
            multipliers: Series::through(&nodes, &vec![system.lambda().to_vec(); count]),
            has_pole: false,
        };
        let (mut last, mut rounds) = (f64::INFINITY, 0);
        let mut before = vec![system.accelerations().to_vec(); count];
        let (states, solved) = loop {
            rounds += 1;
            let mut states = Vec::with_capacity(count);
            let mut solved = Vec::with_capacity(count);
            for (x, place) in nodes.at.iter().zip(&places) {
                let mut state = from.clone();
                passage.place(*x, place, &mut state);
                let expected = state.clone();
                system.project(state.time, &mut state.q, &mut state.v).ok()?;
                system.evaluate(state.state()).ok()?;
                solved.push(Solved {
                    accelerations: system.accelerations().to_vec(),
                    inner_rates: system.inner_rates().to_vec(),
                    powers: system.powers().to_vec(),
                    multipliers: system.lambda().to_vec(),
                });
                states.push((expected, state));
            }
            let now: Vec<Vec<S>> = solved.iter().map(|at| at.accelerations.clone()).collect();
            passage.accelerations = Series::through(&nodes, &now);
            passage.inner_rates = series(&nodes, &solved, |at| &at.inner_rates);
            let change = changed(&before, &now, half.to_f64(), system.scales().1);
            before = now;
            let settled = !(change < last) || change <= 4.0 * S::EPSILON;
            if settled && !S::CARRIES_DERIVATIVE {
                break (states, solved);
            }
            if settled && last >= 0.0 {
                // derivatives come as fast as values did, and after them
                rounds = ROUNDS.saturating_sub(rounds);
                last = f64::NEG_INFINITY;
                continue;
            }
            if rounds >= ROUNDS {
                match last < 0.0 {
                    true => break (states, solved),
                    false => return None,
                }
            }
            if last >= 0.0 {
                last = change;
            }
        };
        let sizes = system.scales().0;
        let off = states.iter().map(|(expected, state)| distance(&expected.q, &state.q, sizes));
        if !(off.fold(0.0, f64::max) <= held) {
            return None;
        }
        passage.powers = series(&nodes, &solved, |at| &at.powers);
        passage.find_middle(system, &nodes, &states)?;
        passage.find_multipliers(&nodes, &solved);
        let mut to = from.clone();
        passage.place(S::one(), &Place::new(count, S::one()), &mut to);
        system.project(to.time, &mut to.q, &mut to.v).ok()?;
        passage.to = to;
        Some(passage)
    }

    /// Whether no event passes at the nodes, nor at the end.
    fn is_quiet(&self, system: &mut Mechanism<S>) -> bool {
        let mut at = self.from.clone();
        let nodes = Nodes::new(self.count).at;
        nodes.into_iter().all(|x| {
            self.place(x, &Place::new(self.count, x), &mut at);
            nothing_happens(system, &at)
        }) && nothing_happens(system, &self.to)
    }

    /// Finds where the constraints depend on each other, from their shares at the nodes; `None` where those
    /// are not like a straight line through zero.
    fn find_middle(
        &mut self,
        system: &mut Mechanism<S>,
        nodes: &Nodes<S>,
        states: &[(Snapshot<S>, Snapshot<S>)],
    ) -> Option<()> {
        let mut roots = Vec::with_capacity(states.len());
        for (_, state) in states {
            let (owner, left) = system.weakest_joint(state.state())?;
            roots.push((owner, left.max(0.0).sqrt()));
        }
        let x: Vec<f64> = nodes.at.iter().map(|x| x.to_f64()).collect();
        let count = roots.len();
        // where the line through both neighbours of the smallest is
        let least = (1..count - 1).min_by(|a, b| roots[*a].1.total_cmp(&roots[*b].1))?;
        let [before, after] = [least - 1, least + 1].map(|k| (x[k], roots[k].1));
        let share = (x[least] - before.0) / (after.0 - before.0);
        let first_after = if share * (before.1 + after.1) > before.1 { least } else { least + 1 };
        let signed: Vec<f64> = (roots.iter().enumerate())
            .map(|(k, (_, root))| if k < first_after { -root } else { *root })
            .collect();
        let mean = (signed[count - 1] - signed[0]) / (x[count - 1] - x[0]);
        let straight = (1..count).all(|k| {
            let slope = (signed[k] - signed[k - 1]) / (x[k] - x[k - 1]);
            slope * STRAIGHT > mean && slope < STRAIGHT * mean
        });
        if !(mean > 0.0 && straight) {
            return None;
        }
        self.owner = roots[least].0;
        let [low, high] = [first_after - 1, first_after].map(|k| (x[k], signed[k]));
        let about = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
        self.middle = S::from_f64(self.zero_near(system, about)?);
        Some(())
    }

    /// Where the root of the share comes to zero, near a place.
    fn zero_near(&self, system: &mut Mechanism<S>, about: f64) -> Option<f64> {
        let nodes = Nodes::<f64>::new(FEWEST);
        let mut at = self.from.clone();
        let mut signed = Vec::with_capacity(FEWEST);
        for x in &nodes.at {
            let place = S::from_f64(about + LOOK * x);
            self.place(place, &Place::new(self.count, place), &mut at);
            let (_, left) = system.weakest_joint(at.state())?;
            signed.push(vec![left.max(0.0).sqrt().copysign(*x)]);
        }
        let line = Series::through(&nodes, &signed);
        let value = |x: f64| line.value(&Place::new(FEWEST, x))[0];
        let mut x = 0.0;
        for _ in 0..ZERO_LOOKS {
            x -= value(x) * LOOK / (value(x + LOOK) - value(x));
        }
        let inside = nodes.at[FEWEST / 2];
        (x.abs() < inside).then_some(about + LOOK * x)
    }

    /// Takes the multipliers at the nodes, times the distance from their pole if they have one.
    fn find_multipliers(&mut self, nodes: &Nodes<S>, solved: &[Solved<S>]) {
        let middle = self.middle;
        let times: Vec<Vec<S>> = (nodes.at.iter().zip(solved))
            .map(|(x, at)| at.multipliers.iter().map(|lambda| *lambda * (*x - middle)).collect())
            .collect();
        let with_pole = Series::through(nodes, &times);
        let largest = |list: &[S]| list.iter().fold(0.0, |most: f64, x| most.max(x.abs().to_f64()));
        let residue = largest(&with_pole.value(&Place::new(self.count, middle)));
        let whole = times.iter().map(|at| largest(at)).fold(0.0, f64::max);
        self.has_pole = residue > NO_POLE * whole;
        self.multipliers = match self.has_pole {
            true => with_pole,
            false => series(nodes, solved, |at| &at.multipliers),
        };
    }

    /// Puts the state at −1 ≤ x ≤ 1, integrals included, into a snapshot.
    fn place(&self, x: S, place: &Place<S>, at: &mut Snapshot<S>) {
        let (from, half) = (&self.from, self.half);
        let since = half * (x + S::one());
        let end = x == S::one();
        at.time = from.time + if end { half + half } else { since };
        let (gained, gone) =
            (self.accelerations.integral(place), self.accelerations.double_integral(place));
        for k in 0..from.q.len() {
            at.q[k] = from.q[k] + (since * from.v[k] + half * half * gone[k]);
            at.v[k] = from.v[k] + half * gained[k];
        }
        for (list, before, rates) in [
            (&mut at.z, &from.z, &self.inner_rates),
            (&mut at.integrals, &from.integrals, &self.powers),
        ] {
            let gained = rates.integral(place);
            for (k, gained) in gained.into_iter().enumerate() {
                list[k] = before[k] + half * gained;
            }
        }
    }

    /// Puts the state at a time (s) within it into a snapshot.
    pub fn at(&self, time: S, at: &mut Snapshot<S>) {
        let x = self.part(time);
        self.place(x, &Place::new(self.count, x), at);
        at.time = time;
    }

    /// Has the system stand at a time (s) within it; the state is put into a snapshot.
    pub fn show(&self, system: &mut Mechanism<S>, time: S, at: &mut Snapshot<S>) {
        let x = self.part(time);
        let off = x - self.middle;
        let beside = S::from_f64(BESIDE);
        let place = Place::new(self.count, x);
        let put = |at: &mut Snapshot<S>| {
            self.place(x, &place, at);
            at.time = time;
        };
        put(at);
        if off.abs().to_f64() > CLEAR {
            let projected = system.project(time, &mut at.q, &mut at.v);
            if projected.is_ok() && system.evaluate(at.state()).is_ok() {
                return;
            }
            put(at);
        }
        let accelerations = self.accelerations.value(&place);
        if self.has_pole && off.abs() < beside {
            let near = self.middle + beside;
            let place = Place::new(self.count, near);
            self.place(near, &place, at);
            system.stand_with(
                at.state(),
                &self.accelerations.value(&place),
                &self.held(&place, beside),
            );
            put(at);
            system.stand_on(at.state(), &accelerations);
            return;
        }
        system.stand_with(at.state(), &accelerations, &self.held(&place, off));
    }

    /// Multipliers at a place, so far from the middle.
    fn held(&self, place: &Place<S>, off: S) -> Vec<S> {
        let mut multipliers = self.multipliers.value(place);
        if self.has_pole {
            multipliers.iter_mut().for_each(|lambda| *lambda = *lambda / off);
        }
        multipliers
    }

    fn part(&self, time: S) -> S {
        (time - self.from.time) / self.half - S::one()
    }

    /// By how much a finer one ends elsewhere, over the sizes of what is there.
    fn off(&self, finer: &Self, system: &Mechanism<S>) -> f64 {
        let (sizes, speeds) = system.scales();
        let (a, b) = (&self.to, &finer.to);
        let moved = distance(&a.q, &b.q, sizes).max(distance(&a.v, &b.v, speeds));
        moved.max(distance(&a.z, &b.z, system.inner_scales()))
    }
}

fn series<S: Scalar>(
    nodes: &Nodes<S>,
    solved: &[Solved<S>],
    of: impl Fn(&Solved<S>) -> &Vec<S>,
) -> Series<S> {
    let values: Vec<Vec<S>> = solved.iter().map(|at| of(at).clone()).collect();
    Series::through(nodes, &values)
}

/// The largest difference, over the size of each.
fn distance<S: Scalar>(a: &[S], b: &[S], sizes: &[f64]) -> f64 {
    let all = a.iter().zip(b).zip(sizes);
    all.map(|((a, b), size)| (*a - *b).abs().to_f64() / size)
        .fold(0.0, |most, off| if off > most || off.is_nan() { off } else { most })
}

/// By how much velocities change for accelerations that do, over their sizes.
fn changed<S: Scalar>(before: &[Vec<S>], now: &[Vec<S>], half: f64, speeds: &[f64]) -> f64 {
    let all = before.iter().zip(now);
    all.map(|(before, now)| half * distance(before, now, speeds)).fold(0.0, f64::max)
}

/// Whether no event has passed at a state.
fn nothing_happens<S: Scalar>(system: &mut Mechanism<S>, state: &Snapshot<S>) -> bool {
    let mut values = vec![S::zero(); system.watches().len()];
    if system.event_values(state.state(), &mut values).is_err() {
        return false;
    }
    let beyond = BEYOND * S::EPSILON;
    values.iter().zip(system.watches()).all(|(value, watch)| match watch.direction {
        Direction::Off => true,
        Direction::Rising => value.to_f64() < beyond,
        Direction::Falling => -value.to_f64() < beyond,
    })
}
