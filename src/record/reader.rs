//! Reading result files.

use super::schema::{
    DATASETS, Dataset, Dimension, Part, Place, SCHEMA_VERSION, Side, Source, Values, column_name,
};
use super::sound::{Member, Ration, members};
use super::{Attribute, Error, LibraryError};
use crate::mechanism::{
    BodyObservation, ClearanceObservation, JointObservation, Measure, Measures, Observation,
    PointObservation,
};
use crate::model::{did_you_mean, is_name, shortened};
use crate::run::{Contact, Event, Extremum, Peak, Revolution};
use hdf5::{File, IndexType, IterationOrder, MinorErrorCode};
use ndarray::{Array2, s};
use std::collections::HashSet;
use std::io::{Error as SystemError, ErrorKind};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A result file, open for reading. Its samples stay on disk until they are asked for.
#[derive(Debug)]
pub struct ResultFile {
    file: File,
    path: PathBuf,
    lengths: [usize; Dimension::ALL.len()],
    names: [Vec<String>; Dimension::ALL.len()],
    attributes: Vec<(String, Attribute)>,
}

/// A whole dataset.
#[derive(Debug, Clone)]
pub struct Table {
    /// What it holds.
    pub dataset: &'static Dataset,
    /// Number of rows.
    pub rows: usize,
    /// Number of values in a row.
    pub width: usize,
    /// Values, row by row, in the dataset's unit.
    pub values: Vec<f64>,
}

impl Table {
    /// The values of one item in all rows.
    pub fn column(&self, item: usize) -> Vec<f64> {
        self.values.iter().skip(item).step_by(self.width.max(1)).copied().collect()
    }
}

/// Datasets that results of older programs do not have.
const LATER: [&str; 3] = ["contact_peak_penetration_time", "event_owner", "event_owner_index"];

