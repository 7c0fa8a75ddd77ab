//! From files of runs to the file of a map, a few runs in memory at a time.

pub mod fuse_files;
mod inputs;
mod intake;
mod road;
pub mod words;
