//! A packed map, written byte by byte from the tables of docs/map-grade.md: no code of the core's
//! writer or reader is in it.

use std::collections::BTreeSet;
use test_kit::varint::{signed, unsigned};

/// Cells of a full block.
const BLOCK_CELLS: i32 = 128;
const PAGE_ENTRIES: usize = 31;
const PAGE_BYTES: usize = 256;
/// Change of a place from one cell to the next: 2.5 m in 10⁻⁷ degrees.
pub const CELL_E7: i32 = 225;
/// Code of a sigma of 0.001 % · 2^(100 / 16).
const SIGMA_CODE: u8 = 100;
/// 180 degrees, 10⁻⁷ degrees.
const HALF_TURN_E7: i64 = 1_800_000_000;

/// A straight way of one grade.
#[derive(Clone, Copy, Debug)]
pub struct TestWay {
    pub name: &'static str,
    pub cells: i32,
    /// Grade in units of 0.005 %.
    pub grade: i32,
    /// Place of its first cell, 10⁻⁷ degrees.
    pub begin_e7: [i32; 2],
    /// Cells to the north and to the east for each cell, in tenths.
    pub heading: [i32; 2],
    /// Ways that leave it: cell, number of the way that is entered at its first cell.
    pub joins: &'static [(i32, usize)],
    /// Cells that no block has: the first one, and the one behind the last.
    pub gap: Option<(i32, i32)>,
}

impl TestWay {
    /// Returns the place of a cell, 10⁻⁷ degrees.
    pub fn place_e7(&self, cell: i32) -> (i32, i32) {
        let [north, east] = self.way_e7(0, cell);
        let longitude = i64::from(self.begin_e7[1]) + i64::from(east);
        let round = (longitude + HALF_TURN_E7).rem_euclid(2 * HALF_TURN_E7) - HALF_TURN_E7;
        (self.begin_e7[0] + north, round as i32)
    }

    /// Returns the way from one cell to another, 10⁻⁷ degrees.
    fn way_e7(&self, from: i32, to: i32) -> [i32; 2] {
        self.heading
            .map(|heading| to * heading * CELL_E7 / 10 - from * heading * CELL_E7 / 10)
    }

    /// Returns the first cell and the number of cells of each block.
    fn blocks(&self) -> Vec<(i32, i32)> {
        let (gap, behind) = self.gap.unwrap_or((self.cells, self.cells));
        let blocks = |begin: i32, end: i32| {
            let firsts = (begin..end).step_by(BLOCK_CELLS as usize);
            firsts.map(move |first| (first, BLOCK_CELLS.min(end - first)))
        };
        blocks(0, gap).chain(blocks(behind, self.cells)).collect()
    }
}

/// CRC-32 bit by bit: polynomial 0x04C11DB7, reflected.
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc: u32, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

/// Returns a map with other bytes in a record, and with the checksum that belongs to them. `length` is
/// that of the record.
pub fn with_bytes(map: &[u8], record: usize, length: usize, at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut map = map.to_vec();
    map[record + at..record + at + bytes.len()].copy_from_slice(bytes);
    let end = record + length - 4;
    let checksum = crc32(&map[record..end]).to_le_bytes();
    map[end..end + 4].copy_from_slice(&checksum);
    map
}

/// Returns the length of a way or a block, which it begins with.
pub fn length_of(map: &[u8], record: usize) -> usize {
    u16::from_le_bytes([map[record], map[record + 1]]).into()
}

fn with_checksum(mut record: Vec<u8>) -> Vec<u8> {
    record.extend(crc32(&record).to_le_bytes());
    record
}

