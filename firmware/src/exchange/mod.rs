//! The files that an emulated board and a host exchange.
//!
//! Both are records of words ([`estimator_core::word_record`]), so that results can be compared bit
//! for bit.
//!
//! | `drive.bin`          | words | content                                                     |
//! |----------------------|-------|-------------------------------------------------------------|
//! | header, once         | 252   | see [`estimator_core::packed_vehicle`]                      |
//! | record, one a frame  | 6     | time in µs (2), identifier, length, data (2); see [`frame`] |
//!
//! | `cells.bin`          | words | content                                                     |
//! |----------------------|-------|-------------------------------------------------------------|
//! | record, one a cell   | 13    | see [`cell`]                                                |
//!
//! | `on_map.bin`, with a map in flash | words | content                                        |
//! |----------------------|-------|-------------------------------------------------------------|
//! | record, one a step   | 14    | see [`on_map`]                                              |
//!
//! Decoding refuses records of another length, and content that encoding never writes.

pub mod cell;
pub mod frame;
pub mod on_map;

use core::ffi::CStr;

/// File in QEMU's working folder that the host writes: a vehicle, and the frames of a drive.
pub const DRIVE_FILE: &CStr = c"drive.bin";
/// File in QEMU's working folder that the board writes: the finished cells.
pub const CELLS_FILE: &CStr = c"cells.bin";
/// File in QEMU's working folder that the board writes: the map's part of each step.
pub const ON_MAP_FILE: &CStr = c"on_map.bin";
