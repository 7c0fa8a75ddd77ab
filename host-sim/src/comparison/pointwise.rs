//! Grade from the vehicle model alone, point by point (thesis section 4.2).

use super::drive::{G, MeasuredDrive, MeasuredPoint, STEP_M, moving_mean, percent_of_sine};

/// Returns eq. 9 solved for the grade in %, with a forward difference for the acceleration.
///
/// The last point repeats the one before it.
#[must_use]
pub fn grade_percent(drive: &MeasuredDrive) -> Vec<f64> {
    let mut grade: Vec<f64> = drive
        .points
        .windows(2)
        .map(|pair| {
            // dv/dt = v dv/dx, and v dv is the difference of v²/2.
            let acceleration =
                (pair[1].speed_mps.powi(2) - pair[0].speed_mps.powi(2)) / (2.0 * STEP_M);
            at(drive, &pair[0], acceleration)
        })
        .collect();
    if let Some(last) = grade.last().copied() {
        grade.push(last);
    }
    grade
}

/// Returns eq. 9 solved for the grade in % at a point with a known acceleration in m/s².
#[must_use]
pub fn at(drive: &MeasuredDrive, point: &MeasuredPoint, acceleration: f64) -> f64 {
    let air_n = 0.5 * drive.drag_area_m2 * point.air_density * point.speed_mps.powi(2);
    let inertia_n = (drive.mass_kg + point.rotating_kg) * acceleration;
    let sine =
        (point.traction_n - air_n - inertia_n) / (drive.mass_kg * G) - drive.rolling_resistance;
    percent_of_sine(sine)
}

/// Returns a drive with low-pass filtered speed: the mean over `length_m` about each point.
#[must_use]
pub fn with_smooth_speed(drive: &MeasuredDrive, length_m: f64) -> MeasuredDrive {
    let speeds: Vec<f64> = drive.points.iter().map(|point| point.speed_mps).collect();
    let mut smooth = drive.clone();
    let means = moving_mean(&speeds, length_m);
    for (point, speed_mps) in smooth.points.iter_mut().zip(means) {
        point.speed_mps = speed_mps;
    }
    smooth
}
