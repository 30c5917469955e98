//! `freeplay info FILE`

use super::Failure;
use crate::record::{Overview, ResultFile};
use std::path::PathBuf;

/// Arguments of `info`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Result file (HDF5).
    file: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Says what a result file holds and how it was made.
pub(super) fn info(arguments: &Arguments) -> Result<(), Failure> {
    let overview = ResultFile::open(&arguments.file).and_then(|file| Overview::of(&file));
    let overview = overview.map_err(Failure::input)?;
    match arguments.json {
        true => super::print_json(format_args!("{:#}\n", overview.to_json())),
        false => super::print(overview),
    }
}
