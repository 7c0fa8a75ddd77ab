//! Where output goes, and what else is written beside runs and maps.

mod drive;
mod files;
mod formats;
mod messages;
