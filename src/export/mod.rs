//! Result files for tools that do not read HDF5: one file a format.

mod columns;
mod csv;
mod openmbv;
mod parquet;
mod table;

use crate::post;
use crate::record::{self, Draft, ResultFile};
use std::error::Error as StdError;
use std::path::{Path, PathBuf};

pub use columns::{Column, Columns, TableName};
pub(crate) use table::{Cells, Field, GROUP, Holds, Kind, Table};

/// Formats that a result file can be written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values.
    Csv,
    /// Apache Parquet.
    Parquet,
    /// A scene and its motion for the viewer OpenMBV.
    OpenMbv,
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The files.
    pub paths: Vec<PathBuf>,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns of a table; of moving things in a scene.
    pub columns: usize,
}

/// Why a result file could not be written in another format.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The result file could not be read.
    #[error(transparent)]
    Read(#[from] record::Error),
    /// The output is there already, or cannot be made.
    #[error(transparent)]
    Output(record::Error),
    /// Writing failed.
    #[error("cannot write {}", path.display())]
    Write {
        /// The output.
        path: PathBuf,
        /// Why it failed.
        source: Box<dyn StdError + Send + Sync>,
    },
    /// The shapes of the bodies stand in the case, which the file lacks or this program cannot
    /// read.
    #[error("the bodies in {} cannot be drawn", path.display())]
    NoShapes {
        /// The result file.
        path: PathBuf,
        /// What is wrong with its case.
        source: post::Error,
    },
    /// OpenMBV finds the motion by the ending of the scene's name.
    #[error("{} must end in .ombvx, by which OpenMBV finds the motion beside it", path.display())]
    Ending {
        /// The output asked for.
        path: PathBuf,
    },
}

/// Writes a result file in another format; `table` is of no matter to OpenMBV. With `force` an
/// old output is replaced.
///
/// # Errors
/// See [`Error`]; what stood under the output's name is then still there.
pub fn export(
    file: &ResultFile,
    format: Format,
    table: TableName,
    output: &Path,
    force: bool,
) -> Result<Written, Error> {
    let columns = Columns::of(file, table);
    match format {
        Format::Csv => publish(file, output, force, &columns, Kind::Csv),
        Format::Parquet => publish(file, output, force, &columns, Kind::Parquet),
        Format::OpenMbv => openmbv::write(file, output, force),
    }
}

/// Writes a table under a temporary name, then publishes it.
fn publish(
    file: &ResultFile,
    output: &Path,
    force: bool,
    columns: &Columns,
    kind: Kind,
) -> Result<Written, Error> {
    let draft = Draft::create_from(output, force, &[file.path()]).map_err(Error::Output)?;
    table::write(kind, file, columns, draft.temporary()).map_err(|error| error.at(output))?;
    let path = draft.publish().map_err(Error::Output)?;
    Ok(Written { paths: vec![path], rows: columns.rows, columns: columns.columns.len() })
}

/// What a format meets while it writes.
pub(crate) enum WriteError {
    Read(record::Error),
    Write(Box<dyn StdError + Send + Sync>),
}

impl WriteError {
    pub fn at(self, output: &Path) -> Error {
        match self {
            WriteError::Read(error) => Error::Read(error),
            WriteError::Write(source) => Error::Write { path: output.to_owned(), source },
        }
    }

    fn write(error: impl StdError + Send + Sync + 'static) -> Self {
        WriteError::Write(Box::new(error))
    }
}

impl From<record::Error> for WriteError {
    fn from(error: record::Error) -> Self {
        WriteError::Read(error)
    }
}
