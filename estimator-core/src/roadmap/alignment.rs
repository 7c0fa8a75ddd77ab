//! How far a map is shifted along the road, from the grades alone.

use super::map_limits::MapLimits;
use crate::cell::{CELL_LENGTH_M, Cell, Uncertain};
use libm::sqrtf;

/// Cells of which the map's grade is held: more than the fixed lag.
const HELD: usize = 256;
/// Cells on each side between which the map's grade changes.
const ASIDE: u32 = 2;
/// Unit of the grades that are held, %.
const UNIT_PERCENT: f32 = 0.001;
/// Distance over which shifts are averaged, m.
const MEMORY_M: f32 = 1_000.0;
/// Cells whose differences count as one: errors of a lagged grade last some 50 m.
const CORRELATED_CELLS: f32 = 20.0;
/// A shift larger than so many of its standard deviations is seen.
const SEEN_SIGMAS: f32 = 1.0;
/// Standard deviation of a shift before anything is known, m.
const PRIOR_M: f32 = 5.0;

/// Compares lagged grades with the grades of the map: where they differ in proportion to the change
/// of grade along the road, the map is shifted. Lagged grades are used because live grades lag
/// behind the road as if they were shifted themselves.
#[derive(Clone, Debug)]
pub(super) struct Alignment {
    /// Grades of the map, the newest at its cell's number modulo [`HELD`].
    grades: [Option<i16>; HELD],
    newest: u32,
    /// Sum of squared changes over their variances, 1/m², and that of differences times changes, 1/m.
    information: f32,
    product: f32,
    /// The square of the shift, if it is seen.
    shift_squared_m2: f32,
    is_displaced: bool,
    limits: MapLimits,
}

impl Alignment {
    pub(super) const fn new(limits: MapLimits) -> Self {
        Self {
            grades: [None; HELD],
            newest: 0,
            information: 0.0,
            product: 0.0,
            shift_squared_m2: 0.0,
            is_displaced: false,
            limits,
        }
    }

    /// Forgets everything. In place: the grades are long.
    pub(super) fn clear(&mut self) {
        self.grades.fill(None);
        self.newest = 0;
        (self.information, self.product) = (0.0, 0.0);
        self.shift_squared_m2 = 0.0;
        self.is_displaced = false;
    }

    /// Holds the grade of the map at a cell, %.
    pub(super) fn hold(&mut self, cell: u32, grade_percent: Option<f32>) {
        let first = self.newest.max(cell.saturating_sub(HELD as u32 - 1));
        for skipped in first..cell {
            self.grades[skipped as usize % HELD] = None;
        }
        self.newest = cell + 1;
        self.grades[cell as usize % HELD] = grade_percent
            .map(|grade| grade / UNIT_PERCENT)
            .filter(|units| units.abs() < f32::from(i16::MAX))
            .map(|units| units as i16);
    }

    /// Compares a finished cell with the map. `map_sigma_percent` is the standard deviation of the
    /// map's grade.
    pub(super) fn compare(&mut self, cell: &Cell, map_sigma_percent: f32) {
        let number = cell.end.cell;
        let held = |cell: u32| {
            let age = self.newest.checked_sub(cell)?;
            if age == 0 || age as usize > HELD {
                return None;
            }
            let units = self.grades[cell as usize % HELD]?;
            Some(f32::from(units) * UNIT_PERCENT)
        };
        let (Some(here), Some(before), Some(after)) = (
            held(number),
            number.checked_sub(ASIDE).and_then(held),
            held(number.saturating_add(ASIDE)),
        ) else {
            return;
        };
        if !cell.lagged_grade_percent.is_possible_grade() {
            return;
        }
        let Uncertain { value, sigma } = cell.lagged_grade_percent;
        let variance = sigma * sigma + map_sigma_percent * map_sigma_percent;
        let change = (after - before) / (2.0 * ASIDE as f32 * CELL_LENGTH_M);
        let forget = 1.0 - CELL_LENGTH_M / MEMORY_M;
        self.information = forget * self.information + change * change / variance;
        self.product = forget * self.product + change * (value - here) / variance;
        self.judge();
    }

    fn judge(&mut self) {
        let square = |x: f32| x * x;
        let limits = &self.limits;
        let information = self.shift_information();
        let shift_squared_m2 = square(self.shift_value_m(information));
        // What the shift does to the grade, in standard deviations of the estimate.
        let harm_squared = shift_squared_m2 * self.information * (CELL_LENGTH_M / MEMORY_M);
        let significance = shift_squared_m2 * information;
        self.shift_squared_m2 = if significance > square(SEEN_SIGMAS) {
            shift_squared_m2
        } else {
            0.0
        };
        if significance > square(limits.displaced_sigmas)
            && harm_squared > square(limits.displaced_harm)
        {
            self.is_displaced = true;
        } else if harm_squared < square(limits.aligned_harm) {
            self.is_displaced = false;
        }
    }

    /// Returns the inverse of the variance of the shift, 1/m².
    fn shift_information(&self) -> f32 {
        self.information / CORRELATED_CELLS + 1.0 / (PRIOR_M * PRIOR_M)
    }

    fn shift_value_m(&self, information: f32) -> f32 {
        self.product / CORRELATED_CELLS / information
    }

    /// Returns how far the vehicle is ahead of its place on the map, m.
    pub(super) fn shift_m(&self) -> Uncertain {
        let information = self.shift_information();
        Uncertain {
            value: self.shift_value_m(information),
            sigma: shift_sigma_m(information),
        }
    }

    /// Returns the standard deviation of a place along the road, m, with a shift that is seen.
    pub(super) fn with_shift(&self, sigma_m: f32) -> f32 {
        if self.shift_squared_m2 > 0.0 {
            sqrtf(sigma_m * sigma_m + self.shift_squared_m2)
        } else {
            sigma_m
        }
    }

    /// Returns whether the map is shifted by so much that it does harm.
    pub(super) const fn is_displaced(&self) -> bool {
        self.is_displaced
    }
}

fn shift_sigma_m(information: f32) -> f32 {
    sqrtf(1.0 / information)
}
