//! The block that is being changed, cell by cell, and its form as bytes.

use super::fusion::Known;
use crate::roadmap::block::{
    ALTITUDE_CELLS, ALTITUDE_UNITS_PER_CM, Block, GRADE_UNITS_PER_PERCENT, MOST_CELLS, MapPoint,
    SIGMA_CELLS, SIGMA_CODES_PER_OCTAVE, SIGMA_UNIT_PERCENT,
};
use crate::roadmap::record::checksum;
use heapless::Vec;
use libm::{log2f, roundf, sqrtf};
use serde::Serialize;

/// Cells from one point of the plan view to the next: 20 m. The chord of a bend of 50 m radius is
/// 1 m beside it.
pub(super) const POINT_CELLS: i32 = 8;
/// Most points of a block: those of a map may be closer.
const MOST_POINTS: usize = 34;
/// Most bytes of a block. Most have 250.
pub(super) const BLOCK_BYTES: usize = 900;
/// Units of a place in the file, 10⁻⁷ degrees.
const PLACE_STEP: i32 = 10;
/// A turn, 10⁻⁷ degrees.
const TURN_E7: i64 = 3_600_000_000;

/// The bytes of a block.
pub(super) type BlockBytes = Vec<u8, BLOCK_BYTES>;

/// A block in RAM.
#[derive(Clone, Debug, Default)]
pub(super) struct WorkBlock {
    /// Address of the way.
    pub(super) way: u32,
    /// Number of the block in its page.
    pub(super) number: u8,
    pub(super) first_cell: i32,
    pub(super) cells: Vec<Known, MOST_CELLS>,
    points: Vec<MapPoint, MOST_POINTS>,
    /// The last cell with a position.
    latest: Option<MapPoint>,
    /// Whether it differs from the one in the page.
    pub(super) is_changed: bool,
}

impl WorkBlock {
    /// Becomes an empty block.
    pub(super) fn begin(&mut self, way: u32, number: u8, first_cell: i32) {
        self.way = way;
        self.number = number;
        self.first_cell = first_cell;
        self.cells.clear();
        self.points.clear();
        self.latest = None;
        self.is_changed = false;
    }

    /// Becomes a copy of a block. Returns false if it cannot be read whole.
    pub(super) fn load(&mut self, block: &Block<'_>, number: u8) -> bool {
        self.begin(block.way, number, block.first_cell);
        for point in block.points() {
            if self.points.push(point).is_err() {
                return false;
            }
        }
        if let Ok(cells) = block.cells() {
            self.cells
                .extend(cells.map(|cell| Known::of(&cell)).take(MOST_CELLS));
        }
        self.cells.len() == usize::from(block.count)
    }

    /// Returns the number of the cell behind the last one.
    pub(super) fn end(&self) -> i32 {
        self.first_cell + self.cells.len() as i32
    }

    /// Returns a cell.
    pub(super) fn cell_mut(&mut self, cell: i32) -> Option<&mut Known> {
        let index = usize::try_from(cell.checked_sub(self.first_cell)?).ok()?;
        self.cells.get_mut(index)
    }

    /// Appends a cell. Returns whether the block is full.
    pub(super) fn push(&mut self, known: Known, position_e7: Option<(i32, i32)>) -> bool {
        let cell = self.end();
        let point = position_e7.map(|(latitude_e7, longitude_e7)| MapPoint {
            cell,
            latitude_e7,
            longitude_e7,
        });
        if let Some(point) = point {
            let before = self.points.last();
            if before.is_none_or(|before| cell - before.cell >= POINT_CELLS) {
                let _ = self.points.push(point);
            }
            self.latest = Some(point);
        }
        let _ = self.cells.push(known);
        self.is_changed = true;
        self.cells.is_full()
    }

    /// Returns the points, with the last cell that has a position.
    fn all_points(&self) -> impl Iterator<Item = MapPoint> {
        let last = self.points.last().map(|point| point.cell);
        let latest = self.latest.filter(|latest| Some(latest.cell) > last);
        self.points.iter().copied().chain(latest)
    }

