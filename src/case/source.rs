//! The text of a case file: reading it, and which line a key stands on.

use super::{Error, Override};
use crate::model::{Complaint, KeyPath};
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml_edit::{Document, DocumentMut, Item, TableLike, TomlError, Value};

/// Largest case file that is read (bytes). Most are a few thousand bytes long; this keeps a
/// wrong path, to a result file say, from filling the memory.
const LARGEST: u64 = 16_000_000;

/// Reads the text of a case file.
pub(super) fn read_text(path: &Path) -> Result<String, Error> {
    let unreadable = |source| Error::Unreadable { path: path.to_owned(), source };
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST {
        return Err(Error::TooLarge { path: path.to_owned(), limit: LARGEST });
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        Error::NotText { path: path.to_owned(), line: line_at(error.as_bytes(), valid) }
    })
}

/// Parses a text that may be edited.
pub(super) fn parse(path: &Path, text: &str) -> Result<DocumentMut, Error> {
    text.parse().map_err(|error| syntax(path, text, &error))
}

fn syntax(path: &Path, text: &str, error: &TomlError) -> Error {
    let start = error.span().map_or(0, |span| span.start);
    let line = line_at(text.as_bytes(), start);
    Error::Syntax { path: path.to_owned(), line, message: error.message().to_owned() }
}

/// The line of a position, from 1.
fn line_at(text: &[u8], position: usize) -> usize {
    1 + text.iter().take(position).filter(|&&byte| byte == b'\n').count()
}

/// Where each key of a case was written: in the file, or with `--set`.
#[derive(Debug, Clone)]
pub(super) struct Source {
    written: Arc<Written>,
    overrides: Vec<KeyPath>,
}

/// A case file as it was written.
#[derive(Debug)]
struct Written {
    path: PathBuf,
    file: Document<String>,
    /// Where each line begins.
    lines: Vec<usize>,
}

impl Source {
    /// The source of a case whose file at `path` has this text.
    pub fn new(path: &Path, text: &str) -> Result<Source, Error> {
        let file = Document::parse(text.to_owned()).map_err(|error| syntax(path, text, &error))?;
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let lines = std::iter::once(0).chain(ends.map(|(end, _)| end + 1)).collect();
        let written = Arc::new(Written { path: path.to_owned(), file, lines });
        Ok(Source { written, overrides: Vec::new() })
    }

    /// The same with keys set on the command line.
    pub fn overridden(&self, overrides: &[Override]) -> Source {
        let overrides = overrides.iter().map(|set| set.key().clone()).collect();
        Source { written: Arc::clone(&self.written), overrides }
    }

    /// The error that tells these complaints, each with its place, in the order of the file.
    pub fn reject(&self, complaints: Vec<Complaint>) -> Error {
        let locate =
            |complaint: Complaint| Located { place: self.place(&complaint.key), complaint };
        let mut complaints: Vec<Located> = complaints.into_iter().map(locate).collect();
        complaints.sort_by(|a, b| a.place.cmp(&b.place));
        Error::NotAMechanism { path: self.written.path.clone(), complaints }
    }

    /// Where a key, or the table that lacks it, was written.
    fn place(&self, key: &KeyPath) -> Place {
        let keys = key.keys();
        let set = |wanted: &dyn Fn(&[String]) -> bool| {
            self.overrides.iter().rev().find(|set| wanted(set.keys())).cloned().map(Place::Set)
        };
        let above = set(&|set| keys.starts_with(set));
        above
            .or_else(|| {
                (1..=keys.len()).rev().map(|depth| &keys[..depth]).find_map(|parent| {
                    let created = || set(&|set| set.starts_with(parent));
                    self.line(parent).map(Place::Line).or_else(created)
                })
            })
            .unwrap_or(Place::Whole)
    }

    /// The line in the file of the key at this path.
    fn line(&self, keys: &[String]) -> Option<usize> {
        let Written { file, lines, .. } = &*self.written;
        let mut inside = Inside::Table(file.as_table());
        let mut span = None;
        for key in keys {
            (inside, span) = inside.below(key)?;
        }
        let span = span?;
        Some(lines.partition_point(|begin| *begin <= span.start))
    }
}

/// What of a file keys lead into.
enum Inside<'a> {
    Table(&'a dyn TableLike),
    /// Tables that count from 1.
    List(Vec<&'a dyn TableLike>),
    Nothing,
}

impl<'a> Inside<'a> {
    /// What a key leads to, and where it is written.
    fn below(&self, key: &str) -> Option<(Inside<'a>, Option<Range<usize>>)> {
        match self {
            Inside::Table(table) => {
                let (key, item) = table.get_key_value(key)?;
                let inside = match (item.as_table_like(), list_of_tables(item)) {
                    (Some(table), _) => Inside::Table(table),
                    (None, Some(list)) => Inside::List(list),
                    (None, None) => Inside::Nothing,
                };
                Some((inside, key.span().or_else(|| item.span())))
            }
            Inside::List(list) => {
                let table = *list.get(key.parse::<usize>().ok()?.checked_sub(1)?)?;
                let first = table.iter().next().and_then(|(key, _)| table.key(key)?.span());
                Some((Inside::Table(table), first))
            }
            Inside::Nothing => None,
        }
    }
}

/// The tables of a list of tables, `[[run.window]]` or `window = [{ … }]`.
pub(super) fn list_of_tables(item: &Item) -> Option<Vec<&dyn TableLike>> {
    match item {
        Item::ArrayOfTables(list) => Some(list.iter().map(|t| t as &dyn TableLike).collect()),
        Item::Value(Value::Array(list)) => {
            list.iter().map(|t| t.as_inline_table().map(|t| t as &dyn TableLike)).collect()
        }
        _ => None,
    }
}

/// Where the key of a complaint was written.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// Nowhere in particular: the case as a whole lacks it.
    Whole,
    /// A line of the file, from 1.
    Line(usize),
    /// A key set on the command line.
    Set(KeyPath),
}

/// A complaint and its place in what the user wrote.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Located {
    /// The line or override.
    pub place: Place,
    /// The complaint.
    pub complaint: Complaint,
}

impl fmt::Display for Located {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Place::Whole => write!(f, "{}", self.complaint),
            Place::Line(line) => write!(f, "line {line}, {}", self.complaint),
            Place::Set(key) if *key == self.complaint.key => write!(f, "--set {}", self.complaint),
            Place::Set(key) => write!(f, "--set {key}, {}", self.complaint),
        }
    }
}
