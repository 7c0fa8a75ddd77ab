//! The layout of the messages: decoding and encoding of their fields.

use super::reading::{Signal, Value};
use crate::division::Divisor;

/// The convention of the codes for "not available" and "error".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Convention {
    /// SAE J1939-71: the top of the raw range, a byte's worth at the head of the field.
    J1939,
    /// NMEA 2000: the three largest raw values; the largest is "not available".
    Nmea2000,
}

/// How frames carry a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framing {
    /// In one frame.
    Single,
    /// In a fast packet (NMEA 2000).
    FastPacket,
    /// In a session of the transport protocol (SAE J1939-21).
    Transport,
}

/// Conversion of a raw number to a physical value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Scaling {
    /// `raw * scale + offset`.
    Real { scale: f32, offset: f32 },
    /// `raw / divisor + offset`, in 1e-7 degrees.
    DegreesE7 {
        divisor: &'static Divisor,
        offset: i64,
    },
}

/// One signal in one message.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field {
    pub signal: Signal,
    /// First byte, and first bit in it.
    first_byte: u8,
    shift: u8,
    bits: u8,
    signed: bool,
    /// Smallest raw numbers of the codes "error" and "not available". The codes go up to the largest
    /// raw number, which for a signed field is half as large. Not used beyond four bytes.
    error_from: u32,
    not_available_from: u32,
    scaling: Scaling,
}

impl Field {
    const fn new(
        convention: Convention,
        signal: Signal,
        start_bit: u16,
        bits: u8,
        signed: bool,
        scaling: Scaling,
    ) -> Self {
        let largest = (u64::MAX >> (64 - bits)) as u32 >> signed as u32;
        let (error_from, not_available_from) = match convention {
            // Two bits: 10 error, 11 not available; the measurement is 00 or 01. Up to a byte
            // likewise.
            _ if bits < 8 => (largest - 1, largest),
            // By the head byte: FF not available, FE error, FB to FD reserved.
            Convention::J1939 => (0xfb << (bits - 8), 0xff << (bits - 8)),
            Convention::Nmea2000 => (largest - 2, largest),
        };
        Self {
            signal,
            first_byte: (start_bit / 8) as u8,
            shift: (start_bit % 8) as u8,
            bits,
            signed,
            error_from,
            not_available_from,
            scaling,
        }
    }
}

/// One message: a parameter group with the fields of interest.
#[derive(Debug)]
pub(super) struct Message {
    pub pgn: u32,
    pub name: &'static str,
    pub priority: u8,
    pub length: u8,
    pub framing: Framing,
    /// End of the last field, bit.
    pub end_bit: u16,
    /// First of the two bits in which the sender judges its signals (J1939); 0 where it does not.
    pub merit_bit: u8,
    pub convention: Convention,
    pub fields: &'static [Field],
    /// Number of fields that the estimator reads: the first ones. The others are for tools.
    pub read: usize,
}

include!(concat!(env!("OUT_DIR"), "/layout_tables.rs"));

impl Message {
    /// Returns whether the sender says that its signals are degraded (01) or faulty (10).
    #[inline]
    pub(super) fn is_poor(&self, payload: &[u8]) -> bool {
        self.merit_bit != 0 && {
            let byte = payload.get(usize::from(self.merit_bit / 8));
            byte.is_some_and(|byte| matches!((byte >> (self.merit_bit % 8)) & 3, 1 | 2))
        }
    }
}

/// A message that the decoder knows.
#[derive(Clone, Copy, Debug)]
pub struct MessageInfo(&'static Message);

impl MessageInfo {
    /// Returns the parameter group number.
    #[must_use]
    pub const fn pgn(self) -> u32 {
        self.0.pgn
    }

    /// Returns the acronym.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.0.name
    }

    /// Returns the default priority.
    #[must_use]
    pub const fn priority(self) -> u8 {
        self.0.priority
    }

    /// Returns the length of the payload, bytes. Above 8 it takes several frames ([`Self::framing`]).
    #[must_use]
    pub const fn length(self) -> usize {
        self.0.length as usize
    }

    /// Returns how frames carry it.
    #[must_use]
    pub const fn framing(self) -> Framing {
        self.0.framing
    }

    /// Returns its signals.
    pub fn signals(self) -> impl Iterator<Item = Signal> {
        self.0.fields.iter().map(|field| field.signal)
    }
}

/// Returns every message that the decoder knows, by ascending PGN.
pub fn messages() -> impl Iterator<Item = MessageInfo> {
    MESSAGES.iter().map(MessageInfo)
}

