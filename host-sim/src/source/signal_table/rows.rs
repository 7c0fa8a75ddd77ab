//! The records of a table as text: separated by commas, semicolons or tabs (RFC 4180 and what
//! spreadsheets make of it).

use super::time_column::TimeUnit;
use crate::error::{Error, Result};
use crate::files::limits::{self, Budget};
use crate::source::log_file::LogFile;
use crate::source::own_signals::units;
use crate::source::packing::Joint;
use csv::ByteRecord;
use std::io::{Chain, Read};

/// A log with a line feed appended, because its last line may lack one.
type TerminatedLog = Budget<Chain<LogFile, &'static [u8]>>;

/// What separates the cells of a row.
const DELIMITERS: [u8; 3] = [b',', b';', b'\t'];
/// The first line that a spreadsheet takes for itself.
const SEPARATOR_LINE: &[u8] = b"sep=";

/// Reader of records; its memory does not depend on the length of the table.
pub struct TableRows {
    csv: csv::Reader<TerminatedLog>,
    header: ByteRecord,
    header_line: u64,
    /// The row of units below the header, if there is one.
    units: Option<ByteRecord>,
    record: ByteRecord,
    /// True if the record is that of a row that was not handed out yet.
    is_read_ahead: bool,
    delimiter: u8,
    /// The point or comma of the first number that has one.
    decimal: Option<u8>,
}

/// Returns what separates the cells of a header: the one that it has most of.
pub(super) fn delimiter_of(header: &[u8]) -> u8 {
    let count = |of: u8| header.iter().filter(|byte| **byte == of).count();
    let most = DELIMITERS.into_iter().rev().max_by_key(|of| count(*of));
    most.unwrap_or(b',')
}

/// Returns the line of the header: the first one that is neither blank nor a comment.
pub(super) fn header_line(head: &[u8]) -> &[u8] {
    let is_header = |line: &&[u8]| {
        !line.is_empty() && !line.starts_with(b"#") && !line.starts_with(SEPARATOR_LINE)
    };
    let mut lines = head.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    lines.find(is_header).unwrap_or_default()
}

impl TableRows {
    /// Reads the header of a table, and the row of units below it.
    ///
    /// # Errors
    /// Returns the error of the disk, and an error for an empty file.
    pub fn new(mut file: LogFile) -> Result<Self> {
        let delimiter = delimiter_of(header_line(file.look_at_head()));
        file.join(Joint::Lines);
        let csv = csv::ReaderBuilder::new()
            .has_headers(false)
            .delimiter(delimiter)
            .comment(Some(b'#'))
            // With a terminator of one byte, the reader's line is exact; see `line`. The carriage
            // return of CR LF is trimmed by `cell`, and blank lines are skipped in `advance`.
            .terminator(csv::Terminator::Any(b'\n'))
            .flexible(true)
            .from_reader(Budget::new(
                file.chain(&b"\n"[..]),
                limits::RECORD_BYTES,
                "row",
            ));
        let mut rows = Self {
            csv,
            header: ByteRecord::new(),
            header_line: 0,
            units: None,
            record: ByteRecord::new(),
            is_read_ahead: false,
            delimiter,
            decimal: None,
        };
        rows.read_header()?;
        Ok(rows)
    }

    fn read_header(&mut self) -> Result<()> {
        loop {
            if !self.advance()? {
                return Err(Error::content(
                    self.file().path(),
                    "the file is empty; expected a header with time_s and signal columns",
                ));
            }
            let first = self.cell(0);
            if !first.starts_with(SEPARATOR_LINE) {
                break;
            }
        }
        self.record.trim();
        self.header = std::mem::take(&mut self.record);
        self.header_line = self.line();
        if self.advance()? {
            if is_row_of_units(&self.record) {
                self.record.trim();
                self.units = Some(std::mem::take(&mut self.record));
            } else {
                self.is_read_ahead = true;
            }
        }
        Ok(())
    }

    /// Goes to the next record that is not blank. Returns false at the end.
    ///
    /// # Errors
    /// Returns the error of the disk.
    pub fn advance(&mut self) -> Result<bool> {
        if std::mem::take(&mut self.is_read_ahead) {
            return Ok(true);
        }
        loop {
            let line = self.csv.position().line();
            self.csv.get_mut().renew();
            let read = self.csv.read_byte_record(&mut self.record);
            let is_read = read.map_err(|error| match error.into_kind() {
                csv::ErrorKind::Io(error) => self.file().read_error(line, error),
                kind => Error::line(self.file().path(), line, format!("{kind:?}"), "CSV"),
            })?;
            let is_blank = self.record.len() == 1 && self.record[0].trim_ascii().is_empty();
            if !is_read || !is_blank {
                return Ok(is_read);
            }
        }
    }

