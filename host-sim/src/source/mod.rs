//! Sources of frames and readings.

pub mod can_frame;

pub mod candump_writer;
pub mod column_count;
pub mod damage;
pub mod frame_log;
pub mod frame_readings;
pub mod i3;
pub mod input;
pub mod interfaces;
mod lines;
pub mod log;
pub mod log_file;
pub mod log_kind;
pub mod log_report;
mod log_stream;
pub mod log_time;
mod mdf;
pub mod mdf_signals;
pub mod obd;
pub mod own_signals;
mod packed_bytes;
mod packed_members;
mod packing;
pub mod parquet_table;
pub mod read_options;
mod row_order;
pub mod signal_range;
pub mod signal_source;
pub mod signal_table;
#[cfg(target_os = "linux")]
pub mod socketcan;
pub mod terrain;
mod time_order;
mod vehicle_number;

pub mod ztbus;
