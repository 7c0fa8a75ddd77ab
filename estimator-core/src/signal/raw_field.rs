//! A number in the payload of a frame, as a `.dbc` file places it: both byte orders, integers and
//! floating-point numbers.

/// The order of the bytes of a number, and what its start bit is. Bit 0 of a byte is its least
/// significant one, and bit 8 of a payload is bit 0 of its second byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ByteOrder {
    /// Least significant byte first; the start bit is the least significant bit (`@1`).
    Intel,
    /// Most significant byte first; the start bit is the most significant bit (`@0`).
    Motorola,
}

/// The kind of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NumberKind {
    /// An unsigned integer.
    Unsigned,
    /// A signed integer, two's complement.
    Signed,
    /// A floating-point number of 32 bits, IEEE 754.
    Float32,
    /// A floating-point number of 64 bits, IEEE 754.
    Float64,
}

/// A number as it is in a payload, before scale and offset.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RawNumber {
    /// An unsigned integer.
    Unsigned(u64),
    /// A signed integer.
    Signed(i64),
    /// A floating-point number; not finite if the sender has none.
    Real(f64),
}

impl RawNumber {
    /// Returns the nearest `f64`.
    #[must_use]
    pub const fn to_f64(self) -> f64 {
        match self {
            Self::Unsigned(number) => number as f64,
            Self::Signed(number) => number as f64,
            Self::Real(number) => number,
        }
    }

    /// Returns whether the number is `code`. The codes of unsigned numbers of 64 bits beyond
    /// `i64::MAX` are negative: -1 is all ones.
    #[must_use]
    pub fn is(self, code: i64) -> bool {
        match self {
            Self::Unsigned(number) => number == code as u64,
            Self::Signed(number) => number == code,
            Self::Real(number) => number == code as f64,
        }
    }
}

/// The place and kind of a number in a payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RawField {
    /// The bytes that hold it.
    first_byte: u16,
    bytes: u8,
    /// Bits of these bytes below the least significant bit of the number.
    unused_low: u8,
    bits: u8,
    order: ByteOrder,
    kind: NumberKind,
}

impl RawField {
    /// Creates a field as a `.dbc` file describes it: `start_bit|bits@order`. Returns `None` if the
    /// length is not 1 to 64 bits, or not that of the floating-point number.
    #[must_use]
    pub const fn new(start_bit: u16, bits: u8, order: ByteOrder, kind: NumberKind) -> Option<Self> {
        let fits = match kind {
            NumberKind::Float32 => bits == 32,
            NumberKind::Float64 => bits == 64,
            NumberKind::Unsigned | NumberKind::Signed => bits >= 1 && bits <= 64,
        };
        if !fits {
            return None;
        }
        let bit = (start_bit % 8) as u8;
        // Bits of the first byte that are not of the number: below it, or above it.
        let before = match order {
            ByteOrder::Intel => bit,
            ByteOrder::Motorola => 7 - bit,
        };
        let bytes = (before + bits).div_ceil(8);
        let unused_low = match order {
            ByteOrder::Intel => before,
            ByteOrder::Motorola => 8 * bytes - before - bits,
        };
        Some(Self {
            first_byte: start_bit / 8,
            bytes,
            unused_low,
            bits,
            order,
            kind,
        })
    }

    /// Returns the number of bytes that a payload has at least if it contains the field.
    #[must_use]
    pub const fn payload_bytes(&self) -> usize {
        self.first_byte as usize + self.bytes as usize
    }

    /// Returns the length, bits.
    #[must_use]
    pub const fn bits(&self) -> u8 {
        self.bits
    }

    /// Returns the kind of the number.
    #[must_use]
    pub const fn kind(&self) -> NumberKind {
        self.kind
    }

    /// Reads the number from `payload`; `None` if the payload ends before it.
    #[must_use]
    pub fn read(&self, payload: &[u8]) -> Option<RawNumber> {
        let bytes = payload.get(self.first_byte.into()..self.payload_bytes())?;
        let mut raw = 0_u64;
        for (k, byte) in bytes.iter().enumerate() {
            let place = match self.order {
                ByteOrder::Intel => k,
                ByteOrder::Motorola => bytes.len() - 1 - k,
            };
            // The place of the byte's lowest bit in the number: up to 63, for nine bytes have
            // unused bits.
            let up = 8 * place as u32;
            let down = u32::from(self.unused_low);
            let byte = u64::from(*byte);
            raw |= match up.checked_sub(down) {
                Some(up) => byte.checked_shl(up).unwrap_or(0),
                None => byte >> (down - up),
            };
        }
        let unused_high = 64 - u32::from(self.bits);
        let high = raw << unused_high;
        Some(match self.kind {
            NumberKind::Unsigned => RawNumber::Unsigned(high >> unused_high),
            NumberKind::Signed => RawNumber::Signed(high as i64 >> unused_high),
            NumberKind::Float32 => RawNumber::Real(f32::from_bits((high >> 32) as u32).into()),
            NumberKind::Float64 => RawNumber::Real(f64::from_bits(high)),
        })
    }
}
