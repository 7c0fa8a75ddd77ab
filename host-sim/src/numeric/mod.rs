//! Small numeric tools: series, a robust line, rounding.

pub mod robust_line;
pub mod rounding;
pub mod series;
