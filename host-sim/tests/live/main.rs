//! `roadgrade replay` and `listen`, as far as they need no interface.

mod parts;
mod usage;
