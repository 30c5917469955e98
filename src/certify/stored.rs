//! A certified reference in a result file.

use super::{Certificate, Claim, Growth, Reference};
use crate::case::{self, Case};
use crate::digits::{Parts, Scales, Sizes};
use crate::record::{Attribute, Dimension, ResultFile, Seal, Series, Values};
use crate::run::Trajectory;
use crate::simulate::assemble;

/// A file that does not serve as the reference of a case.
#[derive(Debug, thiserror::Error)]
pub enum NotAReference {
    /// The file cannot be read.
    #[error(transparent)]
    Unreadable(#[from] crate::record::Error),
    /// The file holds no certificate.
    #[error("{file} holds no certified reference: it has no {what}; `freeplay certify` makes one")]
    NoCertificate {
        /// The file.
        file: String,
        /// What is missing.
        what: &'static str,
    },
    /// The certificate has no seal.
    #[error(
        "the certificate in {file} is not sealed: it was made before certificates were, or its \
         attribute certificate_sha256 was lost; `freeplay certify` makes it again"
    )]
    NotSealed {
        /// The file.
        file: String,
    },
    /// The file was changed after it was sealed.
    #[error(
        "{file} was changed after it was certified: its contents are not those that its seal, \
         the attribute certificate_sha256, is of"
    )]
    Broken {
        /// The file.
        file: String,
    },
    /// The reference has no sample within the duration asked for.
    #[error("the reference in {file} has no sample up to {until} s")]
    NoSamples {
        /// The file.
        file: String,
        /// The duration asked for (s).
        until: f64,
    },
    /// The case in the file cannot be read.
    #[error("the case in {file} cannot be read")]
    Case {
        /// The file.
        file: String,
        /// Why.
        source: case::Error,
    },
    /// The reference is that of another mechanism.
    #[error("the reference in {file} is that of another mechanism: {what} differs")]
    OtherMechanism {
        /// The file.
        file: String,
        /// What differs.
        what: &'static str,
    },
}

/// Name and `long_name` of a dataset, and its value for a sample.
type Column = (&'static str, &'static str, fn(&Claim) -> f64);

/// What the file says of a sample.
const CLAIMS: [Column; 6] = [
    ("reference_digits", "digits of the state to which this reference is certified", |c| {
        c.reference.state
    }),
    ("reference_digits_forces", "digits of the joint forces to which it is certified", |c| {
        c.reference.forces
    }),
    ("reference_digits_torque", "digits of the drive torques to which it is certified", |c| {
        c.reference.torque
    }),
    ("run_digits", "true digits of the state of the run under test", |c| c.run.state),
    ("run_digits_forces", "true digits of the joint forces of the run under test", |c| {
        c.run.forces
    }),
    ("run_digits_torque", "true digits of the drive torques of the run under test", |c| {
        c.run.torque
    }),
];

/// What the file says of the time of an event.
const TIME_BOUND: &str = "event_time_bound";

impl Certificate {
    /// The datasets that a certificate adds to a result file.
    pub fn series(&self) -> Vec<Series> {
        let claims = CLAIMS.into_iter().map(|(name, long_name, of)| Series {
            name,
            unit: "1",
            long_name,
            stored: Values::Real,
            along: Dimension::Time,
            values: self.claims.iter().map(of).collect(),
        });
        let late = self.events.iter().map(|event| event.late);
        let found = self.events.iter().map(|event| match (event.counts, event.late) {
            (true, None) => 0.0,
            (true, Some(_)) => 1.0,
            (false, _) => 2.0,
        });
        let in_run = Series {
            name: "event_in_run",
            unit: "1",
            long_name: "whether the run under test has this event",
            stored: Values::Flag(&[(0, "missing"), (1, "found"), (2, "beyond_doubles")]),
            along: Dimension::Event,
            values: found.collect(),
        };
        let by = Series {
            name: "event_time_error",
            unit: "s",
            long_name: "time of this event in the run under test less its true time",
            stored: Values::Real,
            along: Dimension::Event,
            values: late.map(|late| late.unwrap_or(f64::NAN)).collect(),
        };
        let bound = Series {
            name: TIME_BOUND,
            unit: "s",
            long_name: "how far the true time of this event may be from the one that is told",
            stored: Values::Real,
            along: Dimension::Event,
            values: self.reference.event_times_wrong.clone(),
        };
        let factors = &self.reference.growth.factors;
        let growth = Series {
            name: "error_growth",
            unit: "1",
            long_name: "how much a small error of the start has grown, in the scales of digits",
            stored: Values::Real,
            along: Dimension::Time,
            values: (0..self.claims.len())
                .map(|place| factors.get(place).copied().unwrap_or(f64::NAN))
                .collect(),
        };
        claims.chain([in_run, by, bound, growth]).collect()
    }
}

