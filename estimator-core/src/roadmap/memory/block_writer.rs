//! The form of a block as bytes, written in shares: to write it at once takes longer than all else of
//! a cell.

use super::fusion::Known;
use super::work_block::WorkBlock;
use crate::roadmap::block_cells::{
    ALTITUDE_CELLS, ALTITUDE_UNITS_PER_CM, GRADE_UNITS_PER_PERCENT, SIGMA_CELLS,
    SIGMA_CODES_PER_OCTAVE, SIGMA_UNIT_PERCENT,
};
use crate::roadmap::record::checksum;
use core::task::Poll;
use heapless::Vec;
use libm::{log2f, roundf, sqrtf};

/// Most bytes of a block. Most have 250.
const BLOCK_BYTES: usize = 900;
/// Units of a place in the file, 10⁻⁷ degrees.
const PLACE_STEP: i32 = 10;
/// A turn, 10⁻⁷ degrees.
const TURN_E7: i64 = 3_600_000_000;

/// The bytes of a block.
type BlockBytes = Vec<u8, BLOCK_BYTES>;

/// What is written next.
#[derive(Clone, Copy, Debug, Default)]
enum Share {
    /// The header, the points and the altitudes.
    #[default]
    Place,
    /// The numbers of runs, the sigmas and the grades.
    Grades,
    /// The length and the checksum.
    End,
    /// Nothing more.
    Done,
}

/// Writes a block as bytes.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockWriter {
    /// Not on the stack, which is short.
    bytes: BlockBytes,
    /// Number of cells that are written.
    count: usize,
    share: Share,
}

impl BlockWriter {
    /// Begins with another block.
    pub(super) const fn begin(&mut self) {
        self.share = Share::Place;
    }

    /// Writes a share of a block, which stays as it is until the last one. Returns the bytes in the end,
    /// until another block begins; `None` if the block has no cells or no place, or does not fit.
    pub(super) fn write(&mut self, block: &WorkBlock) -> Poll<Option<&[u8]>> {
        let (written, next) = match self.share {
            Share::Place => (self.write_place(block), Share::Grades),
            Share::Grades => (self.write_grades(block), Share::End),
            Share::End => (self.write_end(), Share::Done),
            Share::Done => return Poll::Ready(Some(&self.bytes)),
        };
        if written.is_none() {
            self.begin();
            return Poll::Ready(None);
        }
        self.share = next;
        Poll::Pending
    }

    fn write_place(&mut self, block: &WorkBlock) -> Option<()> {
        let start = block.all_points().next()?;
        // Cells behind the last position have no place.
        let placed = block.all_points().last()?.cell - block.first_cell + 1;
        self.count = usize::try_from(placed).ok()?.min(block.cells.len());
        let cells = block.cells.get(..self.count)?;
        if cells.is_empty() || start.cell != block.first_cell {
            return None;
        }
        let out = &mut self.bytes;
        out.clear();
        let has_altitude = cells.iter().all(|cell| cell.altitude_m.is_some());
        let origin = [start.latitude_e7, start.longitude_e7].map(rounded_e7);
        append(out, &[0, 0, self.count as u8, has_altitude.into()])?;
        append(out, &block.way.to_le_bytes())?;
        append(out, &block.first_cell.to_le_bytes())?;
        append(out, &origin[0].to_le_bytes())?;
        append(out, &origin[1].to_le_bytes())?;
        append(out, &(block.all_points().count() as u16 - 1).to_le_bytes())?;
        put_points(out, block, origin)?;
        if has_altitude {
            put_altitudes(out, cells)?;
        }
        Some(())
    }

    fn write_grades(&mut self, block: &WorkBlock) -> Option<()> {
        let cells = block.cells.get(..self.count)?;
        let out = &mut self.bytes;
        // Not `chunk_by`, which can panic, as far as the compiler knows.
        let mut rest = cells;
        while let Some(first) = rest.first() {
            let same = rest.iter().take_while(|cell| cell.runs == first.runs);
            let count = same.count();
            put(out, first.runs.into())?;
            put(out, count as u32)?;
            rest = rest.get(count..)?;
        }
        for group in cells.chunks(SIGMA_CELLS) {
            append(out, &[sigma_code(group)])?;
        }
        let (mut before, mut step) = (0, 0);
        for (i, cell) in cells.iter().enumerate() {
            let grade = units(cell);
            let now = grade - before;
            put_signed(out, if i < 2 { now } else { now - step })?;
            (before, step) = (grade, now);
        }
        Some(())
    }

