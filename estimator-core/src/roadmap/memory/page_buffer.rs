//! A page in RAM, while it is changed.

use super::address::{PageKey, block_number};
use super::page::{
    BODY_BYTES, MOST_BLOCKS, MOST_JOINS, PAGE_HEADER, Page, PageHeader, STORED_JOIN, StoredJoin,
    block_in, block_start, bounds_of, head_bytes, heads_of_blocks,
};
use crate::roadmap::block::Block;
use crate::roadmap::map_error::MapError;
use crate::time::Instant;
use heapless::Vec;

/// Joins of a way within this distance to the same way are one, cells.
const SAME_CELLS: i32 = 12;

/// A page in RAM.
#[derive(Clone, Debug, Default)]
pub(super) struct PageBuffer {
    header: PageHeader,
    joins: Vec<StoredJoin, MOST_JOINS>,
    blocks: Vec<u8, BODY_BYTES>,
    /// When the first change was made that is not written yet.
    pub(super) changed: Option<Instant>,
}

impl PageBuffer {
    /// Becomes an empty page.
    pub(super) fn begin(&mut self, key: PageKey) {
        // In place: an empty page would pass over the stack, with all of its room.
        self.header = PageHeader {
            key,
            ..PageHeader::default()
        };
        self.joins.clear();
        self.blocks.clear();
        self.changed = None;
    }

    /// Becomes a copy of a page.
    pub(super) fn load(&mut self, page: &Page<'_>) {
        self.header = page.header;
        self.changed = None;
        self.joins.clear();
        self.joins.extend(
            (0..page.header.joins)
                .filter_map(|i| page.join(i))
                .take(MOST_JOINS),
        );
        self.blocks.clear();
        if self.blocks.extend_from_slice(page.block_bytes()).is_err() {
            self.header.blocks = 0;
        }
    }

    /// Returns which page it is.
    pub(super) const fn key(&self) -> PageKey {
        self.header.key
    }

    /// Returns the number of its blocks.
    pub(super) const fn blocks(&self) -> u8 {
        self.header.blocks
    }

    /// Returns the free bytes.
    pub(super) fn room(&self) -> usize {
        BODY_BYTES - self.blocks.len() - self.joins.len() * STORED_JOIN
    }

    /// Returns a block.
    pub(super) fn block(&self, number: u8) -> Result<Block<'_>, MapError> {
        block_in(&self.blocks, number, self.key().block(number), false)
    }

    /// Returns the number of the block of a way that has a cell.
    pub(super) fn block_with(&self, way: u32, cell: i32) -> Option<u8> {
        heads_of_blocks(&self.blocks, block_number(way))
            .take_while(|head| head.number < self.header.blocks && head.way == way)
            .find(|head| (head.first_cell..=head.last_cell()).contains(&cell))
            .map(|head| head.number)
    }

    /// Notes that this drive changes the page.
    pub(super) fn touch(&mut self, drive: u32, now: Instant) {
        if self.header.last_drive != drive {
            self.header.last_drive = drive;
            self.header.drives = self.header.drives.saturating_add(1);
        }
        self.changed.get_or_insert(now);
    }

    /// Makes room for a block in place of the one with this number, or behind the last one: moves those
    /// behind it. Returns false, and changes nothing, if there is no room. [`put`](Self::put) follows.
    pub(super) fn make_room(&mut self, number: u8, length: usize) -> bool {
        let older = block_start(&self.blocks, number).zip(block_start(&self.blocks, number + 1));
        let (start, end) = match older {
            Some(range) if number < self.header.blocks => range,
            _ if number == self.header.blocks && number < MOST_BLOCKS => {
                (self.blocks.len(), self.blocks.len())
            }
            _ => return false,
        };
        let was = end - start;
        if length > was && length - was > self.room() {
            return false;
        }
        self.move_from(end, start + length).is_some()
    }

    /// Moves the bytes from one offset on to another one. Returns `None` if they do not fit.
    fn move_from(&mut self, from: usize, to: usize) -> Option<()> {
        // In the form in which the compiler sees that `copy_within` does not panic.
        if let Some(by) = to.checked_sub(from) {
            self.blocks.resize(self.blocks.len() + by, 0).ok()?;
            let behind = self.blocks.get_mut(from..)?;
            let count = behind.len().checked_sub(by)?;
            behind.copy_within(..count, by);
        } else {
            let behind = self.blocks.get_mut(to..)?;
            let by = from - to;
            let count = behind.len().checked_sub(by)?;
            behind.copy_within(by.., 0);
            self.blocks.truncate(to + count);
        }
        Some(())
    }

    /// Puts a block where there is room for it now.
    pub(super) fn put(&mut self, number: u8, block: &[u8]) {
        let start = block_start(&self.blocks, number).unwrap_or(self.blocks.len());
        if let Some(place) = self.blocks.get_mut(start..start + block.len()) {
            place.copy_from_slice(block);
        }
        self.header.blocks = self.header.blocks.max(number + 1);
        if let Ok(block) = self.block(number) {
            let bounds = bounds_of(&block);
            self.header.bounds.unite(&bounds);
        }
    }

    /// Adds a join unless it is known. The first one makes room. Returns whether it was added.
    pub(super) fn add_join(&mut self, join: StoredJoin) -> bool {
        let is_same = |known: &StoredJoin| {
            known.at_way == join.at_way
                && known.to_way == join.to_way
                && (known.at_cell - join.at_cell).abs() < SAME_CELLS
        };
        if self.joins.iter().any(is_same) || self.room() < STORED_JOIN {
            return false;
        }
        if self.joins.is_full() {
            self.joins.remove(0);
        }
        let place = |join: &StoredJoin| (join.at_way, join.at_cell);
        let next = self
            .joins
            .iter()
            .position(|known| place(known) > place(&join));
        self.joins
            .insert(next.unwrap_or(self.joins.len()), join)
            .is_ok()
    }

    /// Returns the header of the page in a sector that has been erased so often.
    pub(super) fn header(&self, erases: u32, sequence: u32) -> Option<PageHeader> {
        let joins = self.joins.len();
        let length = PAGE_HEADER + joins * STORED_JOIN + self.blocks.len();
        Some(PageHeader {
            erases,
            sequence,
            joins: u8::try_from(joins).ok()?,
            length: u16::try_from(length).ok()?,
            ..self.header
        })
    }

    /// Copies what lies in a chunk of the sector, from this byte of it on: all but the checksum.
    pub(super) fn copy_to(&self, chunk: &mut [u8], at: usize, header: &PageHeader) -> Option<()> {
        let head_length = PAGE_HEADER + self.joins.len() * STORED_JOIN;
        if at < head_length {
            overlay(chunk, at, &head_bytes(header, &self.joins)?, 0);
        }
        overlay(chunk, at, &self.blocks, head_length);
        Some(())
    }
}

/// Copies a part of a page to a chunk of it, as far as the part lies in the chunk. Both are given with
/// their offset in the page.
pub(super) fn overlay(chunk: &mut [u8], chunk_at: usize, part: &[u8], part_at: usize) {
    let to = chunk.get_mut(part_at.saturating_sub(chunk_at)..);
    let from = part.get(chunk_at.saturating_sub(part_at)..);
    if let Some((to, from)) = to.zip(from) {
        let length = to.len().min(from.len());
        if let Some((to, from)) = to.get_mut(..length).zip(from.get(..length)) {
            to.copy_from_slice(from);
        }
    }
}
