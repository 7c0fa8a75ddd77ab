//! From drives to what the vehicle model lacks.

pub mod candidates;
pub mod drive;
pub mod evidence;
pub mod selection;
