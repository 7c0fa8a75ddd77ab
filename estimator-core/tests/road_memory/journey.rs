//! A drive cell by cell, wherever it goes.

use super::flash::Memory;
use super::tracks::{Road, SIGMA};
use estimator_core::{Cell, CellEnd, Condition, Disagreement, Estimate, Instant, Live, Uncertain};
use std::collections::VecDeque;

/// The same in an estimator.
const LAG: usize = 200;
/// Microseconds from one cell to the next: 25 m/s.
const CELL_MICROS: u64 = 100_000;

/// What a cell of a drive shows.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    pub position_e7: (i32, i32),
    pub grade_percent: f32,
    pub altitude_m: Option<f32>,
}

impl Seen {
    /// Returns what a cell of a road shows.
    pub fn on(road: &Road, cell: u32) -> Self {
        Self {
            position_e7: road.place_e7(cell, 0.0),
            grade_percent: road.grade_percent(cell),
            altitude_m: Some(100.0),
        }
    }
}

/// A drive, with the cells that are not finished yet.
pub struct Journey<'m> {
    pub memory: &'m mut Memory,
    number: u32,
    /// Whether the clock goes on. Where it stands, no minute passes, and nothing is written.
    pub has_time: bool,
    micros: u64,
    /// Cells by which a finished cell lies behind the live one.
    pub lag: usize,
    waiting: VecDeque<Cell>,
}

impl<'m> Journey<'m> {
    pub const fn new(memory: &'m mut Memory) -> Self {
        Self {
            memory,
            number: 0,
            has_time: true,
            micros: 0,
            lag: LAG,
            waiting: VecDeque::new(),
        }
    }

    /// Drives over a cell.
    pub fn step(&mut self, seen: &Seen) {
        let end = CellEnd {
            cell: self.number,
            time: Instant::from_micros(self.micros),
            position_e7: Some(seen.position_e7),
            speed_mps: 25.0,
            condition: Condition::default(),
        };
        let grade_percent = Uncertain {
            value: seen.grade_percent,
            sigma: SIGMA,
        };
        self.memory.advance(&Live {
            end,
            estimate: Estimate {
                grade_percent,
                ..Estimate::default()
            },
            disagreement: Disagreement::default(),
        });
        self.waiting.push_back(Cell {
            end,
            live_grade_percent: grade_percent,
            lagged_grade_percent: grade_percent,
            altitude_m: seen.altitude_m.map(|value| Uncertain { value, sigma: 2.0 }),
            live_consistent: true,
            lagged_consistent: true,
        });
        self.number += 1;
        self.micros += if self.has_time { CELL_MICROS } else { 0 };
        if self.waiting.len() > self.lag {
            self.finish_one();
        }
    }

    /// Drives over some cells of a road.
    pub fn over(&mut self, road: &Road, cells: std::ops::Range<u32>) {
        cells.for_each(|cell| self.step(&Seen::on(road, cell)));
    }

    /// Goes on this many cells further, as behind a gap of the estimate. The cells before it are
    /// finished first.
    pub fn skip(&mut self, cells: u32) {
        self.finish();
        self.number += cells;
    }

    /// Finishes all cells. Returns how many there were so far.
    pub fn finish(&mut self) -> u32 {
        while !self.waiting.is_empty() {
            self.finish_one();
        }
        self.number
    }

    fn finish_one(&mut self) {
        if let Some(cell) = self.waiting.pop_front() {
            self.memory.finish(&cell).expect("a write");
        }
    }
}
