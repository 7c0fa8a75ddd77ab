//! The blocks of an MDF file: a header with name, length and links to other blocks, then data.

use crate::error::{Error, Result};
use crate::source::log_file::LogFile;
use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};

/// Where the header block stands, behind the identification.
const HEADER_AT: u64 = 64;
/// Bytes of the header of a block, without its links.
pub(in crate::source) const HEADER_BYTES: u64 = 24;
/// Bytes of a link.
const LINK_BYTES: u64 = 8;
/// Most links of a block. A list of data blocks of 64 KiB with as many is one of 64 GiB.
const MOST_LINKS: u64 = 1 << 20;
/// Most bytes of a block that is read whole and is no data block.
const MOST_BYTES: u64 = 1 << 20;
/// Most blocks that are read besides those of data: a file with a circle of links ends there.
const MOST_BLOCKS: u32 = 1 << 18;
/// The same of texts.
const MOST_TEXTS: u32 = 1 << 20;
/// Bytes of a text that are read. Names and units have fewer.
const MOST_TEXT_BYTES: u64 = 1 << 12;

/// Where the identification block has its flags of what is not finished.
const UNFINISHED_AT: u64 = 60;
/// The length of the last data block is not up to date.
const LAST_LENGTH: u16 = 1 << 2;

/// A block of the file.
pub(in crate::source) struct Block {
    pub id: [u8; 4],
    pub at: u64,
    /// Bytes with header and links.
    pub length: u64,
    pub links: Vec<u64>,
}

impl Block {
    /// Returns a link; 0 for none.
    pub(in crate::source) fn link(&self, index: usize) -> u64 {
        self.links.get(index).copied().unwrap_or(0)
    }

    /// Returns where its data begin.
    pub(in crate::source) fn data_at(&self) -> u64 {
        self.at + HEADER_BYTES + LINK_BYTES * self.links.len() as u64
    }

    /// Returns the number of its data bytes.
    pub(in crate::source) fn data_length(&self) -> u64 {
        (self.at + self.length).saturating_sub(self.data_at())
    }
}

/// Returns the number at a place of some bytes, if it is inside.
pub(in crate::source) fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

pub(in crate::source) fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    number(bytes, at).map(u16::from_le_bytes)
}

pub(in crate::source) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    number(bytes, at).map(u32::from_le_bytes)
}

pub(in crate::source) fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    number(bytes, at).map(u64::from_le_bytes)
}

/// An open MDF file.
pub(in crate::source) struct MdfFile {
    log: LogFile,
    file: File,
    length: u64,
    flags: u16,
    blocks: u32,
    texts: u32,
    /// Where the newest block begins.
    block_at: u64,
}

impl MdfFile {
    pub(in crate::source) fn open(mut log: LogFile) -> Result<Self> {
        let mut file = log.open_seekable()?;
        let length = file.seek(SeekFrom::End(0)).map_err(Error::io(log.path()))?;
        let mut opened = Self {
            log,
            file,
            length,
            flags: 0,
            blocks: 0,
            texts: 0,
            block_at: 0,
        };
        let mut flags = Vec::new();
        opened.read(UNFINISHED_AT, 2, &mut flags)?;
        opened.flags = u16_at(&flags, 0).unwrap_or(0);
        Ok(opened)
    }

    pub(in crate::source) const fn log(&self) -> &LogFile {
        &self.log
    }

    /// Returns the size of the file, bytes.
    pub(in crate::source) const fn length(&self) -> u64 {
        self.length
    }

    /// Returns true if the length of the last data block may be too small.
    pub(in crate::source) const fn has_open_end(&self) -> bool {
        self.flags & LAST_LENGTH != 0
    }

    /// Returns the error of the newest block.
    pub(in crate::source) fn error(&self, problem: &str, expected: &str) -> Error {
        let at = self.block_at;
        let problem = format!("{problem}, in the block at byte {at}; expected {expected}");
        Error::content(self.log.path(), problem)
    }

    /// Reads bytes at a place; fewer at the end of the file.
    pub(in crate::source) fn read(
        &mut self,
        at: u64,
        count: u64,
        bytes: &mut Vec<u8>,
    ) -> Result<()> {
        bytes.clear();
        let failed = |e| Error::io(self.log.path())(e);
        self.file.seek(SeekFrom::Start(at)).map_err(failed)?;
        loop {
            let left = count - bytes.len() as u64;
            match self.file.by_ref().take(left).read_to_end(bytes) {
                Ok(_) => break,
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => return Err(Error::io(self.log.path())(e)),
            }
        }
        self.log.note_read(bytes.len() as u64);
        Ok(())
    }

