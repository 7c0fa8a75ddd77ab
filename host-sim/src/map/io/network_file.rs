//! The road or network of a map from a file: ROAD.csv or ROAD.parquet with one road or several
//! ways, the lines of a GeoJSON file, or the roads of an OpenStreetMap extract.

use super::network_draft::{DraftWay, NetworkDraft};
use super::network_geojson::{is_geojson, read_geojson};
use super::osm::extract;
use super::road_file::read_ways;
use super::road_row::RoadRow;
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use crate::map::geometry::network::Network;
use crate::map::geometry::network_size::NetworkSize;
use crate::map::geometry::road_line::{RoadLine, RoadPoint};
use std::collections::BTreeSet;
use std::path::Path;

/// Returns true if the name or the content is that of an OpenStreetMap extract.
fn is_pbf(path: &Path) -> bool {
    let named = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("pbf"));
    named || kind::of(path) == Some(Kind::OsmPbf)
}

/// Reads a road or a network.
///
/// # Errors
/// Returns an error that names the file, the line or feature, and the expected value.
pub fn read(path: &Path) -> Result<Network> {
    if is_geojson(path) {
        return read_geojson(path).map_err(|e| kind::explained(e, path, &[Kind::Json]));
    }
    if is_pbf(path) {
        return read_pbf(path).map_err(|e| kind::explained(e, path, &[Kind::OsmPbf]));
    }
    let wrong = |problem| Error::content(path, problem);
    let mut draft = NetworkDraft::default();
    for way in read_ways(path)? {
        let points = way.rows.iter().map(RoadRow::point).collect();
        let Some(name) = way.name else {
            return road_through(path, points);
        };
        let line =
            RoadLine::new(points).map_err(|problem| wrong(format!("way {name}: {problem}")))?;
        draft.add_line(name, line).map_err(wrong)?;
    }
    draft.finish().map_err(wrong)
}

/// Returns the network of the roads in an OpenStreetMap extract.
fn read_pbf(path: &Path) -> Result<Network> {
    let wrong = |problem| Error::content(path, problem);
    let extract = extract::read(path)?;
    let mut names = BTreeSet::new();
    let mut draft = NetworkDraft::default();
    for road in &extract.roads {
        let name = road.name();
        if !names.insert(road.id) {
            return Err(wrong(format!(
                "{name} is there twice; expected unique ways"
            )));
        }
        let way = DraftWay {
            name: name.clone(),
            points: extract.points(road).map_err(wrong)?,
            directions: road.directions.clone(),
            structure: road.structure,
        };
        draft.add(way).map_err(|e| wrong(format!("{name}: {e}")))?;
    }
    draft.finish().map_err(wrong)
}

/// Creates a single road through these points, with a point for each of its cells. It is then
/// the same whether it comes from its file or from a store. `path` is for error messages.
///
/// # Errors
/// Returns an error if the points do not make a road.
pub fn road_through(path: &Path, points: Vec<RoadPoint>) -> Result<Network> {
    RoadLine::new(points)
        .and_then(|line| RoadLine::new(line.on_grid()))
        .map_err(|problem| problem.to_string())
        .and_then(|line| {
            let size = NetworkSize::default().add(&line);
            size.map(|()| line).map_err(|problem| problem.to_string())
        })
        .map(Network::from)
        .map_err(|problem| Error::content(path, problem))
}
