//! The runs that are drawn: their samples, events and names, and the axis they are drawn over.

use super::{Error, Options, Over};
use crate::case::{Case, Changes};
use crate::certify::Horizon;
use crate::model::did_you_mean;
use crate::record::{self, Dimension, ResultFile, Table};
use crate::run::{Contact, Event, Peak, Revolution};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::ops::Range;
use std::path::PathBuf;
use std::rc::Rc;

/// A run, read as far as several figures need it.
#[derive(Debug)]
pub(super) struct Run {
    file: ResultFile,
    /// What it is called in the figures.
    pub name: String,
    /// Times of the samples drawn (s).
    pub times: Vec<f64>,
    /// Angle of its drive at these times; `None` without a drive.
    pub drive: Option<DriveAngle>,
    /// All events.
    pub events: Vec<Event>,
    /// All contacts.
    pub contacts: Vec<Contact>,
    /// All local maxima of normal forces.
    pub peaks: Vec<Peak>,
    /// Extremes by revolution.
    pub revolutions: Vec<Revolution>,
    /// How far the run is true; `None` where the file does not tell.
    horizon: Option<Horizon>,
    window: Range<usize>,
    over: Over,
    /// Datasets read last: figures of several parts read the same ones again.
    read: RefCell<VecDeque<Rc<Table>>>,
}

/// Datasets kept in memory.
const KEPT: usize = 4;

/// The angle of a drive over time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DriveAngle {
    /// Name of the drive.
    pub name: String,
    /// Angle of the second body relative to the first at each sample drawn (rad).
    pub angles: Vec<f64>,
}

impl Run {
    fn read(file: ResultFile, name: String, options: &Options) -> Result<Self, Error> {
        let path = || file.path().to_owned();
        let all = file.times()?;
        let from = options.from.unwrap_or(f64::NEG_INFINITY);
        let until = options.until.unwrap_or(f64::INFINITY);
        let window = all.partition_point(|t| *t < from)..all.partition_point(|t| *t <= until);
        if window.is_empty() {
            return Err(Error::NoSamples { path: path(), from, until });
        }
        let drive = match drive_angle(&file, options, &window) {
            Err(Error::NoDrive { .. }) if options.over == Over::Time && options.drive.is_none() => {
                None
            }
            found => Some(found?),
        };
        Ok(Run {
            name,
            times: all[window.clone()].to_vec(),
            drive,
            events: file.events()?,
            contacts: file.contacts()?,
            peaks: file.peaks()?,
            revolutions: file.revolutions()?,
            horizon: Horizon::of(&file)?,
            window,
            over: options.over,
            read: RefCell::default(),
            file,
        })
    }

    /// Names of the items of a dimension.
    pub fn names(&self, dimension: Dimension) -> &[String] {
        self.file.names(dimension)
    }

    /// Index of a named item.
    pub fn index(&self, dimension: Dimension, name: &str) -> Option<usize> {
        self.names(dimension).iter().position(|known| known == name)
    }

    /// Whether a clearance is a journal's, and has the name of its joint; else it is one corner of a
    /// block or one flank of a slot, and has a number behind that.
    pub fn is_journal(&self, clearance: &str) -> bool {
        let is_joint = |name: &str| self.index(Dimension::Joint, name).is_some();
        is_joint(clearance) || clearance.rsplit_once('_').is_none_or(|(joint, _)| !is_joint(joint))
    }

    /// Whether the mechanism has no clearance.
    pub fn is_ideal(&self) -> bool {
        self.names(Dimension::Clearance).is_empty()
    }

    /// A dataset over time.
    pub fn samples(&self, dataset: &str) -> Result<Samples, Error> {
        let known = self.read.borrow().iter().find(|table| table.dataset.name == dataset).cloned();
        let table = match known {
            Some(table) => table,
            None => Rc::new(self.file.table(dataset)?),
        };
        let mut read = self.read.borrow_mut();
        read.retain(|other| other.dataset.name != dataset);
        read.push_front(Rc::clone(&table));
        read.truncate(KEPT);
        Ok(Samples { table, window: self.window.clone() })
    }

