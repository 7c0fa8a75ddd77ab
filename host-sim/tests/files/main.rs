//! Files: runs, vehicle and tuning files, terrain tiles, spools.

mod run_columns;
mod spool;
mod terrain_tiles;
mod tuning_file;
mod vehicle_file;
