//! Case files: TOML to a mechanism and a plan, with every complaint at once.
//!
//! A complaint carries the line of its key, or the `--set` that set it. Complaints that only a
//! later step can make, from the model's constructor say, get theirs from [`Case::reject`].

mod changes;
mod error;
mod files;
mod mechanism;
mod plan;
mod schema;
mod source;
mod start_from;
mod table_reader;
#[cfg(test)]
mod tests;

pub use changes::{Changes, NotAnOverride, Override};
pub use error::Error;
pub use plan::{AbsoluteTolerance, EngineName, NormName, Plan, Precision, Sampling, SolverPlan};
pub use schema::{schema, tables, unit_of};
pub use source::{Located, Place};

use crate::model::{Complaint, Complaints, Description, KeyPath, check};
use source::Source;
use std::path::{Path, PathBuf};
use table_reader::{Findings, TableReader};
use toml_edit::DocumentMut;

/// A case, read and checked as far as it can be without mechanics.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name, fit for the stem of a file's name.
    pub name: String,
    /// Title; may be empty.
    pub title: String,
    /// The mechanism.
    pub description: Description,
    /// How it is run.
    pub plan: Plan,
    /// The text as run: the file's, with the changes of the command line applied.
    pub text: String,
    /// The result file that the start was taken from, if it was.
    pub started_from: Option<PathBuf>,
    /// Values that the program put where the case gives none, in the order of reading.
    pub defaults: Vec<DefaultTaken>,
    source: Source,
}

/// A value that the program put where a case gives none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DefaultTaken {
    /// The key.
    pub key: KeyPath,
    /// The value, as a case file would have it.
    pub value: String,
}

impl Case {
    /// Reads and checks a case file, with changes from the command line.
    ///
    /// # Errors
    /// The file cannot be read, is not TOML, or does not describe a mechanism.
    pub fn read(path: &Path, changes: &Changes) -> Result<Case, Error> {
        Case::from_text(path, &source::read_text(path)?, changes)
    }

    /// Reads and checks the text of a case file; `path` gives the default name, and errors tell it.
    ///
    /// # Errors
    /// The text is not TOML, or does not describe a mechanism.
    pub fn from_text(path: &Path, text: &str, changes: &Changes) -> Result<Case, Error> {
        let template = Template::new(path, text)?;
        template.case(template.resolve(changes)?, changes)
    }

    /// Checks what a document says.
    fn of(
        path: &Path,
        text: String,
        document: &DocumentMut,
        source: Source,
    ) -> Result<Case, Error> {
        let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into());
        let mut findings = Findings::default();
        let (name, title, description, mut plan) =
            TableReader::root(document.as_table(), &mut findings, |root| {
                let name = root.optional("name", "").unwrap_or(stem);
                let title = root.optional("title", "").unwrap_or_default();
                (name, title, mechanism::description(root), Plan::read(root))
            });
        findings.add_checks(check_name(&name));
        findings.add_checks(check(&description));
        findings.add_checks(plan.settle(&description).into_iter().collect());
        findings.add_checks(plan.check());
        findings.add_checks(plan.check_tables(&description));
        let (complaints, defaults) = findings.into_parts();
        if !complaints.is_empty() {
            return Err(source.reject(complaints));
        }
        let started_from = None;
        Ok(Case { name, title, description, plan, text, started_from, defaults, source })
    }

    /// The error that tells complaints about this case, each with its place in what was written.
    pub fn reject(&self, complaints: Vec<Complaint>) -> Error {
        self.source.reject(complaints)
    }
}

/// The text of a case file, from which cases are made that differ in some keys.
#[derive(Debug, Clone)]
pub struct Template {
    path: PathBuf,
    text: String,
    /// As it stands in the file, ...
    written: DocumentMut,
    /// ... and with what files that it names have.
    document: DocumentMut,
    /// The result file that the start is taken from.
    from: Option<PathBuf>,
    source: Source,
}

impl Template {
    /// Where it was read.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads a case file.
    ///
    /// # Errors
    /// The file cannot be read, or is not TOML.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Template::new(path, &source::read_text(path)?)
    }

    /// Of the text of a case file; `path` gives the default name, and errors tell it.
    ///
    /// # Errors
    /// The text is not TOML.
    pub fn new(path: &Path, text: &str) -> Result<Self, Error> {
        let mut document = source::parse(path, text)?;
        let written = document.clone();
        let source = Source::new(path, text)?;
        let taken = files::take_in(path, &mut document);
        let taken = taken.and_then(|any| Ok((any, start_from::take_in(path, &mut document)?)));
        let (text, from) = match taken {
            Ok((false, None)) => (text.to_owned(), None),
            Ok((_, from)) => (document.to_string(), from),
            Err(complaints) => return Err(source.reject(complaints)),
        };
        Ok(Template { path: path.to_owned(), text, written, document, from, source })
    }

    /// The text as it stands in the file, with the numbers of files that belong to it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text with changes applied: that of a case which is run so.
    ///
    /// # Errors
    /// A key cannot be set.
    pub fn resolve(&self, changes: &Changes) -> Result<String, Error> {
        if changes.is_empty() {
            return Ok(self.text.clone());
        }
        // another time of the run that the file itself starts from is had by reading that again
        let mut document = match changes.move_start() {
            true => self.written.clone(),
            false => self.document.clone(),
        };
        let mut complaints = changes.apply(&mut document);
        complaints.extend(files::take_in(&self.path, &mut document).err().into_iter().flatten());
        let started = start_from::take_in(&self.path, &mut document);
        complaints.extend(started.err().into_iter().flatten());
        if !complaints.is_empty() {
            return Err(self.source.overridden(&changes.set).reject(complaints));
        }
        Ok(document.to_string())
    }

    /// The case of a text that [`Template::resolve`] made with these changes.
    ///
    /// # Errors
    /// The text does not describe a mechanism.
    pub fn case(&self, resolved: String, changes: &Changes) -> Result<Case, Error> {
        // what is recorded as run is what is run: the changed text is read like any other
        let document = source::parse(&self.path, &resolved)?;
        let mut case =
            Case::of(&self.path, resolved, &document, self.source.overridden(&changes.set))?;
        let beside = self.path.parent().unwrap_or(Path::new(""));
        let set = changes.start_from().map(|name| beside.join(name));
        case.started_from = set.or(self.from.clone());
        Ok(case)
    }
}

/// A case's name must serve as the stem of a file's name.
fn check_name(name: &str) -> Vec<Complaint> {
    let mut complaints = Complaints::default();
    let begins = name.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
    if !begins || !name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)) {
        let rule =
            "letters, digits, \"-\", \"_\" and \".\", beginning with a letter, digit or \"_\"";
        let default = "the default is the file's name without its ending";
        complaints
            .add(KeyPath::new(["name"]), format!("must be of {rule}, is {name:?}; {default}"));
    }
    complaints.into_vec()
}
