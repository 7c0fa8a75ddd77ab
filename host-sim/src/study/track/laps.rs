//! The laps, the grade by place, and errors in windows by place.

use super::estimates::EstimatedCell;
use crate::error::{Error, Result};
use crate::files::csv::read_csv;
use crate::numeric::series::linear;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Where the estimator has found the vehicle's errors, m.
const FROM_M: f64 = 2_500.0;
/// Least part of a window that has cells.
const LEAST_COVERED: f64 = 0.8;
const CELL_M: f64 = 2.5;

#[derive(Deserialize)]
struct LapStart {
    distance_m: f64,
}

#[derive(Deserialize)]
struct TrueGrade {
    place_m: f64,
    grade_percent: f64,
}

/// The laps of a drive.
#[derive(Clone, Debug)]
pub struct Laps {
    /// Driven distances at which laps begin, and at which the last one ends, m.
    starts_m: Vec<f64>,
    /// Grade, %, over the place on the lap, m.
    grades: Vec<(f64, f64)>,
}

/// The error of a window on a lap.
#[derive(Clone, Copy)]
pub(super) struct LapError {
    pub lap: usize,
    /// Its middle.
    pub place_m: f64,
    pub error_percent: f64,
    /// Mean sigma of its cells, if they have one: their errors are taken as common.
    pub sigma_percent: Option<f64>,
}

impl Laps {
    /// Reads lap_starts.csv and truth.csv of a folder.
    ///
    /// # Errors
    /// Returns an error if a file cannot be read, or has too little.
    pub fn read(folder: &Path) -> Result<Self> {
        let starts: Vec<LapStart> = read_csv(&folder.join("lap_starts.csv"))?;
        let truth = folder.join("truth.csv");
        let grades: Vec<TrueGrade> = read_csv(&truth)?;
        let pairs = grades.iter().map(|of| (of.place_m, of.grade_percent));
        let laps = Self {
            starts_m: starts.iter().map(|lap| lap.distance_m).collect(),
            grades: pairs.collect(),
        };
        if laps.count() < 3 || laps.grades.len() < 2 {
            let problem = "too few laps or places; expected at least three laps and two places";
            return Err(Error::content(&truth, problem));
        }
        Ok(laps)
    }

    pub(super) fn count(&self) -> usize {
        self.starts_m.len().saturating_sub(1)
    }

    /// Returns the length of a lap, m.
    pub(super) fn length_m(&self) -> f64 {
        self.grades.last().map_or(0.0, |last| last.0)
    }

    /// Returns the lap, from 0, and the place on it, m; `None` beyond the laps.
    fn place(&self, driven_m: f64) -> Option<(usize, f64)> {
        let begun = self
            .starts_m
            .partition_point(|start_m| *start_m <= driven_m);
        let lap = begun.checked_sub(1).filter(|lap| *lap < self.count())?;
        Some((lap, driven_m - self.starts_m[lap]))
    }

    /// Returns the true grade, %, at a place. A lap is a few metres longer than the table.
    fn true_percent(&self, place_m: f64) -> Option<f64> {
        linear(&self.grades, place_m.min(self.length_m()))
    }

    /// Returns the true grade, %, at a driven distance; `None` beyond the laps.
    #[must_use]
    pub fn grade_percent(&self, driven_m: f64) -> Option<f64> {
        let (_, place_m) = self.place(driven_m)?;
        self.true_percent(place_m)
    }

    /// Returns the errors of windows of this length on each lap, in order.
    pub(super) fn errors(&self, cells: &[EstimatedCell], length_m: f64) -> Vec<LapError> {
        let windows = (self.length_m() / length_m) as usize;
        let mut sums: BTreeMap<(usize, usize), (f64, f64, f64)> = BTreeMap::new();
        for cell in cells.iter().filter(|cell| cell.driven_m > FROM_M) {
            let Some((lap, place_m)) = self.place(cell.driven_m) else {
                continue;
            };
            let window = (place_m / length_m) as usize;
            let Some(grade_percent) = self.true_percent(place_m).filter(|_| window < windows)
            else {
                continue;
            };
            let sum = sums.entry((lap, window)).or_default();
            sum.0 += 1.0;
            sum.1 += cell.grade_percent - grade_percent;
            sum.2 += cell.sigma_percent.unwrap_or(f64::NAN);
        }
        let least = LEAST_COVERED * length_m / CELL_M;
        let covered = sums.into_iter().filter(|(_, sum)| sum.0 >= least);
        covered
            .map(|((lap, window), (count, errors, sigmas))| LapError {
                lap,
                place_m: (window as f64 + 0.5) * length_m,
                error_percent: errors / count,
                sigma_percent: Some(sigmas / count).filter(|sigma| sigma.is_finite()),
            })
            .collect()
    }
}

/// Returns the root mean square of errors, %; NaN without any.
pub(super) fn rmse(errors: &[LapError]) -> f64 {
    let sum: f64 = errors.iter().map(|error| error.error_percent.powi(2)).sum();
    (sum / errors.len() as f64).sqrt()
}

/// Returns the mean of squared errors over their variances; `None` without sigmas.
pub(super) fn nees(errors: &[LapError]) -> Option<f64> {
    let ratio = |error: &LapError| Some((error.error_percent / error.sigma_percent?).powi(2));
    let ratios: Vec<f64> = errors.iter().filter_map(ratio).collect();
    (!ratios.is_empty()).then(|| ratios.iter().sum::<f64>() / ratios.len() as f64)
}

/// Returns the parts of the errors that repeat by place, and that do not, %: an analysis of variance.
pub(super) fn split(errors: &[LapError]) -> (f64, f64) {
    let mut places: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    for error in errors {
        let place = places.entry(error.place_m.to_bits()).or_default();
        place.push(error.error_percent);
    }
    let (mut repeats, mut random, mut count) = (0.0, 0.0, 0.0);
    for of_place in places.values().filter(|of| of.len() > 1) {
        let laps = of_place.len() as f64;
        let mean = of_place.iter().sum::<f64>() / laps;
        let squares: f64 = of_place.iter().map(|error| (error - mean).powi(2)).sum();
        let variance = squares / (laps - 1.0);
        repeats += mean * mean - variance / laps;
        random += variance;
        count += 1.0;
    }
    ((repeats / count).max(0.0).sqrt(), (random / count).sqrt())
}
