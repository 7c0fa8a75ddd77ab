//! Progress on long work: bars on a terminal's stderr, nothing elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// A bar over a file's bytes.
#[must_use]
pub fn bytes(total: u64) -> ProgressBar {
    bar(total, "{bar:40} {bytes}/{total_bytes} {eta}")
}

/// A bar over a number of things.
#[must_use]
pub fn count(total: u64, what: &str) -> ProgressBar {
    bar(total, &format!("{{bar:40}} {{pos}}/{{len}} {what} {{eta}}"))
}

fn bar(total: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(
        Some(total),
        if std::io::stderr().is_terminal() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        },
    );
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}
