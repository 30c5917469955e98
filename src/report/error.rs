//! Why there is no page.

use crate::{post, record};
use std::io;
use std::path::PathBuf;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A result file cannot be read.
    #[error(transparent)]
    Record(#[from] record::Error),
    /// A run cannot be summarised.
    #[error(transparent)]
    Summary(#[from] post::Error),
    /// The samples of a result file could not be packed into the page.
    #[error("cannot pack {what} of {}", path.display())]
    Pack {
        /// Which column.
        what: String,
        /// Of which result file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The runs cannot be written as JSON.
    #[error("cannot write the runs into the page")]
    Json(#[from] serde_json::Error),
}
