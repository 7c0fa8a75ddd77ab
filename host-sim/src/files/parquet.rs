//! Tables of numbers as Parquet: column names as in the CSV files, units in the metadata.

use super::limits;
use super::output::{Staged, Writing};
use super::parquet_column::NumberColumn;
use super::parquet_pages;
use crate::error::{Error, Result, out_of_files};
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, BinaryArray, PrimitiveArray, RecordBatch, StringArray};
use arrow_schema::{Field, Schema};
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use parquet::arrow::{ArrowWriter, ProjectionMask};
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use std::cell::Cell;
use std::collections::HashMap;
use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Once};

/// Number of rows that are decoded at once.
const BATCH_ROWS: usize = 8192;
/// What altitudes refer to, in the metadata of files: the receiver decides.
pub const VERTICAL_DATUM: &str =
    "mean sea level, as the GNSS receiver reports it (by its own geoid model)";
/// Number of rows of a row group (164 km). A group is encoded in memory before it is written.
const ROW_GROUP_ROWS: usize = 65_536;

/// Returns true if the name of the file ends in `.parquet`.
#[must_use]
pub fn is_parquet(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}

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
        "deg" => Some("deg"),
        "percent" => Some("%"),
        "percent2" => Some("%^2"),
        "kg" => Some("kg"),
        _ => None,
    }
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
        let fields: Vec<Field> = columns.iter().map(ParquetColumn::field).collect();
        let schema = Arc::new(Schema::new(fields));
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

/// Key of the metadata of GeoParquet, which has no prefix.
pub const GEO: &str = "geo";

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

/// A Parquet file whose footer has been read.
pub struct Opened<'a> {
    path: &'a Path,
    most_rows: usize,
    builder: ParquetRecordBatchReaderBuilder<File>,
}

/// Opens a file.
///
/// # Errors
/// Returns an error if the file cannot be read or its footer is damaged.
pub fn open(path: &Path) -> Result<Opened<'_>> {
    let file = File::open(path).map_err(Error::io(path))?;
    if file.metadata().map_err(Error::io(path))?.is_dir() {
        let problem = "a folder; expected a file";
        return Err(Error::content(path, problem));
    }
    guarded(path, || {
        let builder = ParquetRecordBatchReaderBuilder::try_new(file)
            .map_err(|e| damaged(path, &e.to_string()))?;
        Ok(Opened {
            path,
            most_rows: usize::MAX,
            builder,
        })
    })
}

/// Runs `decode` and reports a panic as damage. Decoders can panic on damaged files (an index out
/// of range in a page); that must not end a fusion of thousands of files. The caller discards all
/// changes of `decode`.
fn guarded<T>(path: &Path, decode: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_quietly(decode).unwrap_or_else(|| Err(damaged(path, "its pages cannot be decoded")))
}

/// Returns the result of `attempt`, or `None` if it panics. The panic is not printed. The panic
/// hook is set once for all threads: it is silent for this thread, and calls the previous hook for
/// the others.
fn catch_quietly<T>(attempt: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    thread_local! {
        static QUIET: Cell<bool> = const { Cell::new(false) };
    }
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !QUIET.get() {
                before(panic);
            }
        }));
    });
    QUIET.set(true);
    let result = catch_unwind(AssertUnwindSafe(attempt));
    QUIET.set(false);
    result.ok()
}

fn damaged(path: &Path, problem: &str) -> Error {
    // The decoder opens the file again and again.
    if let Some(error) = out_of_files(problem) {
        return Error::io(path)(error);
    }
    Error::content(
        path,
        format!("damaged, or not a Parquet file: {problem}; restore the file as it was written"),
    )
}

