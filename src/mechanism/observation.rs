//! Everything that is told of a mechanism at one time, in double precision.

/// A mechanism at one time. Lists follow the order of the case file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Observation {
    /// Time (s).
    pub time: f64,
    /// Every body, the driven ones too.
    pub bodies: Vec<BodyObservation>,
    /// Every joint with clearance.
    pub clearances: Vec<ClearanceObservation>,
    /// Every joint.
    pub joints: Vec<JointObservation>,
    /// Torque of each drive on the second body of its joint (N m).
    pub drive_torques: Vec<f64>,
    /// Every point that the case wants to be observed.
    pub points: Vec<PointObservation>,
    /// What frictions and loads remember: the inner states, each in its own unit.
    pub memories: Vec<f64>,
    /// Energies and works.
    pub energy: EnergyObservation,
    /// What x, y, angle and their rates of each body, then the offset of each clearance, are
    /// beyond their doubles (see [`Scalar::beyond`](crate::scalar::Scalar::beyond)); empty in
    /// double precision.
    pub beyond: Vec<f64>,
}

/// Position, velocity and acceleration of a body's mass centre and angle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BodyObservation {
    /// Mass centre (m).
    pub position: [f64; 2],
    /// Angle, not wrapped (rad).
    pub angle: f64,
    /// Velocity of the mass centre (m/s).
    pub velocity: [f64; 2],
    /// Angular rate (rad/s).
    pub angular_velocity: f64,
    /// Acceleration of the mass centre (m/s²).
    pub acceleration: [f64; 2],
    /// Angular acceleration (rad/s²).
    pub angular_acceleration: f64,
}

/// Position, velocity and acceleration of a point of a body, fixed frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PointObservation {
    /// Position (m).
    pub position: [f64; 2],
    /// Velocity (m/s).
    pub velocity: [f64; 2],
    /// Acceleration (m/s²).
    pub acceleration: [f64; 2],
}

/// A journal in its bearing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ClearanceObservation {
    /// Journal centre minus bearing centre, fixed frame (m).
    pub offset: [f64; 2],
    /// Distance of the centres (m).
    pub eccentricity: f64,
    /// Eccentricity minus clearance (m); negative in flight.
    pub penetration: f64,
    /// Rate of the penetration (m/s); 0 where the centres coincide.
    pub penetration_rate: f64,
    /// Slip of the journal's contact point relative to the bearing's, along t (m/s); 0 where the
    /// centres coincide.
    pub slip_velocity: f64,
    /// Normal force (N); pushes the journal along −n.
    pub normal_force: f64,
    /// Tangential force on the journal along t (N).
    pub tangential_force: f64,
    /// Whether the joint is in contact.
    pub in_contact: bool,
}

/// What a joint puts on its second body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointObservation {
    /// Force (N), fixed frame.
    pub force: [f64; 2],
    /// Moment about the joint's point on the second body (N m), where the joint carries one.
    pub moment: f64,
}

/// Energies and works since the start (J).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnergyObservation {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Potential energy: gravity, springs.
    pub potential: f64,
    /// Energy stored in contacts.
    pub elastic: f64,
    /// Dissipated by contact damping, friction and dampers.
    pub dissipated: f64,
    /// Work of the drives.
    pub drive_work: f64,
    /// Work of the applied forces and torques.
    pub load_work: f64,
    /// What the balance is off by.
    pub residual: f64,
}
