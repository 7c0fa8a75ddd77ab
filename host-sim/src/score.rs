//! How far estimates are from the truth.
//!
//! The first and last 500 m are left out: there a smoother lacks one side (thesis section 7, 200
//! points cut at both ends). RMSE and bias are in % grade; the mean normalised squared error is
//! the mean of (error / sigma)², 1 if the sigmas are honest.

use crate::map::{MapRow, Place, RoadLine, RoadRow, TrackPoint, match_track};
use crate::run_file::{RunRow, round};
use crate::series::linear;
use crate::text_table::text_table;
use crate::truth_file::TruthRow;
use comfy_table::Table;
use serde::Serialize;

/// Left out at both ends, m.
pub const END_CUT_M: f64 = 500.0;

/// Name of the rows that hold the mean over runs.
pub const MEAN: &str = "mean";

/// One line of the error table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScoreRow {
    /// Which run, or [`MEAN`].
    pub run: String,
    /// `smoothed`, `lagged`, `live`, or `map`.
    pub estimate: &'static str,
    pub cells: usize,
    pub rmse_percent: f64,
    /// Over cells that neither a shift nor braking spoiled; `None` if there are none.
    pub rmse_valid_percent: Option<f64>,
    /// Mean of estimate minus truth.
    pub bias_percent: f64,
    /// Mean normalised squared error.
    pub nees: f64,
}

impl ScoreRow {
    /// With the decimals that a file carries.
    pub fn rounded(&self) -> Self {
        Self {
            run: self.run.clone(),
            estimate: self.estimate,
            cells: self.cells,
            rmse_percent: round(self.rmse_percent, 5),
            rmse_valid_percent: self.rmse_valid_percent.map(|value| round(value, 5)),
            bias_percent: round(self.bias_percent, 5),
            nees: round(self.nees, 4),
        }
    }
}

/// The errors of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunScore {
    /// Smoothed, lagged, live.
    pub rows: Vec<ScoreRow>,
    /// Cells left out because the truth does not reach there.
    pub beyond_truth: usize,
}

/// Why there is nothing to score.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unscorable {
    /// Too short, or at another time.
    #[error(
        "no cell of {cells} both within the truth and {END_CUT_M} m away from either end; \
         expected a longer run, or the truth of this drive"
    )]
    NothingLeft { cells: usize },
    /// A reference without a grade.
    #[error("no grade_percent; expected a reference with the grade of each point")]
    NoGrade,
    /// A reference that is no line.
    #[error(transparent)]
    Road(#[from] crate::map::RoadProblem),
}

/// Compares a run with the truth at the same times. Both must be sorted by time.
///
/// # Errors
/// If no cell is left to compare.
pub fn score_run(run: &str, rows: &[RunRow], truth: &[TruthRow]) -> Result<RunScore, Unscorable> {
    let truth: Vec<(f64, f64)> = truth
        .iter()
        .map(|row| (row.time_s, row.grade_percent))
        .collect();
    let mut sums = [Sums::default(); 3];
    let mut beyond_truth = 0;
    for row in rows {
        let Some(true_percent) = linear(&truth, row.time_s) else {
            beyond_truth += 1;
            continue;
        };
        if is_end(
            rows[0].distance_m,
            rows[rows.len() - 1].distance_m,
            row.distance_m,
        ) {
            continue;
        }
        let estimates = [
            (row.grade_percent, row.grade_sigma_percent),
            (row.lagged_grade_percent, row.lagged_grade_sigma_percent),
            (row.live_grade_percent, row.live_grade_sigma_percent),
        ];
        for (sums, (percent, sigma_percent)) in sums.iter_mut().zip(estimates) {
            sums.add(percent - true_percent, sigma_percent, row.valid == 1);
        }
    }
    let rows = ["smoothed", "lagged", "live"]
        .iter()
        .zip(&sums)
        .map(|(estimate, sums)| sums.row(run, estimate))
        .collect::<Option<Vec<_>>>()
        .ok_or(Unscorable::NothingLeft { cells: rows.len() })?;
    Ok(RunScore { rows, beyond_truth })
}

/// Compares a map with a reference by distance: pairs of distance, m, and grade, %, sorted. Both
/// must count distance from the same point.
///
/// # Errors
/// If no cell is left to compare.
pub fn score_map(map: &[MapRow], reference: &[(f64, f64)]) -> Result<ScoreRow, Unscorable> {
    let places: Vec<Option<f64>> = map.iter().map(|row| Some(row.distance_m)).collect();
    score_placed(map, &places, reference)
}

