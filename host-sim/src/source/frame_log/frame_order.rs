//! The order of frames in time.

use super::frame_reader::LoggedFrame;
use crate::error::Error;
use estimator_core::{Duration, Instant};
use std::collections::VecDeque;

/// Largest disorder of frames. Frames of two interfaces, or of two senders on a virtual one, can
/// reach a logger in the wrong order.
const DISORDER: Duration = Duration::from_millis(100);
/// A frame later than the one before by more than this is held back: if the next frame continues
/// from before, its time stamp is damaged.
const JUMP: Duration = Duration::from_millis(60_000);

/// What is expected of the times of a log, for messages.
pub(super) const IN_ORDER: &str = "times that do not decrease by more than 100 ms";

/// Frames that may not be in order yet. Memory: those of 100 ms.
#[derive(Default)]
pub(super) struct FrameOrder {
    newest: Option<Instant>,
    waiting: VecDeque<LoggedFrame>,
    /// A frame far ahead, and the error of its time stamp.
    ahead: Option<(LoggedFrame, Error)>,
    is_over: bool,
}

/// What became of a frame.
pub(super) enum Placed {
    InOrder,
    /// It is too old: the problem in words.
    TooOld(String),
    /// The frame before it was too far ahead: the error of that.
    WasAhead(Error),
}

impl FrameOrder {
    /// Takes the next frame of the log. `error` makes the error of its place.
    pub(super) fn put(&mut self, logged: LoggedFrame, error: impl FnOnce(&str) -> Error) -> Placed {
        let mut placed = Placed::InOrder;
        if let Some((ahead, problem)) = self.ahead.take() {
            if ahead.time.since(logged.time) > DISORDER {
                placed = Placed::WasAhead(problem);
            } else {
                self.insert(ahead);
            }
        }
        let Some(newest) = self.newest else {
            self.insert(logged);
            return placed;
        };
        if newest.since(logged.time) > DISORDER {
            let (newest, logged) = (Seconds(newest), Seconds(logged.time));
            return Placed::TooOld(format!("time runs backwards, from {newest} to {logged}"));
        }
        if logged.time.since(newest) > JUMP {
            let (newest, time) = (Seconds(newest), Seconds(logged.time));
            let problem = format!("time jumps from {newest} to {time} and back");
            self.ahead = Some((logged, error(&problem)));
            return placed;
        }
        self.insert(logged);
        placed
    }

    /// Inserts a frame behind all that are not later.
    fn insert(&mut self, logged: LoggedFrame) {
        let newest = self.newest.get_or_insert(logged.time);
        *newest = (*newest).max(logged.time);
        let later = self.waiting.iter().rev();
        let later = later.take_while(|frame| frame.time > logged.time).count();
        self.waiting.insert(self.waiting.len() - later, logged);
    }

    /// Lets all frames go: the log is over.
    pub(super) fn end(&mut self) {
        if let Some((ahead, _)) = self.ahead.take() {
            self.insert(ahead);
        }
        self.is_over = true;
    }

    /// Returns the next frame that no frame of the log can precede.
    pub(super) fn next(&mut self) -> Option<LoggedFrame> {
        let first = self.waiting.front()?;
        let is_due = self.is_over || self.newest?.since(first.time) > DISORDER;
        if is_due {
            self.waiting.pop_front()
        } else {
            None
        }
    }

    /// Returns the frames behind the one that came last, in order.
    pub(super) fn waiting(&self) -> impl Iterator<Item = &LoggedFrame> {
        self.waiting.iter()
    }
}

/// A time as candump writes it.
pub(in crate::source) struct Seconds(pub(in crate::source) Instant);

impl std::fmt::Display for Seconds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let micros = self.0.micros();
        write!(f, "{}.{:06} s", micros / 1_000_000, micros % 1_000_000)
    }
}
