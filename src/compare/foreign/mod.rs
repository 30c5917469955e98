//! Trajectories of other programs: text with columns, MATLAB files, HDF5 of any layout.

mod arrays;
mod delimited;

use super::Error;
use super::unit::{Named, named};
use crate::model::shortened;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What kind of file another program wrote.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Text: numbers in columns under a line of names.
    Text,
    /// MATLAB, version 7.3: HDF5 behind a block of 512 bytes.
    Matlab,
    /// HDF5 of another layout.
    Hdf5,
}

impl Format {
    /// Name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Text => "text with columns",
            Format::Matlab => "MATLAB 7.3 file",
            Format::Hdf5 => "HDF5 file",
        }
    }
}

/// A trajectory of another program: its columns, and which of them is the time.
#[derive(Debug, Clone)]
pub struct ForeignTable {
    /// The file.
    pub path: PathBuf,
    /// What kind of file it is.
    pub format: Format,
    /// All columns of numbers, the time among them.
    pub columns: Vec<ForeignColumn>,
    /// Numbers that are no columns, their length not being that of the time, in words.
    pub misfits: Vec<String>,
    /// Whether the file seems to end before its last line does.
    pub ends_within_a_line: bool,
}

/// A column of another program's file.
#[derive(Debug, Clone)]
pub struct ForeignColumn {
    /// Its name in the file.
    pub name: String,
    /// Its values, in its own unit.
    pub values: Vec<f64>,
    /// The first cell that is no number.
    pub text: Option<Misplaced>,
    /// Most significant digits that any of its numbers is written with; `None` where numbers are
    /// not written in decimals.
    pub written_digits: Option<usize>,
}

/// A cell that is no number, and where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Misplaced {
    /// The line, from 1.
    pub line: u64,
    /// What stands there.
    pub text: String,
}

impl ForeignColumn {
    /// Its name and unit, taken apart.
    pub fn named(&self) -> Named<'_> {
        named(&self.name)
    }
}

/// Names that a column of times has of old, in lower case.
const TIME_NAMES: [&str; 3] = ["time", "t", "tout"];

impl ForeignTable {
    /// Reads a file that is no result of ours.
    ///
    /// # Errors
    /// The file cannot be read, is of no kind known, or holds no columns of numbers.
    pub fn read(path: &Path) -> Result<ForeignTable, Error> {
        let unreadable = |source| Error::Unreadable { path: path.to_owned(), source };
        let mut file = File::open(path).map_err(unreadable)?;
        let mut bytes = Vec::new();
        (&mut file).take(HEAD).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.is_empty() {
            return Err(Error::Empty { path: path.to_owned() });
        }
        if hdf5_begins(&bytes) {
            let matlab = bytes.starts_with(b"MATLAB");
            return arrays::read(path, if matlab { Format::Matlab } else { Format::Hdf5 });
        }
        if bytes.starts_with(b"MATLAB 5.0 MAT-file") {
            return Err(Error::OldMatlab { path: path.to_owned() });
        }
        file.read_to_end(&mut bytes).map_err(unreadable)?;
        let text = String::from_utf8(bytes).ok().filter(|text| !text.contains('\0'));
        match text {
            Some(text) => delimited::read(path, &text),
            None => Err(Error::UnknownFormat { path: path.to_owned() }),
        }
    }

    /// The column of times, by its usual names, with or without a unit; in a file of arrays the
    /// last word of a name counts, `out.t`.
    pub fn usual_time(&self) -> Option<usize> {
        let is = |column: &ForeignColumn, name: &str| {
            let Named { name: theirs, unit, .. } = column.named();
            let word = match self.format {
                Format::Text => theirs,
                Format::Matlab | Format::Hdf5 => last_word(theirs),
            };
            word.to_lowercase() == name && unit.is_none_or(|unit| unit.si == "s")
        };
        TIME_NAMES.iter().find_map(|name| self.columns.iter().position(|column| is(column, name)))
    }

    /// The names of all columns, quoted, for a message.
    pub fn names(&self) -> String {
        const MOST: usize = 40;
        let shown = self.columns.iter().take(MOST);
        let mut names: Vec<String> =
            shown.map(|column| format!("\"{}\"", shortened(&column.name))).collect();
        if self.columns.len() > MOST {
            names.push(format!("and {} more", self.columns.len() - MOST));
        }
        names.extend(self.misfits.iter().take(MOST).cloned());
        names.join(", ")
    }
}

/// The last word of an array's name, behind those of the groups it is in.
fn last_word(name: &str) -> &str {
    name.rsplit(['.', '/']).next().unwrap_or(name)
}

/// Bytes that tell what kind of file it is.
const HEAD: u64 = 4096;

/// Whether a file begins as HDF5 does, at its head or behind a block of 512, 1024, … bytes
/// (HDF5 File Format Specification 3.0, II.A).
fn hdf5_begins(bytes: &[u8]) -> bool {
    let signature = b"\x89HDF\r\n\x1a\n";
    [0, 512, 1024, 2048]
        .into_iter()
        .any(|at| bytes.get(at..).is_some_and(|rest| rest.starts_with(signature)))
}
