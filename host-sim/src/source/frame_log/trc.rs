//! PEAK's text format (TRC), versions 1.0 to 1.3, 2.0 and 2.1.
//!
//! ```text
//!      1)         2  0CF00400  8  01 02 03 04 05 06 07 08
//! ;$FILEVERSION=1.1
//!      1)         2.3  Rx     0CF00400  8  01 02 03 04 05 06 07 08
//! ;$FILEVERSION=1.2
//!      1)         2.3 1  Rx     0CF00400  8  01 02 03 04 05 06 07 08
//! ;$FILEVERSION=1.3
//!      1)         2.3 1  Rx     0CF00400 -  8    01 02 03 04 05 06 07 08
//! ;$FILEVERSION=2.1
//! ;$COLUMNS=N,O,T,B,I,d,R,L,D
//!       1         2.300 DT 1  0CF00400 Rx -  8    01 02 03 04 05 06 07 08
//! ```
//!
//! * Version 1.0 has no line `;$FILEVERSION`. Its errors of the bus have the identifier FFFFFFFF.
//! * Messages of more than 8 bytes are those that a J1939 add-in has put together; their frames stand
//!   in the file too.
//! * Times are milliseconds since the start of the measurement.
//! * An identifier of more than 4 digits has 29 bits, any other 11 bits. PEAK's programs write 8 and 4
//!   digits, others leave out zeros.

use super::fields::{Words, data_frame, identifier, length_of, number, signed_fixed_point};
use super::line_problem::{LineProblem, Parsed, header_problem, problem};
use super::text::{LineFormat, TextLine};
use crate::source::can_frame::CanFrame;
use crate::source::interfaces::Interfaces;
use embedded_can::{Frame, Id};

/// The layout of the lines, from the header.
#[derive(Default)]
pub(super) struct Trc {
    has_version: bool,
    origin_us: Option<u64>,
    columns: Vec<Column>,
}

/// A column; the comments have its letter in `;$COLUMNS`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Column {
    /// `O`
    Time,
    /// `T`
    Type,
    /// `I`
    Identifier,
    /// `L`
    Length,
    /// `l`: 9 to 15 mean 8 bytes too.
    LengthCode,
    /// `D`
    Data,
    /// `B`
    Bus,
    /// `N`, `d`, `R` and others of one word.
    Unused,
}

/// What a line of some type is.
enum Message {
    Data,
    Remote,
    FlexibleRate,
    BusError,
    Status,
}

const COLUMNS_1_0: [Column; 5] = [
    Column::Unused,
    Column::Time,
    Column::Identifier,
    Column::Length,
    Column::Data,
];
const COLUMNS_1_1: [Column; 6] = [
    Column::Unused,
    Column::Time,
    Column::Type,
    Column::Identifier,
    Column::Length,
    Column::Data,
];
const COLUMNS_1_2: [Column; 7] = [
    Column::Unused,
    Column::Time,
    Column::Bus,
    Column::Type,
    Column::Identifier,
    Column::Length,
    Column::Data,
];
const COLUMNS_1_3: [Column; 8] = [
    Column::Unused,
    Column::Time,
    Column::Bus,
    Column::Type,
    Column::Identifier,
    Column::Unused,
    Column::Length,
    Column::Data,
];

const VERSIONS: &str = "1.0 to 1.3, 2.0 or 2.1";
/// Identifier of an error of the bus in version 1.0.
const BUS_ERROR: &[u8] = b"FFFFFFFF";
const NO_FRAME: LineProblem = problem(
    "no frame",
    "number, time, type, identifier, length and data in the order of the header",
);

impl LineFormat for Trc {
    fn origin_us(&self) -> Option<u64> {
        self.origin_us
    }

    fn parse(&mut self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        match line.trim_ascii() {
            [] => Ok(TextLine::Blank),
            [b';', header @ ..] => self.header(header).map(|()| TextLine::Other),
            // Messages begin with their number.
            [first, ..] if !first.is_ascii_digit() => Ok(TextLine::Other),
            line if !self.has_version => {
                // A log of version 1.0 names no version.
                self.columns = COLUMNS_1_0.to_vec();
                self.has_version = true;
                self.message(line, interfaces)
            }
            _ if self.columns.is_empty() => Err(header_problem(
                "no columns above",
                "a line such as `;$COLUMNS=N,O,T,B,I,d,R,L,D`",
            )),
            line => self.message(line, interfaces),
        }
    }
}

impl Trc {
    fn header(&mut self, header: &[u8]) -> Parsed<()> {
        if let Some(version) = header.strip_prefix(b"$FILEVERSION=") {
            self.columns = match version.trim_ascii() {
                b"1.0" => COLUMNS_1_0.to_vec(),
                b"1.1" => COLUMNS_1_1.to_vec(),
                b"1.2" => COLUMNS_1_2.to_vec(),
                b"1.3" => COLUMNS_1_3.to_vec(),
                b"2.0" | b"2.1" => Vec::new(),
                _ => return Err(header_problem("a version that is not read", VERSIONS)),
            };
            self.has_version = true;
        } else if let Some(days) = header.strip_prefix(b"$STARTTIME=") {
            // Some programs write a semicolon behind it.
            let days = days.trim_ascii();
            self.origin_us = start_time(days.strip_suffix(b";").unwrap_or(days));
        } else if let Some(names) = header.strip_prefix(b"$COLUMNS=") {
            let names = names.trim_ascii().split(|byte| *byte == b',');
            self.columns = names.map(column).collect();
            let has = |column| self.columns.contains(&column);
            if ![Column::Time, Column::Type, Column::Identifier, Column::Data]
                .into_iter()
                .all(has)
                || !(has(Column::Length) || has(Column::LengthCode))
            {
                return Err(header_problem(
                    "columns are missing",
                    "at least O, T, I, l or L, and D",
                ));
            }
        }
        Ok(())
    }

