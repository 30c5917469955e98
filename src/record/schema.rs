//! What a result file holds: one table for the writer, the reader and whoever lists columns.

use crate::mechanism::{
    BodyObservation, ClearanceObservation, JointObservation, Measure, Observation, PointObservation,
};
use crate::model::Owner;
use crate::run::{Contact, Event, EventKind, Peak, Revolution};

/// Version of the layout; it grows when a name is dropped or changes its meaning.
pub const SCHEMA_VERSION: i64 = 1;

/// A dimension, and the dataset that is its scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Samples; the only scale whose values are not counted from 0.
    Time,
    /// Bodies, the driven ones too.
    Body,
    /// Joints.
    Joint,
    /// Joints with clearance.
    Clearance,
    /// Drives.
    Drive,
    /// Events.
    Event,
    /// Contacts.
    Contact,
    /// Peaks of normal forces.
    Peak,
    /// Revolutions of the first drive; one, the whole run, where no drive turns.
    Revolution,
    /// Points that are observed; a file of a case that observes none has not the dimension.
    Point,
    /// Inner states of frictions and loads; a file of a case where nothing remembers has not the
    /// dimension.
    Memory,
}

impl Dimension {
    /// All, in the order in which they stand in a file.
    pub const ALL: [Dimension; 11] = [
        Dimension::Time,
        Dimension::Body,
        Dimension::Joint,
        Dimension::Clearance,
        Dimension::Drive,
        Dimension::Event,
        Dimension::Contact,
        Dimension::Peak,
        Dimension::Revolution,
        Dimension::Point,
        Dimension::Memory,
    ];

    /// Name of the dimension and of its scale.
    pub const fn name(self) -> &'static str {
        match self {
            Dimension::Time => "time",
            Dimension::Body => "body",
            Dimension::Joint => "joint",
            Dimension::Clearance => "clearance",
            Dimension::Drive => "drive",
            Dimension::Event => "event",
            Dimension::Contact => "contact",
            Dimension::Peak => "peak",
            Dimension::Revolution => "revolution",
            Dimension::Point => "point",
            Dimension::Memory => "memory",
        }
    }

    /// `long_name` of the scale.
    pub const fn long_name(self) -> &'static str {
        match self {
            Dimension::Time => "time",
            Dimension::Body => "index of the body",
            Dimension::Joint => "index of the joint",
            Dimension::Clearance => "index of the joint with clearance",
            Dimension::Drive => "index of the drive",
            Dimension::Event => "index of the event",
            Dimension::Contact => "index of the contact",
            Dimension::Peak => "index of the peak of a normal force",
            Dimension::Revolution => "index of the revolution of the first drive",
            Dimension::Point => "index of the point observed",
            Dimension::Memory => "index of the inner state of a friction or a load",
        }
    }
}

/// How the values of a dataset are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Values {
    /// 64-bit floating point.
    Real,
    /// 32-bit integer: an index.
    Index,
    /// 8-bit integer; its values in rising order, and what they mean.
    Flag(&'static [(i8, &'static str)]),
}

/// Where a value stands in what is written: for the writer, and for the reader that puts it back.
#[derive(Debug)]
pub struct Place<T> {
    /// The value.
    pub get: fn(&T) -> f64,
    /// Puts a value there.
    pub put: fn(&mut T, f64),
}

impl<T> Clone for Place<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Place<T> {}

/// Where the values of a dataset come from, which also gives its dimensions.
#[derive(Debug, Clone, Copy)]
pub enum Source {
    /// A value of each sample.
    Sample(Place<Observation>),
    /// A value of each body at each sample.
    Body(Place<BodyObservation>),
    /// A value of each joint with clearance at each sample.
    Clearance(Place<ClearanceObservation>),
    /// A value of each joint at each sample.
    Joint(Place<JointObservation>),
    /// The torque of each drive at each sample.
    Drive,
    /// A value of each point that is observed, at each sample.
    Point(Place<PointObservation>),
    /// Each inner state at each sample.
    Memory,
    /// A value of each event.
    Event(Place<Event>),
    /// A value of each contact.
    Contact(Place<Contact>),
    /// A value of each peak of a normal force.
    Peak(Place<Peak>),
    /// A value of each revolution.
    Revolution(Place<Revolution>),
    /// An extreme of each body, joint, clearance or drive in each revolution.
    Extreme(Measure, Side, Part),
}

