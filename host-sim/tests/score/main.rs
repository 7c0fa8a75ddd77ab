//! Scores: errors against the truth, beside other methods, over windows.

#[path = "../command/mod.rs"]
mod command;
#[path = "../roads/mod.rs"]
mod roads;

mod beside_others;
mod planted_errors;
mod windows_and_drift;
