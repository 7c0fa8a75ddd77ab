//! Planes, roads, networks of ways and their joins.

pub mod course;
pub mod find_joins;
pub mod grid;
pub mod joins;
pub mod network;
pub mod network_size;
pub mod plane;
pub mod road_index;
pub mod road_line;
pub mod structure;
pub mod way_index;
pub mod way_name;
