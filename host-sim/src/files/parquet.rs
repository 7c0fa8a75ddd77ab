//! Tables of numbers as Parquet: columns named as in the CSV files, units in the metadata.

use super::output::{Staged, Writing};
use crate::error::{Error, Result};
use arrow_array::types::{ArrowPrimitiveType, Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, PrimitiveArray, RecordBatch, StringArray};
use arrow_schema::{Field, Schema};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
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

/// Rows that are decoded at once.
const BATCH_ROWS: usize = 8192;
/// Rows of a row group (164 km), which is encoded in memory before it is written.
const ROW_GROUP_ROWS: usize = 65_536;

/// Whether a file of this name is, or is to be, Parquet.
#[must_use]
pub fn is_parquet(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}

/// A column to write.
#[derive(Debug)]
pub struct Column {
    name: &'static str,
    values: ArrayRef,
    nullable: bool,
}

impl Column {
    /// Numbers that are all there.
    pub fn numbers(name: &'static str, values: impl Iterator<Item = f64>) -> Self {
        Self::new(
            name,
            PrimitiveArray::<Float64Type>::from_iter_values(values),
            false,
        )
    }

    /// Numbers of which some may be missing.
    pub fn optional(name: &'static str, values: impl Iterator<Item = Option<f64>>) -> Self {
        Self::new(name, values.collect::<PrimitiveArray<Float64Type>>(), true)
    }

    /// Whole numbers.
    pub fn whole(name: &'static str, values: impl Iterator<Item = i64>) -> Self {
        Self::new(
            name,
            PrimitiveArray::<Int64Type>::from_iter_values(values),
            false,
        )
    }

    /// The same text, or none, in all of `count` rows.
    pub fn text(name: &'static str, value: Option<&str>, count: usize) -> Self {
        let values: StringArray = std::iter::repeat_n(value, count).collect();
        Self::new(name, values, true)
    }

    /// Texts of which some may be missing.
    pub fn texts<'a>(name: &'static str, values: impl Iterator<Item = Option<&'a str>>) -> Self {
        Self::new(name, values.collect::<StringArray>(), true)
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

/// The unit that a column's name carries.
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
        _ => None,
    }
}

/// Writes columns, to appear when committed; `metadata` goes with the file as a whole.
///
/// # Errors
/// What the file system says.
pub fn stage(path: &Path, columns: Vec<Column>, metadata: &[(&str, String)]) -> Result<Staged> {
    let mut table = TableWriter::begin(path, &columns, metadata)?;
    table.write(columns)?;
    table.finish()
}

/// A table that is written some rows at a time.
pub struct TableWriter {
    path: PathBuf,
    schema: Arc<Schema>,
    writer: ArrowWriter<Writing>,
}

impl TableWriter {
    /// Begins a file with columns like these, whatever their rows; `metadata` goes with the file
    /// as a whole.
    ///
    /// # Errors
    /// What the file system says.
    pub fn begin(path: &Path, columns: &[Column], metadata: &[(&str, String)]) -> Result<Self> {
        let fields: Vec<Field> = columns.iter().map(Column::field).collect();
        let schema = Arc::new(Schema::new(fields));
        let metadata = metadata
            .iter()
            .map(|(key, value)| KeyValue::new(format!("roadgrade.{key}"), value.clone()))
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

    /// Writes rows behind the others.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&mut self, columns: Vec<Column>) -> Result<()> {
        let values = columns.into_iter().map(|column| column.values).collect();
        RecordBatch::try_new(self.schema.clone(), values)
            .map_err(Into::into)
            .and_then(|batch| self.writer.write(&batch))
            .map_err(|e| failed(&self.path, e))
    }

    /// Ends the file, to appear when committed.
    ///
    /// # Errors
    /// What the file system says.
    pub fn finish(self) -> Result<Staged> {
        let Self { path, writer, .. } = self;
        writer.into_inner().map_err(|e| failed(&path, e))?.finish()
    }
}

fn failed(path: &Path, error: ParquetError) -> Error {
    Error::io(path)(std::io::Error::other(error))
}

/// A file whose footer has been read.
pub struct Opened<'a> {
    path: &'a Path,
    builder: ParquetRecordBatchReaderBuilder<File>,
}

/// Opens a file.
///
/// # Errors
/// If it cannot be read or its footer is damaged.
pub fn open(path: &Path) -> Result<Opened<'_>> {
    let file = File::open(path).map_err(Error::io(path))?;
    if file.metadata().map_err(Error::io(path))?.is_dir() {
        let problem = "a folder; expected a file";
        return Err(Error::content(path, problem));
    }
    guarded(path, || {
        let builder = ParquetRecordBatchReaderBuilder::try_new(file)
            .map_err(|e| damaged(path, &e.to_string()))?;
        Ok(Opened { path, builder })
    })
}

