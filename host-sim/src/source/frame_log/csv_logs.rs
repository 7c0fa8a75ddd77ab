//! The CSV of SavvyCAN and GVRET, and that of python-can.
//!
//! ```text
//! Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8
//! 166064000,0CF00400,true,Rx,0,8,60,7D,84,48,14,00,F0,84,
//! timestamp,arbitration_id,extended,remote,error,dlc,data
//! 0.001,0xcf00400,1,0,0,8,YH2ESBQA8IQ=
//! ```
//!
//! * Times of SavvyCAN are microseconds, those of python-can seconds.
//! * Buses of SavvyCAN are counted from 0. Older versions have no column `Dir`.
//! * Data of python-can are in base64 (RFC 4648).
//! * A row with more than 8 bytes is a CAN FD frame.

use super::fields::{MOST_MICROS, identifier, number, signed_fixed_point};
use super::line_problem::{LineProblem, Parsed, header_problem, problem};
use super::text::{LineFormat, TextLine};
use crate::source::can_frame::CanFrame;
use crate::source::interfaces::Interfaces;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use embedded_can::{Frame, Id};

/// Largest number of columns before the data.
const MOST_COLUMNS: usize = 16;
/// Most data bytes of a classic frame.
const MOST_BYTES: usize = 8;
/// Most data bytes of a CAN FD frame.
const MOST_FD_BYTES: usize = 64;

/// A column of either program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    Time,
    Identifier,
    Extended,
    Remote,
    Error,
    Bus,
    Length,
    Data,
    Unused,
}

/// Rows under a header.
pub(super) struct CsvLog {
    is_python_can: bool,
    columns: Vec<Column>,
}

impl CsvLog {
    pub(super) const fn savvy_can() -> Self {
        Self {
            is_python_can: false,
            columns: Vec::new(),
        }
    }

    pub(super) const fn python_can() -> Self {
        Self {
            is_python_can: true,
            columns: Vec::new(),
        }
    }

    fn header(&mut self, line: &[u8]) -> Parsed<()> {
        let names = line.split(|byte| *byte == b',').take(MOST_COLUMNS);
        self.columns = names.map(column).collect();
        let first_data = self.columns.iter().position(|it| *it == Column::Data);
        self.columns
            .truncate(first_data.map_or(MOST_COLUMNS, |at| at + 1));
        let has = |column| self.columns.contains(&column);
        let needed = [
            Column::Time,
            Column::Identifier,
            Column::Length,
            Column::Data,
        ];
        if needed.into_iter().all(has) {
            return Ok(());
        }
        Err(header_problem(
            "columns are missing",
            "`Time Stamp,ID,Extended,Dir,Bus,LEN,D1,…` or \
             `timestamp,arbitration_id,extended,remote,error,dlc,data`",
        ))
    }

    fn row(&self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        let mut fields = line.split(|byte| *byte == b',').map(<[u8]>::trim_ascii);
        let mut row = Row::default();
        for column in &self.columns {
            if *column == Column::Data {
                break;
            }
            let field = fields.next().ok_or(NO_ROW)?;
            row.take(*column, field, self.is_python_can)?;
        }
        if row.is_error {
            return Ok(TextLine::BusError);
        }
        if row.length > MOST_BYTES {
            return Ok(TextLine::FlexibleRate);
        }
        let id = row.id()?;
        let frame = if row.is_remote {
            CanFrame::new_remote(id, row.length)
        } else {
            let data = if self.is_python_can {
                base64_data(fields.next(), row.length)
            } else {
                hexadecimal_data(&mut fields, row.length)
            };
            CanFrame::new(id, data?.get(..row.length).unwrap_or_default())
        };
        Ok(TextLine::Frame {
            micros: row.micros,
            interface: interfaces.channel(row.bus.saturating_add(1)),
            frame: frame.ok_or(NO_ROW)?,
            is_closed: self.is_python_can && row.length > 0 && line.ends_with(b"="),
        })
    }
}

const NO_ROW: LineProblem = problem("no frame", "as many columns as the header has");

/// The fields before the data.
#[derive(Default)]
struct Row {
    micros: i64,
    raw_id: u32,
    is_extended: bool,
    is_remote: bool,
    is_error: bool,
    bus: u32,
    length: usize,
}

