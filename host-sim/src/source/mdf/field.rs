//! Numbers and times in a record.

use super::conversion::Conversion;
use super::mdf_file::{Block, MdfFile, number, u32_at};
use crate::error::Result;
use estimator_core::signal::raw_field::RawNumber;

/// Latest time of a log, µs, as for other formats.
const MOST_MICROS: f64 = 1e18;

/// Types of channels.
pub(in crate::source) const FIXED_LENGTH: u8 = 0;
pub(in crate::source) const VARIABLE_LENGTH: u8 = 1;
pub(in crate::source) const MASTER: u8 = 2;
/// A master without bits in the record: its conversion makes a time of the number of the record.
pub(in crate::source) const VIRTUAL_MASTER: u8 = 3;
/// A channel without bits in the record: its conversion makes a value of the number of the record.
pub(in crate::source) const VIRTUAL: u8 = 6;

/// Flags of a channel: none of its values is valid; a bit of each record tells.
const ALL_INVALID: u32 = 1;
const HAS_INVALID_BIT: u32 = 2;

/// A number within a record.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::source) struct Field {
    pub byte: usize,
    pub bit: u32,
    pub bits: u32,
    pub data_type: u8,
}

impl Field {
    /// Returns true if the bits are a number that is read.
    pub(in crate::source) const fn is_number(&self) -> bool {
        match self.data_type {
            0..=3 => matches!(self.bits, 1..=64),
            4 | 5 => matches!(self.bits, 16 | 32 | 64),
            _ => false,
        }
    }

    /// Reads the bits, as they are; `None` if the record is too short.
    pub(in crate::source) fn raw(&self, record: &[u8]) -> Option<u64> {
        let count = self.bit.saturating_add(self.bits).div_ceil(8) as usize;
        let bytes = record.get(self.byte..)?.get(..count)?;
        let is_big_endian = matches!(self.data_type, 1 | 3 | 5);
        let add = |sum: u128, byte: &u8| (sum << 8) | u128::from(*byte);
        let word = if is_big_endian {
            bytes.iter().fold(0, add)
        } else {
            bytes.iter().rev().fold(0, add)
        };
        let mask = u64::MAX.checked_shr(64 - self.bits.clamp(1, 64))?;
        Some(word.checked_shr(self.bit)? as u64 & mask)
    }

    /// Reads the number that the bits mean.
    pub(in crate::source) fn number(&self, record: &[u8]) -> Option<RawNumber> {
        let raw = self.raw(record)?;
        match (self.data_type, self.bits) {
            (4 | 5, 64) => Some(RawNumber::Real(f64::from_bits(raw))),
            (4 | 5, 32) => Some(RawNumber::Real(f32::from_bits(raw as u32).into())),
            (4 | 5, 16) => Some(RawNumber::Real(half(raw as u16))),
            (0 | 1, _) => Some(RawNumber::Unsigned(raw)),
            (2 | 3, bits @ 1..=64) => {
                let unused = 64 - bits;
                Some(RawNumber::Signed((raw << unused) as i64 >> unused))
            }
            _ => None,
        }
    }
}

/// Returns a number in floating point of 16 bits (IEEE 754, binary16).
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    sign * match exponent {
        0 => fraction * 2_f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction / 1024.0) * 2_f64.powi(exponent - 15),
    }
}

/// A time within a record.
#[derive(Clone, Copy, Debug)]
pub(in crate::source) struct Clock {
    /// `None` for a time by the number of the record.
    field: Option<Field>,
    factor_us: f64,
    offset_us: f64,
}

impl Clock {
    /// Reads the conversion of a time to seconds: none, or linear.
    pub(in crate::source) fn read(
        file: &mut MdfFile,
        channel: &Block,
        field: Option<Field>,
    ) -> Result<Option<Self>> {
        let (offset_s, factor_s) = match Conversion::of(file, channel)? {
            Conversion::None => (0.0, 1.0),
            Conversion::Linear { offset, factor } => (offset, factor),
            _ => return Ok(None),
        };
        let is_number = field.is_none_or(|field| field.is_number());
        Ok(is_number.then_some(Self {
            field,
            factor_us: factor_s * 1e6,
            offset_us: offset_s * 1e6,
        }))
    }

    /// Returns true for a time by the number of the record.
    pub(in crate::source) const fn is_virtual(&self) -> bool {
        self.field.is_none()
    }

    /// Reads the time of a record with this number, in microseconds since the start of the
    /// measurement. Some writers take the time at which they open the file for that.
    pub(in crate::source) fn micros(&self, record: &[u8], index: u64) -> Option<i64> {
        let value = match self.field {
            Some(field) => field.number(record)?.to_f64(),
            None => index as f64,
        };
        let micros = (value * self.factor_us + self.offset_us).round();
        (-MOST_MICROS..=MOST_MICROS)
            .contains(&micros)
            .then_some(micros as i64)
    }
}

/// How records mark values that are not valid.
#[derive(Clone, Debug, Default)]
pub(in crate::source) struct Invalid {
    /// True if a value never is.
    is_always: bool,
    /// Where the bits stand, by their byte and mask; set for a value that is not.
    bits: Vec<(usize, u8)>,
}

impl Invalid {
    /// Notes how a channel with these data marks its values, in bytes behind `data_bytes`.
    pub(in crate::source) fn note(&mut self, channel: &[u8], data_bytes: usize) {
        let flags = u32_at(channel, 12).unwrap_or(0);
        self.is_always |= flags & ALL_INVALID != 0;
        if flags & HAS_INVALID_BIT != 0
            && let Some(bit) = u32_at(channel, 16)
        {
            let byte = data_bytes.saturating_add(bit as usize / 8);
            self.bits.push((byte, 1 << (bit % 8)));
        }
    }

    /// Returns true for a record that marks a value.
    pub(in crate::source) fn is_set(&self, record: &[u8]) -> bool {
        let is_set = |(byte, mask): &(usize, u8)| record.get(*byte).is_some_and(|b| b & mask != 0);
        self.is_always || self.bits.iter().any(is_set)
    }
}

/// Type, type of data, synchronisation and place of a channel.
#[derive(Clone, Copy, Debug)]
pub(in crate::source) struct ChannelHead {
    pub kind: u8,
    pub sync: u8,
    pub field: Field,
}

impl ChannelHead {
    /// Reads the head of a channel with these data; `None` if they are too short.
    pub(in crate::source) fn read(data: &[u8]) -> Option<Self> {
        let [kind, sync, data_type, bit] = number(data, 0)?;
        Some(Self {
            kind,
            sync,
            field: Field {
                byte: u32_at(data, 4)? as usize,
                bit: u32::from(bit).min(7),
                bits: u32_at(data, 8)?,
                data_type,
            },
        })
    }
}
