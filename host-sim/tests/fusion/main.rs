//! Runs become maps: roads, networks, stores, and `roadgrade fuse` and `export`.

#[path = "../command/mod.rs"]
mod command;
#[path = "../roads/mod.rs"]
mod roads;

mod end_to_end;
mod export;
mod fleet;
mod known_roads;
mod network;
mod network_files;
mod parquet;
mod road_line;
mod sessions;
mod store;
