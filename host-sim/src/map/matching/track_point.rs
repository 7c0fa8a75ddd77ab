//! One point of a run, to be matched.

/// One point of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// Driven distance, m; does not decrease.
    pub odometer_m: f64,
    /// Latitude and longitude, deg.
    pub position: Option<(f64, f64)>,
}
