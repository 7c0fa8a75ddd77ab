//! The roads of a memory as the matcher reads them.

use super::address::{PageKey, block_number};
use super::flash::sector_bytes;
use super::page::{Page, StoredJoin};
use super::sectors::Sector;
use crate::roadmap::block::Block;
use crate::roadmap::map_error::MapError;
use crate::roadmap::tile::{Looked, Tile};

/// Slots that are gone over in one look for a block.
const SLOTS_AT_ONCE: u32 = 128;

/// The roads of a memory as they are now.
#[derive(Clone, Copy, Debug)]
pub struct MemoryView<'m> {
    flash: &'m [u8],
    sectors: &'m [Sector],
}

/// A way of a memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredWay {
    /// Address of its first block, by which blocks and joins name it.
    pub address: u32,
    /// Address behind its last block.
    pub blocks_end: u32,
    /// Number of its first cell.
    pub first_cell: i32,
    /// Number of its last cell.
    pub last_cell: i32,
    /// Address of its first join: of its page, with the number of the join.
    pub first_join: u32,
    /// Number of its joins.
    pub joins: u32,
}

impl<'m> MemoryView<'m> {
    pub(super) const fn new(flash: &'m [u8], sectors: &'m [Sector]) -> Self {
        Self { flash, sectors }
    }

    /// Returns the page of a slot.
    #[must_use]
    pub fn page_of_slot(&self, slot: u16) -> Option<Page<'m>> {
        let sector = self.sectors.get(usize::from(slot))?.page_sector()?;
        Page::open(sector_bytes(self.flash, sector)?).ok()
    }

    /// Returns all pages, by slot.
    pub fn pages(self) -> impl Iterator<Item = Page<'m>> {
        (0..self.sectors.len() as u16).filter_map(move |slot| self.page_of_slot(slot))
    }

    /// Returns a page; `None` if it has made room for another one.
    #[must_use]
    pub fn page(&self, key: PageKey) -> Option<Page<'m>> {
        self.page_of_slot(key.slot)
            .filter(|page| page.header.key == key)
    }

    /// Returns the block with an address, with its checksum checked if asked for.
    ///
    /// # Errors
    /// Returns an error if there is none.
    pub fn block(&self, address: u32, is_checked: bool) -> Result<Block<'m>, MapError> {
        self.page(PageKey::of(address))
            .ok_or(MapError::Content)?
            .block(block_number(address), is_checked)
    }

    /// Returns the way with an address.
    ///
    /// # Errors
    /// Returns an error if there is none.
    pub fn way(&self, address: u32) -> Result<StoredWay, MapError> {
        let page = self.page(PageKey::of(address)).ok_or(MapError::Content)?;
        way_in(&page, block_number(address)).ok_or(MapError::Content)
    }

    /// Returns the first way at or behind an address, in the order of slots.
    #[must_use]
    pub fn way_from(&self, address: u32) -> Option<StoredWay> {
        let start = PageKey::of(address).slot;
        (start..self.sectors.len() as u16).find_map(|slot| {
            let page = self.page_of_slot(slot)?;
            let from = if slot == start {
                block_number(address)
            } else {
                0
            };
            (from..page.header.blocks).find_map(|number| {
                let block = page.block(number, false).ok()?;
                (block.way == block.offset).then(|| way_in(&page, number))?
            })
        })
    }

    /// Returns a join by its address.
    #[must_use]
    pub fn join(&self, address: u32) -> Option<StoredJoin> {
        self.page(PageKey::of(address))?.join(block_number(address))
    }

    /// Returns the address of the first block of a way that ends at or behind a cell.
    #[must_use]
    pub fn block_at(&self, way: u32, cell: i32) -> Option<u32> {
        let page = self.page(PageKey::of(way))?;
        page.heads_of_way(block_number(way), way)
            .find(|head| head.last_cell() >= cell)
            .map(|head| page.header.key.block(head.number))
    }

    /// Looks for a block with a cell in a tile, from a block of a slot on, with bounded work. Returns
    /// what it found, and the slot and the block to go on from.
    pub(in crate::roadmap) fn look(&self, tile: Tile, slot: u32, number: u8) -> (Looked, u32, u8) {
        let slots = self.sectors.len() as u32;
        let last = slots.min(slot.saturating_add(SLOTS_AT_ONCE));
        for here in slot..last {
            let sector = usize::try_from(here).ok().and_then(|i| self.sectors.get(i));
            if !sector.is_some_and(|sector| sector.bounds.contains(tile)) {
                continue;
            }
            let Some(page) = self.page_of_slot(here as u16) else {
                continue;
            };
            let first = if here == slot { number } else { 0 };
            return match page.look(tile, first) {
                (Looked::End, _) => (Looked::NotYet, here + 1, 0),
                (looked, next) => (looked, here, next),
            };
        }
        let looked = if last < slots {
            Looked::NotYet
        } else {
            Looked::End
        };
        (looked, last, 0)
    }
}

/// Returns the way that begins with a block of a page.
fn way_in(page: &Page<'_>, first: u8) -> Option<StoredWay> {
    let key = page.header.key;
    let address = key.block(first);
    let start = page.block(first, false).ok()?;
    if start.way != address {
        return None;
    }
    let last = page.last_of_way(first, address)?;
    let (mut before, mut own) = (0_u8, 0_u8);
    for at_way in page.ways_of_joins() {
        before += u8::from(at_way < first);
        own += u8::from(at_way == first);
    }
    Some(StoredWay {
        address,
        blocks_end: last.next,
        first_cell: start.first_cell,
        last_cell: last.last_cell(),
        first_join: key.block(before),
        joins: own.into(),
    })
}
