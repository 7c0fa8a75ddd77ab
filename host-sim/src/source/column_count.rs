//! The columns of a table as it is, with the range of each: also of one that is not understood.

use super::log_file::LogFile;
use super::signal_table::{ColumnName, TableRows, is_missing, switch};
use crate::error::Result;
use crate::files::kind::PARQUET_MAGIC;
use crate::files::parquet;
use serde::Serialize;
use std::path::Path;

/// Statistics of one column of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnCount {
    /// As the header has it.
    pub column: String,
    /// Unit, as the header or the row below it has it.
    pub unit: Option<String>,
    /// Number of cells that are numbers.
    pub numbers: u64,
    /// Smallest number.
    pub min: Option<f64>,
    /// Largest number.
    pub max: Option<f64>,
    /// The first cell that is no number and not empty.
    pub text: Option<String>,
}

impl ColumnCount {
    fn of(name: ColumnName) -> Self {
        Self {
            column: name.whole,
            unit: name.unit,
            numbers: 0,
            min: None,
            max: None,
            text: None,
        }
    }

    fn add(&mut self, number: f64) {
        self.numbers += 1;
        self.min = Some(self.min.map_or(number, |min| min.min(number)));
        self.max = Some(self.max.map_or(number, |max| max.max(number)));
    }
}

/// Reads all columns of a table, also of one that is not understood.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn count_columns(path: &Path) -> Result<Vec<ColumnCount>> {
    let mut file = LogFile::open(path)?;
    if file.look_at_head().starts_with(PARQUET_MAGIC) {
        return count_parquet(path);
    }
    let mut rows = TableRows::new(file)?;
    let mut columns: Vec<ColumnCount> = rows.names().into_iter().map(ColumnCount::of).collect();
    while rows.advance()? {
        for (k, column) in columns.iter_mut().enumerate() {
            let number = rows.number(k);
            let cell = rows.cell(k);
            match number.or_else(|| switch(cell)) {
                Some(number) => column.add(number),
                None if column.text.is_none() && !is_missing(cell) => {
                    column.text = Some(String::from_utf8_lossy(cell).into_owned());
                }
                None => {}
            }
        }
    }
    Ok(columns)
}

fn count_parquet(path: &Path) -> Result<Vec<ColumnCount>> {
    let opened = parquet::open(path)?;
    let names = opened.number_names();
    let name = |name: &String| ColumnCount::of(ColumnName::of(name, None));
    let mut columns: Vec<ColumnCount> = names.iter().map(name).collect();
    let mut batches = opened.batches(names)?;
    while let Some(batch) = batches.next_batch()? {
        for (column, numbers) in columns.iter_mut().zip(batch) {
            let finite = numbers.into_iter().flatten().filter(|n| n.is_finite());
            finite.for_each(|number| column.add(number));
        }
    }
    Ok(columns)
}