impl Opened<'_> {
    /// Limits the number of rows, for a table that is kept in memory.
    #[must_use]
    pub const fn with_most_rows(mut self, most_rows: usize) -> Self {
        self.most_rows = most_rows;
        self
    }

    /// Returns the metadata value of this key; see [`stage`].
    pub fn metadata(&self, key: &str) -> Option<&str> {
        let pairs = self.builder.metadata().file_metadata().key_value_metadata();
        pairs?
            .iter()
            .find(|pair| pair.key.strip_prefix("roadgrade.") == Some(key))?
            .value
            .as_deref()
    }

    /// Returns the number of rows, as the footer states it.
    pub fn rows(&self) -> usize {
        usize::try_from(self.builder.metadata().file_metadata().num_rows()).unwrap_or(0)
    }

    /// Returns true if there is a column of this name.
    #[must_use]
    pub fn has_column(&self, name: &str) -> bool {
        self.builder.schema().field_with_name(name).is_ok()
    }

    /// Passes these columns of every row to `take`, row group by row group. Other columns are not
    /// read. Integers are converted to floating point.
    ///
    /// # Errors
    /// Returns an error if a column is missing or not numeric, if a value that `take` needs is
    /// missing, and if the file is damaged.
    pub fn read<const N: usize>(
        self,
        names: [&str; N],
        mut take: impl FnMut([Option<f64>; N]) -> Result<()>,
    ) -> Result<()> {
        self.read_texts(names, [], |numbers, []| take(numbers))
    }

    /// Reads columns as [`Self::read`] does, with numeric columns that older files lack. Such a
    /// column is null in every row.
    ///
    /// # Errors
    /// Returns the errors of [`Self::read`].
    pub fn read_newer<const N: usize, const M: usize>(
        self,
        names: [&str; N],
        newer: [&str; M],
        mut take: impl FnMut([Option<f64>; N], [Option<f64>; M]) -> Result<()>,
    ) -> Result<()> {
        self.read_batches(names, newer, |rows, numbers, newer| {
            (0..rows).try_for_each(|row| {
                take(
                    numbers.each_ref().map(|column| column.at(row)),
                    newer.each_ref().map(|column| column.at(row)),
                )
            })
        })
    }

    /// Reads columns as [`Self::read_newer`] does, and passes `take` the number of rows of each
    /// batch and its columns.
    ///
    /// # Errors
    /// Returns the errors of [`Self::read`].
    pub fn read_batches<const N: usize, const M: usize>(
        self,
        names: [&str; N],
        newer: [&str; M],
        mut take: impl FnMut(usize, &[NumberColumn; N], &[NumberColumn; M]) -> Result<()>,
    ) -> Result<()> {
        let wanted = names.into_iter().chain(newer).collect();
        guarded(self.path, || {
            self.decode(&names, wanted, |path, batch| {
                let numbers = number_columns(path, batch, names)?;
                take(
                    batch.num_rows(),
                    &numbers,
                    &number_columns(path, batch, newer)?,
                )
            })
        })
    }

    /// Reads columns as [`Self::read`] does, with text columns. A text column that the file lacks
    /// is null in every row.
    ///
    /// # Errors
    /// Returns the errors of [`Self::read`].
    pub fn read_texts<const N: usize, const M: usize>(
        self,
        names: [&str; N],
        texts: [&str; M],
        mut take: impl FnMut([Option<f64>; N], [Option<&str>; M]) -> Result<()>,
    ) -> Result<()> {
        let wanted = names.into_iter().chain(texts).collect();
        guarded(self.path, || {
            self.decode(&names, wanted, |path, batch| {
                let numbers = number_columns(path, batch, names)?;
                let words = text_columns(path, batch, texts)?;
                (0..batch.num_rows()).try_for_each(|row| {
                    let text = |i: usize| {
                        let known = words[i].filter(|values| !values.is_null(row));
                        known.map(|values| values.value(row))
                    };
                    take(
                        numbers.each_ref().map(|column| column.at(row)),
                        std::array::from_fn(text),
                    )
                })
            })
        })
    }

    /// Passes the `wanted` columns of the file to `take`, batch by batch. It must have those that
    /// are `needed`.
    fn decode(
        self,
        needed: &[&str],
        wanted: Vec<&str>,
        mut take: impl FnMut(&Path, &RecordBatch) -> Result<()>,
    ) -> Result<()> {
        if self.rows() > self.most_rows {
            return Err(limits::too_many_rows(self.path, self.most_rows));
        }
        if let Some(name) = needed.iter().find(|name| !self.has_column(name)) {
            let problem = format!("no column {name}; expected the columns of docs/formats.md");
            return Err(Error::content(self.path, problem));
        }
        let Self {
            path,
            most_rows,
            builder,
        } = self;
        let file = File::open(path).map_err(Error::io(path))?;
        parquet_pages::check(&file, builder.metadata(), &wanted)
            .map_err(|problem| damaged(path, &problem))?;
        let mut rows = 0;
        let projection = ProjectionMask::columns(builder.parquet_schema(), wanted);
        let batches = builder
            .with_projection(projection)
            .with_batch_size(BATCH_ROWS)
            .build()
            .map_err(|e| damaged(path, &e.to_string()))?;
        for batch in batches {
            let batch = batch.map_err(|e| damaged(path, &e.to_string()))?;
            rows += batch.num_rows();
            if rows > most_rows {
                return Err(limits::too_many_rows(path, most_rows));
            }
            take(path, &batch)?;
        }
        Ok(())
    }
}

