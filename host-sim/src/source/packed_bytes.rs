//! The packed bytes of a log, with a look ahead and a search for the next member.

use super::packing::Packing;
use memchr::memchr;
use std::io::{self, BufRead, ErrorKind, Read};

/// Bytes read at once.
const STEP_BYTES: usize = 1 << 16;
/// Bytes at the head of a member that are looked at. No member is shorter.
const HEAD_BYTES: usize = 9;
/// First bytes of a gzip member, with the only method there is.
const GZIP_START: &[u8] = &[0x1f, 0x8b, 8];
/// Flags of a gzip member that mean nothing (RFC 1952).
const GZIP_RESERVED: u8 = 0xe0;
/// First bytes of a Zstandard frame.
pub(super) const ZSTD_MAGIC: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];

/// Packed bytes that can be looked at before they are taken.
pub(super) struct PackedBytes<R> {
    inner: R,
    buffer: Vec<u8>,
    /// Bytes of the buffer that were taken.
    used: usize,
    taken: u64,
}

impl<R: Read> PackedBytes<R> {
    pub(super) const fn new(inner: R) -> Self {
        Self {
            inner,
            buffer: Vec::new(),
            used: 0,
            taken: 0,
        }
    }

    /// Returns the number of bytes taken.
    pub(super) const fn taken(&self) -> u64 {
        self.taken
    }

    /// Returns the bytes that come next: at least so many, or all that are left.
    fn ahead(&mut self, count: usize) -> io::Result<&[u8]> {
        if self.buffer.len() - self.used < count {
            self.buffer.drain(..self.used);
            self.used = 0;
        }
        while self.buffer.len() - self.used < count {
            let before = self.buffer.len();
            self.buffer.resize(before + STEP_BYTES, 0);
            let read = self
                .inner
                .read(self.buffer.get_mut(before..).unwrap_or_default());
            self.buffer.truncate(before + *read.as_ref().unwrap_or(&0));
            match read {
                Ok(0) => break,
                Ok(_) => {}
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => return Err(e),
            }
        }
        Ok(self.buffer.get(self.used..).unwrap_or_default())
    }

    /// Returns true if a member begins here; `None` at the end.
    pub(super) fn is_start(&mut self, packing: Packing) -> io::Result<Option<bool>> {
        let head = self.ahead(HEAD_BYTES)?;
        Ok((!head.is_empty()).then(|| is_start(packing, head)))
    }

    /// Skips the skippable frames of Zstandard that come next.
    pub(super) fn skip_skippable(&mut self) -> io::Result<()> {
        loop {
            let head = self.ahead(8)?;
            if !is_skippable(head) {
                return Ok(());
            }
            let length = head.get(4..).and_then(|rest| rest.first_chunk());
            let mut left = 8 + length.map_or(0, |length| u64::from(u32::from_le_bytes(*length)));
            while left > 0 {
                let count = self.ahead(1)?.len();
                if count == 0 {
                    return Ok(());
                }
                let skipped = left.min(count as u64);
                self.consume(skipped as usize);
                left -= skipped;
            }
        }
    }

    /// Goes to the next place where a member may begin, or to the end. Returns the number of bytes
    /// left out, and whether there is such a place.
    pub(super) fn skip_to_start(&mut self, packing: Packing) -> io::Result<(u64, bool)> {
        let mut lost = 0;
        loop {
            let bytes = self.ahead(HEAD_BYTES)?;
            let is_end = bytes.len() < HEAD_BYTES;
            let last = if is_end {
                bytes.len()
            } else {
                bytes.len() - HEAD_BYTES + 1
            };
            let first = first_byte(packing);
            let mut at = 0;
            let found = loop {
                let rest = bytes.get(at..last).unwrap_or_default();
                let Some(next) = memchr(first, rest) else {
                    break None;
                };
                at += next;
                if !is_end && is_start(packing, bytes.get(at..).unwrap_or_default()) {
                    break Some(at);
                }
                at += 1;
            };
            let skipped = found.unwrap_or(last);
            self.consume(skipped);
            lost += skipped as u64;
            if found.is_some() || is_end {
                return Ok((lost, found.is_some()));
            }
        }
    }
}

impl<R: Read> Read for PackedBytes<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let bytes = self.ahead(1)?;
        let count = bytes.len().min(buffer.len());
        for (to, from) in buffer.iter_mut().zip(bytes) {
            *to = *from;
        }
        self.consume(count);
        Ok(count)
    }
}

impl<R: Read> BufRead for PackedBytes<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.ahead(1)
    }

    fn consume(&mut self, count: usize) {
        self.used = (self.used + count).min(self.buffer.len());
        self.taken += count as u64;
    }
}

const fn first_byte(packing: Packing) -> u8 {
    match packing {
        Packing::Zstd => 0x28,
        Packing::Gzip | Packing::Plain => 0x1f,
    }
}

/// Returns true for the head of a skippable frame of Zstandard, which has no content of the log.
pub(super) fn is_skippable(head: &[u8]) -> bool {
    matches!(head, [0x50..=0x5f, 0x2a, 0x4d, 0x18, ..])
}

fn is_start(packing: Packing, head: &[u8]) -> bool {
    match packing {
        Packing::Plain => false,
        Packing::Zstd => head.starts_with(ZSTD_MAGIC) || is_skippable(head),
        // The level is one of three numbers.
        Packing::Gzip => {
            head.starts_with(GZIP_START)
                && head.get(3).is_some_and(|flags| flags & GZIP_RESERVED == 0)
                && head.get(8).is_none_or(|level| matches!(level, 0 | 2 | 4))
        }
    }
}