impl Reference {
    /// The attributes that a certificate adds to a result file.
    pub fn attributes(&self) -> Vec<(String, Attribute)> {
        let Scales { angle, angular_velocity, velocity, clearances, force, torque, .. } =
            &self.scales;
        let mut attributes = vec![
            ("reference_tolerance_tight".to_owned(), self.tolerances[0]),
            ("reference_tolerance_loose".to_owned(), self.tolerances[1]),
            ("scale_angle".to_owned(), *angle),
            ("scale_angular_velocity".to_owned(), *angular_velocity),
            ("scale_velocity".to_owned(), *velocity),
            ("scale_force".to_owned(), *force),
            ("scale_torque".to_owned(), *torque),
        ];
        let clearances = clearances.iter().enumerate();
        attributes.extend(clearances.map(|(k, c)| (format!("scale_clearance_{k}"), *c)));
        let ends = self.growth.double_precision_ends;
        attributes.extend(ends.map(|time| ("double_precision_ends".to_owned(), time)));
        attributes.into_iter().map(|(name, value)| (name, Attribute::from(value))).collect()
    }
}

/// Reads a reference back, as far as the case asks for: it is as certain as its file says, and no
/// finer than doubles.
pub(super) fn read(case: &Case, file: &ResultFile) -> Result<Reference, NotAReference> {
    let name = || file.path().display().to_string();
    let claim = |of: &'static str| {
        let digits = file.along(Dimension::Time, of)?;
        digits.ok_or_else(|| NotAReference::NoCertificate { file: name(), what: of })
    };
    let state = claim("reference_digits")?;
    match file.seal()? {
        Seal::Whole => {}
        Seal::Missing => return Err(NotAReference::NotSealed { file: name() }),
        Seal::Broken => return Err(NotAReference::Broken { file: name() }),
    }
    let kept = same_mechanism(case, file)?;
    let mechanism: crate::mechanism::Mechanism<f64> =
        assemble(&kept).map_err(|source| NotAReference::Case { file: name(), source })?;
    let until = case.plan.duration.to_f64();
    let last = file.times()?.last().copied().unwrap_or(0.0);
    let need = |attribute: &'static str| {
        let missing = NotAReference::NoCertificate { file: name(), what: attribute };
        file.number(attribute).ok_or(missing)
    };
    let (forces, torque) = (claim("reference_digits_forces")?, claim("reference_digits_torque")?);
    let growth = claim("error_growth")?;
    let wrong = |digits: f64| 10f64.powf(-digits);
    let wrong = (state.iter().zip(&forces).zip(&torque))
        .map(|((s, f), t)| Parts { state: wrong(*s), forces: wrong(*f), torque: wrong(*t) })
        .collect();
    let events = file.events()?;
    let event_times_wrong = file.along(Dimension::Event, TIME_BOUND)?;
    let event_times_wrong = event_times_wrong.unwrap_or_else(|| vec![f64::NAN; events.len()]);
    let clearances = (0..file.clearances().len())
        .map(|k| file.number(&format!("scale_clearance_{k}")).unwrap_or(1.0))
        .collect();
    let samples = file.observations(0..file.length(Dimension::Time))?;
    let scales = Scales {
        angle: need("scale_angle")?,
        angular_velocity: need("scale_angular_velocity")?,
        velocity: need("scale_velocity")?,
        clearances,
        force: need("scale_force")?,
        torque: need("scale_torque")?,
        ..Scales::of(&samples, &Sizes::of(&mechanism))
    };
    let within = samples.partition_point(|sample| sample.time <= until);
    let mut reference = Reference {
        trajectory: Trajectory {
            samples,
            events,
            contacts: file.contacts()?,
            peaks: file.peaks()?,
            revolutions: file.revolutions()?,
        },
        wrong,
        event_times_wrong,
        scales,
        tolerances: [need("reference_tolerance_tight")?, need("reference_tolerance_loose")?],
        growth: Growth {
            factors: growth.into_iter().take_while(|factor| factor.is_finite()).collect(),
            double_precision_ends: file.number("double_precision_ends"),
        },
        until,
        complete: last >= until,
        stopped: None,
    };
    if within == 0 {
        return Err(NotAReference::NoSamples { file: name(), until });
    }
    if within < reference.trajectory.samples.len() {
        reference.cut(within);
    }
    Ok(reference)
}

/// The case in the file, if its mechanism is that of the case.
fn same_mechanism(case: &Case, file: &ResultFile) -> Result<Case, NotAReference> {
    let name = || file.path().display().to_string();
    let text = file.text("case_toml").unwrap_or_default();
    let kept = Case::from_text(file.path(), text, &case::Changes::default())
        .map_err(|source| NotAReference::Case { file: name(), source })?;
    let (ours, theirs) = (&case.description, &kept.description);
    let differs = [
        ("[ground]", ours.ground != theirs.ground),
        ("[bodies]", ours.bodies != theirs.bodies),
        ("[joints]", ours.joints != theirs.joints),
        ("[drives]", ours.drives != theirs.drives),
        ("[loads]", ours.loads != theirs.loads),
        ("[start]", ours.start != theirs.start),
        ("[start] clock", ours.clock != theirs.clock),
        ("[start] contact", ours.contacts != theirs.contacts),
        ("[start] memory", ours.memories != theirs.memories),
        ("[observe]", ours.observed != theirs.observed),
    ];
    match differs.into_iter().find(|(_, differs)| *differs) {
        Some((what, _)) => Err(NotAReference::OtherMechanism { file: name(), what }),
        None => Ok(kept),
    }
}
