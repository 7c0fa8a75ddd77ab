//! Entries of one size, put by until a run is over: in memory while they are few, then in a
//! temporary file (`TMPDIR`, else where the system has them), which nobody else sees and which is
//! gone with the process.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use tempfile::SpooledTempFile;

/// Bytes that stay in memory.
const MEMORY_BYTES: usize = 256 * 1024;
/// Entries that are written or read at once.
const BLOCK: usize = 512;

/// A part in blocks of which each is little to hold.
pub fn blocks(part: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let end = part.end;
    part.step_by(BLOCK)
        .map(move |begin| begin..end.min(begin + BLOCK))
}

/// Entries of `N` words.
#[derive(Debug)]
pub struct Spool<const N: usize> {
    file: SpooledTempFile,
    /// Entries in the file.
    filed: usize,
    /// The last ones, which are not yet.
    waiting: Vec<[u32; N]>,
    /// Room for what is written or read.
    bytes: Vec<u8>,
}

impl<const N: usize> Default for Spool<N> {
    fn default() -> Self {
        Self {
            file: SpooledTempFile::new(MEMORY_BYTES),
            filed: 0,
            waiting: Vec::new(),
            bytes: Vec::new(),
        }
    }
}

impl<const N: usize> Spool<N> {
    const ENTRY_BYTES: usize = N * size_of::<u32>();

    /// Number of entries, from the first to the last that was put by.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.filed + self.waiting.len()
    }

    /// Puts an entry behind the others.
    ///
    /// # Errors
    /// What the file system says.
    pub fn push(&mut self, entry: [u32; N]) -> io::Result<()> {
        self.waiting.push(entry);
        if self.waiting.len() < BLOCK {
            return Ok(());
        }
        self.file_waiting()
    }

    /// Puts entries by at their numbers, in whatever order.
    ///
    /// # Errors
    /// What the file system says.
    pub fn put(&mut self, first: usize, entries: &[[u32; N]]) -> io::Result<()> {
        self.file_waiting()?;
        self.write(first, entries)
    }

    /// The entries of a part, to be read [block by block](blocks).
    ///
    /// # Errors
    /// What the file system says; entries that were not put by.
    pub fn read(&mut self, part: Range<usize>) -> io::Result<Vec<[u32; N]>> {
        self.file_waiting()?;
        self.bytes.resize(part.len() * Self::ENTRY_BYTES, 0);
        self.seek(part.start)?;
        self.file.read_exact(&mut self.bytes)?;
        let (words, _) = self.bytes.as_chunks();
        let entry = |words: &[[u8; 4]]| std::array::from_fn(|i| u32::from_le_bytes(words[i]));
        Ok(words.chunks_exact(N).map(entry).collect())
    }

    fn file_waiting(&mut self) -> io::Result<()> {
        let waiting = std::mem::take(&mut self.waiting);
        self.write(self.filed, &waiting)?;
        self.waiting = waiting;
        self.waiting.clear();
        Ok(())
    }

    fn write(&mut self, first: usize, entries: &[[u32; N]]) -> io::Result<()> {
        if entries.is_empty() {
            return Ok(());
        }
        self.bytes.clear();
        let words = entries.iter().flatten();
        self.bytes.extend(words.flat_map(|word| word.to_le_bytes()));
        self.seek(first)?;
        self.file.write_all(&self.bytes)?;
        self.filed = self.filed.max(first + entries.len());
        Ok(())
    }

    fn seek(&mut self, entry: usize) -> io::Result<()> {
        let at = entry as u64 * Self::ENTRY_BYTES as u64;
        self.file.seek(SeekFrom::Start(at)).map(drop)
    }
}
