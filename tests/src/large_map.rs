//! A packed map of a country: the roads of a small map, again and again beside each other.

use estimator_core::roadmap::format::{HEADER, INDEX_ENTRIES, INDEX_PAGE, JOIN, checksum};
use std::ops::Range;

/// Distance from one copy to the next, in tiles of the index: north, and east.
const STEP_TILES: (i32, i32) = (10, 8);
/// Size of a tile, 10⁻⁷ degrees.
const TILE_E7: i32 = 1 << 16;

/// Returns a map that has the roads of another one so often, in a square around the place of the
/// first. `map` must be small enough to fit into a step.
///
/// # Panics
/// Panics if `map` is no packed map, or the result is larger than 4 GiB.
#[must_use]
pub fn repeated(map: &[u8], copies: u32) -> Vec<u8> {
    let parts = Parts::of(map);
    let side = copies.isqrt().max(1) as i32;
    let mut out = map[..HEADER].to_vec();
    let count = copies as usize;
    let joins = HEADER + count * parts.ways.len();
    let blocks = joins + count * parts.joins.len();
    let shifts: Vec<Shift> = (0..copies as i32)
        .map(|copy| Shift {
            way: copy * parts.ways.len() as i32,
            join: (joins - parts.joins.start) as i32 + copy * parts.joins.len() as i32,
            block: (blocks - parts.blocks.start) as i32 + copy * parts.blocks.len() as i32,
            tiles: (
                STEP_TILES.0 * (copy / side - side / 2),
                STEP_TILES.1 * (copy % side - side / 2),
            ),
        })
        .collect();
    for shift in &shifts {
        parts.copy_ways(map, shift, &mut out);
    }
    for shift in &shifts {
        parts.copy_joins(map, shift, &mut out);
    }
    for shift in &shifts {
        parts.copy_blocks(map, shift, &mut out);
    }
    let end = out.len();
    let mut entries: Vec<(u32, u32)> = Vec::new();
    for shift in &shifts {
        entries.extend(parts.index.iter().map(|(tile, block)| {
            let tile = moved(*tile, (shift.tiles.0 << 16) + shift.tiles.1);
            (tile, moved(*block, shift.block))
        }));
    }
    entries.sort_unstable();
    for page in entries.chunks(INDEX_ENTRIES) {
        let numbers = page.iter().flat_map(|(tile, block)| [*tile, *block]);
        let mut page_bytes: Vec<u8> = numbers.flat_map(u32::to_le_bytes).collect();
        page_bytes.resize(INDEX_PAGE - 8, 0);
        page_bytes.extend((page.len() as u32).to_le_bytes());
        page_bytes.extend([0; 4]);
        out.extend(sealed(page_bytes));
    }
    let length = u32::try_from(out.len()).expect("a map has at most 4 GiB");
    let numbers = [
        (8, length),
        (20, read(map, 20) * copies),
        (24, blocks as u32),
        (28, end as u32),
        (32, end as u32),
        (36, entries.len().div_ceil(INDEX_ENTRIES) as u32),
    ];
    let mut header = out[..HEADER].to_vec();
    for (at, number) in numbers {
        put(&mut header, at, number);
    }
    out[..HEADER].copy_from_slice(&sealed(header));
    out
}

/// By how much the offsets and the places of a copy differ.
struct Shift {
    way: i32,
    join: i32,
    block: i32,
    /// Tiles north and east.
    tiles: (i32, i32),
}

/// The parts of a map, and the entries of its index.
struct Parts {
    ways: Range<usize>,
    joins: Range<usize>,
    blocks: Range<usize>,
    index: Vec<(u32, u32)>,
}

impl Parts {
    fn of(map: &[u8]) -> Self {
        let offset = |at| read(map, at) as usize;
        let mut ways_end = offset(16);
        for _ in 0..read(map, 20) {
            ways_end += length(map, ways_end);
        }
        let blocks = offset(24)..offset(28);
        let pages = map[offset(32)..].chunks_exact(INDEX_PAGE);
        let index = pages.take(offset(36)).flat_map(|page| {
            let entries = read(page, INDEX_PAGE - 8) as usize;
            (0..entries).map(|entry| (read(page, 8 * entry), read(page, 8 * entry + 4)))
        });
        Self {
            ways: offset(16)..ways_end,
            joins: ways_end..blocks.start,
            index: index.collect(),
            blocks,
        }
    }

    fn copy_ways(&self, map: &[u8], shift: &Shift, out: &mut Vec<u8>) {
        let mut at = self.ways.start;
        while at < self.ways.end {
            let mut record = map[at..at + length(map, at)].to_vec();
            at += record.len();
            add(&mut record, 12, shift.block);
            add(&mut record, 16, shift.block);
            add(&mut record, 20, shift.join);
            out.extend(sealed(record));
        }
    }

    fn copy_joins(&self, map: &[u8], shift: &Shift, out: &mut Vec<u8>) {
        for join in map[self.joins.clone()].chunks_exact(JOIN) {
            let mut record = join.to_vec();
            add(&mut record, 4, shift.way);
            add(&mut record, 12, shift.block);
            out.extend(sealed(record));
        }
    }

    fn copy_blocks(&self, map: &[u8], shift: &Shift, out: &mut Vec<u8>) {
        let mut at = self.blocks.start;
        while at < self.blocks.end {
            let mut record = map[at..at + length(map, at)].to_vec();
            at += record.len();
            add(&mut record, 4, shift.way);
            add(&mut record, 12, shift.tiles.0 * TILE_E7);
            add(&mut record, 16, shift.tiles.1 * TILE_E7);
            out.extend(sealed(record));
        }
    }
}

/// Returns the length of the record at an offset.
fn length(map: &[u8], at: usize) -> usize {
    usize::from(u16::from_le_bytes([map[at], map[at + 1]]))
}

fn read(bytes: &[u8], at: usize) -> u32 {
    let number = bytes[at..].first_chunk().expect("four bytes");
    u32::from_le_bytes(*number)
}

fn put(bytes: &mut [u8], at: usize, number: u32) {
    bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
}

fn add(bytes: &mut [u8], at: usize, shift: i32) {
    put(bytes, at, moved(read(bytes, at), shift));
}

fn moved(number: u32, by: i32) -> u32 {
    number.wrapping_add_signed(by)
}

/// Writes the checksum of a record to its last four bytes.
fn sealed(mut record: Vec<u8>) -> Vec<u8> {
    let end = record.len() - 4;
    let sum = checksum(&record[..end]);
    put(&mut record, end, sum);
    record
}
