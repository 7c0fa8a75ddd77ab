//! Files: vehicles, terrain tiles, entries beyond memory.

mod spool;
mod terrain_tiles;
mod tuning_file;
mod vehicle_file;
