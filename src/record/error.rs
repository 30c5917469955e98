//! What can go wrong with a result file.

use super::SCHEMA_VERSION;
use std::io;
use std::path::PathBuf;

/// A result file that could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The output is there already, and was not to be replaced.
    #[error("{} exists; --force replaces it", path.display())]
    Exists {
        /// The output asked for.
        path: PathBuf,
    },
    /// The output is one of the files that it is made from.
    #[error("{} is an input of this command, which writing there would destroy; choose another output", path.display())]
    IsInput {
        /// The output asked for.
        path: PathBuf,
    },
    /// Another process is writing the output.
    #[error("{} is being written by process {process}; wait for it, or choose another output", path.display())]
    Busy {
        /// The output asked for.
        path: PathBuf,
        /// Who is writing it.
        process: u32,
    },
    /// Writing failed; what was written before is a file of its own.
    #[error("{} is incomplete; what was written before the error is in {}", path.display(), kept.display())]
    Incomplete {
        /// The output asked for.
        path: PathBuf,
        /// Where the rest is.
        kept: PathBuf,
        /// What failed.
        source: Box<Error>,
    },
    /// There are segments of a run that has not come to its end.
    #[error(
        "{} holds a run that has not come to its end ({count} of its segments): --resume goes on with \
         it, --force begins anew", folder.display()
    )]
    SegmentsLeft {
        /// Where they are.
        folder: PathBuf,
        /// How many.
        count: usize,
    },
    /// A run is not to be gone on with by another case.
    #[error("{} is of another case: {difference}", path.display())]
    OtherCase {
        /// The file.
        path: PathBuf,
        /// What differs, in words.
        difference: String,
    },
    /// A run is not to be gone on with by another program.
    #[error(
        "{} was written by {theirs}, this is {ours}: another program may go on otherwise; go on with \
         that one, or begin anew", path.display()
    )]
    OtherProgram {
        /// The file.
        path: PathBuf,
        /// Who wrote it.
        theirs: String,
        /// Who would go on.
        ours: String,
    },
    /// A file has no checkpoint to go on from.
    #[error(
        "{} has no checkpoint to go on from: its case has no run.checkpoint_interval, or it ended \
         before the first", path.display()
    )]
    NoCheckpoint {
        /// The file.
        path: PathBuf,
    },
    /// The process was asked to stop.
    #[error("interrupted while {} was read", path.display())]
    Interrupted {
        /// What was being read.
        path: PathBuf,
    },
    /// What was read back from the disk is not what was written.
    #[error("cannot write {}: {what} came back from the disk otherwise than it was written", path.display())]
    NotAsWritten {
        /// The output asked for.
        path: PathBuf,
        /// Which part of the file.
        what: String,
    },
    /// The output came to be while the run went on; the run's own file is kept beside it.
    #[error("{} was made by another program during the run; this run's file is {}", path.display(), kept.display())]
    Taken {
        /// The output asked for.
        path: PathBuf,
        /// Where the run's file is.
        kept: PathBuf,
    },
    /// The folder of the output is missing.
    #[error("cannot write {}: there is no folder {}", path.display(), folder.display())]
    NoFolder {
        /// The output asked for.
        path: PathBuf,
        /// The missing folder.
        folder: PathBuf,
    },
    /// The path names a folder, a device or another thing that is no plain file.
    #[error("{} is not a plain file", path.display())]
    NotPlain {
        /// The path.
        path: PathBuf,
    },
    /// The operating system refused.
    /// Of two files that belong together one was replaced, the other could not be, and the old file
    /// cannot be put back.
    #[error("cannot put back {}, whose old file is now {}", path.display(), kept.display())]
    NotPutBack {
        /// The output.
        path: PathBuf,
        /// Where its old file is.
        kept: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    #[error("cannot {attempt} {}", path.display())]
    System {
        /// What was attempted, as a verb.
        attempt: &'static str,
        /// On which file.
        path: PathBuf,
        /// Why it failed.
        source: io::Error,
    },
    /// There are not as many labels as files.
    #[error("each file needs one label, in their order: labels {labels}, files {files}")]
    Labels {
        /// Number of labels.
        labels: usize,
        /// Number of files.
        files: usize,
    },
    /// Two files have one label.
    #[error("two files have the label \"{label}\"; each needs its own")]
    SameLabel {
        /// The label.
        label: String,
    },
    /// The HDF5 library failed.
    #[error("cannot {attempt} {}", path.display())]
    Library {
        /// What was attempted.
        attempt: String,
        /// On which file.
        path: PathBuf,
        /// Why it failed.
        source: LibraryError,
    },
    /// The writer was used again after it had failed.
    #[error("writing {} has failed before", path.display())]
    Failed {
        /// The output asked for.
        path: PathBuf,
    },
    /// The file is not HDF5.
    #[error("{} is not an HDF5 file", path.display())]
    NotHdf5 {
        /// The file.
        path: PathBuf,
    },
    /// The file is shorter than it says.
    #[error("{} is cut short: a copy that did not finish, or a run that was killed", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
    },
    /// The file is HDF5, but no result of ours.
    #[error("{} is not a freeplay result: {missing}", path.display())]
    NotAResult {
        /// The file.
        path: PathBuf,
        /// What a result would have.
        missing: String,
    },
    /// The file was written by a newer program.
    #[error("{} has layout {found}, this program reads layouts up to {SCHEMA_VERSION}", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its `schema_version`.
        found: i64,
    },
    /// There is no such dataset, column or attribute.
    #[error("{} has no {what}{hint}", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// What was asked for: `column "angle.cupler"`.
        what: String,
        /// The nearest name that is there, as ` (did you mean …?)`, or nothing.
        hint: String,
    },
    /// The file contradicts itself.
    #[error("{} is damaged: {what}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The contradiction.
        what: String,
    },
}

/// What the HDF5 library said, in one line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("HDF5: {0}")]
pub struct LibraryError(String);

impl From<hdf5::Error> for LibraryError {
    fn from(error: hdf5::Error) -> Self {
        let Some(stack) = error.stack() else {
            return LibraryError(error.to_string());
        };
        let told = stack.iter().filter_map(|frame| system_message(frame.desc())).next_back();
        LibraryError(told.unwrap_or_else(|| stack.description().to_owned()))
    }
}

/// The operating system's words in the description of a failed read or write.
fn system_message(description: &str) -> Option<String> {
    let (_, rest) = description.split_once("error message = '")?;
    let (message, _) = rest.split_once('\'')?;
    Some(message.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_of_the_operating_system_are_what_is_reported() {
        let description = "file write failed: time = Thu Jan  1 00:00:00 1970\n, filename = \
                           'a.h5', file descriptor = 5, errno = 28, error message = 'No space \
                           left on device', buf = 0x55, total write size = 2048";
        assert_eq!(system_message(description).as_deref(), Some("No space left on device"));
        assert_eq!(system_message("unable to open file"), None);
    }

    #[test]
    fn an_error_of_the_library_keeps_its_words() {
        let error = LibraryError::from(hdf5::Error::from("bad shape"));
        assert_eq!(error.to_string(), "HDF5: bad shape");
    }
}
