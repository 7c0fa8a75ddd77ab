//! The diagnosis on logs with planted effects.

mod bench;
mod planted_logs;
