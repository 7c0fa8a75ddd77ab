//! Files of maps, roads, networks and sums.

mod checksum;
pub mod edges_csv;
pub mod elevation_tiles;
pub mod inclines_file;
pub mod learned_roads;
pub mod map_file;
pub mod map_geojson;
pub mod map_gpx;
pub mod map_kml;
mod map_lines;
pub mod map_parquet;
mod network_draft;
pub mod network_file;
pub mod network_geojson;
pub mod osm;
pub mod packed;
pub mod placed_file;
pub mod road_file;
pub mod road_row;
pub mod run_list;
pub mod session_name;
pub mod store;
pub(crate) mod store_file;
pub mod store_row;
pub mod way_file;
pub mod ways_csv;
