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
use super::alignment::{Stretch, stretches};
use super::cell_sums::CellSums;
use super::dependence::{BETWEEN_SESSIONS, Dependence, Disagreement, Expectation, WITHIN_SESSION};
use super::map_file::MapRow;
use super::matching::{Place, match_track};
use super::road_line::RoadLine;
use super::track::track_of_run;
use crate::run_file::RunRow;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Cells of a run farther apart than this are not joined, m: two rows of a RUN.csv are missing.
const JOIN_LIMIT_M: f64 = 8.0;

/// How much of a run lies on the road, in cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    pub cells: usize,
    /// On the road, those bridged by odometer included.
    pub matched: usize,
    pub off_road: usize,
    /// At the road, driven against its direction.
    pub opposite: usize,
    /// Without a position, and not bridged.
    pub no_position: usize,
}

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
        }
    }

    /// The road that it is a map of.
    pub const fn road(&self) -> &'a RoadLine {
        self.road
    }

    /// Adds one run, and says how much of it lies on the road.
    pub fn add_run(&mut self, run: &SessionRun) -> Coverage {
        let SessionRun { session, rows } = *run;
        let track = track_of_run(rows);
        let places = match_track(self.road, &track);
        let count = |wanted: Place| places.iter().filter(|&&place| place == wanted).count();
        let mut coverage = Coverage {
            cells: rows.len(),
            off_road: count(Place::OffRoad),
            opposite: count(Place::Opposite),
            ..Coverage::default()
        };
        let first = self.first;
        for stretch in stretches(&track, &places) {
            coverage.matched += stretch.points.len();
            add_stretch(self.cells_of(session), first, rows, &stretch);
        }
        coverage.no_position =
            coverage.cells - coverage.matched - coverage.off_road - coverage.opposite;
        coverage
    }

    /// Adds what another map of the same road knows.
    pub fn merge(&mut self, other: &Self) {
        debug_assert!(std::ptr::eq(self.road, other.road), "maps of one road");
        merge_cells(&mut self.alone, &other.alone);
        for (name, cells) in &other.sessions {
            merge_cells(self.cells_of(Some(name)), cells);
        }
    }

    /// What the runs together say.
    pub fn fused(&self) -> FusedMap {
        let mut estimates = self.alone.clone();
        let mut runs: Vec<u32> = self.alone.iter().map(|cell| cell.estimates).collect();
        let mut within = Vec::with_capacity(self.sessions.len());
        for (name, cells) in &self.sessions {
            let agreement = agreement(&WITHIN_SESSION, cells);
            for ((sums, runs), cell) in estimates.iter_mut().zip(&mut runs).zip(cells) {
                sums.merge(&cell.pooled(&agreement.dependence));
                *runs = runs.saturating_add(cell.estimates);
            }
            within.push((name.clone(), agreement));
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

/// Interpolates a run onto the grid between neighbouring cells; `first` is the number of the
/// first of `cells`. Errors of neighbours are nearly the same, so variances are interpolated, not
/// reduced.
fn add_stretch(cells: &mut [CellSums], first: i64, rows: &[RunRow], stretch: &Stretch) {
    let rows = &rows[stretch.points.clone()];
    // Number of the first cell that this run has not yet filled.
    let mut next = i64::MIN;
    for (pair, at_m) in rows.windows(2).zip(stretch.distance_m.windows(2)) {
        let (from_m, to_m) = (at_m[0], at_m[1]);
        if to_m <= from_m || pair[1].distance_m - pair[0].distance_m > JOIN_LIMIT_M {
            continue;
        }
        let begin = ((from_m / GRID_M).ceil() as i64).max(next).max(first);
        let end = (to_m / GRID_M).floor() as i64;
        for number in begin..=end {
            let Some(cell) = usize::try_from(number - first)
                .ok()
                .and_then(|index| cells.get_mut(index))
            else {
                break;
            };
            let part = (number as f64 * GRID_M - from_m) / (to_m - from_m);
            cell.merge(&between(&pair[0], &pair[1], part));
        }
        next = next.max(end + 1);
    }
}

/// What a run knows between two of its cells.
fn between(a: &RunRow, b: &RunRow, part: f64) -> CellSums {
    let mix = |a: f64, b: f64| a + part * (b - a);
    let known = |row: &RunRow| row.altitude_m.zip(row.altitude_sigma_m);
    CellSums::of(
        (
            mix(a.grade_percent, b.grade_percent),
            mix(a.grade_sigma_percent.powi(2), b.grade_sigma_percent.powi(2)),
        ),
        known(a)
            .zip(known(b))
            .map(|((a_m, a_sigma), (b_m, b_sigma))| {
                (mix(a_m, b_m), mix(a_sigma.powi(2), b_sigma.powi(2)))
            }),
    )
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
    let added: Vec<(GradeMap<'a>, Coverage)> = runs
        .par_iter()
        .map(|run| {
            let mut map = GradeMap::new(road);
            let coverage = map.add_run(run);
            (map, coverage)
        })
        .collect();
    let mut map = GradeMap::new(road);
    for (part, _) in &added {
        map.merge(part);
    }
    Fusion {
        map,
        coverage: added.iter().map(|(_, coverage)| *coverage).collect(),
    }
}
