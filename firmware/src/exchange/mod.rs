//! The files that an emulated board and a host exchange.
//!
//! Both are sequences of 32-bit words, little endian, in records of fixed length. A float is the
//! word of its bits, so that results can be compared bit for bit; a 64-bit number is two words,
//! the lower half first.
//!
//! | `drive.bin`          | words | content                                                     |
//! |----------------------|-------|-------------------------------------------------------------|
//! | header, once         | 252   | see [`vehicle`]                                             |
//! | record, one a frame  | 6     | time in µs (2), identifier, length, data (2); see [`frame`] |
//!
//! | `cells.bin`          | words | content                                                     |
//! |----------------------|-------|-------------------------------------------------------------|
//! | record, one a cell   | 13    | see [`cell`]                                                |
//!
//! | `on_map.bin`, with a map in flash | words | content                                        |
//! |----------------------|-------|-------------------------------------------------------------|
//! | record, one a step   | 14    | see [`on_map`]                                              |
//!
//! Decoding refuses records of another length, and content that encoding never writes.

pub mod cell;
pub mod frame;
pub mod on_map;
pub mod vehicle;

use core::ffi::CStr;

/// File in QEMU's working folder that the host writes: a vehicle, and the frames of a drive.
pub const DRIVE_FILE: &CStr = c"drive.bin";
/// File in QEMU's working folder that the board writes: the finished cells.
pub const CELLS_FILE: &CStr = c"cells.bin";
/// File in QEMU's working folder that the board writes: the map's part of each step.
pub const ON_MAP_FILE: &CStr = c"on_map.bin";

const WORD: usize = size_of::<u32>();

/// Returns the words as a record of `BYTES` bytes.
fn to_bytes<const BYTES: usize>(words: impl IntoIterator<Item = u32>) -> [u8; BYTES] {
    let mut bytes = [0; BYTES];
    let (places, _) = bytes.as_chunks_mut::<WORD>();
    for (place, word) in places.iter_mut().zip(words) {
        *place = word.to_le_bytes();
    }
    bytes
}

/// Returns the words of a record; `None` if its length is not `bytes`.
fn to_words(record: &[u8], bytes: usize) -> Option<impl Iterator<Item = u32> + '_> {
    let (words, _) = record.as_chunks::<WORD>();
    (record.len() == bytes).then(|| words.iter().map(|word| u32::from_le_bytes(*word)))
}

const fn halves(number: u64) -> [u32; 2] {
    [number as u32, (number >> 32) as u32]
}

/// Reads a 64-bit number from the next two words.
fn next_u64(words: &mut impl Iterator<Item = u32>) -> Option<u64> {
    let low = u64::from(words.next()?);
    Some(low | u64::from(words.next()?) << 32)
}

/// Reads a float from the next word.
fn next_f32(words: &mut impl Iterator<Item = u32>) -> Option<f32> {
    words.next().map(f32::from_bits)
}
