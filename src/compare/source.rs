//! The two files: results of ours, or tables of other programs.

use super::Error;
use super::foreign::{ForeignColumn, ForeignTable};
use super::mapping::Mapping;
use super::quantity::Column;
use super::unit::Unit;
use crate::case::{Case, Changes};
use crate::model::one_line;
use crate::record::{self, ResultFile};
use std::path::Path;

/// A file to be compared.
#[derive(Debug)]
pub enum Source {
    /// A result of ours.
    Result(Box<ResultFile>),
    /// A table of another program.
    Foreign(ForeignTable),
}

impl Source {
    /// Opens a file, whatever it is.
    ///
    /// # Errors
    /// It cannot be read or is of no kind known.
    pub fn open(path: &Path) -> Result<Source, Error> {
        match ResultFile::open(path) {
            Ok(file) => Ok(Source::Result(Box::new(file))),
            Err(record::Error::NotHdf5 { .. } | record::Error::NotAResult { .. }) => {
                ForeignTable::read(path).map(Source::Foreign)
            }
            Err(error) => Err(Error::Result(error)),
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        match self {
            Source::Result(file) => file.path(),
            Source::Foreign(table) => &table.path,
        }
    }

    /// The result, if it is one of ours.
    pub fn result(&self) -> Option<&ResultFile> {
        match self {
            Source::Result(file) => Some(file),
            Source::Foreign(_) => None,
        }
    }

    /// What it is, for people.
    pub fn description(&self) -> String {
        match self {
            Source::Foreign(table) => table.format.name().to_owned(),
            Source::Result(file) => {
                let text = |name| one_line(file.text(name).unwrap_or("?"));
                let mut words = format!("freeplay result of case {}", text("case_name"));
                match file.number("reference_tolerance_tight") {
                    Some(tolerance) => {
                        words += &format!(", in 71 digits, tolerance {tolerance:e}");
                    }
                    None => {
                        let engine = text("engine");
                        let tolerance = file.number("relative_tolerance").unwrap_or(f64::NAN);
                        words += &format!(", engine {engine}, relative tolerance {tolerance:e}");
                    }
                }
                if !file.is_complete() {
                    words += &format!("; the run is {}", text("run_status"));
                }
                words
            }
        }
    }
}

/// Reads the case that a result holds, with changes.
pub fn case_in(file: &ResultFile, changes: &Changes) -> Result<Case, Error> {
    let Some(text) = file.text("case_toml") else {
        return Err(Error::NoCase { path: file.path().to_owned() });
    };
    Case::from_text(file.path(), text, changes)
        .map_err(|source| Error::Case { path: file.path().to_owned(), source: Box::new(source) })
}

/// A trajectory: its times and the columns that are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Sample times (s), never going back.
    pub times: Vec<f64>,
    /// What the columns are.
    pub columns: Vec<Column>,
    /// Values of each column, in SI.
    pub values: Vec<Vec<f64>>,
}

impl Trajectory {
    /// The columns of a result.
    ///
    /// # Errors
    /// What reading meets.
    pub fn of_result(file: &ResultFile, columns: &[Column]) -> Result<Trajectory, Error> {
        let mut values = Vec::with_capacity(columns.len());
        let mut table: Option<record::Table> = None;
        for column in columns {
            let name = column.dataset.name;
            let read = match table.take().filter(|table| table.dataset.name == name) {
                Some(table) => table,
                None => file.table(name)?,
            };
            values.push(read.column(column.item));
            table = Some(read);
        }
        let trajectory = Trajectory { times: file.times()?, columns: columns.to_vec(), values };
        trajectory.check_times(file.path())?;
        Ok(trajectory)
    }

    /// The columns of a table that are mapped.
    ///
    /// # Errors
    /// Words among the numbers; times that are none or go back.
    pub fn of_table(table: &ForeignTable, mapping: &Mapping) -> Result<Trajectory, Error> {
        let read = |index: usize, unit: Option<Unit>| numbers(table, &table.columns[index], unit);
        let times = read(mapping.time, mapping.time_unit)?;
        let mapped = mapping.columns.iter();
        let values: Result<Vec<Vec<f64>>, Error> =
            mapped.clone().map(|mapped| read(mapped.theirs, mapped.unit)).collect();
        let columns = mapped.map(|mapped| mapped.ours).collect();
        let trajectory = Trajectory { times, columns, values: values? };
        trajectory.check_times(&table.path)?;
        Ok(trajectory)
    }

    /// The same with only these columns.
    pub fn with_columns(self, columns: &[Column]) -> Trajectory {
        let (columns, values) = self
            .columns
            .into_iter()
            .zip(self.values)
            .filter(|(column, _)| columns.contains(column))
            .unzip();
        Trajectory { times: self.times, columns, values }
    }

    fn check_times(&self, path: &Path) -> Result<(), Error> {
        let path = || path.to_owned();
        if self.times.is_empty() {
            return Err(Error::Empty { path: path() });
        }
        if let Some(index) = self.times.iter().position(|time| !time.is_finite()) {
            let value = self.times[index];
            return Err(Error::NotATime { path: path(), number: index + 1, value });
        }
        match self.times.windows(2).find(|pair| pair[1] < pair[0]) {
            Some(pair) => Err(Error::Unsorted { path: path(), before: pair[0], after: pair[1] }),
            None => Ok(()),
        }
    }
}

/// The numbers of a column, in SI.
fn numbers(
    table: &ForeignTable,
    column: &ForeignColumn,
    unit: Option<Unit>,
) -> Result<Vec<f64>, Error> {
    if let Some(misplaced) = &column.text {
        return Err(Error::NotANumber {
            path: table.path.clone(),
            line: misplaced.line,
            column: column.name.clone(),
            text: misplaced.text.clone(),
        });
    }
    let factor = unit.map_or(1.0, |unit| unit.factor);
    Ok(column.values.iter().map(|value| value * factor).collect())
}
