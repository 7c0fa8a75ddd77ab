//! The ways of a network while it is read.

use crate::map::geometry::network::Network;
use crate::map::geometry::network_size::NetworkSize;
use crate::map::geometry::plane::chord_m;
use crate::map::geometry::road_line::{RoadLine, RoadPoint};
use crate::map::geometry::structure::Structure;
use crate::map::geometry::way_name::{WayDirection, WayName};
use std::collections::BTreeMap;

/// A way as a file has it.
#[derive(Debug)]
pub(super) struct DraftWay {
    pub(super) name: String,
    /// Latitude and longitude of its points, deg.
    pub(super) points: Vec<(f64, f64)>,
    pub(super) directions: Vec<WayDirection>,
    pub(super) structure: Option<Structure>,
}

/// The ways so far. Their size is checked while they are added.
#[derive(Debug, Default)]
pub(super) struct NetworkDraft {
    size: NetworkSize,
    ways: Vec<(WayName, RoadLine)>,
    structures: BTreeMap<String, Structure>,
}

impl NetworkDraft {
    /// Adds a way in each of its directions.
    pub(super) fn add(&mut self, way: DraftWay) -> Result<(), String> {
        for &direction in &way.directions {
            let line = line(&way.points, direction)?;
            let way = way.name.clone();
            self.add_line(WayName { way, direction }, line)?;
        }
        if let Some(structure) = way.structure {
            self.structures.insert(way.name, structure);
        }
        Ok(())
    }

    /// Adds a way in one direction.
    pub(super) fn add_line(&mut self, name: WayName, line: RoadLine) -> Result<(), String> {
        self.size.add(&line).map_err(|e| e.to_string())?;
        self.ways.push((name, line));
        Ok(())
    }

    /// Returns the network, if its ways meet as roads do.
    pub(super) fn finish(self) -> Result<Network, String> {
        NetworkSize::check_meetings(self.ways.iter().map(|(_, line)| line))
            .map_err(|problem| problem.to_string())?;
        Ok(Network::new(self.ways).with_structures(self.structures))
    }
}

/// Creates the line; distances are those on the ellipsoid. A repeated position is no step.
fn line(points: &[(f64, f64)], direction: WayDirection) -> Result<RoadLine, String> {
    let mut points = points.to_vec();
    points.dedup();
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
