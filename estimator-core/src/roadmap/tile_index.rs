//! The index of a packed map by place.

use super::map_error::MapError;
use super::packed_map::PackedMap;
use super::record::{Numbers, record};
use super::tile::{Looked, Tile};

/// Bytes of a page of the index.
pub const INDEX_PAGE: usize = 256;
/// Entries of a page of the index.
pub const INDEX_ENTRIES: usize = 31;

/// Bytes of an entry of the index.
const INDEX_ENTRY: usize = 8;

impl<'m> PackedMap<'m> {
    /// Returns the offsets of the blocks with a cell in a tile. After an error there are no more.
    #[must_use]
    pub fn blocks_in(&self, tile: Tile) -> TileBlocks<'m> {
        if self.memory.is_some() {
            return self.blocks_from_page(tile, 0, 0);
        }
        let (mut low, mut high) = (0, self.pages);
        // The first page whose last entry is not before the tile. Only this page and those after it
        // are checked: a damaged entry on the way leads to no blocks, never to wrong ones.
        while low < high {
            let middle = low + (high - low) / 2;
            match self.last_key(middle) {
                Some(key) if key < tile.key() => low = middle + 1,
                _ => high = middle,
            }
        }
        self.blocks_from_page(tile, low, 0)
    }

    /// Returns the blocks with a cell in a tile, from an entry of a page on.
    pub(super) const fn blocks_from_page(
        &self,
        tile: Tile,
        page: u32,
        entry: usize,
    ) -> TileBlocks<'m> {
        TileBlocks {
            map: *self,
            tile,
            page,
            entry,
            content: None,
        }
    }

    fn page_offset(&self, page: u32) -> Option<u32> {
        let bytes = page.checked_mul(u32::try_from(INDEX_PAGE).ok()?)?;
        self.first_page.checked_add(bytes)
    }

    /// Returns the last tile of a page, unchecked.
    fn last_key(&self, page: u32) -> Option<u32> {
        let start = usize::try_from(self.page_offset(page)?).ok()?;
        let content = self.bytes.get(start..)?.get(..INDEX_PAGE)?;
        let entries = Numbers::from(content, INDEX_ENTRIES * INDEX_ENTRY)
            .ok()?
            .u32()
            .ok()?;
        let last = usize::try_from(entries).ok()?.checked_sub(1)?;
        let at = last.min(INDEX_ENTRIES - 1) * INDEX_ENTRY;
        Numbers::from(content, at).ok()?.u32().ok()
    }
}

/// Offsets of the blocks with a cell in a tile.
#[derive(Clone, Debug)]
pub struct TileBlocks<'m> {
    map: PackedMap<'m>,
    pub(super) tile: Tile,
    /// Page of the index, or slot of the memory.
    pub(super) page: u32,
    pub(super) entry: usize,
    /// The last page that was read, by its number: checking one costs more than reading it.
    content: Option<(u32, &'m [u8])>,
}

impl Iterator for TileBlocks<'_> {
    type Item = Result<u32, MapError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.map.memory.is_some() {
            return loop {
                match self.look() {
                    Looked::Block(address) => break Some(Ok(address)),
                    Looked::NotYet => {}
                    Looked::End => break None,
                }
            };
        }
        let entry = self.next_entry();
        if !matches!(entry, Ok(Some(_))) {
            self.page = self.map.pages;
        }
        entry.transpose()
    }
}

impl TileBlocks<'_> {
    /// Looks for the next block with bounded work: a memory has no index.
    pub(super) fn look(&mut self) -> Looked {
        let Some(memory) = &self.map.memory else {
            return match self.next() {
                Some(Ok(offset)) => Looked::Block(offset),
                _ => Looked::End,
            };
        };
        let Ok(number) = u8::try_from(self.entry) else {
            return Looked::End;
        };
        let (looked, slot, number) = memory.look(self.tile, self.page, number);
        self.page = slot;
        self.entry = number.into();
        looked
    }

    /// Goes on with the blocks of another tile.
    pub(super) fn look_in(&mut self, tile: Tile) {
        *self = Self {
            content: self.content,
            ..self.map.blocks_in(tile)
        };
    }

    fn next_entry(&mut self) -> Result<Option<u32>, MapError> {
        while self.page < self.map.pages {
            let content = match self.content {
                Some((page, content)) if page == self.page => content,
                _ => {
                    let offset = self.map.page_offset(self.page).ok_or(MapError::Content)?;
                    let content = record(self.map.bytes, offset, INDEX_PAGE)?;
                    self.content = Some((self.page, content));
                    content
                }
            };
            let entries = Numbers::from(content, INDEX_ENTRIES * INDEX_ENTRY)?.u32()?;
            let entries = usize::try_from(entries).map_err(|_| MapError::Content)?;
            while self.entry < entries.min(INDEX_ENTRIES) {
                let mut numbers = Numbers::from(content, self.entry * INDEX_ENTRY)?;
                let (key, offset) = (numbers.u32()?, numbers.u32()?);
                self.entry += 1;
                if key > self.tile.key() {
                    return Ok(None);
                }
                if key == self.tile.key() {
                    return Ok(Some(offset));
                }
            }
            self.page += 1;
            self.entry = 0;
        }
        Ok(None)
    }
}
