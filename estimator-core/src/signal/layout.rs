//! The layout of the messages, and the decoding of their fields.

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
    /// An angle in 1e-7 degrees.
    DegreesE7(&'static AngleScaling),
}

/// Conversion of a raw number to 1e-7 degrees: `raw / divisor + offset`.
#[derive(Debug)]
pub(super) struct AngleScaling {
    pub divisor: Divisor,
    pub offset: i64,
}

/// One signal in one message.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field {
    pub signal: Signal,
    /// First byte, and first bit in it.
    pub first_byte: u8,
    pub shift: u8,
    /// Number of bits, negative for a signed number: in one byte, so that the table is small.
    width: i8,
    /// Smallest raw numbers of the codes "error" and "not available". The codes go up to the largest
    /// raw number, which for a signed field is half as large. Not used beyond four bytes.
    error_from: u32,
    not_available_from: u32,
    pub scaling: Scaling,
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
            width: if signed { -(bits as i8) } else { bits as i8 },
            error_from,
            not_available_from,
            scaling,
        }
    }

    pub(super) const fn bits(&self) -> u32 {
        self.width.unsigned_abs() as u32
    }

    pub(super) const fn is_signed(&self) -> bool {
        self.width < 0
    }
}

/// What is to be looked at before the fields of a message.
#[derive(Clone, Copy, Debug)]
pub(super) enum PayloadCheck {
    /// Nothing.
    None,
    /// The two bits from this one on, in which the sender judges its signals (J1939).
    Merit(u8),
    /// This byte, whose signal most senders leave out. The estimator reads it last.
    Optional(u8),
}

/// A payload of error codes (J1939).
const ERRORS: [u8; 8] = [0xfe; 8];

impl Message {
    /// Returns payload and fields to decode. Where the sender calls its signals degraded (01) or faulty
    /// (10), the payload is one of error codes. An optional field is left out where it is not in the
    /// payload or, if the estimator alone reads, not available.
    #[inline]
    pub(super) fn checked<'a>(
        &'static self,
        payload: &'a [u8],
        only_read: bool,
    ) -> (&'a [u8], &'static [Field]) {
        let fields = self.fields;
        match self.check {
            PayloadCheck::None => (payload, fields),
            PayloadCheck::Merit(bit) => match payload.get(usize::from(bit / 8)) {
                Some(byte) if matches!((byte >> (bit % 8)) & 3, 1 | 2) => (&ERRORS, fields),
                _ => (payload, fields),
            },
            PayloadCheck::Optional(byte) => match (payload.get(usize::from(byte)), fields) {
                (None, [others @ .., _]) => (payload, others),
                (Some(0xff), [others @ .., _]) if only_read => (payload, others),
                _ => (payload, fields),
            },
        }
    }
}

impl AngleScaling {
    /// Returns the angle of a raw number.
    #[inline(never)] // Of 64-bit numbers, and called from several places.
    fn degrees_e7(&self, number: i64) -> Value {
        let half = self.divisor.by() / 2;
        let angle = self.divisor.divide(number.unsigned_abs() + half) as i64;
        let angle = if number < 0 { -angle } else { angle };
        match i32::try_from(angle + self.offset) {
            Ok(angle) => Value::DegreesE7(angle),
            Err(_) => Value::Error,
        }
    }
}

/// One message: a parameter group with the fields that the estimator reads.
#[derive(Debug)]
pub(super) struct Message {
    pub pgn: u32,
    pub framing: Framing,
    /// End of the last field, bit.
    pub end_bit: u16,
    pub check: PayloadCheck,
    pub fields: &'static [Field],
}

/// What only tools need of a message, in a table of its own that a controller leaves out.
#[derive(Debug)]
pub(super) struct Description {
    pub name: &'static str,
    pub priority: u8,
    pub length: u8,
    pub convention: Convention,
    /// Fields that the estimator does not read.
    pub unread: &'static [Field],
}

include!(concat!(env!("OUT_DIR"), "/layout_tables.rs"));

/// Returns the index of a message. That behind the last one is for the frames of the transport
/// protocol: only what is no message has to look at it.
#[inline(never)] // Called from two places.
pub(super) fn index_of(pgn: u32) -> Option<usize> {
    let slot = pgn.wrapping_mul(MULTIPLIER) >> (u32::BITS - SLOT_BITS);
    let index = usize::from(*SLOTS.get(slot as usize)?);
    let is_known = match MESSAGES.get(index) {
        Some(message) => message.pgn == pgn,
        None => TRANSPORT_PGNS.contains(&pgn),
    };
    is_known.then_some(index)
}

impl Field {
    /// Reads the value from `payload`; `None` if the payload ends before the field.
    #[inline(always)] // In the one loop over fields.
    pub(super) fn read(&self, payload: &[u8]) -> Option<Value> {
        let rest = payload.get(usize::from(self.first_byte)..)?;
        if self.bits() > 32 {
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
        let unused = 32 - self.bits();
        let raw = (word >> self.shift) << unused >> unused;
        let number = ((raw << unused) as i32) >> unused;
        Some(if self.is_signed() && number < 0 {
            // All ones: no sender means a step below zero by what fills unused bytes.
            if number == -1 {
                return Some(Value::NotAvailable);
            }
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
        match number {
            i64::MAX | -1 => Value::NotAvailable,
            number if number >= i64::MAX - 2 => Value::Error,
            _ => self.physical(number as f32, || number),
        }
    }

    /// Returns the physical value of a raw number, given as the nearest `f32` and exactly.
    fn physical(&self, nearest: f32, exact: impl FnOnce() -> i64) -> Value {
        match self.scaling {
            Scaling::Real { scale, offset } => Value::Real(nearest * scale + offset),
            Scaling::DegreesE7(angle) => angle.degrees_e7(exact()),
        }
    }
}