/// Which extreme.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The largest value.
    Largest,
    /// The smallest value, of what has a sign.
    Smallest,
}

/// What of an extreme.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The value.
    Value,
    /// Its time.
    Time,
}

/// A dataset of the result file.
#[derive(Debug, Clone, Copy)]
pub struct Dataset {
    /// Name.
    pub name: &'static str,
    /// Attribute `units`, as UDUNITS reads it; `1` where there is none.
    pub unit: &'static str,
    /// Attribute `long_name`.
    pub long_name: &'static str,
    /// How the values are stored.
    pub values: Values,
    /// Where they come from.
    pub source: Source,
    /// What comparisons count it to.
    pub quantity: Option<Quantity>,
    /// How the report page draws it over time.
    pub drawn: Drawn,
}

/// A kind of quantity; all its columns are compared with one scale, but for clearances, which have
/// one each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Angles of the bodies (rad).
    Angle,
    /// Angular rates of the bodies (rad/s).
    AngularRate,
    /// Velocities of the mass centres (m/s).
    Velocity,
    /// Clearance vectors (m).
    Clearance,
    /// Positions of the mass centres (m).
    Position,
    /// Forces in clearances and joints (N).
    Force,
    /// Torques of the drives (N m).
    Torque,
    /// Moments of the joints (N m).
    Moment,
    /// Positions of the points that are observed (m).
    PointPosition,
    /// Velocities of these (m/s).
    PointVelocity,
}

/// How a page that has fewer samples than the file draws a dataset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drawn {
    /// Not at all.
    No,
    /// By any samples.
    Smooth,
    /// With its extremes.
    Extremes,
}

impl Dataset {
    /// The dimension that grows: samples, events, contacts, peaks or revolutions.
    pub const fn rows(&self) -> Dimension {
        match self.source {
            Source::Event(_) => Dimension::Event,
            Source::Contact(_) => Dimension::Contact,
            Source::Peak(_) => Dimension::Peak,
            Source::Revolution(_) | Source::Extreme(..) => Dimension::Revolution,
            _ => Dimension::Time,
        }
    }

    /// The dimension across, where each row has several values.
    pub const fn items(&self) -> Option<Dimension> {
        match self.source {
            Source::Body(_) => Some(Dimension::Body),
            Source::Clearance(_) => Some(Dimension::Clearance),
            Source::Joint(_) => Some(Dimension::Joint),
            Source::Drive => Some(Dimension::Drive),
            Source::Point(_) => Some(Dimension::Point),
            Source::Memory => Some(Dimension::Memory),
            Source::Extreme(measure, ..) => Some(match measure {
                Measure::AccelerationX | Measure::AccelerationY | Measure::AngularAcceleration => {
                    Dimension::Body
                }
                Measure::NormalForce | Measure::TangentialForce => Dimension::Clearance,
                Measure::DriveTorque => Dimension::Drive,
                Measure::JointForce => Dimension::Joint,
            }),
            _ => None,
        }
    }

    /// The value of one of its items in a sample; NaN where it is not along samples.
    pub fn value(&self, sample: &Observation, item: usize) -> f64 {
        match self.source {
            Source::Sample(place) => (place.get)(sample),
            Source::Body(place) => (place.get)(&sample.bodies[item]),
            Source::Clearance(place) => (place.get)(&sample.clearances[item]),
            Source::Joint(place) => (place.get)(&sample.joints[item]),
            Source::Drive => sample.drive_torques[item],
            Source::Point(place) => (place.get)(&sample.points[item]),
            Source::Memory => sample.memories[item],
            Source::Event(_)
            | Source::Contact(_)
            | Source::Peak(_)
            | Source::Revolution(_)
            | Source::Extreme(..) => f64::NAN,
        }
    }

    /// Puts a value into a sample, if it is along samples.
    pub fn put(&self, sample: &mut Observation, item: usize, value: f64) {
        match self.source {
            Source::Sample(place) => (place.put)(sample, value),
            Source::Body(place) => (place.put)(&mut sample.bodies[item], value),
            Source::Clearance(place) => (place.put)(&mut sample.clearances[item], value),
            Source::Joint(place) => (place.put)(&mut sample.joints[item], value),
            Source::Drive => sample.drive_torques[item] = value,
            Source::Point(place) => (place.put)(&mut sample.points[item], value),
            Source::Memory => sample.memories[item] = value,
            Source::Event(_)
            | Source::Contact(_)
            | Source::Peak(_)
            | Source::Revolution(_)
            | Source::Extreme(..) => {}
        }
    }

