//! Runs to be recorded, made of arbitrary numbers, and what their files must hold. The names,
//! dimensions and units here are written out once more on purpose: other people's scripts depend
//! on them.

use freeplay::mechanism::{
    BodyObservation, ClearanceObservation, EnergyObservation, JointObservation, Measure, Measures,
    Observation,
};
use freeplay::model::Owner;
use freeplay::record::{Attribute, Ending, Header, Outcome, Writer};
use freeplay::run::{Contact, Event, EventKind, Extremum, Peak, Recorder, Revolution};
use std::path::{Path, PathBuf};

/// Everything that a recorder is told.
pub struct Recorded {
    pub header: Header,
    pub observations: Vec<Observation>,
    pub events: Vec<Event>,
    pub contacts: Vec<Contact>,
    pub peaks: Vec<Peak>,
    pub revolutions: Vec<Revolution>,
}

/// A dataset that a file must hold, its values row by row.
pub struct Expected {
    pub name: &'static str,
    pub dimensions: Vec<&'static str>,
    pub shape: Vec<usize>,
    pub unit: &'static str,
    pub values: Vec<f64>,
}

/// Numbers of all sizes with all digits, the same each time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let fraction = (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        fraction * 10_f64.powi((self.0 % 13) as i32 - 6)
    }

    fn pair(&mut self) -> [f64; 2] {
        [self.next(), self.next()]
    }
}

fn words<const N: usize>(words: [&str; N]) -> Vec<String> {
    words.map(str::to_owned).to_vec()
}

impl Recorded {
    /// A four-bar linkage; samples at uneven times, as adaptive sampling makes them.
    pub fn new(clearances: &[&str], samples: usize, events: usize) -> Self {
        let header = Header {
            name: "four-bar".to_owned(),
            title: "Four-bar linkage, δ ≤ c".to_owned(),
            case_text: "name = \"four-bar\" # δ ≤ c\n".to_owned(),
            bodies: words(["crank", "coupler", "follower"]),
            joints: words(["A0", "A", "B", "B0"]),
            clearances: clearances.iter().map(|&name| name.to_owned()).collect(),
            drives: words(["crank"]),
            points: Vec::new(),
            memories: Vec::new(),
            sundials_version: "6.4.1".to_owned(),
            attributes: vec![
                ("solver_engine".to_owned(), Attribute::from("ida")),
                ("solver_relative_tolerance".to_owned(), Attribute::Number(1e-12)),
            ],
            started_utc: "2026-03-01T12:00:00Z".to_owned(),
            samples: None,
        };
        let mut numbers = Numbers(1);
        let mut run = Recorded {
            observations: (0..samples).map(|row| observation(row, &header, &mut numbers)).collect(),
            header,
            events: Vec::new(),
            contacts: Vec::new(),
            peaks: Vec::new(),
            revolutions: Vec::new(),
        };
        run.add_events(events, &mut numbers);
        run.add_revolutions(events / 3, &mut numbers);
        run
    }

    fn add_events(&mut self, events: usize, numbers: &mut Numbers) {
        let kinds = EventKind::ALL;
        for k in 0..events {
            let clearance = k % self.header.clearances.len();
            let (time, rate) = (numbers.next(), numbers.next());
            let kind = kinds[k % kinds.len()];
            let owner = match kind {
                EventKind::CourseChanges if k % 4 == 0 => Owner::Load(k),
                EventKind::CourseChanges => Owner::Drive(0),
                EventKind::Singular => Owner::Joint(0),
                _ => Owner::Clearance(clearance),
            };
            self.events.push(Event { time, owner, kind, rate });
            self.peaks.push(Peak { time: numbers.next(), clearance, force: numbers.next() });
            self.contacts.push(Contact {
                clearance,
                begin: numbers.next(),
                end: if k + 1 == events { f64::NAN } else { numbers.next() },
                impact_rate: numbers.next(),
                peak_penetration: numbers.next(),
                peak_penetration_time: numbers.next(),
                peak_force: numbers.next(),
                peak_time: numbers.next(),
                dissipated: numbers.next(),
            });
        }
    }

