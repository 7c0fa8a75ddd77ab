//! Fusion of runs in two levels, weighted by the inverse of their variances (Sahlholm and
//! Johansson, "Road grade estimation for look-ahead vehicle control using multiple measurement
//! runs", 2010; thesis section 3.1; that runs are not independent: dependence.rs).
//!
//! The runs of one session (one vehicle, one day) become one estimate, the sessions become the
//! map. A run that belongs to no session is a session of its own.
//!
//! Only sums are kept: for each session by name, and for all runs without one together. So a
//! map's size does not depend on the number of its runs, runs can be added one by one and maps
//! merged in any order.

use super::GRID_M;
use super::cell_sums::CellSums;
use super::dependence::{BETWEEN_SESSIONS, Dependence, Disagreement, Expectation, WITHIN_SESSION};
use super::map_file::MapRow;
use super::placing::{Coverage, PlacedRun, place};
use super::road_line::RoadLine;
use crate::run_cell::RunCell;
use crate::run_file::RunRow;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A run, and the session that it belongs to.
#[derive(Clone, Copy, Debug)]
pub struct SessionRun<'a> {
    /// `None` is a session of its own.
    pub session: Option<&'a str>,
    pub rows: &'a [RunRow],
}

/// What estimates of one kind turned out to have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    pub disagreement: Disagreement,
    pub dependence: Dependence,
}

/// A map, and how far to trust what went into it.
#[derive(Clone, Debug)]
pub struct FusedMap {
    /// The cells that some run covered.
    pub rows: Vec<MapRow>,
    /// Runs within each session that has a name.
    pub within: Vec<(String, Agreement)>,
    /// Sessions against each other.
    pub between: Agreement,
}

/// Accumulated cells of a road, every 2.5 m.
#[derive(Clone, Debug)]
pub struct GradeMap<'a> {
    road: &'a RoadLine,
    /// Number of the first cell: its distance over 2.5 m.
    first: i64,
    /// Runs without a session.
    alone: Vec<CellSums>,
    /// Runs of each session.
    sessions: BTreeMap<String, Vec<CellSums>>,
    /// Sessions that are complete, and how far their runs agreed.
    closed: Pooled,
    within: Vec<(String, Agreement)>,
}

/// Sessions, each one estimate.
#[derive(Clone, Debug)]
struct Pooled {
    cells: Vec<CellSums>,
    /// Runs behind them.
    runs: Vec<u32>,
}

impl Pooled {
    fn new(count: usize) -> Self {
        Self {
            cells: vec![CellSums::default(); count],
            runs: vec![0; count],
        }
    }

    /// Adds the runs of one session as one estimate.
    fn add(&mut self, session: &[CellSums]) -> Agreement {
        let agreement = agreement(&WITHIN_SESSION, session);
        for ((sums, runs), cell) in self.cells.iter_mut().zip(&mut self.runs).zip(session) {
            sums.merge(&cell.pooled(&agreement.dependence));
            *runs = runs.saturating_add(cell.estimates);
        }
        agreement
    }
}

impl<'a> GradeMap<'a> {
    /// An empty map of a road.
    pub fn new(road: &'a RoadLine) -> Self {
        let numbers = road.cell_numbers();
        let count = usize::try_from(numbers.end() - numbers.start() + 1).unwrap_or(0);
        Self {
            road,
            first: *numbers.start(),
            alone: vec![CellSums::default(); count],
            sessions: BTreeMap::new(),
            closed: Pooled::new(count),
            within: Vec::new(),
        }
    }

