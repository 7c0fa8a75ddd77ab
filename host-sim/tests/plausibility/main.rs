//! Warnings of `roadgrade estimate` about input that is not plausible, as a user sees them.

mod drive;
mod good;
mod wrong_signals;
mod wrong_vehicle;
