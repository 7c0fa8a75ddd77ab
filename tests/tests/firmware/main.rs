//! The firmware: the files that it exchanges with a host, and its results.

mod exchange;
mod matches_host;
