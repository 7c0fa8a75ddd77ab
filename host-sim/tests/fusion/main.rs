//! Runs become maps: roads, networks, stores, and `roadgrade fuse` and `export`.

mod alignment;
mod altitude_datum;
mod end_to_end;
mod export;
mod fleet;
mod knots;
mod known_roads;
mod network;
mod network_files;
mod osm_networks;
mod packed;
mod parquet;
mod placed;
mod road_formats;
mod road_line;
mod sessions;
mod shared_errors;
mod slopes;
mod store;
mod suspect_cells;
mod tunnels;

use host_sim::map::{WayRows, stage_map_ways};
use std::path::Path;

/// Writes ways as a map, CSV or Parquet.
fn save(folder: &Path, name: &str, ways: &[WayRows]) {
    let staged = stage_map_ways(&folder.join(name), ways).expect("staged");
    staged.commit().expect("written");
}
