//! The bare vehicle model against a reference: no GNSS and no filter help it.
//!
//! The mean slope that the force balance reads over 600 m, against that of the reference: a map
//! that was given, else the map of all other drives in the same direction, else the drive's own
//! smoothed estimate. Single cells say little, since every reference is noisy there.

use super::drive::LoggedDrive;
use crate::map::{
    GradeMap, MapRow, Place, RoadLine, RoadPoint, SessionRun, match_track, road_of_run,
    track_of_run,
};
use crate::series::linear;
use estimator_core::vehicle::VehicleParameters;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Length of a window, m.
pub const WINDOW_M: f64 = 600.0;
/// Part of a window in which the model must hold.
const VALID: f64 = 0.8;
/// Draws of the bootstrap, and its seed.
const DRAWS: usize = 500;
const SEED: u64 = 1;
/// Windows that are drawn together, since neighbours err alike: 3 km.
const BLOCK: usize = 5;

/// One window of one drive.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// Number of the drive.
    pub drive: usize,
    /// Middle, along the drive, m.
    pub at_m: f64,
    /// Slope that the model reads less that of the reference, %.
    pub error_percent: f64,
}

/// Errors of the bare model.
#[derive(Clone, Debug, Default)]
pub struct Judgement {
    /// Root mean square over windows, %, with an interval of 90 %.
    pub rmse_percent: f64,
    pub rmse_interval: (f64, f64),
    /// Mean over windows, %, with an interval of 90 %.
    pub bias_percent: f64,
    pub bias_interval: (f64, f64),
    /// Altitude that the model gains over the reference in each km, m.
    pub drift_m_per_km: f64,
    /// The windows.
    pub windows: Vec<Window>,
}

/// Reference grade along each drive: distance, m, and grade, %.
pub type Reference = Vec<(f64, f64)>;

/// The reference of each drive.
#[must_use]
pub fn references(drives: &[LoggedDrive], given: Option<&[MapRow]>) -> Vec<Reference> {
    (0..drives.len())
        .map(|number| {
            given
                .and_then(|map| along_map(&drives[number], map))
                .or_else(|| {
                    let others = map_of_others(drives, number)?;
                    along_map(&drives[number], &others)
                })
                .unwrap_or_else(|| {
                    let rows = drives[number].run.rows.iter();
                    rows.map(|row| (row.distance_m, row.grade_percent))
                        .collect()
                })
        })
        .collect()
}

/// A map's grade along a drive in its direction or against it; `None` if they hardly meet.
fn along_map(drive: &LoggedDrive, map: &[MapRow]) -> Option<Reference> {
    let points: Vec<RoadPoint> = map
        .iter()
        .map(|row| RoadPoint {
            distance_m: row.distance_m,
            latitude_deg: row.latitude_deg,
            longitude_deg: row.longitude_deg,
        })
        .collect();
    let grades: Vec<(f64, f64)> = map
        .iter()
        .map(|r| (r.distance_m, r.grade_percent))
        .collect();
    let end_m = points.last()?.distance_m;
    let back = points
        .iter()
        .rev()
        .map(|point| RoadPoint {
            distance_m: end_m - point.distance_m,
            ..*point
        })
        .collect();
    let rows = &drive.run.rows;
    let track = track_of_run(rows);
    for (road, sign) in [(points, 1.0), (back, -1.0)] {
        let road = RoadLine::new(road).ok()?;
        let found: Reference = match_track(&road, &track)
            .iter()
            .zip(rows)
            .filter_map(|(place, row)| {
                let Place::OnRoad(at_m) = place else {
                    return None;
                };
                let at_m = if sign > 0.0 { *at_m } else { end_m - at_m };
                Some((row.distance_m, sign * linear(&grades, at_m)?))
            })
            .collect();
        if 2 * found.len() > rows.len() {
            return Some(found);
        }
    }
    None
}

fn map_of_others(drives: &[LoggedDrive], number: usize) -> Option<Vec<MapRow>> {
    let road = RoadLine::new(road_of_run(&drives[number].run.rows)?).ok()?;
    let mut map = GradeMap::new(&road);
    for (other, drive) in drives.iter().enumerate() {
        if other != number {
            map.add_run(&SessionRun {
                session: Some("vehicle"),
                rows: &drive.run.rows,
            });
        }
    }
    let rows = map.fused().rows;
    (2 * rows.len() > drives[number].run.rows.len()).then_some(rows)
}

