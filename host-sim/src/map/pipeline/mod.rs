//! From run files to a map file, a few runs in memory at a time.

pub mod fuse_files;
mod in_order;
mod inputs;
mod intake;
mod road;
pub mod roads_of_runs;
pub mod words;
