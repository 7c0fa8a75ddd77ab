//! Networks of ways along the spots of drives.

use super::Spot;
use crate::osm::OsmNode;
use host_sim::files::run::RunRow;
use host_sim::map::{Network, WayRows, fuse, read_network};
use serde_json::{Value, json};
use std::path::Path;

/// Number of spots from one point of a way to the next: 20 m.
const EVERY: usize = 8;

/// Returns a way through these spots. `oneway` has the values of OpenStreetMap.
pub fn way(name: &str, oneway: &str, spots: &[Spot]) -> Value {
    let last = spots.len() - 1;
    let points = (0..last).step_by(EVERY).chain([last]).map(|i| {
        let (latitude, longitude) = spots[i].latitude_longitude_deg();
        let round = |angle: f64| (angle * 1e7).round() / 1e7;
        json!([round(longitude), round(latitude)])
    });
    json!({
        "type": "Feature",
        "properties": {"way": name, "oneway": oneway},
        "geometry": {"type": "LineString", "coordinates": points.collect::<Vec<_>>()},
    })
}

/// Returns the coordinates of a GeoJSON way in 1e-7 degrees, latitude first.
fn coordinates(way: &Value) -> Vec<(i64, i64)> {
    let points = way["geometry"]["coordinates"].as_array().expect("points");
    let steps = |angle: &Value| (angle.as_f64().expect("a number") * 1e7).round() as i64;
    points
        .iter()
        .map(|p| (steps(&p[1]), steps(&p[0])))
        .collect()
}

/// Returns the nodes and, for each way, their identifiers. Equal places are one node.
pub fn osm_nodes(ways: &[Value]) -> (Vec<OsmNode<'static>>, Vec<Vec<i64>>) {
    let mut nodes: Vec<OsmNode> = Vec::new();
    let mut of_ways = Vec::new();
    for way in ways {
        let mut of_way = Vec::new();
        for (latitude, longitude) in coordinates(way) {
            let known = nodes.iter().find(|n| (n.1, n.2) == (latitude, longitude));
            let id = known.map_or(9_000_000_000 - nodes.len() as i64 * 7, |node| node.0);
            if known.is_none() {
                nodes.push((id, latitude, longitude, &[]));
            }
            of_way.push(id);
        }
        of_ways.push(of_way);
    }
    (nodes, of_ways)
}

pub fn collection(ways: &[Value]) -> String {
    json!({"type": "FeatureCollection", "features": ways}).to_string()
}

pub fn network(ways: &[Value]) -> Network {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("net.geojson");
    save(&path, ways);
    read_network(&path).expect("a network")
}

pub fn save(path: &Path, ways: &[Value]) {
    std::fs::write(path, collection(ways)).expect("written");
}

/// Returns the map of these runs, each a session of its own.
pub fn map(network: &Network, runs: &[&[RunRow]]) -> Vec<WayRows> {
    let runs: Vec<_> = runs.iter().map(|rows| super::alone(rows)).collect();
    fuse(network, &runs).map.fused().ways
}

/// Returns the rows of a way, driven forward.
pub fn rows_of<'m>(map: &'m [WayRows], name: &str) -> &'m WayRows {
    let shown = format!("{name} forward");
    let of_way = |way: &&WayRows| way.name.as_ref().is_some_and(|n| n.to_string() == shown);
    map.iter()
        .find(of_way)
        .unwrap_or_else(|| panic!("no way {name} in the map"))
}

pub fn names(map: &[WayRows]) -> Vec<String> {
    let shown = |way: &WayRows| way.name.as_ref().expect("a name").to_string();
    map.iter().map(shown).collect()
}
