//! Apache Parquet: doubles, flags as 8-bit integers, words as text; Snappy.
//!
//! Units and descriptions stand in the file's metadata: `units` and `long_names`, each a JSON
//! object by column, and once more in `PANDAS_ATTRS`, from which pandas fills `DataFrame.attrs`.
//! All texts of the result file's root follow: title, case, versions.

use super::{Column, Columns, WriteError};
use crate::record::{ResultFile, Values};
use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type};
use serde_json::{Map, Value, json};
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// Rows of a row group.
const GROUP: usize = 16 * 4096;

/// Writes a table to an empty file.
pub(super) fn write(file: &ResultFile, columns: &Columns, path: &Path) -> Result<(), WriteError> {
    let output = File::create(path).map_err(WriteError::write)?;
    let schema = schema(columns).map_err(WriteError::write)?;
    let properties = Arc::new(properties(file, columns));
    let mut writer =
        SerializedFileWriter::new(output, schema, properties).map_err(WriteError::write)?;
    for rows in columns.blocks(GROUP) {
        let values = columns.read(file, rows)?;
        let mut group = writer.next_row_group().map_err(WriteError::write)?;
        for (column, values) in columns.columns.iter().zip(&values) {
            if let Some(mut chunk) = group.next_column().map_err(WriteError::write)? {
                write_column(column, values, &mut chunk).map_err(WriteError::write)?;
                chunk.close().map_err(WriteError::write)?;
            }
        }
        group.close().map_err(WriteError::write)?;
    }
    writer.close().map_err(WriteError::write)?;
    Ok(())
}

fn schema(columns: &Columns) -> Result<Arc<Type>, ParquetError> {
    let fields = columns.columns.iter().map(|column| {
        let physical = match (&column.words, column.values) {
            (Some(_), _) => PhysicalType::BYTE_ARRAY,
            (None, Values::Real) => PhysicalType::DOUBLE,
            (None, Values::Index | Values::Flag(_)) => PhysicalType::INT32,
        };
        let logical = match (&column.words, column.values) {
            (Some(_), _) => Some(LogicalType::String),
            (None, Values::Flag(_)) => Some(LogicalType::integer(8, true)),
            (None, _) => None,
        };
        let field = Type::primitive_type_builder(&column.name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_logical_type(logical)
            .build()?;
        Ok(Arc::new(field))
    });
    let fields = fields.collect::<Result<Vec<_>, ParquetError>>()?;
    Ok(Arc::new(Type::group_type_builder("freeplay").with_fields(fields).build()?))
}

fn properties(file: &ResultFile, columns: &Columns) -> WriterProperties {
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(concat!("freeplay ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(metadata(file, columns)));
    for column in columns.columns.iter().filter(|column| column.values == Values::Real) {
        // no two doubles of a trajectory are alike
        let path = ColumnPath::new(vec![column.name.clone()]);
        properties = properties.set_column_dictionary_enabled(path, false);
    }
    properties.build()
}

fn metadata(file: &ResultFile, columns: &Columns) -> Vec<KeyValue> {
    let by_column = |of: fn(&Column) -> &'static str| {
        let pairs = columns.columns.iter();
        Map::from_iter(pairs.map(|column| (column.name.clone(), Value::from(of(column)))))
    };
    let units = by_column(|column| column.unit);
    let long_names = by_column(|column| column.long_name);
    let entry = |key: &str, value: Value| KeyValue::new(key.to_owned(), value.to_string());
    let mut all = vec![
        entry("units", json!(units)),
        entry("long_names", json!(long_names)),
        entry("PANDAS_ATTRS", json!({ "units": units, "long_names": long_names })),
    ];
    let texts = file.attributes().iter();
    all.extend(texts.map(|(name, value)| KeyValue::new(name.clone(), value.to_string())));
    all
}

fn write_column(
    column: &Column,
    values: &[f64],
    chunk: &mut SerializedColumnWriter<'_>,
) -> Result<(), ParquetError> {
    if column.words.is_some() {
        let words = values.iter().map(|value| ByteArray::from(column.word(*value).unwrap_or("")));
        let words: Vec<ByteArray> = words.collect();
        chunk.typed::<ByteArrayType>().write_batch(&words, None, None)?;
    } else if column.values == Values::Real {
        chunk.typed::<DoubleType>().write_batch(values, None, None)?;
    } else {
        let whole: Vec<i32> = values.iter().map(|value| *value as i32).collect();
        chunk.typed::<Int32Type>().write_batch(&whole, None, None)?;
    }
    Ok(())
}
