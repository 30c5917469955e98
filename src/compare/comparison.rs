//! Making a comparison of two files.

use super::coverage::{Coverage, free_columns};
use super::event::EventComparison;
use super::foreign::ForeignTable;
use super::mapping::{How, Map, Mapped, Mapping};
use super::quantity::{Column, Parts, Quantity};
use super::reference::{Reference, Way, index_of, pick};
use super::series::{Aligned, Certificate, Series};
use super::source::{Source, Trajectory, case_in};
use super::{Error, mechanism, note, scale};
use crate::case::{Case, Changes};
use crate::certify::Horizon;
use crate::digits::{Scales, Sizes};
use crate::mechanism::Mechanism;
use crate::record::{self, DATASETS, Dimension, ResultFile};
use crate::run::Watcher;
use crate::simulate::assemble;
use std::path::{Path, PathBuf};

/// Times that differ by no more than this, relative, are one where files must share their times.
const SAME_TIME: f64 = 4.0 * f64::EPSILON;

/// What is to be compared, and how.
#[derive(Debug, Clone, Copy, Default)]
pub struct Request<'a> {
    /// Last time looked at (s); else that of the first file.
    pub until: Option<f64>,
    /// Whether forces and torques are looked at, and count.
    pub forces: bool,
    /// Whether only times that both files hold are looked at, and nothing is run again.
    pub common_times: bool,
    /// Which of their columns are which of ours.
    pub maps: &'a [Map],
}

/// One of the two files.
#[derive(Debug, Clone, PartialEq)]
pub struct Side {
    /// The file.
    pub path: PathBuf,
    /// What it is, for people.
    pub description: String,
    /// Times of its first and last sample (s).
    pub span: [f64; 2],
    /// For another program's table: its columns that are compared.
    pub mapping: Vec<MappedName>,
    /// Names of its columns that are not.
    pub unused: Vec<String>,
    /// How far it is true, where it tells.
    pub horizon: Option<Horizon>,
}

/// A column of another program and what it is of ours.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MappedName {
    /// Their name.
    pub theirs: String,
    /// Ours.
    pub ours: String,
    /// How that is known.
    pub how: How,
    /// The unit that it was converted from.
    pub unit: Option<&'static str>,
}

/// In what two files are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Identity {
    /// They differ.
    None,
    /// Every number that was compared is the same.
    Compared,
    /// Every number of two results is the same.
    Everything,
}

/// A trajectory held against a reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The file that is judged.
    pub theirs: Side,
    /// The file that it is judged by.
    pub reference: Side,
    /// Names of the mechanism's parts.
    pub parts: Parts,
    /// The columns compared; grades give indices into this.
    pub columns: Vec<Column>,
    /// What errors are measured with.
    pub scales: Scales,
    /// How the reference came to have values at the times of the other.
    pub way: Way,
    /// How much of the reference was looked at.
    pub coverage: Coverage,
    /// Samples of the first file that have no like in the reference, and were left out.
    pub left_out: usize,
    /// Last time asked for (s).
    pub until: Option<f64>,
    /// Digits over time.
    pub series: Series,
    /// Events, where both have them.
    pub events: Option<EventComparison>,
    /// In what the files are the same.
    pub identity: Identity,
    /// What else should be known.
    pub notes: Vec<String>,
    /// Time of the last sample that the reference has up to the time asked for (s).
    pub(super) last_wanted: f64,
    /// The numbers compared.
    pub(super) values: Aligned,
    pub(super) certificate: Option<Certificate>,
}

