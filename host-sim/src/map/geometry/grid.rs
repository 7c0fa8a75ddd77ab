//! The grid of a map.

/// Step of a map, m: that of a cell.
pub const GRID_M: f64 = estimator_core::cell::CELL_LENGTH_M as f64;
