//! Where frames and readings come from.

pub mod can_frame;
pub mod candump;
pub mod candump_writer;
pub mod signal_table;
pub mod ztbus;