/// Returns a block without its checksum and with its length.
fn block(way: &TestWay, offset_of_way: u32, first: i32, count: i32) -> Vec<u8> {
    let mut body = vec![count as u8, 0];
    body.extend(offset_of_way.to_le_bytes());
    body.extend(first.to_le_bytes());
    let (latitude, longitude) = way.place_e7(first);
    body.extend(latitude.to_le_bytes());
    body.extend(longitude.to_le_bytes());
    body.extend(1_u16.to_le_bytes());
    // The last point: at the last cell, or at the first one of the next block.
    let last = (first + count).min(way.cells - 1);
    let [north, east] = way.way_e7(first, last);
    unsigned(&mut body, (last - first) as u32);
    signed(&mut body, north / 10);
    signed(&mut body, east / 10);
    unsigned(&mut body, 3_u32);
    unsigned(&mut body, count as u32);
    body.extend(vec![SIGMA_CODE; (count as usize).div_ceil(16)]);
    signed(&mut body, way.grade);
    (1..count).for_each(|_| signed(&mut body, 0));
    let mut record = (body.len() as u16 + 6).to_le_bytes().to_vec();
    record.extend(body);
    with_checksum(record)
}

/// Lengths of the records before the blocks are fixed by names and joins.
fn way_length(way: &TestWay) -> u32 {
    28 + way.name.len() as u32 + 4
}

/// Returns the file of a map of these ways.
pub fn packed(ways: &[TestWay]) -> Vec<u8> {
    let mut ways_at = Vec::new();
    let mut at = 64;
    for way in ways {
        ways_at.push(at);
        at += way_length(way);
    }
    let first_join = at;
    let joins: usize = ways.iter().map(|way| way.joins.len()).sum();
    let first_block = first_join + 20 * joins as u32;
    let mut blocks = Vec::new();
    let mut blocks_at = Vec::new();
    let mut tiles = BTreeSet::new();
    for (way, way_at) in ways.iter().zip(&ways_at) {
        let begin = first_block + blocks.len() as u32;
        for (first, count) in way.blocks() {
            let offset = first_block + blocks.len() as u32;
            blocks.extend(block(way, *way_at, first, count));
            for cell in first..first + count {
                tiles.insert((tile(way.place_e7(cell)), offset));
            }
        }
        blocks_at.push((begin, first_block + blocks.len() as u32));
    }
    let first_page = first_block + blocks.len() as u32;
    let mut body = Vec::new();
    let mut join_at = first_join;
    for ((number, way), (begin, end)) in (0_u8..).zip(ways).zip(&blocks_at) {
        let mut record = (way_length(way) as u16).to_le_bytes().to_vec();
        record.extend([number % 3, way.name.len() as u8]);
        record.extend(0_i32.to_le_bytes());
        record.extend((way.cells - 1).to_le_bytes());
        for number in [*begin, *end, join_at, way.joins.len() as u32] {
            record.extend(number.to_le_bytes());
        }
        record.extend(way.name.bytes());
        body.extend(with_checksum(record));
        join_at += 20 * way.joins.len() as u32;
    }
    for (cell, to) in ways.iter().flat_map(|way| way.joins) {
        let mut record = cell.to_le_bytes().to_vec();
        record.extend(ways_at[*to].to_le_bytes());
        record.extend(0_i32.to_le_bytes());
        record.extend(blocks_at[*to].0.to_le_bytes());
        body.extend(with_checksum(record));
    }
    body.extend(blocks);
    let tiles: Vec<(u32, u32)> = tiles.into_iter().collect();
    let pages = tiles.chunks(PAGE_ENTRIES);
    let page_count = pages.len() as u32;
    for entries in pages {
        let mut page = Vec::new();
        for (key, offset) in entries {
            page.extend(key.to_le_bytes());
            page.extend(offset.to_le_bytes());
        }
        page.resize(PAGE_BYTES - 8, 0);
        page.extend((entries.len() as u32).to_le_bytes());
        body.extend(with_checksum(page));
    }
    let mut header = b"rgm\x1a".to_vec();
    let length = 64 + body.len() as u32;
    for number in [
        1,
        length,
        2_500,
        64,
        ways.len() as u32,
        first_block,
        first_page,
        first_page,
        page_count,
    ] {
        header.extend(number.to_le_bytes());
    }
    header.resize(60, 0);
    [with_checksum(header), body].concat()
}

/// Returns the number of the tile of a place.
fn tile((latitude_e7, longitude_e7): (i32, i32)) -> u32 {
    let upper = |angle: i32| (angle as u32 ^ 0x8000_0000) >> 16;
    upper(latitude_e7) << 16 | upper(longitude_e7)
}
