//! A packed map: its header, ways, joins and index.

use super::block::Block;
use super::map_error::MapError;
use super::memory::{MemoryView, StoredWay};
use super::record::{Numbers, record, sized_record};
use super::stored_roads::StoredRoads;

/// First bytes of a packed map.
pub const MAGIC: [u8; 4] = *b"rgm\x1a";
/// Version of the format.
pub const VERSION: u32 = 1;
/// Bytes of the header.
pub const HEADER: usize = 64;
/// Bytes of a way before its name.
pub const WAY_HEADER: usize = 28;

/// Length of a cell, mm.
const CELL_MM: u32 = 2_500;

/// A map in the form that the vehicle reads, in place.
#[derive(Clone, Copy, Debug)]
pub struct PackedMap<'m> {
    pub(super) bytes: &'m [u8],
    first_way: u32,
    ways: u32,
    first_block: u32,
    blocks_end: u32,
    pub(super) first_page: u32,
    pub(super) pages: u32,
    /// The road memory that is read instead of the bytes.
    pub(super) memory: Option<StoredRoads<'m>>,
}

/// Direction in which a way is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WayDirection {
    /// In the order of the points that its name stands for.
    Forward,
    /// Against it.
    Backward,
    /// The map is of a single road.
    SingleRoad,
}

/// A way: a line in one direction of travel.
#[derive(Clone, Copy, Debug)]
pub struct MapWay<'m> {
    /// Offset of its record, by which blocks and joins name it.
    pub offset: u32,
    name: &'m [u8],
    /// Direction in which it is driven.
    pub direction: WayDirection,
    /// Number of its first cell.
    pub first_cell: i32,
    /// Number of its last cell.
    pub last_cell: i32,
    /// Offset of its first block.
    pub first_block: u32,
    /// End of its last block.
    pub blocks_end: u32,
    pub(super) first_join: u32,
    pub(super) joins: u32,
    next: u32,
}

impl<'m> PackedMap<'m> {
    /// Opens the map at the start of these bytes. What follows it is ignored.
    ///
    /// Only the header is read, so that a map of a country is opened as fast as one of a road.
    ///
    /// # Errors
    /// Returns why these bytes are no map that this release can read.
    pub fn open(bytes: &'m [u8]) -> Result<Self, MapError> {
        if !bytes.starts_with(&MAGIC) {
            return Err(MapError::Magic);
        }
        let mut numbers = Numbers::from(bytes, MAGIC.len())?;
        let version = numbers.u32().map_err(|_| MapError::CutOff)?;
        if version != VERSION {
            return Err(MapError::Version(version));
        }
        let mut numbers = Numbers::from(record(bytes, 0, HEADER)?, 8)?;
        let length = numbers.u32()?;
        let bytes = usize::try_from(length)
            .ok()
            .and_then(|length| bytes.get(..length))
            .ok_or(MapError::CutOff)?;
        if numbers.u32()? != CELL_MM {
            return Err(MapError::Content);
        }
        Ok(Self {
            bytes,
            first_way: numbers.u32()?,
            ways: numbers.u32()?,
            first_block: numbers.u32()?,
            blocks_end: numbers.u32()?,
            first_page: numbers.u32()?,
            pages: numbers.u32()?,
            memory: None,
        })
    }

    /// Returns the roads of a memory as a map.
    #[must_use]
    pub const fn of_memory(memory: MemoryView<'m>) -> Self {
        Self {
            bytes: &[],
            first_way: 0,
            ways: u32::MAX,
            first_block: 0,
            blocks_end: 0,
            first_page: 0,
            pages: 0,
            memory: Some(StoredRoads::new(memory)),
        }
    }

