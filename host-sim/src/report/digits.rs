//! Numbers with as many digits as a chart shows.

/// Rounds to a number of digits. Files of all systems are then the same: their mathematical functions
/// differ in the last digit.
pub(super) fn rounded(value: f64, digits: i32) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    to_place(value, place_of(value) - digits + 1)
}

/// Returns the power of ten of the first digit.
pub(super) fn place_of(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

/// Rounds to a power of ten.
pub(super) fn to_place(value: f64, place: i32) -> f64 {
    let power = 10_f64.powi(place.abs());
    if place < 0 {
        (value * power).round() / power
    } else {
        (value / power).round() * power
    }
}
