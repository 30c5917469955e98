//! `freeplay report FILE…`

use super::plot::study_folder;
use super::{Failure, signals};
use crate::record::ResultFile;
use crate::report::{Report, StudyPage};
use crate::study::Recorded;
use std::path::{Path, PathBuf};

/// Arguments of `report`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Result files (HDF5): one run, or several to be compared. Or the folder of a study.
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Page to write (HTML).
    #[arg(short, long, value_name = "PAGE", default_value = "report.html")]
    output: PathBuf,
    /// What a run is called; once for each file, in their order.
    #[arg(long, value_name = "NAME")]
    label: Vec<String>,
    /// Replace the output if it exists.
    #[arg(long)]
    force: bool,
}

/// Writes a page on one or several runs.
pub(super) fn report(arguments: &Arguments) -> Result<(), Failure> {
    signals::end_at_once()?;
    if let Some(folder) = study_folder(&arguments.files).map_err(Failure::input)? {
        return report_study(arguments, folder);
    }
    let files: Vec<ResultFile> = arguments
        .files
        .iter()
        .map(|path| ResultFile::open(path))
        .collect::<Result<_, _>>()
        .map_err(Failure::input)?;
    let report = Report::new(&files, &arguments.label).map_err(Failure::input)?;
    report.write(&arguments.output, arguments.force).map_err(Failure::output)?;
    let runs = if files.len() == 1 { "1 run".to_owned() } else { format!("{} runs", files.len()) };
    let size = report.html().len() as f64 / 1e6;
    super::print(format_args!("{}: {runs}, {size:.2} MB\n", arguments.output.display()))
}

/// Writes the page of a study.
fn report_study(arguments: &Arguments, folder: &Path) -> Result<(), Failure> {
    let recorded = Recorded::open(folder).map_err(Failure::input)?;
    let page = StudyPage::new(&recorded, folder).map_err(Failure::input)?;
    page.write(&arguments.output, arguments.force).map_err(Failure::output)?;
    let (runs, size) = (recorded.study.runs, page.html().len() as f64 / 1e6);
    super::print(format_args!(
        "{}: a study of {runs} runs, {size:.2} MB\n",
        arguments.output.display()
    ))
}
