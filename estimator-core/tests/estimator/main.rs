//! The facade: frames in, cells and frames out.

#[path = "../common/mod.rs"]
mod common;

mod broadcast;
mod facade;
mod input_faults;
