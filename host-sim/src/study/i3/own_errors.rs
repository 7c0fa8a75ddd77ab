//! The judge's own errors on one trip.

use super::trips::JudgedTrip;
use crate::inertial_judge::profile::GRAVITY_MPS2;
use crate::inertial_judge::{InertialProfile, Stretch, Window};
use nalgebra::{Matrix2, Vector2};

/// Least way between two elevations whose climb is compared, m.
const PIECE_M: f64 = 2_000.0;
/// Step of the regression on the acceleration, s.
const STEP_S: f64 = 1.0;
/// Below this speed, m/s, the speed is not smooth.
const SLOW_MPS: f64 = 2.0;
/// Ratio of a grade in % to an acceleration in m/s².
const TO_PERCENT: f64 = 100.0 / GRAVITY_MPS2;

/// Errors of the accelerometer as a judge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct OwnErrors {
    /// Climb by the judge less that by the elevation between its first and last point, as a grade,
    /// %: mounting angle and offset.
    pub(super) offset_percent: Option<f64>,
    /// The same over pieces of the trip, 1 sigma about the offset, %: drift, and noise of elevations.
    pub(super) drift_percent: Option<f64>,
    /// What the accelerometer shows too much for each m/s² of motion, % of grade: pitch of the body,
    /// and its scale.
    pub(super) pitch_percent: Option<f64>,
    /// Delay of the speed against the accelerometer, s.
    pub(super) delay_s: Option<f64>,
}

/// Finds the errors of a trip's judge.
pub(super) fn own_errors(trip: &JudgedTrip) -> OwnErrors {
    let motion = motion(&trip.profile);
    OwnErrors {
        offset_percent: offset(trip, trip.elevations.first(), trip.elevations.last()),
        drift_percent: drift(trip),
        pitch_percent: motion.map(|(scale, _)| TO_PERCENT * (scale - 1.0)),
        delay_s: motion.map(|(_, delay_s)| delay_s),
    }
}

/// Returns the root mean square of what the windows' sigmas have from their ends, %: resolution and
/// timing of the speed there.
pub(super) fn ends_percent(windows: &[Window], noise_percent: f64) -> f64 {
    let part = |window: &Window| (window.sigma_percent.powi(2) - noise_percent.powi(2)).max(0.0);
    let sum: f64 = windows.iter().map(part).sum();
    (sum / windows.len().max(1) as f64).sqrt()
}

/// Returns the judge's climb less the elevation's between two points, as a grade, %.
fn offset(trip: &JudgedTrip, from: Option<&(f64, f64)>, to: Option<&(f64, f64)>) -> Option<f64> {
    let (from, to) = (from?, to?);
    let (a, b) = (trip.profile.at_time(from.0)?, trip.profile.at_time(to.0)?);
    let stretch = Stretch::between(&a, &b)?;
    let excess_m = stretch.climb_m - (to.1 - from.1);
    (stretch.length_m > PIECE_M).then(|| 100.0 * excess_m / stretch.length_m)
}

fn drift(trip: &JudgedTrip) -> Option<f64> {
    let mut offsets = Vec::new();
    let mut from = trip.elevations.first()?;
    for to in &trip.elevations {
        if let Some(found) = offset(trip, Some(from), Some(to)) {
            offsets.push(found);
            from = to;
        }
    }
    let count = offsets.len() as f64;
    let mean = offsets.iter().sum::<f64>() / count;
    let squares: f64 = offsets.iter().map(|of| (of - mean).powi(2)).sum();
    (offsets.len() > 2).then(|| (squares / (count - 1.0)).sqrt())
}

/// Regresses changes of the accelerometer from second to second on those of dv/dt and of its
/// derivative: within a second the slope hardly changes. Returns the scale and the delay, s.
fn motion(profile: &InertialProfile) -> Option<(f64, f64)> {
    let points = profile.points();
    let end_s = points.last()?.time_s;
    let mut time_s = points.first()?.time_s + 2.0 * STEP_S;
    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
    let mut last: Option<[f64; 3]> = None;
    while time_s + 2.0 * STEP_S < end_s {
        let now = motion_at(profile, time_s);
        if let (Some(a), Some(b)) = (last, now) {
            let x = Vector2::new(b[1] - a[1], b[2] - a[2]);
            normal += x * x.transpose();
            right += x * (b[0] - a[0]);
        }
        last = now;
        time_s += STEP_S;
    }
    let solved = normal.try_inverse()? * right;
    Some((solved[0], solved[1]))
}

/// Returns the mean reading over a second, the change of speed over it, and the change of that.
fn motion_at(profile: &InertialProfile, time_s: f64) -> Option<[f64; 3]> {
    let at = |after_s: f64| profile.at_time(time_s + after_s);
    let speed = |after_s: f64| at(after_s).map(|point| point.speed_mps);
    if speed(0.0)? < SLOW_MPS {
        return None;
    }
    let mut reading = 0.0;
    for share in [-0.4, -0.2, 0.0, 0.2, 0.4] {
        reading += 0.2 * at(share * STEP_S)?.acceleration_mps2;
    }
    let half_s = 0.5 * STEP_S;
    let change = (speed(half_s)? - speed(-half_s)?) / STEP_S;
    let bend = (speed(STEP_S)? - 2.0 * speed(0.0)? + speed(-STEP_S)?) / STEP_S.powi(2);
    Some([reading, change, bend])
}
