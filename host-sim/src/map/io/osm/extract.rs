//! The roads of an OpenStreetMap extract (.osm.pbf), or of its XML (.osm).

use super::osm_xml;
use super::pbf::for_each_block;
use super::roads::{OsmExtract, Roads};
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use osmpbf::Element;
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
        read_ways(path, &mut roads)?;
    }
    if roads.roads.is_empty() {
        let problem = "no roads; expected ways with a highway for vehicles";
        let first = roads.left_out.first().first();
        return Err(Error::content(path, first.map_or(problem, String::as_str)));
    }
    if is_xml {
        osm_xml::read_nodes(path, &mut roads)?;
    } else {
        read_nodes(path, &mut roads)?;
    }
    Ok(roads.done())
}

fn read_ways(path: &Path, roads: &mut Roads) -> Result<()> {
    for_each_block(path, |block| {
        for way in block.groups().flat_map(|group| group.ways()) {
            let tag = |key: &str| way.tags().find(|(k, _)| *k == key).map(|(_, value)| value);
            roads.way(way.id(), way.refs().collect(), tag)?;
            for (node, place) in way.refs().zip(way.node_locations()) {
                roads.node(node, (place.lat(), place.lon()));
            }
        }
        Ok(())
    })
}

fn read_nodes(path: &Path, roads: &mut Roads) -> Result<()> {
    for_each_block(path, |block| {
        for element in block.elements() {
            match element {
                Element::Node(node) => roads.node(node.id(), (node.lat(), node.lon())),
                Element::DenseNode(node) => roads.node(node.id(), (node.lat(), node.lon())),
                _ => {}
            }
        }
        Ok(())
    })
}
