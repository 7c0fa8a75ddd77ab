//! The table of the bench, its totals, and both as JSON.

use super::bench::BenchRow;
use super::drives::BenchTruck;
use super::judge::{FEW_WINDOWS, HONEST, Judgement, KindJudgement, WORST};
use host_sim::terminal::table::text_table;
use serde_json::{Value, json};
use std::fmt::Write;

/// Returns the table and the totals.
#[must_use]
pub fn table(rows: &[BenchRow]) -> String {
    let header = [
        "manoeuvre or fault",
        "truck",
        "seed",
        "RMSE % s/l/v",
        "NEES s/l/v",
        "worst 5 km",
        "marked %",
        "verdict",
    ];
    let lines: Vec<Vec<String>> = rows.iter().map(line).collect();
    let mut text = text_table(&header, &lines, 2).to_string();
    let _ = write!(text, "\n\n{}", Totals::of(rows).text());
    text
}

fn line(row: &BenchRow) -> Vec<String> {
    let plan = &row.plan;
    let mut line = vec![
        plan.name.clone(),
        plan.truck.name().to_owned(),
        plan.seed.to_string(),
    ];
    match &row.judgement {
        Ok(judgement) => line.extend([
            three(judgement, |of| format!("{:.3}", of.rmse_percent)),
            three(judgement, |of| of.nees.map_or_else(|| "–".into(), short)),
            three(judgement, |of| short(of.worst())),
            three(judgement, |of| format!("{:.0}", of.marked_percent)),
            verdict(judgement),
        ]),
        Err(error) => {
            line.extend(std::iter::repeat_n(String::new(), 4));
            line.push(error.clone());
        }
    }
    line
}

/// Returns a number of each kind of estimate: smoothed, lagged and live.
pub(super) fn three(judgement: &Judgement, of: impl Fn(&KindJudgement) -> String) -> String {
    judgement.of.iter().map(of).collect::<Vec<_>>().join(" / ")
}

/// Returns a number with a decimal if it is below 10.
pub(super) fn short(number: f64) -> String {
    if number < 9.95 {
        format!("{number:.1}")
    } else {
        format!("{number:.0}")
    }
}

/// Returns what is not met; an asterisk where the smoothed error is above 1.5 times that without a
/// fault, plus 0.02 %.
fn verdict(judgement: &Judgement) -> String {
    let complaints = judgement.complaints();
    let words = if complaints.is_empty() {
        "ok".to_owned()
    } else {
        complaints.join(", ")
    };
    let star = if judgement.keeps_accuracy { "" } else { " *" };
    words + star
}

/// Sums over all drives.
#[derive(Clone, Debug, Default)]
pub(super) struct Totals {
    drives: usize,
    failed: usize,
    lying: usize,
    unmet: usize,
    windows: [usize; 3],
    above: [usize; 3],
    far_above: [usize; 3],
    marked_without_fault_percent: [f64; 3],
    /// Part of the marked cells of drives with a fault that are right, %.
    right_percent: [f64; 3],
    /// Mean RMSE and mean median sigma of each truck on drives without a fault, %.
    without_fault: Vec<(&'static str, [f64; 3], [f64; 3])>,
}

impl Totals {
    pub(super) fn of(rows: &[BenchRow]) -> Self {
        let judgements: Vec<&Judgement> = rows
            .iter()
            .filter_map(|row| row.judgement.as_ref().ok())
            .collect();
        let count = |kind: usize, above: f64| {
            let windows = judgements
                .iter()
                .flat_map(|judgement| &judgement.of[kind].windows);
            windows.filter(|nees| **nees > above).count()
        };
        let marked = |kind: usize| {
            let faultless = judgements.iter().filter(|j| !j.has_fault);
            mean(faultless.map(|j| (j.of[kind].marked_percent, 1.0)))
        };
        let right = |kind: usize| {
            let faulty = judgements.iter().filter(|j| j.has_fault);
            mean(faulty.map(|j| (j.of[kind].right_percent, j.of[kind].marked_percent)))
        };
        Self {
            drives: rows.len(),
            failed: rows.len() - judgements.len(),
            lying: judgements.iter().filter(|j| j.lies()).count(),
            unmet: judgements
                .iter()
                .filter(|j| !j.complaints().is_empty())
                .count(),
            windows: [0, 1, 2].map(|kind| count(kind, f64::NEG_INFINITY)),
            above: [0, 1, 2].map(|kind| count(kind, HONEST)),
            far_above: [0, 1, 2].map(|kind| count(kind, WORST)),
            marked_without_fault_percent: [0, 1, 2].map(marked),
            right_percent: [0, 1, 2].map(right),
            without_fault: BenchTruck::ALL
                .into_iter()
                .filter_map(|truck| without_fault(rows, truck))
                .collect(),
        }
    }

