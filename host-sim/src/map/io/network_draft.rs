//! The ways of a network while it is read.

use crate::files::left_out::LeftOut;
use crate::files::row_check;
use crate::map::geometry::network::Network;
use crate::map::geometry::network_size::NetworkSize;
use crate::map::geometry::plane::chord_m;
use crate::map::geometry::road_line::{RoadLine, RoadPoint};
use crate::map::geometry::structure::Structure;
use crate::map::geometry::way_name::{WayDirection, WayName};
use std::collections::BTreeMap;

/// Latitude and longitude, deg.
pub(super) type Position = (f64, f64);

/// Returns a position on Earth.
///
/// # Errors
/// Returns an error that names the angle that is out of range. Latitude and longitude of 0 are what
/// receivers without a fix send.
pub(super) fn position(latitude_deg: f64, longitude_deg: f64) -> Result<Position, String> {
    if latitude_deg == 0.0 && longitude_deg == 0.0 {
        return Err("latitude and longitude are 0; expected a place".to_owned());
    }
    row_check::position(latitude_deg, longitude_deg).map_err(|flaw| flaw.to_string())?;
    Ok((latitude_deg, longitude_deg))
}

/// A way as a file has it.
#[derive(Debug)]
pub(super) struct DraftWay {
    pub(super) name: String,
    /// Its lines. Those that touch are one way, the others ways of their own.
    pub(super) parts: Vec<Vec<Position>>,
    pub(super) directions: Vec<WayDirection>,
    pub(super) structure: Option<Structure>,
}

/// The ways so far. Their size is checked while they are added.
#[derive(Debug, Default)]
pub(super) struct NetworkDraft {
    size: NetworkSize,
    ways: Vec<(WayName, RoadLine)>,
    structures: BTreeMap<String, Structure>,
    /// The lines of each name in the file.
    names: BTreeMap<String, Vec<u64>>,
    left_out: LeftOut,
}

impl NetworkDraft {
    /// Leaves out an object of the file.
    pub(super) fn leave_out(&mut self, problem: impl Into<String>) {
        self.left_out.add(problem);
    }

    /// Leaves out what was left out before.
    pub(super) fn leave_out_all(&mut self, others: LeftOut) {
        self.left_out.extend(others);
    }

    /// Adds a way in each of its directions. What makes no road is left out, with `place` in the message.
    ///
    /// # Errors
    /// Returns an error if the network becomes too large.
    pub(super) fn add(&mut self, place: &str, way: DraftWay) -> Result<(), String> {
        if way.parts.is_empty() {
            self.leave_out(format!(
                "{place}: no line; expected a line of two positions or more"
            ));
        }
        for points in joined(way.parts) {
            let lines = way.directions.iter().map(|direction| {
                let line = line(&points, *direction)?;
                Ok((*direction, line))
            });
            let lines: Vec<(WayDirection, RoadLine)> = match lines.collect() {
                Ok(lines) => lines,
                Err::<_, String>(problem) => {
                    self.leave_out(format!("{place}: {problem}"));
                    continue;
                }
            };
            let Some(name) = self.free_name(&way.name, &points) else {
                self.leave_out(format!("{place}: is there twice; expected unique ways"));
                continue;
            };
            for (direction, line) in lines {
                let way = name.clone();
                self.add_line(WayName { way, direction }, line)?;
            }
            if let Some(structure) = way.structure {
                self.structures.insert(name, structure);
            }
        }
        Ok(())
    }

    /// Returns the name, with a number if it is that of another line; `None` if the line is the same.
    fn free_name(&mut self, name: &str, points: &[Position]) -> Option<String> {
        let hash = xxhash_rust::xxh3::xxh3_64(&bytes_of(points));
        let known = self.names.entry(name.to_owned()).or_default();
        if known.contains(&hash) {
            return None;
        }
        known.push(hash);
        let mut number = known.len();
        let mut free = name.to_owned();
        while number > 1 {
            free = format!("{name}#{number}");
            if !self.names.contains_key(&free) {
                self.names.insert(free.clone(), vec![hash]);
                break;
            }
            number += 1;
        }
        Some(free)
    }

    /// Adds a way in one direction.
    ///
    /// # Errors
    /// Returns an error if the network becomes too large.
    pub(super) fn add_line(&mut self, name: WayName, line: RoadLine) -> Result<(), String> {
        self.size.add(&line).map_err(|e| e.to_string())?;
        self.ways.push((name, line));
        Ok(())
    }

    /// Returns the network, if its ways meet as roads do, and what is left out.
    ///
    /// # Errors
    /// Returns an error if they do not, and the first problem if there is no way.
    pub(super) fn finish(self) -> Result<(Network, LeftOut), String> {
        if let (true, Some(first)) = (self.ways.is_empty(), self.left_out.first().first()) {
            return Err(first.clone());
        }
        NetworkSize::check_meetings(self.ways.iter().map(|(_, line)| line))
            .map_err(|problem| problem.to_string())?;
        let network = Network::new(self.ways).with_structures(self.structures);
        Ok((network, self.left_out))
    }
}

fn bytes_of(points: &[Position]) -> Vec<u8> {
    let numbers = points
        .iter()
        .flat_map(|(latitude, longitude)| [latitude, longitude]);
    numbers.flat_map(|number| number.to_le_bytes()).collect()
}

/// Joins lines whose ends touch.
fn joined(parts: Vec<Vec<Position>>) -> Vec<Vec<Position>> {
    let mut lines: Vec<Vec<Position>> = Vec::new();
    for mut part in parts {
        part.dedup();
        let behind = lines
            .iter_mut()
            .find(|line| !line.is_empty() && line.last() == part.first());
        if let Some(line) = behind {
            line.extend(part.into_iter().skip(1));
            continue;
        }
        let before = lines
            .iter_mut()
            .find(|line| !line.is_empty() && line.first() == part.last());
        match before {
            Some(line) => {
                part.extend(line.iter().skip(1));
                *line = part;
            }
            None => lines.push(part),
        }
    }
    lines
}

/// Creates the line; distances are those on the ellipsoid. A repeated position is no step.
fn line(points: &[Position], direction: WayDirection) -> Result<RoadLine, String> {
    let mut points = points.to_vec();
    points.dedup();
    if points.len() < 2 {
        let count = points.len();
        return Err(format!(
            "{count} position(s) that differ; expected a line of two positions or more"
        ));
    }
    if direction == WayDirection::Backward {
        points.reverse();
    }
    let mut distance_m = 0.0;
    let mut before = None;
    let points = points.into_iter().map(|(latitude_deg, longitude_deg)| {
        let place = (latitude_deg, longitude_deg, 0.0);
        distance_m += before
            .replace(place)
            .map_or(0.0, |before| chord_m(before, place));
        RoadPoint {
            distance_m,
            latitude_deg,
            longitude_deg,
        }
    });
    RoadLine::new(points.collect()).map_err(|problem| problem.to_string())
}
