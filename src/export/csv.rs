//! Comma-separated values: a line of column names, then a line a row. Numbers are the shortest
//! that read back as the same doubles; what is unknown is `NaN`.

use super::{Columns, WriteError};
use crate::record::{ResultFile, Values};
use std::fmt::Write;
use std::path::Path;

/// Rows that are read at a time.
const BLOCK: usize = 8 * 4096;

/// Writes a table to an empty file.
pub(super) fn write(file: &ResultFile, columns: &Columns, path: &Path) -> Result<(), WriteError> {
    let mut writer = csv::Writer::from_path(path).map_err(WriteError::write)?;
    let names = columns.columns.iter().map(|column| &column.name);
    writer.write_record(names).map_err(WriteError::write)?;
    let mut field = String::new();
    for rows in columns.blocks(BLOCK) {
        let values = columns.read(file, rows.clone())?;
        for row in 0..rows.len() {
            for (column, values) in columns.columns.iter().zip(&values) {
                field.clear();
                let value = values[row];
                let written = match (column.word(value), column.values) {
                    // a spreadsheet would reckon with what begins so, a quote makes it text
                    (Some(word), _) if word.starts_with(['=', '+', '-', '@']) => {
                        write!(field, "'{word}")
                    }
                    (Some(word), _) => field.write_str(word),
                    (None, Values::Real) => write!(field, "{value:?}"),
                    (None, _) => write!(field, "{value}"),
                };
                written.map_err(WriteError::write)?;
                writer.write_field(&field).map_err(WriteError::write)?;
            }
            writer.write_record(None::<&[u8]>).map_err(WriteError::write)?;
        }
    }
    writer.flush().map_err(WriteError::write)
}
