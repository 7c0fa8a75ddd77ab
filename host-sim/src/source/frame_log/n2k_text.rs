//! NMEA 2000 as text: that of canboat, the RAW of Yacht Devices, the N2K ASCII of Actisense.
//!
//! ```text
//! 2026-11-22T10:00:01.500Z,2,129026,7,255,8,ff,fc,e4,1b,03,00,ff,ff
//! 10:00:01.500 R 09F80207 FF FC E4 1B 03 00 FF FF
//! A100001.500 07FF2 1F802 FFFCE41B0300FFFF
//! ```
//!
//! * canboat: time, priority, parameter group, source, destination, length, bytes. Its form PLAIN has a
//!   line for each frame, its form FAST one for each message.
//! * Yacht Devices: time of day, received or transmitted, identifier, bytes of a frame.
//! * Actisense: time of day, source, destination and priority, parameter group, bytes of a message.
//! * Times of canboat are those of the day in UTC. The others have no day: midnight is no step.

use super::calendar::DateTime;
use super::fields::{Words, fixed_point, number};
use super::line_problem::{LineProblem, Parsed, problem};
use super::rolling_clock::{DAY_US, RollingClock};
use super::text::{LineFormat, TextLine};
use super::whole_message::{Splitter, WholeMessage};
use crate::source::interfaces::Interfaces;

/// Fields of a line of canboat before the bytes.
const CANBOAT_FIELDS: usize = 6;
/// Most bytes of a message.
const MOST_BYTES: usize = 1785;

/// Who wrote a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Writer {
    Canboat,
    YachtDevices,
    Actisense,
}

/// A log of one of them.
pub(super) struct N2kText {
    writer: Writer,
    clock: RollingClock,
    splitter: Splitter,
    data: Vec<u8>,
}

const NO_TIME: LineProblem = problem("no time", "a time such as `10:00:01.500`");
const NO_MESSAGE: LineProblem = problem(
    "no message",
    "`2026-11-22T10:00:01.500Z,2,129026,7,255,8,ff,…`, `10:00:01.500 R 09F80207 FF …` or \
     `A100001.500 07FF2 1F802 FF…`",
);
const NO_DATA: LineProblem = problem(
    "no data",
    "bytes of two hexadecimal digits, as many as the length says",
);

/// Time and the head of a message.
struct Head {
    micros: i64,
    id: WholeMessage<'static>,
}

impl N2kText {
    pub(super) fn of(writer: Writer) -> Self {
        Self {
            writer,
            clock: RollingClock::default(),
            splitter: Splitter::default(),
            data: Vec::new(),
        }
    }

    fn canboat(&mut self, line: &[u8]) -> Parsed<(Head, bool)> {
        let mut fields = line.split(|byte| *byte == b',').map(<[u8]>::trim_ascii);
        let micros = fields.next().and_then(date_and_time).ok_or(NO_TIME)?;
        let mut numbers = [0; CANBOAT_FIELDS - 1];
        for value in &mut numbers {
            let field = fields.next().and_then(|field| number(field, 10));
            *value = field.ok_or(NO_MESSAGE)?;
        }
        let [priority, pgn, source, destination, length] = numbers;
        let mut last_digits = 0;
        for field in fields.filter(|field| !field.is_empty()) {
            last_digits = field.len();
            self.data.push(byte(field).ok_or(NO_DATA)?);
        }
        if self.data.len() != length as usize {
            return Err(NO_DATA);
        }
        let address = |address| u8::try_from(address).map_err(|_| NO_MESSAGE);
        let id = WholeMessage {
            priority,
            pgn,
            source: address(source)?,
            destination: address(destination)?,
            data: &[],
        };
        Ok((Head { micros, id }, last_digits == 2))
    }

    fn yacht_devices(&mut self, line: &[u8]) -> Parsed<(Head, bool)> {
        let mut words = Words(line);
        let micros = words.next().and_then(time_of_day).ok_or(NO_TIME)?;
        let Some(b"R" | b"T") = words.next() else {
            return Err(NO_MESSAGE);
        };
        let id = words.next().and_then(|word| number(word, 16));
        let id = id.filter(|id| *id < 1 << 29).ok_or(problem(
            "no CAN identifier",
            "8 hexadecimal digits up to 1FFFFFFF",
        ))?;
        let mut last_digits = 0;
        for word in words {
            last_digits = word.len();
            self.data.push(byte(word).ok_or(NO_DATA)?);
        }
        let micros = self.clock.within(micros, DAY_US);
        let id = WholeMessage::of_id(id, &[]);
        // A frame has 8 bytes at most.
        Ok((
            Head { micros, id },
            last_digits == 2 && self.data.len() == 8,
        ))
    }

