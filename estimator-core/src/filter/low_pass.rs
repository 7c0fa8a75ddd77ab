//! A low-pass of first order.

/// Returns what a low-pass of a time constant gives for a value that held for so long.
pub(super) fn low_passed(before: f32, value: f32, duration_s: f32, constant_s: f32) -> f32 {
    before + duration_s / (duration_s + constant_s) * (value - before)
}
