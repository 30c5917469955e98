//! `freeplay summary FILE`

use super::Failure;
use crate::post::Summary;
use crate::record::ResultFile;
use std::path::PathBuf;

/// Arguments of `summary`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Result file (HDF5).
    file: PathBuf,
    /// Compare with this result file, not with the ideal mechanism of the same case.
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Says what a result file shows: peaks, ratios to the ideal mechanism, contacts, energy balance.
pub(super) fn summary(arguments: &Arguments) -> Result<(), Failure> {
    let file = ResultFile::open(&arguments.file).map_err(Failure::input)?;
    let against = arguments.against.as_deref().map(ResultFile::open);
    let against = against.transpose().map_err(Failure::input)?;
    let summary = Summary::of(&file, against.as_ref()).map_err(Failure::input)?;
    if let Err(error) = &summary.reference {
        super::say(format_args!(
            "note: no ideal run of this case: {}",
            super::chain(error.as_ref())
        ));
    }
    match arguments.json {
        true => super::print_json(format_args!("{:#}\n", summary.to_json())),
        false => super::print(&summary),
    }
}
