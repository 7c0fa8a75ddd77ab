//! A page in RAM, while it is changed.

use super::address::PageKey;
use super::page::{
    BODY_BYTES, MOST_BLOCKS, MOST_JOINS, PAGE_HEADER, Page, PageHeader, STORED_JOIN, StoredJoin,
    block_in, block_start, bounds_of, head_bytes,
};
use crate::roadmap::block::Block;
use crate::roadmap::map_error::MapError;
use crate::roadmap::record::checksum_of;
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
        *self = Self::default();
        self.header.key = key;
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

    /// Notes that this drive changes the page.
    pub(super) fn touch(&mut self, drive: u32, now: Instant) {
        if self.header.last_drive != drive {
            self.header.last_drive = drive;
            self.header.drives = self.header.drives.saturating_add(1);
        }
        self.changed.get_or_insert(now);
    }

    /// Puts a block in place of the one with this number, or behind the last one. Returns false, and
    /// changes nothing, if there is no room.
    pub(super) fn put(&mut self, number: u8, block: &[u8]) -> bool {
        let older = block_start(&self.blocks, number).zip(block_start(&self.blocks, number + 1));
        let (start, end) = match older {
            Some(range) if number < self.header.blocks => range,
            _ if number == self.header.blocks && number < MOST_BLOCKS => {
                (self.blocks.len(), self.blocks.len())
            }
            _ => return false,
        };
        let (was, now) = (end - start, block.len());
        if now > was && now - was > self.room() {
            return false;
        }
        let length = self.blocks.len();
        if now > was && self.blocks.resize(length + now - was, 0).is_err() {
            return false;
        }
        self.blocks.copy_within(end..length, start + now);
        self.blocks.truncate(length + now - was);
        if let Some(place) = self.blocks.get_mut(start..start + now) {
            place.copy_from_slice(block);
        }
        self.header.blocks = self.header.blocks.max(number + 1);
        if let Ok(block) = self.block(number) {
            let bounds = bounds_of(&block);
            self.header.bounds.unite(&bounds);
        }
        true
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

    /// Passes the page as bytes to `write`, in parts, for a sector that has been erased so often.
    pub(super) fn sealed<T>(
        &self,
        erases: u32,
        sequence: u32,
        write: impl FnOnce(&PageHeader, [&[u8]; 3]) -> T,
    ) -> Option<T> {
        let joins = self.joins.len();
        let length = PAGE_HEADER + joins * STORED_JOIN + self.blocks.len();
        let header = PageHeader {
            erases,
            sequence,
            joins: u8::try_from(joins).ok()?,
            length: u16::try_from(length).ok()?,
            ..self.header
        };
        let head = head_bytes(&header, &self.joins)?;
        let sum = checksum_of(&[&head, &self.blocks]).to_le_bytes();
        Some(write(&header, [&head, &self.blocks, &sum]))
    }
}
