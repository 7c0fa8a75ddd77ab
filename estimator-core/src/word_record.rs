//! Records of fixed length in 32-bit words, little endian: what boards store and exchange.
//!
//! A float is the word of its bits, so that results can be compared bit for bit. A 64-bit number is
//! two words, the lower half first.

const WORD: usize = size_of::<u32>();

/// Returns the words as a record of `BYTES` bytes. What is missing is zero, what is too much is left out.
#[must_use]
pub fn to_bytes<const BYTES: usize>(words: impl IntoIterator<Item = u32>) -> [u8; BYTES] {
    let mut bytes = [0; BYTES];
    let (places, _) = bytes.as_chunks_mut::<WORD>();
    for (place, word) in places.iter_mut().zip(words) {
        *place = word.to_le_bytes();
    }
    bytes
}

/// Returns the words of a record; `None` if its length is not `bytes`.
#[must_use]
pub fn to_words(record: &[u8], bytes: usize) -> Option<impl Iterator<Item = u32> + '_> {
    let (words, _) = record.as_chunks::<WORD>();
    (record.len() == bytes).then(|| words.iter().map(|word| u32::from_le_bytes(*word)))
}

/// Returns the lower and the upper half of a number.
#[must_use]
pub const fn halves(number: u64) -> [u32; 2] {
    [number as u32, (number >> 32) as u32]
}

/// Reads a 64-bit number from the next two words; `None` at the end.
pub fn next_u64(words: &mut impl Iterator<Item = u32>) -> Option<u64> {
    let low = u64::from(words.next()?);
    Some(low | u64::from(words.next()?) << 32)
}

/// Reads a float from the next word; `None` at the end.
pub fn next_f32(words: &mut impl Iterator<Item = u32>) -> Option<f32> {
    words.next().map(f32::from_bits)
}
