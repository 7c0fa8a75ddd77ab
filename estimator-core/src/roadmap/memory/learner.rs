//! Puts finished cells in their places: into known ways, or into new ones.

use super::address::PageKey;
use super::finished::{Finished, Placed, Waiting};
use super::flash::MappedFlash;
use super::fusion::Known;
use super::history::{History, Was, follows};
use super::memory_counters::MemoryCounters;
use super::new_way::NewWay;
use super::on_way::verified;
use super::pages::{Pages, WayCell};
use super::sectors::SectorTable;
use super::store::{MemoryError, Store};
use super::work_block::WorkBlock;
use crate::cell::{CELL_LENGTH_M, Cell};
use crate::time::Instant;
use core::task::{Poll, ready};

/// Factor on the variance of a cell in which signals disagree, as in the fusion of maps.
const SUSPECT_VARIANCE: f32 = 16.0;
/// Distance over which misfits are averaged, m.
const MISFIT_M: f32 = 150.0;
/// Largest squared difference that counts, standard deviations.
const WORST: f32 = 100.0;
/// Cells that are put in their places in one call. One is finished in a call: those that wait become
/// fewer.
const CELLS_AT_ONCE: usize = 2;
/// A place that moves back by less is corrected, not driven again, cells.
const BACK_CELLS: f32 = 40.0;
/// Driven cells between two ways that follow each other.
const JOIN_CELLS: u32 = 40;

/// Puts finished cells in their places.
#[derive(Clone, Debug)]
pub(super) struct Learner {
    pub(super) history: History,
    pages: Pages,
    new_way: NewWay,
    block: WorkBlock,
    /// Finished cells that wait. The first one may be in work.
    waiting: Waiting,
    /// Cells of the way that the first one has been added to.
    fused: u8,
    /// Since when pages are due to be written.
    due: Option<Instant>,
    /// When the vehicle was at the cell that was finished last.
    now: Instant,
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
            waiting: Waiting::new(),
            fused: 0,
            due: None,
            now: Instant::default(),
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