    fn actisense(&mut self, line: &[u8]) -> Parsed<(Head, bool)> {
        let mut words = Words(line);
        let time = words.next().and_then(|word| word.strip_prefix(b"A"));
        let micros = time.and_then(packed_time_of_day).ok_or(NO_TIME)?;
        let mut numbers = || words.next().and_then(|word| number(word, 16));
        let (Some(addresses), Some(pgn)) = (numbers(), numbers()) else {
            return Err(NO_MESSAGE);
        };
        if addresses >> 20 != 0 {
            return Err(NO_MESSAGE);
        }
        let digits = words.next().unwrap_or_default();
        let (pairs, []) = digits.as_chunks::<2>() else {
            return Err(NO_DATA);
        };
        for pair in pairs {
            self.data.push(byte(pair).ok_or(NO_DATA)?);
        }
        let micros = self.clock.within(micros, DAY_US);
        let id = WholeMessage {
            priority: addresses & 0xf,
            pgn,
            source: (addresses >> 12) as u8,
            destination: (addresses >> 4) as u8,
            data: &[],
        };
        Ok((Head { micros, id }, false))
    }
}

impl LineFormat for N2kText {
    fn parse(&mut self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        let line = line.trim_ascii();
        let [first, rest @ ..] = line else {
            return Ok(TextLine::Blank);
        };
        let is_line = match self.writer {
            Writer::Canboat | Writer::YachtDevices => first.is_ascii_digit(),
            Writer::Actisense => *first == b'A' && rest.first().is_some_and(u8::is_ascii_digit),
        };
        if !is_line {
            return Ok(TextLine::Other);
        }
        self.data.clear();
        let (head, is_closed) = match self.writer {
            Writer::Canboat => self.canboat(line),
            Writer::YachtDevices => self.yacht_devices(line),
            Writer::Actisense => self.actisense(line),
        }?;
        if head.id.priority > 7 || self.data.len() > MOST_BYTES {
            return Err(NO_MESSAGE);
        }
        let message = WholeMessage {
            data: &self.data,
            ..head.id
        };
        let frames = self.splitter.split(&message)?;
        let (micros, interface) = (head.micros, interfaces.channel(1));
        let [frame] = frames[..] else {
            return Ok(if frames.is_empty() {
                TextLine::Other
            } else {
                TextLine::Message {
                    micros,
                    interface,
                    frames,
                }
            });
        };
        Ok(TextLine::Frame {
            micros,
            interface,
            frame,
            is_closed,
        })
    }
}

/// Reads a byte of one or two hexadecimal digits.
fn byte(digits: &[u8]) -> Option<u8> {
    let is_byte = (1..=2).contains(&digits.len());
    is_byte
        .then(|| number(digits, 16))
        .flatten()
        .map(|value| value as u8)
}

/// Reads `10:00:01.500`; below a microsecond is cut.
fn time_of_day(word: &[u8]) -> Option<i64> {
    let mut parts = word.splitn(3, |byte| *byte == b':');
    let hour = parts.next().and_then(|part| number(part, 10))?;
    let minute = parts.next().and_then(|part| number(part, 10))?;
    let micros = parts.next().and_then(|part| fixed_point(part, 6))?;
    time(hour, minute, micros)
}

/// Reads `100001.500`.
fn packed_time_of_day(word: &[u8]) -> Option<i64> {
    let (hour, rest) = word.split_at_checked(2)?;
    let (minute, seconds) = rest.split_at_checked(2)?;
    time(
        number(hour, 10)?,
        number(minute, 10)?,
        fixed_point(seconds, 6)?,
    )
}

fn time(hour: u32, minute: u32, micros: u64) -> Option<i64> {
    // A minute may have a leap second.
    let is_time = hour < 24 && minute < 60 && micros < 61_000_000;
    is_time.then(|| i64::from(60 * hour + minute) * 60_000_000 + micros as i64)
}

/// Reads `2026-11-22T10:00:01.500Z`, or with a blank, `-` or `Z` in its middle.
fn date_and_time(word: &[u8]) -> Option<i64> {
    let (date, time) = word.split_at_checked(10)?;
    let mut parts = date.split(|byte| *byte == b'-');
    let mut part = || parts.next().and_then(|part| number(part, 10));
    let (year, month, day) = (part()?, part()?, part()?);
    let (b'T' | b'Z' | b'-' | b' ', time) = time.split_first()? else {
        return None;
    };
    let of_day = time_of_day(time.strip_suffix(b"Z").unwrap_or(time))?;
    let midnight = DateTime {
        year: year.into(),
        month: month.into(),
        day: day.into(),
        ..DateTime::default()
    }
    .unix_micros()?;
    i64::try_from(midnight)
        .ok()
        .map(|midnight| midnight + of_day)
}
