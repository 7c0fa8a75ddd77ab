//! Files: runs, vehicles, terrain tiles, entries beyond memory.

mod run_columns;
mod spool;
mod terrain_tiles;
mod tuning_file;
mod vehicle_file;
