//! The messages that the decoder knows, for tools: their names, and the encoding of their fields.

use super::layout::{
    Convention, DESCRIPTIONS, Description, Field, Framing, MESSAGES, Message, Scaling, index_of,
};
use super::reading::{Signal, Value};

/// A message that the decoder knows.
#[derive(Clone, Copy, Debug)]
pub struct MessageInfo {
    message: &'static Message,
    description: &'static Description,
}

impl MessageInfo {
    /// Returns the parameter group number.
    #[must_use]
    pub const fn pgn(self) -> u32 {
        self.message.pgn
    }

    /// Returns the acronym.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.description.name
    }

    /// Returns the default priority.
    #[must_use]
    pub const fn priority(self) -> u8 {
        self.description.priority
    }

    /// Returns the length of the payload, bytes. Above 8 it takes several frames ([`Self::framing`]).
    #[must_use]
    pub const fn length(self) -> usize {
        self.description.length as usize
    }

    /// Returns how frames carry it.
    #[must_use]
    pub const fn framing(self) -> Framing {
        self.message.framing
    }

    /// Returns its signals.
    pub fn signals(self) -> impl Iterator<Item = Signal> {
        self.fields().map(|field| field.signal)
    }

    fn fields(self) -> impl Iterator<Item = &'static Field> {
        self.message.fields.iter().chain(self.description.unread)
    }
}

/// Returns every message that the decoder knows, by ascending PGN.
pub fn messages() -> impl Iterator<Item = MessageInfo> {
    let pairs = MESSAGES.iter().zip(&DESCRIPTIONS);
    pairs.map(|(message, description)| MessageInfo {
        message,
        description,
    })
}

impl Field {
    const fn mask(&self) -> u64 {
        u64::MAX >> (64 - self.bits())
    }

    /// Writes `value` into `payload`, as the nearest raw number that is a measurement.
    fn write(&self, convention: Convention, value: Value, payload: &mut [u8]) {
        let mask = self.mask();
        let raw = match (value, self.scaling) {
            (Value::Real(value), Scaling::Real { scale, offset }) => {
                let raw = (f64::from(value) - f64::from(offset)) / f64::from(scale);
                self.clamp(convention, libm::round(raw) as i64)
            }
            (Value::DegreesE7(angle), Scaling::DegreesE7(scaling)) => self.clamp(
                convention,
                (i64::from(angle) - scaling.offset) * scaling.divisor.by() as i64,
            ),
            (Value::Error, _) if self.bits() == 2 => 2,
            (Value::Error, _) if convention == Convention::J1939 && self.bits() >= 8 => {
                0xfe << (self.bits() - 8)
            }
            (Value::Error, _) if self.is_signed() => (mask >> 1) - 1,
            (Value::Error, _) => mask - 1,
            // Not available, or of another kind than the field.
            _ if convention == Convention::Nmea2000 && self.is_signed() => mask >> 1,
            _ => mask,
        };
        let first = usize::from(self.first_byte);
        let shift = u32::from(self.shift);
        let bytes = (self.bits() + shift).div_ceil(8) as usize;
        for (k, byte) in payload.iter_mut().skip(first).take(bytes).enumerate() {
            let place = 8 * k as u32;
            let keep = !((mask << shift) >> place) as u8;
            *byte = (*byte & keep) | ((raw & mask) << shift >> place) as u8;
        }
    }

    /// Limits a raw number to the range of measurements.
    fn clamp(&self, convention: Convention, raw: i64) -> u64 {
        let mask = self.mask();
        let (low, high) = match (convention, self.bits(), self.is_signed()) {
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
    let message = messages().nth(index_of(pgn)?)?;
    let payload = payload.get_mut(..message.length())?;
    payload.fill(0xff);
    for field in message.fields() {
        let value = value_of(field.signal);
        field.write(message.description.convention, value, payload);
    }
    Some(payload.len())
}
