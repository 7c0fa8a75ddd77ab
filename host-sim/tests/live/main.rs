//! `roadgrade replay` and `listen`, without an interface.

mod parts;
mod usage;
