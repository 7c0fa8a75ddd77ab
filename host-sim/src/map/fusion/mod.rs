//! Cells of many runs become one, weighted by the inverse of their variances.

pub mod cell_sums;
pub mod dependence;
pub mod grade_map;
pub mod map_row;