    /// Returns true if every bar of single drives and of windows is met.
    fn is_met(&self) -> bool {
        let few = |kind: usize| self.above[kind] as f64 <= FEW_WINDOWS * self.windows[kind] as f64;
        self.failed == 0
            && self.unmet == 0
            && (0..3).all(|kind| few(kind) && self.far_above[kind] == 0)
    }

    pub(super) fn text(&self) -> String {
        let of = |counts: [usize; 3]| counts.map(|count| count.to_string()).join(" / ");
        let percent = |values: [f64; 3], digits: usize| {
            values.map(|value| format!("{value:.digits$}")).join(" / ")
        };
        let mut text = String::new();
        for (truck, rmse, sigma) in &self.without_fault {
            let _ = writeln!(
                text,
                "without a fault, truck {truck}: RMSE % {}; median sigma % {}",
                percent(*rmse, 3),
                percent(*sigma, 3)
            );
        }
        text + &format!(
            "{} drives: {} lie, {} miss a bar (lies included), {} without result\n\
             windows of 5 km (s/l/v): {}; NEES above {HONEST}: {}; above {WORST}: {}\n\
             marked without a fault, % (s/l/v): {}; right of those marked with a fault, %: {}\n\
             bars {}; * smoothed error above 1.5 times that without the fault, plus 0.02 %",
            self.drives,
            self.lying,
            self.unmet,
            self.failed,
            of(self.windows),
            of(self.above),
            of(self.far_above),
            percent(self.marked_without_fault_percent, 2),
            percent(self.right_percent, 0),
            if self.is_met() { "met" } else { "NOT met" },
        )
    }
}

/// Returns the weighted mean of values with their weights; 0 without any.
fn mean(values: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, weights) = values.fold((0.0, 0.0), |(sum, weights), (value, weight)| {
        (sum + value * weight, weights + weight)
    });
    if weights > 0.0 { sum / weights } else { 0.0 }
}

/// Returns the truck, its mean RMSE and its mean sigma on drives without a fault, %.
fn without_fault(
    rows: &[BenchRow],
    truck: BenchTruck,
) -> Option<(&'static str, [f64; 3], [f64; 3])> {
    let judgements: Vec<&Judgement> = rows
        .iter()
        .filter(|row| row.plan.truck == truck && row.plan.faults.is_empty())
        .filter_map(|row| row.judgement.as_ref().ok())
        .collect();
    let of = |value: fn(&KindJudgement) -> f64| {
        [0, 1, 2].map(|kind| mean(judgements.iter().map(|j| (value(&j.of[kind]), 1.0))))
    };
    (!judgements.is_empty()).then(|| {
        let (rmse, sigma) = (of(|kind| kind.rmse_percent), of(|kind| kind.sigma_percent));
        (truck.name(), rmse, sigma)
    })
}

/// Returns the part of the drives that lie or have no result, %.
#[must_use]
pub fn lying_percent(rows: &[BenchRow]) -> f64 {
    let totals = Totals::of(rows);
    100.0 * (totals.lying + totals.failed) as f64 / totals.drives.max(1) as f64
}

/// Returns rows and totals as JSON.
#[must_use]
pub fn json(rows: &[BenchRow]) -> Value {
    let drives: Vec<Value> = rows
        .iter()
        .map(|row| {
            let mut drive = json!({
                "name": row.plan.name,
                "truck": row.plan.truck.name(),
                "seed": row.plan.seed,
            });
            match &row.judgement {
                Ok(judgement) => {
                    drive["complaints"] = json!(judgement.complaints());
                    drive["judgement"] = json!(judgement);
                }
                Err(error) => drive["error"] = json!(error),
            }
            drive
        })
        .collect();
    let totals = Totals::of(rows);
    json!({
        "drives": drives,
        "lying": totals.lying,
        "unmet": totals.unmet,
        "failed": totals.failed,
        "windows": totals.windows,
        "windows_above_4": totals.above,
        "windows_above_9": totals.far_above,
        "without_fault": totals
            .without_fault
            .iter()
            .map(|(truck, rmse, sigma)| {
                json!({"truck": truck, "rmse_percent": rmse, "median_sigma_percent": sigma})
            })
            .collect::<Vec<_>>(),
        "met": totals.is_met(),
    })
}
