//! Quantities whose extremes are told: forces of joints, torques of drives, angular
//! accelerations of bodies.

use crate::mechanism::Observation;
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
}

impl Quantity {
    /// All that a mechanism has, joints first.
    pub fn all(names: &Names) -> Vec<Quantity> {
        let joints = (0..names.joints.len()).map(Quantity::JointForce);
        let drives = (0..names.drives.len()).map(Quantity::DriveTorque);
        let bodies = (0..names.bodies.len()).map(Quantity::AngularAcceleration);
        joints.chain(drives).chain(bodies).collect()
    }

    /// Name as that of a column: `joint_force.A`, `drive_torque.crank`.
    pub fn name(self, names: &Names) -> String {
        match self {
            Quantity::JointForce(joint) => column_name("joint_force", Some(&names.joints[joint])),
            Quantity::DriveTorque(drive) => column_name("drive_torque", Some(&names.drives[drive])),
            Quantity::AngularAcceleration(body) => {
                column_name("angular_acceleration", Some(&names.bodies[body]))
            }
        }
    }

    /// Its unit, as in result files.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::JointForce(_) => "N",
            Quantity::DriveTorque(_) => "N m",
            Quantity::AngularAcceleration(_) => "rad/s^2",
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
        }
    }
}
