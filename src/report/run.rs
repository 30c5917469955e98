//! One run as the page tells it.

use super::Error;
use super::drawing::{self, Drawing};
use super::pack::{Packed, TIME_DIGITS, VALUE_DIGITS, pack};
use super::thin::{BLOCK, rows_to_keep};
use crate::case::Case;
use crate::certify::Horizon;
use crate::record::{self, DATASETS, Dataset, Drawn, ResultFile, column_name};
use crate::run::Contact;
use serde::Serialize;
use std::collections::BTreeMap;

/// Datasets over time that the page draws.
fn drawn() -> impl Iterator<Item = &'static Dataset> {
    DATASETS.iter().filter(|dataset| dataset.drawn != Drawn::No)
}

/// Datasets of contacts and peaks, and whether they are times.
const OF_CONTACTS: [(&str, bool); 10] = [
    ("contact_clearance", false),
    ("contact_begin", true),
    ("contact_end", true),
    ("contact_peak_penetration", false),
    ("contact_peak_force", false),
    ("contact_peak_time", true),
    ("contact_impact_rate", false),
    ("peak_clearance", false),
    ("peak_time", true),
    ("peak_force", false),
];

/// A result file, read as far as the page needs it.
#[derive(Debug)]
pub(super) struct Run<'a> {
    pub file: &'a ResultFile,
    /// What the run is called on the page; no two runs have the same.
    pub label: String,
    /// The case; `None` where its text is not one that this program reads.
    pub case: Option<Case>,
    pub times: Vec<f64>,
    pub contacts: Vec<Contact>,
    /// Datasets over time that the page draws and the file has.
    drawn: Vec<&'static Dataset>,
}

/// What the page's script gets of a run.
#[derive(Debug, Serialize)]
pub(super) struct PageRun<'a> {
    label: &'a str,
    title: &'a str,
    /// Why the run did not come to its end.
    failure: Option<String>,
    /// Index of the run of the same mechanism without clearances.
    reference: Option<usize>,
    samples_in_file: usize,
    /// Samples in the page.
    samples: usize,
    bodies: &'a [String],
    joints: &'a [String],
    clearances: &'a [String],
    drives: &'a [String],
    points: &'a [String],
    /// Duration of a turn of the first drive (s).
    period: Option<f64>,
    /// Behind which times (s) the state, and forces, torques and accelerations, mean nothing;
    /// nothing where the whole run does, or nobody knows.
    horizon: Option<[f64; 2]>,
    drawing: Option<Drawing>,
    /// Columns by their names in result files.
    columns: BTreeMap<String, Packed>,
}

impl<'a> Run<'a> {
    /// Reads what the page needs.
    pub fn read(file: &'a ResultFile, label: String) -> Result<Self, record::Error> {
        Ok(Run {
            file,
            label,
            case: drawing::case_of(file),
            times: file.times()?,
            contacts: file.contacts()?,
            drawn: drawn().filter(|dataset| file.dataset(dataset.name).is_ok()).collect(),
        })
    }

    /// Why the run did not come to its end, if it did not.
    pub fn failure(&self) -> Option<String> {
        if self.file.is_complete() {
            return None;
        }
        let status = self.file.text("run_status").unwrap_or("of unknown status");
        let reason = self.file.text("run_failure").map_or(String::new(), |why| format!(": {why}"));
        Some(format!("{status}{reason}"))
    }

    /// Whether a run is of the same mechanism as this, without clearances.
    pub fn is_ideal_of(&self, other: &Run<'_>) -> bool {
        let ideal = self.file.clearances().is_empty() && !other.file.clearances().is_empty();
        let cases = self.case.as_ref().zip(other.case.as_ref());
        ideal && cases.is_some_and(|(one, other)| drawing::same_but_for_clearances(one, other))
    }

