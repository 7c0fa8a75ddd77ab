//! The checksum of a store: the 128-bit XXH3 of all that follows its first line, which has it.

use std::io::{self, BufRead, Write};
use xxhash_rust::xxh3::Xxh3;

/// A writer that only computes the checksum of what it is given.
#[derive(Default)]
pub(super) struct Checksum(Xxh3);

impl Checksum {
    /// Computes the checksum of the rest of a file.
    pub(super) fn of(mut rest: impl BufRead) -> io::Result<String> {
        let mut sum = Self::default();
        io::copy(&mut rest, &mut sum)?;
        Ok(sum.text())
    }

    /// Returns the checksum as 32 hexadecimal digits.
    pub(super) fn text(&self) -> String {
        format!("{:032x}", self.0.digest128())
    }
}

impl Write for Checksum {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
