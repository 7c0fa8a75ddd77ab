//! What tests across packages share.

pub mod budgets;
pub mod diagnosed;
pub mod drive;
pub mod emulator;
pub mod image;
pub mod peers;
pub mod planted;