/// Returns these columns of a batch; one that the file lacks is absent.
fn number_columns<'b, const N: usize>(
    path: &Path,
    batch: &'b RecordBatch,
    names: [&str; N],
) -> Result<[NumberColumn<'b>; N]> {
    let mut columns = std::array::from_fn(|_| NumberColumn::absent());
    for (column, name) in columns.iter_mut().zip(names) {
        if let Some(values) = batch.column_by_name(name) {
            *column = NumberColumn::of(values).ok_or_else(|| {
                let problem = format!("column {name} is not of numbers; expected doubles");
                Error::content(path, problem)
            })?;
        }
    }
    Ok(columns)
}

/// Returns these columns of a batch; `None` for one that the file lacks.
fn text_columns<'b, const N: usize>(
    path: &Path,
    batch: &'b RecordBatch,
    names: [&str; N],
) -> Result<[Option<&'b StringArray>; N]> {
    let mut columns = [None; N];
    for (column, name) in columns.iter_mut().zip(names) {
        let values = batch.column_by_name(name);
        let strings = values.map(|values| {
            values.as_any().downcast_ref().ok_or_else(|| {
                let problem = format!("column {name} is not of texts; expected strings");
                Error::content(path, problem)
            })
        });
        *column = strings.transpose()?;
    }
    Ok(columns)
}

impl Opened<'_> {
    /// Returns the names of all columns.
    pub fn column_names(&self) -> impl Iterator<Item = &str> {
        self.builder
            .schema()
            .fields()
            .iter()
            .map(|field| &**field.name())
    }

    /// Returns a reader of these columns, batch by batch: its memory does not depend on the length
    /// of the table.
    ///
    /// # Errors
    /// Returns an error if the file is damaged.
    pub fn batches(self, names: Vec<String>) -> Result<NumberBatches> {
        let path = self.path;
        guarded(path, || {
            let builder = self.builder;
            let wanted: Vec<&str> = names.iter().map(String::as_str).collect();
            let file = File::open(path).map_err(Error::io(path))?;
            parquet_pages::check(&file, builder.metadata(), &wanted)
                .map_err(|problem| damaged(path, &problem))?;
            let projection = ProjectionMask::columns(builder.parquet_schema(), wanted);
            let reader = builder
                .with_projection(projection)
                .with_batch_size(BATCH_ROWS)
                .build()
                .map_err(|e| damaged(path, &e.to_string()))?;
            Ok(NumberBatches {
                path: path.to_owned(),
                names,
                reader,
            })
        })
    }
}

/// A reader of columns of numbers, batch by batch.
pub struct NumberBatches {
    path: PathBuf,
    names: Vec<String>,
    reader: ParquetRecordBatchReader,
}

impl NumberBatches {
    /// Returns the path, for messages.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the next rows: the columns in the order in which they were asked for. Switches are 0 and
    /// 1. Returns `None` at the end.
    ///
    /// # Errors
    /// Returns an error if a column is not numeric, and if the file is damaged.
    pub fn next_batch(&mut self) -> Result<Option<Vec<Vec<Option<f64>>>>> {
        let Self {
            path,
            names,
            reader,
        } = self;
        guarded(path, || {
            let Some(batch) = reader.next() else {
                return Ok(None);
            };
            let batch = batch.map_err(|e| damaged(path, &e.to_string()))?;
            let column = |name: &String| {
                let values = batch.column_by_name(name).and_then(NumberColumn::of);
                let values = values.ok_or_else(|| {
                    let problem = format!("column {name} is not of numbers; expected doubles");
                    Error::content(path, problem)
                })?;
                Ok((0..batch.num_rows()).map(|row| values.at(row)).collect())
            };
            names.iter().map(column).collect::<Result<_>>().map(Some)
        })
    }
}
