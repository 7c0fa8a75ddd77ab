//! Effects: each by itself, and on a drive.

#[path = "../common/mod.rs"]
mod common;

mod on_a_drive;
mod single;
