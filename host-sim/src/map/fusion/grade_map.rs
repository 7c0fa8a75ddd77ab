//! Fusion of runs in two levels, weighted by the inverse of their variances (Sahlholm and
//! Johansson, "Road grade estimation for look-ahead vehicle control using multiple measurement
//! runs", 2010; thesis section 3.1). The correlation between runs is in dependence.rs.
//!
//! The runs of one session (one vehicle, one day) give one estimate; the sessions give the map. A
//! run without a session is a session of its own.
//!
//! Only sums are kept: one for each named session, and one for all runs without a session. The size
//! of a map does not depend on the number of runs. Runs can be added one by one, and maps merged in
//! any order.

use super::cell_sums::CellSums;
use super::dependence::{BETWEEN_SESSIONS, Dependence, Disagreement, Expectation, WITHIN_SESSION};
use super::map_row::{MapRow, WayRows};
use crate::files::run::{RunCell, RunRow};
use crate::map::geometry::network::Network;
use crate::map::matching::placing::{Coverage, PlacedRun, place};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A run with its session.
#[derive(Clone, Copy, Debug)]
pub struct SessionRun<'a> {
    /// `None` is a session of its own.
    pub session: Option<&'a str>,
    /// The cells of the run.
    pub rows: &'a [RunRow],
}

/// Agreement of estimates, and the correlation derived from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Disagreement of the estimates.
    pub disagreement: Disagreement,
    /// Correlation derived from it.
    pub dependence: Dependence,
}

/// A fused map, with the agreement of its runs.
#[derive(Clone, Debug)]
pub struct FusedMap {
    /// The ways with the cells that some run covered; ways without such cells are left out.
    pub ways: Vec<WayRows>,
    /// Agreement within each named session.
    pub within: Vec<(String, Agreement)>,
    /// Agreement of the sessions.
    pub between: Agreement,
}

impl FusedMap {
    /// Returns the rows of all ways.
    #[must_use]
    pub fn rows(&self) -> Vec<MapRow> {
        let rows = self.ways.iter().flat_map(|way| &way.rows);
        rows.copied().collect()
    }
}

/// Sums of the cells of each way that a session covers.
type SessionSums = BTreeMap<usize, Vec<CellSums>>;

/// Sums over a network, for every cell of 2.5 m of each way.
#[derive(Clone, Debug)]
pub struct GradeMap<'a> {
    network: &'a Network,
    /// Runs without a session, on all ways.
    alone: Vec<CellSums>,
    /// Runs of each open session.
    sessions: BTreeMap<String, SessionSums>,
    /// Closed sessions, with the agreement of their runs.
    closed: Pooled,
    within: Vec<(String, Agreement)>,
}

/// Sessions, each as one estimate.
#[derive(Clone, Debug)]
struct Pooled {
    cells: Vec<CellSums>,
    /// Number of runs.
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
    fn add(&mut self, network: &Network, session: &SessionSums) -> Agreement {
        let agreement = agreement(&WITHIN_SESSION, session.values().flatten());
        for (&way, cells) in session {
            let of_way = network.cells_of(way);
            let known = self.cells[of_way.clone()].iter_mut();
            for ((sums, runs), cell) in known.zip(&mut self.runs[of_way]).zip(cells) {
                sums.merge(&cell.pooled(&agreement.dependence));
                *runs = runs.saturating_add(cell.estimates);
            }
        }
        agreement
    }
}

impl<'a> GradeMap<'a> {
    /// Creates an empty map of a network.
    pub fn new(network: &'a Network) -> Self {
        let count = network.cells();
        Self {
            network,
            alone: vec![CellSums::default(); count],
            sessions: BTreeMap::new(),
            closed: Pooled::new(count),
            within: Vec::new(),
        }
    }

