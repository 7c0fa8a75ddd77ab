//! Signal tables: text with a time and one column per signal, plain or packed; an empty cell is
//! missing.
//!
//! | file | content |
//! |---|---|
//! | `rows` | the records: delimiters, units, numbers |
//! | `header` | which column has which signal |
//! | `columns_file` | the mapping of a user, `COLUMNS.toml` |
//! | `time_column` | units of times, and dates |
//! | `cell_value` | the value of a cell, and what it may be |
//! | `writer` | the writer of tables |

mod cell_value;
mod columns_file;
mod header;
mod rows;
mod time_column;
mod writer;

pub use super::row_order::SignalRow;
pub(super) use cell_value::{checked, is_missing, switch};
pub use columns_file::ColumnsFile;
pub(super) use header::{HeaderColumns, NoTime, Problem, SignalColumn, columns_of, is_header};
pub use rows::{ColumnName, TableRows};
pub use time_column::{TIME, TimeUnit};
pub use writer::write;

use super::damage::{Damage, DamageCheck};
use super::log_file::LogFile;
use super::read_options::ReadOptions;
use super::row_order::RowOrder;
use super::signal_range::unit_of_column;
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use estimator_core::{Reading, Signal, Value};
use std::path::Path;

/// What is expected of a time, ...
pub(super) const TIME_EXPECTED: &str = "seconds from -4e9 to 4e9";
/// ... and of all times.
pub(super) const IN_ORDER: &str = "the rows of one drive; cut the table where another begins";

/// Reader of tables, row by row; its memory does not depend on the length of a table that is long.
pub struct SignalTableReader {
    rows: TableRows,
    fields: usize,
    header: HeaderColumns,
    readings: Vec<Reading>,
    order: RowOrder,
    good_rows: u64,
    damage: DamageCheck,
}

impl SignalTableReader {
    /// Opens a table and reads its header.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened or is empty, or if a column is repeated, or the
    /// time or any signal is missing.
    pub fn open(path: &Path) -> Result<Self> {
        Self::new(LogFile::open(path)?, &ReadOptions::default())
    }

    /// Reads the header of an open table.
    ///
    /// # Errors
    /// As [`open`](Self::open), and an error for a mapping that does not fit.
    pub fn new(file: LogFile, options: &ReadOptions) -> Result<Self> {
        let rows = TableRows::new(file)?;
        let path = rows.file().path();
        let names = rows.names();
        let found = columns_of(path, &names, options.columns.as_deref());
        let mut header = found.map_err(|problem| match problem {
            Problem::Mapping(error) => error,
            Problem::Table(problem, expected) => {
                let error = Error::line(path, rows.header_line(), problem, expected);
                kind::explained(error, path, &[Kind::SignalTable])
            }
        })?;
        // A run has signals, too, but none that drives it.
        let is_speed = |column: &SignalColumn| {
            matches!(column.signal, Signal::WheelSpeed | Signal::FrontAxleSpeed)
        };
        if !header.ignored.is_empty() && !header.columns.iter().any(is_speed) {
            kind::refuse_other(path, &[Kind::SignalTable])?;
        }
        header.ignore(&options.ignore);
        let width = header.columns.len();
        Ok(Self {
            fields: names.len(),
            rows,
            header,
            readings: Vec::new(),
            order: RowOrder::new(width),
            good_rows: 0,
            damage: DamageCheck::new(options.strict),
        })
    }

    /// Returns the columns that are not ours.
    #[must_use]
    pub fn ignored_columns(&self) -> &[String] {
        &self.header.ignored
    }

    /// Returns the signals that have a column, in the order of [`Signal`].
    pub fn signals(&self) -> impl Iterator<Item = Signal> {
        self.header.signals()
    }

