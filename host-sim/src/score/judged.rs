//! A run file scored together with its companion files.

use super::companions::Companions;
use super::rivals::Rival;
use super::run_score::score_run_beside;
use super::score_row::ScoreRow;
use crate::error::{Error, Result};
use crate::files::run;
use crate::files::truth::TruthRow;
use std::path::Path;

/// The scores of a run, with remarks.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Rows of the error table.
    pub rows: Vec<ScoreRow>,
    /// Estimates that were left out, with the reason.
    pub notes: Vec<String>,
}

/// Scores a run, and the comparison estimates that its files allow.
///
/// # Errors
/// Returns an error if a file cannot be read or used, if the log is of another drive, or if the run
/// has no cell to compare.
pub fn judge(path: &Path, truth: &[TruthRow], files: &Companions) -> Result<Judged> {
    let run = run::read(path)?;
    let name = path.display().to_string();
    let beside = |rivals: &[Rival]| {
        score_run_beside(&name, &run, truth, rivals)
            .map_err(|problem| Error::content(path, problem.to_string()))
    };
    let rivals = files.rivals(&run)?;
    let mut scored = beside(&rivals)?;
    let mut notes: Vec<String> = files.missing().into_iter().map(String::from).collect();
    if scored.beyond_truth > 0 {
        notes.push(format!(
            "{} of {} cells left out, beyond the time span of the truth",
            scored.beyond_truth,
            run.len()
        ));
    }
    let cells = scored.rows[0].cells;
    let shared = |rival: &Rival| {
        let mut rows = scored.rows.iter();
        let row = rows.find(|row| row.estimate == rival.estimate);
        row.map_or(0, |row| row.cells)
    };
    let fewest = rivals.iter().map(shared).min().unwrap_or(cells);
    if fewest < cells {
        let problem = format!("shares {fewest} of {cells} cells with the run");
        if 2 * fewest >= cells {
            notes.push(format!(
                "the log {problem}; the run itself has no ratio to the oracle"
            ));
        } else if let Some(log) = files.named_log() {
            let expected = "expected the log that the run was estimated from";
            return Err(Error::content(log, format!("{problem} {name}; {expected}")));
        } else {
            let left_out = "original, modified and oracle left out";
            notes.push(format!("{left_out}: the log beside the truth {problem}"));
            scored = beside(&[])?;
        }
    }
    Ok(Judged {
        rows: scored.rows,
        notes,
    })
}
