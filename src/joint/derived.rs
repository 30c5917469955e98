//! What follows from Φ, by dual numbers: Φ_q, Φ̇, Φ̈ and their slopes.
//!
//! Φ_q comes from one evaluation, in numbers with a derivative by each coordinate that can change. Along a path q(t) with velocity v and acceleration a, in numbers with ε² = η² = 0,
//! ```text
//! Φ(q + v ε + v η + a ε η) = Φ + Φ̇ ε + Φ̇ η + Φ̈ ε η
//! ```

use super::{Arms, Blocks, Ends, GROUND, MOST_BODIES, MOST_ROWS, Relation, Travel};
use crate::plane::{Motion, Pose, Vector};
use crate::scalar::{Dual, Lift, Scalar};

/// A joint by its Φ alone, or a drive of a travel; and where it sits.
#[derive(Debug, Clone)]
pub struct Derived<S> {
    ends: Ends<S>,
    says: Says<S>,
}

#[derive(Debug, Clone)]
enum Says<S> {
    Joint(Relation<S>),
    Travel(Travel<S>),
}

/// A coordinate of a joint's bodies: which body, and which of its x, y, θ.
type Place = (usize, usize);

impl<S: Scalar> Derived<S> {
    /// The rows of a joint where it sits.
    pub fn joint(relation: Relation<S>, ends: &Ends<S>) -> Self {
        Derived { ends: *ends, says: Says::Joint(relation) }
    }

    /// The row of a drive on a prismatic joint that sits there.
    pub fn travel(travel: Travel<S>, ends: &Ends<S>) -> Self {
        Derived { ends: *ends, says: Says::Travel(travel) }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        match &self.says {
            Says::Joint(joint) => joint.rows(),
            Says::Travel(_) => 1,
        }
    }

    /// Whether a row is an angle (rad).
    pub fn is_angle(&self, row: usize) -> bool {
        match &self.says {
            Says::Joint(joint) => joint.is_angle(row),
            Says::Travel(_) => false,
        }
    }

    /// The bodies: first, second, third.
    #[inline(always)]
    pub fn bodies(&self) -> [usize; MOST_BODIES] {
        [self.ends.pair.i, self.ends.pair.j, self.ends.third]
    }

    /// From the mass centres of first and second body to the points (m), fixed frame.
    pub fn arms(&self, poses: &[Pose<S>]) -> Arms<S> {
        let pair = &self.ends.pair;
        [poses[pair.i].rotate(pair.s_i), poses[pair.j].rotate(pair.s_j)]
    }

    /// What is prescribed, with two derivatives.
    fn prescribed(&self, time: S) -> [S; 3] {
        match &self.says {
            Says::Joint(_) => [S::zero(); 3],
            Says::Travel(travel) => travel.course.at(time),
        }
    }

    #[inline(always)]
    fn says<T: Lift<S>>(&self, poses: &[Pose<T>; MOST_BODIES]) -> [T; MOST_ROWS] {
        match &self.says {
            Says::Joint(joint) => joint.error(poses),
            Says::Travel(travel) => [travel.slide.travel(poses), T::zero(), T::zero()],
        }
    }

    fn poses(&self, poses: &[Pose<S>]) -> [Pose<S>; MOST_BODIES] {
        self.bodies().map(|body| poses[body])
    }

    /// The coordinates that can change.
    fn places(&self) -> impl Iterator<Item = Place> + use<S> {
        let moving = self.bodies().map(|body| body != GROUND);
        (0..MOST_BODIES)
            .filter(move |side| moving[*side])
            .flat_map(|side| (0..3).map(move |c| (side, c)))
    }

    /// Φ (m, rad).
    pub fn position_error(&self, time: S, poses: &[Pose<S>], error: &mut [S]) {
        let [prescribed, ..] = self.prescribed(time);
        let says = self.says(&self.poses(poses));
        let says = says.into_iter().take(self.rows());
        error.iter_mut().zip(says).for_each(|(error, says)| *error = says - prescribed);
    }

