//! A page: the content of one sector. `docs/road-memory.md` specifies it.

use super::address::{PageKey, block_number};
use super::flash::SECTOR_BYTES;
use crate::roadmap::block::Block;
use crate::roadmap::map_error::MapError;
use crate::roadmap::record::{Numbers, checksum};
use crate::roadmap::tile::{Looked, Tile, TileBounds};
use heapless::Vec;

/// First bytes of a page.
pub const MAGIC: [u8; 4] = *b"rgm\x1b";
/// Version of the format.
pub const VERSION: u16 = 1;
/// Bytes before the joins.
pub const PAGE_HEADER: usize = 40;
/// Bytes of a join.
pub const STORED_JOIN: usize = 16;
/// Most joins of a page.
pub const MOST_JOINS: usize = 16;
/// Most blocks of a page.
pub const MOST_BLOCKS: u8 = 64;
/// Rows of tiles that a block can reach from its first cell: it is shorter than a row is high.
const ROWS_OF_BLOCK: u16 = 1;
/// Bytes for joins and blocks.
pub(super) const BODY_BYTES: usize = SECTOR_BYTES - PAGE_HEADER - 4;

/// What the first bytes of a page say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PageHeader {
    /// Times that the sector has been erased.
    pub erases: u32,
    /// Number of the write: of two copies of a page, the one with the higher number counts.
    pub sequence: u32,
    /// Which page it is.
    pub key: PageKey,
    /// Number of the drive that changed it last.
    pub last_drive: u32,
    /// Number of drives that changed it.
    pub drives: u16,
    /// Number of its joins, and of its blocks.
    pub joins: u8,
    pub(super) blocks: u8,
    /// Where its blocks are.
    pub bounds: TileBounds,
    /// Bytes before the checksum.
    pub(super) length: u16,
}

/// A place where one way can be left for another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredJoin {
    /// Number of the first block of the way that is left, within this page.
    pub at_way: u8,
    /// Cell at which it is left.
    pub at_cell: i32,
    /// Address of the way that is entered.
    pub to_way: u32,
    /// Cell at which it is entered.
    pub to_cell: i32,
}

/// A page, read in place.
#[derive(Clone, Copy, Debug)]
pub struct Page<'m> {
    /// What its first bytes say.
    pub header: PageHeader,
    joins: &'m [u8],
    blocks: &'m [u8],
}

/// What is wrong with a sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoPage {
    /// Nothing was written.
    Blank,
    /// Another release wrote it.
    OtherVersion,
    /// It is damaged, or was not written to its end.
    Damaged,
}

impl<'m> Page<'m> {
    /// Checks a sector, and reads its page.
    pub(super) fn check(sector: &'m [u8]) -> Result<Self, NoPage> {
        if sector.iter().take(PAGE_HEADER).all(|byte| *byte == 0xff) {
            return Err(NoPage::Blank);
        }
        if !sector.starts_with(&MAGIC) {
            return Err(NoPage::Damaged);
        }
        let number = |at| Numbers::from(sector, at)?.u16();
        if number(4) != Ok(VERSION) {
            return Err(NoPage::OtherVersion);
        }
        let length = number(6).unwrap_or(0).into();
        let content = sector.get(..length).ok_or(NoPage::Damaged)?;
        let written = Numbers::from(sector, length).and_then(|mut numbers| numbers.u32());
        if written != Ok(checksum(content)) {
            return Err(NoPage::Damaged);
        }
        Self::open(sector).map_err(|_| NoPage::Damaged)
    }

    /// Reads the page of a sector that was checked before.
    pub(super) fn open(sector: &'m [u8]) -> Result<Self, MapError> {
        let mut numbers = Numbers::from(sector, 6)?;
        let length = numbers.u16()?;
        let header = PageHeader {
            length,
            erases: numbers.u32()?,
            sequence: numbers.u32()?,
            key: PageKey {
                slot: numbers.u16()?,
                generation: numbers.u16()?,
            },
            last_drive: numbers.u32()?,
            drives: numbers.u16()?,
            joins: numbers.u8()?,
            blocks: numbers.u8()?,
            bounds: TileBounds {
                least: [numbers.u16()?, numbers.u16()?],
                most: [numbers.u16()?, numbers.u16()?],
            },
        };
        let body = sector
            .get(PAGE_HEADER..length.into())
            .ok_or(MapError::Content)?;
        let (joins, blocks) = body
            .split_at_checked(usize::from(header.joins) * STORED_JOIN)
            .ok_or(MapError::Content)?;
        Ok(Self {
            header,
            joins,
            blocks,
        })
    }

