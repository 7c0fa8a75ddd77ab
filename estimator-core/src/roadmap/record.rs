//! Records of a packed map: bytes that end with their checksum, and numbers in them.

use super::map_error::MapError;
use crc::{CRC_32_ISO_HDLC, Crc};
use serde::Deserialize;

/// Bytes of a checksum.
const CHECKSUM_BYTES: usize = 4;
/// With a table of 1 kB: a page of the index is checked within one cell.
static CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Returns the CRC-32 (ISO-HDLC) with which a record of these bytes ends.
#[inline(never)] // Each kind of record checks one.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u32 {
    CHECKSUM.checksum(bytes)
}

/// Returns the content of the record of `length` bytes, checksum included, at an offset.
pub(super) fn record(bytes: &[u8], offset: u32, length: usize) -> Result<&[u8], MapError> {
    let start = usize::try_from(offset).map_err(|_| MapError::Content)?;
    let rest = bytes.get(start..).ok_or(MapError::CutOff)?;
    let record = rest.get(..length).ok_or(MapError::CutOff)?;
    let (content, written) = record
        .split_last_chunk::<CHECKSUM_BYTES>()
        .ok_or(MapError::Content)?;
    if checksum(content) == u32::from_le_bytes(*written) {
        Ok(content)
    } else {
        Err(MapError::Checksum)
    }
}

/// Returns the content of the record at an offset whose first two bytes are its length.
pub(super) fn sized_record(bytes: &[u8], offset: u32) -> Result<&[u8], MapError> {
    let start = usize::try_from(offset).map_err(|_| MapError::Content)?;
    let rest = bytes.get(start..).ok_or(MapError::CutOff)?;
    let length = rest.first_chunk::<2>().ok_or(MapError::CutOff)?;
    record(bytes, offset, u16::from_le_bytes(*length).into())
}

/// Returns the content of the record at the start of these bytes, without a check of its checksum.
pub(super) fn sized_content(bytes: &[u8]) -> Result<&[u8], MapError> {
    let length = bytes.first_chunk::<2>().ok_or(MapError::CutOff)?;
    let record = bytes.get(..u16::from_le_bytes(*length).into());
    let content = record.and_then(|record| record.split_last_chunk::<CHECKSUM_BYTES>());
    content.map(|(content, _)| content).ok_or(MapError::CutOff)
}

/// Returns the checksum of bytes with these behind them. That of no bytes is 0.
pub(super) fn checksum_after(sum: u32, bytes: &[u8]) -> u32 {
    // The register is the inverted checksum; the digest takes it in the order of the polynomial's bits.
    let mut digest = CHECKSUM.digest_with_initial((!sum).reverse_bits());
    digest.update(bytes);
    digest.finalize()
}

/// Reads numbers from the content of a record, one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers<'m>(pub(super) &'m [u8]);

impl<'m> Numbers<'m> {
    /// Returns the numbers from this byte of the content on.
    pub(super) fn from(content: &'m [u8], at: usize) -> Result<Self, MapError> {
        content.get(at..).map(Self).ok_or(MapError::Content)
    }

    /// Takes the next `N` bytes.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], MapError> {
        let (first, rest) = self.0.split_first_chunk().ok_or(MapError::Content)?;
        self.0 = rest;
        Ok(*first)
    }

    pub(super) fn u8(&mut self) -> Result<u8, MapError> {
        self.take().map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Result<u16, MapError> {
        self.take().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, MapError> {
        self.take().map(u32::from_le_bytes)
    }

    pub(super) fn i32(&mut self) -> Result<i32, MapError> {
        self.take().map(i32::from_le_bytes)
    }

    /// Takes the next `count` bytes.
    pub(super) fn bytes(&mut self, count: usize) -> Result<&'m [u8], MapError> {
        let (first, rest) = self.0.split_at_checked(count).ok_or(MapError::Content)?;
        self.0 = rest;
        Ok(first)
    }

    /// Returns the last `count` bytes.
    pub(super) fn last(&self, count: u16) -> Option<Self> {
        let start = self.0.len().checked_sub(count.into())?;
        self.0.get(start..).map(Self)
    }

    /// Takes the next number of postcard's form.
    pub(super) fn varint<T: Deserialize<'m>>(&mut self) -> Result<T, MapError> {
        let (value, rest) = postcard::take_from_bytes(self.0).map_err(|_| MapError::Content)?;
        self.0 = rest;
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::{checksum, checksum_after};

    #[test]
    fn a_checksum_in_shares_is_that_of_all_bytes() {
        let bytes: [u8; 64] = core::array::from_fn(|i| (i * 37) as u8);
        for cut in 0..=bytes.len() {
            let (first, rest) = bytes.split_at(cut);
            let sum = checksum_after(checksum_after(0, first), rest);
            assert_eq!(sum, checksum(&bytes), "cut at {cut}");
        }
    }
}
