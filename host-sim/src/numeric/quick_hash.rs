//! A map with small keys, quicker than that of the standard library: one multiplication for a key. Keys
//! are chosen by a file, and a file that is made to be slow is one that its owner need not read.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A map of numbers.
pub type QuickMap<T> = HashMap<u64, T, BuildHasherDefault<QuickHasher>>;

/// Multiplies by the golden ratio (Knuth, The Art of Computer Programming 3, 6.4), and folds.
#[derive(Clone, Copy, Debug, Default)]
pub struct QuickHasher(u64);

impl Hasher for QuickHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    fn write_u64(&mut self, number: u64) {
        let product = (self.0 ^ number).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = product ^ product >> 32;
    }
}