    /// Whether files of cases with none of its items do without it.
    pub const fn is_optional(&self) -> bool {
        matches!(self.source, Source::Point(_) | Source::Memory)
    }

    const fn compared(self, quantity: Quantity) -> Dataset {
        Dataset { quantity: Some(quantity), ..self }
    }

    const fn drawn(self, drawn: Drawn) -> Dataset {
        Dataset { drawn, ..self }
    }

    /// The dataset of this name.
    pub fn find(name: &str) -> Option<&'static Dataset> {
        DATASETS.iter().find(|dataset| dataset.name == name)
    }
}

/// Name of a single column: `angle.coupler`, or the dataset's own where it is one column.
pub fn column_name(dataset: &str, item: Option<&str>) -> String {
    item.map_or(dataset.to_owned(), |item| format!("{dataset}.{item}"))
}

/// A field of what is written.
macro_rules! at {
    ($($field:tt)+) => {
        Place { get: |of| of.$($field)+, put: |of, value| of.$($field)+ = value }
    };
}

/// A field that is an index.
macro_rules! at_index {
    ($field:ident) => {
        Place { get: |of| of.$field as f64, put: |of, value| of.$field = value as usize }
    };
}

const fn dataset(
    name: &'static str,
    unit: &'static str,
    long_name: &'static str,
    values: Values,
    source: Source,
) -> Dataset {
    Dataset { name, unit, long_name, values, source, quantity: None, drawn: Drawn::No }
}

const fn real(
    name: &'static str,
    unit: &'static str,
    long_name: &'static str,
    source: Source,
) -> Dataset {
    dataset(name, unit, long_name, Values::Real, source)
}

const fn index(name: &'static str, long_name: &'static str, source: Source) -> Dataset {
    dataset(name, "1", long_name, Values::Index, source)
}

const fn flag(
    name: &'static str,
    long_name: &'static str,
    meanings: &'static [(i8, &'static str)],
    source: Source,
) -> Dataset {
    dataset(name, "1", long_name, Values::Flag(meanings), source)
}

const fn extreme(
    name: &'static str,
    unit: &'static str,
    long_name: &'static str,
    measure: Measure,
    side: Side,
    part: Part,
) -> Dataset {
    real(name, unit, long_name, Source::Extreme(measure, side, part))
}

