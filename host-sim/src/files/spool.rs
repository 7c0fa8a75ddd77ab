//! Storage for entries until a run is over: in memory while they are few, then in a temporary file
//! (in `TMPDIR`, else in the system's folder). The file is unlinked, so it disappears with the
//! process.

use crate::error::Error;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::marker::PhantomData;
use std::ops::Range;
use tempfile::SpooledTempFile;

/// Number of bytes that stay in memory.
const MEMORY_BYTES: usize = 256 * 1024;
/// Number of entries that are written or read at once.
const BLOCK: usize = 512;

/// Splits a range into blocks that are small enough for memory.
pub fn blocks(part: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let end = part.end;
    part.step_by(BLOCK)
        .map(move |begin| begin..end.min(begin + BLOCK))
}

/// Returns the error for a temporary file that cannot be written or read back.
pub fn no_room(error: io::Error) -> Error {
    Error::io(&tempfile::env::temp_dir())(error)
}

/// Entries of at most `SLOT` bytes in postcard's encoding. Each takes a slot of this size, so that
/// entries are found by number.
#[derive(Debug)]
pub struct Spool<T, const SLOT: usize> {
    file: SpooledTempFile,
    /// Number of entries in the file.
    filed: usize,
    /// The last entries, which are not yet in the file.
    waiting: Vec<u8>,
    entries: PhantomData<T>,
}

impl<T, const SLOT: usize> Default for Spool<T, SLOT> {
    fn default() -> Self {
        Self {
            file: SpooledTempFile::new(MEMORY_BYTES),
            filed: 0,
            waiting: Vec::new(),
            entries: PhantomData,
        }
    }
}

impl<T, const SLOT: usize> Spool<T, SLOT> {
    /// Returns the number of entries, the last stored number plus one.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.filed + self.waiting.len() / SLOT
    }

    fn file_waiting(&mut self) -> io::Result<()> {
        let waiting = std::mem::take(&mut self.waiting);
        let written = self.write(self.filed, &waiting);
        self.waiting = waiting;
        if written.is_ok() {
            self.waiting.clear();
        }
        written
    }

    fn write(&mut self, first: usize, slots: &[u8]) -> io::Result<()> {
        if slots.is_empty() {
            return Ok(());
        }
        self.seek(first)?;
        self.file.write_all(slots)?;
        self.filed = self.filed.max(first + slots.len() / SLOT);
        Ok(())
    }

    fn seek(&mut self, entry: usize) -> io::Result<()> {
        let at = entry as u64 * SLOT as u64;
        self.file.seek(SeekFrom::Start(at)).map(drop)
    }
}

impl<T: Serialize, const SLOT: usize> Spool<T, SLOT> {
    /// Appends an entry.
    ///
    /// # Errors
    /// Returns the error of the file system, or an error if the entry does not fit its slot.
    pub fn push(&mut self, entry: &T) -> io::Result<()> {
        encode::<T, SLOT>(entry, &mut self.waiting)?;
        if self.waiting.len() < BLOCK * SLOT {
            return Ok(());
        }
        self.file_waiting()
    }

    /// Stores entries at their numbers, in any order.
    ///
    /// # Errors
    /// Returns the errors of [`push`](Self::push).
    pub fn put(&mut self, first: usize, entries: impl Iterator<Item = T>) -> io::Result<()> {
        self.file_waiting()?;
        let mut slots = Vec::new();
        for entry in entries {
            encode::<T, SLOT>(&entry, &mut slots)?;
        }
        self.write(first, &slots)
    }
}

impl<T: DeserializeOwned, const SLOT: usize> Spool<T, SLOT> {
    /// Returns the entries of a range; read it [block by block](blocks).
    ///
    /// # Errors
    /// Returns the error of the file system, or an error if an entry was never stored.
    pub fn read(&mut self, part: Range<usize>) -> io::Result<Vec<T>> {
        self.file_waiting()?;
        let mut slots = vec![0; part.len() * SLOT];
        self.seek(part.start)?;
        self.file.read_exact(&mut slots)?;
        slots
            .chunks_exact(SLOT)
            .map(|slot| postcard::from_bytes(slot).map_err(io::Error::other))
            .collect()
    }
}

fn encode<T: Serialize, const SLOT: usize>(entry: &T, slots: &mut Vec<u8>) -> io::Result<()> {
    let mut slot = [0; SLOT];
    postcard::to_slice(entry, &mut slot).map_err(io::Error::other)?;
    slots.extend_from_slice(&slot);
    Ok(())
}
