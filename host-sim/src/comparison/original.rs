//! The original method: a three-state extended Kalman filter in the distance domain with switched
//! noise, smoothed backwards (thesis section 3; equations reconstructed from its model).

use super::drive::{G, MeasuredDrive, MeasuredPoint, Profile, STEP_M, percent_of_sine};
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Elements of Q and R, as standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseSigmas {
    /// Wheel speed, m/s.
    pub speed_mps: f64,
    /// GNSS altitude, m.
    pub altitude_m: f64,
    /// Vehicle model over one step, as grade, %.
    pub model_percent: f64,
    /// The same during shifts and braking, %.
    pub model_invalid_percent: f64,
    /// Altitude over one step, m.
    pub climb_m: f64,
    /// Change of grade over one step, %.
    pub grade_percent: f64,
}

impl NoiseSigmas {
    /// The original method: "vehicle data is treated as a signal with large amounts of white
    /// noise, thus giving more weight to GPS" (section 7.1). `study::experiments::tuning` chose the
    /// numbers of all three.
    pub const ORIGINAL: Self = Self {
        speed_mps: 0.013,
        altitude_m: 4.0,
        model_percent: 2.0,
        model_invalid_percent: 30.0,
        climb_m: 0.02,
        grade_percent: 0.12,
    };
    /// The first pass of the modified method, with more weight on GPS (section 8.1). More GPS
    /// weight than the original's does not help; less change of grade reduces the GPS error in the
    /// means.
    pub const GPS_HEAVY: Self = Self {
        grade_percent: 0.06,
        ..Self::ORIGINAL
    };
    /// Its second pass, on corrected data: "less weight on GPS".
    pub const GPS_LIGHT: Self = Self {
        altitude_m: 16.0,
        model_percent: 1.0,
        ..Self::ORIGINAL
    };
}

struct FilterStep {
    predicted: Vector3<f64>,
    predicted_p: Matrix3<f64>,
    filtered: Vector3<f64>,
    filtered_p: Matrix3<f64>,
    transition: Matrix3<f64>,
}

/// Returns the smoothed grade of a drive.
#[must_use]
pub fn estimate(drive: &MeasuredDrive, noise: &NoiseSigmas) -> Profile {
    smooth(&filter(drive, noise))
}

/// Returns the filtered grade, without smoothing.
#[must_use]
pub fn filtered(drive: &MeasuredDrive, noise: &NoiseSigmas) -> Profile {
    let steps = filter(drive, noise);
    let each = |f: fn(&FilterStep) -> f64| steps.iter().map(f).collect();
    Profile {
        grade_percent: each(|step| percent_of_sine(step.filtered[2])),
        sigma_percent: each(|step| sigma_percent(&step.filtered_p)),
    }
}

/// Filters speed, altitude and grade (as sine) along a drive.
fn filter(drive: &MeasuredDrive, noise: &NoiseSigmas) -> Vec<FilterStep> {
    let Some(first) = drive.points.first() else {
        return Vec::new();
    };
    let altitude = drive.points.iter().find_map(|point| point.altitude_m);
    let mut x = Vector3::new(first.speed_mps, altitude.unwrap_or(0.0), 0.0);
    let mut p = Matrix3::from_diagonal(&Vector3::new(1.0, 100.0, 1e-3));
    let mut steps = Vec::with_capacity(drive.points.len());
    let mut before: Option<&MeasuredPoint> = None;
    for point in &drive.points {
        let mut transition = Matrix3::identity();
        if let Some(before) = before {
            (x, transition) = predict(drive, before, &x);
            p = transition * p * transition.transpose() + process_noise(drive, before, &x, noise);
        }
        let (predicted, predicted_p) = (x, p);
        fuse(&mut x, &mut p, 0, point.speed_mps, noise.speed_mps);
        if let Some(altitude_m) = point.altitude_m {
            fuse(&mut x, &mut p, 1, altitude_m, noise.altitude_m);
        }
        steps.push(FilterStep {
            predicted,
            predicted_p,
            filtered: x,
            filtered_p: p,
            transition,
        });
        before = Some(point);
    }
    steps
}

/// Returns one step of eq. 9 in v, and its Jacobian.
fn predict(
    drive: &MeasuredDrive,
    point: &MeasuredPoint,
    x: &Vector3<f64>,
) -> (Vector3<f64>, Matrix3<f64>) {
    // The distance domain is singular at standstill; the thesis has no such data.
    let v = x[0].max(1.0);
    let mass = drive.mass_kg + point.rotating_kg;
    let air = 0.5 * drive.drag_area_m2 * point.air_density;
    let weight = drive.mass_kg * G;
    let steady = point.traction_n - weight * (drive.rolling_resistance + x[2]);
    let moved = Vector3::new(
        v + STEP_M / (v * mass) * (steady - air * v * v),
        x[1] + STEP_M * x[2],
        x[2],
    );
    let mut jacobian = Matrix3::identity();
    jacobian[(0, 0)] = 1.0 - STEP_M / mass * (steady / (v * v) + air);
    jacobian[(0, 2)] = -STEP_M * weight / (mass * v);
    jacobian[(1, 2)] = STEP_M;
    (moved, jacobian)
}

fn process_noise(
    drive: &MeasuredDrive,
    point: &MeasuredPoint,
    x: &Vector3<f64>,
    noise: &NoiseSigmas,
) -> Matrix3<f64> {
    let percent = if point.is_valid() {
        noise.model_percent
    } else {
        noise.model_invalid_percent
    };
    let mass = drive.mass_kg + point.rotating_kg;
    let speed = STEP_M * drive.mass_kg * G / (mass * x[0].max(1.0)) * percent * 0.01;
    let grade = noise.grade_percent * 0.01;
    Matrix3::from_diagonal(&Vector3::new(
        speed * speed,
        noise.climb_m * noise.climb_m,
        grade * grade,
    ))
}

fn fuse(x: &mut Vector3<f64>, p: &mut Matrix3<f64>, state: usize, value: f64, sigma: f64) {
    let cross: SMatrix<f64, 3, 1> = p.column(state).into_owned();
    let variance = cross[state] + sigma * sigma;
    *x += cross * ((value - x[state]) / variance);
    *p -= cross * cross.transpose() / variance;
}

/// Smooths (Rauch, Tung and Striebel).
fn smooth(steps: &[FilterStep]) -> Profile {
    let n = steps.len();
    let mut profile = Profile {
        grade_percent: vec![0.0; n],
        sigma_percent: vec![0.0; n],
    };
    let mut later: Option<(Vector3<f64>, Matrix3<f64>)> = None;
    for k in (0..n).rev() {
        let step = &steps[k];
        let (x, p) = match (&later, steps.get(k + 1)) {
            (Some((x, p)), Some(next)) => {
                let gain = next
                    .predicted_p
                    .cholesky()
                    .map_or_else(Matrix3::zeros, |c| {
                        c.solve(&(next.transition * step.filtered_p)).transpose()
                    });
                (
                    step.filtered + gain * (x - next.predicted),
                    step.filtered_p + gain * (p - next.predicted_p) * gain.transpose(),
                )
            }
            _ => (step.filtered, step.filtered_p),
        };
        profile.grade_percent[k] = percent_of_sine(x[2]);
        profile.sigma_percent[k] = sigma_percent(&p);
        later = Some((x, p));
    }
    profile
}

fn sigma_percent(p: &Matrix3<f64>) -> f64 {
    100.0 * p[(2, 2)].max(0.0).sqrt()
}
