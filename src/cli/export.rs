//! `freeplay export FILE --to FORMAT -o OUT`

use super::{Failure, signals};
use crate::export::{self, Error, Format, TableName};
use crate::record::ResultFile;
use clap::ValueEnum;
use std::path::PathBuf;

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Result file (HDF5).
    file: PathBuf,
    /// Format to write.
    #[arg(long, value_enum)]
    to: To,
    /// File to write; for openmbv NAME.ombvx, beside which NAME.ombvh5 is written.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Table to write as CSV or Parquet.
    #[arg(long, value_enum, default_value = "samples")]
    table: Table,
    /// Replace the output if it exists.
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum To {
    /// Comma-separated values, one line of column names.
    Csv,
    /// Apache Parquet, units in its metadata.
    Parquet,
    /// Scene and motion for the viewer OpenMBV.
    Openmbv,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Table {
    /// Everything over time.
    Samples,
    /// Begins and ends of contacts, kinks of friction, tension.
    Events,
    /// Contacts with impact rate, peak force, dissipated energy.
    Contacts,
    /// Every local maximum of a contact force.
    Peaks,
}

/// Writes a result file in another format.
pub(super) fn export(arguments: &Arguments) -> Result<(), Failure> {
    signals::end_at_once()?;
    let file = ResultFile::open(&arguments.file).map_err(Failure::input)?;
    let (format, things) = match arguments.to {
        To::Csv => (Format::Csv, "columns"),
        To::Parquet => (Format::Parquet, "columns"),
        To::Openmbv => (Format::OpenMbv, "moving things"),
    };
    let table = match arguments.table {
        Table::Samples => TableName::Samples,
        Table::Events => TableName::Events,
        Table::Contacts => TableName::Contacts,
        Table::Peaks => TableName::Peaks,
    };
    let written = export::export(&file, format, table, &arguments.output, arguments.force);
    let written = written.map_err(|error| match error {
        Error::Output(_) | Error::Write { .. } => Failure::output(error),
        Error::Read(_) | Error::NoShapes { .. } | Error::Ending { .. } => Failure::input(error),
    })?;
    let paths: Vec<String> = written.paths.iter().map(|path| path.display().to_string()).collect();
    let (rows, columns) = (written.rows, written.columns);
    super::print(format_args!("{}: {rows} rows, {columns} {things}\n", paths.join(", ")))
}
