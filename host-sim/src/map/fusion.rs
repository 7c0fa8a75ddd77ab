//! Fusion of runs, weighted by the inverse of their variances (Sahlholm and Johansson, "Road
//! grade estimation for look-ahead vehicle control using multiple measurement runs", 2010;
//! thesis section 3.1).
//!
//! Only sums are kept, so a map's size does not depend on the number of its runs, runs can be
//! added one by one and maps merged in any order.

use super::GRID_M;
use super::alignment::{Stretch, stretches};
use super::map_file::MapRow;
use super::matching::{Place, match_track};
use super::road_line::RoadLine;
use super::track::track_of_run;
use crate::run_file::RunRow;
use rayon::prelude::*;

/// Cells of a run farther apart than this are not joined, m: two rows of a RUN.csv are missing.
const JOIN_LIMIT_M: f64 = 8.0;

/// What is known of one cell of a road: sums over runs. The default knows nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapCell {
    /// Sum of w = 1/sigma² of the grade, 1/%².
    pub grade_information: f64,
    /// Sum of w times grade, 1/%.
    pub grade_sum: f64,
    /// Sum of w times grade²: tells how far the runs disagree.
    pub grade_square_sum: f64,
    /// Sum of 1/sigma² of the altitude, 1/m².
    pub altitude_information: f64,
    /// Sum of altitude over sigma², 1/m.
    pub altitude_sum: f64,
    /// Number of traversals.
    pub runs: u32,
}

impl MapCell {
    /// What one run knows: grade and its variance, %, and altitude and its variance, m.
    pub fn of_run(grade: (f64, f64), altitude: Option<(f64, f64)>) -> Self {
        let (grade_percent, variance) = grade;
        let mut cell = Self {
            grade_information: 1.0 / variance,
            grade_sum: grade_percent / variance,
            grade_square_sum: grade_percent * grade_percent / variance,
            runs: 1,
            ..Self::default()
        };
        if let Some((altitude_m, variance)) = altitude {
            cell.altitude_information = 1.0 / variance;
            cell.altitude_sum = altitude_m / variance;
        }
        cell
    }

    /// Adds what another cell knows of the same place. Commutative.
    pub fn merge(&mut self, other: &Self) {
        self.grade_information += other.grade_information;
        self.grade_sum += other.grade_sum;
        self.grade_square_sum += other.grade_square_sum;
        self.altitude_information += other.altitude_information;
        self.altitude_sum += other.altitude_sum;
        self.runs += other.runs;
    }

    /// Weighted mean and its sigma, %; `None` if nothing is known.
    pub fn grade_percent(&self) -> Option<(f64, f64)> {
        (self.runs > 0).then(|| {
            (
                self.grade_sum / self.grade_information,
                self.grade_information.sqrt().recip(),
            )
        })
    }

    /// Weighted mean, m; `None` if nothing is known.
    pub fn altitude_m(&self) -> Option<f64> {
        (self.altitude_information > 0.0).then(|| self.altitude_sum / self.altitude_information)
    }

    /// Weighted squares about the weighted mean: χ² with `runs - 1` degrees of freedom if runs
    /// err as their sigmas say, independently.
    fn chi_squared(&self) -> f64 {
        (self.grade_square_sum - self.grade_sum * self.grade_sum / self.grade_information).max(0.0)
    }
}

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

/// Accumulated cells of a road, every 2.5 m.
#[derive(Clone, Debug)]
pub struct GradeMap<'a> {
    road: &'a RoadLine,
    /// Number of the first cell: its distance over 2.5 m.
    first: i64,
    cells: Vec<MapCell>,
}

impl<'a> GradeMap<'a> {
    /// An empty map of a road.
    pub fn new(road: &'a RoadLine) -> Self {
        let first = (road.start_m() / GRID_M).ceil() as i64;
        let last = (road.end_m() / GRID_M).floor() as i64;
        let count = usize::try_from(last - first + 1).unwrap_or(0);
        Self {
            road,
            first,
            cells: vec![MapCell::default(); count],
        }
    }

