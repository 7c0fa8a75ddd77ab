//! Printing to stdout and stderr.

use crate::error::{Error, Result, without_controls};
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::Path;

/// Control characters that our own texts contain.
const OURS: [char; 2] = ['\n', '\t'];

/// Prints to stdout. Control characters, such as those of terminal escapes in names, are written as
/// `\u001b`. A closed pipe (`| head`) is not an error.
///
/// # Errors
/// Returns an error if stdout cannot be written.
pub fn print(text: &str) -> Result<()> {
    let text = without_controls(text, &OURS);
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io(Path::new("stdout"))(e)),
        _ => Ok(()),
    }
}

/// Prints a line to stderr, with control characters as in [`print()`]. A message that cannot be
/// printed is dropped: a closed stderr must not end the work.
pub fn note(message: impl Display) {
    let text = printable(&format!("{message}\n"));
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Returns a text as [`print()`] prints it.
#[must_use]
pub fn printable(text: &str) -> String {
    without_controls(text, &OURS)
}
