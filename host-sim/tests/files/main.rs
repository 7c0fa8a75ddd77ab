//! Files: vehicles, terrain tiles, entries beyond memory.

#[path = "../command/mod.rs"]
mod command;

mod spool;
mod terrain_tiles;
mod vehicle_file;