    /// Returns the number of its bytes.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Returns whether it has no ways.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.ways == 0
    }

    /// Returns its ways. After an error there are no more.
    #[must_use]
    pub const fn ways(&self) -> Ways<'m> {
        Ways {
            map: *self,
            next: self.first_way,
            left: self.ways,
        }
    }

    /// Returns the way whose record is at an offset.
    ///
    /// # Errors
    /// Returns an error if there is none, or if it is damaged.
    pub fn way(&self, offset: u32) -> Result<MapWay<'m>, MapError> {
        if let Some(memory) = &self.memory {
            return memory.way(offset).map(MapWay::of_memory);
        }
        let content = sized_record(self.bytes, offset)?;
        let mut numbers = Numbers(content);
        let length = numbers.u16()?;
        let direction = match numbers.u8()? {
            0 => WayDirection::Forward,
            1 => WayDirection::Backward,
            2 => WayDirection::SingleRoad,
            _ => return Err(MapError::Content),
        };
        let name_bytes = numbers.u8()?;
        Ok(MapWay {
            offset,
            direction,
            first_cell: numbers.i32()?,
            last_cell: numbers.i32()?,
            first_block: numbers.u32()?,
            blocks_end: numbers.u32()?,
            first_join: numbers.u32()?,
            joins: numbers.u32()?,
            name: numbers.bytes(name_bytes.into())?,
            next: offset.checked_add(length.into()).ok_or(MapError::Content)?,
        })
    }

    /// Returns the block at an offset.
    ///
    /// # Errors
    /// Returns an error if there is none, or if it is damaged.
    pub fn block(&self, offset: u32) -> Result<Block<'m>, MapError> {
        if let Some(memory) = &self.memory {
            return memory.block(offset, true);
        }
        if !(self.first_block..self.blocks_end).contains(&offset) {
            return Err(MapError::Content);
        }
        Block::read(self.bytes, offset)
    }

    /// Returns the block at an offset, which was read before.
    pub(super) fn block_again(&self, offset: u32) -> Result<Block<'m>, MapError> {
        match &self.memory {
            Some(memory) => memory.block(offset, false),
            None => self.block(offset),
        }
    }

    /// Returns the blocks of a way, in the order of their cells. After an error there are no more.
    #[must_use]
    pub const fn blocks(&self, way: &MapWay<'m>) -> Blocks<'m> {
        self.blocks_from(way, way.first_block)
    }

    /// Returns a block of a way, given by its offset, and those behind it.
    #[must_use]
    pub const fn blocks_from(&self, way: &MapWay<'m>, block: u32) -> Blocks<'m> {
        Blocks {
            map: *self,
            next: block,
            end: way.blocks_end,
        }
    }
}

impl<'m> MapWay<'m> {
    const fn of_memory(way: StoredWay) -> Self {
        Self {
            offset: way.address,
            name: &[],
            direction: WayDirection::Forward,
            first_cell: way.first_cell,
            last_cell: way.last_cell,
            first_block: way.address,
            blocks_end: way.blocks_end,
            first_join: way.first_join,
            joins: way.joins,
            next: way.blocks_end,
        }
    }

    /// Returns its name, not necessarily unique: both directions have the same.
    ///
    /// # Errors
    /// Returns an error if it is no text.
    pub const fn name(&self) -> Result<&'m str, MapError> {
        // Not in `PackedMap::way`: a vehicle follows ways without their names.
        match core::str::from_utf8(self.name) {
            Ok(name) => Ok(name),
            Err(_) => Err(MapError::Content),
        }
    }

    /// Returns whether a cell is within its ends.
    #[must_use]
    pub const fn contains(&self, cell: i32) -> bool {
        self.first_cell <= cell && cell <= self.last_cell
    }
}

/// The ways of a map.
#[derive(Clone, Debug)]
pub struct Ways<'m> {
    map: PackedMap<'m>,
    next: u32,
    left: u32,
}

impl<'m> Iterator for Ways<'m> {
    type Item = Result<MapWay<'m>, MapError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        let way = match &self.map.memory {
            Some(memory) => Ok(MapWay::of_memory(memory.way_from(self.next)?)),
            None => self.map.way(self.next),
        };
        match &way {
            Ok(way) => self.next = way.next,
            Err(_) => self.left = 0,
        }
        Some(way)
    }
}

/// The blocks of a way.
#[derive(Clone, Debug)]
pub struct Blocks<'m> {
    map: PackedMap<'m>,
    next: u32,
    end: u32,
}

impl<'m> Iterator for Blocks<'m> {
    type Item = Result<Block<'m>, MapError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.next >= self.end {
            return None;
        }
        let block = self.map.block(self.next);
        self.next = match &block {
            Ok(block) => block.next,
            Err(_) => self.end,
        };
        Some(block)
    }
}
