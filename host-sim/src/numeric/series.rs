//! Interpolation of series over time or distance.

/// Interpolates linearly between sorted points; `None` outside the series.
#[must_use]
pub fn linear(points: &[(f64, f64)], at: f64) -> Option<f64> {
    let after = points.partition_point(|point| point.0 < at);
    let &(b_at, b) = points.get(after)?;
    if b_at == at {
        return Some(b);
    }
    let &(a_at, a) = points.get(after.checked_sub(1)?)?;
    Some(a + (b - a) * (at - a_at) / (b_at - a_at))
}