    /// Returns the block as bytes; `None` if it has no cells or no place, or does not fit.
    pub(super) fn bytes(&self) -> Option<BlockBytes> {
        let start = self.points.first()?;
        // Cells behind the last position have no place.
        let placed = self.all_points().last()?.cell - self.first_cell + 1;
        let count = usize::try_from(placed).ok()?.min(self.cells.len());
        let cells = self.cells.get(..count)?;
        if cells.is_empty() || start.cell != self.first_cell {
            return None;
        }
        let mut out = BlockBytes::new();
        let has_altitude = cells.iter().all(|cell| cell.altitude_m.is_some());
        let origin = [start.latitude_e7, start.longitude_e7].map(rounded_e7);
        append(&mut out, &[0, 0, count as u8, has_altitude.into()])?;
        append(&mut out, &self.way.to_le_bytes())?;
        append(&mut out, &self.first_cell.to_le_bytes())?;
        append(&mut out, &origin[0].to_le_bytes())?;
        append(&mut out, &origin[1].to_le_bytes())?;
        append(
            &mut out,
            &(self.all_points().count() as u16 - 1).to_le_bytes(),
        )?;
        self.put_points(&mut out, origin)?;
        let units = |cell: &Known| roundf(cell.grade_percent * GRADE_UNITS_PER_PERCENT) as i32;
        if has_altitude {
            put_altitudes(&mut out, cells, units)?;
        }
        for same in cells.chunk_by(|a, b| a.runs == b.runs) {
            put(&mut out, u32::from(same[0].runs))?;
            put(&mut out, same.len() as u16)?;
        }
        for group in cells.chunks(SIGMA_CELLS) {
            append(&mut out, &[sigma_code(group)])?;
        }
        let (mut before, mut step) = (0, 0);
        for (i, cell) in cells.iter().enumerate() {
            let grade = units(cell);
            let now = grade - before;
            put(&mut out, if i < 2 { now } else { now - step })?;
            (before, step) = (grade, now);
        }
        let length = u16::try_from(out.len() + 4).ok()?.to_le_bytes();
        out[..2].copy_from_slice(&length);
        let sum = checksum(&out).to_le_bytes();
        append(&mut out, &sum)?;
        Some(out)
    }

    fn put_points(&self, out: &mut BlockBytes, origin: [i32; 2]) -> Option<()> {
        let (mut cell, mut place) = (self.first_cell, origin);
        for point in self.all_points().skip(1) {
            put(out, u16::try_from(point.cell - cell).ok()?)?;
            let next = [point.latitude_e7, point.longitude_e7].map(rounded_e7);
            for i in 0..2 {
                let by = short_way(i64::from(next[i]) - i64::from(place[i]));
                put(out, (by / i64::from(PLACE_STEP)) as i32)?;
            }
            (cell, place) = (point.cell, next);
        }
        Some(())
    }
}

/// Appends the altitude of the first cell and what the climb by the grades lacks at the end of each
/// stretch.
fn put_altitudes(
    out: &mut BlockBytes,
    cells: &[Known],
    units: impl Fn(&Known) -> i32,
) -> Option<()> {
    let wanted = |i: usize| {
        let altitude_m = cells[i].altitude_m.unwrap_or_default();
        roundf(altitude_m * 100.0) as i32
    };
    put(out, wanted(0))?;
    let mut altitude = wanted(0) * ALTITUDE_UNITS_PER_CM;
    let mut from = 0;
    while from + 1 < cells.len() {
        let to = (from + ALTITUDE_CELLS).min(cells.len() - 1);
        let climb: i32 = cells[from..=to]
            .windows(2)
            .map(|pair| units(&pair[0]) + units(&pair[1]))
            .sum();
        let missing = wanted(to) * ALTITUDE_UNITS_PER_CM - (altitude + climb);
        let correction_cm = (missing + ALTITUDE_UNITS_PER_CM / 2).div_euclid(ALTITUDE_UNITS_PER_CM);
        put(out, correction_cm)?;
        altitude += climb + correction_cm * ALTITUDE_UNITS_PER_CM;
        from = to;
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

/// Appends a number in postcard's form.
fn put<T: Serialize>(out: &mut BlockBytes, number: T) -> Option<()> {
    let mut buffer = [0; 5];
    let bytes = postcard::to_slice(&number, &mut buffer).ok()?;
    append(out, bytes)
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
