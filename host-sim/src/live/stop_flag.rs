//! Orderly end on Ctrl-C and SIGTERM.

use crate::error::{Error, Result};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Returns a flag that SIGINT and SIGTERM set. A second signal ends the program at once.
///
/// # Errors
/// Returns an error if a handler cannot be installed.
pub fn stop_flag() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // Shells report 128 + signal for a program that a signal ended.
        let status = 128 + signal;
        register_conditional_shutdown(signal, status, Arc::clone(&stop))
            .and_then(|_| register(signal, Arc::clone(&stop)))
            .map_err(Error::io(Path::new("signal handler")))?;
    }
    Ok(stop)
}
