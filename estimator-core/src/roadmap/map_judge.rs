//! Whether a map counts: how well its grade fits the estimates.

use super::alignment::Alignment;
use super::map_limits::MapLimits;
use crate::cell::{CELL_LENGTH_M, Cell, Live, Uncertain};
use crate::scalar::Scalar;

/// Distance over which the map is compared with the estimate, m.
const COMPARED_M: f32 = 150.0;

/// What happened on the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MapCounters {
    /// Cells with a known place on the map.
    pub cells_on_map: u32,
    /// Cells in which the map was left out because it differs from the estimate.
    pub cells_left_out: u32,
    /// Times that the map was left out.
    pub times_left_out: u32,
}

/// Compares the grades of a map with the estimates.
#[derive(Clone, Debug)]
pub(super) struct MapJudge {
    /// Mean squared difference of estimate and map, in their standard deviations.
    difference: f32,
    is_left_out: bool,
    alignment: Alignment,
    limits: MapLimits,
    /// Standard deviation of the map's grade, %, lately.
    map_sigma_percent: f32,
    counters: MapCounters,
}

impl MapJudge {
    pub(super) const fn new(limits: MapLimits) -> Self {
        Self {
            difference: 1.0,
            is_left_out: false,
            alignment: Alignment::new(limits),
            limits,
            map_sigma_percent: 0.0,
            counters: MapCounters {
                cells_on_map: 0,
                cells_left_out: 0,
                times_left_out: 0,
            },
        }
    }

    /// Begins the next drive. The counters go on.
    pub(super) fn begin_drive(&mut self) {
        self.difference = 1.0;
        self.is_left_out = false;
        self.alignment.clear();
    }

    /// Takes the grade of the map at the end of the newest cell, %. Returns whether it counts.
    pub(super) fn advance(&mut self, live: &Live, is_on_map: bool, map: Option<Uncertain>) -> bool {
        self.alignment.hold(live.end.cell, map.map(|map| map.value));
        if is_on_map {
            self.counters.cells_on_map = self.counters.cells_on_map.saturating_add(1);
        }
        let Some(map) = map else {
            return false;
        };
        self.map_sigma_percent = map.sigma;
        self.compare(live.estimate.grade_percent, map);
        if self.is_left_out() {
            self.counters.cells_left_out = self.counters.cells_left_out.saturating_add(1);
        }
        !self.is_left_out()
    }

    /// Compares a finished cell with the map: its lagged grade shows whether the map is shifted along
    /// the road.
    pub(super) fn finish(&mut self, cell: &Cell) {
        let was_left_out = self.is_left_out();
        self.alignment.compare(cell, self.map_sigma_percent);
        self.count_left_out(was_left_out);
    }

    pub(super) const fn alignment(&self) -> &Alignment {
        &self.alignment
    }

    pub(super) const fn is_left_out(&self) -> bool {
        self.is_left_out || self.alignment.is_displaced()
    }

    pub(super) const fn counters(&self) -> &MapCounters {
        &self.counters
    }

    fn compare(&mut self, own: Uncertain, map: Uncertain) {
        if !own.is_possible_grade() {
            return;
        }
        let difference = own.value - map.value;
        let variance = own.sigma * own.sigma + map.sigma * map.sigma;
        let was_left_out = self.is_left_out();
        let squared = Scalar::min(100.0, difference * difference / variance);
        self.difference += (squared - self.difference) * CELL_LENGTH_M / COMPARED_M;
        if self.difference > self.limits.left_out {
            self.is_left_out = true;
        } else if self.difference < self.limits.counts_again {
            self.is_left_out = false;
        }
        self.count_left_out(was_left_out);
    }

    fn count_left_out(&mut self, was_left_out: bool) {
        if self.is_left_out() && !was_left_out {
            self.counters.times_left_out = self.counters.times_left_out.saturating_add(1);
        }
    }
}