    /// A single column over time that not every file has.
    pub fn optional_column(&self, dataset: &str) -> Result<Option<Vec<f64>>, Error> {
        let column = self.file.along(Dimension::Time, dataset)?;
        Ok(column.map(|column| column[self.window.clone()].to_vec()))
    }

    /// Where the samples are on the horizontal axis (s or rad).
    pub fn abscissa(&self) -> &[f64] {
        match (self.over, &self.drive) {
            (Over::Angle, Some(drive)) => &drive.angles,
            _ => &self.times,
        }
    }

    /// Where a time is on the horizontal axis (s or rad).
    pub fn place(&self, time: f64) -> f64 {
        match self.over {
            Over::Time => time,
            Over::Angle => interpolate(&self.times, self.abscissa(), time),
        }
    }

    /// Time (s) behind which the state means nothing, where that is drawn.
    pub fn state_ends(&self) -> Option<f64> {
        self.ends(|horizon| horizon.state)
    }

    /// The same of forces, torques and accelerations.
    pub fn forces_end(&self) -> Option<f64> {
        self.ends(|horizon| horizon.forces)
    }

    fn ends(&self, of: fn(&Horizon) -> f64) -> Option<f64> {
        let last = self.times.last()?;
        self.horizon.as_ref().map(of).filter(|until| until < last)
    }

    /// Where on the horizontal axis what is drawn lies behind a time (s).
    pub fn behind(&self, until: Option<f64>) -> Option<[f64; 2]> {
        let (first, last) = self.times.first().zip(self.times.last())?;
        until.map(|until| [self.place(until.max(*first)), self.place(*last)])
    }

    /// Whether a time lies in what is drawn.
    pub fn shows(&self, time: f64) -> bool {
        let ends = self.times.first().zip(self.times.last());
        ends.is_some_and(|(first, last)| *first <= time && time <= *last)
    }

    /// Radial clearance of a joint (m); `None` where no sample tells it.
    pub fn radial_clearance(&self, clearance: usize) -> Result<Option<f64>, Error> {
        let eccentricity = self.samples("eccentricity")?.column(clearance);
        let penetration = self.samples("penetration")?.column(clearance);
        let mut radial = eccentricity.iter().zip(&penetration).map(|(e, depth)| e - depth);
        Ok(radial.find(|radial| radial.is_finite() && *radial > 0.0))
    }
}

/// A dataset over time, as far as it is drawn.
#[derive(Debug)]
pub(super) struct Samples {
    table: Rc<Table>,
    window: Range<usize>,
}

impl Samples {
    /// The values of one item.
    pub fn column(&self, item: usize) -> Vec<f64> {
        let width = self.table.width.max(1);
        let rows = self.table.values[self.window.start * width..self.window.end * width].iter();
        rows.skip(item).step_by(width).copied().collect()
    }
}

/// All runs of a figure.
#[derive(Debug)]
pub(super) struct Runs {
    runs: Vec<Run>,
}

impl Runs {
    /// Reads the runs of some files.
    pub fn read(files: Vec<ResultFile>, options: &Options) -> Result<Self, Error> {
        let names = record::names_of_runs(&files, &options.labels)?;
        let runs = files.into_iter().zip(names).map(|(file, name)| Run::read(file, name, options));
        Ok(Runs { runs: runs.collect::<Result<_, Error>>()? })
    }

    /// The run of the ideal mechanism that others are compared with: the first without clearances,
    /// if another has some.
    pub fn ideal(&self) -> Option<&Run> {
        let compared = self.runs.iter().any(|run| !run.is_ideal());
        self.runs.iter().find(|run| compared && run.is_ideal())
    }

