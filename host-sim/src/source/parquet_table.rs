//! Signal tables as Parquet: `time_s` and one column per signal; null and NaN are missing.

use super::damage::{Damage, DamageCheck};
use super::signal_table::{SignalRow, TIME, checked};
use super::table_clock::{EXPECTED, NoTime, TableClock};
use crate::error::{Error, Result};
use crate::files::parquet::{NumberBatches, open};
use estimator_core::{Instant, Reading, Signal};
use std::path::Path;

/// Reader of tables, row by row; its memory does not depend on the length of the table.
pub struct ParquetTable {
    batches: NumberBatches,
    /// In the order of [`Signal`].
    signals: Vec<Signal>,
    ignored: Vec<String>,
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
    pub fn open(path: &Path, left_out: &[Signal], is_strict: bool) -> Result<Self> {
        let opened = open(path)?;
        let names: Vec<String> = opened.column_names().map(str::to_owned).collect();
        if !names.iter().any(|name| name == TIME) {
            let problem = "is a Parquet file without a column time_s; expected a log, or a signal \
                           table";
            return Err(Error::content(path, problem));
        }
        let mut signals: Vec<Signal> = names
            .iter()
            .filter_map(|name| Signal::from_column(name))
            .filter(|signal| !left_out.contains(signal))
            .collect();
        signals.sort();
        if signals.is_empty() {
            let problem = "no column with a signal; expected any that `roadgrade columns` lists, \
                           such as wheel_speed_mps";
            return Err(Error::content(path, problem));
        }
        let is_ignored = |name: &String| *name != TIME && Signal::from_column(name).is_none();
        let ignored = names.into_iter().filter(is_ignored).collect();
        let columns = signals.iter().map(|signal| signal.column());
        let wanted = std::iter::once(TIME).chain(columns);
        Ok(Self {
            batches: opened.batches(wanted.map(str::to_owned).collect())?,
            signals,
            ignored,
            batch: Vec::new(),
            next: 0,
            row: 0,
            clock: TableClock::default(),
            readings: Vec::new(),
            damage: DamageCheck::new(is_strict),
        })
    }

    /// Returns the signals that have a column, in the order of [`Signal`].
    pub fn signals(&self) -> impl Iterator<Item = Signal> {
        self.signals.iter().copied()
    }

    /// Returns the columns that are not ours.
    #[must_use]
    pub fn ignored_columns(&self) -> &[String] {
        &self.ignored
    }

    /// Returns what was mended of the times, in words.
    #[must_use]
    pub fn mended(&self) -> Vec<String> {
        self.clock.mended()
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
        let time = self.clock.time(self.seconds(row));
        let time = time.map_err(|problem| match problem {
            NoTime::Wrong => self.error("time_s is wrong", EXPECTED),
            NoTime::Backwards(problem) => self.error(&problem, "times that do not decrease"),
        })?;
        self.readings.clear();
        for (signal, values) in self.signals.iter().zip(&self.batch[1..]) {
            let number = values[row].filter(|value| !value.is_nan());
            if number.is_some() {
                let value = checked(*signal, number).map_err(|expected| {
                    self.error(&format!("{} is wrong", signal.column()), expected)
                })?;
                self.readings.push(Reading {
                    signal: *signal,
                    value,
                });
            }
        }
        Ok(time)
    }

    /// Returns the time of a row of the batch, s.
    fn seconds(&self, row: usize) -> Option<f64> {
        let seconds = *self.batch.first()?.get(row)?;
        seconds.filter(|seconds| seconds.is_finite())
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
