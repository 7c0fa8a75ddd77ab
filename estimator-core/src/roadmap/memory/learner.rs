//! Puts finished cells in their places: into known ways, or into new ones.

use super::address::{PageKey, block_number};
use super::flash::MappedFlash;
use super::fusion::Known;
use super::history::{History, Was, follows};
use super::memory_counters::MemoryCounters;
use super::new_way::NewWay;
use super::on_way::verified;
use super::pages::{Pages, WayCell};
use super::sectors::Sector;
use super::store::{MemoryError, Store};
use super::work_block::WorkBlock;
use crate::cell::{CELL_LENGTH_M, Cell};
use crate::time::Instant;

/// Factor on the variance of a cell in which signals disagree, as in the fusion of maps.
const SUSPECT_VARIANCE: f32 = 16.0;
/// Distance over which misfits are averaged, m.
const MISFIT_M: f32 = 150.0;
/// Largest squared difference that counts, standard deviations.
const WORST: f32 = 100.0;
/// Driven cells between two ways that follow each other.
const JOIN_CELLS: u32 = 40;

/// A finished cell on a known way.
#[derive(Clone, Copy, Debug)]
struct Placed {
    way: u32,
    at: f32,
    known: Known,
    number: u32,
}

/// Puts finished cells in their places.
#[derive(Clone, Debug)]
pub(super) struct Learner {
    pub(super) history: History,
    pages: Pages,
    new_way: NewWay,
    block: WorkBlock,
    before: Option<Placed>,
    /// Mean squared difference of drive and memory, standard deviations.
    misfit: f32,
    counters: MemoryCounters,
}

impl Learner {
    pub(super) fn new() -> Self {
        Self {
            history: History::new(),
            pages: Pages::new(),
            new_way: NewWay::default(),
            block: WorkBlock::default(),
            before: None,
            misfit: 1.0,
            counters: MemoryCounters::default(),
        }
    }

    pub(super) const fn counters(&self) -> MemoryCounters {
        MemoryCounters {
            writes: self.pages.writes,
            write_failures: self.pages.failures,
            ..self.counters
        }
    }

