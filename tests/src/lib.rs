//! What tests across packages share.

pub mod diagnosed;
pub mod drive;
pub mod emulator;
pub mod planted;