    /// Φ̇ (m/s, rad/s).
    pub fn velocity_error(
        &self,
        time: S,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        error: &mut [S],
    ) {
        let [_, prescribed, _] = self.prescribed(time);
        let moving = self.bodies().map(|body| moving(&poses[body], &motions[body]));
        let says: [Dual<S>; MOST_ROWS] = self.says(&moving);
        let says = says.into_iter().take(self.rows());
        error.iter_mut().zip(says).for_each(|(error, says)| *error = says.eps - prescribed);
    }

    /// Φ̈ (m/s², rad/s²).
    pub fn acceleration_error(
        &self,
        time: S,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
        error: &mut [S],
    ) {
        let [.., prescribed] = self.prescribed(time);
        let [i, j, k] = self.bodies();
        let on = |body: usize| on_path(&poses[body], &motions[body], &accelerations[body]);
        let path = [on(i), on(j), on(k)];
        let says: [Dual<Dual<S>>; MOST_ROWS] = self.says(&path);
        let says = says.into_iter().take(self.rows());
        error.iter_mut().zip(says).for_each(|(error, says)| *error = says.eps.eps - prescribed);
    }

    /// Φ_q, row by row.
    pub fn slopes(&self, poses: &[Pose<S>], slopes: &mut [Blocks<S>]) {
        slopes.iter_mut().for_each(|row| *row = [[S::zero(); 3]; MOST_BODIES]);
        let moving = self.bodies().into_iter().filter(|body| *body != GROUND).count();
        match moving {
            1 => self.slopes_by::<3>(poses, slopes),
            2 => self.slopes_by::<6>(poses, slopes),
            _ => self.slopes_by::<9>(poses, slopes),
        }
    }

    /// Φ_q where N coordinates can change.
    #[inline(always)]
    fn slopes_by<const N: usize>(&self, poses: &[Pose<S>], slopes: &mut [Blocks<S>]) {
        let bodies = self.bodies();
        let moves = bodies.map(|body| usize::from(body != GROUND));
        // where the coordinates of each side begin among the N; behind them all if there are none
        let first = |side: usize| match moves[side] {
            0 => N,
            _ => 3 * moves[..side].iter().sum::<usize>(),
        };
        let places = [first(0), first(1), first(2)];
        let seed = |side: usize| seed(&poses[bodies[side]], places[side]);
        // one by one, for poses are large: what builds an array from a function copies them
        let seeded: [Pose<Dual<S, [S; N]>>; MOST_BODIES] = [seed(0), seed(1), seed(2)];
        let says = self.says(&seeded);
        for (row, says) in slopes.iter_mut().zip(&says) {
            for (block, first) in row.iter_mut().zip(places) {
                if first < N {
                    block.copy_from_slice(&says.eps[first..first + 3]);
                }
            }
        }
    }

    /// ∂(Φ_qᵀ λ)/∂q, a symmetric matrix: its entries, with the places of their rows and columns.
    pub fn bend(&self, poses: &[Pose<S>], lambda: &[S], mut entry: impl FnMut(Place, Place, S)) {
        let here = self.poses(poses);
        for (k, row) in self.places().enumerate() {
            let once: [Pose<Dual<S>>; MOST_BODIES] = seeded(&here, row);
            for column in self.places().take(k + 1) {
                let says: [Dual<Dual<S>>; MOST_ROWS] = self.says(&seeded(&once, column));
                let terms = says.iter().zip(lambda).map(|(says, lambda)| says.eps.eps * *lambda);
                let bend = terms.fold(S::zero(), |sum, term| sum + term);
                if bend == S::zero() {
                    continue;
                }
                entry(row, column, bend);
                if column != row {
                    entry(column, row, bend);
                }
            }
        }
    }

