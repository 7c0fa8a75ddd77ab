//! What the reading of a log tells the user, on stderr.

use crate::error::on_one_line;
use crate::files::left_out::LeftOut;
use crate::source::log_report::LogReport;
use crate::terminal::print::note;
use std::path::Path;

/// Columns that are named, of a table with many others.
const FEW: usize = 20;

/// Tells what was left out of a log, the columns that are not ours, and the own signals that no frame
/// had.
pub fn note_report(log: &Path, report: &LogReport) {
    note_damage(log, report);
    let path = on_one_line(log);
    for words in report.mended.iter().chain(&report.notes) {
        note(format_args!("{path}: {words}"));
    }
    if let Some(columns) = in_words(&report.ignored_columns) {
        note(format_args!("{path}: ignored columns: {columns}"));
    }
    if let Some(signals) = in_words(&report.unseen_signals) {
        note(format_args!(
            "{path}: no frame has these signals of --signals: {signals}"
        ));
    }
}

/// Tells what was left out of a log, with the first problems.
fn note_damage(log: &Path, report: &LogReport) {
    let Some(words) = report.damage.words() else {
        return;
    };
    note(format_args!("{}: {words}:", on_one_line(log)));
    for problem in &report.damage.first {
        note(format_args!("  {problem}"));
    }
}

/// Prints a note of the statements that were left out of a description of the bus.
pub fn note_left_out(path: &Path, left_out: &LeftOut) {
    let statements = match left_out.count() {
        0 => return,
        1 => "1 statement".to_owned(),
        count => format!("{count} statements"),
    };
    note(format_args!(
        "{}: left out {statements}:",
        on_one_line(path)
    ));
    for problem in left_out.first() {
        note(format_args!("  {problem}"));
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
