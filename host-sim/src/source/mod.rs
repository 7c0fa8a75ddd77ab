//! Sources of frames and readings.

/// A CAN frame in memory.
pub mod can_frame;
/// Reader of candump logs.
pub mod candump;
mod candump_line;
/// Writer of candump logs.
pub mod candump_writer;
/// The inputs of a log of either kind.
pub mod input;
mod lines;
/// A log on disk, plain or gzip.
pub mod log_file;
/// Kinds of log files.
pub mod log_kind;
/// The log's time stamps, sent with its frames.
pub mod log_time;
/// Signal tables.
pub mod signal_table;
#[cfg(target_os = "linux")]
/// SocketCAN interfaces.
pub mod socketcan;
/// Terrain altitude from SRTM tiles.
pub mod terrain;
/// ZTBus missions.
pub mod ztbus;
