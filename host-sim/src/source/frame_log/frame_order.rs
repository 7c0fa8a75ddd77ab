//! The order of frames in time.
//!
//! Loggers store channels in chunks, programs sort by identifier, and groups of a file interleave. So
//! frames are held back and put in order: all of a log that is small enough, else the newest ones.

use super::frame_reader::LoggedFrame;
use std::cmp::Reverse;
use std::collections::VecDeque;

/// Most frames that wait: with the next one 8 MiB, some minutes of a bus.
const MOST_WAITING: usize = (1 << 18) - 1;
/// Most runs. Beyond them, all frames that wait are sorted into one.
const MOST_RUNS: usize = 4096;

/// Frames that may not be in order yet.
///
/// They wait in runs, each of which is in order. The last times of the runs fall, so that a frame goes
/// to the first run whose last time is not later; frames of the same time keep their order. A log that
/// is in order has one run.
#[derive(Default)]
pub(super) struct FrameOrder {
    runs: Vec<VecDeque<LoggedFrame>>,
    waiting: usize,
    /// Time of the newest frame that was let go, µs.
    gone: Option<i64>,
    is_over: bool,
}

impl FrameOrder {
    /// Takes a frame. Returns false if a later one is gone already.
    pub(super) fn put(&mut self, logged: LoggedFrame) -> bool {
        if self.gone.is_some_and(|gone| logged.micros < gone) {
            return false;
        }
        let is_later = |run: &VecDeque<LoggedFrame>| {
            run.back().is_some_and(|last| last.micros > logged.micros)
        };
        let at = self.runs.partition_point(is_later);
        match self.runs.get_mut(at) {
            Some(run) => run.push_back(logged),
            None => self.runs.push(VecDeque::from([logged])),
        }
        self.waiting += 1;
        if self.runs.len() > MOST_RUNS {
            let mut all: Vec<LoggedFrame> = self.runs.drain(..).flatten().collect();
            all.sort_by_key(|frame| frame.micros);
            self.runs.push(all.into());
        }
        true
    }

    /// Lets all frames go: the log is over.
    pub(super) const fn end(&mut self) {
        self.is_over = true;
    }

    /// Forgets all frames that wait.
    pub(super) fn clear(&mut self) {
        self.runs.clear();
        self.waiting = 0;
    }

    /// Forgets the latest frame that waits, if it has this time.
    pub(super) fn forget_latest(&mut self, micros: i64) {
        let Some(first) = self.runs.first_mut() else {
            return;
        };
        if first.back().is_some_and(|latest| latest.micros == micros) {
            first.pop_back();
            self.waiting -= 1;
            self.runs.retain(|run| !run.is_empty());
            let last = |run: &VecDeque<LoggedFrame>| run.back().map(|frame| frame.micros);
            self.runs.sort_by_key(|run| Reverse(last(run)));
        }
    }

    /// Returns the next frame, if no frame that still comes should precede it.
    pub(super) fn next(&mut self) -> Option<LoggedFrame> {
        if !self.is_over && self.waiting <= MOST_WAITING {
            return None;
        }
        let first = |run: &VecDeque<LoggedFrame>| run.front().map_or(i64::MAX, |f| f.micros);
        let (at, _) = self
            .runs
            .iter()
            .enumerate()
            .min_by_key(|(_, run)| first(run))?;
        let run = self.runs.get_mut(at)?;
        let next = run.pop_front()?;
        if run.is_empty() {
            self.runs.remove(at);
        }
        self.waiting -= 1;
        self.gone = Some(next.micros);
        Some(next)
    }

    /// Returns the frames that wait up to a time, in no order.
    pub(super) fn waiting_until(&self, micros: i64) -> impl Iterator<Item = &LoggedFrame> {
        let early = move |frame: &&LoggedFrame| frame.micros <= micros;
        self.runs
            .iter()
            .flat_map(move |run| run.iter().take_while(early))
    }
}