    /// Reads the next record, which `advance` then returns. Returns false at the end.
    pub(super) fn look_ahead(&mut self) -> Result<bool> {
        self.is_read_ahead = self.advance()?;
        Ok(self.is_read_ahead)
    }

    /// Returns the names of the columns, each with its unit: that of the name, such as `v [km/h]`, or
    /// of the row of units.
    #[must_use]
    pub fn names(&self) -> Vec<ColumnName> {
        let unit = |index| {
            let unit = self.units.as_ref()?.get(index)?;
            Some(unit_of(unit)).filter(|unit| !units::is_none(unit))
        };
        let names = self.header.iter().enumerate();
        names
            .map(|(index, name)| {
                let name = String::from_utf8_lossy(name);
                ColumnName::of(name.trim_start_matches('\u{feff}'), unit(index))
            })
            .collect()
    }

    /// Returns the number of cells of the newest record.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.record.len()
    }

    /// Returns a cell of the newest record without blanks around it; empty if there is none.
    #[must_use]
    pub fn cell(&self, index: usize) -> &[u8] {
        self.record.get(index).unwrap_or_default().trim_ascii()
    }

    /// Returns the number of a cell; `None` if it is none. A comma is a decimal one where commas do not
    /// separate cells, and no number before it has a point.
    pub fn number(&mut self, index: usize) -> Option<f64> {
        let text = str::from_utf8(self.record.get(index)?.trim_ascii()).ok()?;
        let decimal = match self.delimiter {
            b',' => None,
            _ => text.bytes().find(|byte| matches!(byte, b'.' | b',')),
        };
        if let Some(decimal) = decimal {
            if *self.decimal.get_or_insert(decimal) != decimal {
                return None;
            }
            if decimal == b',' {
                return finite(&text.replacen(',', ".", 1));
            }
        }
        finite(text)
    }

    /// Returns the line of the header.
    pub(super) const fn header_line(&self) -> u64 {
        self.header_line
    }

    /// Returns the line of the newest record: the reader is behind its line feed.
    pub(super) fn line(&self) -> u64 {
        self.csv.position().line().saturating_sub(1)
    }

    /// Returns the file, for progress and messages.
    #[must_use]
    pub fn file(&self) -> &LogFile {
        self.csv.get_ref().inner().get_ref().0
    }
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Returns true for a row of names of units: none is a number or a time, and one is a unit at least.
fn is_row_of_units(record: &ByteRecord) -> bool {
    let cells = || record.iter().map(unit_of);
    let is_unit = |cell: &str| units::is_known(cell) || TimeUnit::named(cell).is_some();
    let is_value = |cell: &str| {
        finite(&cell.replace(',', ".")).is_some() || TimeUnit::of_value(cell, None).is_some()
    };
    cells().all(|cell| !is_value(&cell)) && cells().any(|cell| is_unit(&cell))
}

/// Returns the unit that a cell names, without brackets.
fn unit_of(cell: &[u8]) -> String {
    let cell = String::from_utf8_lossy(cell.trim_ascii());
    cell.trim_matches(['[', ']', '(', ')']).trim().to_owned()
}

/// The name of a column, and its unit where the table has one.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnName {
    /// As the table writes it.
    pub whole: String,
    /// Without its unit.
    pub name: String,
    /// The unit in brackets behind the name, or below it.
    pub unit: Option<String>,
}

impl ColumnName {
    /// Takes a name apart.
    #[must_use]
    pub fn of(whole: &str, below: Option<String>) -> Self {
        let brackets = [('[', ']'), ('(', ')')];
        let inside = brackets.into_iter().find_map(|(open, close)| {
            let (name, unit) = whole.strip_suffix(close)?.rsplit_once(open)?;
            Some((name.trim(), unit.trim()))
        });
        let (name, unit) =
            inside.map_or((whole, below), |(name, unit)| (name, Some(unit.to_owned())));
        Self {
            whole: whole.to_owned(),
            name: name.to_owned(),
            unit,
        }
    }
}
