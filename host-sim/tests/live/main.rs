//! `roadgrade replay` and `listen`, without an interface.

mod on_map;
mod parts;
mod usage;
