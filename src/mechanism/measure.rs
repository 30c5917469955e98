//! Forces, torques and accelerations at the state last evaluated, in one list of doubles that is
//! quick to make: a run looks at it at every step, for their extremes.

use super::Mechanism;
use super::layout::{Layout, Role, Row};
use crate::clearance::{Clearance, Gap};
use crate::course::Course;
use crate::model::{Joint, Model, Owner};
use crate::plane::Vector;
use crate::scalar::Scalar;
use std::ops::Range;

/// A quantity whose extremes a run keeps: one for each body, joint, clearance or drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// x of the acceleration of a body's mass centre (m/s²), fixed frame.
    AccelerationX,
    /// y of it (m/s²).
    AccelerationY,
    /// Angular acceleration of a body (rad/s²).
    AngularAcceleration,
    /// Normal force of a joint with clearance (N).
    NormalForce,
    /// Tangential force on the journal of a joint with clearance (N).
    TangentialForce,
    /// Torque of a drive (N m).
    DriveTorque,
    /// Magnitude of a joint's force (N), friction and all.
    JointForce,
}

/// Where each measure stands in the list: accelerations by body, forces by clearance, torques by
/// drive, and last, as they have no sign, the magnitudes by joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Measures {
    /// Number of bodies, without the ground.
    pub bodies: usize,
    /// Number of joints with clearance.
    pub clearances: usize,
    /// Number of drives.
    pub drives: usize,
    /// Number of joints.
    pub joints: usize,
}

impl Measures {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.signed() + self.joints
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many have a sign: these come first.
    pub fn signed(&self) -> usize {
        3 * self.bodies + 2 * self.clearances + self.drives
    }

    /// Places of a measure in the list, in the order of its bodies, joints, clearances or drives.
    pub fn places(&self, measure: Measure) -> impl Iterator<Item = usize> + use<> {
        let touching = 3 * self.bodies;
        let driving = touching + 2 * self.clearances;
        let (first, stride, count) = match measure {
            Measure::AccelerationX => (0, 3, self.bodies),
            Measure::AccelerationY => (1, 3, self.bodies),
            Measure::AngularAcceleration => (2, 3, self.bodies),
            Measure::NormalForce => (touching, 2, self.clearances),
            Measure::TangentialForce => (touching + 1, 2, self.clearances),
            Measure::DriveTorque => (driving, 1, self.drives),
            Measure::JointForce => (self.signed(), 1, self.joints),
        };
        (0..count).map(move |item| first + stride * item)
    }
}

/// Where the force of a joint stands in what was evaluated.
#[derive(Debug, Clone)]
pub(super) enum ForceSource {
    /// A contact, or more of them.
    Clearances(Range<usize>),
    /// The joint of a driven body.
    Driven(usize),
    /// The constraint with this index.
    Constraint(usize),
}

/// Where the force of each joint stands.
pub(super) fn force_sources<S: Scalar>(model: &Model<S>, layout: &Layout<S>) -> Vec<ForceSource> {
    let source = |(index, joint): (usize, &Joint<S>)| {
        if joint.is_loose() {
            return Some(ForceSource::Clearances(joint.clearances.clone()));
        }
        if let Some(place) = layout.driven.iter().position(|driven| driven.joint == index) {
            return Some(ForceSource::Driven(place));
        }
        let its = |row: &Row<S>| row.owner == Owner::Joint(index);
        layout.constraints.iter().position(its).map(ForceSource::Constraint)
    };
    model.joints().iter().enumerate().filter_map(source).collect()
}

/// What a unit force along the line of centres gives the surfaces of each clearance in acceleration
/// apart, at most, and one across it, at the surfaces (1/kg).
pub(super) fn mobilities<S: Scalar>(model: &Model<S>, layout: &Layout<S>) -> Vec<Option<[f64; 2]>> {
    let of = |law: &Clearance<S>| {
        let arms = [law.pair.s_i, law.pair.s_j];
        law.wall.is_none().then(|| mobility(model, layout, law, arms))
    };
    model.clearances().iter().map(of).collect()
}

/// The same of one clearance, by the arms of its bodies.
fn mobility<S: Scalar>(
    model: &Model<S>,
    layout: &Layout<S>,
    clearance: &Clearance<S>,
    [arm_i, arm_j]: [Vector<S>; 2],
) -> [f64; 2] {
    let of = |body: usize, arm: Vector<S>, radius: S| match layout.roles[body] {
        Role::Free(_) => {
            let (mass, inertia) = (model.masses()[body].to_f64(), model.inertias()[body].to_f64());
            let far = (arm.norm() + radius).to_f64();
            [1.0 / mass + arm.dot(arm).to_f64() / inertia, 1.0 / mass + far * far / inertia]
        }
        Role::Ground | Role::Driven => [0.0; 2],
    };
    let [along_i, across_i] = of(clearance.pair.i, arm_i, clearance.bearing_radius);
    let [along_j, across_j] = of(clearance.pair.j, arm_j, clearance.journal_radius);
    [along_i + along_j, across_i + across_j]
}

