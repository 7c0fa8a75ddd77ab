//! Statistics.

/// Returns the arithmetic mean; NaN of an empty slice.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
