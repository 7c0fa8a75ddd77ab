//! The parts of `tests/faults.md` on manoeuvres, by name and drawn at random.

use super::bench::{BenchRow, bench};
use super::catalogue::catalogue;
use super::random::drawn;
use super::road::BenchRoad;
use super::table::{Totals, short, three};
use crate::verdict::{Verdict, counts};
use std::fmt::Write;

/// The first words of these parts.
pub const HEADING: &str = "# Manoeuvres and their outcomes\n";
/// How many drives are drawn at random, and the seed.
const RANDOM: (usize, u64) = (200, 1);

const MANOEUVRES: &str = "\
Drives of 35 km on the measured profile of the E4, by both trucks, on which something happens that
neither the vehicle file nor the bus reports (`--example manoeuvres` makes single ones). The first
rows have no fault. RMSE of grade over all cells, NEES over unmarked cells, NEES of the worst window
of 5 km, and the marked part of the cells: smoothed / lagged / live.

*Withstood* means: over unmarked cells NEES is at most 4 on the drive and at most 9 in each window of
5 km, smoothed, lagged and live (live from 500 m after a fault's onset on). *Marked* means: that holds
because suspect cells are marked; with these cells it would not. *Not withstood* means: it does not
hold (*NEES*, *window*), or the marks are wrong: more than a tenth of them are on cells that are right
(*marks right cells*), they are more than 5 km behind the fault (*marks last*), they are on more than
1 % of a drive without a fault (*marks without fault*), or cells were made while the vehicle reversed
(*cells in reverse*). An asterisk: the smoothed error is above 1.5 times that without the fault, plus
0.02 %.
";

const AT_RANDOM: &str = "\
Two or three manoeuvres or faults at once, on four stretches of the road, drawn at random and judged
as above. `tests/run long_manoeuvres` draws others, with the date as seed.
";

/// Drives all manoeuvres, and those drawn at random, and returns what came of them as text.
#[must_use]
pub fn page(road: &BenchRoad) -> String {
    let (count, seed) = RANDOM;
    let named = bench(road, catalogue(1), || ());
    let random = bench(road, drawn(count, seed), || ());
    format!(
        "{HEADING}\n{MANOEUVRES}\n{}\n\n{}\n{}\n\
         # Manoeuvres drawn at random\n\n{AT_RANDOM}\n{count} drives, seed {seed}: {}\n\n{}",
        sums(&named),
        not_withstood(&named),
        table(&named),
        sums(&random),
        not_withstood(&random)
    )
}

/// Returns the totals.
fn sums(rows: &[BenchRow]) -> String {
    let verdicts: Vec<Verdict> = rows.iter().map(verdict).collect();
    format!(
        "{}.\n\n```text\n{}\n```",
        counts(&verdicts),
        Totals::of(rows).text()
    )
}

/// Returns the verdict on a drive. A drive without a result is not withstood.
fn verdict(row: &BenchRow) -> Verdict {
    let judgement = row.judgement.as_ref();
    judgement.map_or(Verdict::NotWithstood, |judgement| judgement.verdict())
}

/// Returns the bars that a drive misses, or why it has no result.
fn missed(row: &BenchRow) -> String {
    match &row.judgement {
        Ok(judgement) => judgement.missed().join(", "),
        Err(error) => error.clone(),
    }
}

fn table(rows: &[BenchRow]) -> String {
    let mut text =
        "| manoeuvre or fault | truck | verdict | RMSE, % | NEES | worst 5 km | marked, % |\n\
                    |---|---|---|---|---|---|---|\n"
            .to_owned();
    for row in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} |",
            row.plan.name,
            row.plan.truck.name(),
            verdict_text(row),
            numbers(row)
        );
    }
    text
}

fn verdict_text(row: &BenchRow) -> String {
    let (words, missed) = (verdict(row).to_string(), missed(row));
    let keeps = row.judgement.as_ref().is_ok_and(|j| j.keeps_accuracy);
    let star = if keeps { "" } else { " *" };
    if missed.is_empty() {
        words + star
    } else {
        format!("{words}: {missed}{star}")
    }
}

fn numbers(row: &BenchRow) -> String {
    let Ok(judgement) = &row.judgement else {
        return " | | | ".to_owned();
    };
    [
        three(judgement, |of| format!("{:.3}", of.rmse_percent)),
        three(judgement, |of| of.nees.map_or_else(|| "–".into(), short)),
        three(judgement, |of| short(of.worst())),
        three(judgement, |of| format!("{:.0}", of.marked_percent)),
    ]
    .join(" | ")
}

/// Returns a list of the drives that are not withstood.
fn not_withstood(rows: &[BenchRow]) -> String {
    let mut text = "Not withstood:\n\n".to_owned();
    for row in rows {
        if verdict(row) == Verdict::NotWithstood {
            let (name, truck) = (&row.plan.name, row.plan.truck.name());
            let _ = writeln!(
                text,
                "- {name}; {truck}, stretch {}: {}",
                row.plan.seed,
                missed(row)
            );
        }
    }
    text
}
