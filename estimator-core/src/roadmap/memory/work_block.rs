//! The block that is being changed, cell by cell.

use super::fusion::Known;
use crate::roadmap::block::{Block, MOST_CELLS, MapPoint};
use crate::roadmap::block_cells::ParkedCells;
use core::task::Poll;
use heapless::Vec;

/// Cells from one point of the plan view to the next: 20 m. The chord of a bend of 50 m radius is
/// 1 m beside it.
pub(super) const POINT_CELLS: i32 = 8;
/// Most points of a block: those of a map may be closer.
const MOST_POINTS: usize = 34;
/// Cells that are read in one call.
const CELLS_AT_ONCE: usize = 48;

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
    /// Where its cells are read, while not all are.
    unread: Option<ParkedCells>,
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
        self.unread = None;
        self.is_changed = false;
    }

    /// Begins to become a copy of a block. Returns false if it cannot be read.
    pub(super) fn begin_load(&mut self, block: &Block<'_>, number: u8) -> bool {
        self.begin(block.way, number, block.first_cell);
        for point in block.points() {
            if self.points.push(point).is_err() {
                return false;
            }
        }
        self.unread = block.cells().ok().map(|cells| cells.park());
        self.unread.is_some()
    }

    /// Returns whether it is still becoming a copy.
    pub(super) const fn is_loading(&self) -> bool {
        self.unread.is_some()
    }

    /// Goes on to become a copy of the block. Returns false if it cannot be read whole.
    pub(super) fn load(&mut self, block: &Block<'_>) -> Poll<bool> {
        let parked = self.unread.take();
        let Some(mut cells) = parked.and_then(|parked| block.cells_from(&parked)) else {
            return Poll::Ready(false);
        };
        let before = self.cells.len();
        for cell in cells.by_ref().take(CELLS_AT_ONCE) {
            if self.cells.push(Known::of(&cell)).is_err() {
                return Poll::Ready(false);
            }
        }
        let (read, count) = (self.cells.len(), usize::from(block.count));
        if read < count && read == before + CELLS_AT_ONCE {
            self.unread = Some(cells.park());
            return Poll::Pending;
        }
        Poll::Ready(read == count)
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
    pub(super) fn all_points(&self) -> impl Iterator<Item = MapPoint> {
        let last = self.points.last().map(|point| point.cell);
        let latest = self.latest.filter(|latest| Some(latest.cell) > last);
        self.points.iter().copied().chain(latest)
    }
}
