//! Windows of driven distance: mean grade and its sigma.

use super::profile::{GRAVITY_MPS2, InertialProfile, ProfilePoint};
use super::stretch::Stretch;
use crate::numeric::slope::grade;

/// Noise of the mean grade times the root of the window, % √m: of the road, curves, lane and driver.
/// From a car's drives over the same road (`study i3`): 0.14 to 0.17 % over 100 m, 0.07 to 0.095 %
/// over 300 m.
const NOISE_PERCENT_ROOT_M: f64 = 1.5;
/// Uncertainty of the time between speed and accelerometer, s; the same car's trips differ by this.
const TIME_SIGMA_S: f64 = 0.02;
/// Steepest sine of a road; beyond it, a window tells of a fault.
const STEEPEST_SINE: f64 = 0.5;

/// One window of a drive, judged by the accelerometer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Where it begins, distance driven since the first sample, m.
    pub from_m: f64,
    /// Where it ends, m.
    pub to_m: f64,
    /// When it begins, time of the log, s.
    pub from_s: f64,
    /// When it ends, s.
    pub to_s: f64,
    /// Mean grade over the distance, %, positive uphill. It includes the offset of the sensor.
    pub grade_percent: f64,
    /// One standard deviation of the grade without the offset, %.
    pub sigma_percent: f64,
    /// Mean acceleration over the distance, m/s²: what pitches the body.
    pub acceleration_mps2: f64,
    /// Mean speed over time, m/s.
    pub speed_mps: f64,
}

/// Judges windows of `window_m` of a drive that stands as one time (s), speed (m/s) and
/// acceleration (m/s²) a sample. The windows lie end to end from the first sample on; those with a
/// break are left out. Returns none if a slice or the length is empty.
#[must_use]
pub fn windows(
    times_s: &[f64],
    speeds_mps: &[f64],
    accelerations_mps2: &[f64],
    window_m: f64,
) -> Vec<Window> {
    let profile = InertialProfile::new(times_s, speeds_mps, accelerations_mps2);
    windows_of(&profile, window_m)
}

/// Judges windows of `window_m` of a profile, as [`windows`] does.
#[must_use]
pub fn windows_of(profile: &InertialProfile, window_m: f64) -> Vec<Window> {
    let length_m = profile.points().last().map_or(0.0, |end| end.distance_m);
    if !(window_m.is_finite() && window_m > 0.0) {
        return Vec::new();
    }
    let count = (length_m / window_m).floor() as usize;
    let edges = (0..=count).map(|k| profile.at_distance(k as f64 * window_m));
    let edges: Vec<Option<ProfilePoint>> = edges.collect();
    edges
        .windows(2)
        .filter_map(|pair| judged(pair[0]?, pair[1]?, profile.speed_resolution_mps()))
        .collect()
}

/// Judges the road between two points; `None` if there is a break in it or it is no road.
fn judged(from: ProfilePoint, to: ProfilePoint, resolution_mps: f64) -> Option<Window> {
    let stretch = Stretch::between(&from, &to)?;
    let duration_s = to.time_s - from.time_s;
    let is_road = duration_s > 0.0 && stretch.sine().abs() <= STEEPEST_SINE;
    is_road.then(|| Window {
        from_m: from.distance_m,
        to_m: to.distance_m,
        from_s: from.time_s,
        to_s: to.time_s,
        grade_percent: 100.0 * grade(stretch.sine()),
        sigma_percent: sigma_percent(&from, &to, resolution_mps),
        acceleration_mps2: stretch.acceleration_mps2,
        speed_mps: stretch.length_m / duration_s,
    })
}

/// Returns the part of the sigma of a window of `length_m` that is not from its ends, %.
#[must_use]
pub fn noise_percent(length_m: f64) -> f64 {
    NOISE_PERCENT_ROOT_M / length_m.sqrt()
}

/// Returns the sigma of a window without the offset: noise of the road, and at each end the speed's
/// resolution (uniform) and what the speed changes in the uncertain time.
fn sigma_percent(from: &ProfilePoint, to: &ProfilePoint, resolution_mps: f64) -> f64 {
    let length_m = to.distance_m - from.distance_m;
    let end = |point: &ProfilePoint| {
        let speed_variance =
            resolution_mps.powi(2) / 12.0 + (TIME_SIGMA_S * point.acceleration_mps2).powi(2);
        point.speed_mps.powi(2) * speed_variance
    };
    let noise_variance = noise_percent(length_m).powi(2);
    let percent_per_joule = 100.0 / (GRAVITY_MPS2 * length_m);
    (noise_variance + percent_per_joule.powi(2) * (end(from) + end(to))).sqrt()
}
