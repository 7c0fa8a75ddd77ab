//! A number of a scenario within its range.

use std::ops::RangeInclusive;

/// A number within a range.
///
/// # Errors
/// What is wrong, beginning with the key's name.
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