    /// The road that it is a map of.
    pub const fn road(&self) -> &'a RoadLine {
        self.road
    }

    /// Adds one run, and says how much of it lies on the road.
    pub fn add_run(&mut self, run: &SessionRun) -> Coverage {
        let placed = place(self.road, &cells_of_run(run.rows));
        self.add_placed(run.session, &placed);
        placed.coverage
    }

    /// Adds a run that was placed on this map's road.
    pub fn add_placed(&mut self, session: Option<&str>, run: &PlacedRun) {
        if run.cells.is_empty() {
            return;
        }
        let first = self.first;
        let cells = self.cells_of(session);
        for placed in &run.cells {
            let index = usize::try_from(placed.number - first).ok();
            if let Some(cell) = index.and_then(|index| cells.get_mut(index)) {
                cell.merge(&placed.sums());
            }
        }
    }

    /// Makes one estimate of a session's runs, for good: its memory is free again. No run of this
    /// session may be added later, and what is left is not for a store.
    pub fn close_session(&mut self, name: &str) {
        if let Some(cells) = self.sessions.remove(name) {
            let agreement = self.closed.add(&cells);
            self.within.push((name.to_owned(), agreement));
        }
    }

    /// Adds what another map of the same road knows.
    pub fn merge(&mut self, other: &Self) {
        debug_assert!(std::ptr::eq(self.road, other.road), "maps of one road");
        merge_cells(&mut self.alone, &other.alone);
        for (name, cells) in &other.sessions {
            merge_cells(self.cells_of(Some(name)), cells);
        }
        merge_cells(&mut self.closed.cells, &other.closed.cells);
        for (runs, others) in self.closed.runs.iter_mut().zip(&other.closed.runs) {
            *runs = runs.saturating_add(*others);
        }
        self.within.extend(other.within.iter().cloned());
    }

    /// What the runs together say.
    pub fn fused(&self) -> FusedMap {
        let mut pooled = self.closed.clone();
        let mut within = self.within.clone();
        for (name, cells) in &self.sessions {
            within.push((name.clone(), pooled.add(cells)));
        }
        let Pooled {
            cells: mut estimates,
            mut runs,
        } = pooled;
        merge_cells(&mut estimates, &self.alone);
        for (runs, cell) in runs.iter_mut().zip(&self.alone) {
            *runs = runs.saturating_add(cell.estimates);
        }
        let between = agreement(&BETWEEN_SESSIONS, &estimates);
        let rows = (self.first..)
            .zip(estimates.iter().zip(runs))
            .filter_map(|(number, (sums, runs))| {
                let (grade_percent, variance) = sums.grade(&between.dependence)?;
                let distance_m = number as f64 * GRID_M;
                let (latitude_deg, longitude_deg) = self.road.position_at(distance_m);
                Some(MapRow {
                    distance_m,
                    latitude_deg,
                    longitude_deg,
                    altitude_m: sums.altitude_m(),
                    grade_percent,
                    grade_sigma_percent: variance.sqrt(),
                    runs,
                })
            })
            .collect();
        FusedMap {
            rows,
            within,
            between,
        }
    }

    /// Cells of which sums are held.
    pub fn held_cells(&self) -> usize {
        self.alone.len() * (1 + self.sessions.len())
    }

    /// Sums of every cell of the road, in its order: of the runs without a session, then of each
    /// session by name.
    pub(super) fn sums(&self) -> impl Iterator<Item = (Option<&str>, &[CellSums])> {
        let named = self.sessions.iter();
        std::iter::once((None, self.alone.as_slice()))
            .chain(named.map(|(name, cells)| (Some(name.as_str()), cells.as_slice())))
    }

    /// The cells in which runs of a session are summed.
    pub(super) fn cells_of(&mut self, session: Option<&str>) -> &mut [CellSums] {
        let Some(name) = session else {
            return &mut self.alone;
        };
        let empty = || vec![CellSums::default(); self.alone.len()];
        self.sessions.entry(name.to_owned()).or_insert_with(empty)
    }
}

fn merge_cells(cells: &mut [CellSums], others: &[CellSums]) {
    for (cell, other) in cells.iter_mut().zip(others) {
        cell.merge(other);
    }
}

fn agreement(expectation: &Expectation, cells: &[CellSums]) -> Agreement {
    let mut disagreement = Disagreement::default();
    for cell in cells {
        disagreement.add(&cell.disagreement());
    }
    Agreement {
        disagreement,
        dependence: expectation.learn(&disagreement),
    }
}

/// A map fused from runs, and what each gave to it.
#[derive(Clone, Debug)]
pub struct Fusion<'a> {
    pub map: GradeMap<'a>,
    /// One for each run, in the order given.
    pub coverage: Vec<Coverage>,
}

/// Fuses runs onto a road. The result does not depend on the number of threads.
pub fn fuse<'a>(road: &'a RoadLine, runs: &[SessionRun]) -> Fusion<'a> {
    let placed: Vec<PlacedRun> = runs
        .par_iter()
        .map(|run| place(road, &cells_of_run(run.rows)))
        .collect();
    let mut map = GradeMap::new(road);
    for (run, placed) in runs.iter().zip(&placed) {
        map.add_placed(run.session, placed);
    }
    Fusion {
        map,
        coverage: placed.iter().map(|placed| placed.coverage).collect(),
    }
}

fn cells_of_run(rows: &[RunRow]) -> Vec<RunCell> {
    rows.iter().map(RunCell::from).collect()
}
