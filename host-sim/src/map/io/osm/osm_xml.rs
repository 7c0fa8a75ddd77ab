//! OpenStreetMap as XML (<https://wiki.openstreetmap.org/wiki/OSM_XML>).

use super::roads::Roads;
use crate::error::Result;
use crate::map::io::xml_steps::{Step, for_each_step};
use std::collections::BTreeMap;
use std::path::Path;

/// A way so far.
#[derive(Default)]
struct Way {
    id: i64,
    nodes: Vec<i64>,
    places: Vec<(i64, (f64, f64))>,
    tags: BTreeMap<String, String>,
}

/// Takes the ways of a file.
///
/// # Errors
/// Returns an error for what is no XML, and for too many nodes.
pub(super) fn read_ways(path: &Path, roads: &mut Roads) -> Result<()> {
    let mut way: Option<Way> = None;
    for_each_step(path, |step| {
        match (step, &mut way) {
            (Step::Open("way", element), _) => {
                // JOSM and Overpass keep what is deleted.
                let is_there = element.text("visible").as_deref() != Some("false")
                    && element.text("action").as_deref() != Some("delete");
                way = element.number("id").filter(|_| is_there).map(|id| Way {
                    id,
                    ..Way::default()
                });
            }
            (Step::Open("nd", element), Some(way)) => {
                if let Some(node) = element.number("ref") {
                    way.nodes.push(node);
                    if let Some(place) = element.place() {
                        way.places.push((node, place));
                    }
                }
            }
            (Step::Open("tag", element), Some(way)) => {
                if let (Some(key), Some(value)) = (element.text("k"), element.text("v")) {
                    way.tags.insert(key, value);
                }
            }
            (Step::Close("way"), Some(_)) => {
                let whole = way.take().unwrap_or_default();
                let tag = |key: &str| whole.tags.get(key).map(String::as_str);
                roads.way(whole.id, whole.nodes, tag)?;
                for (node, place) in whole.places {
                    roads.node(node, place);
                }
            }
            _ => {}
        }
        Ok(())
    })
}

/// Takes the nodes of a file.
///
/// # Errors
/// Returns an error for what is no XML.
pub(super) fn read_nodes(path: &Path, roads: &mut Roads) -> Result<()> {
    for_each_step(path, |step| {
        if let Step::Open("node", element) = step
            && let (Some(id), Some(place)) = (element.number("id"), element.place())
        {
            roads.node(id, place);
        }
        Ok(())
    })
}
