//! Why two files cannot be compared.

use crate::record::LibraryError;
use crate::{case, record, simulate};
use std::convert::Infallible;
use std::io;
use std::path::PathBuf;

/// Why two files cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A result file cannot be read.
    #[error(transparent)]
    Result(#[from] record::Error),
    /// The case that a result file holds cannot be read.
    #[error("cannot read the case that {} was made from", path.display())]
    Case {
        /// The result file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<case::Error>,
    },
    /// A result file does not hold the case it was made from.
    #[error("{} does not hold the case it was made from", path.display())]
    NoCase {
        /// The file.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("cannot read {}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The HDF5 library failed.
    #[error("cannot read {}", path.display())]
    Library {
        /// The file.
        path: PathBuf,
        /// Why.
        source: LibraryError,
    },
    /// The file is shorter than it says.
    #[error("{} is cut short: a copy that did not finish, or a program that was killed", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
    },
    /// There is nothing in the file.
    #[error("{} has no rows of numbers", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A MATLAB file that is not HDF5.
    #[error("{} is a MATLAB file of an older version; save(…, '-v7.3') writes one that can be read", path.display())]
    OldMatlab {
        /// The file.
        path: PathBuf,
    },
    /// Neither HDF5 nor text.
    #[error("{} is neither HDF5 (a freeplay result, MATLAB 7.3) nor text in UTF-8", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// A text that begins with numbers.
    #[error("{} has no line of names above the numbers of line {line}: time,angle.coupler,…", path.display())]
    NoNames {
        /// The file.
        path: PathBuf,
        /// First line of numbers, from 1.
        line: u64,
    },
    /// A line with another number of fields.
    #[error("{}, line {line}: {fields} fields under {names} names; is the file cut short?", path.display())]
    Ragged {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// Its number of fields.
        fields: usize,
        /// Number of names.
        names: usize,
    },
    /// A line that cannot be taken apart.
    #[error("{}, line {line}: {message}", path.display())]
    Unparsable {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What the reader says.
        message: String,
    },
    /// A word where a number is wanted.
    #[error("{}, line {line}: {text:?} in column \"{column}\" is not a number{}", path.display(), decimal_comma(text))]
    NotANumber {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// The column.
        column: String,
        /// What stands there.
        text: String,
    },
    /// No column of times.
    #[error("{} has no column of times (time, t); --map THEIRS=time names it, of {columns}", path.display())]
    NoTime {
        /// The file.
        path: PathBuf,
        /// Its columns.
        columns: String,
    },
    /// A time that is not a finite number.
    #[error("{}: time {number} is {value}, not a number of seconds", path.display())]
    NotATime {
        /// The file.
        path: PathBuf,
        /// Which sample, from 1.
        number: usize,
        /// What it is.
        value: f64,
    },
    /// Times that go back.
    #[error("{}: times are not sorted, {after} s follows {before} s", path.display())]
    Unsorted {
        /// The file.
        path: PathBuf,
        /// A time (s).
        before: f64,
        /// The one behind it (s).
        after: f64,
    },
    /// `--map` names a column that is not there.
    #[error("{} has no column \"{column}\"{hint}; it has {columns}", path.display())]
    NoSuchColumn {
        /// The file.
        path: PathBuf,
        /// The name.
        column: String,
        /// The nearest name.
        hint: String,
        /// Its columns.
        columns: String,
    },
    /// `--map` names a column of ours that is not there.
    #[error(
        "\"{name}\" is no column of this mechanism{hint}; columns are named as angle.coupler is"
    )]
    NotOurs {
        /// The name.
        name: String,
        /// The nearest name.
        hint: String,
    },
    /// `--map` names a force without `--forces`.
    #[error("{name} is looked at with --forces only")]
    NeedsForces {
        /// The name.
        name: String,
    },
    /// `--map` names a column that is not compared.
    #[error("{name} is not compared: it is neither state nor force")]
    NotCompared {
        /// The name.
        name: String,
    },
    /// `--map` names the same column of ours again.
    #[error("--map names {ours} twice")]
    MappedTwice {
        /// The name.
        ours: String,
    },
    /// `--map` without a file that needs it.
    #[error("--map is for files of other programs; both are freeplay results")]
    NothingToMap,
    /// A unit that is not known.
    #[error(
        "column \"{column}\": there is no unit \"{unit}\" here; s, ms, rad, deg, m, mm, m/s, rad/s, rpm, N, N m and the like are known"
    )]
    UnknownUnit {
        /// The column.
        column: String,
        /// The unit.
        unit: String,
    },
    /// A unit of another kind.
    #[error("column \"{column}\" is in {unit}, but {ours} is in {si}")]
    WrongUnit {
        /// The column.
        column: String,
        /// Its unit.
        unit: &'static str,
        /// Our column.
        ours: String,
        /// Our unit.
        si: &'static str,
    },
    /// No column of theirs is one of ours.
    #[error("{} has no columns that are known to be of ours; --map THEIRS=OURS tells which are\n  theirs: {columns}\n  ours: {ours}{hints}", path.display())]
    NothingInCommon {
        /// The file.
        path: PathBuf,
        /// Its columns.
        columns: String,
        /// Ours.
        ours: String,
        /// What theirs are near to, a line each.
        hints: String,
    },
    /// A certified reference is not what was certified.
    #[error(
        "{} was changed after it was certified: its contents are not those that its seal, the \
         attribute certificate_sha256, is of", path.display()
    )]
    BrokenSeal {
        /// The reference.
        path: PathBuf,
    },
    /// Neither file says which mechanism it is of.
    #[error("neither {} nor {} is a freeplay result: one must say which mechanism it is", theirs.display(), reference.display())]
    NoMechanism {
        /// The first file.
        theirs: PathBuf,
        /// The second.
        reference: PathBuf,
    },
    /// The files are of two mechanisms.
    #[error("{} and {} are of two mechanisms: {difference}", theirs.display(), reference.display())]
    OtherMechanism {
        /// The first file.
        theirs: PathBuf,
        /// The second.
        reference: PathBuf,
        /// Where they differ.
        difference: String,
    },
    /// A time beyond the reference.
    #[error("{} has a sample at {time} s, but {} covers {first} s to {last} s{hint}", theirs.display(), reference.display())]
    Outside {
        /// The first file.
        theirs: PathBuf,
        /// The second.
        reference: PathBuf,
        /// The time (s).
        time: f64,
        /// First time of the reference (s).
        first: f64,
        /// Last time of the reference (s).
        last: f64,
        /// What would help.
        hint: String,
    },
    /// `--until` beyond the reference.
    #[error("{} ends at {last} s, before --until {until}", reference.display())]
    ReferenceEnds {
        /// The reference.
        reference: PathBuf,
        /// Its last time (s).
        last: f64,
        /// The time asked for (s).
        until: f64,
    },
    /// No sample before `--until`.
    #[error("{} has no sample up to {until} s", path.display())]
    NoSamples {
        /// The file.
        path: PathBuf,
        /// The time asked for (s).
        until: f64,
    },
    /// No time in common, where a time must be in both.
    #[error("{} and {} have no times in common", theirs.display(), reference.display())]
    NoCommonTimes {
        /// The first file.
        theirs: PathBuf,
        /// The second.
        reference: PathBuf,
    },
    /// The reference's case could not be run again.
    #[error("cannot run the case of {} again, to have it at the times of {}", reference.display(), theirs.display())]
    Again {
        /// The first file.
        theirs: PathBuf,
        /// The second.
        reference: PathBuf,
        /// Why.
        source: Box<simulate::Error<Infallible>>,
    },
    /// Running the reference's case again gives another trajectory.
    #[error(
        "the case of {} was run again, to have it at the times of {}, and came out otherwise: \
         {column} at {time} s is {again:e}, in the file {stored:e}; another version of the \
         program or of its libraries, or another machine, made it. --common-times compares at \
         the times that both files hold",
        reference.display(), theirs.display()
    )]
    NotReproduced {
        /// The first file.
        theirs: PathBuf,
        /// The second.
        reference: PathBuf,
        /// The column.
        column: String,
        /// The time (s).
        time: f64,
        /// Its value in the file.
        stored: f64,
        /// Its value now.
        again: f64,
    },
    /// Whoever watched asked to stop.
    #[error("interrupted")]
    Interrupted,
}

fn decimal_comma(text: &str) -> &'static str {
    if text.contains(',') { "; the decimal sign is a point" } else { "" }
}