    /// Takes a finished cell. Where `is_displaced`, the memory is shifted along the road, and it is
    /// left out.
    pub(super) fn finish<F, R>(
        &mut self,
        store: &mut Store<F, R>,
        cell: &Cell,
        is_displaced: bool,
    ) -> Result<(), MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        let (number, now) = (cell.end.cell, cell.end.time);
        let known = known_of(cell);
        let place = verified(&self.history, store.view(), cell);
        match (place, known) {
            (Was::On(way, at), Some(known)) if !is_displaced => {
                let here = Placed {
                    way,
                    at,
                    known,
                    number,
                };
                self.drive_known(store, here, now);
            }
            (Was::Off, Some(known)) => self.drive_new(store, cell, known),
            _ => {
                self.counters.cells_left_out = self.counters.cells_left_out.saturating_add(1);
                self.end_new(store);
                self.before = None;
            }
        }
        if self.pages.is_due(now) {
            self.keep(store, now);
            self.pages.write(store, now)?;
        }
        Ok(())
    }

    /// Ends the drive: writes what is not written yet.
    pub(super) fn close<F, R>(
        &mut self,
        store: &mut Store<F, R>,
    ) -> Result<(), MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        self.end_new(store);
        self.before = None;
        self.keep(store, Instant::default());
        while self.pages.write(store, Instant::default())? {}
        Ok(())
    }

    /// Evens out the wear of the sectors by one write at most. Returns whether it did.
    pub(super) fn level<F, R>(
        &mut self,
        store: &mut Store<F, R>,
    ) -> Result<bool, MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        match self.pages.clean_buffer() {
            Some(buffer) => {
                let is_moved = store.level(buffer);
                // The buffer is not taken for a newer copy of the page.
                buffer.begin(PageKey::default());
                is_moved
            }
            None => Ok(false),
        }
    }

    fn drive_known<F, R>(&mut self, store: &mut Store<F, R>, here: Placed, now: Instant)
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        let left = self.end_new(store).or_else(|| self.left());
        let before = self.before.filter(|before| before.way == here.way);
        match before {
            Some(before) if here.at < before.at && before.at - here.at < 2.0 => return,
            Some(before) if follows(before.at, here.at) => {
                for cell in before.at as i32 + 1..=here.at as i32 {
                    let part = (cell as f32 - before.at) / (here.at - before.at);
                    let drive = Known::between(&before.known, &here.known, part);
                    self.fuse(store, here.way, cell, &drive, now);
                }
            }
            _ => {
                let to = WayCell {
                    way: here.way,
                    cell: here.at as i32,
                };
                if let Some((from, number)) = left
                    && from.way != to.way
                    && here.number.saturating_sub(number) < JOIN_CELLS
                {
                    self.pages.join(store, from, to, now);
                }
            }
        }
        self.before = Some(here);
    }

    /// Adds a drive to a cell of a way.
    fn fuse<F, R>(
        &mut self,
        store: &mut Store<F, R>,
        way: u32,
        cell: i32,
        drive: &Known,
        now: Instant,
    ) where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        if self.block.way != way || self.block.cell_mut(cell).is_none() {
            self.keep_known(store, now);
            if !self.load(store, way, cell) {
                self.counters.cells_left_out = self.counters.cells_left_out.saturating_add(1);
                self.block.begin(0, 0, 0);
                return;
            }
        }
        let Some(known) = self.block.cell_mut(cell) else {
            return;
        };
        let squared = known.squared_difference(drive).min(WORST);
        self.misfit += (squared - self.misfit) * CELL_LENGTH_M / MISFIT_M;
        known.add(drive, self.misfit);
        self.block.is_changed = true;
        self.counters.cells_fused = self.counters.cells_fused.saturating_add(1);
    }

    fn load<F, R>(&mut self, store: &Store<F, R>, way: u32, cell: i32) -> bool
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        let Some(page) = self.pages.page(store, PageKey::of(way)) else {
            return false;
        };
        let found = (block_number(way)..page.blocks())
            .map_while(|number| Some((number, page.block(number).ok()?)))
            .take_while(|(_, block)| block.way == way)
            .find(|(_, block)| (block.first_cell..=block.last_cell()).contains(&cell));
        found.is_some_and(|(number, block)| self.block.load(&block, number))
    }

    fn drive_new<F, R>(&mut self, store: &mut Store<F, R>, cell: &Cell, known: Known)
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        let (number, now) = (cell.end.cell, cell.end.time);
        let from = self
            .left()
            .filter(|(_, left)| number.saturating_sub(*left) < JOIN_CELLS)
            .map(|(from, _)| from);
        let is_kept = self.new_way.push(
            (store, &mut self.pages),
            (number, now),
            (known, cell.end.position_e7),
            from,
        );
        let counter = if is_kept {
            &mut self.counters.cells_new
        } else {
            &mut self.counters.cells_left_out
        };
        *counter = counter.saturating_add(1);
    }

    /// Returns the last place on a known way, and the number of the driven cell there.
    fn left(&self) -> Option<(WayCell, u32)> {
        self.before.map(|before| {
            let cell = before.at as i32;
            (
                WayCell {
                    way: before.way,
                    cell,
                },
                before.number,
            )
        })
    }

    fn end_new<F, R>(&mut self, store: &mut Store<F, R>) -> Option<(WayCell, u32)>
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        if !self.new_way.is_begun() {
            return None;
        }
        let end = self.new_way.end(store, &mut self.pages);
        if end.is_some() {
            self.before = None;
        }
        end
    }

    /// Puts all changed blocks into their pages.
    fn keep<F, R>(&mut self, store: &mut Store<F, R>, now: Instant)
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        self.new_way.keep(store, &mut self.pages);
        self.keep_known(store, now);
    }

    fn keep_known<F, R>(&mut self, store: &Store<F, R>, now: Instant)
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        if self.block.is_changed {
            self.block.is_changed = false;
            self.pages.put(store, &self.block, now);
        }
    }
}

/// Returns what a finished cell says; `None` if that cannot be.
fn known_of(cell: &Cell) -> Option<Known> {
    let altitude_m = cell.altitude_m.map(|altitude| altitude.value);
    let mut known = Known::of_drive(cell.lagged_grade_percent, altitude_m)?;
    if !cell.lagged_consistent {
        known.variance *= SUSPECT_VARIANCE;
    }
    Some(known)
}
