//! The roads of an OpenStreetMap extract (.osm.pbf).

use super::pbf::for_each_block;
use super::tags::{directions, is_road, structure};
use crate::error::{Error, Result};
use crate::files::row_check;
use crate::map::geometry::structure::Structure;
use crate::map::geometry::way_name::WayDirection;
use osmpbf::{Element, Way};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

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
#[derive(Debug)]
pub struct OsmExtract {
    /// Roads in the order of the file.
    pub roads: Vec<OsmRoad>,
    /// Latitude and longitude of the nodes, deg, by identifier.
    pub positions: BTreeMap<i64, (f64, f64)>,
}

impl OsmExtract {
    /// Returns latitude and longitude of the nodes of a road, deg.
    ///
    /// # Errors
    /// Returns an error for a node that the file lacks.
    pub fn points(&self, road: &OsmRoad) -> std::result::Result<Vec<(f64, f64)>, String> {
        let missing = |node| {
            format!(
                "way {}: no node {node}; expected an extract with complete ways \
                 (osmium extract --strategy complete_ways)",
                road.id
            )
        };
        let position = |node| self.positions.get(node).copied();
        road.nodes
            .iter()
            .map(|node| position(node).ok_or_else(|| missing(node)))
            .collect()
    }
}

/// Reads the roads of an extract. Ways come after their nodes, so the file is read twice: memory
/// depends on the roads alone. Of an extract whose ways have the places of their nodes
/// (`osmium add-locations-to-ways`), these count; it may lack the nodes.
///
/// # Errors
/// Returns an error that names the file and the block, way or node, and what was expected.
pub fn read(path: &Path) -> Result<OsmExtract> {
    let mut roads = Vec::new();
    let mut positions: BTreeMap<i64, Option<(f64, f64)>> = BTreeMap::new();
    let mut count = 0;
    for_each_block(path, |block| {
        for way in block.groups().flat_map(|group| group.ways()) {
            let Some(road) = road(&way)? else { continue };
            count += road.nodes.len();
            if count > MOST_NODES {
                return Err(format!(
                    "more than {MOST_NODES} nodes on roads; expected a smaller extract"
                ));
            }
            for node in &road.nodes {
                positions.entry(*node).or_default();
            }
            for (node, place) in way.refs().zip(way.node_locations()) {
                positions.insert(node, Some(node_position(node, (place.lat(), place.lon()))?));
            }
            roads.push(road);
        }
        Ok(())
    })?;
    if roads.is_empty() {
        let problem = "no roads; expected ways with a highway for vehicles";
        return Err(Error::content(path, problem));
    }
    for_each_block(path, |block| {
        for element in block.elements() {
            let (id, place) = match element {
                Element::Node(node) => (node.id(), (node.lat(), node.lon())),
                Element::DenseNode(node) => (node.id(), (node.lat(), node.lon())),
                _ => continue,
            };
            if let Some(slot) = positions.get_mut(&id) {
                *slot = Some(node_position(id, place)?);
            }
        }
        Ok(())
    })?;
    let known = |(id, place): (i64, Option<_>)| Some((id, place?));
    Ok(OsmExtract {
        roads,
        positions: positions.into_iter().filter_map(known).collect(),
    })
}

/// Returns the road that a way is, if it is one.
fn road(way: &Way<'_>) -> std::result::Result<Option<OsmRoad>, String> {
    let tag = |key: &str| way.tags().find(|(k, _)| *k == key).map(|(_, value)| value);
    if !is_road(tag) {
        return Ok(None);
    }
    let wrong = |problem| format!("way {}: {problem}", way.id());
    let mut nodes: Vec<i64> = way.refs().collect();
    // A repeated node is no step.
    nodes.dedup();
    if nodes.len() < 2 {
        return Err(wrong("fewer than two nodes; expected a line".to_owned()));
    }
    Ok(Some(OsmRoad {
        id: way.id(),
        nodes,
        directions: directions(|key| tag(key).map(Cow::from)).map_err(wrong)?,
        structure: structure(|key| tag(key).map(Cow::from)),
    }))
}

/// Returns the position of a node without the rounding of its sum.
fn node_position(
    node: i64,
    (latitude_deg, longitude_deg): (f64, f64),
) -> std::result::Result<(f64, f64), String> {
    let round = |angle: f64| (angle * STEPS).round() / STEPS;
    let (latitude_deg, longitude_deg) = (round(latitude_deg), round(longitude_deg));
    row_check::position(latitude_deg, longitude_deg)
        .map_err(|flaw| format!("node {node}: {}; expected {}", flaw.problem, flaw.expected))?;
    Ok((latitude_deg, longitude_deg))
}