    fn add_revolutions(&mut self, revolutions: usize, numbers: &mut Numbers) {
        let header = &self.header;
        let measures = Measures {
            bodies: header.bodies.len(),
            clearances: header.clearances.len(),
            drives: header.drives.len(),
            joints: header.joints.len(),
        };
        let mut extrema = |count: usize| -> Vec<Extremum> {
            (0..count).map(|_| Extremum { value: numbers.next(), time: numbers.next() }).collect()
        };
        for k in 0..revolutions {
            self.revolutions.push(Revolution {
                begin: k as f64,
                end: k as f64 + 1.0,
                measures,
                largest: extrema(measures.len()),
                smallest: extrema(measures.signed()),
            });
        }
    }

    /// Tells a writer everything and finishes it.
    pub fn write(&self, path: &Path, force: bool) -> PathBuf {
        let mut writer = Writer::create(path, self.header.clone(), force).unwrap();
        self.tell(&mut writer);
        writer.finish(complete()).unwrap()
    }

    /// Tells a writer everything, the events between the samples.
    pub fn tell(&self, writer: &mut Writer) {
        for observation in &self.observations {
            writer.sample(observation).unwrap();
        }
        for event in &self.events {
            writer.event(*event).unwrap();
        }
        for contact in &self.contacts {
            writer.contact(*contact).unwrap();
        }
        for peak in &self.peaks {
            writer.peak(*peak).unwrap();
        }
        for revolution in &self.revolutions {
            writer.revolution(revolution).unwrap();
        }
    }

    /// What its file must hold.
    pub fn expected(&self) -> Vec<Expected> {
        let mut all = self.expected_of_samples();
        all.extend(self.expected_of_events());
        all.extend(self.expected_of_revolutions());
        all
    }

    fn expected_of_samples(&self) -> Vec<Expected> {
        let one = |name, unit, value: fn(&Observation) -> f64| Expected {
            name,
            dimensions: vec!["time"],
            shape: vec![self.observations.len()],
            unit,
            values: self.observations.iter().map(value).collect(),
        };
        let body = |name, unit, value: fn(&BodyObservation) -> f64| {
            self.expected_of_items(name, "body", unit, |o| o.bodies.iter().map(value).collect())
        };
        let clearance = |name, unit, value: fn(&ClearanceObservation) -> f64| {
            self.expected_of_items(name, "clearance", unit, |o| {
                o.clearances.iter().map(value).collect()
            })
        };
        let joint = |name, unit, value: fn(&JointObservation) -> f64| {
            self.expected_of_items(name, "joint", unit, |o| o.joints.iter().map(value).collect())
        };
        vec![
            one("time", "s", |o| o.time),
            body("position_x", "m", |b| b.position[0]),
            body("position_y", "m", |b| b.position[1]),
            body("angle", "rad", |b| b.angle),
            body("velocity_x", "m/s", |b| b.velocity[0]),
            body("velocity_y", "m/s", |b| b.velocity[1]),
            body("angular_velocity", "rad/s", |b| b.angular_velocity),
            body("acceleration_x", "m/s^2", |b| b.acceleration[0]),
            body("acceleration_y", "m/s^2", |b| b.acceleration[1]),
            body("angular_acceleration", "rad/s^2", |b| b.angular_acceleration),
            clearance("clearance_x", "m", |c| c.offset[0]),
            clearance("clearance_y", "m", |c| c.offset[1]),
            clearance("eccentricity", "m", |c| c.eccentricity),
            clearance("penetration", "m", |c| c.penetration),
            clearance("penetration_rate", "m/s", |c| c.penetration_rate),
            clearance("slip_velocity", "m/s", |c| c.slip_velocity),
            clearance("normal_force", "N", |c| c.normal_force),
            clearance("tangential_force", "N", |c| c.tangential_force),
            clearance("in_contact", "1", |c| f64::from(u8::from(c.in_contact))),
            joint("joint_force_x", "N", |j| j.force[0]),
            joint("joint_force_y", "N", |j| j.force[1]),
            joint("joint_moment", "N m", |j| j.moment),
            self.expected_of_items("drive_torque", "drive", "N m", |o| o.drive_torques.clone()),
            one("energy_kinetic", "J", |o| o.energy.kinetic),
            one("energy_potential", "J", |o| o.energy.potential),
            one("energy_elastic", "J", |o| o.energy.elastic),
            one("energy_dissipated", "J", |o| o.energy.dissipated),
            one("drive_work", "J", |o| o.energy.drive_work),
            one("load_work", "J", |o| o.energy.load_work),
            one("energy_residual", "J", |o| o.energy.residual),
        ]
    }

