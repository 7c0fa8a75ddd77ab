//! The road or network of a map from a file: ROAD.csv or ROAD.parquet with one road or several
//! ways, lines of GeoJSON, GPX or KML, or the roads of OpenStreetMap.

use super::network_draft::{DraftWay, NetworkDraft};
use super::network_geojson::{has_geojson, read_geojson};
use super::osm::extract;
use super::road_file::read_ways;
use super::road_row::RoadRow;
use super::{network_gpx, network_kml};
use crate::error::{Error, Result, on_one_line};
use crate::files::kind::{self, Kind};
use crate::files::left_out::LeftOut;
use crate::map::geometry::network::Network;
use crate::map::geometry::network_size::NetworkSize;
use crate::map::geometry::road_line::{RoadLine, RoadPoint};
use crate::terminal::print::note;
use std::path::Path;

/// Returns true if the name or the content is that of an OpenStreetMap extract.
fn is_pbf(path: &Path) -> bool {
    let named = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("pbf"));
    named || kind::of(path) == Some(Kind::OsmPbf)
}

/// Reads a road or a network. Objects of the file that are no ways are left out, and told.
///
/// # Errors
/// Returns an error that names the file, the line or feature, and the expected value.
pub fn read(path: &Path) -> Result<Network> {
    let wrong = |problem| Error::content(path, problem);
    let draft = match kind::of(path) {
        Some(Kind::OsmXml) => of_roads(path)?,
        Some(Kind::Gpx) => network_gpx::read(path)?,
        Some(Kind::Kml) => network_kml::read(path)?,
        _ if has_geojson(path) => {
            read_geojson(path).map_err(|e| kind::explained(e, path, &[Kind::Json]))?
        }
        _ if is_pbf(path) => {
            of_roads(path).map_err(|e| kind::explained(e, path, &[Kind::OsmPbf]))?
        }
        _ => {
            let mut draft = NetworkDraft::default();
            for way in read_ways(path)? {
                let points = way.rows.iter().map(RoadRow::point).collect();
                let Some(name) = way.name else {
                    return road_through(path, points);
                };
                let line = RoadLine::new(points)
                    .map_err(|problem| wrong(format!("way {name}: {problem}")))?;
                draft.add_line(name, line).map_err(wrong)?;
            }
            draft
        }
    };
    let (network, left_out) = draft.finish().map_err(wrong)?;
    tell(path, &left_out);
    Ok(network)
}

/// Tells what is left out.
fn tell(path: &Path, left_out: &LeftOut) {
    let objects = match left_out.count() {
        0 => return,
        1 => "1 object that is no way".to_owned(),
        count => format!("{count} objects that are no ways"),
    };
    note(format_args!("{}: left out {objects}:", on_one_line(path)));
    for problem in left_out.first() {
        note(format_args!("  {problem}"));
    }
}

/// Returns the roads of OpenStreetMap. A way whose nodes are not all there is cut.
fn of_roads(path: &Path) -> Result<NetworkDraft> {
    let extract = extract::read(path)?;
    let mut draft = NetworkDraft::default();
    draft.leave_out_all(extract.left_out.clone());
    for road in &extract.roads {
        let (parts, missing) = extract.parts(road);
        if let Some(node) = missing {
            draft.leave_out(format!(
                "{}: no node {node}; expected an extract with complete ways \
                 (osmium extract --strategy complete_ways)",
                road.name()
            ));
            if parts.is_empty() {
                continue;
            }
        }
        let way = DraftWay {
            name: road.name(),
            parts,
            directions: road.directions.clone(),
            structure: road.structure,
        };
        draft
            .add(&road.name(), way)
            .map_err(|e| Error::content(path, format!("{}: {e}", road.name())))?;
    }
    Ok(draft)
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
