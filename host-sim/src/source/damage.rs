//! Damage of a log: what was left out, and when it is too much.
//!
//! A truck's logger loses power at every stop, and a disk flips a bit. Damaged lines, rows and
//! frames are left out up to 1 %; so are damaged blocks of a binary format, by their bytes. One
//! lost block is no reason to refuse a short log.

use crate::error::{Error, Result};
use serde::Serialize;

/// Share of a log that may be damaged: one part in so many.
const MOST_DAMAGED: u64 = 100;
/// Number of problems that are kept for messages.
const FIRST_PROBLEMS: usize = 5;
/// Without any frame, so many damaged lines show that this is no such log.
const NO_LOG: u64 = 1000;

/// What was left out of a log.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Damage {
    /// Number of damaged lines or rows; in a binary format, of damaged frames.
    pub lines: u64,
    /// Number of damaged blocks of a binary format.
    pub blocks: u64,
    /// Size of these blocks in the log, bytes.
    pub bytes: u64,
    /// True if the log ends within a line, a block or compressed data.
    pub cut_off: bool,
    /// The first problems, each with file and place.
    pub first: Vec<String>,
}

impl Damage {
    /// Returns true if nothing was left out.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        self.lines == 0 && self.blocks == 0 && !self.cut_off
    }

    /// Returns the damage in words; `None` if there is none.
    #[must_use]
    pub fn words(&self) -> Option<String> {
        let count = |count: u64, one: &str| match count {
            1 => format!("1 damaged {one}"),
            _ => format!("{count} damaged {one}s"),
        };
        let mut parts = Vec::new();
        if self.lines > 0 {
            parts.push(count(self.lines, "line"));
        }
        if self.blocks > 0 {
            let bytes = self.bytes;
            parts.push(format!("{} of {bytes} bytes", count(self.blocks, "block")));
        }
        let left_out = (!parts.is_empty()).then(|| format!("left out {}", parts.join(" and ")));
        let cut_off = self
            .cut_off
            .then(|| "used up to where it is cut off".to_owned());
        let parts: Vec<String> = left_out.into_iter().chain(cut_off).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }
}

/// Collects the damage of a log while it is read.
#[derive(Debug, Default)]
pub(super) struct DamageCheck {
    is_strict: bool,
    found: Damage,
    first: Option<Error>,
}

impl DamageCheck {
    /// Creates a check. A strict one allows no damage at all.
    pub(super) fn new(is_strict: bool) -> Self {
        Self {
            is_strict,
            ..Self::default()
        }
    }

    /// Returns what was found so far.
    pub(super) const fn found(&self) -> &Damage {
        &self.found
    }

    /// Leaves out a line, a row or a frame of a binary format. `read` is the number of good ones so
    /// far.
    ///
    /// # Errors
    /// Returns `problem` if the check is strict, or if nothing of the log is good.
    pub(super) fn line(&mut self, problem: Error, read: u64) -> Result<()> {
        self.found.lines += 1;
        if read == 0 && self.found.lines >= NO_LOG {
            return Err(self.first.take().unwrap_or(problem));
        }
        self.keep(problem)
    }

    /// Leaves out a block of so many bytes.
    ///
    /// # Errors
    /// Returns `problem` if the check is strict.
    pub(super) fn block(&mut self, problem: Error, bytes: u64) -> Result<()> {
        self.found.blocks += 1;
        self.found.bytes += bytes;
        self.keep(problem)
    }

    /// Leaves out so many bytes of packed data. Their damage explains that of lines, so it is reported first.
    ///
    /// # Errors
    /// Returns `problem` if the check is strict.
    pub(super) fn packed(&mut self, problem: Error, bytes: u64) -> Result<()> {
        self.found.first.insert(0, problem.to_string());
        self.found.first.truncate(FIRST_PROBLEMS - 1);
        let told = self.found.first.clone();
        self.block(problem, bytes)?;
        self.found.first = told;
        Ok(())
    }

    /// Adds bytes to the block that was left out last.
    pub(super) const fn more_of_block(&mut self, bytes: u64) {
        self.found.bytes += bytes;
    }

    /// Notes that the log ends before its time.
    ///
    /// # Errors
    /// Returns `problem` if the check is strict.
    pub(super) fn cut_off(&mut self, problem: Error) -> Result<()> {
        if self.found.cut_off {
            return Ok(());
        }
        self.found.cut_off = true;
        self.keep(problem)
    }

    fn keep(&mut self, problem: Error) -> Result<()> {
        if self.is_strict {
            return Err(problem);
        }
        if self.found.first.len() < FIRST_PROBLEMS {
            self.found.first.push(problem.to_string());
        }
        self.first.get_or_insert(problem);
        Ok(())
    }

    /// Returns the first problem.
    pub(super) fn take_first(&mut self) -> Option<Error> {
        self.first.take()
    }

    /// Checks at the end that there is not too much damage among so many lines (rows, frames) and
    /// bytes of the log.
    ///
    /// # Errors
    /// Returns the first problem, with the share, if there is too much.
    pub(super) fn end(&mut self, lines: u64, bytes: u64) -> Result<()> {
        let found = &self.found;
        let is_over = |part: u64, whole: u64| part.saturating_mul(MOST_DAMAGED) > whole;
        let share = if found.lines > 0 && is_over(found.lines, lines) {
            format!("{} of {lines} lines are damaged", found.lines)
        } else if found.blocks > 1 && is_over(found.bytes, bytes) {
            let Damage {
                blocks,
                bytes: lost,
                ..
            } = found;
            format!("{blocks} blocks with {lost} of {bytes} bytes are damaged")
        } else {
            return Ok(());
        };
        let is_single = found.lines + found.blocks == 1;
        match self.first.take() {
            Some(problem) if is_single => Err(problem),
            Some(problem) => Err(problem.with_note(&format!("{share}, more than 1 %"))),
            None => Ok(()),
        }
    }
}