    /// Adds one run, and says how much of it lies on the road.
    pub fn add_run(&mut self, rows: &[RunRow]) -> Coverage {
        let track = track_of_run(rows);
        let places = match_track(self.road, &track);
        let count = |wanted: Place| places.iter().filter(|&&place| place == wanted).count();
        let mut coverage = Coverage {
            cells: rows.len(),
            off_road: count(Place::OffRoad),
            opposite: count(Place::Opposite),
            ..Coverage::default()
        };
        for stretch in stretches(&track, &places) {
            coverage.matched += stretch.points.len();
            self.add_stretch(rows, &stretch);
        }
        coverage.no_position =
            coverage.cells - coverage.matched - coverage.off_road - coverage.opposite;
        coverage
    }

    /// Adds what another map of the same road knows.
    pub fn merge(&mut self, other: &Self) {
        debug_assert!(std::ptr::eq(self.road, other.road), "maps of one road");
        for (cell, other) in self.cells.iter_mut().zip(&other.cells) {
            cell.merge(other);
        }
    }

    /// The cells that some run covered.
    pub fn rows(&self) -> Vec<MapRow> {
        (self.first..)
            .zip(&self.cells)
            .filter_map(|(number, cell)| {
                let (grade_percent, grade_sigma_percent) = cell.grade_percent()?;
                let distance_m = number as f64 * GRID_M;
                let (latitude_deg, longitude_deg) = self.road.position_at(distance_m);
                Some(MapRow {
                    distance_m,
                    latitude_deg,
                    longitude_deg,
                    altitude_m: cell.altitude_m(),
                    grade_percent,
                    grade_sigma_percent,
                    runs: cell.runs,
                })
            })
            .collect()
    }

    /// Squared disagreement of the runs over what their sigmas promise: near 1 if the sigmas are
    /// honest and errors independent, below 1 if runs err alike. `None` with one run.
    pub fn disagreement(&self) -> Option<f64> {
        let (chi_squared, freedom) = self
            .cells
            .iter()
            .filter(|cell| cell.runs > 1)
            .fold((0.0, 0.0), |(sum, freedom), cell| {
                (sum + cell.chi_squared(), freedom + f64::from(cell.runs - 1))
            });
        (freedom > 0.0).then(|| chi_squared / freedom)
    }

    /// Interpolates a run onto the grid between neighbouring cells. Their errors are nearly the
    /// same, so variances are interpolated, not reduced.
    fn add_stretch(&mut self, rows: &[RunRow], stretch: &Stretch) {
        let rows = &rows[stretch.points.clone()];
        // Number of the first cell that this run has not yet filled.
        let mut next = i64::MIN;
        for (pair, at_m) in rows.windows(2).zip(stretch.distance_m.windows(2)) {
            let (from_m, to_m) = (at_m[0], at_m[1]);
            if to_m <= from_m || pair[1].distance_m - pair[0].distance_m > JOIN_LIMIT_M {
                continue;
            }
            let begin = ((from_m / GRID_M).ceil() as i64).max(next).max(self.first);
            let end = (to_m / GRID_M).floor() as i64;
            for number in begin..=end {
                let Some(cell) = usize::try_from(number - self.first)
                    .ok()
                    .and_then(|index| self.cells.get_mut(index))
                else {
                    break;
                };
                let part = (number as f64 * GRID_M - from_m) / (to_m - from_m);
                cell.merge(&between(&pair[0], &pair[1], part));
            }
            next = next.max(end + 1);
        }
    }
}

/// What a run knows between two of its cells.
fn between(a: &RunRow, b: &RunRow, part: f64) -> MapCell {
    let mix = |a: f64, b: f64| a + part * (b - a);
    let known = |row: &RunRow| row.altitude_m.zip(row.altitude_sigma_m);
    MapCell::of_run(
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
pub fn fuse<'a>(road: &'a RoadLine, runs: &[&[RunRow]]) -> Fusion<'a> {
    let added: Vec<(GradeMap<'a>, Coverage)> = runs
        .par_iter()
        .map(|rows| {
            let mut map = GradeMap::new(road);
            let coverage = map.add_run(rows);
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
