//! One run as the page tells it.

use super::Error;
use super::drawing::{self, Drawing};
use super::pack::{Packed, TIME_DIGITS, VALUE_DIGITS, pack};
use super::thin::rows_to_keep;
use crate::case::Case;
use crate::certify::Horizon;
use crate::record::{self, DATASETS, Dataset, Drawn, ResultFile, Table, column_name};
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
    tables: BTreeMap<&'static str, Table>,
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
        let mut tables = BTreeMap::new();
        for dataset in drawn() {
            match file.table(dataset.name) {
                Ok(table) => tables.insert(dataset.name, table),
                Err(record::Error::Missing { .. }) => None,
                Err(error) => return Err(error),
            };
        }
        Ok(Run {
            file,
            label,
            case: drawing::case_of(file),
            times: file.times()?,
            contacts: file.contacts()?,
            tables,
        })
    }

    /// A dataset over time; `None` where the file has it not.
    pub fn table(&self, name: &str) -> Option<&Table> {
        self.tables.get(name)
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
        let kept = self.rows_to_keep(most_samples);
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
        for (name, table) in &self.tables {
            for item in 0..table.width {
                let column = table.column(item);
                let values: Vec<f64> = kept.iter().map(|row| column[*row]).collect();
                add(column_name(name, self.item_name(table, item)), &values, VALUE_DIGITS)?;
            }
        }
        for (name, is_time) in OF_CONTACTS {
            let digits = if is_time { TIME_DIGITS } else { VALUE_DIGITS };
            add(name.to_owned(), &self.file.table(name)?.values, digits)?;
        }
        Ok(columns)
    }

    fn item_name(&self, table: &Table, item: usize) -> Option<&str> {
        let names = self.file.names(table.dataset.items()?);
        names.get(item).map(String::as_str)
    }

    fn rows_to_keep(&self, most: usize) -> Vec<usize> {
        if self.times.len() <= most {
            return (0..self.times.len()).collect();
        }
        let extremes = drawn().filter(|dataset| dataset.drawn == Drawn::Extremes);
        let tables = extremes.filter_map(|dataset| self.table(dataset.name));
        let columns: Vec<Vec<f64>> =
            tables.flat_map(|table| (0..table.width).map(|item| table.column(item))).collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        rows_to_keep(self.times.len(), most, &columns)
    }
}

impl PageRun<'_> {
    /// Samples in the page.
    pub fn samples(&self) -> usize {
        self.samples
    }
}