    fn expected_of_items(
        &self,
        name: &'static str,
        items: &'static str,
        unit: &'static str,
        values: impl Fn(&Observation) -> Vec<f64>,
    ) -> Expected {
        let width = match items {
            "body" => self.header.bodies.len(),
            "joint" => self.header.joints.len(),
            "drive" => self.header.drives.len(),
            _ => self.header.clearances.len(),
        };
        Expected {
            name,
            dimensions: vec!["time", items],
            shape: vec![self.observations.len(), width],
            unit,
            values: self.observations.iter().flat_map(values).collect(),
        }
    }

    fn expected_of_events(&self) -> Vec<Expected> {
        fn list<T>(
            dimension: &'static str,
            rows: &[T],
            name: &'static str,
            unit: &'static str,
            value: fn(&T) -> f64,
        ) -> Expected {
            let values = rows.iter().map(value).collect();
            Expected { name, dimensions: vec![dimension], shape: vec![rows.len()], unit, values }
        }
        let event = |name, unit, value| list("event", &self.events, name, unit, value);
        let contact = |name, unit, value| list("contact", &self.contacts, name, unit, value);
        let peak = |name, unit, value| list("peak", &self.peaks, name, unit, value);
        vec![
            event("event_time", "s", |e| e.time),
            event("event_clearance", "1", |e| e.owner.clearance().map_or(-1.0, |k| k as f64)),
            event("event_kind", "1", |e| f64::from(e.kind as u8)),
            event("event_rate", "m/s", |e| e.rate),
            event("event_owner", "1", |e| f64::from(e.owner.sort())),
            event("event_owner_index", "1", |e| e.owner.index() as f64),
            contact("contact_clearance", "1", |c| c.clearance as f64),
            contact("contact_begin", "s", |c| c.begin),
            contact("contact_end", "s", |c| c.end),
            contact("contact_impact_rate", "m/s", |c| c.impact_rate),
            contact("contact_peak_penetration", "m", |c| c.peak_penetration),
            contact("contact_peak_penetration_time", "s", |c| c.peak_penetration_time),
            contact("contact_peak_force", "N", |c| c.peak_force),
            contact("contact_peak_time", "s", |c| c.peak_time),
            contact("contact_dissipated", "J", |c| c.dissipated),
            peak("peak_time", "s", |p| p.time),
            peak("peak_clearance", "1", |p| p.clearance as f64),
            peak("peak_force", "N", |p| p.force),
        ]
    }
}

impl Recorded {
    fn expected_of_revolutions(&self) -> Vec<Expected> {
        let end = |name, value: fn(&Revolution) -> f64| Expected {
            name,
            dimensions: vec!["revolution"],
            shape: vec![self.revolutions.len()],
            unit: "s",
            values: self.revolutions.iter().map(value).collect(),
        };
        let mut all = vec![end("revolution_begin", |r| r.begin), end("revolution_end", |r| r.end)];
        let Header { bodies, joints, clearances, drives, .. } = &self.header;
        for (names, items, width, unit, measure) in [
            (ACCELERATION_X, "body", bodies.len(), "m/s^2", Measure::AccelerationX),
            (ACCELERATION_Y, "body", bodies.len(), "m/s^2", Measure::AccelerationY),
            (ANGULAR_ACCELERATION, "body", bodies.len(), "rad/s^2", Measure::AngularAcceleration),
            (NORMAL_FORCE, "clearance", clearances.len(), "N", Measure::NormalForce),
            (TANGENTIAL_FORCE, "clearance", clearances.len(), "N", Measure::TangentialForce),
            (JOINT_FORCE, "joint", joints.len(), "N", Measure::JointForce),
            (DRIVE_TORQUE, "drive", drives.len(), "N m", Measure::DriveTorque),
        ] {
            let mut add = |name, unit, of: &dyn Fn(&Revolution) -> Vec<f64>| {
                all.push(Expected {
                    name,
                    dimensions: vec!["revolution", items],
                    shape: vec![self.revolutions.len(), width],
                    unit,
                    values: self.revolutions.iter().flat_map(of).collect(),
                });
            };
            add(names[0], unit, &|r| r.largest(measure).map(|found| found.value).collect());
            add(names[1], "s", &|r| r.largest(measure).map(|found| found.time).collect());
            if let [_, _, smallest, time] = names {
                add(smallest, unit, &|r| r.smallest(measure).map(|found| found.value).collect());
                add(time, "s", &|r| r.smallest(measure).map(|found| found.time).collect());
            }
        }
        all
    }
}

