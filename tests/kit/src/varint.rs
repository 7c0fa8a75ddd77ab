//! Numbers of seven bits a byte, the lowest first, as postcard and Protocol Buffers write them.

/// Appends a number.
pub fn unsigned(bytes: &mut Vec<u8>, number: impl Into<u64>) {
    let mut number = number.into();
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

/// Appends a number that may be negative.
pub fn signed(bytes: &mut Vec<u8>, number: impl Into<i64>) {
    unsigned(bytes, zigzag(number.into()));
}

/// Returns a number with its sign in the lowest bit.
#[must_use]
pub const fn zigzag(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)) as u64
}
