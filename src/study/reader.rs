//! The tables of a study, read again.

use super::{ENSEMBLE, Error, Study};
use crate::model::Model;
use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;
use serde_json::Value;
use std::fs::File;
use std::path::{Path, PathBuf};

/// The folder of a study that has been made.
pub struct Recorded {
    /// The study, as its tables tell it.
    pub study: Study,
    /// A row of each run.
    pub runs: Rows,
    /// Rows of its revolutions.
    pub revolutions: Rows,
    /// Rows of its section points.
    pub sections: Rows,
    /// A row of each run that failed.
    pub failures: Rows,
    /// Rows of the revolutions of ensembles, where it has some.
    pub ensemble: Option<Rows>,
}

/// A table of a study.
pub struct Rows {
    path: PathBuf,
    reader: SerializedFileReader<File>,
    names: Vec<String>,
    units: Value,
}

impl Recorded {
    /// Opens the tables in a folder.
    ///
    /// # Errors
    /// Tables that are missing or are no tables of a study.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let runs = Rows::open(folder, "runs")?;
        let [study, case] = [runs.text("study_toml")?, runs.text("case_toml")?];
        let study = Study::recorded(&folder.join("study"), &study, &case)?;
        Ok(Recorded {
            runs,
            revolutions: Rows::open(folder, "revolutions")?,
            sections: Rows::open(folder, "sections")?,
            failures: Rows::open(folder, "failures")?,
            ensemble: match study.ensemble {
                Some(_) => Some(Rows::open(folder, ENSEMBLE)?),
                None => None,
            },
            study,
        })
    }

    /// Radial clearance (m) of a joint in a run; `None` where it has none there.
    pub fn radial_clearance(&self, run: u64, joint: &str) -> Option<f64> {
        let case = self.study.case(run).ok()?;
        let model = Model::<f64>::new(&case.description).ok()?;
        let place = model.names().clearances.iter().position(|name| name == joint)?;
        Some(model.clearances()[place].radial)
    }
}

impl Rows {
    fn open(folder: &Path, name: &str) -> Result<Self, Error> {
        let path = folder.join(format!("{name}.parquet"));
        let unreadable = |source| Error::Unreadable { path: path.clone(), source };
        let file = File::open(&path).map_err(unreadable)?;
        let reader = SerializedFileReader::new(file).map_err(|source| damaged(&path, source))?;
        let columns = reader.metadata().file_metadata().schema_descr().columns();
        let names = columns.iter().map(|column| column.name().to_owned()).collect();
        let mut rows = Rows { path, reader, names, units: Value::Null };
        rows.units = serde_json::from_str(&rows.text("units")?).unwrap_or_default();
        Ok(rows)
    }

    /// Names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.reader.metadata().file_metadata().num_rows().max(0) as usize
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The unit of a column; `1` where there is none.
    pub fn unit(&self, name: &str) -> &str {
        self.units[name].as_str().unwrap_or("1")
    }

    /// A column of numbers.
    ///
    /// # Errors
    /// There is none of this name, or it cannot be read.
    pub fn column(&self, name: &str) -> Result<Vec<f64>, Error> {
        let failed = |source| damaged(&self.path, source);
        let missing = || failed(ParquetError::General(format!("it has no numbers {name:?}")));
        let place = self.names.iter().position(|known| known == name).ok_or_else(missing)?;
        let mut all = Vec::with_capacity(self.len());
        for group in 0..self.reader.num_row_groups() {
            let group = self.reader.get_row_group(group).map_err(failed)?;
            let rows = group.metadata().num_rows().max(0) as usize;
            let read = match group.get_column_reader(place).map_err(failed)? {
                ColumnReader::DoubleColumnReader(mut column) => {
                    column.read_records(rows, None, None, &mut all)
                }
                ColumnReader::Int32ColumnReader(mut column) => {
                    let mut whole = Vec::with_capacity(rows);
                    let read = column.read_records(rows, None, None, &mut whole);
                    all.extend(whole.into_iter().map(f64::from));
                    read
                }
                _ => return Err(missing()),
            };
            read.map_err(failed)?;
        }
        Ok(all)
    }

    /// A column of texts.
    ///
    /// # Errors
    /// There is none of this name, or it cannot be read.
    pub fn texts(&self, name: &str) -> Result<Vec<String>, Error> {
        let failed = |source| damaged(&self.path, source);
        let missing = || failed(ParquetError::General(format!("it has no texts {name:?}")));
        let place = self.names.iter().position(|known| known == name).ok_or_else(missing)?;
        let mut all = Vec::with_capacity(self.len());
        for group in 0..self.reader.num_row_groups() {
            let group = self.reader.get_row_group(group).map_err(failed)?;
            let rows = group.metadata().num_rows().max(0) as usize;
            let ColumnReader::ByteArrayColumnReader(mut column) =
                group.get_column_reader(place).map_err(failed)?
            else {
                return Err(missing());
            };
            let mut texts = Vec::with_capacity(rows);
            column.read_records(rows, None, None, &mut texts).map_err(failed)?;
            all.extend(texts.iter().map(|text| String::from_utf8_lossy(text.data()).into_owned()));
        }
        Ok(all)
    }

    /// A text of the metadata.
    pub(super) fn text(&self, key: &str) -> Result<String, Error> {
        let metadata = self.reader.metadata().file_metadata().key_value_metadata();
        let found = metadata.into_iter().flatten().find(|entry| entry.key == key);
        found.and_then(|entry| entry.value.clone()).ok_or_else(|| {
            damaged(&self.path, ParquetError::General(format!("it does not tell {key}")))
        })
    }
}

fn damaged(path: &Path, source: ParquetError) -> Error {
    Error::NotATable { path: path.to_owned(), source }
}
