//! What a terminal shows: printing, progress, tables, words for counters.

pub mod counters;
pub mod print;
pub mod progress;
pub mod table;
