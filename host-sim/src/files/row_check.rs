//! Checks of rows, so that an error names its line. The ranges are those of
//! [`columns`](super::columns).

use super::columns::{Column, LATITUDE_DEG, LONGITUDE_DEG};

pub use super::flaw::Flaw;

/// Checks that every number is within the range of its column.
///
/// # Errors
/// Returns an error that names the first number that is not, its column and the range.
pub fn within(values: &[(Column, f64)]) -> Result<(), Flaw> {
    values
        .iter()
        .try_for_each(|(column, value)| column.check(*value))
}

/// Checks that every number that is there is within the range of its column.
///
/// # Errors
/// Returns an error that names the first number that is not, its column and the range.
pub fn within_if_known(values: &[(Column, Option<f64>)]) -> Result<(), Flaw> {
    values
        .iter()
        .try_for_each(|(column, value)| value.map_or(Ok(()), |value| column.check(value)))
}

/// Checks a position on Earth, degrees.
///
/// # Errors
/// Returns an error that names the angle that is out of range.
pub fn position(latitude_deg: f64, longitude_deg: f64) -> Result<(), Flaw> {
    within(&[(LATITUDE_DEG, latitude_deg), (LONGITUDE_DEG, longitude_deg)])
}

/// Checks that a quantity grows from row to row; if `strictly`, it may not stay equal.
///
/// # Errors
/// Returns an error that names the quantity.
pub fn forwards(name: &str, before: f64, now: f64, strictly: bool) -> Result<(), Flaw> {
    if now > before || (now == before && !strictly) {
        return Ok(());
    }
    Err(Flaw {
        problem: format!("{name} is {now} after {before}"),
        expected: "a number that grows from row to row",
    })
}