/// Compares a map with a reference road that carries grades, by position and course: their
/// distances may count from different points.
///
/// # Errors
/// If the reference is no road or has no grade, or no cell is left to compare.
pub fn score_map_on_road(map: &[MapRow], reference: &[RoadRow]) -> Result<ScoreRow, Unscorable> {
    let road = RoadLine::new(reference.iter().map(RoadRow::point).collect())?;
    let grades: Vec<(f64, f64)> = reference
        .iter()
        .filter_map(|row| Some((row.distance_m, row.grade_percent?)))
        .collect();
    if grades.is_empty() {
        return Err(Unscorable::NoGrade);
    }
    let track: Vec<TrackPoint> = map
        .iter()
        .map(|row| TrackPoint {
            odometer_m: row.distance_m,
            position: Some((row.latitude_deg, row.longitude_deg)),
        })
        .collect();
    let places: Vec<Option<f64>> = match_track(&road, &track)
        .into_iter()
        .map(|place| match place {
            Place::OnRoad(distance_m) => Some(distance_m),
            _ => None,
        })
        .collect();
    score_placed(map, &places, &grades)
}

/// Means over runs, one row for each estimate; cells are summed. Estimates come in the order in
/// which they first appear.
pub fn mean(rows: &[ScoreRow]) -> Vec<ScoreRow> {
    let mut estimates: Vec<&'static str> = Vec::new();
    for row in rows {
        if !estimates.contains(&row.estimate) {
            estimates.push(row.estimate);
        }
    }
    estimates
        .into_iter()
        .map(|estimate| {
            let of: Vec<&ScoreRow> = rows.iter().filter(|row| row.estimate == estimate).collect();
            let mean_of = |value: fn(&ScoreRow) -> Option<f64>| {
                let known: Vec<f64> = of.iter().filter_map(|row| value(row)).collect();
                (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
            };
            ScoreRow {
                run: MEAN.into(),
                estimate,
                cells: of.iter().map(|row| row.cells).sum(),
                rmse_percent: mean_of(|row| Some(row.rmse_percent)).unwrap_or_default(),
                rmse_valid_percent: mean_of(|row| row.rmse_valid_percent),
                bias_percent: mean_of(|row| Some(row.bias_percent)).unwrap_or_default(),
                nees: mean_of(|row| Some(row.nees)).unwrap_or_default(),
            }
        })
        .collect()
}

/// Names of the columns of the error table.
pub const HEADER: [&str; 7] = [
    "run",
    "estimate",
    "cells",
    "RMSE %",
    "RMSE valid %",
    "bias %",
    "NEES",
];

/// The rows as text, one entry for each of [`HEADER`].
pub fn text(rows: &[ScoreRow]) -> Vec<Vec<String>> {
    rows.iter()
        .map(|row| {
            vec![
                row.run.clone(),
                row.estimate.into(),
                row.cells.to_string(),
                format!("{:.4}", row.rmse_percent),
                row.rmse_valid_percent
                    .map_or_else(|| "-".into(), |value| format!("{value:.4}")),
                format!("{:+.4}", row.bias_percent),
                format!("{:.2}", row.nees),
            ]
        })
        .collect()
}

/// The rows as an aligned table.
pub fn table(rows: &[ScoreRow]) -> Table {
    text_table(&HEADER, &text(rows), 2)
}

/// The rows as a JSON array.
pub fn json(rows: &[ScoreRow]) -> String {
    let rows: Vec<ScoreRow> = rows.iter().map(ScoreRow::rounded).collect();
    serde_json::json!(rows).to_string()
}

fn score_placed(
    map: &[MapRow],
    places: &[Option<f64>],
    reference: &[(f64, f64)],
) -> Result<ScoreRow, Unscorable> {
    let mut sums = Sums::default();
    for (row, place) in map.iter().zip(places) {
        let ends = (map[0].distance_m, map[map.len() - 1].distance_m);
        if is_end(ends.0, ends.1, row.distance_m) {
            continue;
        }
        if let Some(true_percent) = place.and_then(|at| linear(reference, at)) {
            sums.add(
                row.grade_percent - true_percent,
                row.grade_sigma_percent,
                true,
            );
        }
    }
    sums.row("map", "map")
        .ok_or(Unscorable::NothingLeft { cells: map.len() })
}

fn is_end(first_m: f64, last_m: f64, at_m: f64) -> bool {
    at_m < first_m + END_CUT_M || at_m > last_m - END_CUT_M
}

#[derive(Clone, Copy, Default)]
struct Sums {
    cells: usize,
    error: f64,
    squared: f64,
    normalised: f64,
    valid_cells: usize,
    valid_squared: f64,
}

impl Sums {
    fn add(&mut self, error_percent: f64, sigma_percent: f64, valid: bool) {
        let squared = error_percent * error_percent;
        self.cells += 1;
        self.error += error_percent;
        self.squared += squared;
        self.normalised += squared / (sigma_percent * sigma_percent);
        if valid {
            self.valid_cells += 1;
            self.valid_squared += squared;
        }
    }

    /// `None` if there were no cells.
    fn row(&self, run: &str, estimate: &'static str) -> Option<ScoreRow> {
        let cells = self.cells as f64;
        (self.cells > 0).then(|| ScoreRow {
            run: run.into(),
            estimate,
            cells: self.cells,
            rmse_percent: (self.squared / cells).sqrt(),
            rmse_valid_percent: (self.valid_cells > 0)
                .then(|| (self.valid_squared / self.valid_cells as f64).sqrt()),
            bias_percent: self.error / cells,
            nees: self.normalised / cells,
        })
    }
}
