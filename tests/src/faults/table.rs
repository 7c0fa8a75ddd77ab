//! The table of all faults: the first part of `tests/faults.md`.

use super::catalogue::FaultKind;
use super::matrix::{FaultOutcome, FaultRow};
use super::outcome::CellErrors;
use crate::verdict::{Verdict, counts};
use host_sim::terminal::counters::name_of;
use std::fmt::Write;

const HEAD: &str = "\
# Faults and their outcomes

Written by `cargo run -p cross-tests --release --example faults -- --write`; checked by
`tests/tests/faults.rs`. Three parts: faults of bus, senders, receiver and clock; manoeuvres; and
drives with several of them at once, drawn at random. Each is withstood, marked, or not withstood.

Each row of this part is one fault on eight simulated drives of 30 km, four by each truck
(A 39 t, B 12 t). Mass, drag, rolling resistance and torque are wrong by one sigma, the tyres are cold,
and there is wind and a slow GNSS error of 2 m. A fault begins at 600 s. Its name or the second column
states its duration.

Errors are RMSE of grade in %, smoothed / lagged / live. *Before* is before the fault. *With* is from
the start of the fault to 2 km after its end; the value in brackets is that of the same segment without
the fault. *After* is from there to the end of the drive, likewise. NEES is the mean of squared errors
over stated variances, smoothed / lagged / live, with the fault: 1 for consistent sigmas. These are over
all cells; NEES in brackets is over the unmarked ones. *Marked* is the part of the cells with the fault that is marked as suspect, likewise.
*Distance* is the distance error at the end, and the number of missing cells. *Counted* is the increase
of the estimator's counters over the four drives.

*Withstood* means: all values are finite, NEES is below 3 (smoothed and lagged; with the fault and over
the drive), and the error after the fault is at most 1.25 times that without it, plus 0.01 %. *Marked*
means: that holds over the cells that are not marked as suspect, not over all. *Not withstood* means: it
holds over neither; the bars that are missed follow: *NEES*, or *error after* the fault. *No effect*
means: the cells are equal to the last bit. Each fault that is not withstood, or not detected, has its
reason below the table.
";

/// Number of counters that are shown. The others are small or follow from these.
const MOST_KINDS: usize = 4;

