//! Files: vehicle and tuning files, terrain tiles, spools.

mod spool;
mod terrain_tiles;
mod tuning_file;
mod vehicle_file;
