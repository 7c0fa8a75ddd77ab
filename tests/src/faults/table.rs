//! The table of the matrix, `tests/faults.md`.

use super::catalogue::FaultKind;
use super::matrix::{FaultOutcome, FaultRow};
use super::outcome::CellErrors;
use crate::image::root;
use std::fmt::Write;
use std::path::PathBuf;

const HEAD: &str = "\
# Faults, and what comes of them

Written by `cargo run -p cross-tests --release --example faults -- --write`; checked by
`tests/tests/faults.rs`. Each row is one fault on eight simulated drives of 30 km, four by each truck
(A 39 t, B 12 t), with mass, drag, rolling resistance and torque wrong by one sigma, cold tyres, wind
and a slow GNSS error of 2 m. A fault begins at 600 s and lasts as long as its name says, else for the
time given.

CellErrors are RMSE of grade in %, smoothed / lagged / live: before the fault; with it (from its begin to
2 km after its end) and, in brackets, on the same stretch without it; and from there to the end of the
drive, likewise. NEES is the mean of squared errors over stated variances, smoothed / lagged / live,
with the fault (as above): 1 where sigmas are honest. *Counted* is what the estimator's counters tell
more than without the fault, over the four drives. *Way* is what the distance is off at the end, and
how many cells are missing.

*Withstood*: numbers that are numbers, NEES below 3 (smoothed and lagged; with the fault and over the
drive), and the error after it at most 1.25 times what it is without, plus 0.01 %. *No effect*: the
cells are the same to the last bit. What is not withstood, or not seen, has its reason below the table.
";

/// Counted kinds that are shown; the rest are few or follow from these.
const MOST_KINDS: usize = 4;

/// Returns where the table is.
#[must_use]
pub fn committed_file() -> PathBuf {
    root().join("tests/faults.md")
}

/// Returns the table.
#[must_use]
pub fn table(rows: &[FaultRow]) -> String {
    let mut text = HEAD.to_owned();
    let mut kind = None;
    let mut reasons = Vec::new();
    for row in rows {
        if kind != Some(row.fault.kind) {
            kind = Some(row.fault.kind);
            let _ = writeln!(
                text,
                "\n## {}\n\n| fault | for, s | truck | outcome | before | with (without) | after (without) \
                 | NEES | way, m; cells | counted |\n|---|---|---|---|---|---|---|---|---|---|",
                heading(row.fault.kind)
            );
        }
        let mut verdict = row.verdict().to_owned();
        if let Some(reason) = row.fault.short.reason {
            if !reasons.contains(&reason) {
                reasons.push(reason);
            }
            let number = reasons.iter().position(|known| *known == reason);
            let _ = write!(verdict, " [{}]", number.map_or(0, |index| index + 1));
        }
        for (index, outcome) in row.outcomes.iter().enumerate() {
            let (name, for_s, verdict) = if index == 0 {
                (&*row.fault.name, row.fault.lasts(), &*verdict)
            } else {
                ("", String::new(), "")
            };
            let _ = writeln!(
                text,
                "| {name} | {for_s} | {} | {verdict} | {} | {} | {} | {} | {} | {} |",
                outcome.truck,
                three(outcome.with.before.rmse_percent()),
                beside(&outcome.with.during, &outcome.without.during),
                beside(&outcome.with.after, &outcome.without.after),
                normalised(&outcome.with.during),
                way(outcome),
                counted(outcome)
            );
        }
    }
    text.push('\n');
    for (index, reason) in reasons.iter().enumerate() {
        let _ = writeln!(text, "[{}] {reason}\n", index + 1);
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

const fn heading(kind: FaultKind) -> &'static str {
    match kind {
        FaultKind::Nothing => "None",
        FaultKind::Bus => "The bus",
        FaultKind::Signal => "Senders",
        FaultKind::Receiver => "The GNSS receiver",
        FaultKind::Clock => "The listener's clock",
        FaultKind::Attack => "Somebody else on the bus",
    }
}

fn three(numbers: [f64; 3]) -> String {
    numbers.map(|number| format!("{number:.3}")).join(" / ")
}

fn beside(with: &CellErrors, without: &CellErrors) -> String {
    if with.cells() == 0 {
        return "–".to_owned();
    }
    format!(
        "{} ({})",
        three(with.rmse_percent()),
        three(without.rmse_percent())
    )
}

fn normalised(errors: &CellErrors) -> String {
    errors
        .normalised()
        .map(|mean| format!("{mean:.1}"))
        .join(" / ")
}

fn way(outcome: &FaultOutcome) -> String {
    let way_m = outcome.way_m.round();
    let missing = outcome.cells_missing.round();
    if way_m == 0.0 && missing == 0.0 {
        return String::new();
    }
    format!("{way_m:+}; {:+}", -missing)
}

fn counted(outcome: &FaultOutcome) -> String {
    let mut kinds: Vec<_> = outcome.counted.iter().collect();
    kinds.sort_by_key(|(name, count)| (std::cmp::Reverse(**count), **name));
    let shown = kinds.iter().take(MOST_KINDS);
    let shown: Vec<String> = shown
        .map(|(name, count)| format!("{name} {count}"))
        .collect();
    shown.join(", ")
}