/// Every dataset but the index scales, in the order in which they stand in a file.
pub static DATASETS: [Dataset; 83] = {
    use Drawn::{Extremes, Smooth};
    use Measure as M;
    use Quantity as Q;
    use Source::{Body, Clearance, Contact, Drive, Event, Joint, Peak, Point, Revolution, Sample};
    [
        real("time", "s", "time", Sample(at!(time))),
        real("position_x", "m", "x of the mass centre, fixed frame", Body(at!(position[0])))
            .compared(Q::Position)
            .drawn(Smooth),
        real("position_y", "m", "y of the mass centre, fixed frame", Body(at!(position[1])))
            .compared(Q::Position)
            .drawn(Smooth),
        real("angle", "rad", "angle of the body, not wrapped", Body(at!(angle)))
            .compared(Q::Angle)
            .drawn(Smooth),
        real("velocity_x", "m/s", "x of the mass centre's velocity", Body(at!(velocity[0])))
            .compared(Q::Velocity),
        real("velocity_y", "m/s", "y of the mass centre's velocity", Body(at!(velocity[1])))
            .compared(Q::Velocity),
        real("angular_velocity", "rad/s", "angular rate of the body", Body(at!(angular_velocity)))
            .compared(Q::AngularRate)
            .drawn(Smooth),
        real(
            "acceleration_x",
            "m/s^2",
            "x of the mass centre's acceleration",
            Body(at!(acceleration[0])),
        ),
        real(
            "acceleration_y",
            "m/s^2",
            "y of the mass centre's acceleration",
            Body(at!(acceleration[1])),
        ),
        real(
            "angular_acceleration",
            "rad/s^2",
            "angular acceleration of the body",
            Body(at!(angular_acceleration)),
        )
        .drawn(Extremes),
        real(
            "clearance_x",
            "m",
            "x of the journal centre minus the bearing centre, fixed frame",
            Clearance(at!(offset[0])),
        )
        .compared(Q::Clearance)
        .drawn(Smooth),
        real(
            "clearance_y",
            "m",
            "y of the journal centre minus the bearing centre, fixed frame",
            Clearance(at!(offset[1])),
        )
        .compared(Q::Clearance)
        .drawn(Smooth),
        real(
            "eccentricity",
            "m",
            "distance of the journal centre from the bearing centre",
            Clearance(at!(eccentricity)),
        ),
        real(
            "penetration",
            "m",
            "eccentricity minus radial clearance; negative in flight",
            Clearance(at!(penetration)),
        )
        .drawn(Extremes),
        real(
            "penetration_rate",
            "m/s",
            "rate of the penetration",
            Clearance(at!(penetration_rate)),
        ),
        real(
            "slip_velocity",
            "m/s",
            "velocity along t of the journal's contact point relative to the bearing's",
            Clearance(at!(slip_velocity)),
        ),
        real(
            "normal_force",
            "N",
            "normal force, which pushes the journal along -n",
            Clearance(at!(normal_force)),
        )
        .compared(Q::Force)
        .drawn(Extremes),
        real(
            "tangential_force",
            "N",
            "tangential force on the journal, along t",
            Clearance(at!(tangential_force)),
        )
        .compared(Q::Force)
        .drawn(Extremes),
        flag(
            "in_contact",
            "whether the journal touches the bearing",
            &[(0, "flight"), (1, "contact")],
            Clearance(Place {
                get: |c| if c.in_contact { 1.0 } else { 0.0 },
                put: |c, value| c.in_contact = value != 0.0,
            }),
        ),
        real(
            "joint_force_x",
            "N",
            "x of the joint's force on its second body",
            Joint(at!(force[0])),
        )
        .compared(Q::Force)
        .drawn(Extremes),
        real(
            "joint_force_y",
            "N",
            "y of the joint's force on its second body",
            Joint(at!(force[1])),
        )
        .compared(Q::Force)
        .drawn(Extremes),
        real("joint_moment", "N m", "moment of the joint on its second body", Joint(at!(moment)))
            .compared(Q::Moment)
            .drawn(Extremes),
        real("drive_torque", "N m", "torque of the drive on the second body of its joint", Drive)
            .compared(Q::Torque)
            .drawn(Extremes),
        real("point_position_x", "m", "x of the point, fixed frame", Point(at!(position[0])))
            .compared(Q::PointPosition)
            .drawn(Smooth),
        real("point_position_y", "m", "y of the point, fixed frame", Point(at!(position[1])))
            .compared(Q::PointPosition)
            .drawn(Smooth),
        real("point_velocity_x", "m/s", "x of the point's velocity", Point(at!(velocity[0])))
            .compared(Q::PointVelocity)
            .drawn(Smooth),
        real("point_velocity_y", "m/s", "y of the point's velocity", Point(at!(velocity[1])))
            .compared(Q::PointVelocity)
            .drawn(Smooth),
        real(
            "point_acceleration_x",
            "m/s^2",
            "x of the point's acceleration",
            Point(at!(acceleration[0])),
        )
        .drawn(Extremes),
        real(
            "point_acceleration_y",
            "m/s^2",
            "y of the point's acceleration",
            Point(at!(acceleration[1])),
        )
        .drawn(Extremes),
        real("energy_kinetic", "J", "kinetic energy", Sample(at!(energy.kinetic))).drawn(Extremes),
        real(
            "energy_potential",
            "J",
            "potential energy of gravity and springs",
            Sample(at!(energy.potential)),
        )
        .drawn(Extremes),
        real("energy_elastic", "J", "energy stored in contacts", Sample(at!(energy.elastic)))
            .drawn(Smooth),
        real(
            "energy_dissipated",
            "J",
            "energy dissipated since the start by contact damping, friction and dampers",
            Sample(at!(energy.dissipated)),
        )
        .drawn(Smooth),
        real(
            "drive_work",
            "J",
            "work of the drives since the start",
            Sample(at!(energy.drive_work)),
        )
        .drawn(Smooth),
        real(
            "load_work",
            "J",
            "work of applied forces and torques since the start",
            Sample(at!(energy.load_work)),
        )
        .drawn(Smooth),
        real(
            "energy_residual",
            "J",
            "what the energy balance is off by",
            Sample(at!(energy.residual)),
        )
        .drawn(Extremes),
        real(
            "inner_state",
            "1",
            "what frictions and loads remember, over its own unit: deflection of bristles (m), dwell (1), \
             integral of a controller (rad)",
            Source::Memory,
        ),
        real("event_time", "s", "time of the event", Event(at!(time))),
        index(
            "event_clearance",
            "index of the event's clearance; -1 where it belongs to something else",
            Event(Place {
                get: |e| e.owner.clearance().map_or(-1.0, |k| k as f64),
                put: |e, value| e.owner = Owner::Clearance(value.max(0.0) as usize),
            }),
        ),
        flag(
            "event_kind",
            "kind of the event",
            &EventKind::WORDS,
            Event(Place {
                get: |e| f64::from(e.kind as i8),
                put: |e, value| e.kind = EventKind::of_number(value as i8).unwrap_or_default(),
            }),
        ),
        real(
            "event_rate",
            "m/s",
            "penetration rate at the event; slip velocity at a friction kink; independent share of the \
             constraints at a singular position, 0 where the run went on through it",
            Event(at!(rate)),
        ),
        flag(
            "event_owner",
            "what the event belongs to",
            &Owner::WORDS,
            Event(Place {
                get: |e| f64::from(e.owner.sort()),
                put: |e, value| e.owner = Owner::of(value as i8, e.owner.index()),
            }),
        ),
        index(
            "event_owner_index",
            "index of what the event belongs to among those of its sort",
            Event(Place {
                get: |e| e.owner.index() as f64,
                put: |e, value| e.owner = Owner::of(e.owner.sort(), value as usize),
            }),
        ),
        index(
            "contact_clearance",
            "index of the contact's clearance",
            Contact(at_index!(clearance)),
        ),
        real("contact_begin", "s", "begin of the contact", Contact(at!(begin))),
        real("contact_end", "s", "end of the contact; NaN while open", Contact(at!(end))),
        real(
            "contact_impact_rate",
            "m/s",
            "penetration rate at the begin of the contact",
            Contact(at!(impact_rate)),
        ),
        real(
            "contact_peak_penetration",
            "m",
            "largest penetration of the contact",
            Contact(at!(peak_penetration)),
        ),
        real(
            "contact_peak_penetration_time",
            "s",
            "time of the contact's largest penetration",
            Contact(at!(peak_penetration_time)),
        ),
        real(
            "contact_peak_force",
            "N",
            "largest normal force of the contact",
            Contact(at!(peak_force)),
        ),
        real(
            "contact_peak_time",
            "s",
            "time of the contact's largest normal force",
            Contact(at!(peak_time)),
        ),
        real(
            "contact_dissipated",
            "J",
            "energy dissipated in the contact by damping and friction",
            Contact(at!(dissipated)),
        ),
        real("peak_time", "s", "time of the local maximum of a normal force", Peak(at!(time))),
        index("peak_clearance", "index of the peak's clearance", Peak(at_index!(clearance))),
        real("peak_force", "N", "normal force at its local maximum", Peak(at!(force))),
        real("revolution_begin", "s", "begin of the revolution", Revolution(at!(begin))),
        real("revolution_end", "s", "end of the revolution or of the run", Revolution(at!(end))),
        extreme(
            "acceleration_x_largest",
            "m/s^2",
            "largest x of the mass centre's acceleration of the revolution",
            M::AccelerationX,
            Side::Largest,
            Part::Value,
        ),
        extreme(
            "acceleration_x_largest_time",
            "s",
            "time of the largest x of the mass centre's acceleration of the revolution",
            M::AccelerationX,
            Side::Largest,
            Part::Time,
        ),
        extreme(
            "acceleration_x_smallest",
            "m/s^2",
            "smallest x of the mass centre's acceleration of the revolution",
            M::AccelerationX,
            Side::Smallest,
            Part::Value,
        ),
        extreme(
            "acceleration_x_smallest_time",
            "s",
            "time of the smallest x of the mass centre's acceleration of the revolution",
            M::AccelerationX,
            Side::Smallest,
            Part::Time,
        ),
        extreme(
            "acceleration_y_largest",
            "m/s^2",
            "largest y of the mass centre's acceleration of the revolution",
            M::AccelerationY,
            Side::Largest,
            Part::Value,
        ),
        extreme(
            "acceleration_y_largest_time",
            "s",
            "time of the largest y of the mass centre's acceleration of the revolution",
            M::AccelerationY,
            Side::Largest,
            Part::Time,
        ),
        extreme(
            "acceleration_y_smallest",
            "m/s^2",
            "smallest y of the mass centre's acceleration of the revolution",
            M::AccelerationY,
            Side::Smallest,
            Part::Value,
        ),
        extreme(
            "acceleration_y_smallest_time",
            "s",
            "time of the smallest y of the mass centre's acceleration of the revolution",
            M::AccelerationY,
            Side::Smallest,
            Part::Time,
        ),
        extreme(
            "angular_acceleration_largest",
            "rad/s^2",
            "largest angular acceleration of the revolution",
            M::AngularAcceleration,
            Side::Largest,
            Part::Value,
        ),
        extreme(
            "angular_acceleration_largest_time",
            "s",
            "time of the largest angular acceleration of the revolution",
            M::AngularAcceleration,
            Side::Largest,
            Part::Time,
        ),
        extreme(
            "angular_acceleration_smallest",
            "rad/s^2",
            "smallest angular acceleration of the revolution",
            M::AngularAcceleration,
            Side::Smallest,
            Part::Value,
        ),
        extreme(
            "angular_acceleration_smallest_time",
            "s",
            "time of the smallest angular acceleration of the revolution",
            M::AngularAcceleration,
            Side::Smallest,
            Part::Time,
        ),
        extreme(
            "normal_force_largest",
            "N",
            "largest normal force of the revolution",
            M::NormalForce,
            Side::Largest,
            Part::Value,
        ),
        extreme(
            "normal_force_largest_time",
            "s",
            "time of the largest normal force of the revolution",
            M::NormalForce,
            Side::Largest,
            Part::Time,
        ),
        extreme(
            "normal_force_smallest",
            "N",
            "smallest normal force of the revolution",
            M::NormalForce,
            Side::Smallest,
            Part::Value,
        ),
        extreme(
            "normal_force_smallest_time",
            "s",
            "time of the smallest normal force of the revolution",
            M::NormalForce,
            Side::Smallest,
            Part::Time,
        ),
        extreme(
            "tangential_force_largest",
            "N",
            "largest tangential force of the revolution",
            M::TangentialForce,
            Side::Largest,
            Part::Value,
        ),
        extreme(
            "tangential_force_largest_time",
            "s",
            "time of the largest tangential force of the revolution",
            M::TangentialForce,
            Side::Largest,
            Part::Time,
        ),
        extreme(
            "tangential_force_smallest",
            "N",
            "smallest tangential force of the revolution",
            M::TangentialForce,
            Side::Smallest,
            Part::Value,
        ),
        extreme(
            "tangential_force_smallest_time",
            "s",
            "time of the smallest tangential force of the revolution",
            M::TangentialForce,
            Side::Smallest,
            Part::Time,
        ),
        extreme(
            "joint_force_largest",
            "N",
            "largest magnitude of the joint's force, friction included, of the revolution",
            M::JointForce,
            Side::Largest,
            Part::Value,
        ),
        extreme(
            "joint_force_largest_time",
            "s",
            "time of the largest magnitude of the joint's force, friction included, of the revolution",
            M::JointForce,
            Side::Largest,
            Part::Time,
        ),
        extreme(
            "drive_torque_largest",
            "N m",
            "largest drive torque of the revolution",
            M::DriveTorque,
            Side::Largest,
            Part::Value,
        ),
        extreme(
            "drive_torque_largest_time",
            "s",
            "time of the largest drive torque of the revolution",
            M::DriveTorque,
            Side::Largest,
            Part::Time,
        ),
        extreme(
            "drive_torque_smallest",
            "N m",
            "smallest drive torque of the revolution",
            M::DriveTorque,
            Side::Smallest,
            Part::Value,
        ),
        extreme(
            "drive_torque_smallest_time",
            "s",
            "time of the smallest drive torque of the revolution",
            M::DriveTorque,
            Side::Smallest,
            Part::Time,
        ),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_dataset_has_its_own_name_and_says_what_it_is() {
        let names: HashSet<_> = DATASETS.iter().map(|dataset| dataset.name).collect();
        assert_eq!(names.len(), DATASETS.len());
        for dataset in &DATASETS {
            assert!(!dataset.unit.is_empty() && !dataset.long_name.is_empty(), "{}", dataset.name);
            let texts = [dataset.name, dataset.unit, dataset.long_name];
            assert!(texts.iter().all(|text| text.is_ascii()), "{}", dataset.name);
        }
    }
}