    fn message(&self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        let mut words = Words(line);
        let mut micros = None;
        let has_type = self.columns.contains(&Column::Type);
        let mut message = (!has_type).then_some(Message::Data);
        let mut id = None;
        let mut length = None;
        let mut bus = 1;
        for column in &self.columns {
            match column {
                Column::Data => break,
                Column::Time => micros = Some(time(words.next())?),
                Column::Identifier => {
                    let word = words.next();
                    if !has_type && word == Some(BUS_ERROR) {
                        return Ok(TextLine::BusError);
                    }
                    id = Some(identifier_of(word)?);
                }
                Column::Bus => bus = bus_of(words.next())?,
                Column::Length => {
                    let word = words.next();
                    if word.is_some_and(is_long) {
                        return Ok(TextLine::Other);
                    }
                    length = Some(length_of(word, 10)?);
                }
                Column::LengthCode => length = Some(length_of(words.next(), 10)?),
                Column::Type => {
                    message = match message_of(words.next())? {
                        // The other columns of these may be empty.
                        Message::FlexibleRate => return Ok(TextLine::FlexibleRate),
                        Message::BusError => return Ok(TextLine::BusError),
                        Message::Status => return Ok(TextLine::Other),
                        frame => Some(frame),
                    };
                }
                Column::Unused => {
                    words.next().ok_or(NO_FRAME)?;
                }
            }
        }
        let (Some(micros), Some(message), Some(id), Some(length)) = (micros, message, id, length)
        else {
            return Err(NO_FRAME);
        };
        // Versions 1.x write `RTR` instead of data.
        let is_remote = matches!(message, Message::Remote) || words.0.trim_ascii_start() == b"RTR";
        let (frame, is_closed) = if is_remote {
            let frame = CanFrame::new_remote(id, length).ok_or(NO_FRAME)?;
            (frame, words.0.trim_ascii() == b"RTR")
        } else {
            data_frame(&mut words, id, length, 16)?
        };
        Ok(TextLine::Frame {
            micros,
            interface: interfaces.channel(bus),
            frame,
            is_closed,
        })
    }
}

/// Returns true for the length of a message that is longer than a frame.
fn is_long(word: &[u8]) -> bool {
    const LONGEST: u32 = 1785;
    number(word, 10).is_some_and(|bytes| (9..=LONGEST).contains(&bytes))
}

fn column(name: &[u8]) -> Column {
    match name.trim_ascii() {
        b"O" => Column::Time,
        b"B" => Column::Bus,
        b"T" => Column::Type,
        b"I" => Column::Identifier,
        b"L" => Column::Length,
        b"l" => Column::LengthCode,
        b"D" => Column::Data,
        _ => Column::Unused,
    }
}

/// Reads a time in milliseconds; returns microseconds.
fn time(word: Option<&[u8]>) -> Parsed<i64> {
    let micros = word.and_then(|word| signed_fixed_point(word, 3));
    micros.ok_or(problem(
        "no time",
        "milliseconds since the start, such as `2.300`",
    ))
}

/// Returns the microseconds since the Unix epoch for days since 1899-12-30, the start of OLE dates.
fn start_time(days: &[u8]) -> Option<u64> {
    const EPOCH_DAYS: f64 = 25_569.0;
    let days = str::from_utf8(days).ok()?.replace(',', ".");
    let days: f64 = days.parse().ok()?;
    let micros = ((days - EPOCH_DAYS) * 86_400e6).round();
    (0.0..1e18).contains(&micros).then_some(micros as u64)
}

/// Returns the number of a bus; `-` stands for the only one.
fn bus_of(word: Option<&[u8]>) -> Parsed<u32> {
    match word {
        Some(b"-") => Ok(1),
        Some(word) => number(word, 10).ok_or(NO_FRAME),
        None => Err(NO_FRAME),
    }
}

fn message_of(word: Option<&[u8]>) -> Parsed<Message> {
    Ok(match word {
        Some(b"DT" | b"Rx" | b"Tx") => Message::Data,
        Some(b"RR") => Message::Remote,
        Some(b"FD" | b"FB" | b"FE" | b"BI") => Message::FlexibleRate,
        Some(b"ER" | b"Error" | b"Warng") => Message::BusError,
        Some(b"ST" | b"EC" | b"EV") => Message::Status,
        _ => {
            return Err(problem(
                "no type of message",
                "DT, RR, FD, FB, FE, BI, ST, ER, EC or EV; Rx, Tx, Warng or Error in 1.x",
            ));
        }
    })
}

fn identifier_of(word: Option<&[u8]>) -> Parsed<Id> {
    let id = word.and_then(|digits| {
        let is_extended = match digits.len() {
            5..=8 => true,
            1..=4 => false,
            _ => return None,
        };
        identifier(number(digits, 16)?, is_extended)
    });
    id.ok_or(problem(
        "no CAN identifier",
        "4 hexadecimal digits up to 07FF, or up to 8 and 1FFFFFFF",
    ))
}
