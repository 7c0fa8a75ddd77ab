//! Runs become maps: roads, networks, stores, and `roadgrade fuse` and `export`.

mod end_to_end;
mod export;
mod fleet;
mod knots;
mod known_roads;
mod network;
mod network_files;
mod packed;
mod parquet;
mod placed;
mod road_line;
mod sessions;
mod store;
mod suspect_cells;