    fn write_end(&mut self) -> Option<()> {
        let length = u16::try_from(self.bytes.len() + 4).ok()?.to_le_bytes();
        *self.bytes.first_chunk_mut()? = length;
        let sum = checksum(&self.bytes).to_le_bytes();
        append(&mut self.bytes, &sum)
    }
}

/// Returns a grade in the unit of the file.
fn units(cell: &Known) -> i32 {
    roundf(cell.grade_percent * GRADE_UNITS_PER_PERCENT) as i32
}

fn put_points(out: &mut BlockBytes, block: &WorkBlock, origin: [i32; 2]) -> Option<()> {
    let (mut cell, mut place) = (block.first_cell, origin);
    for point in block.all_points().skip(1) {
        put(out, u16::try_from(point.cell - cell).ok()?.into())?;
        let next = [point.latitude_e7, point.longitude_e7].map(rounded_e7);
        for i in 0..2 {
            let by = short_way(i64::from(next[i]) - i64::from(place[i]));
            put_signed(out, (by / i64::from(PLACE_STEP)) as i32)?;
        }
        (cell, place) = (point.cell, next);
    }
    Some(())
}

/// Appends the altitude of the first cell and what the climb by the grades lacks at the end of each
/// stretch.
fn put_altitudes(out: &mut BlockBytes, cells: &[Known]) -> Option<()> {
    let wanted = |cell: &Known| roundf(cell.altitude_m.unwrap_or_default() * 100.0) as i32;
    let (first, rest) = cells.split_first()?;
    put_signed(out, wanted(first))?;
    let mut altitude = wanted(first) * ALTITUDE_UNITS_PER_CM;
    let mut before = units(first);
    for stretch in rest.chunks(ALTITUDE_CELLS) {
        let mut climb = 0;
        for cell in stretch {
            let now = units(cell);
            climb += before + now;
            before = now;
        }
        let missing = wanted(stretch.last()?) * ALTITUDE_UNITS_PER_CM - (altitude + climb);
        let correction_cm = (missing + ALTITUDE_UNITS_PER_CM / 2).div_euclid(ALTITUDE_UNITS_PER_CM);
        put_signed(out, correction_cm)?;
        altitude += climb + correction_cm * ALTITUDE_UNITS_PER_CM;
    }
    Some(())
}

/// Returns the code of the root mean square of sigmas.
fn sigma_code(cells: &[Known]) -> u8 {
    let sum: f32 = cells.iter().map(|cell| cell.variance).sum();
    let sigma = sqrtf(sum / cells.len() as f32);
    let code = log2f((sigma / SIGMA_UNIT_PERCENT).max(1.0)) * SIGMA_CODES_PER_OCTAVE;
    roundf(code).min(255.0) as u8
}

fn append(out: &mut BlockBytes, bytes: &[u8]) -> Option<()> {
    out.extend_from_slice(bytes).ok()
}

/// Appends a number in postcard's form: seven bits a byte, the lowest first.
fn put(out: &mut BlockBytes, mut number: u32) -> Option<()> {
    while number >= 0x80 {
        out.push(number as u8 | 0x80).ok()?;
        number >>= 7;
    }
    out.push(number as u8).ok()
}

/// Appends a signed number: its sign is the lowest bit.
fn put_signed(out: &mut BlockBytes, number: i32) -> Option<()> {
    put(out, ((number << 1) ^ (number >> 31)).cast_unsigned())
}

/// Returns a coordinate in 10⁻⁷ degrees, as the file has it.
fn rounded_e7(angle_e7: i32) -> i32 {
    angle_e7
        .saturating_add(PLACE_STEP / 2)
        .div_euclid(PLACE_STEP)
        * PLACE_STEP
}

/// Returns a difference of longitudes the short way round.
const fn short_way(east_e7: i64) -> i64 {
    if east_e7 > TURN_E7 / 2 {
        east_e7 - TURN_E7
    } else if east_e7 < -TURN_E7 / 2 {
        east_e7 + TURN_E7
    } else {
        east_e7
    }
}