    /// ∂Φ̈/∂(q, v): for each coordinate, the slopes of every row by it and by its rate, which are
    /// ```text
    /// ∂Φ̈/∂v = 2 ∂Φ̇/∂q
    /// ```
    pub fn acceleration_slopes(
        &self,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
        mut entries: impl FnMut(Place, [[S; 2]; MOST_ROWS]),
    ) {
        let here = self.poses(poses);
        let constant = |m: Motion<S>| Motion {
            linear: Vector::new(Dual::from_re(m.linear.x), Dual::from_re(m.linear.y)),
            angular: Dual::from_re(m.angular),
        };
        let motions = self.bodies().map(|body| constant(motions[body]));
        let accelerations = self.bodies().map(|body| constant(accelerations[body]));
        for place in self.places() {
            let poses = seeded(&here, place);
            let on = |side: usize| on_path(&poses[side], &motions[side], &accelerations[side]);
            let path = [on(0), on(1), on(2)];
            let says: [Dual<Dual<Dual<S>>>; MOST_ROWS] = self.says(&path);
            entries(place, says.map(|says| [says.eps.eps.eps, says.eps.re.eps + says.eps.re.eps]));
        }
    }
}

/// A pose with the derivatives by its coordinates, the first of which is number `first` of N; without any
/// where there are not so many.
#[inline(always)]
fn seed<T: Scalar, const N: usize>(from: &Pose<T>, first: usize) -> Pose<Dual<T, [T; N]>> {
    let (zero, one) = (T::zero(), T::one());
    let by = |re: T, c: usize, slope: T| {
        let part = |k: usize| if k == first + c { slope } else { zero };
        Dual::new(re, std::array::from_fn(part))
    };
    Pose {
        position: Vector::new(by(from.position.x, 0, one), by(from.position.y, 1, one)),
        angle: by(from.angle, 2, one),
        cos: by(from.cos, 2, -from.sin),
        sin: by(from.sin, 2, from.cos),
    }
}

/// A pose that stays.
fn lifted<T: Scalar>(pose: &Pose<T>) -> Pose<Dual<T>> {
    let stays = Dual::from_re;
    Pose {
        position: Vector::new(stays(pose.position.x), stays(pose.position.y)),
        angle: stays(pose.angle),
        cos: stays(pose.cos),
        sin: stays(pose.sin),
    }
}

/// Poses with the derivative by one of their coordinates.
pub(crate) fn seeded<T: Scalar, const N: usize>(
    poses: &[Pose<T>; N],
    (side, c): Place,
) -> [Pose<Dual<T>>; N] {
    let mut seeded = poses.each_ref().map(lifted);
    let (pose, from) = (&mut seeded[side], &poses[side]);
    match c {
        0 => pose.position.x.eps = T::one(),
        1 => pose.position.y.eps = T::one(),
        _ => {
            pose.angle.eps = T::one();
            (pose.cos.eps, pose.sin.eps) = (-from.sin, from.cos);
        }
    }
    seeded
}

/// A pose with its first derivative by time.
fn moving<T: Scalar>(pose: &Pose<T>, motion: &Motion<T>) -> Pose<Dual<T>> {
    let (at, v, rate) = (pose.position, motion.linear, motion.angular);
    Pose {
        position: Vector::new(Dual::new(at.x, v.x), Dual::new(at.y, v.y)),
        angle: Dual::new(pose.angle, rate),
        cos: Dual::new(pose.cos, -pose.sin * rate),
        sin: Dual::new(pose.sin, pose.cos * rate),
    }
}

/// A pose with two derivatives by time.
#[inline(always)]
fn on_path<T: Scalar>(
    pose: &Pose<T>,
    motion: &Motion<T>,
    acceleration: &Motion<T>,
) -> Pose<Dual<Dual<T>>> {
    let second = |x: T, v: T, a: T| Dual::new(Dual::new(x, v), Dual::new(v, a));
    let (at, v, a) = (pose.position, motion.linear, acceleration.linear);
    let (rate, bend) = (motion.angular, acceleration.angular);
    let (cos, sin, square) = (pose.cos, pose.sin, rate * rate);
    Pose {
        position: Vector::new(second(at.x, v.x, a.x), second(at.y, v.y, a.y)),
        angle: second(pose.angle, rate, bend),
        cos: second(cos, -sin * rate, -sin * bend - cos * square),
        sin: second(sin, cos * rate, cos * bend - sin * square),
    }
}
