//! candump logs: both layouts, and time stamps of every kind.
//!
//! ```text
//! (1.000000) can0 0CF00400#0102030405060708             candump -l, -L
//! (001.000000)  can0  0CF00400   [8]  01 02 03 04 …     candump -t a|z|d on a terminal
//! (2026-11-22 10:00:00.000000)  can0  0CF00400 …        candump -t A
//! ```
//!
//! The parser is our own. It reads both layouts, detects truncated logs, names the line of each
//! error, and reads millions of frames per second without an allocation per line.
//!
//! * Times are those of the log, in microseconds; since the Unix epoch if candump logged absolute
//!   time.
//! * Differences (`-t d`) are told from other times by the first lines: they do not grow.
//! * Among fractions of six digits, one of seven is a count of microseconds that a writer did not carry.
//! * CAN FD and CAN XL frames and bus error reports of the kernel are skipped and counted.
//! * Lines that do not begin with a bracket are comments, unless they have the rest of a frame.
//! * A last line without a line end counts only if it cannot be truncated.

use super::candump_line::{Content, parse, time_of};
use super::fields::{FractionDigits, MOST_MICROS};
use super::line_problem::{Parsed, problem};
use super::text::{LineFormat, TextLine};
use crate::source::interfaces::Interfaces;

/// Fewest lines that show differences of time.
const FEWEST: usize = 3;

/// What the first lines say on the times.
#[derive(Default)]
pub(super) struct Candump {
    are_differences: bool,
    micros: i64,
    digits: FractionDigits,
}

impl Candump {
    /// Creates the format of a log that begins with these bytes.
    pub(super) fn of_head(head: &[u8]) -> Self {
        let lines = head.split_inclusive(|byte| *byte == b'\n');
        let whole = lines.filter(|line| line.ends_with(b"\n"));
        let times: Vec<i64> = whole.filter_map(time_of).collect();
        Self {
            are_differences: are_differences(&times),
            ..Self::default()
        }
    }
}

/// Returns true if these times are those between frames. Other times begin with 0, too, but grow: of
/// frames that were logged in the wrong order there are few.
fn are_differences(times: &[i64]) -> bool {
    let [0, later @ ..] = times else {
        return false;
    };
    if later.len() < FEWEST {
        return false;
    }
    let pairs = || later.iter().zip(later.iter().skip(1));
    let falling = pairs().filter(|(one, next)| next < one).count();
    let is_constant = later.first() > Some(&0) && pairs().all(|(one, next)| one == next);
    falling * 5 > later.len() || is_constant
}

impl LineFormat for Candump {
    fn parse(&mut self, text: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        let Some(line) = parse(text)? else {
            return Ok(if text.trim_ascii().is_empty() {
                TextLine::Blank
            } else {
                TextLine::Other
            });
        };
        let mut micros = if self.digits.is_overflow(line.stamp.fraction_digits) {
            line.stamp.overflowed()?
        } else {
            line.stamp.micros
        };
        if self.are_differences {
            let sum = self.micros.checked_add(micros);
            let sum = sum.filter(|sum| *sum <= MOST_MICROS);
            micros = sum.ok_or(problem("too large a sum of times", "at most 10^12 s"))?;
            self.micros = micros;
        }
        Ok(match line.content {
            Content::Frame(frame) => TextLine::Frame {
                micros,
                interface: interfaces.named(line.interface),
                frame,
                is_closed: line.is_closed,
            },
            Content::FlexibleRate => TextLine::FlexibleRate,
            Content::ExtraLarge => TextLine::ExtraLarge,
            Content::BusError => TextLine::BusError,
        })
    }
}
