//! What the reading of a log tells the user, on stderr.

use super::damage;
use crate::error::on_one_line;
use crate::source::log_report::LogReport;
use crate::terminal::print::note;
use std::path::Path;

/// Columns that are named, of a table with many others.
const FEW: usize = 20;

/// Tells what was left out of a log, the columns that are not ours, and the own signals that no frame
/// had.
pub fn note_report(log: &Path, report: &LogReport) {
    damage::note_log(log, report);
    let path = on_one_line(log);
    if let Some(columns) = in_words(&report.ignored_columns) {
        note(format_args!("{path}: ignored columns: {columns}"));
    }
    if let Some(signals) = in_words(&report.unseen_signals) {
        note(format_args!(
            "{path}: no frame has these signals of --signals: {signals}"
        ));
    }
}

fn in_words<S: AsRef<str>>(names: &[S]) -> Option<String> {
    let (first, rest) = names.split_at(names.len().min(FEW));
    let first: Vec<&str> = first.iter().map(AsRef::as_ref).collect();
    let first = first.join(", ");
    match (names.len(), rest.len()) {
        (0, _) => None,
        (_, 0) => Some(first),
        (_, left) => Some(format!("{first} and {left} more")),
    }
}
