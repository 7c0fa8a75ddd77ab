//! Printing to stdout and stderr.

use crate::error::{Error, Result, without_controls};
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether stdout is an output file: tables then go to stderr.
static STDOUT_IS_OUTPUT: AtomicBool = AtomicBool::new(false);
/// Whether messages and progress are left out.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Control characters that our own texts contain.
const OURS: [char; 2] = ['\n', '\t'];

/// Keeps stdout free for an output file: [`print()`] prints to stderr from now on.
pub fn leave_stdout() {
    STDOUT_IS_OUTPUT.store(true, Ordering::Relaxed);
}

/// Leaves out messages and progress from now on. Tables, warnings and errors stay.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Returns whether messages and progress are left out.
#[must_use]
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Prints to stdout. Control characters, such as those of terminal escapes in names, are written as
/// `\u001b`. A closed pipe (`| head`) is not an error.
///
/// # Errors
/// Returns an error if stdout cannot be written.
pub fn print(text: &str) -> Result<()> {
    let text = without_controls(text, &OURS);
    if STDOUT_IS_OUTPUT.load(Ordering::Relaxed) {
        let _ = io::stderr().lock().write_all(text.as_bytes());
        return Ok(());
    }
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io(Path::new("stdout"))(e)),
        _ => Ok(()),
    }
}

/// Prints a message to stderr as [`alert`] does, unless the command is quiet.
pub fn note(message: impl Display) {
    if !is_quiet() {
        alert(message);
    }
}

/// Prints a warning or an error to stderr, with control characters as in [`print()`]. One that
/// cannot be printed is dropped: a closed stderr must not end the work.
pub fn alert(message: impl Display) {
    let text = printable(&format!("{message}\n"));
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Returns a text as [`print()`] prints it.
#[must_use]
pub fn printable(text: &str) -> String {
    without_controls(text, &OURS)
}
