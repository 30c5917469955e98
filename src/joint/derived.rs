//! What follows from Φ, by dual numbers: Φ_q, Φ̇, Φ̈ and their slopes.
//!
//! Along a path q(t) with velocity v and acceleration a, in numbers with ε² = η² = 0,
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
        let path = self.bodies().map(|b| on_path(&poses[b], &motions[b], &accelerations[b]));
        let says: [Dual<Dual<S>>; MOST_ROWS] = self.says(&path);
        let says = says.into_iter().take(self.rows());
        error.iter_mut().zip(says).for_each(|(error, says)| *error = says.eps.eps - prescribed);
    }

    /// Φ_q, row by row.
    pub fn slopes(&self, poses: &[Pose<S>], slopes: &mut [Blocks<S>]) {
        let here = self.poses(poses);
        slopes.iter_mut().for_each(|row| *row = [[S::zero(); 3]; MOST_BODIES]);
        for (side, c) in self.places() {
            let says: [Dual<S>; MOST_ROWS] = self.says(&seeded(&here, (side, c)));
            for (row, says) in slopes.iter_mut().zip(says) {
                row[side][c] = says.eps;
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
            let side = |side: usize| on_path(&poses[side], &motions[side], &accelerations[side]);
            let says: [Dual<Dual<Dual<S>>>; MOST_ROWS] = self.says(&[side(0), side(1), side(2)]);
            entries(place, says.map(|says| [says.eps.eps.eps, says.eps.re.eps + says.eps.re.eps]));
        }
    }
}

/// A pose that stays.
fn lifted<T: Scalar>(pose: &Pose<T>) -> Pose<Dual<T>> {
    let constant = Dual::from_re;
    Pose {
        position: Vector::new(constant(pose.position.x), constant(pose.position.y)),
        angle: constant(pose.angle),
        cos: constant(pose.cos),
        sin: constant(pose.sin),
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
