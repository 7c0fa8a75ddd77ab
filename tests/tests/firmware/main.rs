//! The firmware: the files that it exchanges with a host, and its results.

mod exchange;
mod large_map;
mod matches_host;
