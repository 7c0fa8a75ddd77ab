//! Progress bars on stderr, if it is a terminal and the command is not quiet.

use super::print::is_quiet;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// Returns a progress bar over `total` bytes.
#[must_use]
pub fn bytes(total: u64) -> ProgressBar {
    bar(total, "{bar:40} {bytes}/{total_bytes} {eta}")
}

/// Returns a progress bar over `total` items, labelled `what`.
#[must_use]
pub fn count(total: u64, what: &str) -> ProgressBar {
    bar(total, &format!("{{bar:40}} {{pos}}/{{len}} {what} {{eta}}"))
}

/// Returns a spinner for work of unknown length.
#[must_use]
pub fn spinner(what: &str) -> ProgressBar {
    let spinner = if is_shown() {
        ProgressBar::new_spinner()
    } else {
        ProgressBar::hidden()
    };
    spinner.set_message(what.to_owned());
    spinner.enable_steady_tick(std::time::Duration::from_millis(100));
    spinner
}

/// Returns whether progress is shown.
fn is_shown() -> bool {
    std::io::stderr().is_terminal() && !is_quiet()
}

fn bar(total: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(
        Some(total),
        if is_shown() {
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
