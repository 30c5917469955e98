//! The report: one page, made for people, that needs no network and opens from a disk.
//!
//! It holds what was run, a summary, charts, and the mechanism in motion. The samples go into the
//! page packed (`pack`); the script that draws them is in `page/`.

mod drawing;
mod error;
mod html;
mod number;
mod pack;
mod page;
mod provenance;
mod run;
mod study;
mod tables;
mod thin;

pub use error::Error;
pub use study::StudyPage;

use crate::post::Summary;
use crate::record::{self, Draft, ResultFile};
use html::{escape, json_in_script};
use run::{PageRun, Run};
use std::path::{Path, PathBuf};
use tables::Summarised;

/// Samples that a page holds at most, of all its runs together.
const MOST_SAMPLES: usize = 240_000;

/// A report on one or several runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    html: String,
    /// The result files that it is made from.
    sources: Vec<PathBuf>,
}

impl Report {
    /// Makes the report on these result files, in their order. Labels are what their runs are
    /// called; without any, they have the names of [`record::names_of_runs`].
    ///
    /// # Errors
    /// A file cannot be read, its samples cannot be packed, or labels and files do not go together.
    pub fn new(files: &[ResultFile], labels: &[String]) -> Result<Report, Error> {
        let labels = record::names_of_runs(files, labels)?;
        let runs: Vec<Run<'_>> = files
            .iter()
            .zip(labels)
            .map(|(file, label)| Run::read(file, label))
            .collect::<Result<_, _>>()?;
        let reference = |run: &Run<'_>| runs.iter().position(|other| other.is_ideal_of(run));
        let references: Vec<Option<usize>> = runs.iter().map(reference).collect();
        let most = MOST_SAMPLES / runs.len().max(1);
        let pages: Vec<PageRun<'_>> = runs
            .iter()
            .zip(&references)
            .map(|(run, reference)| run.for_page(*reference, most))
            .collect::<Result<_, _>>()?;
        let samples: Vec<usize> = pages.iter().map(PageRun::samples).collect();
        let summarised: Vec<Summarised<'_>> = runs
            .iter()
            .map(|run| Ok(Summarised { run, summary: Summary::of(run.file, None)? }))
            .collect::<Result<_, Error>>()?;
        let html = page::page(&page::Content {
            title: &escape(&title(&runs)),
            failures: &provenance::failures(&runs),
            summary: &tables::summary(&summarised),
            contacts: &tables::contacts(&summarised),
            what_was_run: &provenance::what_was_run(&runs, &samples),
            everything: &provenance::everything(&runs),
            runs: &json_in_script(&serde_json::to_string(&pages)?),
            program: concat!("freeplay ", env!("CARGO_PKG_VERSION")),
        });
        let sources = files.iter().map(|file| file.path().to_owned()).collect();
        Ok(Report { html, sources })
    }

    /// The page.
    pub fn html(&self) -> &str {
        &self.html
    }

    /// Writes the page; with `force` in place of one that is there.
    ///
    /// # Errors
    /// The page is there and `force` is not, or is one of the result files, or cannot be written.
    pub fn write(&self, path: &Path, force: bool) -> Result<(), record::Error> {
        let sources: Vec<&Path> = self.sources.iter().map(PathBuf::as_path).collect();
        Draft::create_from(path, force, &sources)?.publish_bytes(self.html.as_bytes())
    }
}

/// Title of the page: that of its run, or the names of them.
fn title(runs: &[Run<'_>]) -> String {
    let named = |run: &Run<'_>| match run.file.text("title") {
        Some(title) if !title.is_empty() => title.to_owned(),
        _ => run.label.clone(),
    };
    match runs {
        [run] => named(run),
        runs => runs.iter().map(|run| run.label.as_str()).collect::<Vec<_>>().join(", "),
    }
}
