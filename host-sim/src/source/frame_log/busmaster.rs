//! The text of BUSMASTER, of the protocols CAN and J1939.
//!
//! ```text
//! ***BUSMASTER Ver 3.2.2***
//! ***PROTOCOL CAN***
//! ***START DATE AND TIME 22:11:2026 10:0:0:000***
//! ***HEX***
//! ***SYSTEM MODE***
//! ***<Time><Tx/Rx><Channel><CAN ID><Type><DLC><DataBytes>***
//! 10:00:01:5000 Rx 1 0x0CF00400 x 8 60 7D 84 48 14 00 F0 84
//! ***<Time><Channel><CAN ID><PGN><Type><Source Node><Destination Node><Priority><Tx/Rx><DLC><DataBytes>***
//! 10:00:01:5000 1 0x0CF00400 0x00F004 NONE 00 FF 3 Rx 8 60 7D 84 48 14 00 F0 84
//! ```
//!
//! * The last part of a time are the digits behind the point, of 100 µs.
//! * Times are those of the day (`SYSTEM`), those since the start (`ABSOLUTE`), or since the line before
//!   (`RELATIVE`). The clock is that of the logger, without its time zone.
//! * In the layout of J1939, messages of more than 8 bytes are put together; their frames may stand before
//!   them.

use super::calendar::DateTime;
use super::fields::{Words, data_frame, identifier, length_of, number};
use super::line_problem::{LineProblem, Parsed, header_problem, problem};
use super::rolling_clock::{DAY_US, RollingClock};
use super::text::{LineFormat, TextLine};
use super::whole_message::{Splitter, WholeMessage};
use crate::source::can_frame::CanFrame;
use crate::source::interfaces::{InterfaceIndex, Interfaces};
use embedded_can::{Frame, Id};

/// Most data bytes of a classic frame.
const MOST_BYTES: usize = 8;

/// What the times are.
#[derive(Clone, Copy, Default)]
enum TimeMode {
    #[default]
    System,
    Absolute,
    Relative,
}

/// What the header said.
#[derive(Default)]
pub(super) struct Busmaster {
    is_decimal: bool,
    mode: TimeMode,
    /// The start, in microseconds since the Unix epoch.
    start_us: i64,
    clock: RollingClock,
    /// Sum of the times of lines that count from the line before.
    sum_us: i64,
    /// True if the frames of the transport protocol are in the log.
    has_transport: bool,
    splitter: Splitter,
}

const NO_FRAME: LineProblem = problem(
    "no frame",
    "time, direction, channel, identifier, type, length and data, or those of J1939",
);
const NO_ID: LineProblem = problem(
    "no CAN identifier",
    "a number up to 7FF (2047), or up to 1FFFFFFF of an extended frame",
);

impl Busmaster {
    /// Takes a line between stars.
    fn header(&mut self, line: &[u8]) -> Parsed<()> {
        let words = line.trim_ascii_start().to_ascii_uppercase();
        let words = words
            .split(|byte| *byte == b'*')
            .find(|part| !part.is_empty());
        let words = words.unwrap_or_default().trim_ascii();
        if let Some(protocol) = words.strip_prefix(b"PROTOCOL ") {
            if !matches!(protocol.trim_ascii(), b"CAN" | b"J1939") {
                return Err(header_problem(
                    "a protocol that is not read",
                    "`***PROTOCOL CAN***` or `***PROTOCOL J1939***`",
                ));
            }
        } else if let Some(start) = words.strip_prefix(b"START DATE AND TIME ") {
            // Logs that are appended have a header each.
            let start_us = date_and_time(start);
            self.start_us = start_us.unwrap_or_default();
            self.clock = start_us.map_or_else(RollingClock::default, RollingClock::from_start);
            self.sum_us = 0;
        }
        match words {
            b"HEX" => self.is_decimal = false,
            b"DEC" => self.is_decimal = true,
            b"SYSTEM MODE" => self.mode = TimeMode::System,
            b"ABSOLUTE MODE" => self.mode = TimeMode::Absolute,
            b"RELATIVE MODE" => self.mode = TimeMode::Relative,
            _ => {}
        }
        Ok(())
    }

    fn radix(&self) -> u32 {
        if self.is_decimal { 10 } else { 16 }
    }

    /// Returns the time of a line.
    fn micros(&mut self, word: &[u8]) -> Parsed<i64> {
        let micros = time(word).ok_or(problem("no time", "a time such as `10:00:01:5000`"))?;
        Ok(match self.mode {
            TimeMode::System => self.clock.within(micros, DAY_US),
            TimeMode::Absolute => self.start_us + micros,
            TimeMode::Relative => {
                self.sum_us = self.sum_us.saturating_add(micros);
                self.start_us.saturating_add(self.sum_us)
            }
        })
    }

    fn line(&mut self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        let mut words = Words(line);
        let micros = self.micros(words.next().unwrap_or_default())?;
        let second = words.next().ok_or(NO_FRAME)?;
        if is_direction(second) {
            let interface = channel(words.next(), interfaces)?;
            return self.can(words, micros, interface);
        }
        let interface = channel(Some(second), interfaces)?;
        self.j1939(words, micros, interface)
    }

