//! Files: vehicles, terrain tiles, entries beyond memory.

mod spool;
mod terrain_tiles;
mod vehicle_file;