impl Comparison {
    /// Holds a file against a reference.
    ///
    /// # Errors
    /// Either cannot be read; they have nothing to compare; the reference cannot be had at the
    /// times of the first. See [`Error`].
    pub fn new(
        theirs: &Path,
        reference: &Path,
        request: &Request<'_>,
        watch: Watcher<'_>,
    ) -> Result<Comparison, Error> {
        let files = [Source::open(theirs)?, Source::open(reference)?];
        let subject = Subject::of(&files)?;
        let mut compared = subject.parts.compared(request.forces);
        if let [Source::Result(theirs), Source::Result(reference)] = &files
            && theirs.points() != reference.points()
        {
            // what one of them observes alone has no like
            compared.retain(|column| column.dataset.items() != Some(Dimension::Point));
        }
        let [theirs_maps, reference_maps] = share_maps(&files, request.maps)?;
        let theirs = Read::new(&files[0], &subject.parts, &compared, theirs_maps)?;
        let reference = Read::new(&files[1], &subject.parts, &compared, reference_maps)?;
        let scales = subject.scales(&reference);
        let common = common(&theirs, &reference, &subject.parts)?;
        let (theirs, reference) = (theirs.with_columns(&common), reference.with_columns(&common));
        let pairing = Pairing { theirs: &theirs, reference: &reference, request };
        let Paired { values, way, left_out } = pairing.pair(&scales, &subject.parts, watch)?;
        let certificate = reference.result().map(Certificate::of).transpose()?.flatten();
        let columns = free_columns(&common, &subject.parts, request.forces, &subject.driven);
        let until = request.until.unwrap_or(reference.span()[1]);
        let times = [&values.times[..], &reference.trajectory.times[..]];
        let coverage = Coverage::new(times, until, columns);
        let foreign = theirs.result().is_none() || reference.result().is_none();
        let series = values.grade(&scales, certificate.as_ref(), foreign);
        let end = values.times.last().copied().unwrap_or_default();
        let known = &reference.trajectory.times;
        let wanted = request
            .until
            .map_or(known.len(), |until| known.partition_point(|time| *time <= later(until)));
        let (events, identity) = match (theirs.result(), reference.result()) {
            (Some(a), Some(b)) => {
                let identity = identity(a, b, &values)?;
                (Some(EventComparison::new(a, b, request.until.unwrap_or(end))?), identity)
            }
            _ => (None, identity_of(&values)),
        };
        let mut comparison = Comparison {
            notes: note::notes(&theirs, &reference, &values, &series, &subject.parts),
            theirs: theirs.side(&subject.parts),
            reference: reference.side(&subject.parts),
            parts: subject.parts,
            columns: common,
            scales,
            way,
            coverage,
            left_out,
            until: request.until,
            series,
            events,
            identity,
            last_wanted: wanted.checked_sub(1).map_or(f64::INFINITY, |index| known[index]),
            values,
            certificate,
        };
        comparison.notes.extend(comparison.coverage_note());
        Ok(comparison)
    }

    /// Name of a column, by its index in [`columns`](Comparison::columns).
    pub fn column_name(&self, index: usize) -> String {
        self.parts.name(&self.columns[index])
    }

    /// Fewest digits to which the reference is certified over the samples compared; `None` where
    /// it carries no certificate.
    pub fn certified_digits(&self) -> Option<f64> {
        let certificate = self.certificate.as_ref()?;
        let at = |time: &f64| certificate.at(Quantity::Angle, *time);
        Some(self.series.times.iter().map(at).fold(f64::INFINITY, f64::min))
    }
}

/// The mechanism that two files are of.
struct Subject {
    parts: Parts,
    case: Case,
    sizes: Sizes,
    /// Of each body whether drives prescribe its motion.
    driven: Vec<bool>,
}

impl Subject {
    /// # Errors
    /// Neither file is a result, or they are of two mechanisms.
    fn of(files: &[Source; 2]) -> Result<Subject, Error> {
        let read = |file: &ResultFile| -> Result<Subject, Error> {
            let (parts, case) = (Parts::of(file), case_in(file, &Changes::default())?);
            let mechanism: Mechanism<f64> = assemble(&case).map_err(|source| Error::Case {
                path: file.path().to_owned(),
                source: Box::new(source),
            })?;
            let driven: Vec<bool> =
                (0..parts.0.bodies.len()).map(|body| mechanism.is_driven(body)).collect();
            if mechanism.model().names().clearances == parts.0.clearances {
                return Ok(Subject { parts, case, sizes: Sizes::of(&mechanism), driven });
            }
            let what = "its case has other clearances than it names".to_owned();
            Err(record::Error::Damaged { path: file.path().to_owned(), what }.into())
        };
        let [theirs, reference] = files;
        let paths = || (theirs.path().to_owned(), reference.path().to_owned());
        match (theirs.result(), reference.result()) {
            (Some(a), Some(b)) => {
                let (a, b) = (read(a)?, read(b)?);
                match mechanism::difference((&a.parts, &a.case), (&b.parts, &b.case)) {
                    None => Ok(b),
                    Some(difference) => {
                        let (theirs, reference) = paths();
                        Err(Error::OtherMechanism { theirs, reference, difference })
                    }
                }
            }
            (Some(file), None) | (None, Some(file)) => read(file),
            (None, None) => {
                let (theirs, reference) = paths();
                Err(Error::NoMechanism { theirs, reference })
            }
        }
    }

    /// The scales that a reference gives.
    fn scales(&self, reference: &Read<'_>) -> Scales {
        let Trajectory { columns, values, .. } = &reference.trajectory;
        let scales = scale::measure(columns, values, &self.sizes);
        match reference.result() {
            Some(file) => scale::carried(scales, file),
            None => scales,
        }
    }
}

