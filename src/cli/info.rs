//! `freeplay info FILE`

use super::Failure;
use crate::record::{Overview, ResultFile};
use std::path::PathBuf;

/// Arguments of `info`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Result file (HDF5).
    file: PathBuf,
}

/// Says what a result file holds and how it was made.
pub(super) fn info(arguments: &Arguments) -> Result<(), Failure> {
    let overview = ResultFile::open(&arguments.file).and_then(|file| Overview::of(&file));
    super::print(overview.map_err(Failure::input)?)
}
