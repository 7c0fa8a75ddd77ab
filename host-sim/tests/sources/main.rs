//! Sources: recordings of buses, signal tables, and what is on a bus.

mod can_frame;
mod candump;
mod frame_log;
mod inspect;
mod mdf_signals;
mod own_signals;
mod packed;
mod parquet_table;
mod read_options;
mod signal_table;
