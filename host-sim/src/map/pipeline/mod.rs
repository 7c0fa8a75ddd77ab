//! From run files to a map file, a few runs in memory at a time.

mod cell_buffer;
pub mod fuse_files;
mod in_order;
pub mod inputs;
mod intake;
pub mod place_files;
mod road;
pub mod roads_of_runs;
pub mod words;
