//! Where the vehicle was, for the cells that are not finished yet.

use crate::roadmap::matcher::MapMatch;

/// Cells that are held: more than the fixed lag.
const HELD: usize = 256;
/// Places farther apart than this on one way do not follow each other, cells.
const JUMP_CELLS: f32 = 12.0;

/// Where the vehicle was at the end of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Was {
    /// On a way of the memory, given by its address, at this cell.
    On(u32, f32),
    /// Perhaps on one.
    Unclear,
    /// On none.
    #[default]
    Off,
}

/// The places of the last cells, the newest at its cell's number modulo [`HELD`].
#[derive(Clone, Debug)]
pub(super) struct History {
    places: [Was; HELD],
    /// Number of the cell behind the newest.
    end: u32,
}

impl History {
    pub(super) const fn new() -> Self {
        Self {
            places: [Was::Off; HELD],
            end: 0,
        }
    }

    /// Forgets all places.
    pub(super) fn clear(&mut self) {
        self.places.fill(Was::Off);
        self.end = 0;
    }

    /// Takes the place at the end of a cell. `scale` is the cells on the way for each driven cell.
    ///
    /// A place becomes known some hundred metres after the vehicle has come to the way. Then those
    /// before follow, back to `first_cell`, the begin of the way. It is asked for only then.
    pub(super) fn push(
        &mut self,
        cell: u32,
        found: MapMatch,
        scale: f32,
        first_cell: impl FnOnce(u32) -> i32,
    ) {
        let first = self.end.max(cell.saturating_sub(HELD as u32 - 1));
        for skipped in first..cell {
            self.places[skipped as usize % HELD] = Was::Off;
        }
        self.end = cell + 1;
        let place = match found {
            MapMatch::On(place) => Was::On(place.way, place.cell),
            MapMatch::Unclear => Was::Unclear,
            MapMatch::Off => Was::Off,
        };
        self.places[cell as usize % HELD] = place;
        let before = cell
            .checked_sub(1)
            .map(|before| self.places[before as usize % HELD]);
        if let (Was::On(way, at), Some(Was::Unclear | Was::Off)) = (place, before) {
            self.follow_back(cell, way, at, scale, first_cell(way) as f32);
        }
    }

    fn follow_back(&mut self, cell: u32, way: u32, at: f32, scale: f32, first_cell: f32) {
        for back in 1..HELD as u32 {
            let at = at - back as f32 * scale;
            let Some(before) = cell.checked_sub(back).filter(|_| at >= first_cell) else {
                return;
            };
            let was = &mut self.places[before as usize % HELD];
            if matches!(was, Was::On(..)) {
                return;
            }
            *was = Was::On(way, at);
        }
    }

    /// Returns where the vehicle was at the end of a cell. Where that is not clear, what became clear
    /// later counts.
    pub(super) fn place(&self, cell: u32) -> Was {
        if cell >= self.end || self.end - cell > HELD as u32 {
            return Was::Off;
        }
        let later = (cell..self.end).map(|cell| self.places[cell as usize % HELD]);
        match later.clone().next() {
            Some(Was::Unclear) => match later.clone().find(|was| *was != Was::Unclear) {
                // What becomes known later has been followed back already, as far as the way goes.
                None => Was::Unclear,
                Some(_) => Was::Off,
            },
            Some(was) => was,
            None => Was::Off,
        }
    }
}

/// Returns whether a place on a way can follow another one.
pub(super) fn follows(before: f32, cell: f32) -> bool {
    cell >= before && cell - before < JUMP_CELLS
}
