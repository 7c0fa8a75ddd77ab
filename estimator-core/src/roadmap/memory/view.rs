//! The roads of a memory as the matcher reads them.

use super::address::{PageKey, block_number};
use super::flash::SECTOR_BYTES;
use super::page::{Page, StoredJoin, bounds_of};
use super::sectors::Sector;
use crate::roadmap::block::Block;
use crate::roadmap::map_error::MapError;
use crate::roadmap::tile::Tile;

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
        let start = usize::from(sector) * SECTOR_BYTES;
        Page::open(self.flash.get(start..start + SECTOR_BYTES)?).ok()
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
        (block_number(way)..page.header.blocks)
            .map_while(|number| page.block(number, false).ok())
            .take_while(|block| block.way == way)
            .find(|block| block.last_cell() >= cell)
            .map(|block| block.offset)
    }

    /// Returns the first block with a cell in a tile, from a block of a slot on: its slot, its number
    /// and its address.
    #[must_use]
    pub fn block_in(&self, tile: Tile, slot: u32, number: u8) -> Option<(u32, u8, u32)> {
        let slots = u32::try_from(self.sectors.len()).ok()?;
        (slot..slots).find_map(|here| {
            let sector = self.sectors.get(usize::try_from(here).ok()?)?;
            if !sector.bounds.contains(tile) {
                return None;
            }
            let page = self.page_of_slot(here as u16)?;
            let first = if here == slot { number } else { 0 };
            (first..page.header.blocks)
                .map_while(|number| page.block(number, false).ok())
                .find(|block| bounds_of(block).contains(tile))
                .map(|block| (here, block_number(block.offset), block.offset))
        })
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
    let last = (first..page.header.blocks)
        .map_while(|number| page.block(number, false).ok())
        .take_while(|block| block.way == address)
        .last()?;
    let joins = || (0..page.header.joins).filter_map(|i| page.join(i));
    let before = joins().take_while(|join| join.at_way < first).count();
    let own = joins().filter(|join| join.at_way == first).count();
    Some(StoredWay {
        address,
        blocks_end: last.next,
        first_cell: start.first_cell,
        last_cell: last.last_cell(),
        first_join: key.block(u8::try_from(before).ok()?),
        joins: u32::try_from(own).ok()?,
    })
}