    /// Takes a finished cell, and does a share of the work that waits. Where `is_displaced`, the memory
    /// is shifted along the road, and the cell is left out.
    pub(super) fn finish<F, R>(
        &mut self,
        store: &mut Store<F, R>,
        cell: &Cell,
        is_displaced: bool,
    ) -> Result<(), MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let (number, now) = (cell.end.cell, cell.end.time);
        let place = verified(&self.history, store.view(), cell);
        let finished = match (place, known_of(cell)) {
            (Was::On(way, at), Some(known)) if !is_displaced => {
                let here = Placed {
                    way,
                    at,
                    known,
                    number,
                };
                Finished::OnWay(here, now)
            }
            (Was::Off, Some(known)) => Finished::New(known, number, cell.end.position_e7, now),
            _ => Finished::LeftOut(now),
        };
        self.now = now;
        let made_room = self.wait(store, finished);
        made_room.and(self.share(store))
    }

    /// Begins the next drive: its cells are numbered from the start.
    pub(super) fn begin_drive<F, R>(&mut self, store: &mut Store<F, R>)
    where
        F: MappedFlash,
        R: SectorTable,
    {
        // What could not be written is counted, and tried again.
        let _ = self.wait(store, Finished::DriveEnd);
        self.history.clear();
    }

    /// Ends the drive: writes what is not written yet.
    pub(super) fn close<F, R>(
        &mut self,
        store: &mut Store<F, R>,
    ) -> Result<(), MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let _ = self.wait(store, Finished::DriveEnd);
        self.settle(store);
        while self.keep(store, Instant::default()).is_pending() {}
        self.pages.begin_writing(Instant::default());
        while self.pages.is_writing() {
            self.pages.write_share(store)?;
        }
        Ok(())
    }

    /// Evens out the wear of the sectors by one write at most. Returns whether it did.
    pub(super) fn level<F, R>(
        &mut self,
        store: &mut Store<F, R>,
    ) -> Result<bool, MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        self.settle(store);
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

    /// Lets a cell wait for its turn. If there is no room, those before come first.
    fn wait<F, R>(
        &mut self,
        store: &mut Store<F, R>,
        finished: Finished,
    ) -> Result<(), MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let mut result = Ok(());
        while self.waiting.is_full() {
            result = result.and(self.share(store));
        }
        let _ = self.waiting.push_back(finished);
        result
    }

    /// Does all work that waits. What could not be written is counted, and tried again.
    fn settle<F, R>(&mut self, store: &mut Store<F, R>)
    where
        F: MappedFlash,
        R: SectorTable,
    {
        while !self.waiting.is_empty() || self.due.is_some() || self.pages.is_writing() {
            let _ = self.share(store);
        }
    }

    /// Does a share of the work that waits: a part of a block or of a page, or a few cells.
    fn share<F, R>(&mut self, store: &mut Store<F, R>) -> Result<(), MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        if self.pages.is_writing() {
            return self.pages.write_share(store);
        }
        for _ in 0..CELLS_AT_ONCE {
            if let Some(now) = self.due {
                if self.keep(store, now).is_pending() {
                    break;
                }
                self.due = None;
                if self.pages.begin_writing(self.now) {
                    break;
                }
            }
            let Some(first) = self.waiting.front().copied() else {
                break;
            };
            if self.take(store, &first).is_pending() {
                break;
            }
            self.waiting.pop_front();
            self.fused = 0;
            self.due = first.time().filter(|now| self.pages.is_due(*now));
        }
        Ok(())
    }

    /// Puts a cell in its place.
    fn take<F, R>(&mut self, store: &mut Store<F, R>, finished: &Finished) -> Poll<()>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        match *finished {
            Finished::OnWay(here, now) => return self.drive_known(store, here, now),
            Finished::New(known, number, position_e7, now) => {
                return self.drive_new(store, (number, now), (known, position_e7));
            }
            Finished::LeftOut(_) => {
                ready!(self.end_new(store));
                self.counters.cells_left_out = self.counters.cells_left_out.saturating_add(1);
            }
            Finished::DriveEnd => {
                ready!(self.end_new(store));
                self.misfit = 1.0;
            }
        }
        self.before = None;
        Poll::Ready(())
    }

    fn drive_known<F, R>(&mut self, store: &mut Store<F, R>, here: Placed, now: Instant) -> Poll<()>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let left = ready!(self.end_new(store)).or_else(|| self.left());
        let before = self.before.filter(|before| before.way == here.way);
        match before {
            // The place has moved back: these cells are in the memory already.
            Some(before) if here.at < before.at && before.at - here.at < BACK_CELLS => {
                return Poll::Ready(());
            }
            Some(before) if follows(before.at, here.at) => {
                // Those before are in the memory already.
                let first = before.at as i32 + 1 + i32::from(self.fused);
                for cell in first..=here.at as i32 {
                    let part = (cell as f32 - before.at) / (here.at - before.at);
                    let drive = Known::between(&before.known, &here.known, part);
                    ready!(self.fuse(store, here.way, cell, &drive, now));
                    self.fused = self.fused.saturating_add(1);
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
        Poll::Ready(())
    }

    /// Adds a drive to a cell of a way.
    fn fuse<F, R>(
        &mut self,
        store: &mut Store<F, R>,
        way: u32,
        cell: i32,
        drive: &Known,
        now: Instant,
    ) -> Poll<()>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        if self.block.is_loading() || self.block.way != way || self.block.cell_mut(cell).is_none() {
            ready!(self.keep_known(store, now));
            if !ready!(self.load(store, way, cell)) {
                self.counters.cells_left_out = self.counters.cells_left_out.saturating_add(1);
                self.block.begin(0, 0, 0);
                return Poll::Ready(());
            }
        }
        let Some(known) = self.block.cell_mut(cell) else {
            return Poll::Ready(());
        };
        let squared = known.squared_difference(drive).min(WORST);
        self.misfit += (squared - self.misfit) * CELL_LENGTH_M / MISFIT_M;
        known.add(drive, self.misfit);
        self.block.is_changed = true;
        self.counters.cells_fused = self.counters.cells_fused.saturating_add(1);
        Poll::Ready(())
    }

    /// Loads the block of a way that has a cell, in shares. Returns false if it cannot be.
    fn load<F, R>(&mut self, store: &Store<F, R>, way: u32, cell: i32) -> Poll<bool>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let Some(page) = self.pages.page(store, PageKey::of(way)) else {
            return Poll::Ready(false);
        };
        if self.block.is_loading() {
            let block = page.block(self.block.number);
            return block.map_or(Poll::Ready(false), |block| self.block.load(&block));
        }
        let number = page.block_with(way, cell);
        let found = number.and_then(|number| Some((number, page.block(number).ok()?)));
        match found {
            Some((number, block)) if self.block.begin_load(&block, number) => Poll::Pending,
            _ => Poll::Ready(false),
        }
    }

    fn drive_new<F, R>(
        &mut self,
        store: &mut Store<F, R>,
        (number, now): (u32, Instant),
        (known, position_e7): (Known, Option<(i32, i32)>),
    ) -> Poll<()>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let from = self
            .left()
            .filter(|(_, left)| number.saturating_sub(*left) < JOIN_CELLS)
            .map(|(from, _)| from);
        let is_kept = ready!(self.new_way.push(
            (store, &mut self.pages),
            (number, now),
            (known, position_e7),
            from,
        ));
        let counter = if is_kept {
            &mut self.counters.cells_new
        } else {
            &mut self.counters.cells_left_out
        };
        *counter = counter.saturating_add(1);
        Poll::Ready(())
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

    /// Ends the new way. Returns its last cell, and the number of the driven cell there.
    fn end_new<F, R>(&mut self, store: &mut Store<F, R>) -> Poll<Option<(WayCell, u32)>>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        if !self.new_way.is_begun() {
            return Poll::Ready(None);
        }
        let end = ready!(self.new_way.end(store, &mut self.pages));
        if end.is_some() {
            self.before = None;
        }
        Poll::Ready(end)
    }

    /// Puts all changed blocks into their pages, in shares.
    fn keep<F, R>(&mut self, store: &mut Store<F, R>, now: Instant) -> Poll<()>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        ready!(self.new_way.keep(store, &mut self.pages));
        self.keep_known(store, now)
    }

    fn keep_known<F, R>(&mut self, store: &Store<F, R>, now: Instant) -> Poll<()>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        if self.block.is_changed {
            ready!(self.pages.put(store, &self.block, now));
            self.block.is_changed = false;
        }
        Poll::Ready(())
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
