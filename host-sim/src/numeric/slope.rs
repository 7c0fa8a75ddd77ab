//! Slope angles.

/// Returns the sine of the slope angle whose tangent is `grade`.
#[must_use]
pub fn sine(grade: f64) -> f64 {
    grade / grade.hypot(1.0)
}