    /// Returns the bytes of its blocks.
    pub(super) const fn block_bytes(&self) -> &'m [u8] {
        self.blocks
    }

    /// Returns one of its joins. They are in the order of ways and cells.
    #[must_use]
    pub fn join(&self, index: u8) -> Option<StoredJoin> {
        let start = usize::from(index) * STORED_JOIN;
        let mut numbers = Numbers(self.joins.get(start..start + STORED_JOIN)?);
        Some(StoredJoin {
            at_way: numbers.u32().ok()? as u8,
            at_cell: numbers.i32().ok()?,
            to_way: numbers.u32().ok()?,
            to_cell: numbers.i32().ok()?,
        })
    }

    /// Returns a block, with its checksum checked if asked for.
    ///
    /// # Errors
    /// Returns an error if there is none, or if it cannot be.
    pub fn block(&self, number: u8, is_checked: bool) -> Result<Block<'m>, MapError> {
        let address = self.header.key.block(number);
        block_in(self.blocks, number, address, is_checked)
    }

    /// Looks for a block with a cell in a tile, from a block on, until one has to be read. Returns what
    /// it found, and the block to go on from.
    pub(super) fn look(&self, tile: Tile, first: u8) -> (Looked, u8) {
        let heads = heads_of_blocks(self.blocks, first);
        for head in heads.take_while(|head| head.number < self.header.blocks) {
            let number = head.number;
            let start = Tile::of(head.start_e7.0, head.start_e7.1);
            let found = Looked::Block(self.header.key.block(number));
            let next = number + 1;
            if start == tile {
                return (found, next);
            }
            if start.row().abs_diff(tile.row()) <= ROWS_OF_BLOCK {
                return match self.block(number, false) {
                    Ok(block) if bounds_of(&block).contains(tile) => (found, next),
                    Ok(_) => (Looked::NotYet, next),
                    Err(_) => (Looked::End, next),
                };
            }
        }
        (Looked::End, 0)
    }

    /// Goes over the blocks of a way, given by its first one.
    pub(super) fn heads_of_way(
        &self,
        first: u8,
        way: u32,
    ) -> impl Iterator<Item = BlockHead> + use<'m> {
        let blocks = self.header.blocks;
        heads_of_blocks(self.blocks, first)
            .take_while(move |head| head.number < blocks && head.way == way)
    }

    /// Returns the last block of a way, given by its first one.
    pub(super) fn last_of_way(&self, first: u8, way: u32) -> Option<Block<'m>> {
        let last = self.heads_of_way(first, way).last()?;
        self.block(last.number, false).ok()
    }

    /// Returns the number of the first block of the way that each join leaves.
    pub(super) fn ways_of_joins(&self) -> impl Iterator<Item = u8> + use<'m> {
        let (joins, _) = self.joins.as_chunks::<STORED_JOIN>();
        joins.iter().map(|join| join[0])
    }

    /// Returns its blocks.
    pub fn blocks(&self) -> impl Iterator<Item = Block<'m>> + use<'m> {
        let page = *self;
        (0..page.header.blocks).map_while(move |number| page.block(number, false).ok())
    }
}

/// Returns where a block begins in the bytes of all blocks of a page.
pub(super) fn block_start(blocks: &[u8], number: u8) -> Option<usize> {
    (0..number).try_fold(0_usize, |start, _| {
        let length = blocks.get(start..)?.first_chunk::<2>()?;
        let length = u16::from_le_bytes(*length).max(1);
        Some(start + usize::from(length))
    })
}

/// The first fields of a block. They decide whether the rest is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockHead {
    /// Its number within the page.
    pub(super) number: u8,
    /// Address of its way.
    pub(super) way: u32,
    pub(super) first_cell: i32,
    count: u8,
    /// Latitude and longitude of its first cell.
    start_e7: (i32, i32),
}