/// Returns the table.
#[must_use]
pub fn table(rows: &[FaultRow]) -> String {
    let mut text = format!("{HEAD}\n{}\n", totals(rows));
    let mut kind = None;
    let mut reasons = Vec::new();
    for row in rows {
        if kind != Some(row.fault.kind) {
            kind = Some(row.fault.kind);
            let _ = writeln!(
                text,
                "\n## {}\n\n| fault | for, s | truck | outcome | before | with (without) | after (without) \
                 | NEES | marked, % | distance, m; cells | counted |\n\
                 |---|---|---|---|---|---|---|---|---|---|---|",
                heading(row.fault.kind)
            );
        }
        let mut name = row.fault.name.clone();
        if let Some(reason) = row.fault.short.reason {
            if !reasons.contains(&reason) {
                reasons.push(reason);
            }
            let number = reasons.iter().position(|known| *known == reason);
            let _ = write!(name, " [{}]", number.map_or(0, |index| index + 1));
        }
        for (index, outcome) in row.outcomes.iter().enumerate() {
            let (name, for_s) = if index == 0 {
                (&*name, row.fault.lasts())
            } else {
                ("", String::new())
            };
            let _ = writeln!(
                text,
                "| {name} | {for_s} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
                outcome.truck,
                verdict(row, outcome),
                three(outcome.with.before.rmse_percent()),
                beside(&outcome.with.during, &outcome.without.during),
                beside(&outcome.with.after, &outcome.without.after),
                nees(outcome),
                marked(outcome),
                distance(outcome),
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

/// Returns the rows of real faults, by truck.
fn by_truck(rows: &[FaultRow]) -> impl Iterator<Item = (&FaultRow, &FaultOutcome)> {
    rows.iter()
        .filter(|row| row.fault.kind != FaultKind::Nothing)
        .flat_map(|row| row.outcomes.iter().map(move |outcome| (row, outcome)))
}

/// Returns how many faults have which verdict, and those that are not withstood.
fn totals(rows: &[FaultRow]) -> String {
    let verdicts: Vec<Verdict> = by_truck(rows)
        .map(|(_, outcome)| outcome.verdict())
        .collect();
    let mut text = format!(
        "{} faults, each by two trucks: {}.",
        verdicts.len() / 2,
        counts(&verdicts)
    );
    let lying = by_truck(rows).filter(|(_, outcome)| outcome.verdict() == Verdict::NotWithstood);
    for (index, (row, outcome)) in lying.enumerate() {
        let before = if index == 0 {
            "\n\nNot withstood:\n\n"
        } else {
            ""
        };
        let (name, truck) = (&row.fault.name, outcome.truck);
        let missed = outcome.missed().join(", ");
        let _ = writeln!(text, "{before}- {name}, {truck}: {missed}");
    }
    text.truncate(text.trim_end().len());
    text
}

/// Returns the verdict in words; none where there is no fault.
fn verdict(row: &FaultRow, outcome: &FaultOutcome) -> String {
    if row.fault.kind == FaultKind::Nothing {
        return String::new();
    }
    let words = outcome.verdict().to_string();
    match outcome.missed().join(", ") {
        missed if !missed.is_empty() => format!("{words}: {missed}"),
        _ if !outcome.is_counted() => format!("{words}, not detected"),
        _ => words,
    }
}

/// Returns the marked part of the cells with the fault; nothing where none is marked.
fn marked(outcome: &FaultOutcome) -> String {
    let marked = outcome.marked_percent().map(|part| format!("{part:.0}"));
    if marked.iter().all(|part| part == "0") {
        return String::new();
    }
    marked.join(" / ")
}

const fn heading(kind: FaultKind) -> &'static str {
    match kind {
        FaultKind::Nothing => "None",
        FaultKind::Bus => "Bus",
        FaultKind::Signal => "Senders",
        FaultKind::Receiver => "GNSS receiver",
        FaultKind::Clock => "The receiving clock",
        FaultKind::Attack => "Attacks on the bus",
    }
}

fn three(numbers: [f64; 3]) -> String {
    numbers.map(|number| format!("{number:.3}")).join(" / ")
}

fn beside(with: &CellErrors, without: &CellErrors) -> String {
    if with.cells() == [0; 3] {
        return "–".to_owned();
    }
    format!(
        "{} ({})",
        three(with.rmse_percent()),
        three(without.rmse_percent())
    )
}

/// Returns NEES over all cells with the fault, and over the unmarked ones where some are marked.
fn nees(outcome: &FaultOutcome) -> String {
    let (all, unmarked) = (&outcome.with.during, &outcome.unmarked.during);
    let mut text = normalised(all);
    if all.cells() != unmarked.cells() {
        let _ = write!(text, " ({})", normalised(unmarked));
    }
    text
}

fn normalised(errors: &CellErrors) -> String {
    errors
        .normalised()
        .map(|mean| format!("{mean:.1}"))
        .join(" / ")
}

fn distance(outcome: &FaultOutcome) -> String {
    let distance_m = outcome.distance_m.round();
    let missing = outcome.cells_missing.round();
    if distance_m == 0.0 && missing == 0.0 {
        return String::new();
    }
    format!("{distance_m:+}; {:+}", -missing)
}

fn counted(outcome: &FaultOutcome) -> String {
    let mut kinds: Vec<_> = outcome.counted.iter().collect();
    kinds.sort_by_key(|(key, count)| (std::cmp::Reverse(**count), **key));
    let shown = kinds.iter().take(MOST_KINDS);
    let shown: Vec<String> = shown
        .map(|(key, count)| format!("{} {count}", name_of(key)))
        .collect();
    shown.join(", ")
}