    /// Reads header and links of a block.
    ///
    /// # Errors
    /// Returns an error for bytes that are no block.
    pub(in crate::source) fn block(&mut self, at: u64) -> Result<Block> {
        self.block_at = at;
        let mut bytes = Vec::new();
        self.read(at, HEADER_BYTES, &mut bytes)?;
        let id = number(&bytes, 0).filter(|id: &[u8; 4]| id.starts_with(b"##"));
        let (Some(id), Some(length), Some(count)) = (id, u64_at(&bytes, 8), u64_at(&bytes, 16))
        else {
            return Err(self.error("no block where a link points to", "the letters ##"));
        };
        let fits = count <= MOST_LINKS && length >= HEADER_BYTES + LINK_BYTES * count;
        if !fits || at.checked_add(length).is_none() {
            let what = format!("a block of {length} bytes with {count} links");
            return Err(self.error(&what, "a block with room for its links"));
        }
        let mut links = Vec::new();
        if count > 0 {
            self.read(at + HEADER_BYTES, LINK_BYTES * count, &mut bytes)?;
            let words = bytes.chunks_exact(LINK_BYTES as usize);
            links.extend(words.filter_map(|word| u64_at(word, 0)));
        }
        Ok(Block {
            id,
            at,
            length,
            links,
        })
    }

    /// Reads a block that describes others. There are not many.
    pub(in crate::source) fn described(&mut self, at: u64, id: &[u8; 4]) -> Result<Block> {
        self.blocks += 1;
        if self.blocks > MOST_BLOCKS {
            let expected = format!("at most {MOST_BLOCKS} blocks besides data");
            return Err(self.error("too many blocks", &expected));
        }
        let block = self.block(at)?;
        if block.id != *id {
            let found = block.id.escape_ascii().to_string();
            return Err(self.error(&format!("a block {found}"), &id.escape_ascii().to_string()));
        }
        Ok(block)
    }

    /// Reads the header block.
    pub(in crate::source) fn header(&mut self) -> Result<Block> {
        self.described(HEADER_AT, b"##HD")
    }

    /// Returns the start of the measurement that the header names, in microseconds since the Unix
    /// epoch.
    pub(in crate::source) fn origin_us(&mut self, header: &Block) -> Result<Option<u64>> {
        let start_ns = u64_at(&self.data(header)?, 0);
        Ok(start_ns.filter(|ns| *ns > 0).map(|ns| ns / 1000))
    }

    /// Reads the data of a block that describes others.
    pub(in crate::source) fn data(&mut self, block: &Block) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let count = block.data_length().min(MOST_BYTES);
        self.read(block.data_at(), count, &mut bytes)?;
        Ok(bytes)
    }

    /// Returns true if the block at a place is a conversion.
    pub(in crate::source) fn is_conversion(&mut self, at: u64) -> Result<bool> {
        Ok(self.counted(at)?.id == *b"##CC")
    }

    /// Reads a block that is one of many texts.
    fn counted(&mut self, at: u64) -> Result<Block> {
        self.texts += 1;
        if self.texts > MOST_TEXTS {
            return Err(self.error("too many texts", &format!("at most {MOST_TEXTS}")));
        }
        self.block(at)
    }

    /// Counts blocks from the beginning, for another reader of the same file.
    pub(in crate::source) const fn begin_again(&mut self) {
        self.blocks = 0;
        self.texts = 0;
    }

    /// Reads the text of a TX or MD block, or its beginning; empty if there is none.
    pub(in crate::source) fn text(&mut self, at: u64) -> Result<Vec<u8>> {
        if at == 0 {
            return Ok(Vec::new());
        }
        let block = self.counted(at)?;
        let mut text = Vec::new();
        let count = block.data_length().min(MOST_TEXT_BYTES);
        self.read(block.data_at(), count, &mut text)?;
        let end = text.iter().position(|byte| *byte == 0);
        text.truncate(end.unwrap_or(text.len()));
        Ok(text)
    }
}