    /// What the page gets, of so many samples at most.
    pub fn for_page(
        &self,
        reference: Option<usize>,
        most_samples: usize,
    ) -> Result<PageRun<'_>, Error> {
        let file = self.file;
        let kept = self.rows_to_keep(most_samples)?;
        Ok(PageRun {
            label: &self.label,
            title: file.text("title").unwrap_or_default(),
            failure: self.failure(),
            reference,
            samples_in_file: self.times.len(),
            samples: kept.len(),
            bodies: file.bodies(),
            joints: file.joints(),
            clearances: file.clearances(),
            drives: file.drives(),
            points: file.points(),
            period: self.case.as_ref().and_then(drawing::period),
            horizon: self.horizon()?,
            drawing: self.case.as_ref().and_then(|case| Drawing::of(case, file)),
            columns: self.pack_columns(&kept)?,
        })
    }

    fn horizon(&self) -> Result<Option<[f64; 2]>, record::Error> {
        let ends = Horizon::of(self.file)?.filter(|horizon| !horizon.is_whole());
        Ok(ends.map(|horizon| [horizon.state, horizon.forces]))
    }

    fn pack_columns(&self, kept: &[usize]) -> Result<BTreeMap<String, Packed>, Error> {
        let mut columns = BTreeMap::new();
        let mut add = |name: String, values: &[f64], digits| {
            let failed = |source| {
                let (what, path) = (name.clone(), self.file.path().to_owned());
                Error::Pack { what, path, source }
            };
            let packed = pack(values, digits).map_err(failed)?;
            columns.insert(name, packed);
            Ok::<(), Error>(())
        };
        let times: Vec<f64> = kept.iter().map(|row| self.times[*row]).collect();
        add("time".to_owned(), &times, TIME_DIGITS)?;
        for &dataset in &self.drawn {
            for (item, values) in self.kept_of(dataset, kept)?.iter().enumerate() {
                add(
                    column_name(dataset.name, self.item_name(dataset, item)),
                    values,
                    VALUE_DIGITS,
                )?;
            }
        }
        for (name, is_time) in OF_CONTACTS {
            let digits = if is_time { TIME_DIGITS } else { VALUE_DIGITS };
            add(name.to_owned(), &self.file.table(name)?.values, digits)?;
        }
        Ok(columns)
    }

    /// The columns of a dataset in the rows to keep, which rise.
    fn kept_of(
        &self,
        dataset: &'static Dataset,
        kept: &[usize],
    ) -> Result<Vec<Vec<f64>>, record::Error> {
        let mut columns = vec![Vec::with_capacity(kept.len()); self.width(dataset)];
        for rows in kept.chunk_by(|one, next| one / BLOCK == next / BLOCK) {
            let (Some(first), Some(last)) = (rows.first(), rows.last()) else { continue };
            let table = self.file.table_rows(dataset, *first..*last + 1)?;
            for (item, column) in columns.iter_mut().enumerate() {
                let value = |row: &usize| table.values[(row - first) * table.width + item];
                column.extend(rows.iter().map(value));
            }
        }
        Ok(columns)
    }

    /// How many columns a dataset has.
    fn width(&self, dataset: &Dataset) -> usize {
        dataset.items().map_or(1, |items| self.file.length(items))
    }

    fn item_name(&self, dataset: &Dataset, item: usize) -> Option<&str> {
        let names = self.file.names(dataset.items()?);
        names.get(item).map(String::as_str)
    }

    fn rows_to_keep(&self, most: usize) -> Result<Vec<usize>, record::Error> {
        let extremes: Vec<&'static Dataset> = (self.drawn.iter().copied())
            .filter(|dataset| dataset.drawn == Drawn::Extremes)
            .collect();
        let count = extremes.iter().map(|dataset| self.width(dataset)).sum();
        rows_to_keep(self.times.len(), most, count, |rows| {
            let mut columns = Vec::new();
            for dataset in &extremes {
                let table = self.file.table_rows(dataset, rows.clone())?;
                columns.extend((0..table.width).map(|item| table.column(item)));
            }
            Ok(columns)
        })
    }
}

impl PageRun<'_> {
    /// Samples in the page.
    pub fn samples(&self) -> usize {
        self.samples
    }
}
