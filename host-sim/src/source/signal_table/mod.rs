//! Signal tables: CSV with `time_s` and one column per signal, plain or gzip; an empty cell is
//! missing.
//!
//! | file | content |
//! |---|---|
//! | `header` | which column has which signal |
//! | `cell_value` | the value of a cell, and what it may be |
//! | `writer` | the writer of tables |

mod cell_value;
mod header;
mod writer;

pub(super) use cell_value::checked;
pub(super) use header::TIME;
pub use writer::write;

use super::damage::{Damage, DamageCheck};
use super::log_file::LogFile;
use super::packing::Joint;
use super::table_clock::{EXPECTED, NoTime, TableClock};
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use crate::files::limits::{self, Budget};
use csv::ByteRecord;
use estimator_core::{Instant, Reading, Signal, Value};
use header::{HeaderColumns, SignalColumn, columns_of};
use std::io::{Chain, Read};
use std::path::Path;

/// A log with a line feed appended, because its last line may lack one.
type TerminatedLog = Budget<Chain<LogFile, &'static [u8]>>;

/// Reader of tables, row by row; its memory does not depend on the length of the table.
pub struct SignalTableReader {
    csv: csv::Reader<TerminatedLog>,
    record: ByteRecord,
    fields: usize,
    time_column: usize,
    /// In the order of [`Signal`], the required order of simultaneous readings.
    columns: Vec<SignalColumn>,
    /// Columns that are not ours.
    ignored: Vec<String>,
    readings: Vec<Reading>,
    clock: TableClock,
    rows: u64,
    damage: DamageCheck,
    /// True if the record is that of a row that was not handed out yet.
    is_read_ahead: bool,
}

/// One row of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalRow<'a> {
    /// `time_s`, rounded to microseconds.
    pub time: Instant,
    /// The values that are not missing, in the order of [`Signal`]; may be empty.
    pub readings: &'a [Reading],
}

impl SignalTableReader {
    /// Opens a table and reads its header.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened or is empty, or if a column is repeated, or the
    /// time or any signal is missing.
    pub fn open(path: &Path) -> Result<Self> {
        let mut file = LogFile::open(path)?;
        file.look_at_head();
        Self::new(file, false)
    }