    /// Returns the network of the map.
    pub const fn network(&self) -> &'a Network {
        self.network
    }

    /// Adds one run; returns its coverage of the network.
    pub fn add_run(&mut self, run: &SessionRun) -> Coverage {
        let placed = place(self.network, &cells_of_run(run.rows));
        self.add_placed(run.session, &placed);
        placed.coverage
    }

    /// Adds a run that was placed on the network of this map.
    pub fn add_placed(&mut self, session: Option<&str>, run: &PlacedRun) {
        if run.cells.is_empty() {
            return;
        }
        for of_way in run.cells.chunk_by(|a, b| a.way == b.way) {
            let way = of_way[0].way;
            let first = self.network.first_number(way);
            let cells = self.cells_of(session, way);
            for placed in of_way {
                let index = usize::try_from(placed.number - first).ok();
                if let Some(cell) = index.and_then(|index| cells.get_mut(index)) {
                    let grade = (placed.grade_percent, placed.grade_variance);
                    cell.merge(&CellSums::of(grade, placed.altitude));
                }
            }
        }
    }

    /// Combines the runs of a session into one estimate and frees their memory. No run of this
    /// session may be added later, and the map can no longer be stored.
    pub fn close_session(&mut self, name: &str) {
        if let Some(session) = self.sessions.remove(name) {
            let agreement = self.closed.add(self.network, &session);
            self.within.push((name.to_owned(), agreement));
        }
    }

    /// Adds the sums of another map of the same network.
    pub fn merge(&mut self, other: &Self) {
        let is_same = std::ptr::eq(self.network, other.network);
        debug_assert!(is_same, "maps of one network");
        merge_cells(&mut self.alone, &other.alone);
        for (name, session) in &other.sessions {
            for (&way, cells) in session {
                merge_cells(self.cells_of(Some(name), way), cells);
            }
        }
        merge_cells(&mut self.closed.cells, &other.closed.cells);
        for (runs, others) in self.closed.runs.iter_mut().zip(&other.closed.runs) {
            *runs = runs.saturating_add(*others);
        }
        self.within.extend(other.within.iter().cloned());
    }

    /// Returns the fused map.
    pub fn fused(&self) -> FusedMap {
        let mut pooled = self.closed.clone();
        let mut within = self.within.clone();
        for (name, session) in &self.sessions {
            within.push((name.clone(), pooled.add(self.network, session)));
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
        let ways = self.network.ways().iter().enumerate().map(|(way, of_way)| {
            let cells = self.network.cells_of(way);
            let known = estimates[cells.clone()].iter().zip(&runs[cells]);
            let rows = of_way.cell_distances().zip(known);
            let rows = rows.filter_map(|(distance_m, (sums, &runs))| {
                let (grade_percent, variance) = sums.grade(&between.dependence)?;
                let (latitude_deg, longitude_deg) = of_way.line.position_at(distance_m);
                Some(MapRow {
                    distance_m,
                    latitude_deg,
                    longitude_deg,
                    altitude_m: sums.altitude_m(),
                    grade_percent,
                    grade_sigma_percent: variance.sqrt(),
                    runs,
                })
            });
            WayRows {
                name: of_way.name.clone(),
                rows: rows.collect(),
            }
        });
        FusedMap {
            ways: ways.filter(|way| !way.rows.is_empty()).collect(),
            within,
            between,
        }
    }

    /// Returns the number of cells whose sums are held.
    pub fn held_cells(&self) -> usize {
        let of_sessions = self.sessions.values().flat_map(BTreeMap::values);
        self.alone.len() + of_sessions.map(Vec::len).sum::<usize>()
    }

    /// Returns the sums of every cell of each way: first of the runs without a session on all ways,
    /// then of each named session on the ways that it covers.
    pub(crate) fn sums(&self) -> impl Iterator<Item = (Option<&str>, usize, &[CellSums])> {
        let ways = 0..self.network.ways().len();
        let alone = ways.map(|way| (None, way, &self.alone[self.network.cells_of(way)]));
        let named = self.sessions.iter().flat_map(|(name, session)| {
            let ways = session.iter();
            ways.map(|(&way, cells)| (Some(name.as_str()), way, cells.as_slice()))
        });
        alone.chain(named)
    }

    /// Returns the sums of a session in the cells of a way.
    pub(crate) fn cells_of(&mut self, session: Option<&str>, way: usize) -> &mut [CellSums] {
        let of_way = self.network.cells_of(way);
        let Some(name) = session else {
            return &mut self.alone[of_way];
        };
        let empty = || vec![CellSums::default(); of_way.len()];
        let session = self.sessions.entry(name.to_owned()).or_default();
        session.entry(way).or_insert_with(empty)
    }
}

fn merge_cells(cells: &mut [CellSums], others: &[CellSums]) {
    for (cell, other) in cells.iter_mut().zip(others) {
        cell.merge(other);
    }
}

fn agreement<'c>(
    expectation: &Expectation,
    cells: impl IntoIterator<Item = &'c CellSums>,
) -> Agreement {
    let mut disagreement = Disagreement::default();
    for cell in cells {
        disagreement.add(&cell.disagreement());
    }
    Agreement {
        disagreement,
        dependence: expectation.learn(&disagreement),
    }
}

/// A map fused from runs, with the coverage of each.
#[derive(Clone, Debug)]
pub struct Fusion<'a> {
    /// The fused map.
    pub map: GradeMap<'a>,
    /// Coverage of each run, in the order given.
    pub coverage: Vec<Coverage>,
}

/// Fuses runs on a network. The result does not depend on the number of threads.
pub fn fuse<'a>(network: &'a Network, runs: &[SessionRun]) -> Fusion<'a> {
    let placed: Vec<PlacedRun> = runs
        .par_iter()
        .map(|run| place(network, &cells_of_run(run.rows)))
        .collect();
    let mut map = GradeMap::new(network);
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
