//! Apache Parquet: doubles, flags as 8-bit integers, words as text; Snappy.
//!
//! Units and descriptions stand in the file's metadata: `units` and `long_names`, each a JSON
//! object by column, and once more in `PANDAS_ATTRS`, from which pandas fills `DataFrame.attrs`.
//! All texts of the result file's root follow: title, case, versions.

use super::table::{Cells, Field, Holds};
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

/// A Parquet file that is being written.
pub(crate) struct Parquet(SerializedFileWriter<File>);

impl Parquet {
    /// Begins a table in an empty file, with more texts for its metadata.
    pub fn create(
        path: &Path,
        fields: &[Field],
        texts: Vec<(String, String)>,
    ) -> Result<Self, ParquetError> {
        let output = File::create(path)?;
        let properties = Arc::new(properties(fields, texts));
        Ok(Parquet(SerializedFileWriter::new(output, schema(fields)?, properties)?))
    }

    /// Writes some rows, which become a row group: the cells of each column.
    pub fn write(&mut self, columns: &[Cells]) -> Result<(), ParquetError> {
        let mut group = self.0.next_row_group()?;
        for cells in columns {
            if let Some(mut chunk) = group.next_column()? {
                write_column(cells, &mut chunk)?;
                chunk.close()?;
            }
        }
        group.close().map(drop)
    }

    /// Ends the table.
    pub fn finish(self) -> Result<(), ParquetError> {
        self.0.close().map(drop)
    }
}

fn schema(fields: &[Field]) -> Result<Arc<Type>, ParquetError> {
    let fields = fields.iter().map(|field| {
        let (physical, logical) = match field.holds {
            Holds::Real | Holds::Repeated => (PhysicalType::DOUBLE, None),
            Holds::Index => (PhysicalType::INT32, None),
            Holds::Flag => (PhysicalType::INT32, Some(LogicalType::integer(8, true))),
            Holds::Text => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let field = Type::primitive_type_builder(&field.name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_logical_type(logical)
            .build()?;
        Ok(Arc::new(field))
    });
    let fields = fields.collect::<Result<Vec<_>, ParquetError>>()?;
    Ok(Arc::new(Type::group_type_builder("freeplay").with_fields(fields).build()?))
}

fn properties(fields: &[Field], texts: Vec<(String, String)>) -> WriterProperties {
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(concat!("freeplay ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(metadata(fields, texts)));
    for field in fields.iter().filter(|field| field.holds == Holds::Real) {
        let path = ColumnPath::new(vec![field.name.clone()]);
        properties = properties.set_column_dictionary_enabled(path, false);
    }
    properties.build()
}

fn metadata(fields: &[Field], texts: Vec<(String, String)>) -> Vec<KeyValue> {
    let by_column = |of: fn(&Field) -> &String| {
        let pairs = fields.iter();
        Map::from_iter(pairs.map(|field| (field.name.clone(), Value::from(of(field).as_str()))))
    };
    let units = by_column(|field| &field.unit);
    let long_names = by_column(|field| &field.long_name);
    let entry = |key: &str, value: Value| KeyValue::new(key.to_owned(), value.to_string());
    let mut all = vec![
        entry("units", json!(units)),
        entry("long_names", json!(long_names)),
        entry("PANDAS_ATTRS", json!({ "units": units, "long_names": long_names })),
    ];
    all.extend(texts.into_iter().map(|(name, value)| KeyValue::new(name, value)));
    all
}

fn write_column(cells: &Cells, chunk: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
    match cells {
        Cells::Text(words) => {
            let words: Vec<ByteArray> =
                words.iter().map(|word| ByteArray::from(word.as_str())).collect();
            chunk.typed::<ByteArrayType>().write_batch(&words, None, None)?;
        }
        Cells::Real(values) => {
            chunk.typed::<DoubleType>().write_batch(values, None, None)?;
        }
        Cells::Whole(values) => {
            chunk.typed::<Int32Type>().write_batch(values, None, None)?;
        }
    }
    Ok(())
}
