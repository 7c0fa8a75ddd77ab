//! Rounding of numbers in files.

/// Rounds to this number of decimals.
pub(crate) fn round(value: f64, decimals: i32) -> f64 {
    let unit = 10_f64.powi(decimals);
    (value * unit).round() / unit
}
