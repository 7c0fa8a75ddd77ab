//! OpenStreetMap: which ways are roads, in which directions, on which structures.

pub mod extract;
pub mod node_altitudes;
mod osm_xml;
#[cfg(feature = "osm-pbf")]
mod pbf;
#[cfg(not(feature = "osm-pbf"))]
#[path = "without_pbf.rs"]
mod pbf;
pub mod roads;
pub mod tags;
pub(super) mod xml;