    /// Reads the header of an open table.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn new(file: LogFile, is_strict: bool) -> Result<Self> {
        let path = &file.path().to_owned();
        file.join(Joint::Lines);
        let mut csv = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .has_headers(false)
            // With a terminator of one byte, the reader's line is exact; see `line_of`. The
            // carriage return of CR LF is trimmed, and blank lines are skipped in `read_row`.
            .terminator(csv::Terminator::Any(b'\n'))
            .flexible(true)
            .from_reader(Budget::new(
                file.chain(&b"\n"[..]),
                limits::RECORD_BYTES,
                "row",
            ));
        let mut header = ByteRecord::new();
        if !read_row(&mut csv, &mut header)? {
            return Err(Error::content(
                path,
                "the file is empty; expected a header with time_s and signal columns",
            ));
        }
        let HeaderColumns {
            time: time_column,
            columns,
            ignored,
        } = columns_of(path, line_of(&csv), &header)
            .map_err(|e| kind::explained(e, path, &[Kind::SignalTable]))?;
        // A run has signals, too, but none that drives it.
        let is_speed = |column: &SignalColumn| {
            matches!(column.signal, Signal::WheelSpeed | Signal::FrontAxleSpeed)
        };
        if !ignored.is_empty() && !columns.iter().any(is_speed) {
            kind::refuse_other(path, &[Kind::SignalTable])?;
        }
        Ok(Self {
            csv,
            fields: header.len(),
            record: header,
            time_column,
            columns,
            ignored,
            readings: Vec::new(),
            clock: TableClock::default(),
            rows: 0,
            damage: DamageCheck::new(is_strict),
            is_read_ahead: false,
        })
    }

    /// Leaves out the columns of these signals.
    pub(super) fn ignore(&mut self, signals: &[Signal]) {
        let is_kept = |column: &SignalColumn| !signals.contains(&column.signal);
        self.columns.retain(is_kept);
    }

    /// Returns the columns that are not ours.
    #[must_use]
    pub fn ignored_columns(&self) -> &[String] {
        &self.ignored
    }

    /// Returns the signals that have a column, in the order of [`Signal`].
    pub fn signals(&self) -> impl Iterator<Item = Signal> {
        self.columns.iter().map(|column| column.signal)
    }

    /// Reads the next row; `None` at the end. Rows with a value that is not a number, with too few or
    /// too many fields, or before the row above are left out.
    ///
    /// # Errors
    /// Returns an error, with file, line, column and expected value, for a table with too much
    /// damage or without rows.
    pub fn next_row(&mut self) -> Result<Option<SignalRow<'_>>> {
        while self.read_on()? {
            match self.parse() {
                Ok(time) => {
                    self.rows += 1;
                    self.clock.take(time);
                    return Ok(Some(SignalRow {
                        time,
                        readings: &self.readings,
                    }));
                }
                Err(problem) => self.leave_out(problem)?,
            }
        }
        self.end().map(|()| None)
    }

    fn read_on(&mut self) -> Result<bool> {
        let is_read = std::mem::take(&mut self.is_read_ahead);
        Ok(is_read || read_row(&mut self.csv, &mut self.record)?)
    }

    /// Reads the values of the record.
    fn parse(&mut self) -> Result<Instant> {
        if self.record.len() != self.fields {
            return Err(self.error(
                format!("{} fields", self.record.len()),
                &format!("{}, as many as the header has", self.fields),
            ));
        }
        let time = self.time()?;
        self.readings.clear();
        for k in 0..self.columns.len() {
            let SignalColumn { index, signal } = self.columns[k];
            if let Some(value) = self.value(index, signal)? {
                self.readings.push(Reading { signal, value });
            }
        }
        Ok(time)
    }

    /// Leaves out a row. The last one of a table without a line end is cut off.
    fn leave_out(&mut self, problem: Error) -> Result<()> {
        self.is_read_ahead = read_row(&mut self.csv, &mut self.record)?;
        if self.is_read_ahead || self.rows == 0 || self.file().newest_byte() == Some(b'\n') {
            return self.damage.line(problem, self.rows);
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
        if self.rows > 0 {
            let bytes = self.file().bytes_read();
            return self
                .damage
                .end(self.rows + self.damage.found().lines, bytes);
        }
        let path = self.file().path();
        let problem = "no rows; expected at least one below the header";
        let empty = Error::content(path, problem);
        Err(self.damage.take_first().unwrap_or(empty))
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

    /// Returns the file, for progress and messages.
    #[must_use]
    pub fn file(&self) -> &LogFile {
        file_of(&self.csv)
    }

    fn time(&mut self) -> Result<Instant> {
        let time = self.clock.time(self.number(self.time_column));
        time.map_err(|problem| match problem {
            NoTime::Wrong => self.wrong_value(self.time_column, TIME, EXPECTED),
            NoTime::Backwards(problem) => self.error(problem, "times that do not decrease"),
        })
    }

    /// Returns the value of a cell; `None` if it is empty.
    fn value(&self, index: usize, signal: Signal) -> Result<Option<Value>> {
        let is_missing = |text: &[u8]| text.is_empty() || text.eq_ignore_ascii_case(b"nan");
        if self.record.get(index).is_none_or(is_missing) {
            return Ok(None);
        }
        let number = self.number(index);
        checked(signal, number)
            .map_err(|expected| self.wrong_value(index, signal.column(), expected))
            .map(Some)
    }

    fn number(&self, index: usize) -> Option<f64> {
        let text = str::from_utf8(self.record.get(index)?).ok()?;
        text.parse().ok().filter(|number: &f64| number.is_finite())
    }

    fn wrong_value(&self, index: usize, column: &str, expected: &str) -> Error {
        let text = self.record.get(index).unwrap_or_default().escape_ascii();
        self.error(format!("{column} is `{text}`"), expected)
    }

    fn error(&self, problem: String, expected: &str) -> Error {
        Error::line(self.file().path(), line_of(&self.csv), problem, expected)
    }
}

/// Returns the line of the last record: the reader is behind its line feed.
fn line_of(csv: &csv::Reader<TerminatedLog>) -> u64 {
    csv.position().line().saturating_sub(1)
}

fn file_of(csv: &csv::Reader<TerminatedLog>) -> &LogFile {
    csv.get_ref().inner().get_ref().0
}

/// Reads the next record that is not blank. Returns false at the end.
fn read_row(csv: &mut csv::Reader<TerminatedLog>, record: &mut ByteRecord) -> Result<bool> {
    loop {
        let line = csv.position().line();
        csv.get_mut().renew();
        let is_read = csv
            .read_byte_record(record)
            .map_err(|error| match error.into_kind() {
                csv::ErrorKind::Io(error) => file_of(csv).read_error(line, error),
                kind => Error::line(file_of(csv).path(), line, format!("{kind:?}"), "CSV"),
            })?;
        let is_blank = record.len() == 1 && record[0].is_empty();
        if !is_read || !is_blank {
            return Ok(is_read);
        }
    }
}
