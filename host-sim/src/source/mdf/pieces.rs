//! The data of a group or of a channel: one block, or a list of blocks, plain or compressed.

use super::mdf_file::{Block, HEADER_BYTES, MdfFile, u32_at, u64_at};
use super::packed::unpack;
use super::piece::Piece;
use crate::error::{Error, Result};
use std::collections::VecDeque;

/// Bytes of a plain block that are read at once.
const STEP_BYTES: u64 = 1 << 18;
/// Flags of a list of columns.
const EQUAL_COUNTS: u32 = 1;
const HAS_INVALIDATION: u32 = 1 << 31;
/// Most blocks of a list that are empty.
const MOST_EMPTY: u32 = 1 << 16;

/// Largest ratio of what deflate unpacks. A file does not have more records than this many for each of
/// its bytes, whatever a list says.
const MOST_RATIO: u64 = 1032;

/// A link to data.
#[derive(Clone, Copy)]
enum Link {
    Block(u64),
    /// So many bytes of zero: records without a block of invalidation bits.
    Zeros(u64),
}

/// The pieces of some data, in order.
#[derive(Default)]
pub(in crate::source) struct Pieces {
    links: VecDeque<Link>,
    /// Bytes of the invalidation bits of a record, if these are to be read. Lists of columns
    /// (LD, MDF 4.2) have them in blocks of their own.
    invalidation_bytes: Option<u64>,
    /// Bytes of zero that come next, and of all lists.
    zeros: u64,
    told_zeros: u64,
    next_list: u64,
    /// The rest of a plain block: place and length.
    rest: (u64, u64),
    is_cut_off: bool,
    empty: u32,
    /// Bytes of the blocks so far: more than the file has are a circle of links.
    taken: u64,
}

impl Pieces {
    /// Creates the pieces of the data that a link points to.
    pub(in crate::source) fn of(link: u64) -> Self {
        Self {
            links: VecDeque::from([Link::Block(link)]),
            ..Self::default()
        }
    }

    /// Creates the pieces of the invalidation bits of a list of columns, so many bytes a record.
    pub(in crate::source) fn of_invalidation(link: u64, bytes: u64) -> Self {
        Self {
            invalidation_bytes: Some(bytes),
            ..Self::of(link)
        }
    }

    /// Reads the next piece into `bytes`.
    ///
    /// # Errors
    /// Returns an error of the disk.
    pub(in crate::source) fn next(
        &mut self,
        file: &mut MdfFile,
        bytes: &mut Vec<u8>,
    ) -> Result<Piece> {
        loop {
            let (at, left) = self.rest;
            if left > 0 {
                return self.read_rest(file, at, left, bytes);
            }
            if self.zeros > 0 {
                let count = self.zeros.min(STEP_BYTES);
                self.zeros -= count;
                bytes.clear();
                bytes.resize(count as usize, 0);
                return Ok(Piece::Bytes);
            }
            let link = match self.next_link() {
                None => return Ok(Piece::End),
                Some(Link::Zeros(count)) => {
                    self.zeros = count;
                    continue;
                }
                Some(Link::Block(link)) => link,
            };
            let block = match file.block(link) {
                Ok(block) => block,
                Err(problem @ Error::Io { .. }) => return Err(problem),
                Err(problem) if link >= file.length() => return Ok(Piece::CutOff(problem)),
                Err(problem) => {
                    return Ok(Piece::Lost {
                        bytes: 0,
                        problem,
                        in_file: HEADER_BYTES,
                    });
                }
            };
            self.taken = self.taken.saturating_add(HEADER_BYTES);
            if matches!(&block.id, b"##DT" | b"##SD" | b"##DV" | b"##DI" | b"##DZ") {
                let in_file = file.length().saturating_sub(link);
                self.taken = self.taken.saturating_add(block.length.min(in_file));
            }
            if self.taken > 2 * file.length() {
                return Err(file.error("more data blocks than the file has", "each of them once"));
            }
            match &block.id {
                b"##DT" | b"##SD" | b"##DV" | b"##DI" => self.plain(file, &block),
                b"##DZ" => {
                    let piece = unpack(file, &block, bytes)?;
                    if matches!(piece, Piece::CutOff(_)) && !bytes.is_empty() {
                        self.is_cut_off = true;
                        return Ok(Piece::Bytes);
                    }
                    return Ok(piece);
                }
                b"##HL" => self.next_list = block.link(0),
                b"##DL" => {
                    self.next_list = block.link(0);
                    let links = block.links.iter().skip(1);
                    self.links.extend(links.copied().map(Link::Block));
                }
                b"##LD" => self.columns(file, &block)?,
                _ => {}
            }
            self.empty += 1;
            if self.empty > MOST_EMPTY {
                return Err(file.error("too many blocks without data", "blocks with data"));
            }
        }
    }

