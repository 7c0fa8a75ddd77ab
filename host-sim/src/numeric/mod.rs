//! Small numeric tools: series, local fits, a robust line, rounding, slope angles.

pub mod local_fit;
pub mod robust_line;
pub mod rounding;
pub mod series;
pub mod slope;
pub mod statistics;
