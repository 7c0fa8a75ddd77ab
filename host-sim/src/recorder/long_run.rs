//! The result of a drive.

use super::innovations::Innovations;
use super::plausibility::Warning;
use super::roads::LearnedRoads;
use super::roadway_grade::RoadwayComparison;
use crate::error::Result;
use crate::files::run::{RunRow, RunRows};
use crate::files::spool::{Spool, blocks, no_room};
use crate::smooth::Disagreements;
use crate::source::log_report::LogReport;
use estimator_core::roadmap::MapCounters;
use estimator_core::{Counters, Delays, Model, PersistentState};
use std::io;

/// A smoothed drive, in memory.
#[derive(Debug)]
pub struct SmoothedRun {
    /// Its cells.
    pub rows: Vec<RunRow>,
    /// Counters of the core.
    pub counters: Counters,
    /// How late receiver and force were found to be.
    pub delays: Delays,
    /// State for the next drive; `None` if this one was too short.
    pub persistent_state: Option<PersistentState>,
    /// Where signals disagree.
    pub disagreements: Disagreements,
    /// What is not plausible about the input.
    pub warnings: Vec<Warning>,
    /// Time of the first input in UTC, as RFC 3339 writes it, where the log has absolute times.
    pub start_utc: Option<String>,
}

/// A smoothed drive that need not fit into memory.
#[derive(Debug)]
pub struct LongRun {
    /// Its cells.
    pub rows: Rows,
    /// The model at the end: what the bus contradicted is as the bus says.
    pub model: Model,
    /// What the reading of the log told; nothing for a live bus.
    pub log: LogReport,
    /// Counters of the core.
    pub counters: Counters,
    /// What happened on the map; `None` without one.
    pub map: Option<MapCounters>,
    /// The road memory after the drive; `None` without one.
    pub memory: Option<LearnedRoads>,
    /// Its measurements beside what the filter predicted; `None` unless they are wanted.
    pub innovations: Option<Innovations>,
    /// The grade of another device against ours; `None` without one.
    pub roadway_grade: Option<RoadwayComparison>,
    /// How late receiver and force were found to be.
    pub delays: Delays,
    /// State for the next drive; `None` if this one was too short.
    pub persistent_state: Option<PersistentState>,
    /// Where signals disagree.
    pub disagreements: Disagreements,
    /// What is not plausible about the input.
    pub warnings: Vec<Warning>,
    /// Time of the first input in UTC, as RFC 3339 writes it, where the log has absolute times.
    pub start_utc: Option<String>,
}

impl LongRun {
    /// Reads all rows into memory.
    ///
    /// # Errors
    /// Returns the error of the file system, if the rows are in a temporary file.
    pub fn in_memory(mut self) -> Result<SmoothedRun> {
        let mut rows = Vec::with_capacity(self.rows.count());
        self.rows.each(&mut |row| {
            rows.push(*row);
            Ok(())
        })?;
        Ok(SmoothedRun {
            rows,
            counters: self.counters,
            delays: self.delays,
            persistent_state: self.persistent_state,
            disagreements: self.disagreements,
            warnings: self.warnings,
            start_utc: self.start_utc,
        })
    }
}

/// Bytes of a row.
const ROW_SLOT: usize = 170;

/// The rows of a run, in memory or in a temporary file.
#[derive(Debug, Default)]
pub struct Rows(Spool<RunRow, ROW_SLOT>);

impl Rows {
    /// Returns the number of rows.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.0.count()
    }

    /// Stores rows at their indices.
    pub(super) fn put(
        &mut self,
        first: usize,
        rows: impl Iterator<Item = RunRow>,
    ) -> io::Result<()> {
        self.0.put(first, rows)
    }
}

impl RunRows for Rows {
    fn each(&mut self, take: &mut dyn FnMut(&RunRow) -> Result<()>) -> Result<()> {
        for block in blocks(0..self.count()) {
            for row in self.0.read(block).map_err(no_room)? {
                take(&row)?;
            }
        }
        Ok(())
    }
}