/// Judges drives, read with `vehicle`, each by its reference.
#[must_use]
pub fn judge(
    drives: &[LoggedDrive],
    vehicle: &VehicleParameters,
    references: &[Reference],
) -> Judgement {
    let windows: Vec<Window> = drives
        .iter()
        .zip(references)
        .enumerate()
        .flat_map(|(number, (drive, reference))| windows(number, drive, vehicle, reference))
        .collect();
    let errors: Vec<f64> = windows.iter().map(|window| window.error_percent).collect();
    let rms = |errors: &[f64]| {
        (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt()
    };
    let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    let bias_percent = mean(&errors);
    Judgement {
        rmse_percent: rms(&errors),
        rmse_interval: interval(&errors, rms),
        bias_percent,
        bias_interval: interval(&errors, mean),
        drift_m_per_km: 10.0 * bias_percent,
        windows,
    }
}

/// 90 % of a statistic over block bootstrap draws (H. R. Künsch, "The jackknife and the bootstrap
/// for general stationary observations", Annals of Statistics 17:1217, 1989).
fn interval(errors: &[f64], statistic: impl Fn(&[f64]) -> f64) -> (f64, f64) {
    if errors.len() < 2 * BLOCK {
        return (f64::NAN, f64::NAN);
    }
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut found: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let mut draw = Vec::with_capacity(errors.len());
            while draw.len() < errors.len() {
                let from = rng.random_range(0..=errors.len() - BLOCK);
                draw.extend_from_slice(&errors[from..from + BLOCK]);
            }
            statistic(&draw)
        })
        .collect();
    found.sort_by(f64::total_cmp);
    (found[DRAWS / 20], found[DRAWS - 1 - DRAWS / 20])
}

/// The model's error in each cell of a drive in which it holds, %.
#[must_use]
pub fn errors(
    drive: &LoggedDrive,
    vehicle: &VehicleParameters,
    reference: &Reference,
) -> Vec<Option<f64>> {
    let mut before: Option<f64> = None;
    drive
        .samples
        .iter()
        .map(|sample| {
            let energy = 0.5 * f64::from(sample.place.speed_mps).powi(2);
            let from = before.replace(energy).filter(|_| sample.gap_cells == 0)?;
            let condition = sample.place.condition;
            let holds = condition.is_valid() && !condition.crawling;
            let grade = linear(reference, sample.place.distance_m()).filter(|_| holds)?;
            Some(model_slope_percent(vehicle, sample, from, energy) - sine_percent(grade))
        })
        .collect()
}

fn windows(
    number: usize,
    drive: &LoggedDrive,
    vehicle: &VehicleParameters,
    reference: &Reference,
) -> Vec<Window> {
    let mut windows = Vec::new();
    let (mut sum, mut valid, mut all, mut start_m) = (0.0, 0.0, 0.0, f64::NAN);
    for (sample, error) in drive.samples.iter().zip(errors(drive, vehicle, reference)) {
        let at_m = sample.place.distance_m();
        if start_m.is_nan() {
            start_m = at_m;
        }
        all += 1.0;
        if let Some(error) = error {
            sum += error;
            valid += 1.0;
        }
        if at_m - start_m >= WINDOW_M {
            if valid >= VALID * all {
                windows.push(Window {
                    drive: number,
                    at_m: 0.5 * (start_m + at_m),
                    error_percent: sum / valid,
                });
            }
            (sum, valid, all, start_m) = (0.0, 0.0, 0.0, at_m);
        }
    }
    windows
}

fn sine_percent(grade_percent: f64) -> f64 {
    let tangent = 0.01 * grade_percent;
    100.0 * tangent / (1.0 + tangent * tangent).sqrt()
}

/// Sine of the slope in % that the force balance (thesis eq. 9) reads over a cell, adopted effects
/// included, between two kinetic energies a kilogram, m²/s².
#[must_use]
pub fn model_slope_percent(
    vehicle: &VehicleParameters,
    sample: &estimator_core::sampler::Sample,
    from: f64,
    to: f64,
) -> f64 {
    let balance = vehicle.force_balance(&sample.load);
    let accelerated_kg = f64::from(sample.load.mass_kg + sample.load.rotating_kg);
    let effects = f64::from(vehicle.effects.force_n(vehicle, sample)) / accelerated_kg;
    let gained = (to - from) / f64::from(sample.length_m);
    let left = f64::from(balance.traction)
        - f64::from(balance.drag) * 0.5 * (from + to)
        - f64::from(balance.rolling)
        - effects
        - gained;
    left / f64::from(balance.gravity)
}
