//! Terminal output: printing, progress, tables, words for counters and disagreements.

pub mod counters;
pub mod disagreements;
pub mod print;
pub mod progress;
pub mod table;