    /// Reads the next row; `None` at the end. Rows come in the order of time. Those with a value that is
    /// not a number, with too few or too many fields, or with a time that is over are left out.
    ///
    /// # Errors
    /// Returns an error, with file, line, column and expected value, for a table with too much
    /// damage or without rows.
    pub fn next_row(&mut self) -> Result<Option<SignalRow<'_>>> {
        while !self.order.advance() {
            if self.order.is_over() {
                return Ok(None);
            }
            let left_out = if self.rows.advance()? {
                match self.parse() {
                    Ok(micros) => {
                        self.good_rows += 1;
                        self.order.put(self.rows.line(), micros, &self.readings)
                    }
                    Err(problem) => {
                        self.leave_out(problem)?;
                        continue;
                    }
                }
            } else {
                self.order.end()
            };
            for (line, problem) in left_out {
                self.good_rows -= 1;
                let problem = Error::line(self.file().path(), line, problem, IN_ORDER);
                self.damage.line(problem, self.good_rows)?;
            }
            if self.order.is_over() {
                self.end()?;
            }
        }
        Ok(Some(self.order.row()))
    }

    /// Reads the values of the record. Returns its time, µs.
    fn parse(&mut self) -> Result<i64> {
        let fields = self.rows.cells();
        if fields != self.fields {
            return Err(self.error(
                format!("{fields} fields"),
                &format!("{}, as many as the header has", self.fields),
            ));
        }
        let micros = self.micros()?;
        self.readings.clear();
        for k in 0..self.header.columns.len() {
            let column = self.header.columns[k];
            if let Some(value) = self.value(&column)? {
                let signal = column.signal;
                self.readings.push(Reading { signal, value });
            }
        }
        Ok(micros)
    }

    /// Leaves out a row. The last one of a table without a line end is cut off.
    fn leave_out(&mut self, problem: Error) -> Result<()> {
        let is_last = !self.rows.look_ahead()?;
        if !is_last || self.good_rows == 0 || self.file().newest_byte() == Some(b'\n') {
            return self.damage.line(problem, self.good_rows);
        }
        let problem = problem.with_note("the table is cut off within its last row");
        self.damage.cut_off(problem)
    }

    fn end(&mut self) -> Result<()> {
        if self.file().is_cut_off() {
            let problem = self.file().cut_off_error();
            self.damage.cut_off(problem)?;
        }
        for (problem, bytes) in self.file().packed_damage() {
            self.damage.packed(problem, bytes)?;
        }
        if self.good_rows > 0 {
            let bytes = self.file().bytes_read();
            let rows = self.good_rows + self.damage.found().lines;
            return self.damage.end(rows, bytes);
        }
        let path = self.file().path();
        let problem = "no rows; expected at least one below the header";
        let empty = Error::content(path, problem);
        Err(self.damage.take_first().unwrap_or(empty))
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

    /// Returns the file, for progress and messages.
    #[must_use]
    pub fn file(&self) -> &LogFile {
        self.rows.file()
    }

    fn micros(&mut self) -> Result<i64> {
        let index = self.header.time.index;
        let number = self.rows.number(index);
        let cell = self.rows.cell(index);
        let text = str::from_utf8(cell).unwrap_or_default();
        let micros = self.header.time.micros(text, number);
        let wrong = |expected| self.wrong_value(index, &self.header.time.name, expected);
        micros.map_err(|problem| match problem {
            NoTime::NoUnit => wrong(
                "a date such as 2026-03-01T23:59:50Z, a time since 1970, or a unit of the time: in the \
                 header (time_s, or time [ms]), or in --columns",
            ),
            NoTime::Wrong => wrong(TIME_EXPECTED),
        })
    }

    /// Returns the value of a cell; `None` if it is empty.
    fn value(&mut self, column: &SignalColumn) -> Result<Option<Value>> {
        let SignalColumn { index, signal, .. } = *column;
        let cell = self.rows.cell(index);
        if is_missing(cell) {
            return Ok(None);
        }
        let switch = if unit_of_column(signal).is_empty() {
            switch(cell)
        } else {
            None
        };
        let number = switch.or_else(|| self.rows.number(index));
        let number = number.map(|number| number * column.scale + column.offset);
        checked(signal, number)
            .map_err(|expected| self.wrong_value(index, signal.column(), expected))
            .map(Some)
    }

    fn wrong_value(&self, index: usize, column: &str, expected: &str) -> Error {
        let text = self.rows.cell(index);
        self.error(format!("{column} is `{}`", text.escape_ascii()), expected)
    }

    fn error(&self, problem: String, expected: &str) -> Error {
        Error::line(self.file().path(), self.rows.line(), problem, expected)
    }
}
