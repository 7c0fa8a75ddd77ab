//! The judge: errors against sigmas, over a drive and in windows of it, and the bars.
//!
//! NEES, the normalised estimation error squared, is the mean of (error / sigma)² over unmarked
//! cells: 1 where sigmas are honest. RMSE is over all cells.

use super::cells::{JudgedCell, RunCells};
use crate::verdict::Verdict;
use serde::Serialize;

/// Length of a window, m.
const WINDOW_M: f64 = 5_000.0;
/// Fewest unmarked cells of a window that counts: 1 km.
const WINDOW_CELLS: usize = 400;
/// Largest NEES of a drive, and of all but a few windows.
pub const HONEST: f64 = 4.0;
/// Largest NEES of any window.
pub const WORST: f64 = 9.0;
/// Largest part of windows with a NEES above [`HONEST`].
pub const FEW_WINDOWS: f64 = 0.01;
/// Largest part of the marked cells with an error within two sigmas of a drive without a fault.
const RIGHT_PART: f64 = 0.1;
/// Largest part of marked cells on a drive without a fault.
const MARKED_WITHOUT_FAULT: f64 = 0.01;
/// Way after the end of a fault on which cells may be marked, m.
const MARKS_END_M: f64 = 5_000.0;
/// Smoothed RMSE with a fault: factor on that of the same drive without it, and in addition, %.
const SPOILT: (f64, f64) = (1.5, 0.02);

/// The complaint about a drive whose sigmas are far too small.
const LIES: &str = "LIES";

/// Means of the drive without a fault: smoothed, lagged and live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Smoothed RMSE, %.
    pub rmse_percent: f64,
    /// Median sigmas, %.
    pub sigma_percent: [f64; 3],
}

/// The judgement of one kind of estimate.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct KindJudgement {
    /// Error over all cells, %.
    pub rmse_percent: f64,
    /// Over all unmarked cells; `None` without any.
    pub nees: Option<f64>,
    /// NEES of each window with enough unmarked cells.
    pub windows: Vec<f64>,
    /// Marked part of the cells, %.
    pub marked_percent: f64,
    /// Part of the marked cells that are right, %: within two sigmas of a drive without a fault.
    pub right_percent: f64,
    /// Farthest marked cell after the end of a fault, m.
    pub marks_last_m: f64,
    /// Median sigma of unmarked cells, %.
    pub sigma_percent: f64,
}

impl KindJudgement {
    /// Returns the largest NEES of a window; 0 without windows.
    #[must_use]
    pub fn worst(&self) -> f64 {
        self.windows.iter().copied().fold(0.0, f64::max)
    }

    /// Returns whether the NEES of the drive is small enough.
    fn is_honest(&self) -> bool {
        self.nees.is_none_or(|nees| nees <= HONEST)
    }

    /// Returns whether that of each window is.
    fn has_honest_windows(&self) -> bool {
        self.windows.iter().all(|nees| *nees <= WORST)
    }

    fn lies(&self) -> bool {
        !self.is_honest() || !self.has_honest_windows()
    }

    fn of(cells: &[JudgedCell], kind: usize, reference: Option<&Reference>) -> Self {
        let is_live = kind == 2;
        let all = cells.iter().map(|cell| (cell, cell.of[kind]));
        let count = cells.len().max(1) as f64;
        let squares: f64 = all.clone().map(|(_, of)| of.error_percent.powi(2)).sum();
        let marked: Vec<_> = all.clone().filter(|(_, of)| of.is_marked).collect();
        let right = marked.iter().filter(|(_, of)| {
            reference.is_some_and(|r| of.error_percent.abs() < 2.0 * r.sigma_percent[kind])
        });
        let unmarked: Vec<(f64, f64)> = all
            .clone()
            .filter(|(cell, of)| !(of.is_marked || is_live && cell.is_onset))
            .map(|(cell, of)| {
                let ratio = of.error_percent / of.sigma_percent;
                (cell.driven_m, ratio * ratio)
            })
            .collect();
        let mut sigmas: Vec<f64> = all
            .filter(|(_, of)| !of.is_marked)
            .map(|(_, of)| of.sigma_percent)
            .collect();
        sigmas.sort_by(f64::total_cmp);
        let after = marked.iter().filter_map(|(cell, _)| cell.after_m);
        Self {
            rmse_percent: (squares / count).sqrt(),
            nees: mean(&unmarked),
            windows: windows(&unmarked),
            marked_percent: 100.0 * marked.len() as f64 / count,
            right_percent: 100.0 * right.count() as f64 / marked.len().max(1) as f64,
            marks_last_m: after.fold(0.0, f64::max),
            sigma_percent: sigmas.get(sigmas.len() / 2).copied().unwrap_or(0.0),
        }
    }
}

