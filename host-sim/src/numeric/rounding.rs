//! Decimals of numbers in files.

/// Decimals that a reader can use and a file can bear.
pub(crate) fn round(value: f64, decimals: i32) -> f64 {
    let unit = 10_f64.powi(decimals);
    (value * unit).round() / unit
}
