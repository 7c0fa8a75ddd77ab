//! What is known of the road under the vehicle: a map, and what it has learned itself.

use crate::files::flash_image::RoadMemoryFile;
use crate::files::run::RunRow;
use crate::files::spool::Spool;
use estimator_core::roadmap::memory::MemoryCounters;
use estimator_core::roadmap::{MapCounters, MapLive, PackedMap, RoadGrade, combined_with_roads};
use estimator_core::{Cell, Live, Uncertain};
use serde::{Deserialize, Serialize};
use std::io;
use std::ops::Range;

/// Slot size of the grades, bytes.
const GRADES_SLOT: usize = 18;

/// Grades of a cell with what is known of the road, %.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct RoadGrades {
    /// The live grade combined with the road's.
    combined: Uncertain,
    road: Uncertain,
}

/// A map and a road memory, as far as there are any, and their grades along the drive.
#[derive(Debug, Default)]
pub(super) struct Roads {
    pub(super) map: Option<MapLive<'static>>,
    pub(super) memory: Option<RoadMemoryFile>,
    grades: Spool<Option<RoadGrades>, GRADES_SLOT>,
}

/// What a drive with a road memory gave.
#[derive(Debug)]
pub struct LearnedRoads {
    /// The memory after the drive.
    pub memory: RoadMemoryFile,
}

impl LearnedRoads {
    /// Returns what happened on known roads.
    #[must_use]
    pub const fn on_roads(&self) -> &MapCounters {
        self.memory.map_counters()
    }

    /// Returns what was learned.
    #[must_use]
    pub const fn counters(&self) -> MemoryCounters {
        self.memory.counters()
    }
}

impl Roads {
    pub(super) fn follow(&mut self, map: PackedMap<'static>) {
        self.map = Some(MapLive::new(map));
    }

    /// Moves on to the end of a cell, and stores its grades.
    pub(super) fn advance(&mut self, live: &Live) -> io::Result<()> {
        if self.map.is_none() && self.memory.is_none() {
            return Ok(());
        }
        if let Some(map) = &mut self.map {
            map.advance(live);
        }
        if let Some(memory) = &mut self.memory {
            memory.advance(live);
        }
        self.grades.push(&self.combined(live).map(RoadGrades::from))
    }

    /// Returns the live grade combined with what is known of the road; `None` if nothing is.
    fn combined(&self, live: &Live) -> Option<RoadGrade> {
        let map = self.map.as_ref().and_then(MapLive::counted_percent);
        let memory = self.memory.as_ref().and_then(RoadMemoryFile::grade);
        combined_with_roads(live.estimate.grade_percent, map, memory)
    }

    /// Returns the live estimate with what is known of the road, where that counts.
    pub(super) fn applied(&self, live: &Live) -> Live {
        let mut applied = *live;
        if let Some(grade) = self.combined(live) {
            applied.estimate.grade_percent = grade.combined_percent;
        }
        applied
    }

    /// Takes a finished cell.
    pub(super) fn finish(&mut self, cell: &Cell) -> io::Result<()> {
        if let Some(map) = &mut self.map {
            map.finish(cell);
        }
        match &mut self.memory {
            Some(memory) => memory.finish(cell).map_err(io::Error::other),
            None => Ok(()),
        }
    }

    /// Returns the grades of cells. Those behind the last one have none.
    pub(super) fn read(
        &mut self,
        cells: Range<usize>,
    ) -> io::Result<impl Iterator<Item = Option<RoadGrades>> + use<>> {
        let count = self.grades.count();
        let grades = self
            .grades
            .read(cells.start.min(count)..cells.end.min(count))?;
        Ok(grades.into_iter().chain(std::iter::repeat(None)))
    }

    /// Ends the drive. Returns what was learned, if there is a memory.
    pub(super) fn end(&mut self) -> io::Result<Option<LearnedRoads>> {
        let Some(mut memory) = self.memory.take() else {
            return Ok(None);
        };
        memory.close().map_err(io::Error::other)?;
        Ok(Some(LearnedRoads { memory }))
    }
}

impl From<RoadGrade> for RoadGrades {
    fn from(grade: RoadGrade) -> Self {
        Self {
            combined: grade.combined_percent,
            road: grade.road_percent,
        }
    }
}

impl RoadGrades {
    /// Returns a row with the road's part in the live grade. Smoothed and lagged grades have none.
    pub(super) fn applied(&self, row: RunRow) -> RunRow {
        RunRow {
            live_grade_percent: self.combined.value.into(),
            live_grade_sigma_percent: self.combined.sigma.into(),
            map_grade_percent: Some(self.road.value.into()),
            map_grade_sigma_percent: Some(self.road.sigma.into()),
            ..row
        }
    }
}
