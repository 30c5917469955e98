//! Studies: one case run many times with some of its keys changed, and tables of what came of it.
//!
//! A run of a study is the case with changes, as `--set` makes them. It happens in memory; what is
//! kept of it, numbers of its summary and section points, is on the disk as soon as it is over
//! (`pack.rs`). The tables are made of that in the order of the runs, so that nobody can see from them
//! how many threads or processes there were, or how often they were killed.

mod attractor;
mod ensemble;
mod pack;
mod plan;
mod reader;
mod runner;
mod sampling;
mod scalar;
mod section;
mod sweep;
mod tables;

pub use attractor::AttractorPlan;
pub use ensemble::EnsemblePlan;
pub(crate) use ensemble::quantile;
pub use plan::{Keep, Literal, SectionPlan, Study, Variable};
pub use reader::{Recorded, Rows};
pub use sweep::{Done, Options, Shard, Told, gather, sweep};
pub use tables::{ENSEMBLE, TABLES};

use crate::{case, export, record};
use parquet::errors::ParquetError;
use std::io;
use std::path::PathBuf;

/// Why a study could not be made.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file of a study cannot be read.
    #[error("cannot read {}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file is far too large for a study.
    #[error("{} is no study file: it is larger than {limit} bytes", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Largest size read (bytes).
        limit: u64,
    },
    /// The file is not TOML, or not that of a study.
    #[error("{} is no study{hint}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// What the parser says, with the line.
        message: String,
        /// What might have been meant.
        hint: &'static str,
    },
    /// Something in a study is wrong.
    #[error("{} is no study{}\n  {}{key}: {message}", path.display(), "", line_words(*line))]
    Wrong {
        /// The file.
        path: PathBuf,
        /// The line, from 1, where it is known.
        line: Option<usize>,
        /// The key.
        key: String,
        /// What is wrong, and what would be right.
        message: String,
    },
    /// A study has no runs.
    #[error("{} has no runs", path.display())]
    NoRuns {
        /// The file.
        path: PathBuf,
    },
    /// The case of a study, with the changes of its first run, cannot be run.
    #[error(transparent)]
    Case(case::Error),
    /// A folder cannot be made.
    #[error("cannot make the folder {}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// What runs came to cannot be kept or read.
    #[error("cannot keep what runs came to in {}", path.display())]
    Pack {
        /// The pack, or the folder of packs.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// An output cannot be made.
    #[error(transparent)]
    Output(record::Error),
    /// A table cannot be written.
    #[error(transparent)]
    Table(export::Error),
    /// A table cannot be read.
    #[error("{} is no table of a study", path.display())]
    NotATable {
        /// The table.
        path: PathBuf,
        /// Why.
        source: ParquetError,
    },
    /// The folder has the tables of another study.
    #[error("{} has the tables of another study, or of another case; --force replaces them (runs that both have are not made again)", path.display())]
    OtherStudy {
        /// The folder.
        path: PathBuf,
    },
    /// Runs are missing that other shards were to make.
    #[error("{missing} of {runs} runs are missing in {}: shards that have not come to their end", path.display())]
    Missing {
        /// The folder.
        path: PathBuf,
        /// How many.
        missing: u64,
        /// Of how many.
        runs: u64,
    },
    /// The process was asked to stop.
    #[error("interrupted")]
    Interrupted,
}

fn line_words(line: Option<usize>) -> String {
    line.map_or(String::new(), |line| format!("line {line}, "))
}
