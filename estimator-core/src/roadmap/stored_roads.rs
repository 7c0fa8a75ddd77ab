//! The roads of a memory in place of the bytes of a map.
//!
//! They are read through a table of functions that only a road memory gives. So an image with a map
//! and without a road memory has none of the code that reads pages.

use super::block::Block;
use super::join::Join;
use super::map_error::MapError;
use super::memory::{MemoryView, StoredWay};
use super::tile::{Looked, Tile};

/// The roads of a memory, and how they are read.
#[derive(Clone, Copy, Debug)]
pub(super) struct StoredRoads<'m> {
    view: MemoryView<'m>,
    reads: &'static Reads,
}

/// How the roads of a memory are read: the methods of [`MemoryView`].
#[derive(Debug)]
struct Reads {
    way: fn(&MemoryView<'_>, u32) -> Result<StoredWay, MapError>,
    way_from: fn(&MemoryView<'_>, u32) -> Option<StoredWay>,
    block: for<'m> fn(&MemoryView<'m>, u32, bool) -> Result<Block<'m>, MapError>,
    look: Look,
    join: fn(&MemoryView<'_>, u32) -> Result<Join, MapError>,
}

type Look = fn(&MemoryView<'_>, Tile, u32, u8) -> (Looked, u32, u8);

static READS: Reads = Reads {
    way: |view, address| view.way(address),
    way_from: |view, address| view.way_from(address),
    block: |view, address, is_checked| view.block(address, is_checked),
    look: |view, tile, slot, number| view.look(tile, slot, number),
    join: join_of,
};

impl<'m> StoredRoads<'m> {
    pub(super) const fn new(view: MemoryView<'m>) -> Self {
        Self {
            view,
            reads: &READS,
        }
    }

    pub(super) fn way(&self, address: u32) -> Result<StoredWay, MapError> {
        (self.reads.way)(&self.view, address)
    }

    pub(super) fn way_from(&self, address: u32) -> Option<StoredWay> {
        (self.reads.way_from)(&self.view, address)
    }

    pub(super) fn block(&self, address: u32, is_checked: bool) -> Result<Block<'m>, MapError> {
        (self.reads.block)(&self.view, address, is_checked)
    }

    pub(super) fn look(&self, tile: Tile, slot: u32, number: u8) -> (Looked, u32, u8) {
        (self.reads.look)(&self.view, tile, slot, number)
    }

    pub(super) fn join(&self, address: u32) -> Result<Join, MapError> {
        (self.reads.join)(&self.view, address)
    }
}

/// Returns a join of a memory by its address.
fn join_of(memory: &MemoryView<'_>, address: u32) -> Result<Join, MapError> {
    let join = memory.join(address).ok_or(MapError::Content)?;
    let to_block = memory.block_at(join.to_way, join.to_cell);
    Ok(Join {
        at_cell: join.at_cell,
        to_way: join.to_way,
        to_cell: join.to_cell,
        to_block: to_block.ok_or(MapError::Content)?,
    })
}