impl BlockHead {
    fn read(number: u8, bytes: &[u8]) -> Option<Self> {
        // As words: a page has many.
        let (words, _) = bytes.first_chunk::<20>()?.as_chunks::<4>();
        let [kind, way, first_cell, latitude, longitude] = *words.first_chunk()?;
        Some(Self {
            number,
            count: kind[2],
            way: u32::from_le_bytes(way),
            first_cell: i32::from_le_bytes(first_cell),
            start_e7: (i32::from_le_bytes(latitude), i32::from_le_bytes(longitude)),
        })
    }

    /// Returns the number of its last cell.
    pub(super) const fn last_cell(&self) -> i32 {
        self.first_cell.saturating_add(self.count as i32 - 1)
    }
}

/// Goes over the blocks in the bytes of all blocks of a page from one on, without reading them whole.
pub(super) fn heads_of_blocks(blocks: &[u8], first: u8) -> impl Iterator<Item = BlockHead> {
    let start = block_start(blocks, first);
    let mut rest = start.and_then(|start| blocks.get(start..));
    (first..MOST_BLOCKS).map_while(move |number| {
        let bytes = rest?;
        let length = u16::from_le_bytes(*bytes.first_chunk()?).max(1);
        rest = bytes.get(length.into()..);
        BlockHead::read(number, bytes)
    })
}

/// Reads a block in the bytes of all blocks of a page.
pub(super) fn block_in(
    blocks: &[u8],
    number: u8,
    address: u32,
    is_checked: bool,
) -> Result<Block<'_>, MapError> {
    let start = block_start(blocks, number).ok_or(MapError::Content)?;
    let bytes = blocks.get(start..).ok_or(MapError::Content)?;
    let mut block = if is_checked {
        Block::read(bytes, 0)?
    } else {
        Block::read_again(bytes)?
    };
    if block_number(block.way) > number || PageKey::of(block.way) != PageKey::of(address) {
        return Err(MapError::Content);
    }
    block.offset = address;
    block.next = address + 1;
    Ok(block)
}

/// Returns the header and the joins of a page as bytes.
pub(super) fn head_bytes(
    header: &PageHeader,
    joins: &[StoredJoin],
) -> Option<Vec<u8, { PAGE_HEADER + MOST_JOINS * STORED_JOIN }>> {
    let mut out = Vec::new();
    let mut put = |bytes: &[u8]| out.extend_from_slice(bytes).ok();
    put(&MAGIC)?;
    put(&VERSION.to_le_bytes())?;
    put(&header.length.to_le_bytes())?;
    put(&header.erases.to_le_bytes())?;
    put(&header.sequence.to_le_bytes())?;
    put(&header.key.slot.to_le_bytes())?;
    put(&header.key.generation.to_le_bytes())?;
    put(&header.last_drive.to_le_bytes())?;
    put(&header.drives.to_le_bytes())?;
    put(&[header.joins, header.blocks])?;
    for number in header.bounds.least.iter().chain(&header.bounds.most) {
        put(&number.to_le_bytes())?;
    }
    put(&[0; 4])?;
    for join in joins {
        put(&u32::from(join.at_way).to_le_bytes())?;
        put(&join.at_cell.to_le_bytes())?;
        put(&join.to_way.to_le_bytes())?;
        put(&join.to_cell.to_le_bytes())?;
    }
    Some(out)
}

/// Returns the tiles that a block lies in.
pub(super) fn bounds_of(block: &Block<'_>) -> TileBounds {
    let mut bounds = TileBounds::default();
    let mut points = block
        .points()
        .map(|point| (point.latitude_e7, point.longitude_e7));
    if let Some(first) = points.next() {
        let ends = points.fold((first, first), |(least, most), (latitude, longitude)| {
            (
                (latitude.min(least.0), longitude.min(least.1)),
                (latitude.max(most.0), longitude.max(most.1)),
            )
        });
        // Tiles are in the order of their places.
        for (latitude, longitude) in [ends.0, ends.1] {
            bounds.include(Tile::of(latitude, longitude));
        }
    }
    bounds
}
