//! Small numeric tools: series, a robust line, rounding, slope angles.

pub mod robust_line;
pub mod rounding;
pub mod series;
pub mod slope;
