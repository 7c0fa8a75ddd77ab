//! Printing to stdout.

use crate::error::{Error, Result};
use std::io::{self, ErrorKind, Write};
use std::path::Path;

/// Prints to stdout. A closed pipe (`| head`) is not an error.
///
/// # Errors
/// Returns an error if stdout cannot be written.
pub fn print(text: &str) -> Result<()> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io(Path::new("stdout"))(e)),
        _ => Ok(()),
    }
}
