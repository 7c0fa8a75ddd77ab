//! From runs to a map: a road as a line, or the ways of a network, where on them each run was, and
//! what the runs together say about their grade.
//!
//! Distances along a road are those of its own `distance_m`; a run's odometer only carries from
//! one position to the next.

mod alignment;
mod cell_sums;
mod course;
mod dependence;
mod fusion;
mod joins;
mod local_fit;
mod map_file;
mod map_geojson;
mod map_parquet;
mod matching;
mod network;
mod network_file;
mod placing;
mod plane;
mod road_file;
mod road_index;
mod road_line;
mod run_list;
mod store;
mod store_row;
mod track;
mod way_file;

pub use cell_sums::CellSums;
pub use dependence::{BETWEEN_SESSIONS, Dependence, Disagreement, Expectation, WITHIN_SESSION};
pub use fusion::{Agreement, FusedMap, Fusion, GradeMap, SessionRun, fuse};
pub use map_file::{
    MapRow, read as read_map, read_ways as read_map_ways, stage as stage_map,
    stage_ways as stage_map_ways, write as write_map,
};
pub use map_geojson::{stage as stage_map_geojson, stretches as map_stretches};
pub use map_parquet::stage_placed;
pub use matching::{Place, TrackPoint, match_track};
pub use network::{Direction, Network, Way, WayName};
pub use network_file::{is_geojson, read as read_network, road_through};
pub use placing::{Coverage, PlacedCell, PlacedRun, place};
pub use road_file::{RoadRow, read as read_road};
pub use road_line::{RoadLine, RoadPoint, RoadProblem};
pub use run_list::RunList;
pub use store::{Store, StoredWay, check_session_name, read as read_store, stage as stage_store};
pub use track::{road_of_run, track_of_run};
pub use way_file::WayRows;

/// Step of a map, m: that of a cell.
pub const GRID_M: f64 = estimator_core::cell::CELL_LENGTH_M as f64;
