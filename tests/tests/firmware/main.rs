//! The firmware: what it exchanges with a host, and what it computes.

mod exchange;
mod matches_host;
