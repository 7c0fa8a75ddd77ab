//! The bytes of a binary log, with a way back after damage.

use crate::error::Result;
use crate::source::log_file::LogFile;
use memchr::memmem;
use std::io::{BufReader, Read};

/// Bytes read at once in search of the next object.
const STEP_BYTES: u64 = 4096;

/// Returns the number at a place of some bytes, if it is inside.
pub(super) fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

pub(super) fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    number(bytes, at).map(u16::from_le_bytes)
}

pub(super) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    number(bytes, at).map(u32::from_le_bytes)
}

/// Bytes that are left out behind damage.
pub(super) struct LeftOut {
    pub bytes: u64,
    /// True if they are all bytes up to the end of the file.
    pub is_rest: bool,
}

/// The file, from which bytes are taken.
pub(super) struct ByteFile {
    file: BufReader<LogFile>,
    /// Bytes that were given back, of which `used` were taken again.
    given_back: Vec<u8>,
    used: usize,
    /// Bytes that were taken.
    offset: u64,
}

impl ByteFile {
    pub(super) fn new(file: LogFile) -> Self {
        Self {
            file: BufReader::with_capacity(1 << 16, file),
            given_back: Vec::new(),
            used: 0,
            offset: 0,
        }
    }

    pub(super) fn log(&self) -> &LogFile {
        self.file.get_ref()
    }

    /// Returns the number of bytes taken.
    pub(super) const fn offset(&self) -> u64 {
        self.offset
    }

    /// Takes so many bytes; returns false if the file ends before.
    pub(super) fn take(&mut self, bytes: &mut Vec<u8>, count: u64) -> Result<bool> {
        bytes.clear();
        self.take_more(bytes, count)
    }

    /// Takes so many bytes to the end of others; returns false if the file ends before.
    pub(super) fn take_more(&mut self, bytes: &mut Vec<u8>, count: u64) -> Result<bool> {
        let before = bytes.len();
        let mut rest = self.given_back.get(self.used..).unwrap_or_default();
        let wanted = usize::try_from(count).unwrap_or(usize::MAX);
        rest = rest.get(..wanted).unwrap_or(rest);
        bytes.extend_from_slice(rest);
        self.used += rest.len();
        let left = count - rest.len() as u64;
        let read = self.file.by_ref().take(left).read_to_end(bytes);
        self.offset += (bytes.len() - before) as u64;
        match read {
            Ok(read) => Ok(read as u64 == left),
            Err(e) => Err(self.log().read_error_at(self.offset, e)),
        }
    }

    /// Gives back the last bytes that were taken.
    pub(super) fn give_back(&mut self, bytes: &[u8]) {
        let rest = self
            .given_back
            .split_off(self.used.min(self.given_back.len()));
        self.given_back = [bytes, &rest].concat();
        self.used = 0;
        self.offset = self.offset.saturating_sub(bytes.len() as u64);
    }

    /// Skips to the next place with these letters, behind the first of the bytes taken last. Returns
    /// the number of bytes that are left out.
    pub(super) fn skip_to(&mut self, bytes: &mut Vec<u8>, letters: &[u8]) -> Result<u64> {
        // The letters may begin at the end of what was read.
        let find = |bytes: &[u8], _| memmem::find(bytes, letters);
        let left_out = self.skip_until(bytes, letters.len() - 1, find)?;
        Ok(left_out.bytes)
    }

    /// Skips to the place that `find` finds behind the first of the bytes taken last, or to the end.
    /// `find` gets bytes, and true if the file has no more. What it finds within `reach` bytes from their
    /// end, it may find only with more of them.
    pub(super) fn skip_until(
        &mut self,
        bytes: &mut Vec<u8>,
        reach: usize,
        find: impl Fn(&[u8], bool) -> Option<usize>,
    ) -> Result<LeftOut> {
        let mut lost = 1;
        let mut is_over = false;
        bytes.drain(..1.min(bytes.len()));
        loop {
            if let Some(at) = find(bytes, is_over) {
                self.give_back(bytes.get(at..).unwrap_or_default());
                return Ok(LeftOut {
                    bytes: lost + at as u64,
                    is_rest: false,
                });
            }
            let kept = bytes.len().min(reach);
            if is_over {
                return Ok(LeftOut {
                    bytes: lost + bytes.len() as u64,
                    is_rest: true,
                });
            }
            lost += (bytes.len() - kept) as u64;
            bytes.drain(..bytes.len() - kept);
            self.take_more(bytes, STEP_BYTES)?;
            is_over = bytes.len() == kept;
        }
    }
}
