//! Range check of scenario values.

use std::ops::RangeInclusive;

/// Checks that a number is within a range.
///
/// # Errors
/// Returns the problem, beginning with the name of the key.
pub fn check(name: &str, value: f64, range: RangeInclusive<f64>) -> Result<(), String> {
    if range.contains(&value) {
        Ok(())
    } else {
        Err(format!(
            "{name} = {value}: expected {} to {}",
            range.start(),
            range.end()
        ))
    }
}
