//! The grades of a way, in the order of its points.

use crate::map::fusion::map_row::{MapRow, WayRows};
use crate::map::geometry::grid::GRID_M;
use crate::map::geometry::network::Network;
use crate::map::geometry::road_line::RoadPoint;
use crate::map::geometry::structure::Structure;
use crate::map::geometry::way_index::Way;
use crate::map::geometry::way_name::{WayDirection, WayName};
use std::collections::BTreeMap;
use std::ops::Range;

/// Part of a stretch that needs cells for a mean of it, or to be among the steepest.
pub const LEAST_COVERED: f64 = 0.8;

/// A way of a network with what the map has of it.
#[derive(Debug)]
pub struct WayProfile<'n> {
    /// Name of the way; `None` for a single road.
    pub way: Option<&'n str>,
    /// Points in the order of the file; distances from its first point, m.
    pub points: Vec<RoadPoint>,
    /// What carries it.
    pub structure: Option<Structure>,
    /// Directions in which it may be driven.
    pub directions: Vec<WayDirection>,
    /// Cells of each direction, at distances and with signs of the order of the points.
    forward: Vec<MapRow>,
    backward: Vec<MapRow>,
}

/// A mean over cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Grade, %, along the order of the points.
    pub grade_percent: f64,
    /// Sigma, %: the mean sigma of the cells, because their errors are almost the same.
    pub sigma_percent: f64,
    /// Part of the stretch that has cells, 0 to 1.
    pub covered: f64,
    /// Least number of runs.
    pub runs: u32,
}

impl WayProfile<'_> {
    /// Returns the length of the way, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.points[self.points.len() - 1].distance_m
    }

    /// Returns the mean over a range of distances as the runs of one direction have it; `None`
    /// without a cell there.
    #[must_use]
    pub fn part(&self, direction: WayDirection, range_m: &Range<f64>) -> Option<Stretch> {
        let rows = match direction {
            WayDirection::Forward => &self.forward,
            WayDirection::Backward => &self.backward,
        };
        stretch(rows, range_m)
    }

    /// Returns the mean over a range of distances from both directions; `None` if neither covers
    /// it, or if both do and contradict each other.
    #[must_use]
    pub fn mean(&self, range_m: &Range<f64>) -> Option<Stretch> {
        let [forward, backward] =
            [WayDirection::Forward, WayDirection::Backward].map(|direction| {
                self.part(direction, range_m)
                    .filter(|stretch| stretch.covered >= LEAST_COVERED)
            });
        match (forward, backward) {
            (Some(forward), Some(backward)) => forward.with(&backward),
            (one, other) => one.or(other),
        }
    }

    /// Returns the altitude at a distance, m; `None` if no cell within a step has one.
    #[must_use]
    pub fn altitude_m(&self, at_m: f64) -> Option<f64> {
        let all = [&self.forward, &self.backward].map(|rows| altitude_m(rows, at_m));
        let known: Vec<f64> = all.into_iter().flatten().collect();
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    }

    /// Returns the positions from one distance to another, with those of the points between them.
    #[must_use]
    pub fn positions(&self, range_m: &Range<f64>) -> Vec<(f64, f64)> {
        let ends = [range_m.start, range_m.end].map(|at_m| self.position(at_m));
        let between = self.points.iter().filter(|point| {
            // Another position within a centimetre is none.
            point.distance_m > range_m.start + 0.01 && point.distance_m < range_m.end - 0.01
        });
        let between = between.map(|point| (point.latitude_deg, point.longitude_deg));
        ends[..1]
            .iter()
            .copied()
            .chain(between)
            .chain([ends[1]])
            .collect()
    }

    fn position(&self, at_m: f64) -> (f64, f64) {
        let last = self.points.len() - 1;
        let i = self
            .points
            .partition_point(|point| point.distance_m <= at_m);
        let (a, b) = (
            self.points[i.clamp(1, last) - 1],
            self.points[i.clamp(1, last)],
        );
        let part = ((at_m - a.distance_m) / (b.distance_m - a.distance_m)).clamp(0.0, 1.0);
        let turn = (b.longitude_deg - a.longitude_deg + 180.0).rem_euclid(360.0) - 180.0;
        (
            a.latitude_deg + part * (b.latitude_deg - a.latitude_deg),
            a.longitude_deg + part * turn,
        )
    }
}

impl Stretch {
    /// Returns the mean with the other direction, weighted by variances. The errors of both may be
    /// the same (a slope of the sensor), so the sigma does not shrink. `None` if they differ by
    /// more than three sigmas.
    fn with(&self, other: &Self) -> Option<Self> {
        let difference = self.grade_percent - other.grade_percent;
        if difference.abs() > 3.0 * self.sigma_percent.hypot(other.sigma_percent) {
            return None;
        }
        let weights = [self, other].map(|stretch| stretch.sigma_percent.powi(-2));
        let sum = weights[0] + weights[1];
        let mean = |a: f64, b: f64| (weights[0] * a + weights[1] * b) / sum;
        Some(Self {
            grade_percent: mean(self.grade_percent, other.grade_percent),
            sigma_percent: mean(self.sigma_percent, other.sigma_percent),
            covered: self.covered.max(other.covered),
            runs: self.runs.max(other.runs),
        })
    }
}