fn mean(squares: &[(f64, f64)]) -> Option<f64> {
    let sum: f64 = squares.iter().map(|square| square.1).sum();
    (!squares.is_empty()).then(|| sum / squares.len() as f64)
}

/// Returns the NEES of each window with enough cells.
fn windows(squares: &[(f64, f64)]) -> Vec<f64> {
    let window = |square: &(f64, f64)| (square.0 / WINDOW_M) as i64;
    squares
        .chunk_by(|a, b| window(a) == window(b))
        .filter(|part| part.len() >= WINDOW_CELLS)
        .filter_map(mean)
        .collect()
}

/// The judgement of a drive.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Judgement {
    /// Smoothed, lagged and live.
    pub of: [KindJudgement; 3],
    /// True if something was wrong on the drive.
    pub has_fault: bool,
    /// Cells made while the vehicle reversed.
    pub in_reverse: usize,
    /// True if the smoothed error is within the bar relative to the drive without a fault.
    pub keeps_accuracy: bool,
    /// True if the drive would lie without its marks.
    pub needs_marks: bool,
}

impl Judgement {
    /// Judges a run. `reference` is that of the same drive without a fault.
    #[must_use]
    pub fn new(run: &RunCells, has_fault: bool, reference: Option<&Reference>) -> Self {
        let of = [0, 1, 2].map(|kind| KindJudgement::of(&run.cells, kind, reference));
        let limit = reference.map_or(f64::INFINITY, |r| SPOILT.0 * r.rmse_percent + SPOILT.1);
        let bare: Vec<JudgedCell> = run.cells.iter().map(JudgedCell::without_marks).collect();
        let lies_bare = |kind| KindJudgement::of(&bare, kind, None).lies();
        Self {
            keeps_accuracy: of[0].rmse_percent <= limit,
            needs_marks: [0, 1, 2].into_iter().any(lies_bare),
            of,
            has_fault,
            in_reverse: run.in_reverse,
        }
    }

    /// Returns what a drive without a fault is a reference for.
    #[must_use]
    pub fn reference(&self) -> Reference {
        Reference {
            rmse_percent: self.of[0].rmse_percent,
            sigma_percent: [0, 1, 2].map(|kind| self.of[kind].sigma_percent),
        }
    }

    /// Returns true if sigmas of unmarked cells are far too small.
    #[must_use]
    pub fn lies(&self) -> bool {
        self.of.iter().any(KindJudgement::lies)
    }