/// Square of the fastest pace (rad²/s²) that loads and courses of time give the bodies.
pub(super) fn given_pace<S: Scalar>(model: &Model<S>, layout: &Layout<S>) -> f64 {
    let paces = model.loads().iter().flat_map(|load| {
        let bodies = load.bodies().into_iter().flatten();
        let free = bodies.filter(|body| matches!(layout.roles[*body], Role::Free(_)));
        let swings = free.map(|body| {
            let [mass, inertia] = [model.masses(), model.inertias()].map(|of| of[body].to_f64());
            load.pace(mass, (inertia / mass).sqrt())
        });
        swings.chain(load.course().and_then(Course::pace))
    });
    let drives = model.drives().iter().filter_map(|drive| drive.course.pace());
    paces.chain(drives).fold(0.0, f64::max).powi(2)
}

impl<S: Scalar> Mechanism<S> {
    /// What [`Mechanism::measure`] tells.
    pub fn measures(&self) -> Measures {
        Measures {
            bodies: self.layout.roles.len() - 1,
            clearances: self.modes.len(),
            drives: self.model.drives().len(),
            joints: self.force_sources.len(),
        }
    }

    /// Forces, torques and accelerations at the state last evaluated, in the order of
    /// [`Mechanism::measures`]; the list may be longer.
    #[inline]
    pub fn measure(&self, values: &mut [f64]) {
        let now = &self.now;
        let (accelerations, rest) = values.split_at_mut(3 * (now.accelerations.len() - 1));
        for (values, a) in accelerations.chunks_exact_mut(3).zip(&now.accelerations[1..]) {
            let a = [a.linear.x, a.linear.y, a.angular];
            values.copy_from_slice(&a.map(S::to_f64));
        }
        let (forces, rest) = rest.split_at_mut(2 * now.touches.len());
        for (values, touch) in forces.chunks_exact_mut(2).zip(&now.touches) {
            let pair = touch.as_ref().map_or([0.0; 2], |touch| {
                [touch.force.normal.value.to_f64(), touch.force.tangential.to_f64()]
            });
            values.copy_from_slice(&pair);
        }
        let (torques, magnitudes) = rest.split_at_mut(self.model.drives().len());
        for (drive, value) in torques.iter_mut().enumerate() {
            *value = self.drive_torque(drive).to_f64();
        }
        for (source, value) in self.force_sources.iter().zip(magnitudes) {
            let [x, y] = match source {
                ForceSource::Clearances(own) => {
                    now.touches[own.clone()].iter().flatten().fold([0.0; 2], |[x, y], touch| {
                        let force = touch.force.on_journal;
                        [x + force.x.to_f64(), y + force.y.to_f64()]
                    })
                }
                &ForceSource::Driven(place) => {
                    let force = now.driving[place].0;
                    [force.x.to_f64(), force.y.to_f64()]
                }
                &ForceSource::Constraint(index) => {
                    let (row, arms) = (&self.layout.constraints[index], &now.arms[index]);
                    let (slopes, lambda) = (&now.jacobian[row.range()], &now.lambda[row.range()]);
                    let force = row.constraint.on_second(arms, slopes, lambda).force;
                    [force.x.to_f64(), force.y.to_f64()]
                }
            };
            *value = (x * x + y * y).sqrt();
        }
    }

    /// What [`mobilities`] tells of a point before a wall, which moves along the first body.
    pub(super) fn mobility_before_wall(&self, law: &Clearance<S>, gap: &Gap<S>) -> [f64; 2] {
        mobility(&self.model, &self.layout, law, [gap.arm_i, gap.arm_j])
    }

    /// Square of the fastest pace (rad²/s²) of the motion at the state last evaluated: that of
    /// contacts that swing on their stiffness, or on that of bristles, or of turning bodies against
    /// each other.
    #[inline]
    pub fn pace_squared(&self) -> f64 {
        let touches = self.now.touches.iter().zip(&self.mobilities).enumerate();
        let swing = touches.fold(0.0, |sum, (k, (touch, mobility))| match touch {
            Some(touch) => {
                let [along, across] = match mobility {
                    Some(mobility) => *mobility,
                    None => self.mobility_before_wall(&self.model.clearances()[k], &touch.gap),
                };
                let bristles = touch.force.tangential_slopes()[0].to_f64().abs();
                sum + along * touch.force.normal.swing.to_f64().abs() + across * bristles
            }
            None => sum,
        });
        let fastest = self.now.motions.iter().fold(0.0, |fastest, motion| {
            let rate = motion.angular.to_f64();
            let square = rate * rate;
            if square > fastest { square } else { fastest }
        });
        swing + 4.0 * (fastest + self.given_pace)
    }
}