    /// Reads a line of CAN from its identifier on.
    fn can(&self, mut words: Words, micros: i64, interface: InterfaceIndex) -> Parsed<TextLine> {
        let raw = words.next().ok_or(NO_FRAME)?;
        let kind = words.next().unwrap_or_default().to_ascii_lowercase();
        if kind.starts_with(b"err") || raw.to_ascii_lowercase().starts_with(b"err") {
            return Ok(TextLine::BusError);
        }
        let (is_extended, is_remote) = match kind.as_slice() {
            b"s" => (false, false),
            b"x" => (true, false),
            b"sr" => (false, true),
            b"xr" => (true, true),
            b"s-fd" | b"x-fd" => return Ok(TextLine::FlexibleRate),
            _ => return Err(problem("no type of frame", "s, x, sr, xr, s-fd or x-fd")),
        };
        let id = identifier(self.raw_id(raw)?, is_extended).ok_or(NO_ID)?;
        // The length is decimal, also beside hexadecimal data.
        let length = length_of(words.next(), 10)?;
        if is_remote {
            return frame(micros, interface, CanFrame::new_remote(id, length), false);
        }
        if Words(words.0).count() > MOST_BYTES {
            return Ok(TextLine::FlexibleRate);
        }
        self.data(&mut words, micros, interface, id, length)
    }

    /// Reads a line of J1939 from its identifier on.
    fn j1939(
        &mut self,
        mut words: Words,
        micros: i64,
        interface: InterfaceIndex,
    ) -> Parsed<TextLine> {
        let raw = self.raw_id(words.next().ok_or(NO_FRAME)?)?;
        let id = identifier(raw, true).ok_or(NO_ID)?;
        let kind = words.nth(1).ok_or(NO_FRAME)?;
        if kind.starts_with(b"ERR") {
            return Ok(TextLine::BusError);
        }
        self.has_transport |= kind == b"TPDT";
        let direction = words.nth(3).ok_or(NO_FRAME)?;
        let length = words.next().and_then(|word| number(word, 10));
        let length = length.filter(|_| is_direction(direction)).ok_or(NO_FRAME)?;
        let length = length as usize;
        if length <= MOST_BYTES {
            return self.data(&mut words, micros, interface, id, length);
        }
        if self.has_transport {
            return Ok(TextLine::Other);
        }
        let radix = self.radix();
        let byte = |word| number(word, radix).and_then(|value| u8::try_from(value).ok());
        let data: Option<Vec<u8>> = words.map(byte).collect();
        let data = data.filter(|data| data.len() == length).ok_or(NO_FRAME)?;
        let frames = self.splitter.split(&WholeMessage::of_id(raw, &data))?;
        Ok(TextLine::Message {
            micros,
            interface,
            frames,
        })
    }

    fn data(
        &self,
        words: &mut Words,
        micros: i64,
        interface: InterfaceIndex,
        id: Id,
        length: usize,
    ) -> Parsed<TextLine> {
        let (data, is_closed) = data_frame(words, id, length, self.radix())?;
        frame(micros, interface, Some(data), is_closed)
    }

    fn raw_id(&self, word: &[u8]) -> Parsed<u32> {
        let hexadecimal = word
            .strip_prefix(b"0x")
            .or_else(|| word.strip_prefix(b"0X"));
        let raw = match hexadecimal {
            Some(digits) => number(digits, 16),
            None => number(word, self.radix()),
        };
        raw.ok_or(NO_ID)
    }
}

fn frame(
    micros: i64,
    interface: InterfaceIndex,
    frame: Option<CanFrame>,
    is_closed: bool,
) -> Parsed<TextLine> {
    Ok(TextLine::Frame {
        micros,
        interface,
        frame: frame.ok_or(NO_FRAME)?,
        is_closed,
    })
}

fn is_direction(word: &[u8]) -> bool {
    word.eq_ignore_ascii_case(b"rx") || word.eq_ignore_ascii_case(b"tx")
}

fn channel(word: Option<&[u8]>, interfaces: &mut Interfaces) -> Parsed<InterfaceIndex> {
    let channel = word.and_then(|word| number(word, 10)).ok_or(NO_FRAME)?;
    Ok(interfaces.channel(channel))
}

impl LineFormat for Busmaster {
    fn parse(&mut self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        match line.trim_ascii() {
            [] => Ok(TextLine::Blank),
            line if line.starts_with(b"***") => self.header(line).map(|()| TextLine::Other),
            // Frames begin with their time.
            [first, ..] if !first.is_ascii_digit() => Ok(TextLine::Other),
            line => self.line(line, interfaces),
        }
    }
}

/// Reads `10:00:01:5000`; hours may be more than 24.
fn time(word: &[u8]) -> Option<i64> {
    let mut parts = word.split(|byte| *byte == b':');
    let mut part = || parts.next().and_then(|part| number(part, 10));
    let (hour, minute, second) = (part()?, part()?, part()?);
    let fraction = parts.next().filter(|part| (1..=6).contains(&part.len()))?;
    let scale = 10_i64.pow(6 - fraction.len() as u32);
    let fraction = i64::from(number(fraction, 10)?) * scale;
    let is_time = hour < 10_000 && minute < 60 && second < 60 && parts.next().is_none();
    let seconds = i64::from(hour) * 3600 + i64::from(minute * 60 + second);
    is_time.then_some(seconds * 1_000_000 + fraction)
}

/// Reads `22:11:2026 10:0:0:5`, whose last number are milliseconds.
fn date_and_time(words: &[u8]) -> Option<i64> {
    let is_between = |byte: &u8| matches!(byte, b':' | b' ');
    let parts = words.split(is_between).filter(|part| !part.is_empty());
    let mut numbers = parts.map(|part| number(part, 10).map(u64::from));
    let mut part = || numbers.next().flatten();
    let (day, month, year) = (part()?, part()?, part()?);
    let (hour, minute, second) = (part()?, part()?, part()?);
    let start = DateTime {
        year,
        month,
        day,
        hour,
        minute,
        second,
        micros: 1000 * part()?,
    };
    i64::try_from(start.unix_micros()?).ok()
}
