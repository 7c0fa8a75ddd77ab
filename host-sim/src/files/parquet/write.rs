//! Tables that are written.

use super::GEO;
use crate::error::{Error, Result};
use crate::files::output::{Staged, Writing};
use arrow_array::types::{Float32Type, Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, BinaryArray, PrimitiveArray, RecordBatch, StringArray};
use arrow_schema::{Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of rows of a row group (164 km). A group is encoded in memory before it is written.
const ROW_GROUP_ROWS: usize = 65_536;

/// A column to write.
#[derive(Debug)]
pub struct ParquetColumn {
    name: &'static str,
    values: ArrayRef,
    nullable: bool,
}

impl ParquetColumn {
    /// Creates a column of numbers, none missing.
    pub fn numbers(name: &'static str, values: impl Iterator<Item = f64>) -> Self {
        Self::new(
            name,
            PrimitiveArray::<Float64Type>::from_iter_values(values),
            false,
        )
    }

    /// Creates a column of numbers, some of which may be missing.
    pub fn optional(name: &'static str, values: impl Iterator<Item = Option<f64>>) -> Self {
        Self::new(name, values.collect::<PrimitiveArray<Float64Type>>(), true)
    }

    /// Creates a column of numbers in single precision, some of which may be missing.
    pub fn singles(name: &'static str, values: impl Iterator<Item = Option<f32>>) -> Self {
        Self::new(name, values.collect::<PrimitiveArray<Float32Type>>(), true)
    }

    /// Creates a column of integers.
    pub fn whole(name: &'static str, values: impl Iterator<Item = i64>) -> Self {
        Self::new(
            name,
            PrimitiveArray::<Int64Type>::from_iter_values(values),
            false,
        )
    }

    /// Creates a column with the same text, or null, in all `count` rows.
    pub fn text(name: &'static str, value: Option<&str>, count: usize) -> Self {
        let values: StringArray = std::iter::repeat_n(value, count).collect();
        Self::new(name, values, true)
    }

    /// Creates a column of texts, some of which may be missing.
    pub fn texts<'a>(name: &'static str, values: impl Iterator<Item = Option<&'a str>>) -> Self {
        Self::new(name, values.collect::<StringArray>(), true)
    }

    /// Creates a column of geometries, as well-known binary.
    pub fn geometries(name: &'static str, values: impl Iterator<Item = Vec<u8>>) -> Self {
        Self::new(name, BinaryArray::from_iter_values(values), false)
    }

    fn new(name: &'static str, values: impl Array + 'static, nullable: bool) -> Self {
        Self {
            name,
            values: Arc::new(values),
            nullable,
        }
    }

    fn field(&self) -> Field {
        let field = Field::new(self.name, self.values.data_type().clone(), self.nullable);
        let unit = |unit: &str| HashMap::from([("unit".to_owned(), unit.to_owned())]);
        field.with_metadata(unit_of(self.name).map(unit).unwrap_or_default())
    }
}

/// Returns the unit that a column's name ends in.
fn unit_of(name: &str) -> Option<&'static str> {
    let (_, unit) = name.rsplit_once('_')?;
    match unit {
        "s" => Some("s"),
        "m" => Some("m"),
        "m2" => Some("m^2"),
        "mps" => Some("m/s"),
        "mps2" => Some("m/s^2"),
        "rpm" => Some("1/min"),
        "radps" => Some("rad/s"),
        "n" => Some("N"),
        "nm" => Some("N m"),
        "pa" => Some("Pa"),
        "celsius" => Some("Cel"),
        "deg" => Some("deg"),
        "percent" => Some("%"),
        "percent2" => Some("%^2"),
        "kg" => Some("kg"),
        _ => None,
    }
}

fn schema_of(columns: &[ParquetColumn]) -> Schema {
    let fields: Vec<Field> = columns.iter().map(ParquetColumn::field).collect();
    Schema::new(fields)
}

/// Returns columns of one length as a table in memory; `metadata` is that of a file with it.
#[must_use]
pub fn in_memory(columns: Vec<ParquetColumn>, metadata: &[(&str, String)]) -> RecordBatch {
    let metadata = metadata
        .iter()
        .map(|(key, value)| (key_of(key), value.clone()));
    let schema = schema_of(&columns).with_metadata(metadata.collect::<HashMap<_, _>>());
    let values = columns.into_iter().map(|column| column.values).collect();
    RecordBatch::try_new(Arc::new(schema), values).expect("columns have the same length")
}

/// Writes columns to a file that appears when it is committed; `metadata` is the metadata of the
/// file.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(
    path: &Path,
    columns: Vec<ParquetColumn>,
    metadata: &[(&str, String)],
) -> Result<Staged> {
    let mut table = TableWriter::begin(path, &columns, metadata)?;
    table.write(columns)?;
    table.finish()
}

/// A table that is written in batches of rows.
pub struct TableWriter {
    path: PathBuf,
    schema: Arc<Schema>,
    writer: ArrowWriter<Writing>,
}

impl TableWriter {
    /// Begins a file with the schema of these columns; their rows are not written. `metadata` is
    /// the metadata of the file.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn begin(
        path: &Path,
        columns: &[ParquetColumn],
        metadata: &[(&str, String)],
    ) -> Result<Self> {
        let schema = Arc::new(schema_of(columns));
        let metadata = metadata
            .iter()
            .map(|(key, value)| KeyValue::new(key_of(key), value.clone()))
            .collect();
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_max_row_group_row_count(Some(ROW_GROUP_ROWS))
            .set_key_value_metadata(Some(metadata))
            .build();
        let writer = ArrowWriter::try_new(Writing::begin(path)?, schema.clone(), Some(properties))
            .map_err(|e| failed(path, e))?;
        Ok(Self {
            path: path.to_owned(),
            schema,
            writer,
        })
    }

    /// Appends rows.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn write(&mut self, columns: Vec<ParquetColumn>) -> Result<()> {
        let values = columns.into_iter().map(|column| column.values).collect();
        RecordBatch::try_new(self.schema.clone(), values)
            .map_err(Into::into)
            .and_then(|batch| self.writer.write(&batch))
            .map_err(|e| failed(&self.path, e))
    }

    /// Completes the file; it appears when it is committed.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn finish(self) -> Result<Staged> {
        let Self { path, writer, .. } = self;
        writer.into_inner().map_err(|e| failed(&path, e))?.finish()
    }
}

/// Returns the key of a file's metadata: ours have a prefix.
fn key_of(key: &str) -> String {
    if key == GEO {
        GEO.to_owned()
    } else {
        format!("roadgrade.{key}")
    }
}

fn failed(path: &Path, error: ParquetError) -> Error {
    Error::io(path)(std::io::Error::other(error))
}
