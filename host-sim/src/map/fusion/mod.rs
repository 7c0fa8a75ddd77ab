//! Inverse-variance weighted fusion of the cells of many runs.

pub mod altitude_datum;
pub mod cell_sums;
pub mod dependence;
pub mod grade_map;
pub mod map_row;
mod position_error;
