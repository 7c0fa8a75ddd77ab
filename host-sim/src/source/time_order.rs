//! The order of frames or rows in time.
//!
//! Loggers store channels in chunks, programs sort by identifier or have the newest row first, and
//! groups of a file interleave. So all are held back and put in order: all of a log that is small
//! enough, else the newest ones.

use std::cmp::Reverse;
use std::collections::VecDeque;

/// Most runs. Beyond them, all that wait are sorted into one.
const MOST_RUNS: usize = 4096;

/// What has a time.
pub(super) trait Timed {
    /// Returns the time, µs.
    fn micros(&self) -> i64;
}

/// Frames or rows that may not be in order yet.
///
/// They wait in runs, each of which is in order. The last times of the runs fall, so that one goes
/// to the first run whose last time is not later; those of the same time keep their order. A log that
/// is in order has one run.
pub(super) struct TimeOrder<T> {
    runs: Vec<VecDeque<T>>,
    waiting: usize,
    most_waiting: usize,
    /// Time of the newest that was let go, µs.
    gone: Option<i64>,
    is_over: bool,
}

impl<T: Timed> TimeOrder<T> {
    /// Creates an order in which so many wait for earlier ones.
    pub(super) const fn new(most_waiting: usize) -> Self {
        Self {
            runs: Vec::new(),
            waiting: 0,
            most_waiting,
            gone: None,
            is_over: false,
        }
    }

    /// Takes one. Returns false if a later one is gone already.
    pub(super) fn put(&mut self, logged: T) -> bool {
        let micros = logged.micros();
        if self.gone.is_some_and(|gone| micros < gone) {
            return false;
        }
        let is_later = |run: &VecDeque<T>| run.back().is_some_and(|last| last.micros() > micros);
        let at = self.runs.partition_point(is_later);
        match self.runs.get_mut(at) {
            Some(run) => run.push_back(logged),
            None => self.runs.push(VecDeque::from([logged])),
        }
        self.waiting += 1;
        if self.runs.len() > MOST_RUNS {
            let mut all: Vec<T> = self.runs.drain(..).flatten().collect();
            all.sort_by_key(T::micros);
            self.runs.push(all.into());
        }
        true
    }

    /// Lets all go: the log is over.
    pub(super) const fn end(&mut self) {
        self.is_over = true;
    }

    /// Returns whether the log is over.
    pub(super) const fn is_over(&self) -> bool {
        self.is_over
    }

    /// Forgets all that wait.
    pub(super) fn clear(&mut self) {
        self.runs.clear();
        self.waiting = 0;
    }

    /// Forgets the latest that waits, if it has this time.
    pub(super) fn forget_latest(&mut self, micros: i64) {
        let Some(first) = self.runs.first_mut() else {
            return;
        };
        if first.back().is_some_and(|latest| latest.micros() == micros) {
            first.pop_back();
            self.waiting -= 1;
            self.runs.retain(|run| !run.is_empty());
            let last = |run: &VecDeque<T>| run.back().map(T::micros);
            self.runs.sort_by_key(|run| Reverse(last(run)));
        }
    }

    /// Returns the next one, if none that still comes should precede it.
    pub(super) fn next(&mut self) -> Option<T> {
        if !self.is_over && self.waiting <= self.most_waiting {
            return None;
        }
        let first = |run: &VecDeque<T>| run.front().map_or(i64::MAX, T::micros);
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
        self.gone = Some(next.micros());
        Some(next)
    }

    /// Returns those that wait up to a time, in no order.
    pub(super) fn waiting_until(&self, micros: i64) -> impl Iterator<Item = &T> {
        let early = move |one: &&T| one.micros() <= micros;
        self.runs
            .iter()
            .flat_map(move |run| run.iter().take_while(early))
    }
}
