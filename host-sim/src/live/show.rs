//! Output of the live view: a panel on a terminal, else lines or JSON.

use super::panel::{header, json, line, panel};
use super::view::LiveView;
use crate::error::Result;
use crate::terminal::print::{note, print, printable};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr, stdout};
use std::time::{Duration, Instant as Monotonic};

/// Update periods of the panel and of the lines.
const PANEL_PERIOD: Duration = Duration::from_millis(200);
const LINE_PERIOD: Duration = Duration::from_secs(1);

/// Shows views.
#[derive(Debug)]
pub struct Show {
    medium: Medium,
    next: Monotonic,
}

#[derive(Debug)]
enum Medium {
    Panel(ProgressBar),
    Lines,
    Json,
}

impl Show {
    /// Creates the output: JSON if `is_json`, else a panel on a terminal, else lines on stdout.
    #[must_use]
    pub fn new(is_json: bool) -> Self {
        let medium = if is_json {
            Medium::Json
        } else if stdout().is_terminal() && stderr().is_terminal() {
            let target = ProgressDrawTarget::stderr_with_hz(10);
            let bar = ProgressBar::with_draw_target(None, target);
            let style = ProgressStyle::with_template("{msg}");
            Medium::Panel(match style {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            })
        } else {
            Medium::Lines
        };
        let first = match medium {
            Medium::Panel(_) => Duration::ZERO,
            _ => LINE_PERIOD,
        };
        Self {
            medium,
            next: Monotonic::now() + first,
        }
    }

    /// Writes the header of the lines.
    ///
    /// # Errors
    /// Returns an error if stdout cannot be written.
    pub fn begin(&self) -> Result<()> {
        match &self.medium {
            Medium::Lines => print(&format!("{}\n", header())),
            Medium::Panel(_) | Medium::Json => Ok(()),
        }
    }

    /// Returns the time until the next view is due.
    #[must_use]
    pub fn due_in(&self) -> Duration {
        self.next.saturating_duration_since(Monotonic::now())
    }

    /// Shows a view, even if it is not due yet.
    ///
    /// # Errors
    /// Returns an error if stdout cannot be written.
    pub fn show(&mut self, view: &LiveView) -> Result<()> {
        let period = match &self.medium {
            Medium::Panel(_) => PANEL_PERIOD,
            _ => LINE_PERIOD,
        };
        self.next = Monotonic::now().max(self.next + period);
        match &self.medium {
            Medium::Panel(bar) => {
                bar.set_message(panel(view));
                Ok(())
            }
            Medium::Lines => print(&format!("{}\n", line(view))),
            Medium::Json => print(&format!("{}\n", json(view))),
        }
    }

    /// Prints a message: above the panel, else on stderr.
    pub fn say(&self, message: &str) {
        match &self.medium {
            Medium::Panel(bar) => bar.println(printable(message)),
            Medium::Lines | Medium::Json => note(format_args!("{message}")),
        }
    }

    /// Shows the last view and leaves it on the screen.
    ///
    /// # Errors
    /// Returns an error if stdout cannot be written.
    pub fn show_last(&mut self, view: &LiveView) -> Result<()> {
        self.show(view)?;
        if let Medium::Panel(bar) = &self.medium {
            bar.abandon();
        }
        Ok(())
    }

    /// Returns true if stdout carries the lines, so that nothing else may be printed there.
    #[must_use]
    pub fn takes_stdout(&self) -> bool {
        matches!(self.medium, Medium::Lines)
    }
}
