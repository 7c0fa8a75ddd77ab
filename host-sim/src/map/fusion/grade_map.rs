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

use super::altitude_datum;
use super::cell_sums::CellSums;
use super::dependence::{BETWEEN_SESSIONS, Dependence, Disagreement, Expectation, WITHIN_SESSION};
use super::map_row::{MapRow, WayRows};
use super::position_error;
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

/// Sums over a network, for every cell of 2.5 m of each way that a run covers.
#[derive(Clone, Debug)]
pub struct GradeMap<'a> {
    network: &'a Network,
    /// Runs without a session.
    alone: SessionSums,
    /// Runs of each open session.
    sessions: BTreeMap<String, SessionSums>,
    /// Closed sessions, with the agreement of their runs.
    closed: Pooled,
    within: Vec<(String, Agreement)>,
}

/// A cell with each session as one estimate.
#[derive(Clone, Copy, Debug, Default)]
struct PooledCell {
    sums: CellSums,
    /// Number of runs.
    runs: u32,
}

impl PooledCell {
    fn merge(&mut self, sums: &CellSums, runs: u32) {
        self.sums.merge(sums);
        self.runs = self.runs.saturating_add(runs);
    }
}

/// Sessions, each as one estimate, on the ways that they cover.
#[derive(Clone, Debug, Default)]
struct Pooled(BTreeMap<usize, Vec<PooledCell>>);

impl Pooled {
    fn cells(&mut self, way: usize, count: usize) -> &mut [PooledCell] {
        let empty = || vec![PooledCell::default(); count];
        self.0.entry(way).or_insert_with(empty)
    }

    /// Adds the runs of one session as one estimate.
    fn add(&mut self, session: &SessionSums) -> Agreement {
        let agreement = agreement(&WITHIN_SESSION, session.values().flatten());
        for (&way, cells) in session {
            for (known, cell) in self.cells(way, cells.len()).iter_mut().zip(cells) {
                known.merge(&cell.pooled(&agreement.dependence), cell.estimates);
            }
        }
        agreement
    }

    /// Adds estimates that are not pooled.
    fn add_alone(&mut self, sums: &SessionSums) {
        for (&way, cells) in sums {
            for (known, cell) in self.cells(way, cells.len()).iter_mut().zip(cells) {
                known.merge(cell, cell.estimates);
            }
        }
    }
}

impl<'a> GradeMap<'a> {
    /// Creates an empty map of a network.
    pub fn new(network: &'a Network) -> Self {
        Self {
            network,
            alone: SessionSums::new(),
            sessions: BTreeMap::new(),
            closed: Pooled::default(),
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
            let agreement = self.closed.add(&session);
            self.within.push((name.to_owned(), agreement));
        }
    }

    /// Adds the sums of another map of the same network.
    pub fn merge(&mut self, other: &Self) {
        let is_same = std::ptr::eq(self.network, other.network);
        debug_assert!(is_same, "maps of one network");
        for (&way, cells) in &other.alone {
            merge_cells(self.cells_of(None, way), cells);
        }
        for (name, session) in &other.sessions {
            for (&way, cells) in session {
                merge_cells(self.cells_of(Some(name), way), cells);
            }
        }
        for (&way, cells) in &other.closed.0 {
            for (known, other) in self.closed.cells(way, cells.len()).iter_mut().zip(cells) {
                known.merge(&other.sums, other.runs);
            }
        }
        self.within.extend(other.within.iter().cloned());
    }

    /// Returns the fused map.
    pub fn fused(&self) -> FusedMap {
        let mut pooled = self.closed.clone();
        let mut within = self.within.clone();
        for (name, session) in &self.sessions {
            within.push((name.clone(), pooled.add(session)));
        }
        pooled.add_alone(&self.alone);
        let estimates = pooled.0.values().flatten().map(|cell| &cell.sums);
        let between = agreement(&BETWEEN_SESSIONS, estimates);
        let ways = pooled.0.iter().map(|(&way, known)| {
            let of_way = &self.network.ways()[way];
            let rows = of_way.cell_distances().zip(known);
            let rows = rows.filter_map(|(distance_m, &PooledCell { sums, runs })| {
                let (grade_percent, variance) = sums.grade(&between.dependence)?;
                let (latitude_deg, longitude_deg) = of_way.line.position_at(distance_m);
                let row = MapRow {
                    distance_m,
                    latitude_deg,
                    longitude_deg,
                    altitude_m: sums.altitude_m(),
                    grade_percent,
                    grade_sigma_percent: variance.sqrt(),
                    runs,
                };
                Some((row, sums.altitude_weight))
            });
            let mut rows: Vec<(MapRow, f64)> = rows.collect();
            altitude_datum::join(&mut rows);
            let mut rows: Vec<MapRow> = rows.into_iter().map(|(row, _)| row).collect();
            let added: Vec<f64> = position_error::variances(&rows).collect();
            for (row, variance) in rows.iter_mut().zip(added) {
                row.grade_sigma_percent = row.grade_sigma_percent.hypot(variance.sqrt());
            }
            WayRows {
                name: of_way.name.clone(),
                rows,
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
        self.network.cells() + of_sessions.map(Vec::len).sum::<usize>()
    }

    /// Returns the sums of the cells of each way: first of the runs without a session on all ways
    /// (none on a way that they do not cover), then of each named session on the ways that it covers.
    pub(crate) fn sums(&self) -> impl Iterator<Item = (Option<&str>, usize, &[CellSums])> {
        let ways = 0..self.network.ways().len();
        let alone = ways.map(|way| {
            let cells = self.alone.get(&way);
            (None, way, cells.map_or(&[][..], Vec::as_slice))
        });
        let named = self.sessions.iter().flat_map(|(name, session)| {
            let ways = session.iter();
            ways.map(|(&way, cells)| (Some(name.as_str()), way, cells.as_slice()))
        });
        alone.chain(named)
    }

    /// Returns the sums of a session in the cells of a way.
    pub(crate) fn cells_of(&mut self, session: Option<&str>, way: usize) -> &mut [CellSums] {
        let of_way = self.network.cells_of(way);
        let empty = || vec![CellSums::default(); of_way.len()];
        let sums = match session {
            None => &mut self.alone,
            Some(name) => self.sessions.entry(name.to_owned()).or_default(),
        };
        sums.entry(way).or_insert_with(empty)
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
