//! Where a view goes: a panel on a terminal, lines elsewhere.

use super::panel::{header, json, line, panel};
use super::view::View;
use crate::error::Result;
use crate::terminal::print::print;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr, stdout};
use std::time::{Duration, Instant as Monotonic};

/// Between two looks of a panel, and between two lines.
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
    /// On a terminal a panel, where output goes elsewhere lines to stdout, or JSON if that is wanted.
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

    /// Writes what stands above lines.
    ///
    /// # Errors
    /// If stdout cannot be written.
    pub fn begin(&self) -> Result<()> {
        match &self.medium {
            Medium::Lines => print(&format!("{}\n", header())),
            Medium::Panel(_) | Medium::Json => Ok(()),
        }
    }

    /// Until the next view is due.
    #[must_use]
    pub fn due_in(&self) -> Duration {
        self.next.saturating_duration_since(Monotonic::now())
    }

    /// Shows a view, whether it is due or not.
    ///
    /// # Errors
    /// If stdout cannot be written.
    pub fn show(&mut self, view: &View) -> Result<()> {
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

    /// Says something to whoever watches.
    pub fn say(&self, message: &str) {
        match &self.medium {
            Medium::Panel(bar) => bar.println(message),
            Medium::Lines | Medium::Json => eprintln!("{message}"),
        }
    }

    /// Shows the last view, and leaves it where it is.
    ///
    /// # Errors
    /// If stdout cannot be written.
    pub fn show_last(&mut self, view: &View) -> Result<()> {
        self.show(view)?;
        if let Medium::Panel(bar) = &self.medium {
            bar.abandon();
        }
        Ok(())
    }

    /// Whether stdout has lines of its own, so that nothing else may go there.
    #[must_use]
    pub fn takes_stdout(&self) -> bool {
        matches!(self.medium, Medium::Lines)
    }
}
