//! The damage of a log, told on stderr.

use crate::error::on_one_line;
use crate::source::log_report::LogReport;
use crate::terminal::print::note;
use std::path::Path;

/// Tells what was left out of a log, with the first problems.
pub(super) fn note_log(log: &Path, report: &LogReport) {
    let Some(words) = report.damage.words() else {
        return;
    };
    note(format_args!("{}: {words}:", on_one_line(log)));
    for problem in &report.damage.first {
        note(format_args!("  {problem}"));
    }
}