/// Decoders of damaged files may panic (an index out of range in a page): that is damage too, and
/// must not end a fusion of thousands of files. Whatever `decode` has changed is to be dropped.
fn guarded<T>(path: &Path, decode: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_quietly(decode).unwrap_or_else(|| Err(damaged(path, "its pages make no sense")))
}

/// What `attempt` gives, or `None` where it panics, of which nothing is printed. The panic hook is
/// set once for all threads and asks whether this one wants quiet; else it does what it did before.
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
    Error::content(
        path,
        format!("damaged, or no Parquet file: {problem}; expected the file as it was written"),
    )
}

impl Opened<'_> {
    /// What `stage` was given under this key.
    pub fn metadata(&self, key: &str) -> Option<&str> {
        let pairs = self.builder.metadata().file_metadata().key_value_metadata();
        pairs?
            .iter()
            .find(|pair| pair.key.strip_prefix("roadgrade.") == Some(key))?
            .value
            .as_deref()
    }

    /// Number of rows, as the footer says.
    pub fn rows(&self) -> usize {
        usize::try_from(self.builder.metadata().file_metadata().num_rows()).unwrap_or(0)
    }

    /// Whether there is a column of this name.
    #[must_use]
    pub fn has_column(&self, name: &str) -> bool {
        self.builder.schema().field_with_name(name).is_ok()
    }

    /// Passes these columns of every row to `take`, row group by row group; the others are not
    /// read. Whole numbers come as floating ones.
    ///
    /// # Errors
    /// A column that is missing, not numbers, or lacks a value that `take` needs; damage.
    pub fn read<const N: usize>(
        self,
        names: [&str; N],
        mut take: impl FnMut([Option<f64>; N]) -> Result<()>,
    ) -> Result<()> {
        self.read_texts(names, [], |numbers, []| take(numbers))
    }

    /// As [`Self::read`], with columns of texts; one of these that the file lacks has none.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_texts<const N: usize, const M: usize>(
        self,
        names: [&str; N],
        texts: [&str; M],
        take: impl FnMut([Option<f64>; N], [Option<&str>; M]) -> Result<()>,
    ) -> Result<()> {
        guarded(self.path, || self.decode(names, texts, take))
    }

    fn decode<const N: usize, const M: usize>(
        self,
        names: [&str; N],
        texts: [&str; M],
        mut take: impl FnMut([Option<f64>; N], [Option<&str>; M]) -> Result<()>,
    ) -> Result<()> {
        if let Some(name) = names.iter().find(|name| !self.has_column(name)) {
            let problem = format!("no column {name}; expected the columns of docs/formats.md");
            return Err(Error::content(self.path, problem));
        }
        let Self { path, builder } = self;
        let wanted = names.iter().chain(&texts).copied();
        let projection = ProjectionMask::columns(builder.parquet_schema(), wanted);
        let batches = builder
            .with_projection(projection)
            .with_batch_size(BATCH_ROWS)
            .build()
            .map_err(|e| damaged(path, &e.to_string()))?;
        for batch in batches {
            let batch = batch.map_err(|e| damaged(path, &e.to_string()))?;
            let mut columns: Vec<Values> = Vec::with_capacity(N);
            for name in names {
                let values = batch.column_by_name(name).and_then(Values::of);
                columns.push(values.ok_or_else(|| {
                    let problem = format!("column {name} is not of numbers; expected doubles");
                    Error::content(path, problem)
                })?);
            }
            let mut words: Vec<Option<&StringArray>> = Vec::with_capacity(M);
            for name in texts {
                let values = batch.column_by_name(name);
                let strings = values.map(|values| {
                    values.as_any().downcast_ref().ok_or_else(|| {
                        let problem = format!("column {name} is not of texts; expected strings");
                        Error::content(path, problem)
                    })
                });
                words.push(strings.transpose()?);
            }
            for row in 0..batch.num_rows() {
                let text = |i: usize| {
                    let known = words[i].filter(|values| !values.is_null(row));
                    known.map(|values| values.value(row))
                };
                take(
                    std::array::from_fn(|i| columns[i].at(row)),
                    std::array::from_fn(text),
                )?;
            }
        }
        Ok(())
    }
}

/// Numbers of one kind or the other.
enum Values<'a> {
    Float(&'a PrimitiveArray<Float64Type>),
    Whole(&'a PrimitiveArray<Int64Type>),
}

impl<'a> Values<'a> {
    fn of(values: &'a ArrayRef) -> Option<Self> {
        let any = values.as_any();
        let float = any.downcast_ref().map(Self::Float);
        float.or_else(|| any.downcast_ref().map(Self::Whole))
    }

    fn at(&self, row: usize) -> Option<f64> {
        fn present<T: ArrowPrimitiveType>(
            array: &PrimitiveArray<T>,
            row: usize,
        ) -> Option<T::Native> {
            (!array.is_null(row)).then(|| array.value(row))
        }
        match self {
            Self::Float(array) => present(array, row),
            Self::Whole(array) => present(array, row).map(|value| value as f64),
        }
    }
}
