//! What tests across packages share.

pub mod drive;
pub mod emulator;
pub mod planted;
