//! A road that is driven for the first time: a new way.

use super::flash::MappedFlash;
use super::fusion::Known;
use super::pages::{Pages, WayCell};
use super::sectors::SectorTable;
use super::store::Store;
use super::work_block::WorkBlock;
use crate::time::Instant;
use core::task::{Poll, ready};

/// Fewest cells of a way: 40 m. Less is a lane of a junction, or a position beside the road.
const FEWEST_CELLS: usize = 16;

/// A way that is being driven for the first time.
#[derive(Clone, Debug, Default)]
pub(super) struct NewWay {
    /// The block of its last cells.
    block: WorkBlock,
    /// Address of the way; `None` before it has a page.
    way: Option<u32>,
    /// Whether the block is in its page.
    is_placed: bool,
    /// Number of the driven cell behind the last one.
    next: u32,
    /// When the first cell came that is not in a page.
    since: Option<Instant>,
    /// Since when the block waits that is on its way to its page.
    being_put: Option<Instant>,
    /// From where the vehicle came.
    from: Option<WayCell>,
}

impl NewWay {
    /// Returns whether there is one.
    pub(super) fn is_begun(&self) -> bool {
        !self.block.cells.is_empty() || self.way.is_some()
    }

    /// Appends a driven cell. `from` is where the vehicle was before, if this is the first one.
    /// Returns false if there is no room for it.
    pub(super) fn push<F, R>(
        &mut self,
        (store, pages): (&mut Store<F, R>, &mut Pages),
        (number, now): (u32, Instant),
        (known, position_e7): (Known, Option<(i32, i32)>),
        from: Option<WayCell>,
    ) -> Poll<bool>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        // A full block has this cell already, and is on its way to its page.
        if !self.block.cells.is_full() {
            if self.is_begun() && number != self.next {
                ready!(self.end(store, pages));
            }
            if !self.is_begun() {
                self.from = from;
                self.block.begin(0, 0, 0);
            }
            if self.block.cells.is_empty() && position_e7.is_none() {
                // A block begins with a place.
                return self.end(store, pages).map(|_| true);
            }
            self.next = number.saturating_add(1);
            self.since.get_or_insert(now);
            if !self.block.push(known, position_e7) {
                return Poll::Ready(true);
            }
        }
        let is_kept = ready!(self.keep(store, pages));
        let (way, next) = (self.block.way, self.block.end());
        self.block.begin(way, 0, next);
        self.is_placed = false;
        Poll::Ready(is_kept)
    }

    /// Puts the cells so far into a page, in shares. Returns false if there is no room.
    pub(super) fn keep<F, R>(&mut self, store: &mut Store<F, R>, pages: &mut Pages) -> Poll<bool>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let Some(now) = self.being_put else {
            let is_short = self.way.is_none() && self.block.cells.len() < FEWEST_CELLS;
            if is_short || !self.block.is_changed {
                return Poll::Ready(true);
            }
            let now = self.since.take().unwrap_or_default();
            if !self.is_placed && !self.find_page(store, pages, now) {
                return Poll::Ready(false);
            }
            self.being_put = Some(now);
            return Poll::Pending;
        };
        let is_put = ready!(pages.put(store, &self.block, now));
        self.being_put = None;
        self.block.is_changed = false;
        Poll::Ready(is_put)
    }

    /// Finds the page of a new block. A way ends with its page; a join leads on.
    fn find_page<F, R>(&mut self, store: &mut Store<F, R>, pages: &mut Pages, now: Instant) -> bool
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let drive = store.drive;
        let Some(page) = pages.page_with_room(store) else {
            return false;
        };
        // It is not given to another page before it is written.
        page.touch(drive, now);
        let number = page.blocks();
        let own = page.key().block(number);
        let follows = number
            .checked_sub(1)
            .and_then(|last| page.block(last).ok())
            .is_some_and(|last| Some(last.way) == self.way);
        self.block.number = number;
        self.is_placed = true;
        if let Some(way) = self.way.filter(|_| follows) {
            self.block.way = way;
            return true;
        }
        self.block.way = own;
        let here = WayCell {
            way: own,
            cell: self.block.first_cell,
        };
        let before = self.way.replace(own).map(|way| WayCell {
            way,
            cell: here.cell - 1,
        });
        if let Some(from) = before.or(self.from) {
            pages.join(store, from, here, now);
        }
        true
    }

    /// Ends the way. Returns its last cell, and the number of the driven cell there.
    pub(super) fn end<F, R>(
        &mut self,
        store: &mut Store<F, R>,
        pages: &mut Pages,
    ) -> Poll<Option<(WayCell, u32)>>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        ready!(self.keep(store, pages));
        let way = self.way.take();
        let cell = self.block.end() - 1;
        self.block.begin(0, 0, 0);
        self.is_placed = false;
        self.since = None;
        Poll::Ready(way.map(|way| (WayCell { way, cell }, self.next.saturating_sub(1))))
    }
}
