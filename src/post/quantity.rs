//! Quantities whose extremes are told: forces of joints, torques of drives, accelerations of
//! bodies.

use crate::mechanism::{Measure, Observation};
use crate::model::Names;
use crate::record::column_name;

/// A quantity of a run, by the index of what it belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Magnitude of a joint's force (N).
    JointForce(usize),
    /// Torque of a drive (N m).
    DriveTorque(usize),
    /// Angular acceleration of a body (rad/s²).
    AngularAcceleration(usize),
    /// x of the acceleration of a body's mass centre (m/s²).
    AccelerationX(usize),
    /// y of it (m/s²).
    AccelerationY(usize),
    /// Normal force of a joint with clearance (N), by the index of the clearance.
    NormalForce(usize),
    /// Tangential force on the journal of a joint with clearance (N), likewise.
    TangentialForce(usize),
}

impl Quantity {
    /// All that a mechanism has, joints first.
    pub fn all(names: &Names) -> Vec<Quantity> {
        let joints = (0..names.joints.len()).map(Quantity::JointForce);
        let drives = (0..names.drives.len()).map(Quantity::DriveTorque);
        let of_bodies = |of: fn(usize) -> Quantity| (0..names.bodies.len()).map(of);
        let of_contacts = |of: fn(usize) -> Quantity| (0..names.clearances.len()).map(of);
        (joints.chain(drives))
            .chain(of_bodies(Quantity::AngularAcceleration))
            .chain(of_bodies(Quantity::AccelerationX))
            .chain(of_bodies(Quantity::AccelerationY))
            .chain(of_contacts(Quantity::NormalForce))
            .chain(of_contacts(Quantity::TangentialForce))
            .collect()
    }

    /// What a run measures of it, and of which body, joint, clearance or drive.
    pub fn measure(self) -> (Measure, usize) {
        match self {
            Quantity::JointForce(joint) => (Measure::JointForce, joint),
            Quantity::DriveTorque(drive) => (Measure::DriveTorque, drive),
            Quantity::AngularAcceleration(body) => (Measure::AngularAcceleration, body),
            Quantity::AccelerationX(body) => (Measure::AccelerationX, body),
            Quantity::AccelerationY(body) => (Measure::AccelerationY, body),
            Quantity::NormalForce(clearance) => (Measure::NormalForce, clearance),
            Quantity::TangentialForce(clearance) => (Measure::TangentialForce, clearance),
        }
    }

    /// The dataset of result files that has it, or its components where it is a magnitude.
    pub fn dataset(self) -> &'static str {
        match self {
            Quantity::JointForce(_) => "joint_force",
            Quantity::DriveTorque(_) => "drive_torque",
            Quantity::AngularAcceleration(_) => "angular_acceleration",
            Quantity::AccelerationX(_) => "acceleration_x",
            Quantity::AccelerationY(_) => "acceleration_y",
            Quantity::NormalForce(_) => "normal_force",
            Quantity::TangentialForce(_) => "tangential_force",
        }
    }

    /// Name as that of a column: `joint_force.A`, `drive_torque.crank`.
    pub fn name(self, names: &Names) -> String {
        let items = match self {
            Quantity::JointForce(_) => &names.joints,
            Quantity::DriveTorque(_) => &names.drives,
            Quantity::NormalForce(_) | Quantity::TangentialForce(_) => &names.clearances,
            _ => &names.bodies,
        };
        column_name(self.dataset(), Some(&items[self.measure().1]))
    }

    /// Its unit, as in result files.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::JointForce(_) | Quantity::NormalForce(_) | Quantity::TangentialForce(_) => {
                "N"
            }
            Quantity::DriveTorque(_) => "N m",
            Quantity::AngularAcceleration(_) => "rad/s^2",
            Quantity::AccelerationX(_) | Quantity::AccelerationY(_) => "m/s^2",
        }
    }

    /// Whether it can be negative, so that its smallest value means something.
    pub fn is_signed(self) -> bool {
        !matches!(self, Quantity::JointForce(_))
    }

    /// Its value in an observation.
    pub fn of(self, observation: &Observation) -> f64 {
        match self {
            Quantity::JointForce(joint) => {
                let [x, y] = observation.joints[joint].force;
                x.hypot(y)
            }
            Quantity::DriveTorque(drive) => observation.drive_torques[drive],
            Quantity::AngularAcceleration(body) => observation.bodies[body].angular_acceleration,
            Quantity::AccelerationX(body) => observation.bodies[body].acceleration[0],
            Quantity::AccelerationY(body) => observation.bodies[body].acceleration[1],
            Quantity::NormalForce(clearance) => observation.clearances[clearance].normal_force,
            Quantity::TangentialForce(clearance) => {
                observation.clearances[clearance].tangential_force
            }
        }
    }
}
