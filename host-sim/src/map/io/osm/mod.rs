//! OpenStreetMap: which ways are roads, in which directions, on which structures.

pub mod extract;
pub mod node_altitudes;
mod osm_xml;
mod pbf;
pub mod roads;
pub mod tags;
pub(super) mod xml;