/// The maps for either file: they are for the first unless that is a result.
fn share_maps<'a>(files: &[Source; 2], maps: &'a [Map]) -> Result<[&'a [Map]; 2], Error> {
    match files {
        [Source::Foreign(_), _] => Ok([maps, &[]]),
        [Source::Result(_), Source::Foreign(_)] => Ok([&[], maps]),
        _ if maps.is_empty() => Ok([&[], &[]]),
        _ => Err(Error::NothingToMap),
    }
}

/// A file with its columns read.
pub(super) struct Read<'a> {
    pub source: &'a Source,
    pub mapping: Option<Mapping>,
    pub trajectory: Trajectory,
}

impl<'a> Read<'a> {
    fn new(
        source: &'a Source,
        parts: &Parts,
        compared: &[Column],
        maps: &[Map],
    ) -> Result<Self, Error> {
        let (mapping, trajectory) = match source {
            Source::Result(file) => (None, Trajectory::of_result(file, compared)?),
            Source::Foreign(table) => {
                let mapping = Mapping::new(table, parts, compared, maps)?;
                let trajectory = Trajectory::of_table(table, &mapping)?;
                (Some(mapping), trajectory)
            }
        };
        Ok(Read { source, mapping, trajectory })
    }

    fn with_columns(self, columns: &[Column]) -> Self {
        let mapping = self.mapping.map(|mut mapping| {
            mapping.keep(columns);
            mapping
        });
        Read { mapping, trajectory: self.trajectory.with_columns(columns), ..self }
    }

    fn result(&self) -> Option<&'a ResultFile> {
        self.source.result()
    }

    /// How far a result is true, where it tells.
    pub fn horizon(&self) -> Option<Horizon> {
        Horizon::of(self.result()?).ok().flatten()
    }

    /// The table of another program and how it is mapped.
    pub fn foreign(&self) -> Option<(&'a ForeignTable, &Mapping)> {
        match (self.source, &self.mapping) {
            (Source::Foreign(table), Some(mapping)) => Some((table, mapping)),
            _ => None,
        }
    }

    pub fn path(&self) -> &'a Path {
        self.source.path()
    }

    pub fn span(&self) -> [f64; 2] {
        let times = &self.trajectory.times;
        [times[0], times[times.len() - 1]]
    }

    fn side(&self, parts: &Parts) -> Side {
        let (mut mapping, mut unused) = (Vec::new(), Vec::new());
        if let Some((table, mapped)) = self.foreign() {
            let name = |index: usize| table.columns[index].name.clone();
            let tell = |m: &Mapped| MappedName {
                theirs: name(m.theirs),
                ours: parts.name(&m.ours),
                how: m.how,
                unit: m.unit.map(|unit| unit.text),
            };
            mapping = mapped.columns.iter().map(tell).collect();
            unused = mapped.unused.iter().map(|index| name(*index)).collect();
        }
        Side {
            path: self.path().to_owned(),
            description: self.source.description(),
            span: self.span(),
            mapping,
            unused,
            horizon: self.horizon(),
        }
    }
}

/// The columns that both have, in the order of the quantities.
fn common(theirs: &Read<'_>, reference: &Read<'_>, parts: &Parts) -> Result<Vec<Column>, Error> {
    let (a, b) = (&theirs.trajectory.columns, &reference.trajectory.columns);
    let common: Vec<Column> = a.iter().filter(|column| b.contains(column)).copied().collect();
    if !common.is_empty() {
        return Ok(common);
    }
    let foreign = theirs.foreign().or(reference.foreign());
    Err(Error::NothingInCommon {
        path: foreign.map_or(theirs.path(), |(table, _)| &table.path).to_owned(),
        columns: foreign.map_or(String::new(), |(table, _)| table.names()),
        ours: parts.names_of(b),
        hints: String::new(),
    })
}

/// Two trajectories whose samples are to be paired.
struct Pairing<'a> {
    theirs: &'a Read<'a>,
    reference: &'a Read<'a>,
    request: &'a Request<'a>,
}

/// Samples paired.
struct Paired {
    values: Aligned,
    way: Way,
    left_out: usize,
}

