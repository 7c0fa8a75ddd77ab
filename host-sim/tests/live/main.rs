//! `roadgrade replay` and `listen`, as far as they need no interface.

#[path = "../command/mod.rs"]
mod command;
#[path = "../simulated/mod.rs"]
mod simulated;

mod parts;
mod usage;
