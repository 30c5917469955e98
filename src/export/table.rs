//! Tables as they are written: columns with names and units, and their cells, some rows at a time.

use super::csv::Csv;
use super::parquet::Parquet;
use super::{Column, Columns, WriteError};
use crate::record::{ResultFile, Values};
use std::path::Path;

/// Rows that are written at a time: a row group of Parquet.
pub(crate) const GROUP: usize = 16 * 4096;

/// Kinds of file that hold tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Comma-separated values.
    Csv,
    /// Apache Parquet.
    Parquet,
}

/// A table that is being written.
pub(crate) enum Table {
    /// Comma-separated values.
    Csv(Csv),
    /// Apache Parquet.
    Parquet(Parquet),
}

impl Table {
    /// Begins a table in an empty file, with more texts for its metadata, if it has some.
    pub fn create(
        kind: Kind,
        path: &Path,
        fields: &[Field],
        texts: Vec<(String, String)>,
    ) -> Result<Self, WriteError> {
        Ok(match kind {
            Kind::Csv => Table::Csv(Csv::create(path, fields).map_err(WriteError::write)?),
            Kind::Parquet => {
                let table = Parquet::create(path, fields, texts);
                Table::Parquet(table.map_err(WriteError::write)?)
            }
        })
    }

    /// Writes some rows, [`GROUP`] at most: the cells of each column.
    pub fn write(&mut self, columns: &[Cells]) -> Result<(), WriteError> {
        match self {
            Table::Csv(table) => table.write(columns).map_err(WriteError::write),
            Table::Parquet(table) => table.write(columns).map_err(WriteError::write),
        }
    }

    /// Ends the table.
    pub fn finish(self) -> Result<(), WriteError> {
        match self {
            Table::Csv(table) => table.finish().map_err(WriteError::write),
            Table::Parquet(table) => table.finish().map_err(WriteError::write),
        }
    }
}

/// Writes a table of a result file to an empty file.
pub(super) fn write(
    kind: Kind,
    file: &ResultFile,
    columns: &Columns,
    path: &Path,
) -> Result<(), WriteError> {
    let fields: Vec<Field> = columns.columns.iter().map(field).collect();
    let texts = file.attributes().iter();
    let texts = texts.map(|(name, value)| (name.clone(), value.to_string())).collect();
    let mut table = Table::create(kind, path, &fields, texts)?;
    for rows in columns.blocks(GROUP) {
        let values = columns.read(file, rows)?;
        let cells =
            columns.columns.iter().zip(values).map(|(column, values)| cells(column, values));
        table.write(&cells.collect::<Vec<_>>())?;
    }
    table.finish()
}

fn field(column: &Column) -> Field {
    let holds = match (&column.words, column.values) {
        (Some(_), _) => Holds::Text,
        (None, Values::Real) => Holds::Real,
        (None, Values::Index) => Holds::Index,
        (None, Values::Flag(_)) => Holds::Flag,
    };
    Field {
        name: column.name.clone(),
        unit: column.unit.to_owned(),
        long_name: column.long_name.to_owned(),
        holds,
    }
}

fn cells(column: &Column, values: Vec<f64>) -> Cells {
    if column.words.is_some() {
        let word = |value: &f64| column.word(*value).unwrap_or("").to_owned();
        Cells::Text(values.iter().map(word).collect())
    } else if column.values == Values::Real {
        Cells::Real(values)
    } else {
        Cells::Whole(values.iter().map(|value| *value as i32).collect())
    }
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Field {
    /// Its name.
    pub name: String,
    /// Its unit, as in result files; `1` where there is none.
    pub unit: String,
    /// What it is, in words.
    pub long_name: String,
    /// What its cells are.
    pub holds: Holds,
}

/// What the cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Holds {
    /// Doubles, no two of them alike.
    Real,
    /// Doubles that many rows share.
    Repeated,
    /// Whole numbers.
    Index,
    /// Small whole numbers.
    Flag,
    /// Texts.
    Text,
}

/// Cells of some rows of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Cells {
    /// Of [`Holds::Real`] or [`Holds::Repeated`].
    Real(Vec<f64>),
    /// Of [`Holds::Index`] or [`Holds::Flag`].
    Whole(Vec<i32>),
    /// Of [`Holds::Text`].
    Text(Vec<String>),
}

impl Cells {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Cells::Real(values) => values.len(),
            Cells::Whole(values) => values.len(),
            Cells::Text(words) => words.len(),
        }
    }

    /// Forgets them.
    pub fn clear(&mut self) {
        match self {
            Cells::Real(values) => values.clear(),
            Cells::Whole(values) => values.clear(),
            Cells::Text(words) => words.clear(),
        }
    }
}
