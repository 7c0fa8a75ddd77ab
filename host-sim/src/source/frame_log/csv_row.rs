//! A row of the CSV of several programs and loggers.

use super::csv_columns::{Column, Dialect};
use super::fields::{MOST_MICROS, identifier, number, signed_fixed_point};
use super::line_problem::{LineProblem, Parsed, problem};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use embedded_can::Id;

/// Most data bytes of a classic frame.
pub(super) const MOST_BYTES: usize = 8;
/// Most data bytes of a CAN FD frame.
const MOST_FD_BYTES: usize = 64;
/// Largest identifier of 11 bits.
const MOST_STANDARD: u32 = 0x7ff;

/// The fields before the data.
#[derive(Default)]
pub(super) struct Row {
    pub micros: i64,
    pub is_remote: bool,
    pub is_error: bool,
    pub is_flexible_rate: bool,
    pub bus: Option<u32>,
    /// The length, if the row has it.
    pub length: Option<usize>,
    /// The code of the length.
    pub code: usize,
    raw_id: u32,
    is_extended: Option<bool>,
}

pub(super) const NO_ROW: LineProblem = problem("no frame", "as many columns as the header has");
const NO_ID: LineProblem = problem(
    "no CAN identifier",
    "hexadecimal digits up to 7FF, or up to 1FFFFFFF of an extended frame",
);

impl Row {
    /// Takes a field, but that of the time of a logger whose times need those before.
    pub(super) fn take(&mut self, column: Column, field: &[u8], dialect: Dialect) -> Parsed<()> {
        match column {
            Column::Time => self.micros = time(field, dialect)?,
            Column::Identifier => {
                let digits = field.strip_prefix(b"0x").unwrap_or(field);
                self.raw_id = number(digits, 16).ok_or(NO_ID)?;
            }
            Column::Extended => self.is_extended = Some(is_true(field)?),
            Column::Remote => self.is_remote = is_true(field)?,
            Column::Error => self.is_error = is_true(field)?,
            Column::FlexibleRate => self.is_flexible_rate = is_true(field)?,
            Column::Type => {
                self.is_extended = Some(match field {
                    b"0" | b"8" => false,
                    b"1" | b"9" => true,
                    _ => return Err(problem("no type of message", "0, 1, 8 or 9")),
                });
            }
            Column::Bus => self.bus = Some(number(field, 10).ok_or(NO_ROW)?),
            Column::Length => self.length = Some(length(field)?),
            Column::LengthCode => self.code = length(field)?.min(MOST_BYTES),
            Column::Data | Column::Unused => {}
        }
        Ok(())
    }

    /// Returns the identifier. Where a table does not tell how many bits it has, its value does, as that
    /// of every message of J1939.
    pub(super) fn id(&self, dialect: Dialect) -> Parsed<Id> {
        let by_value = dialect == Dialect::Clx && self.raw_id > MOST_STANDARD;
        let is_extended = self.is_extended.unwrap_or(by_value);
        identifier(self.raw_id, is_extended).ok_or(NO_ID)
    }
}

fn length(field: &[u8]) -> Parsed<usize> {
    let length = number(field, 10).map(|length| length as usize);
    let length = length.filter(|length| *length <= MOST_FD_BYTES);
    length.ok_or(problem("no data length", "a number from 0 to 8"))
}

/// Reads seconds, with an exponent if they are few, or whole microseconds.
fn time(field: &[u8], dialect: Dialect) -> Parsed<i64> {
    let micros = if dialect == Dialect::SavvyCan {
        // With a point they would be another unit. The clock of the computer counts since 1970.
        let micros: Option<i64> = str::from_utf8(field)
            .ok()
            .and_then(|text| text.parse().ok());
        micros.filter(|micros| micros.unsigned_abs() <= MOST_MICROS.unsigned_abs())
    } else {
        signed_fixed_point(field, 6).or_else(|| {
            let seconds: f64 = str::from_utf8(field).ok()?.parse().ok()?;
            let micros = (seconds * 1e6).round();
            (micros.abs() <= MOST_MICROS as f64).then_some(micros as i64)
        })
    };
    micros.ok_or(problem(
        "no time",
        "a number of SavvyCAN's µs, or of seconds",
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

/// Data bytes, of which the first `count` are those of the frame.
pub(super) struct RowData {
    pub bytes: [u8; MOST_BYTES],
    pub count: usize,
    /// True if the row cannot be truncated.
    pub is_closed: bool,
}

/// Reads bytes in a field each.
pub(super) fn byte_fields<'a>(
    fields: &mut impl Iterator<Item = &'a [u8]>,
    count: usize,
) -> Parsed<RowData> {
    let mut bytes = [0; MOST_BYTES];
    for byte in bytes.iter_mut().take(count) {
        let field = fields.next().filter(|field| field.len() <= 2);
        let value = field.and_then(|field| number(field, 16)).ok_or(NO_DATA)?;
        *byte = value as u8;
    }
    Ok(RowData {
        bytes,
        count,
        is_closed: false,
    })
}

pub(super) fn base64_data(field: Option<&[u8]>, count: usize) -> Parsed<RowData> {
    let field = field.unwrap_or_default();
    // Room as the decoder estimates it: whole groups of three.
    let mut data = [0; MOST_BYTES + 4];
    let found = STANDARD.decode_slice(field, &mut data).ok();
    let whole = found.filter(|found| *found == count).ok_or(NO_DATA)?;
    let mut bytes = [0; MOST_BYTES];
    for (to, from) in bytes.iter_mut().zip(data.iter().take(whole)) {
        *to = *from;
    }
    Ok(RowData {
        bytes,
        count,
        is_closed: count > 0 && field.ends_with(b"="),
    })
}

/// Reads bytes of two digits each without blanks; `None` if they are those of a CAN FD frame. Without a
/// length, the digits tell.
pub(super) fn digit_pairs(field: Option<&[u8]>, length: Option<usize>) -> Parsed<Option<RowData>> {
    let field = field.unwrap_or_default();
    let (pairs, []) = field.as_chunks::<2>() else {
        return Err(NO_DATA);
    };
    let count = length.unwrap_or(pairs.len());
    if count != pairs.len() || count > MOST_FD_BYTES {
        return Err(NO_DATA);
    }
    let mut bytes = [0; MOST_BYTES];
    for (k, pair) in pairs.iter().enumerate() {
        let value = number(pair, 16).ok_or(NO_DATA)?;
        if let Some(byte) = bytes.get_mut(k) {
            *byte = value as u8;
        }
    }
    Ok((count <= MOST_BYTES).then_some(RowData {
        bytes,
        count,
        is_closed: count > 0 && (length.is_some() || count == MOST_BYTES),
    }))
}