impl Field {
    /// Reads the value from `payload`; `None` if the payload ends before the field.
    #[inline(always)] // In the one loop over fields.
    pub(super) fn read(&self, payload: &[u8]) -> Option<Value> {
        let rest = payload.get(usize::from(self.first_byte)..)?;
        if self.bits > 32 {
            return rest
                .first_chunk()
                .map(|bytes| self.wide(i64::from_le_bytes(*bytes)));
        }
        // In words of four bytes, as a controller has them.
        let word = match rest.first_chunk() {
            Some(bytes) => u32::from_le_bytes(*bytes),
            None => rest
                .iter()
                .rev()
                .fold(0, |word, byte| (word << 8) | u32::from(*byte)),
        };
        let unused = 32 - u32::from(self.bits);
        let raw = (word >> self.shift) << unused >> unused;
        let number = ((raw << unused) as i32) >> unused;
        Some(if self.signed && number < 0 {
            self.physical(number as f32, || number.into())
        } else if raw < self.error_from {
            self.physical(raw as f32, || raw.into())
        } else if raw < self.not_available_from {
            Value::Error
        } else {
            Value::NotAvailable
        })
    }

    /// Returns the value of eight bytes. Only NMEA 2000 has such fields, and they are signed.
    fn wide(&self, number: i64) -> Value {
        match i64::MAX - number.max(0) {
            0 => Value::NotAvailable,
            1 | 2 => Value::Error,
            _ => self.physical(number as f32, || number),
        }
    }

    /// Returns the physical value of a raw number, given as the nearest `f32` and exactly.
    fn physical(&self, nearest: f32, exact: impl FnOnce() -> i64) -> Value {
        match self.scaling {
            Scaling::Real { scale, offset } => Value::Real(nearest * scale + offset),
            Scaling::DegreesE7 { divisor, offset } => {
                let number = exact();
                let half = divisor.by() / 2;
                let angle = divisor.divide(number.unsigned_abs() + half) as i64;
                let angle = if number < 0 { -angle } else { angle };
                match i32::try_from(angle + offset) {
                    Ok(angle) => Value::DegreesE7(angle),
                    Err(_) => Value::Error,
                }
            }
        }
    }

    const fn mask(&self) -> u64 {
        u64::MAX >> (64 - self.bits as u32)
    }

    /// Writes `value` into `payload`, as the nearest raw number that is a measurement.
    fn write(&self, convention: Convention, value: Value, payload: &mut [u8]) {
        let mask = self.mask();
        let raw = match value {
            Value::Real(value) => match self.scaling {
                Scaling::Real { scale, offset } => {
                    let raw = (f64::from(value) - f64::from(offset)) / f64::from(scale);
                    self.clamp(convention, libm::round(raw) as i64)
                }
                Scaling::DegreesE7 { .. } => mask,
            },
            Value::DegreesE7(angle) => match self.scaling {
                Scaling::DegreesE7 { divisor, offset } => self.clamp(
                    convention,
                    (i64::from(angle) - offset) * divisor.by() as i64,
                ),
                Scaling::Real { .. } => mask,
            },
            Value::NotAvailable if convention == Convention::Nmea2000 && self.signed => mask >> 1,
            Value::NotAvailable => mask,
            Value::Error if self.bits == 2 => 2,
            Value::Error if convention == Convention::J1939 && self.bits >= 8 => {
                0xfe << (self.bits - 8)
            }
            Value::Error if self.signed => (mask >> 1) - 1,
            Value::Error => mask - 1,
        };
        let first = usize::from(self.first_byte);
        let shift = u32::from(self.shift);
        let bytes = (usize::from(self.bits) + shift as usize).div_ceil(8);
        for (k, byte) in payload.iter_mut().skip(first).take(bytes).enumerate() {
            let place = 8 * k as u32;
            let keep = !((mask << shift) >> place) as u8;
            *byte = (*byte & keep) | ((raw & mask) << shift >> place) as u8;
        }
    }

    /// Limits a raw number to the range of measurements.
    fn clamp(&self, convention: Convention, raw: i64) -> u64 {
        let mask = self.mask();
        let (low, high) = match (convention, self.bits, self.signed) {
            (_, _, true) => (-((mask >> 1) as i64), (mask >> 1) as i64 - 3),
            (Convention::J1939, 2, _) => (0, 1),
            (_, bits, _) if bits < 8 => (0, mask as i64 - 2),
            (Convention::J1939, bits, _) => (0, ((0xfb_u64 << (bits - 8)) - 1) as i64),
            (Convention::Nmea2000, ..) => (0, mask as i64 - 3),
        };
        raw.clamp(low, high) as u64 & mask
    }
}

/// Writes the payload of a message: the inverse of the decoder, for simulators and tests.
///
/// `value_of` returns the value of each signal. Fields without a signal are "not available" (all
/// ones). Returns the payload's length in bytes, or `None` if the PGN is unknown or `payload` is too
/// short. The caller splits messages of more than 8 bytes into packets.
pub fn encode(
    pgn: u32,
    payload: &mut [u8],
    mut value_of: impl FnMut(Signal) -> Value,
) -> Option<usize> {
    let message = MESSAGES.get(index_of(pgn)?)?;
    let payload = payload.get_mut(..usize::from(message.length))?;
    payload.fill(0xff);
    for field in message.fields {
        field.write(message.convention, value_of(field.signal), payload);
    }
    Some(payload.len())
}
