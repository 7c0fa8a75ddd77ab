//! Signals: frames become readings.

#[path = "../common/mod.rs"]
mod common;

mod decoding;
