//! The bare vehicle model, without GNSS and without a filter, against a reference.
//!
//! The mean slope of the force balance over 600 m is compared with that of the reference. The
//! reference is a given map, else the map of all other drives in the same direction, else the
//! drive's own smoothed estimate. Single cells are not compared, since every reference is noisy
//! there.

use super::bare_model;
use super::drive::{CommonRoad, LoggedDrive};
use crate::map::{GradeMap, MapRow, Network, RoadLine, SessionRun, road_of_run};
use crate::numeric::series::linear;
use crate::numeric::slope::sine;
use estimator_core::Model;
use estimator_core::sample::Sample;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Length of a window, m.
pub const WINDOW_M: f64 = 600.0;
/// Fraction of a window in which the model must be valid.
const VALID: f64 = 0.8;
/// Number of bootstrap draws, and their seed.
const DRAWS: usize = 500;
const SEED: u64 = 1;
/// Number of windows in a block of the bootstrap (3 km): the errors of neighbours are correlated.
const BLOCK: usize = 5;

/// Errors of the bare model.
#[derive(Clone, Debug, Default)]
pub struct Judgement {
    /// Root mean square over windows, %.
    pub rmse_percent: f64,
    /// Interval of 90 % of the RMSE, %.
    pub rmse_interval: (f64, f64),
    /// Mean over windows, %.
    pub bias_percent: f64,
    /// Interval of 90 % of the mean error, %.
    pub bias_interval: (f64, f64),
    /// Altitude gain of the model minus that of the reference, m per km.
    pub drift_m_per_km: f64,
    /// Slope of the model minus that of the reference in each window, one drive after the other, %.
    pub windows: Vec<f64>,
}

/// Reference along each drive: distance, m, and grade, %.
pub type ReferenceGrades = Vec<(f64, f64)>;

/// Returns the reference of each drive: the map of all others, else its own estimate.
#[must_use]
pub fn references(drives: &[LoggedDrive]) -> Vec<ReferenceGrades> {
    (0..drives.len())
        .map(|number| by_others(drives, number))
        .collect()
}

/// Returns the reference of each drive: the map where it has the drive's road, else as without a
/// map. Returns `None` if the map has none of the roads.
#[must_use]
pub fn references_by_map(drives: &[LoggedDrive], map: &[MapRow]) -> Option<Vec<ReferenceGrades>> {
    let of_map: Vec<Option<ReferenceGrades>> =
        drives.iter().map(|drive| along_map(drive, map)).collect();
    let met = of_map.iter().any(Option::is_some);
    let numbered = of_map.into_iter().enumerate();
    met.then(|| {
        numbered
            .map(|(number, of_map)| of_map.unwrap_or_else(|| by_others(drives, number)))
            .collect()
    })
}

fn by_others(drives: &[LoggedDrive], number: usize) -> ReferenceGrades {
    let drive = &drives[number];
    let of_map = map_of_others(drives, number).and_then(|map| along_map(drive, &map));
    of_map.unwrap_or_else(|| {
        let rows = drive.run.rows.iter();
        rows.map(|row| (row.distance_m, row.grade_percent))
            .collect()
    })
}

/// Returns a map's grade along a drive, in its direction or against it; `None` if they hardly meet.
fn along_map(drive: &LoggedDrive, map: &[MapRow]) -> Option<ReferenceGrades> {
    let grades: Vec<(f64, f64)> = map
        .iter()
        .map(|r| (r.distance_m, r.grade_percent))
        .collect();
    let road = CommonRoad::through(map.iter().map(MapRow::point).collect())?;
    let rows = &drive.run.rows;
    let found: ReferenceGrades = road
        .places(drive)
        .iter()
        .zip(rows)
        .filter_map(|(place, row)| {
            let place = (*place)?;
            let sign = if place.forward { 1.0 } else { -1.0 };
            Some((row.distance_m, sign * linear(&grades, place.at_m)?))
        })
        .collect();
    (2 * found.len() > rows.len()).then_some(found)
}

fn map_of_others(drives: &[LoggedDrive], number: usize) -> Option<Vec<MapRow>> {
    let road = Network::from(RoadLine::new(road_of_run(&drives[number].run.rows)?).ok()?);
    let mut map = GradeMap::new(&road);
    for (other, drive) in drives.iter().enumerate() {
        if other != number {
            map.add_run(&SessionRun {
                session: Some("vehicle"),
                rows: &drive.run.rows,
            });
        }
    }
    let rows = map.fused().rows();
    (2 * rows.len() > drives[number].run.rows.len()).then_some(rows)
}

/// Judges drives that were read with `model`, each by its reference.
#[must_use]
pub fn judge(drives: &[LoggedDrive], model: &Model, references: &[ReferenceGrades]) -> Judgement {
    let errors: Vec<f64> = drives
        .iter()
        .zip(references)
        .flat_map(|(drive, reference)| windows(drive, model, reference))
        .collect();
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
        windows: errors,
    }
}

/// Returns the 90 % interval of a statistic over block bootstrap draws (H. R. Künsch, "The
/// jackknife and the bootstrap for general stationary observations", Annals of Statistics 17:1217,
/// 1989).
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

/// Returns the model's error (%) in each cell of a drive, where the model is valid.
#[must_use]
pub fn errors(drive: &LoggedDrive, model: &Model, reference: &ReferenceGrades) -> Vec<Option<f64>> {
    let mut before: Option<f64> = None;
    drive
        .samples
        .iter()
        .map(|sample| {
            let energy = 0.5 * f64::from(sample.end.speed_mps).powi(2);
            let from = before.replace(energy).filter(|_| sample.gap_cells == 0)?;
            let grade = linear(reference, sample.end.distance_m()).filter(|_| holds(sample))?;
            Some(model_slope_percent(model, sample, (from, energy)) - 100.0 * sine(0.01 * grade))
        })
        .collect()
}

/// Returns whether the force balance holds in a cell.
pub(super) fn holds(sample: &Sample) -> bool {
    let condition = sample.end.condition;
    condition.is_valid() && !condition.crawling
}

fn windows(drive: &LoggedDrive, model: &Model, reference: &ReferenceGrades) -> Vec<f64> {
    let mut windows = Vec::new();
    let (mut sum, mut valid, mut all, mut start_m) = (0.0, 0.0, 0.0, f64::NAN);
    for (sample, error) in drive.samples.iter().zip(errors(drive, model, reference)) {
        let at_m = sample.end.distance_m();
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
                windows.push(sum / valid);
            }
            (sum, valid, all, start_m) = (0.0, 0.0, 0.0, at_m);
        }
    }
    windows
}

/// Returns the sine of the slope (%) of the force balance over a cell, adopted effects included,
/// between two kinetic energies per kilogram, m²/s².
pub(super) fn model_slope_percent(model: &Model, sample: &Sample, energies: (f64, f64)) -> f64 {
    let accelerated_kg = f64::from(sample.forces.accelerated_kg());
    bare_model::slope_percent(
        &model.vehicle.force_balance(&sample.forces),
        f64::from(model.effects.force_n(&model.vehicle, sample)) / accelerated_kg,
        energies,
        f64::from(sample.length_m),
    )
}
