//! Comma-separated values: a line of column names, then a line a row. Numbers are the shortest
//! that read back as the same doubles; what is unknown is `NaN`.

use super::table::{Cells, Field};
use std::fmt::Write;
use std::fs::File;
use std::path::Path;

/// A file of comma-separated values that is being written.
pub(crate) struct Csv(csv::Writer<File>);

impl Csv {
    /// Begins a table in an empty file.
    pub fn create(path: &Path, fields: &[Field]) -> Result<Self, csv::Error> {
        let mut writer = csv::Writer::from_path(path)?;
        writer.write_record(fields.iter().map(|field| &field.name))?;
        Ok(Csv(writer))
    }

    /// Writes some rows: the cells of each column.
    pub fn write(&mut self, columns: &[Cells]) -> Result<(), csv::Error> {
        let rows = columns.first().map_or(0, Cells::len);
        let mut field = String::new();
        for row in 0..rows {
            for cells in columns {
                field.clear();
                // writing to a string cannot fail
                let _ = match cells {
                    // a spreadsheet would reckon with what begins so, a quote makes it text
                    Cells::Text(words) if words[row].starts_with(['=', '+', '-', '@']) => {
                        write!(field, "'{}", words[row])
                    }
                    Cells::Text(words) => field.write_str(&words[row]),
                    Cells::Real(values) => write!(field, "{:?}", values[row]),
                    Cells::Whole(values) => write!(field, "{}", values[row]),
                };
                self.0.write_field(&field)?;
            }
            self.0.write_record(None::<&[u8]>)?;
        }
        Ok(())
    }

    /// Ends the table.
    pub fn finish(mut self) -> Result<(), csv::Error> {
        Ok(self.0.flush()?)
    }
}