type Names = &'static [&'static str];

const ACCELERATION_X: Names = &[
    "acceleration_x_largest",
    "acceleration_x_largest_time",
    "acceleration_x_smallest",
    "acceleration_x_smallest_time",
];
const ACCELERATION_Y: Names = &[
    "acceleration_y_largest",
    "acceleration_y_largest_time",
    "acceleration_y_smallest",
    "acceleration_y_smallest_time",
];
const ANGULAR_ACCELERATION: Names = &[
    "angular_acceleration_largest",
    "angular_acceleration_largest_time",
    "angular_acceleration_smallest",
    "angular_acceleration_smallest_time",
];
const NORMAL_FORCE: Names = &[
    "normal_force_largest",
    "normal_force_largest_time",
    "normal_force_smallest",
    "normal_force_smallest_time",
];
const TANGENTIAL_FORCE: Names = &[
    "tangential_force_largest",
    "tangential_force_largest_time",
    "tangential_force_smallest",
    "tangential_force_smallest_time",
];
const JOINT_FORCE: Names = &["joint_force_largest", "joint_force_largest_time"];
const DRIVE_TORQUE: Names = &[
    "drive_torque_largest",
    "drive_torque_largest_time",
    "drive_torque_smallest",
    "drive_torque_smallest_time",
];

/// An observation whose time is uneven but rising.
fn observation(row: usize, header: &Header, numbers: &mut Numbers) -> Observation {
    let time = row as f64 * 1e-5 + if row % 7 == 3 { 3.3e-6 } else { 0.0 };
    Observation {
        time,
        bodies: header.bodies.iter().map(|_| body(numbers)).collect(),
        clearances: header.clearances.iter().map(|_| clearance(numbers)).collect(),
        joints: header
            .joints
            .iter()
            .map(|_| JointObservation { force: numbers.pair(), moment: numbers.next() })
            .collect(),
        drive_torques: header.drives.iter().map(|_| numbers.next()).collect(),
        points: Vec::new(),
        memories: Vec::new(),
        energy: EnergyObservation {
            kinetic: numbers.next(),
            potential: numbers.next(),
            elastic: numbers.next(),
            dissipated: numbers.next(),
            drive_work: numbers.next(),
            load_work: numbers.next(),
            residual: numbers.next(),
        },
        beyond: Vec::new(),
    }
}

fn body(numbers: &mut Numbers) -> BodyObservation {
    BodyObservation {
        position: numbers.pair(),
        angle: numbers.next(),
        velocity: numbers.pair(),
        angular_velocity: numbers.next(),
        acceleration: numbers.pair(),
        angular_acceleration: numbers.next(),
    }
}

fn clearance(numbers: &mut Numbers) -> ClearanceObservation {
    ClearanceObservation {
        offset: numbers.pair(),
        eccentricity: numbers.next(),
        penetration: numbers.next(),
        penetration_rate: numbers.next(),
        slip_velocity: numbers.next(),
        normal_force: numbers.next(),
        tangential_force: numbers.next(),
        in_contact: numbers.next() > 0.0,
    }
}

/// The ending of a run that came to its end.
pub fn complete() -> Ending {
    Ending {
        outcome: Outcome::Complete,
        counts: vec![freeplay::dae::Count { name: "steps", value: 123_456 }],
        rulings: vec![freeplay::dae::Count { name: "tension", value: 7 }],
        finished_utc: "2026-03-01T12:00:01Z".to_owned(),
        series: Vec::new(),
        attributes: Vec::new(),
    }
}
