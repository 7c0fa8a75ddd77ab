//! What is inferred: variances of a segment of the road, and of a single cell.

use crate::tuning::Numbers;

/// Cells of a segment, 50 m: shocks are at its start, multipliers are of all its cells.
pub const SEGMENT_CELLS: usize = 20;

/// Variances of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentVariances {
    /// Of a step of the bias at its start, %².
    pub bias_shock: f32,
    /// Of a kink of the road at its start, %².
    pub kink: f32,
    /// Of a load change in it, 1. A cell says how large it is at most.
    pub load: f32,
    /// Multiplier of the road's noise.
    pub road: f32,
    /// Multiplier of the slow GNSS error.
    pub slow_gnss: f32,
}

impl SegmentVariances {
    /// Returns the variances of the first round, with a multiplier of road and receiver.
    #[must_use]
    pub fn start(numbers: &Numbers, multiplier: f32) -> Self {
        let shock = numbers.start_shock_percent * numbers.start_shock_percent;
        Self {
            bias_shock: shock,
            kink: shock,
            load: f32::INFINITY,
            road: multiplier,
            slow_gnss: multiplier,
        }
    }
}

/// Variances of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellVariances {
    /// Weight of the fix: its precision over the assumed one.
    pub altitude_weight: f32,
    /// The same of a slope that was measured directly.
    pub slope_weight: f32,
    /// Of a step of the doubtful force before the cell, %².
    pub doubt: f32,
    /// How the force is in doubt.
    pub doubt_cell: DoubtCell,
}

impl CellVariances {
    /// The variances of the first round.
    pub const START: Self = Self {
        altitude_weight: 1.0,
        slope_weight: 1.0,
        doubt: 0.0,
        doubt_cell: DoubtCell::NONE,
    };
}

/// What a cell is in a stretch of doubtful force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubtCell {
    /// Whether the force is in doubt.
    pub is_on: bool,
    /// Whether what was in doubt before ends here.
    pub renews: bool,
    /// Scale of the prior of a step before the cell, %; zero where there is no step.
    pub step_percent: f32,
}

impl DoubtCell {
    /// The force is known.
    pub const NONE: Self = Self {
        is_on: false,
        renews: false,
        step_percent: 0.0,
    };

    /// Returns whether a doubtful force ends before the cell.
    #[inline(always)]
    #[must_use]
    pub const fn ends_doubt(&self) -> bool {
        !self.is_on || self.renews
    }
}