    /// Returns what becomes of the drive.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if !self.complaints().is_empty() {
            Verdict::NotWithstood
        } else if self.needs_marks {
            Verdict::Marked
        } else {
            Verdict::Withstood
        }
    }

    /// Returns the bars that the drive does not meet, with the kinds of estimate that miss those of
    /// the sigmas.
    #[must_use]
    pub fn missed(&self) -> Vec<String> {
        let kinds = |test: fn(&KindJudgement) -> bool| {
            let kinds = ["smoothed", "lagged", "live"].into_iter().zip(&self.of);
            let missing = kinds.filter_map(|(name, of)| test(of).then_some(name));
            missing.collect::<Vec<_>>().join(", ")
        };
        let sigmas = [
            ("NEES", kinds(|of| !of.is_honest())),
            ("window", kinds(|of| !of.has_honest_windows())),
        ];
        let sigmas = sigmas
            .into_iter()
            .filter_map(|(bar, kinds)| (!kinds.is_empty()).then(|| format!("{bar} ({kinds})")));
        let others = self.complaints().into_iter().filter(|bar| *bar != LIES);
        sigmas.chain(others.map(str::to_owned)).collect()
    }

    /// Returns the bars that the drive does not meet.
    #[must_use]
    pub fn complaints(&self) -> Vec<&'static str> {
        let mut complaints = Vec::new();
        if self.lies() {
            complaints.push(LIES);
        }
        let any = |test: fn(&KindJudgement) -> bool| self.of.iter().any(test);
        if self.has_fault && any(|of| of.right_percent > 100.0 * RIGHT_PART) {
            complaints.push("marks right cells");
        }
        if self.has_fault && any(|of| of.marks_last_m > MARKS_END_M) {
            complaints.push("marks last");
        }
        if !self.has_fault && any(|of| of.marked_percent > 100.0 * MARKED_WITHOUT_FAULT) {
            complaints.push("marks without fault");
        }
        if self.in_reverse > 0 {
            complaints.push("cells in reverse");
        }
        complaints
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manoeuvres::cells::Judged;

    /// Cells of 2.5 m, of which each has the same error over sigma of 0.1 %.
    fn cells(from_m: f64, to_m: f64, ratio: f64, is_marked: bool) -> Vec<JudgedCell> {
        let count = ((to_m - from_m) / 2.5) as usize;
        (0..count)
            .map(|index| JudgedCell {
                driven_m: from_m + 2.5 * index as f64,
                of: [Judged {
                    error_percent: 0.1 * ratio,
                    sigma_percent: 0.1,
                    is_marked,
                }; 3],
                is_onset: false,
                after_m: None,
            })
            .collect()
    }

    fn run(parts: &[Vec<JudgedCell>]) -> RunCells {
        RunCells {
            cells: parts.concat(),
            in_reverse: 0,
        }
    }

    const REFERENCE: Reference = Reference {
        rmse_percent: 0.1,
        sigma_percent: [0.1; 3],
    };

    #[test]
    fn known_errors_give_known_numbers() {
        let run = run(&[
            cells(500.0, 10_000.0, 1.0, false),
            cells(10_000.0, 15_000.0, 3.5, false),
            cells(15_000.0, 20_000.0, 1.0, false),
        ]);
        let judgement = Judgement::new(&run, true, Some(&REFERENCE));
        let live = &judgement.of[2];
        assert!((live.nees.unwrap() - (14_500.0 + 5_000.0 * 12.25) / 19_500.0).abs() < 1e-9);
        assert_eq!(live.windows.len(), 4);
        assert!((live.worst() - 12.25).abs() < 1e-9);
        assert!((live.sigma_percent - 0.1).abs() < 1e-12);
        assert_eq!(judgement.complaints(), ["LIES"]);
        assert_eq!(judgement.missed(), ["window (smoothed, lagged, live)"]);
        assert_eq!(judgement.verdict(), Verdict::NotWithstood);
        let rmse = 0.1 * live.nees.unwrap().sqrt();
        assert!((live.rmse_percent - rmse).abs() < 1e-9);
        assert!(!judgement.keeps_accuracy);
    }

    #[test]
    fn marked_cells_do_not_lie_but_must_be_wrong() {
        let wrong = run(&[
            cells(500.0, 10_000.0, 1.0, false),
            cells(10_000.0, 15_000.0, 9.0, true),
        ]);
        let judgement = Judgement::new(&wrong, true, Some(&REFERENCE));
        assert!(judgement.complaints().is_empty());
        assert_eq!(judgement.verdict(), Verdict::Marked);
        assert!((judgement.of[0].nees.unwrap() - 1.0).abs() < 1e-9);
        assert!((judgement.of[0].marked_percent - 100.0 * 5.0 / 14.5).abs() < 1e-9);
        let right = run(&[
            cells(500.0, 10_000.0, 1.0, false),
            cells(10_000.0, 15_000.0, 1.0, true),
        ]);
        let judgement = Judgement::new(&right, true, Some(&REFERENCE));
        assert_eq!(judgement.complaints(), ["marks right cells"]);
        let judgement = Judgement::new(&right, false, Some(&REFERENCE));
        assert_eq!(judgement.complaints(), ["marks without fault"]);
    }

    #[test]
    fn the_live_estimate_has_500_m_and_marks_5_km() {
        let mut onset = cells(5_000.0, 5_500.0, 20.0, false);
        for cell in &mut onset {
            cell.is_onset = true;
        }
        let mut late = cells(30_000.0, 31_000.0, 9.0, true);
        for cell in &mut late {
            cell.after_m = Some(6_000.0);
        }
        let run = run(&[cells(500.0, 5_000.0, 1.0, false), onset, late]);
        let judgement = Judgement::new(&run, true, Some(&REFERENCE));
        assert!((judgement.of[2].nees.unwrap() - 1.0).abs() < 1e-9);
        assert!(judgement.of[0].nees.unwrap() > HONEST);
        assert_eq!(judgement.complaints(), ["LIES", "marks last"]);
    }

    #[test]
    fn a_nan_lies() {
        let run = run(&[cells(500.0, 10_000.0, f64::NAN, false)]);
        assert!(Judgement::new(&run, false, None).lies());
    }
}
