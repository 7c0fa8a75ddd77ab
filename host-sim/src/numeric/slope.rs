//! Grades and the sines of their slope angles.

/// Returns the sine of the slope angle whose tangent is `grade`.
#[must_use]
pub fn sine(grade: f64) -> f64 {
    grade / grade.hypot(1.0)
}

/// Returns the tangent of the slope angle whose sine is `sine`; NaN beyond ±1.
#[must_use]
pub fn grade(sine: f64) -> f64 {
    sine.asin().tan()
}
