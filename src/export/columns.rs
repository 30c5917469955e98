//! The columns of an exported table.

use crate::record::{DATASETS, Dataset, Dimension, Error, ResultFile, Source, Values, column_name};
use std::ops::Range;

/// Tables of a result file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableName {
    /// Everything over time.
    Samples,
    /// Events.
    Events,
    /// Contacts.
    Contacts,
    /// Peaks of normal forces.
    Peaks,
}

impl TableName {
    /// The dimension that its rows are counted by.
    pub fn rows(self) -> Dimension {
        match self {
            TableName::Samples => Dimension::Time,
            TableName::Events => Dimension::Event,
            TableName::Contacts => Dimension::Contact,
            TableName::Peaks => Dimension::Peak,
        }
    }
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name: `angle.coupler`, `contact_begin`.
    pub name: String,
    /// Its unit, as in result files; `1` where there is none.
    pub unit: &'static str,
    /// What it is, in words.
    pub long_name: &'static str,
    /// How its values are stored in the result file.
    pub values: Values,
    /// Words for the values 0, 1, …: an event's kind, a clearance's name. Left out over time.
    pub words: Option<Vec<(i32, String)>>,
}

/// The columns of a table, and how many rows it has.
#[derive(Debug, Clone)]
pub struct Columns {
    /// Columns, time first.
    pub columns: Vec<Column>,
    /// Number of rows.
    pub rows: usize,
    datasets: Vec<&'static Dataset>,
}

impl Columns {
    /// The columns of a table of a file.
    pub fn of(file: &ResultFile, table: TableName) -> Self {
        let datasets: Vec<&'static Dataset> = DATASETS
            .iter()
            .filter(|dataset| dataset.rows() == table.rows() && file.dataset(dataset.name).is_ok())
            .collect();
        let columns = datasets.iter().flat_map(|dataset| {
            let items = dataset.items().map(|items| file.names(items));
            let names: Vec<String> = match items {
                None => vec![dataset.name.to_owned()],
                Some(items) => {
                    items.iter().map(|item| column_name(dataset.name, Some(item))).collect()
                }
            };
            names.into_iter().map(|name| Column {
                name,
                unit: dataset.unit,
                long_name: dataset.long_name,
                values: dataset.values,
                words: words(file, dataset),
            })
        });
        Columns { columns: columns.collect(), rows: file.length(table.rows()), datasets }
    }

    /// The values of some rows, column by column.
    ///
    /// # Errors
    /// What reading the file meets.
    pub fn read(&self, file: &ResultFile, rows: Range<usize>) -> Result<Vec<Vec<f64>>, Error> {
        let mut columns = Vec::with_capacity(self.columns.len());
        for dataset in &self.datasets {
            let table = file.table_rows(dataset, rows.clone())?;
            columns.extend((0..table.width).map(|item| table.column(item)));
        }
        Ok(columns)
    }

    /// All rows, at most `most` at a time.
    pub fn blocks(&self, most: usize) -> impl Iterator<Item = Range<usize>> + use<> {
        let rows = self.rows;
        (0..rows).step_by(most).map(move |begin| begin..rows.min(begin + most))
    }
}

/// Words for the values of a dataset, where a reader without its attributes would be lost.
fn words(file: &ResultFile, dataset: &Dataset) -> Option<Vec<(i32, String)>> {
    match (dataset.values, dataset.source) {
        (Values::Index, _) if dataset.name == "event_owner_index" => None,
        (Values::Index, _) => {
            let names = file.clearances().iter().zip(0..);
            Some(names.map(|(name, index)| (index, name.clone())).collect())
        }
        (Values::Flag(meanings), Source::Event(_)) => {
            let meanings = meanings.iter();
            Some(meanings.map(|(flag, word)| (i32::from(*flag), (*word).to_owned())).collect())
        }
        _ => None,
    }
}

impl Column {
    /// The word for a value; `None` if it stands for itself, or there is none.
    pub fn word(&self, value: f64) -> Option<&str> {
        let words = self.words.as_ref()?;
        let place = words.binary_search_by(|(of, _)| f64::from(*of).total_cmp(&value)).ok()?;
        Some(&words[place].1)
    }
}
