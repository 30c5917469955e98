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
        let mut path = [Pose::fixed(); MOST_BODIES];
        for (body, pose) in self.bodies().into_iter().zip(&mut path) {
            if body != GROUND {
                put_on_path(&poses[body], &motions[body], &accelerations[body], pose);
            }
        }
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
        // poses are large: filled where they stand, they are never copied
        let mut seeded = [Pose::<Dual<S, [S; N]>>::fixed(); MOST_BODIES];
        let mut places = [N; MOST_BODIES];
        let mut first = 0;
        for ((body, pose), place) in self.bodies().into_iter().zip(&mut seeded).zip(&mut places) {
            if body == GROUND {
                continue;
            }
            lift_into(&poses[body], pose);
            pose.position.x.eps[first] = S::one();
            pose.position.y.eps[first + 1] = S::one();
            pose.angle.eps[first + 2] = S::one();
            pose.cos.eps[first + 2] = -poses[body].sin;
            pose.sin.eps[first + 2] = poses[body].cos;
            *place = first;
            first += 3;
        }
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
            let mut path = [Pose::fixed(); MOST_BODIES];
            for (side, pose) in path.iter_mut().enumerate() {
                put_on_path(&poses[side], &motions[side], &accelerations[side], pose);
            }
            let says: [Dual<Dual<Dual<S>>>; MOST_ROWS] = self.says(&path);
            entries(place, says.map(|says| [says.eps.eps.eps, says.eps.re.eps + says.eps.re.eps]));
        }
    }
}

/// Puts a pose into one whose derivatives are zero.
#[inline(always)]
fn lift_into<T: Scalar, E>(from: &Pose<T>, pose: &mut Pose<Dual<T, E>>) {
    pose.position.x.re = from.position.x;
    pose.position.y.re = from.position.y;
    pose.angle.re = from.angle;
    pose.cos.re = from.cos;
    pose.sin.re = from.sin;
}

/// A pose that stays.
fn lifted<T: Scalar>(pose: &Pose<T>) -> Pose<Dual<T>> {
    let mut stays = Pose::fixed();
    lift_into(pose, &mut stays);
    stays
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

/// Puts a pose with two derivatives by time into another.
#[inline(always)]
fn put_on_path<T: Scalar>(
    from: &Pose<T>,
    motion: &Motion<T>,
    acceleration: &Motion<T>,
    pose: &mut Pose<Dual<Dual<T>>>,
) {
    let put = |number: &mut Dual<Dual<T>>, x: T, v: T, a: T| {
        (number.re.re, number.re.eps) = (x, v);
        (number.eps.re, number.eps.eps) = (v, a);
    };
    let (at, v, a) = (from.position, motion.linear, acceleration.linear);
    let (rate, bend) = (motion.angular, acceleration.angular);
    let (cos, sin, square) = (from.cos, from.sin, rate * rate);
    put(&mut pose.position.x, at.x, v.x, a.x);
    put(&mut pose.position.y, at.y, v.y, a.y);
    put(&mut pose.angle, from.angle, rate, bend);
    put(&mut pose.cos, cos, -sin * rate, -sin * bend - cos * square);
    put(&mut pose.sin, sin, cos * rate, cos * bend - sin * square);
}
