//! Signal tables as Parquet: `time_s` and one column per signal; null and NaN are missing.

use super::damage::{Damage, DamageCheck};
use super::read_options::ReadOptions;
use super::signal_table::{ColumnName, HeaderColumns, Problem, SignalRow, checked, columns_of};
use super::table_clock::{EXPECTED, NoTime, TableClock};
use crate::error::{Error, Result};
use crate::files::parquet::{NumberBatches, open};
use estimator_core::{Instant, Reading, Signal};
use std::path::Path;

/// Reader of tables, row by row; its memory does not depend on the length of the table.
pub struct ParquetTable {
    batches: NumberBatches,
    header: HeaderColumns,
    /// The time, then the signals.
    batch: Vec<Vec<Option<f64>>>,
    next: usize,
    /// Rows so far, with the damaged ones.
    row: u64,
    clock: TableClock,
    readings: Vec<Reading>,
    damage: DamageCheck,
}

impl ParquetTable {
    /// Opens a table, without the columns of the signals that are left out.
    ///
    /// # Errors
    /// Returns an error if the file is damaged, or has no time or no signal.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Self> {
        let opened = open(path)?;
        let names: Vec<ColumnName> = opened
            .column_names()
            .map(|name| ColumnName::of(name, None))
            .collect();
        let found = columns_of(path, &names, options.columns.as_deref());
        let mut header = found.map_err(|problem| match problem {
            Problem::Mapping(error) => error,
            Problem::Table(problem, expected) => {
                let problem = format!("is a Parquet file with {problem}; expected {expected}");
                Error::content(path, problem)
            }
        })?;
        header.ignore(&options.ignore);
        let columns = header.columns.iter().map(|column| column.index);
        let wanted = std::iter::once(header.time.index).chain(columns);
        let wanted = wanted.filter_map(|index| names.get(index));
        Ok(Self {
            batches: opened.batches(wanted.map(|name| name.whole.clone()).collect())?,
            header,
            batch: Vec::new(),
            next: 0,
            row: 0,
            clock: TableClock::default(),
            readings: Vec::new(),
            damage: DamageCheck::new(options.strict),
        })
    }

    /// Returns the signals that have a column, in the order of [`Signal`].
    pub fn signals(&self) -> impl Iterator<Item = Signal> {
        self.header.signals()
    }

    /// Returns the columns that are not ours.
    #[must_use]
    pub fn ignored_columns(&self) -> &[String] {
        &self.header.ignored
    }

    /// Returns what was mended of the times, and what was taken for ours, in words.
    #[must_use]
    pub fn mended(&self) -> Vec<String> {
        self.header.mended(&self.clock)
    }

    /// Returns what was left out so far.
    #[must_use]
    pub const fn damage(&self) -> &Damage {
        self.damage.found()
    }

    /// Reads the next row; `None` at the end. Rows with a time that is missing or runs backwards, or
    /// with a number beyond its range, are left out.
    ///
    /// # Errors
    /// Returns an error, with row, column and expected value, for a table with too much damage or
    /// without rows, and for a damaged file.
    pub fn next_row(&mut self) -> Result<Option<SignalRow<'_>>> {
        loop {
            if self
                .batch
                .first()
                .is_none_or(|times| self.next >= times.len())
            {
                let Some(batch) = self.batches.next_batch()? else {
                    return self.end().map(|()| None);
                };
                (self.batch, self.next) = (batch, 0);
                continue;
            }
            self.row += 1;
            let row = self.next;
            self.next += 1;
            match self.parse(row) {
                Ok(time) => {
                    self.clock.take(time);
                    return Ok(Some(SignalRow {
                        time,
                        readings: &self.readings,
                    }));
                }
                Err(problem) => {
                    let good = self.row - 1 - self.damage.found().lines;
                    self.damage.line(problem, good)?;
                }
            }
        }
    }

    /// Reads the values of a row of the batch.
    fn parse(&mut self, row: usize) -> Result<Instant> {
        let number = self.number(row);
        let time = self.header.time.read(&mut self.clock, "", number);
        let name = &self.header.time.name;
        let time = time.map_err(|problem| match problem {
            NoTime::NoUnit => self.error(
                &format!("{name} has no unit"),
                "a time since 1970, or a unit of the time in --columns",
            ),
            NoTime::Wrong => self.error(&format!("{name} is wrong"), EXPECTED),
            NoTime::Backwards(problem) => self.error(&problem, "times that do not decrease"),
        })?;
        self.readings.clear();
        for (column, values) in self.header.columns.iter().zip(&self.batch[1..]) {
            let signal = column.signal;
            let number = values[row].filter(|value| !value.is_nan());
            if let Some(number) = number {
                let number = number * column.scale + column.offset;
                let value = checked(signal, Some(number)).map_err(|expected| {
                    self.error(&format!("{} is wrong", signal.column()), expected)
                })?;
                self.readings.push(Reading { signal, value });
            }
        }
        Ok(time)
    }

    /// Returns the number of the time of a row of the batch.
    fn number(&self, row: usize) -> Option<f64> {
        let number = *self.batch.first()?.get(row)?;
        number.filter(|number| number.is_finite())
    }

    fn end(&mut self) -> Result<()> {
        let good = self.row - self.damage.found().lines;
        if good > 0 {
            return self.damage.end(self.row, 0);
        }
        let problem = "no rows; expected at least one";
        let empty = Error::content(self.batches.path(), problem);
        Err(self.damage.take_first().unwrap_or(empty))
    }

    fn error(&self, what: &str, expected: &str) -> Error {
        let problem = format!("row {}: {what}; expected {expected}", self.row);
        Error::content(self.batches.path(), problem)
    }
}
