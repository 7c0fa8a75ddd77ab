//! Sources: recordings of buses, signal tables, and what is on a bus.

mod can_frame;
mod candump;
mod folders;
mod foreign_tables;
mod frame_log;
mod inspect;
mod mdf_signals;
mod obd;
mod own_signals;
mod packed;
mod parquet_table;
mod read_options;
pub(crate) mod signal_table;
mod vehicle_number;
