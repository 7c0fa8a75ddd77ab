//! Printing to stdout and stderr.

use crate::error::{Error, Result, without_controls};
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether stdout is an output file: tables then go to stderr.
static STDOUT_IS_OUTPUT: AtomicBool = AtomicBool::new(false);
/// Whether messages and progress are left out.
static QUIET: AtomicBool = AtomicBool::new(false);
/// Who takes the messages instead of stderr.
static TAKER: OnceLock<fn(Kind, &str)> = OnceLock::new();

/// The kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// What is good to know.
    Note,
    /// A warning or an error.
    Alert,
}

/// What messages show instead of a part of a path: the part, and what is shown.
static SHOWN: OnceLock<(String, String)> = OnceLock::new();

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

/// Passes all messages to `taker` from now on, instead of stderr. Only the first call counts. Any
/// thread may have a message.
pub fn pass_messages_to(taker: fn(Kind, &str)) {
    let _ = TAKER.set(taker);
}

/// Shows `shown` instead of `part` in all texts from now on: the address of an object instead of the
/// file that stands for it. Only the first call counts.
pub fn show_instead(part: String, shown: String) {
    let _ = SHOWN.set((part, shown));
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
    let text = printable(text);
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
        tell(Kind::Note, message);
    }
}

/// Prints a warning or an error to stderr, with control characters as in [`print()`]. One that
/// cannot be printed is dropped: a closed stderr must not end the work.
pub fn alert(message: impl Display) {
    tell(Kind::Alert, message);
}

fn tell(kind: Kind, message: impl Display) {
    let text = printable(&message.to_string());
    if let Some(taker) = TAKER.get() {
        taker(kind, &text);
        return;
    }
    let _ = io::stderr()
        .lock()
        .write_all(format!("{text}\n").as_bytes());
}

/// Returns a text as [`print()`] prints it.
#[must_use]
pub fn printable(text: &str) -> String {
    let text = without_controls(text, &OURS);
    match SHOWN.get() {
        Some((part, shown)) => text.replace(part, shown),
        None => text,
    }
}