/// Returns the ways of a network with their cells of the map.
///
/// # Errors
/// Returns an error if the map has a way that the network lacks, or cells beyond the end of one.
pub fn profiles<'n>(network: &'n Network, map: &[WayRows]) -> Result<Vec<WayProfile<'n>>, String> {
    let mut rows: BTreeMap<Option<&WayName>, &[MapRow]> = map
        .iter()
        .map(|way| (way.name.as_ref(), way.rows.as_slice()))
        .collect();
    let mut profiles: Vec<WayProfile> = Vec::new();
    // Both directions of a way are neighbours, forward first.
    for way in network.ways() {
        let of_way = rows.remove(&way.name.as_ref()).unwrap_or_default();
        let length_m = way.line.end_m() - way.line.start_m();
        if let Some(row) = of_way.last()
            && row.distance_m > way.line.end_m() + GRID_M
        {
            let name = way
                .name
                .as_ref()
                .map_or_else(String::new, |n| format!("way {n}: "));
            return Err(format!(
                "{name}cells up to {:.0} m on a way of {length_m:.0} m; expected a map of this network",
                row.distance_m
            ));
        }
        let name = way.name.as_ref().map(|name| name.way.as_str());
        match profiles.last_mut() {
            Some(last) if last.way == name && name.is_some() => last.add(way, of_way),
            _ => profiles.push(profile(network, way, of_way)),
        }
    }
    match rows.keys().next() {
        None => Ok(profiles),
        Some(Some(name)) => Err(format!(
            "has way {name}, which the network lacks; expected a map of this network"
        )),
        Some(None) => Err("has a single road; expected a map of this network".to_owned()),
    }
}

fn profile<'n>(network: &Network, way: &'n Way, rows: &[MapRow]) -> WayProfile<'n> {
    let name = way.name.as_ref();
    let mut points = way.line.points().to_vec();
    let start_m = way.line.start_m();
    let end_m = way.line.end_m();
    if direction(way) == WayDirection::Backward {
        points.reverse();
        for point in &mut points {
            point.distance_m = end_m - point.distance_m;
        }
    } else {
        for point in &mut points {
            point.distance_m -= start_m;
        }
    }
    let mut profile = WayProfile {
        way: name.map(|name| name.way.as_str()),
        points,
        structure: name.and_then(|name| network.structure(&name.way)),
        directions: Vec::new(),
        forward: Vec::new(),
        backward: Vec::new(),
    };
    profile.add(way, rows);
    profile
}

impl WayProfile<'_> {
    fn add(&mut self, way: &Way, rows: &[MapRow]) {
        let (start_m, end_m) = (way.line.start_m(), way.line.end_m());
        self.directions.push(direction(way));
        match direction(way) {
            WayDirection::Forward => self.forward.extend(rows.iter().map(|row| MapRow {
                distance_m: row.distance_m - start_m,
                ..*row
            })),
            WayDirection::Backward => self.backward.extend(rows.iter().rev().map(|row| MapRow {
                distance_m: end_m - row.distance_m,
                grade_percent: -row.grade_percent,
                ..*row
            })),
        }
    }
}

fn direction(way: &Way) -> WayDirection {
    way.name
        .as_ref()
        .map_or(WayDirection::Forward, |name| name.direction)
}

fn stretch(rows: &[MapRow], range_m: &Range<f64>) -> Option<Stretch> {
    let first = rows.partition_point(|row| row.distance_m < range_m.start);
    let last = rows.partition_point(|row| row.distance_m < range_m.end);
    let rows = &rows[first..last];
    let mean = |value: fn(&MapRow) -> f64| rows.iter().map(value).sum::<f64>() / rows.len() as f64;
    let length_m = range_m.end - range_m.start;
    Some(Stretch {
        runs: rows.iter().map(|row| row.runs).min()?,
        grade_percent: mean(|row| row.grade_percent),
        sigma_percent: mean(|row| row.grade_sigma_percent),
        covered: (rows.len() as f64 * GRID_M / length_m).min(1.0),
    })
}

fn altitude_m(rows: &[MapRow], at_m: f64) -> Option<f64> {
    let next = rows.partition_point(|row| row.distance_m <= at_m);
    let near = rows.get(next.saturating_sub(1)..(next + 1).min(rows.len()))?;
    let near: Vec<_> = near
        .iter()
        .filter(|row| (row.distance_m - at_m).abs() < 1.5 * GRID_M)
        .filter_map(|row| Some((row.distance_m, row.altitude_m?, row.grade_percent / 100.0)))
        .collect();
    // The cell's own grade leads to the place, at most a step away.
    let at = near
        .iter()
        .map(|(from_m, altitude_m, grade)| altitude_m + grade * (at_m - from_m));
    (!near.is_empty()).then(|| at.sum::<f64>() / near.len() as f64)
}