impl ResultFile {
    /// Opens a result file.
    ///
    /// # Errors
    /// [`Error::System`], [`Error::NotPlain`], [`Error::NotHdf5`], [`Error::Truncated`],
    /// [`Error::NotAResult`], [`Error::Newer`] or [`Error::Damaged`].
    pub fn open(path: &Path) -> Result<Self, Error> {
        let file = open_file(path)?;
        let mut result = ResultFile {
            file,
            path: path.to_owned(),
            lengths: [0; Dimension::ALL.len()],
            names: Default::default(),
            attributes: Vec::new(),
        };
        result.attributes = result.read_attributes()?;
        result.check_schema()?;
        result.check_members()?;
        for dimension in Dimension::ALL {
            result.lengths[dimension as usize] = result.read_length(dimension)?;
            result.names[dimension as usize] = result.read_names(dimension)?;
        }
        result.check_shapes()?;
        Ok(result)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Length of a dimension: the number of samples, bodies, events and so on.
    pub fn length(&self, dimension: Dimension) -> usize {
        self.lengths[dimension as usize]
    }

    /// Names of the items of a dimension; empty where they have none.
    pub fn names(&self, dimension: Dimension) -> &[String] {
        &self.names[dimension as usize]
    }

    /// Names of all bodies.
    pub fn bodies(&self) -> &[String] {
        self.names(Dimension::Body)
    }

    /// Names of all joints.
    pub fn joints(&self) -> &[String] {
        self.names(Dimension::Joint)
    }

    /// Names of the joints with clearance.
    pub fn clearances(&self) -> &[String] {
        self.names(Dimension::Clearance)
    }

    /// Names of the drives.
    pub fn drives(&self) -> &[String] {
        self.names(Dimension::Drive)
    }

    /// Names of the points that are observed, `coupler.P`.
    pub fn points(&self) -> &[String] {
        self.names(Dimension::Point)
    }

    /// Whether a dataset of the table is in the file, or was left out, as it is of nothing.
    pub(super) fn has(&self, dataset: &Dataset) -> bool {
        !dataset.is_optional() || dataset.items().is_none_or(|items| self.length(items) > 0)
    }

    /// Names of the inner states of frictions and loads.
    pub fn memories(&self) -> &[String] {
        self.names(Dimension::Memory)
    }

    /// All attributes of the root, in the order in which they were written.
    pub fn attributes(&self) -> &[(String, Attribute)] {
        &self.attributes
    }

    /// The attribute of this name.
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// The text of an attribute; `None` where there is none or it is a number.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.attribute(name) {
            Some(Attribute::Text(text)) => Some(text),
            _ => None,
        }
    }

    /// The number of an attribute, whole or not; `None` where there is none or it is text.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.attribute(name) {
            Some(Attribute::Number(value)) => Some(*value),
            Some(Attribute::Integer(value)) => Some(*value as f64),
            _ => None,
        }
    }

    /// Whether the run came to its end.
    pub fn is_complete(&self) -> bool {
        self.text("run_status") == Some("complete")
    }

    /// Names of all columns over time, `time` first, in the order of the file.
    pub fn columns(&self) -> Vec<String> {
        let over_time = DATASETS.iter().filter(|dataset| dataset.rows() == Dimension::Time);
        over_time.flat_map(|dataset| self.columns_of(dataset)).collect()
    }

    fn columns_of(&self, dataset: &Dataset) -> Vec<String> {
        match dataset.items() {
            None => vec![column_name(dataset.name, None)],
            Some(items) => {
                let names = self.names(items).iter();
                names.map(|item| column_name(dataset.name, Some(item))).collect()
            }
        }
    }

    /// Sample times (s).
    pub fn times(&self) -> Result<Vec<f64>, Error> {
        self.column("time")
    }

    /// Time of the last sample (s); `None` without samples.
    ///
    /// # Errors
    /// Those of reading it.
    pub fn last_time(&self) -> Result<Option<f64>, Error> {
        let samples = self.length(Dimension::Time);
        let last = samples.saturating_sub(1)..samples;
        Ok(self.table_rows(self.dataset("time")?, last)?.values.first().copied())
    }

    /// One column by its name, `angle.coupler` or `energy_kinetic`, in the dataset's unit.
    ///
    /// # Errors
    /// [`Error::Missing`] if there is no such column, or what reading it meets.
    pub fn column(&self, name: &str) -> Result<Vec<f64>, Error> {
        let (dataset, item) = match name.split_once('.') {
            Some((dataset, item)) => (dataset, Some(item)),
            None => (name, None),
        };
        let found = Dataset::find(dataset)
            .and_then(|dataset| Some((dataset, self.item_of(dataset, item)?)));
        match found {
            Some((dataset, item)) => Ok(self.table(dataset.name)?.column(item)),
            None => Err(self.no_column(name)),
        }
    }

    /// Index of a column in its dataset.
    fn item_of(&self, dataset: &Dataset, item: Option<&str>) -> Option<usize> {
        match (dataset.items(), item) {
            (None, None) => Some(0),
            (Some(items), Some(item)) => self.names(items).iter().position(|name| name == item),
            _ => None,
        }
    }

    fn no_column(&self, name: &str) -> Error {
        let columns: Vec<String> =
            DATASETS.iter().flat_map(|dataset| self.columns_of(dataset)).collect();
        Error::Missing {
            path: self.path.clone(),
            what: format!("column {:?}", shortened(name)),
            hint: did_you_mean(name, columns.iter().map(String::as_str)),
        }
    }

    /// A whole dataset by its name.
    ///
    /// # Errors
    /// [`Error::Missing`] if there is no such dataset, or what reading it meets.
    pub fn table(&self, name: &str) -> Result<Table, Error> {
        let dataset = self.dataset(name)?;
        self.table_rows(dataset, 0..self.length(dataset.rows()))
    }

    /// The dataset of this name, if it is in the file.
    ///
    /// # Errors
    /// [`Error::Missing`] if it is not.
    pub fn dataset(&self, name: &str) -> Result<&'static Dataset, Error> {
        let dataset = Dataset::find(name).filter(|_| self.file.link_exists(name));
        dataset.ok_or_else(|| Error::Missing {
            path: self.path.clone(),
            what: format!("dataset \"{name}\""),
            hint: did_you_mean(name, DATASETS.iter().map(|dataset| dataset.name)),
        })
    }

    /// Some rows of a dataset, for those who need not have all of a long file at once.
    ///
    /// # Errors
    /// What reading meets.
    pub fn table_rows(
        &self,
        dataset: &'static Dataset,
        rows: Range<usize>,
    ) -> Result<Table, Error> {
        let width = dataset.items().map_or(1, |items| self.length(items));
        let empty = rows.is_empty() || width == 0;
        let read = |handle: hdf5::Dataset| match (empty, dataset.items()) {
            (true, _) => Ok(Vec::new()),
            (_, None) => Ok(handle.read_slice_1d(s![rows.clone()])?.to_vec()),
            (_, Some(_)) => {
                let values: Array2<f64> = handle.read_slice_2d(s![rows.clone(), ..])?;
                Ok(values.into_raw_vec_and_offset().0)
            }
        };
        let values = self.file.dataset(dataset.name).and_then(read);
        let values =
            values.map_err(|error| self.failed(&format!("read {} of", dataset.name), error))?;
        Ok(Table { dataset, rows: rows.len(), width, values })
    }

    /// A dataset along a dimension that not every result has, such as `reference_digits` along time;
    /// `None` where it is missing.
    ///
    /// # Errors
    /// What reading it meets, or [`Error::Damaged`] if it has not a value for each place.
    pub fn along(&self, dimension: Dimension, name: &str) -> Result<Option<Vec<f64>>, Error> {
        if !self.file.link_exists(name) {
            return Ok(None);
        }
        let read = || self.file.dataset(name)?.read_raw::<f64>();
        let values = read().map_err(|error| self.failed(&format!("read {name} of"), error))?;
        let (found, places) = (values.len(), self.length(dimension));
        if found != places {
            let of = dimension.name();
            return Err(self.damaged(format!("{name} has {found} values, {of} has {places}")));
        }
        Ok(Some(values))
    }

    /// Some samples, as they were observed, but for what is beyond doubles.
    ///
    /// # Errors
    /// What reading meets.
    pub fn observations(&self, rows: Range<usize>) -> Result<Vec<Observation>, Error> {
        let none = Observation {
            bodies: vec![BodyObservation::default(); self.bodies().len()],
            clearances: vec![ClearanceObservation::default(); self.clearances().len()],
            joints: vec![JointObservation::default(); self.joints().len()],
            drive_torques: vec![0.0; self.drives().len()],
            points: vec![PointObservation::default(); self.points().len()],
            memories: vec![0.0; self.memories().len()],
            ..Observation::default()
        };
        let mut all = vec![none; rows.len()];
        let along_samples = DATASETS.iter().filter(|dataset| dataset.rows() == Dimension::Time);
        let of_nothing = |dataset: &Dataset| !self.has(dataset);
        for dataset in along_samples.filter(|dataset| !of_nothing(dataset)) {
            let table = self.table_rows(self.dataset(dataset.name)?, rows.clone())?;
            for (sample, values) in all.iter_mut().zip(table.values.chunks(table.width.max(1))) {
                for (item, value) in values.iter().enumerate() {
                    dataset.put(sample, item, *value);
                }
            }
        }
        Ok(all)
    }

    /// All events.
    pub fn events(&self) -> Result<Vec<Event>, Error> {
        self.entries(Dimension::Event, Event::default(), |source| match source {
            Source::Event(place) => Some(place),
            _ => None,
        })
    }

    /// All contacts.
    pub fn contacts(&self) -> Result<Vec<Contact>, Error> {
        // files of older programs do not have that time
        let none = Contact { peak_penetration_time: f64::NAN, ..Contact::default() };
        self.entries(Dimension::Contact, none, |source| match source {
            Source::Contact(place) => Some(place),
            _ => None,
        })
    }

    /// All local maxima of normal forces.
    pub fn peaks(&self) -> Result<Vec<Peak>, Error> {
        self.entries(Dimension::Peak, Peak::default(), |source| match source {
            Source::Peak(place) => Some(place),
            _ => None,
        })
    }

    /// All entries along a dimension, each `none` with its values put in.
    fn entries<T: Copy>(
        &self,
        dimension: Dimension,
        none: T,
        place_of: impl Fn(Source) -> Option<Place<T>>,
    ) -> Result<Vec<T>, Error> {
        let mut all = vec![none; self.length(dimension)];
        for dataset in &DATASETS {
            let Some(place) = place_of(dataset.source) else { continue };
            if LATER.contains(&dataset.name) && !self.file.link_exists(dataset.name) {
                continue;
            }
            let values = self.table(dataset.name)?.values;
            for (entry, value) in all.iter_mut().zip(values) {
                self.check_value(dataset, value)?;
                (place.put)(entry, value);
            }
        }
        Ok(all)
    }

    /// That an index or a flag is one of those there are.
    fn check_value(&self, dataset: &Dataset, value: f64) -> Result<(), Error> {
        let name = dataset.name;
        let (what, least, count) = match dataset.values {
            Values::Real => return Ok(()),
            // whose it is stands beside it
            Values::Index if name == "event_owner_index" => ("owner", 0.0, i32::MAX as usize),
            Values::Index => {
                let least = if name == "event_clearance" { -1.0 } else { 0.0 };
                ("clearance", least, self.length(Dimension::Clearance))
            }
            Values::Flag(meanings) => {
                let known = meanings.iter().any(|(flag, _)| f64::from(*flag) == value);
                let told = || format!("{name} speaks of a kind {value}, there is none");
                return if known { Ok(()) } else { Err(self.damaged(told())) };
            }
        };
        if value >= least && value < count as f64 {
            return Ok(());
        }
        Err(self.damaged(format!("{name} speaks of a {what} {value}, there are {count}")))
    }

    /// Extremes by revolution; none in files of programs that did not keep them.
    pub fn revolutions(&self) -> Result<Vec<Revolution>, Error> {
        if self.length(Dimension::Revolution) == 0 {
            return Ok(Vec::new());
        }
        let [begin, end] = self.tables(["revolution_begin", "revolution_end"])?;
        let measures = Measures {
            bodies: self.bodies().len(),
            clearances: self.clearances().len(),
            drives: self.drives().len(),
            joints: self.joints().len(),
        };
        let none = Extremum { value: f64::NAN, time: f64::NAN };
        let row = |(begin, end): (&f64, &f64)| Revolution {
            begin: *begin,
            end: *end,
            measures,
            largest: vec![none; measures.len()],
            smallest: vec![none; measures.signed()],
        };
        let mut all: Vec<Revolution> = begin.iter().zip(&end).map(row).collect();
        for dataset in DATASETS.iter().filter(|dataset| self.file.link_exists(dataset.name)) {
            if let Source::Extreme(measure, side, part) = dataset.source {
                self.read_extremes(dataset, (measure, side, part), &mut all)?;
            }
        }
        Ok(all)
    }

    fn read_extremes(
        &self,
        dataset: &'static Dataset,
        (measure, side, part): (Measure, Side, Part),
        all: &mut [Revolution],
    ) -> Result<(), Error> {
        let Table { values, width, .. } = self.table(dataset.name)?;
        for (row, values) in all.iter_mut().zip(values.chunks_exact(width.max(1))) {
            for (place, value) in row.measures.places(measure).zip(values) {
                let extremum = match side {
                    Side::Largest => &mut row.largest[place],
                    Side::Smallest => &mut row.smallest[place],
                };
                match part {
                    Part::Value => extremum.value = *value,
                    Part::Time => extremum.time = *value,
                }
            }
        }
        Ok(())
    }

    /// The values of several datasets of one dimension.
    fn tables<const N: usize>(&self, names: [&str; N]) -> Result<[Vec<f64>; N], Error> {
        let mut tables = [const { Vec::new() }; N];
        for (table, name) in tables.iter_mut().zip(names) {
            *table = self.table(name)?.values;
        }
        Ok(tables)
    }

    fn read_attributes(&self) -> Result<Vec<(String, Attribute)>, Error> {
        let read = || -> hdf5::Result<Vec<(String, Attribute)>> {
            let mut attributes = Vec::new();
            let order = (IndexType::CreationOrder, IterationOrder::Increasing);
            for name in self.file.attr_names_by(order.0, order.1)? {
                if let Some(attribute) = Attribute::read(&self.file, &name)? {
                    attributes.push((name, attribute));
                }
            }
            Ok(attributes)
        };
        read().map_err(|error| self.failed("read the attributes of", error))
    }

    fn check_schema(&self) -> Result<(), Error> {
        let path = self.path.clone();
        match self.attribute("schema_version") {
            Some(Attribute::Integer(version)) if *version > SCHEMA_VERSION => {
                Err(Error::Newer { path, found: *version })
            }
            Some(Attribute::Integer(_)) => Ok(()),
            _ => Err(Error::NotAResult { path, missing: "it has no schema_version".to_owned() }),
        }
    }

    fn read_length(&self, dimension: Dimension) -> Result<usize, Error> {
        let name = dimension.name();
        let may_miss = [Dimension::Revolution, Dimension::Point, Dimension::Memory];
        if may_miss.contains(&dimension) && !self.file.link_exists(name) {
            // a file of a program that did not keep extremes by revolution, no points to observe
            // or nothing that remembers
            return Ok(0);
        }
        let (path, missing) = (self.path.clone(), format!("it has no dimension \"{name}\""));
        match self.file.dataset(name).map(|scale| scale.shape()) {
            Ok(shape) if shape.len() == 1 => Ok(shape[0]),
            _ => Err(Error::NotAResult { path, missing }),
        }
    }

    fn read_names(&self, dimension: Dimension) -> Result<Vec<String>, Error> {
        use Dimension::{Body, Clearance, Drive, Joint, Memory, Point};
        let named = [Body, Joint, Clearance, Drive, Point, Memory];
        if !named.contains(&dimension) || self.length(dimension) == 0 {
            return Ok(Vec::new());
        }
        let meanings = self
            .file
            .dataset(dimension.name())
            .and_then(|scale| Attribute::read(&scale, "flag_meanings"))
            .map_err(|error| self.failed("read the names of", error))?;
        let names: Vec<String> = match meanings {
            Some(Attribute::Text(names)) => names.split(' ').map(str::to_owned).collect(),
            _ => Vec::new(),
        };
        let parted = [Point, Memory].contains(&dimension);
        let is_right = |name: &str| match name.split_once('.') {
            Some((owner, part)) => parted && is_name(owner) && is_name(part),
            None => !parted && is_name(name),
        };
        if let Some((at, name)) = names.iter().enumerate().find(|(_, name)| !is_right(name)) {
            let name = shortened(name);
            return Err(self.damaged(format!("{} {at} has no name but {name:?}", dimension.name())));
        }
        let mut seen = HashSet::new();
        if let Some(name) = names.iter().find(|name| !seen.insert(*name)) {
            return Err(self.damaged(format!("{} has {name:?} twice", dimension.name())));
        }
        if names.len() == self.length(dimension) {
            return Ok(names);
        }
        let (count, name) = (self.length(dimension), dimension.name());
        Err(self.damaged(format!("{name} has {count} items and {} names", names.len())))
    }

    /// Everything lies in the file itself, and is no larger than it can be.
    fn check_members(&self) -> Result<(), Error> {
        let failed = |error| self.failed("read the contents of", error);
        let size = std::fs::metadata(&self.path).map_err(|source| Error::System {
            attempt: "read",
            path: self.path.clone(),
            source,
        })?;
        let mut ration = Ration::new(size.len());
        let mut seen = Vec::new();
        for (name, member) in members(&self.file).map_err(failed)? {
            match member {
                Member::Link => {
                    let rule = "which is not followed";
                    return Err(self.damaged(format!("{name:?} is a link to elsewhere, {rule}")));
                }
                // two names for one dataset claim its bytes once
                Member::Dataset(token) if !seen.contains(&token) => {
                    seen.push(token);
                    let dataset = self.file.dataset(&name).map_err(failed)?;
                    if let Some(why) = ration.refuses(&dataset).map_err(failed)? {
                        return Err(self.damaged(format!("{name:?} {why}")));
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Every dataset that is there has the shape that the dimensions ask for.
    fn check_shapes(&self) -> Result<(), Error> {
        for dataset in DATASETS.iter().filter(|dataset| self.file.link_exists(dataset.name)) {
            let found = self
                .file
                .dataset(dataset.name)
                .map_err(|error| self.failed(&format!("open {} of", dataset.name), error))?
                .shape();
            let expected: Vec<usize> = [dataset.rows()]
                .into_iter()
                .chain(dataset.items())
                .map(|dimension| self.length(dimension))
                .collect();
            // netCDF tools write nothing with no extent at all
            let nothing =
                [&found, &expected].map(|shape| shape.iter().product::<usize>()) == [0; 2];
            if found != expected && !(nothing && found.len() == expected.len()) {
                let name = dataset.name;
                return Err(self.damaged(format!("{name} has shape {found:?}, not {expected:?}")));
            }
        }
        Ok(())
    }

    fn damaged(&self, what: String) -> Error {
        Error::Damaged { path: self.path.clone(), what }
    }

    /// The open file, for the rest of this room.
    pub(super) fn handle(&self) -> &File {
        &self.file
    }

    pub(super) fn failed(&self, attempt: &str, error: hdf5::Error) -> Error {
        let source = LibraryError::from(error);
        Error::Library { attempt: attempt.to_owned(), path: self.path.clone(), source }
    }
}

/// Opens an HDF5 file for reading, or says what else the path is.
fn open_file(path: &Path) -> Result<File, Error> {
    let system = |source| Error::System { attempt: "open", path: path.to_owned(), source };
    let found = std::fs::metadata(path).map_err(system)?;
    if !found.is_file() {
        return Err(Error::NotPlain { path: path.to_owned() });
    }
    std::fs::File::open(path).map_err(system)?;
    if path.to_str().is_none() {
        return Err(system(SystemError::new(ErrorKind::InvalidInput, "its name is not UTF-8")));
    }
    File::open(path).map_err(|error| {
        let path = path.to_owned();
        if error.contains_minor(MinorErrorCode::Truncated) {
            Error::Truncated { path }
        } else if error.contains_minor(MinorErrorCode::NotHdf5) {
            Error::NotHdf5 { path }
        } else {
            Error::Library { attempt: "open".to_owned(), path, source: error.into() }
        }
    })
}
