//! The roads of an OpenStreetMap extract (.osm.pbf), or of its XML (.osm).

use super::roads::{OsmExtract, Roads};
use super::{osm_xml, pbf};
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use std::path::Path;

/// Reads the roads of an extract. Ways come after their nodes, so the file is read twice: memory
/// depends on the roads alone. Of an extract whose ways have the places of their nodes
/// (`osmium add-locations-to-ways`), these count; it may lack the nodes. A way or a node that is
/// wrong is left out.
///
/// # Errors
/// Returns an error that names the file and the block, and what was expected.
pub fn read(path: &Path) -> Result<OsmExtract> {
    let mut roads = Roads::default();
    let is_xml = kind::of(path) == Some(Kind::OsmXml);
    if is_xml {
        osm_xml::read_ways(path, &mut roads)?;
    } else {
        pbf::read_ways(path, &mut roads)?;
    }
    if roads.roads.is_empty() {
        let problem = "no roads; expected ways with a highway for vehicles";
        let first = roads.left_out.first().first();
        return Err(Error::content(path, first.map_or(problem, String::as_str)));
    }
    if is_xml {
        osm_xml::read_nodes(path, &mut roads)?;
    } else {
        pbf::read_nodes(path, &mut roads)?;
    }
    Ok(roads.done())
}
