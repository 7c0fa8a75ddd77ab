//! Orderly end on Ctrl-C and SIGTERM.

pub use crate::files::signals::stop_flag;