    fn next_link(&mut self) -> Option<Link> {
        loop {
            match self.links.pop_front() {
                Some(Link::Block(0)) => {}
                Some(link) => return Some(link),
                None if self.next_list == 0 => return None,
                None => {
                    let list = std::mem::take(&mut self.next_list);
                    self.links.push_back(Link::Block(list));
                }
            }
        }
    }

    /// Takes the blocks of a list of columns: those of values, or those of invalidation bits.
    fn columns(&mut self, file: &mut MdfFile, block: &Block) -> Result<()> {
        let data = file.data(block)?;
        let flags = u32_at(&data, 0).unwrap_or(0);
        let count = u32_at(&data, 4).unwrap_or(0) as usize;
        self.next_list = block.link(0);
        let Some(bytes) = self.invalidation_bytes else {
            let links = block.links.iter().skip(1).take(count);
            self.links.extend(links.copied().map(Link::Block));
            return Ok(());
        };
        // Each block has as many records, or the list has the number of the first record of each.
        let number = |k: usize| u64_at(&data, 8 + 8 * k).unwrap_or(0);
        let records = |k: usize| match flags & EQUAL_COUNTS {
            0 => number(k + 1).saturating_sub(number(k)),
            _ => number(0),
        };
        for k in 0..count.min(block.links.len()) {
            let link = match flags & HAS_INVALIDATION {
                0 => 0,
                _ => block.link(1 + count + k),
            };
            self.links.push_back(match link {
                0 => {
                    let most = file.length().saturating_mul(MOST_RATIO);
                    let count = records(k).saturating_mul(bytes);
                    let count = count.min(most.saturating_sub(self.told_zeros));
                    self.told_zeros += count;
                    Link::Zeros(count)
                }
                _ => Link::Block(link),
            });
        }
        Ok(())
    }

    fn plain(&mut self, file: &MdfFile, block: &Block) {
        let (at, length) = (block.data_at(), block.data_length());
        let in_file = file.length().saturating_sub(at);
        let is_last = self.next_list == 0 && self.links.is_empty();
        let is_open = length == 0 && is_last && file.has_open_end();
        self.is_cut_off = !is_open && length > in_file;
        self.rest = (
            at,
            if is_open {
                in_file
            } else {
                length.min(in_file)
            },
        );
    }

    fn read_rest(
        &mut self,
        file: &mut MdfFile,
        at: u64,
        left: u64,
        bytes: &mut Vec<u8>,
    ) -> Result<Piece> {
        self.empty = 0;
        let count = left.min(STEP_BYTES);
        file.read(at, count, bytes)?;
        let read = bytes.len() as u64;
        self.rest = (at + read, if read < count { 0 } else { left - read });
        Ok(Piece::Bytes)
    }

    /// Returns the error of a plain block that the end of the file cut off, once.
    pub(in crate::source) fn take_cut_off(&mut self, file: &MdfFile) -> Option<Error> {
        let is_cut_off = std::mem::take(&mut self.is_cut_off);
        is_cut_off.then(|| file.error("the log is cut off", "a whole data block"))
    }
}