impl Row {
    fn take(&mut self, column: Column, field: &[u8], is_python_can: bool) -> Parsed<()> {
        match column {
            Column::Time => self.micros = time(field, is_python_can)?,
            Column::Identifier => {
                let digits = field.strip_prefix(b"0x").unwrap_or(field);
                self.raw_id = number(digits, 16).ok_or(NO_ID)?;
            }
            Column::Extended => self.is_extended = is_true(field)?,
            Column::Remote => self.is_remote = is_true(field)?,
            Column::Error => self.is_error = is_true(field)?,
            Column::Bus => self.bus = number(field, 10).ok_or(NO_ROW)?,
            Column::Length => {
                let length = number(field, 10).map(|length| length as usize);
                let length = length.filter(|length| *length <= MOST_FD_BYTES);
                self.length = length.ok_or(problem("no data length", "a number from 0 to 8"))?;
            }
            Column::Data | Column::Unused => {}
        }
        Ok(())
    }

    fn id(&self) -> Parsed<Id> {
        identifier(self.raw_id, self.is_extended).ok_or(NO_ID)
    }
}

const NO_ID: LineProblem = problem(
    "no CAN identifier",
    "hexadecimal digits up to 7FF, or up to 1FFFFFFF of an extended frame",
);

impl LineFormat for CsvLog {
    fn parse(&mut self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        let line = line.trim_ascii();
        if line.is_empty() {
            return Ok(TextLine::Blank);
        }
        if line.starts_with(b"#") {
            return Ok(TextLine::Other);
        }
        if self.columns.is_empty() {
            return self.header(line).map(|()| TextLine::Other);
        }
        self.row(line, interfaces)
    }
}

fn column(name: &[u8]) -> Column {
    match name.trim_ascii().to_ascii_lowercase().as_slice() {
        b"time stamp" | b"timestamp" => Column::Time,
        b"id" | b"arbitration_id" => Column::Identifier,
        b"extended" => Column::Extended,
        b"remote" => Column::Remote,
        b"error" => Column::Error,
        b"bus" => Column::Bus,
        b"len" | b"dlc" => Column::Length,
        b"d1" | b"data" => Column::Data,
        _ => Column::Unused,
    }
}

/// Reads seconds, with an exponent if they are few, or whole microseconds.
fn time(field: &[u8], is_seconds: bool) -> Parsed<i64> {
    let micros = if is_seconds {
        signed_fixed_point(field, 6).or_else(|| {
            let seconds: f64 = str::from_utf8(field).ok()?.parse().ok()?;
            let micros = (seconds * 1e6).round();
            (micros.abs() <= MOST_MICROS as f64).then_some(micros as i64)
        })
    } else {
        // With a point they would be another unit.
        let is_whole = !field.contains(&b'.');
        is_whole.then(|| signed_fixed_point(field, 0)).flatten()
    };
    micros.ok_or(problem(
        "no time",
        "a number of SavvyCAN's µs or python-can's s",
    ))
}

fn is_true(field: &[u8]) -> Parsed<bool> {
    match field.to_ascii_lowercase().as_slice() {
        b"true" | b"1" => Ok(true),
        b"false" | b"0" => Ok(false),
        _ => Err(problem("no switch", "true, false, 1 or 0")),
    }
}

const NO_DATA: LineProblem = problem(
    "no data",
    "as many bytes as the length says, in hexadecimal digits or base64",
);

fn hexadecimal_data<'a>(
    fields: &mut impl Iterator<Item = &'a [u8]>,
    length: usize,
) -> Parsed<[u8; MOST_BYTES]> {
    let mut data = [0; MOST_BYTES];
    for byte in data.iter_mut().take(length) {
        let field = fields.next().filter(|field| field.len() <= 2);
        let value = field.and_then(|field| number(field, 16)).ok_or(NO_DATA)?;
        *byte = value as u8;
    }
    Ok(data)
}

fn base64_data(field: Option<&[u8]>, length: usize) -> Parsed<[u8; MOST_BYTES]> {
    let field = field.unwrap_or_default();
    // Room as the decoder estimates it: whole groups of three.
    let mut data = [0; MOST_BYTES + 4];
    let count = STANDARD.decode_slice(field, &mut data).ok();
    let whole = count.filter(|count| *count == length).ok_or(NO_DATA)?;
    let mut bytes = [0; MOST_BYTES];
    for (to, from) in bytes.iter_mut().zip(data.iter().take(whole)) {
        *to = *from;
    }
    Ok(bytes)
}