impl Pairing<'_> {
    fn pair(&self, scales: &Scales, parts: &Parts, watch: Watcher<'_>) -> Result<Paired, Error> {
        let rows = self.rows()?;
        match self.reference.result() {
            Some(file) if !self.request.common_times => {
                self.check_span(&rows)?;
                let asked = Reference {
                    file,
                    stored: &self.reference.trajectory,
                    scales,
                    parts,
                    theirs: self.theirs.path(),
                };
                let their_times: Vec<f64> =
                    rows.iter().map(|row| self.theirs.trajectory.times[*row]).collect();
                // scripts that restart at events write their times twice
                let mut times = their_times.clone();
                times.dedup();
                let (values, way) = asked.at(&times, watch)?;
                let back: Vec<usize> =
                    their_times.iter().filter_map(|time| index_of(&times, *time)).collect();
                let reference = pick(&values, &back);
                Ok(Paired { values: self.aligned(&rows, reference), way, left_out: 0 })
            }
            _ => self.pair_common(&rows),
        }
    }

    /// Rows of the first file up to the last time asked for.
    fn rows(&self) -> Result<Vec<usize>, Error> {
        let times = &self.theirs.trajectory.times;
        let [_, last] = self.reference.span();
        let Some(until) = self.request.until else { return Ok((0..times.len()).collect()) };
        if until > later(last) {
            let reference = self.reference.path().to_owned();
            return Err(Error::ReferenceEnds { reference, last, until });
        }
        let rows: Vec<usize> = (0..times.partition_point(|time| *time <= later(until))).collect();
        if rows.is_empty() {
            return Err(Error::NoSamples { path: self.theirs.path().to_owned(), until });
        }
        Ok(rows)
    }

    /// No row lies outside the reference.
    fn check_span(&self, rows: &[usize]) -> Result<(), Error> {
        let [first, last] = self.reference.span();
        let times = rows.iter().map(|row| self.theirs.trajectory.times[*row]);
        let Some(time) = times.clone().find(|time| !(first..=last).contains(time)) else {
            return Ok(());
        };
        let some_within = times.clone().any(|time| (first..=last).contains(&time));
        let hint = match time > last && some_within {
            true => format!("; --until {last} looks at what both have"),
            false => String::new(),
        };
        let (theirs, reference) = (self.theirs.path().to_owned(), self.reference.path().to_owned());
        Err(Error::Outside { theirs, reference, time, first, last, hint })
    }

    /// Pairs only samples whose times both files hold.
    fn pair_common(&self, rows: &[usize]) -> Result<Paired, Error> {
        let known = &self.reference.trajectory.times;
        let same = |row: &usize| {
            let time = self.theirs.trajectory.times[*row];
            index_of(known, time).or_else(|| {
                let behind = known.partition_point(|known| *known < time);
                let near = [behind.checked_sub(1), Some(behind)].into_iter().flatten();
                let is_same = |index: &usize| {
                    (known.get(*index)? - time).abs().le(&(SAME_TIME * time.abs())).then_some(())
                };
                near.into_iter().find(|index| is_same(index).is_some())
            })
        };
        let pairs: Vec<(usize, usize)> =
            rows.iter().filter_map(|row| Some((*row, same(row)?))).collect();
        if pairs.is_empty() {
            return Err(Error::NoCommonTimes {
                theirs: self.theirs.path().to_owned(),
                reference: self.reference.path().to_owned(),
            });
        }
        let left_out = rows.len() - pairs.len();
        let (rows, indices): (Vec<usize>, Vec<usize>) = pairs.into_iter().unzip();
        let reference = pick(&self.reference.trajectory.values, &indices);
        Ok(Paired { values: self.aligned(&rows, reference), way: Way::CommonTimes, left_out })
    }

    fn aligned(&self, rows: &[usize], reference: Vec<Vec<f64>>) -> Aligned {
        let Trajectory { times, columns, values } = &self.theirs.trajectory;
        Aligned {
            times: rows.iter().map(|row| times[*row]).collect(),
            columns: columns.clone(),
            theirs: pick(values, rows),
            reference,
        }
    }
}

/// A time, and those that only rounding makes later.
pub(super) fn later(time: f64) -> f64 {
    time + SAME_TIME * time.abs()
}

fn identity_of(values: &Aligned) -> Identity {
    if values.is_identical() { Identity::Compared } else { Identity::None }
}

/// In what two results are the same. The end of a contact that is open is no number and the same
/// in both.
fn identity(a: &ResultFile, b: &ResultFile, values: &Aligned) -> Result<Identity, Error> {
    let found = identity_of(values);
    if found == Identity::None {
        return Ok(found);
    }
    for dataset in &DATASETS {
        // files of older programs do not have all of them
        let has = |file: &ResultFile| file.dataset(dataset.name).is_ok();
        match (has(a), has(b)) {
            (true, true) => {}
            (false, false) => continue,
            _ => return Ok(found),
        }
        let (a, b) = (a.table(dataset.name)?.values, b.table(dataset.name)?.values);
        let open = |a: f64, b: f64| dataset.name == "contact_end" && a.is_nan() && b.is_nan();
        let same = |(a, b): (&f64, &f64)| a == b || open(*a, *b);
        if a.len() != b.len() || !a.iter().zip(&b).all(same) {
            return Ok(found);
        }
    }
    Ok(Identity::Everything)
}
