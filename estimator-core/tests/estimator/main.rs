//! The facade: frames in, cells and frames out.

mod broadcast;
mod facade;
mod input_faults;
