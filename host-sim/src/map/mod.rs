//! From runs to a map: roads and networks, map matching, and fusion of the grades of many runs.
//!
//! Distances along a road are those of its own `distance_m`. The odometer of a run only bridges the
//! gaps between positions.
//!
//! * [`geometry`]: planes, roads, networks and where their ways join;
//! * [`matching`]: matches the points of a run to a network;
//! * [`fusion`]: fuses the cells of many runs;
//! * [`slopes`]: slopes of edges, and inclines;
//! * [`io`]: files of maps, roads, networks and sums;
//! * [`pipeline`]: from files of runs to a map, a few in memory at a time.

pub mod fusion;
pub mod geometry;
pub mod io;
pub mod matching;
pub mod pipeline;
pub mod slopes;

pub use fusion::cell_sums::CellSums;
pub use fusion::dependence::{
    BETWEEN_SESSIONS, Dependence, Disagreement, Expectation, WITHIN_SESSION,
};
pub use fusion::grade_map::{Agreement, FusedMap, Fusion, GradeMap, SessionRun, fuse};
pub use fusion::map_row::{MapRow, WayRows};
pub use geometry::grid::GRID_M;
pub use geometry::network::Network;
pub use geometry::road_line::{RoadLine, RoadPoint, RoadProblem};
pub use geometry::structure::Structure;
pub use geometry::way_index::Way;
pub use geometry::way_name::{WayDirection, WayName};
pub use io::edges_csv::stage as stage_edges_csv;
pub use io::elevation_tiles::{TileCount, write as write_elevation_tiles};
pub use io::inclines_file::stage as stage_inclines;
pub use io::learned_roads::{LearnedRun, read as read_learned_run};
pub use io::map_file::{
    read as read_map, read_ways as read_map_ways, stage as stage_map, stage_ways as stage_map_ways,
    write as write_map,
};
pub use io::map_geojson::{segments as map_segments, stage as stage_map_geojson};
pub use io::map_gpx::stage as stage_map_gpx;
pub use io::map_kml::stage as stage_map_kml;
#[cfg(feature = "parquet")]
pub use io::map_parquet::table as map_table;
pub use io::network_file::{read as read_network, road_through};
pub use io::network_geojson::is_geojson;
pub use io::osm::extract::read as read_osm_extract;
pub use io::osm::node_altitudes::stage as stage_node_altitudes;
pub use io::osm::roads::OsmExtract;
pub use io::packed::{open as open_packed_map, pack as packed_map, stage as stage_packed_map};
pub use io::placed_file::PlacedFolder;
pub use io::road_file::read as read_road;
pub use io::road_row::RoadRow;
pub use io::run_list::RunList;
pub use io::session_name::check_session_name;
pub use io::store::{MapStore, read as read_store, stage as stage_store};
pub use io::store_row::StoredWay;
pub use io::ways_csv::write as write_ways_csv;
pub use matching::placing::{
    Coverage, PlacedCell, PlacedRun, place, place_every_cell, road_distances,
};
pub use matching::track::{road_of_run, track_of_run};
pub use matching::track_point::TrackPoint;
pub use matching::viterbi::{MatchedPlace, match_track};
