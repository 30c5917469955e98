//! The rows that joints and drives have among the equations, at three levels: position error Φ,
//! Jacobian Φ_q, acceleration error Φ̈.

use super::{AngleDrive, Blocks, Derived, Ends, GROUND, MOST_BODIES, Relation, Revolute};
use crate::plane::{Motion, Pose, Vector, Wrench};
use crate::scalar::Scalar;

/// A constraint; its rows stand in the order of its position error.
#[derive(Debug, Clone)]
pub enum Constraint<S> {
    /// Two points stay together; written by hand.
    Revolute(Revolute<S>),
    /// A relative angle is a function of time.
    Drive(AngleDrive<S>),
    /// What says nothing but Φ.
    Derived(Derived<S>),
}

/// From the mass centres of first and second body to the points (m), fixed frame.
pub type Arms<S> = [Vector<S>; 2];

impl<S: Scalar> Constraint<S> {
    /// The rows of a joint where it sits.
    pub fn joint(relation: Relation<S>, ends: &Ends<S>) -> Self {
        if let Relation::Revolute(joint) = relation {
            return Constraint::Revolute(joint);
        }
        Constraint::Derived(Derived::joint(relation, ends))
    }

    /// Number of rows.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        match self {
            Constraint::Revolute(_) => 2,
            Constraint::Drive(_) => 1,
            Constraint::Derived(joint) => joint.rows(),
        }
    }

    /// Whether a row is an angle (rad) and no length (m).
    pub fn is_angle(&self, row: usize) -> bool {
        match self {
            Constraint::Revolute(_) => false,
            Constraint::Drive(_) => true,
            Constraint::Derived(joint) => joint.is_angle(row),
        }
    }

    /// Its bodies: first, second, third; the ground where there is none.
    pub fn bodies(&self) -> [usize; MOST_BODIES] {
        match self {
            Constraint::Revolute(joint) => [joint.pair.i, joint.pair.j, GROUND],
            Constraint::Drive(drive) => [drive.i, drive.j, GROUND],
            Constraint::Derived(joint) => joint.bodies(),
        }
    }

    /// The arms, zero where nothing wants them, which the functions below take.
    #[inline(always)]
    pub fn arms(&self, poses: &[Pose<S>]) -> Arms<S> {
        match self {
            Constraint::Revolute(joint) => joint.arms(poses),
            Constraint::Drive(_) => [Vector::zero(); 2],
            Constraint::Derived(joint) => joint.arms(poses),
        }
    }

    /// Φ_q of each row. The functions below that take it look at it only where it follows from Φ.
    #[inline(always)]
    pub fn slopes(&self, poses: &[Pose<S>], arms: &Arms<S>, slopes: &mut [Blocks<S>]) {
        match self {
            Constraint::Revolute(_) => {
                slopes[0] = Revolute::jacobian(0, arms);
                slopes[1] = Revolute::jacobian(1, arms);
            }
            Constraint::Drive(drive) => {
                let [i, j] = drive.jacobian();
                slopes[0] = [i, j, [S::zero(); 3]];
            }
            Constraint::Derived(joint) => joint.slopes(poses, slopes),
        }
    }

    /// Φ (m, rad) of each row.
    pub fn position_error(&self, time: S, poses: &[Pose<S>], error: &mut [S]) {
        match self {
            Constraint::Revolute(joint) => {
                let gap = joint.position_error(poses);
                (error[0], error[1]) = (gap.x, gap.y);
            }
            Constraint::Drive(drive) => error[0] = drive.position_error(time, poses),
            Constraint::Derived(joint) => joint.position_error(time, poses, error),
        }
    }

    /// Φ̇ (m/s, rad/s) of each row.
    pub fn velocity_error(
        &self,
        time: S,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        error: &mut [S],
    ) {
        match self {
            Constraint::Revolute(joint) => {
                let rate = joint.velocity_error(poses, motions);
                (error[0], error[1]) = (rate.x, rate.y);
            }
            Constraint::Drive(drive) => error[0] = drive.velocity_error(time, motions),
            Constraint::Derived(joint) => joint.velocity_error(time, poses, motions, error),
        }
    }

    /// Φ̈ (m/s², rad/s²) of each row for given accelerations; −γ where those of the moving bodies
    /// are zero.
    #[inline(always)]
    pub fn acceleration_error(
        &self,
        time: S,
        arms: &Arms<S>,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
        error: &mut [S],
    ) {
        match self {
            Constraint::Revolute(joint) => {
                let a = joint.acceleration_error(arms, motions, accelerations);
                (error[0], error[1]) = (a.x, a.y);
            }
            Constraint::Drive(drive) => error[0] = drive.acceleration_error(time, accelerations),
            Constraint::Derived(joint) => {
                joint.acceleration_error(time, poses, motions, accelerations, error);
            }
        }
    }

    /// Adds −Φ_qᵀ λ, what the multipliers put on the bodies, to the wrenches by body.
    #[inline(always)]
    pub fn act(
        &self,
        arms: &Arms<S>,
        slopes: &[Blocks<S>],
        lambda: &[S],
        wrenches: &mut [Wrench<S>],
    ) {
        let mut add = |[i, j]: [usize; 2], [on_i, on_j]: [Wrench<S>; 2]| {
            wrenches[i] += on_i;
            wrenches[j] += on_j;
        };
        match self {
            Constraint::Revolute(Revolute { pair }) => {
                let lambda = Vector::new(lambda[0], lambda[1]);
                add([pair.i, pair.j], Revolute::wrenches(arms, lambda));
            }
            Constraint::Drive(drive) => add([drive.i, drive.j], drive.wrenches(lambda[0])),
            Constraint::Derived(joint) => {
                for (side, body) in joint.bodies().into_iter().enumerate() {
                    if body != GROUND {
                        wrenches[body] += wrench_on(side, slopes, lambda);
                    }
                }
            }
        }
    }

    /// Force (N) and moment (N m) that the multipliers put on the second body, at the joint's point
    /// there.
    pub fn on_second(&self, arms: &Arms<S>, slopes: &[Blocks<S>], lambda: &[S]) -> Wrench<S> {
        match self {
            Constraint::Revolute(_) => {
                Wrench { force: -Vector::new(lambda[0], lambda[1]), moment: S::zero() }
            }
            Constraint::Drive(drive) => drive.wrenches(lambda[0])[1],
            Constraint::Derived(_) => {
                let Wrench { force, moment } = wrench_on(1, slopes, lambda);
                Wrench { force, moment: moment - arms[1].cross(force) }
            }
        }
    }

    /// ∂(Φ_qᵀ λ)/∂q: its entries, at side and coordinate of row and of column.
    pub fn bend(
        &self,
        poses: &[Pose<S>],
        lambda: &[S],
        mut entry: impl FnMut((usize, usize), (usize, usize), S),
    ) {
        match self {
            Constraint::Revolute(joint) => {
                let both = joint.d_wrenches(poses, Vector::new(lambda[0], lambda[1]));
                for (side, by_angle) in both.into_iter().enumerate() {
                    entry((side, 2), (side, 2), by_angle);
                }
            }
            Constraint::Drive(_) => {}
            Constraint::Derived(joint) => joint.bend(poses, lambda, entry),
        }
    }

    /// ∂Φ̈/∂(q, v): its entries, at row, side and coordinate, by the coordinate and by its rate.
    pub fn acceleration_slopes(
        &self,
        poses: &[Pose<S>],
        motions: &[Motion<S>],
        accelerations: &[Motion<S>],
        mut entry: impl FnMut(usize, (usize, usize), [S; 2]),
    ) {
        match self {
            Constraint::Revolute(joint) => {
                for row in 0..2 {
                    let both = joint.d_acceleration(row, poses, motions, accelerations);
                    for (side, slopes) in both.into_iter().enumerate() {
                        entry(row, (side, 2), slopes);
                    }
                }
            }
            Constraint::Drive(_) => {}
            Constraint::Derived(joint) => {
                joint.acceleration_slopes(poses, motions, accelerations, |place, slopes| {
                    for (row, slopes) in slopes.into_iter().enumerate().take(joint.rows()) {
                        // what is stored costs at each step
                        if slopes != [S::zero(); 2] {
                            entry(row, place, slopes);
                        }
                    }
                });
            }
        }
    }
}

/// −Φ_qᵀ λ on one body.
#[inline(always)]
fn wrench_on<S: Scalar>(side: usize, slopes: &[Blocks<S>], lambda: &[S]) -> Wrench<S> {
    let mut on = Wrench::none();
    for (row, lambda) in slopes.iter().zip(lambda) {
        let [x, y, angle] = row[side];
        on.force.x += -(x * *lambda);
        on.force.y += -(y * *lambda);
        on.moment += -(angle * *lambda);
    }
    on
}
