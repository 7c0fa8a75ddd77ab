//! One row of the error table, and means over rows.

use crate::numeric::rounding::round;
use serde::Serialize;

/// Distance that is left out at both ends, m.
pub const END_CUT_M: f64 = 500.0;

/// Name of the rows that hold the mean over runs.
pub const MEAN: &str = "mean";

/// One row of the error table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScoreRow {
    /// Name of the run, or [`MEAN`].
    pub run: String,
    /// `smoothed`, `lagged`, `live`, one of the [`rivals`](super::rivals), or `map`.
    pub estimate: &'static str,
    /// Number of cells compared.
    pub cells: usize,
    /// RMSE of the grade over all cells, %.
    pub rmse_percent: f64,
    /// RMSE over the cells without shift or braking, %; `None` if there are none.
    pub rmse_valid_percent: Option<f64>,
    /// Mean of estimate minus truth, %.
    pub bias_percent: f64,
    /// Mean normalised squared error.
    pub nees: f64,
    /// RMSE over that of the oracle on the same cells. The lagged and the live grade are compared
    /// with the oracle's lagged and live grade, all others with its smoothed grade.
    pub oracle_ratio: Option<f64>,
    /// Part of the cells that are marked as suspect, %; `None` for an estimate without marks.
    pub marked_percent: Option<f64>,
    /// Mean normalised squared error of the others; `None` if there are none.
    pub nees_unmarked: Option<f64>,
}

impl ScoreRow {
    /// Returns the row with the decimals of the files.
    pub fn rounded(&self) -> Self {
        Self {
            run: self.run.clone(),
            estimate: self.estimate,
            cells: self.cells,
            rmse_percent: round(self.rmse_percent, 5),
            rmse_valid_percent: self.rmse_valid_percent.map(|value| round(value, 5)),
            bias_percent: round(self.bias_percent, 5),
            nees: round(self.nees, 4),
            oracle_ratio: self.oracle_ratio.map(|value| round(value, 4)),
            marked_percent: self.marked_percent.map(|value| round(value, 3)),
            nees_unmarked: self.nees_unmarked.map(|value| round(value, 4)),
        }
    }
}

/// Reasons why there is no score.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unscorable {
    /// The run is too short, or at another time than the truth.
    #[error(
        "no cell of {cells} both within the truth and {END_CUT_M} m away from either end; \
         expected a longer run, or the truth of this drive"
    )]
    NothingLeft {
        /// Number of cells of the run.
        cells: usize,
    },
    /// A reference without a grade.
    #[error("no grade_percent; expected a reference with the grade of each point")]
    NoGrade,
    /// The reference is not a line.
    #[error(transparent)]
    Road(#[from] crate::map::RoadProblem),
}

/// Returns the means over runs, one row for each estimate, in the order of their first rows.
/// Numbers of cells are summed. The ratio to the oracle is that of mean RMSEs, over the runs that
/// have an oracle.
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
                oracle_ratio: ratio_of_means(&of),
                marked_percent: mean_of(|row| row.marked_percent),
                nees_unmarked: mean_of(|row| row.nees_unmarked),
            }
        })
        .collect()
}

fn ratio_of_means(rows: &[&ScoreRow]) -> Option<f64> {
    let (ours, oracles) = rows
        .iter()
        .filter_map(|row| Some((row.rmse_percent, row.oracle_ratio.filter(|r| *r > 0.0)?)))
        .fold((0.0, 0.0), |sum, (rmse, ratio)| {
            (sum.0 + rmse, sum.1 + rmse / ratio)
        });
    (oracles > 0.0).then(|| ours / oracles)
}

/// Returns whether a cell is at an end of a run.
pub(super) fn is_end(first_m: f64, last_m: f64, at_m: f64) -> bool {
    at_m < first_m + END_CUT_M || at_m > last_m - END_CUT_M
}

/// Sums of errors over cells.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums {
    cells: usize,
    error: f64,
    squared: f64,
    normalised: f64,
    valid_cells: usize,
    valid_squared: f64,
    /// Cells with a mark for or against them, and those of them that are consistent.
    known_cells: usize,
    consistent_cells: usize,
    consistent_normalised: f64,
}

impl Sums {
    /// Adds a cell. `is_consistent` is `None` for an estimate without marks.
    pub(super) fn add(
        &mut self,
        error_percent: f64,
        sigma_percent: f64,
        valid: bool,
        is_consistent: Option<bool>,
    ) {
        let squared = error_percent * error_percent;
        self.cells += 1;
        self.error += error_percent;
        self.squared += squared;
        let normalised = squared / (sigma_percent * sigma_percent);
        self.normalised += normalised;
        if let Some(is_consistent) = is_consistent {
            self.known_cells += 1;
            if is_consistent {
                self.consistent_cells += 1;
                self.consistent_normalised += normalised;
            }
        }
        if valid {
            self.valid_cells += 1;
            self.valid_squared += squared;
        }
    }

    /// Returns the row of these sums; `None` without cells.
    pub(super) fn row(&self, run: &str, estimate: &'static str) -> Option<ScoreRow> {
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
            oracle_ratio: None,
            marked_percent: (self.known_cells > 0).then(|| {
                let marked = self.known_cells - self.consistent_cells;
                100.0 * marked as f64 / self.known_cells as f64
            }),
            nees_unmarked: (self.consistent_cells > 0)
                .then(|| self.consistent_normalised / self.consistent_cells as f64),
        })
    }
}
