//! Whether the estimate of a drive can be trusted.

use super::plausibility::Warning;
use crate::smooth::Disagreements;
use crate::terminal::disagreements::WORDS;
use estimator_core::CELL_LENGTH_M;
use serde::Serialize;

/// Part of the cells beyond which a drive is suspect.
const SUSPECT_PART: f64 = 0.01;
/// Length of the marked cells from which a drive can be suspect, m.
const SUSPECT_M: f64 = 200.0;
/// Stretches of one kind that are closer to each other are told as one, m.
const JOIN_M: f64 = 100.0;

/// A stretch of a drive in which signals disagree.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisagreementStretch {
    /// What disagrees.
    pub what: &'static str,
    /// Distance at which it begins, m.
    pub from_m: f64,
    /// Distance at which it ends, m.
    pub to_m: f64,
}

/// Returns the stretches in which signals disagree, in the order of the drive.
#[must_use]
pub fn stretches(disagreements: &Disagreements) -> Vec<DisagreementStretch> {
    let mut found = Vec::new();
    for (what, ranges) in WORDS.into_iter().zip(disagreements.by_kind()) {
        let mut of_kind: Vec<DisagreementStretch> = Vec::new();
        for range in ranges.iter() {
            // A cell has the number of its end.
            let from_m = end_of(range.start().saturating_sub(1));
            let to_m = end_of(*range.end());
            match of_kind.last_mut() {
                Some(before) if from_m - before.to_m < JOIN_M => before.to_m = to_m,
                _ => of_kind.push(DisagreementStretch { what, from_m, to_m }),
            }
        }
        found.extend(of_kind);
    }
    found.sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
    found
}

/// Returns the verdict on a drive with so many cells, of which so many are marked: `consistent`, or
/// `suspect: `, the warnings that spoil the estimate, and what disagrees, the longest first.
#[must_use]
pub fn verdict(
    cells: usize,
    marked: usize,
    stretches: &[DisagreementStretch],
    warnings: &[Warning],
) -> String {
    let mut words: Vec<&str> = warnings.iter().filter_map(|of| of.spoils).collect();
    let is_suspect = marked as f64 > SUSPECT_PART * cells as f64
        && marked as f64 * f64::from(CELL_LENGTH_M) >= SUSPECT_M;
    if is_suspect {
        words.extend(kinds(stretches));
    } else if words.is_empty() {
        return "consistent".to_owned();
    }
    format!("suspect: {}", words.join("; "))
}

/// Returns what disagrees, the longest first.
fn kinds(stretches: &[DisagreementStretch]) -> Vec<&'static str> {
    let length_m = |what: &str| -> f64 {
        let of_kind = stretches.iter().filter(|stretch| stretch.what == what);
        of_kind.map(|stretch| stretch.to_m - stretch.from_m).sum()
    };
    let mut kinds: Vec<(&str, f64)> = WORDS.map(|what| (what, length_m(what))).to_vec();
    kinds.retain(|(_, length_m)| *length_m > 0.0);
    kinds.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    kinds.into_iter().map(|(what, _)| what).collect()
}

fn end_of(cell: u32) -> f64 {
    f64::from(cell) * f64::from(CELL_LENGTH_M)
}
