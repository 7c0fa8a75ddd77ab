//! Signal tables as Parquet: `time_s` and one column per signal; null and NaN are missing.

use super::damage::{Damage, DamageCheck};
use super::read_options::ReadOptions;
use super::row_order::RowOrder;
use super::signal_table::{
    ColumnName, HeaderColumns, IN_ORDER, NoTime, Problem, SignalRow, TIME_EXPECTED, checked,
    columns_of,
};
use crate::error::{Error, Result};
use crate::files::parquet::{NumberBatches, open};
use estimator_core::{Reading, Signal};
use std::path::Path;

/// Reader of tables, row by row; its memory does not depend on the length of a table that is long.
pub struct ParquetTable {
    batches: NumberBatches,
    header: HeaderColumns,
    /// The time, then the signals.
    batch: Vec<Vec<Option<f64>>>,
    next: usize,
    /// Rows so far, with the damaged ones.
    row: u64,
    order: RowOrder,
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
        let width = header.columns.len();
        let columns = header.columns.iter().map(|column| column.index);
        let wanted = std::iter::once(header.time.index).chain(columns);
        let wanted = wanted.filter_map(|index| names.get(index));
        Ok(Self {
            batches: opened.batches(wanted.map(|name| name.whole.clone()).collect())?,
            header,
            batch: Vec::new(),
            next: 0,
            row: 0,
            order: RowOrder::new(width),
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
        self.header.mended(&self.order)
    }

    /// Returns what was left out so far.
    #[must_use]
    pub const fn damage(&self) -> &Damage {
        self.damage.found()
    }

    /// Reads the next row; `None` at the end. Rows come in the order of time. Those with a time that is
    /// missing or over, or with a number beyond its range, are left out.
    ///
    /// # Errors
    /// Returns an error, with row, column and expected value, for a table with too much damage or
    /// without rows, and for a damaged file.
    pub fn next_row(&mut self) -> Result<Option<SignalRow<'_>>> {
        while !self.order.advance() {
            if self.order.is_over() {
                return Ok(None);
            }
            let left_out = if self.has_batch()? {
                self.row += 1;
                let row = self.next;
                self.next += 1;
                match self.parse(row) {
                    Ok(micros) => self.order.put(self.row, micros, &self.readings),
                    Err(problem) => {
                        self.leave_out(problem)?;
                        continue;
                    }
                }
            } else {
                self.order.end()
            };
            for (row, problem) in left_out {
                self.leave_out(self.error(row, &problem, IN_ORDER))?;
            }
            if self.order.is_over() {
                self.end()?;
            }
        }
        Ok(Some(self.order.row()))
    }

    fn leave_out(&mut self, problem: Error) -> Result<()> {
        let good = (self.row - self.damage.found().lines).saturating_sub(1);
        self.damage.line(problem, good)
    }

    /// Returns whether there is a next row in the batch, and reads another one for it.
    fn has_batch(&mut self) -> Result<bool> {
        while self
            .batch
            .first()
            .is_none_or(|times| self.next >= times.len())
        {
            let Some(batch) = self.batches.next_batch()? else {
                return Ok(false);
            };
            (self.batch, self.next) = (batch, 0);
        }
        Ok(true)
    }

    /// Reads the values of a row of the batch. Returns its time, µs.
    fn parse(&mut self, row: usize) -> Result<i64> {
        let number = self.number(row);
        let micros = self.header.time.micros("", number);
        let name = &self.header.time.name;
        let micros = micros.map_err(|problem| match problem {
            NoTime::NoUnit => self.error(
                self.row,
                &format!("{name} has no unit"),
                "a time since 1970, or a unit of the time in --columns",
            ),
            NoTime::Wrong => self.error(self.row, &format!("{name} is wrong"), TIME_EXPECTED),
        })?;
        self.readings.clear();
        for (column, values) in self.header.columns.iter().zip(&self.batch[1..]) {
            let signal = column.signal;
            let number = values[row].filter(|value| !value.is_nan());
            if let Some(number) = number {
                let number = number * column.scale + column.offset;
                let value = checked(signal, Some(number)).map_err(|expected| {
                    self.error(self.row, &format!("{} is wrong", signal.column()), expected)
                })?;
                self.readings.push(Reading { signal, value });
            }
        }
        Ok(micros)
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

    fn error(&self, row: u64, what: &str, expected: &str) -> Error {
        let problem = format!("row {row}: {what}; expected {expected}");
        Error::content(self.batches.path(), problem)
    }
}
