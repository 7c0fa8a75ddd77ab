//! Scores of a run against its truth, with or without comparison estimates.

use super::rivals::{ORACLE, Rival};
use super::score_row::{ScoreRow, Sums, Unscorable, is_end};
use crate::comparison::ComparisonMethod;
use crate::files::run::RunRow;
use crate::files::truth::TruthRow;
use crate::numeric::series::linear;

/// Returns the flag of a row that says whether an estimate is consistent there.
type Mark = fn(&RunRow) -> u8;

/// The errors of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunScore {
    /// Smoothed, lagged, live, then the comparison estimates that have cells of the run.
    pub rows: Vec<ScoreRow>,
    /// Number of cells outside the time span of the truth; they are left out.
    pub beyond_truth: usize,
}

/// Compares a run with the truth at the same times. Both must be sorted by time.
///
/// # Errors
/// Returns an error if no cell is left to compare.
pub fn score_run(run: &str, rows: &[RunRow], truth: &[TruthRow]) -> Result<RunScore, Unscorable> {
    score_run_beside(run, rows, truth, &[])
}

/// Returns the same, with comparison estimates on the same cells.
///
/// # Errors
/// Returns an error if no cell is left to compare.
pub fn score_run_beside(
    run: &str,
    rows: &[RunRow],
    truth: &[TruthRow],
    rivals: &[Rival],
) -> Result<RunScore, Unscorable> {
    let truth: Vec<(f64, f64)> = truth
        .iter()
        .map(|row| (row.time_s, row.grade_percent))
        .collect();
    let within: Vec<(&RunRow, f64)> = rows
        .iter()
        .filter_map(|row| Some((row, linear(&truth, row.time_s)?)))
        .collect();
    let beyond_truth = rows.len() - within.len();
    let judged: Vec<(&RunRow, f64)> = within
        .into_iter()
        .filter(|(row, _)| {
            let ends = (rows[0].distance_m, rows[rows.len() - 1].distance_m);
            !is_end(ends.0, ends.1, row.distance_m)
        })
        .collect();
    if judged.is_empty() {
        return Err(Unscorable::NothingLeft { cells: rows.len() });
    }
    let score = |estimate, value: &dyn Fn(&RunRow) -> Option<(f64, f64)>, mark: Option<Mark>| {
        let mut sums = Sums::default();
        for (row, true_percent) in &judged {
            if let Some((percent, sigma_percent)) = value(row) {
                let is_consistent = mark.map(|mark| mark(row) == 1);
                let error_percent = percent - true_percent;
                sums.add(error_percent, sigma_percent, row.valid == 1, is_consistent);
            }
        }
        sums.row(run, estimate)
    };
    let own = [
        score(
            "smoothed",
            &|row| Some(row.smoothed()),
            Some(|row| row.consistent),
        ),
        score(
            "lagged",
            &|row| Some(row.lagged()),
            Some(|row| row.lagged_consistent),
        ),
        score(
            "live",
            &|row| Some(row.live()),
            Some(|row| row.live_consistent),
        ),
    ];
    let others = rivals
        .iter()
        .map(|rival| score(rival.estimate, &|row| rival.at(row), None));
    let mut rows: Vec<ScoreRow> = own.into_iter().chain(others).flatten().collect();
    compare_with_oracle(&mut rows);
    Ok(RunScore { rows, beyond_truth })
}

/// Sets the ratio to the oracle in each row where the oracle has an estimate on the same cells.
fn compare_with_oracle(rows: &mut [ScoreRow]) {
    let [oracle, oracle_lagged, oracle_live] = ORACLE;
    let [original, modified] = ComparisonMethod::BOTH.map(ComparisonMethod::word);
    for (estimate, oracle) in [
        ("smoothed", oracle),
        ("lagged", oracle_lagged),
        ("live", oracle_live),
        (original, oracle),
        (modified, oracle),
    ] {
        let find = |name| rows.iter().position(|row| row.estimate == name);
        let (Some(row), Some(best)) = (find(estimate), find(oracle)) else {
            continue;
        };
        if rows[row].cells == rows[best].cells && rows[best].rmse_percent > 0.0 {
            rows[row].oracle_ratio = Some(rows[row].rmse_percent / rows[best].rmse_percent);
        }
    }
}
