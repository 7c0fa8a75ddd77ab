//! Terminal output: printing, progress, tables, names of counters.

pub mod counters;
pub mod print;
pub mod progress;
pub mod table;
