//! Why a case file gives no case.

use super::Located;
use crate::model::MOST_TOLD;
use std::fmt::Write;
use std::io;
use std::path::PathBuf;

/// Why a case file gives no case.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be opened or read.
    #[error("cannot read case file {}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file is far too large for a case.
    #[error("{} is no case file: it is larger than {limit} bytes", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Largest size read (bytes).
        limit: u64,
    },
    /// The file is not UTF-8.
    #[error("{} is no case file: line {line} is not text in UTF-8", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
        /// The first line that is not text, from 1.
        line: usize,
    },
    /// The file is not TOML.
    #[error("{} is not TOML\n  line {line}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What the parser says.
        message: String,
    },
    /// The file is TOML, but no case.
    #[error("{} does not describe a mechanism{}", path.display(), one_a_line(complaints))]
    NotAMechanism {
        /// The file.
        path: PathBuf,
        /// Everything wrong with it, in the order of the file.
        complaints: Vec<Located>,
    },
}

fn one_a_line(complaints: &[Located]) -> String {
    // writing to a string cannot fail
    let told = complaints.iter().take(MOST_TOLD);
    let mut lines = told.fold(String::new(), |mut lines, complaint| {
        let _ = write!(lines, "\n  {complaint}");
        lines
    });
    if complaints.len() > MOST_TOLD {
        let _ = write!(lines, "\n  and {} more", complaints.len() - MOST_TOLD);
    }
    lines
}