    /// The runs that have panels of their own: all others.
    pub fn shown(&self) -> impl Iterator<Item = &Run> {
        let ideal = self.ideal();
        self.runs.iter().filter(move |run| !ideal.is_some_and(|ideal| std::ptr::eq(*run, ideal)))
    }

    /// Names of the items of a dimension in all runs that are shown, each once.
    pub fn names(&self, dimension: Dimension) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for name in self.shown().flat_map(|run| run.names(dimension)) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        names
    }

    /// Ends of the horizontal axis (s or rad).
    pub fn range(&self) -> [f64; 2] {
        let places = self.shown().flat_map(|run| {
            let places = run.abscissa();
            [places.first(), places.last()].into_iter().flatten().copied()
        });
        let ends = super::panel::range_of(places).unwrap_or([0.0, 1.0]);
        if ends[0] < ends[1] { ends } else { super::panel::with_room(Some(ends)) }
    }

    /// Name of the drive whose angle counts.
    pub fn drive(&self) -> Option<&str> {
        self.shown().find_map(|run| run.drive.as_ref()).map(|drive| drive.name.as_str())
    }
}

/// Linear between known values; the end values hold outside.
pub(super) fn interpolate(at: &[f64], values: &[f64], x: f64) -> f64 {
    let right = at.partition_point(|known| *known <= x);
    if right == 0 || right == at.len() {
        let end = if right == 0 { values.first() } else { values.last() };
        return end.copied().unwrap_or(f64::NAN);
    }
    let (from, to) = (at[right - 1], at[right]);
    values[right - 1] + (values[right] - values[right - 1]) * ((x - from) / (to - from))
}

/// The angle of the drive that the options name, or of the first. Which bodies it turns stands in
/// the case that the file holds.
fn drive_angle(
    file: &ResultFile,
    options: &Options,
    window: &Range<usize>,
) -> Result<DriveAngle, Error> {
    let path: PathBuf = file.path().to_owned();
    let Some(name) = options.drive.as_ref().or(file.drives().first()) else {
        return Err(Error::NoDrive { path, what: "it has none".to_owned() });
    };
    if !file.drives().contains(name) {
        let hint = did_you_mean(name, file.drives().iter().map(String::as_str));
        return Err(Error::NoDrive { path, what: format!("it has no drive \"{name}\"{hint}") });
    }
    let Some(bodies) = bodies_of_drive(file, name) else {
        let what = "the case in it cannot be read".to_owned();
        return Err(Error::NoDrive { path, what });
    };
    let [first, second] = bodies.map(|body| match body.as_str() {
        "ground" => Ok(None),
        body => file.column(&format!("angle.{body}")).map(Some),
    });
    let (first, second) = (first?, second?);
    let angle = |angles: &Option<Vec<f64>>, row: usize| angles.as_ref().map_or(0.0, |a| a[row]);
    let angles = window.clone().map(|row| angle(&second, row) - angle(&first, row)).collect();
    Ok(DriveAngle { name: name.clone(), angles })
}

/// Names of the bodies that a drive turns against each other, from the case in the file.
fn bodies_of_drive(file: &ResultFile, name: &str) -> Option<[String; 2]> {
    let text = file.text("case_toml")?;
    let case = Case::from_text(file.path(), text, &Changes::default()).ok()?;
    let drive = case.description.drives.iter().find(|drive| drive.name == name)?;
    let joint = case.description.joints.iter().find(|joint| joint.name == drive.joint)?;
    Some(joint.between().map(|end| end.split('.').next().unwrap_or_default().to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_samples_values_are_linear_and_outside_they_stay() {
        let (at, values) = ([0.0, 1.0, 3.0], [5.0, 7.0, 3.0]);
        for (x, value) in [(-1.0, 5.0), (0.0, 5.0), (0.5, 6.0), (1.0, 7.0), (2.0, 5.0), (9.0, 3.0)]
        {
            assert_eq!(interpolate(&at, &values, x), value, "{x}");
        }
        assert!(interpolate(&[], &[], 1.0).is_nan());
    }
}
