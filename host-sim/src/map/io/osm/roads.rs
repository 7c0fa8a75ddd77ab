//! The roads of an OpenStreetMap file, and the nodes on them.

use super::tags::{directions, is_road, structure};
use crate::files::left_out::LeftOut;
use crate::map::geometry::structure::Structure;
use crate::map::geometry::way_name::WayDirection;
use crate::map::io::network_draft::position;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Most nodes of all roads, the limit of points of a network.
const MOST_NODES: usize = 2_000_000;
/// Coordinates are stored in steps of this size, 1/deg.
const STEPS: f64 = 1e7;

/// A road of an extract.
#[derive(Clone, Debug, PartialEq)]
pub struct OsmRoad {
    /// Identifier of the way.
    pub id: i64,
    /// Identifiers of its nodes.
    pub nodes: Vec<i64>,
    /// Directions in which it may be driven.
    pub directions: Vec<WayDirection>,
    /// What carries it.
    pub structure: Option<Structure>,
}

impl OsmRoad {
    /// Returns the name of the road in a network, the form of Overpass.
    #[must_use]
    pub fn name(&self) -> String {
        format!("way/{}", self.id)
    }
}

/// The roads of an extract, and the nodes on them.
#[derive(Debug, Default)]
pub struct OsmExtract {
    /// Roads in the order of the file.
    pub roads: Vec<OsmRoad>,
    /// Latitude and longitude of the nodes, deg, by identifier.
    pub positions: BTreeMap<i64, (f64, f64)>,
    /// Ways and nodes that are left out.
    pub left_out: LeftOut,
}

impl OsmExtract {
    /// Returns latitude and longitude of the nodes of a road, deg, in parts between nodes that the file
    /// lacks, and the first of these.
    #[must_use]
    pub fn parts(&self, road: &OsmRoad) -> (Vec<Vec<(f64, f64)>>, Option<i64>) {
        let is_missing = |node: &i64| !self.positions.contains_key(node);
        let missing = road.nodes.iter().copied().find(is_missing);
        let places = |nodes: &[i64]| -> Vec<(f64, f64)> {
            let place = |node| self.positions.get(node).copied();
            nodes.iter().filter_map(place).collect()
        };
        let parts = road.nodes.split(is_missing).map(places);
        let has_line = |part: &Vec<(f64, f64)>| missing.is_none() || part.len() > 1;
        (parts.filter(has_line).collect(), missing)
    }
}

/// Ways and nodes of a file while it is read.
#[derive(Default)]
pub(super) struct Roads {
    pub roads: Vec<OsmRoad>,
    /// The nodes of roads.
    places: BTreeMap<i64, Option<(f64, f64)>>,
    count: usize,
    pub left_out: LeftOut,
}

impl Roads {
    /// Takes a way, if it is a road.
    ///
    /// # Errors
    /// Returns an error for too many nodes.
    pub(super) fn way<'t>(
        &mut self,
        id: i64,
        mut nodes: Vec<i64>,
        tag: impl Fn(&str) -> Option<&'t str>,
    ) -> Result<(), String> {
        if !is_road(&tag) {
            return Ok(());
        }
        // A repeated node is no step.
        nodes.dedup();
        let name = format!("way/{id}");
        if nodes.len() < 2 {
            let problem = "fewer than two nodes; expected a line";
            self.left_out.add(format!("{name}: {problem}"));
            return Ok(());
        }
        let directions = match directions(|key| tag(key).map(Cow::from)) {
            Ok(directions) => directions,
            Err(problem) => {
                self.left_out.add(format!("{name}: {problem}"));
                return Ok(());
            }
        };
        self.count += nodes.len();
        if self.count > MOST_NODES {
            return Err(format!(
                "more than {MOST_NODES} nodes on roads; expected a smaller extract"
            ));
        }
        for node in &nodes {
            self.places.entry(*node).or_default();
        }
        self.roads.push(OsmRoad {
            id,
            nodes,
            directions,
            structure: structure(|key| tag(key).map(Cow::from)),
        });
        Ok(())
    }

    /// Takes a node, if it is on a road that came before.
    pub(super) fn node(&mut self, id: i64, place: (f64, f64)) {
        let Some(slot) = self.places.get_mut(&id) else {
            return;
        };
        match node_position(id, place) {
            Ok(place) => *slot = Some(place),
            Err(problem) => self.left_out.add(problem),
        }
    }

    /// Returns what the file has.
    pub(super) fn done(self) -> OsmExtract {
        let known = |(id, place): (i64, Option<_>)| Some((id, place?));
        OsmExtract {
            roads: self.roads,
            positions: self.places.into_iter().filter_map(known).collect(),
            left_out: self.left_out,
        }
    }
}

/// Returns the position of a node without the rounding of its sum.
fn node_position(
    node: i64,
    (latitude_deg, longitude_deg): (f64, f64),
) -> Result<(f64, f64), String> {
    let round = |angle: f64| (angle * STEPS).round() / STEPS;
    let (latitude_deg, longitude_deg) = (round(latitude_deg), round(longitude_deg));
    position(latitude_deg, longitude_deg).map_err(|problem| format!("node {node}: {problem}"))
}
