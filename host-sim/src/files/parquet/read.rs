//! Tables that are read.

use super::guard::{damaged, guarded};
use super::number_column::NumberColumn;
use super::pages;
use crate::error::{Error, Result};
use crate::files::limits;
use crate::platform::{TableFile, table_file};
use arrow_array::{Array, RecordBatch, StringArray};
use arrow_schema::DataType;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Number of rows that are decoded at once.
const BATCH_ROWS: usize = 8192;

/// A Parquet file whose footer has been read.
pub struct Opened<'a> {
    path: &'a Path,
    most_rows: usize,
    builder: ParquetRecordBatchReaderBuilder<TableFile>,
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
    let file = table_file(file).map_err(Error::io(path))?;
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

impl Opened<'_> {
    /// Limits the number of rows, for a table that is kept in memory.
    #[must_use]
    pub const fn with_most_rows(mut self, most_rows: usize) -> Self {
        self.most_rows = most_rows;
        self
    }

    /// Returns the metadata value of this key; see [`super::stage`].
    pub fn metadata(&self, key: &str) -> Option<&str> {
        let pairs = self.builder.metadata().file_metadata().key_value_metadata();
        pairs?
            .iter()
            .find(|pair| pair.key.strip_prefix("roadgrade.") == Some(key))?
            .value
            .as_deref()
    }

    /// Returns the names of the columns of numbers, switches and times.
    #[must_use]
    pub fn number_names(&self) -> Vec<String> {
        let fields = self.builder.schema().fields().iter();
        let is_number = |kind: &DataType| {
            kind.is_numeric() || matches!(kind, DataType::Boolean | DataType::Timestamp(..))
        };
        let numbers = fields.filter(|field| is_number(field.data_type()));
        numbers.map(|field| field.name().clone()).collect()
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
        pages::check(&file, builder.metadata(), &wanted)
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
            pages::check(&file, builder.metadata(), &wanted)
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
