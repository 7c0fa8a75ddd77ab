//! Errors of inputs, with what was expected.

use crate::platform::{IS_FOLDER, OUT_OF_FILES};
use std::fmt::Write;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// An error of an input. The message names the file, the line if there is one, and what was
/// expected.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be opened or read.
    #[error("{}: {}", on_one_line(path), words_of(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A line of a text file is wrong.
    #[error("{}:{line}: {problem}; expected {expected}", on_one_line(path))]
    Line {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: u64,
        /// What was found.
        problem: String,
        /// What was expected.
        expected: String,
    },
    /// A key of a TOML file is wrong.
    #[error("{}: {problem}", on_one_line(path))]
    Key {
        /// The file.
        path: PathBuf,
        /// What is wrong, with the key's name and what was expected.
        problem: String,
    },
    /// The content of the file as a whole cannot be used.
    #[error("{}: {problem}", on_one_line(path))]
    Content {
        /// The file.
        path: PathBuf,
        /// What is missing or wrong, and what was expected.
        problem: String,
    },
    /// An object cannot be read or written.
    #[error("{}: {problem}", without_controls(url, &[]))]
    Storage {
        /// Its address, s3://BUCKET/KEY.
        url: String,
        /// What is wrong, and what was expected.
        problem: String,
    },
    /// Options of the command line contradict each other.
    #[error("{0}")]
    Usage(String),
    /// Another thread asked the work to stop.
    #[error("stopped before the end")]
    Stopped,
}

impl Error {
    /// Returns a function that makes an I/O error of `path`.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        |source| Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    /// Returns true if the machine is at a limit, or object storage fails, so that the error says nothing about the file.
    #[must_use]
    pub fn is_of_the_machine(&self) -> bool {
        if matches!(self, Self::Storage { .. }) {
            return true;
        }
        let Self::Io { source, .. } = self else {
            return false;
        };
        let limits = [
            ErrorKind::OutOfMemory,
            ErrorKind::StorageFull,
            ErrorKind::QuotaExceeded,
        ];
        is_out_of_files(source) || limits.contains(&source.kind())
    }

    /// Returns the error with a note on what was expected.
    #[must_use]
    pub fn with_note(mut self, note: &str) -> Self {
        match &mut self {
            Self::Line { expected, .. } => *expected += &format!(" ({note})"),
            Self::Key { problem, .. } | Self::Content { problem, .. } => {
                *problem += &format!(" ({note})");
            }
            Self::Io { .. } | Self::Storage { .. } | Self::Usage(_) | Self::Stopped => {}
        }
        self
    }

    /// Creates the error of a line.
    pub fn line(
        path: &Path,
        line: u64,
        problem: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Line {
            path: path.to_owned(),
            line,
            problem: problem.into(),
            expected: expected.into(),
        }
    }

    /// Creates the error of a file as a whole.
    pub fn content(path: &Path, problem: impl Into<String>) -> Self {
        Self::Content {
            path: path.to_owned(),
            problem: problem.into(),
        }
    }
}

/// Returns a path for a message: a line break in a name must not begin a line of its own.
#[must_use]
pub fn on_one_line(path: &Path) -> String {
    without_controls(&path.to_string_lossy(), &[])
}

/// Returns a text with its control characters as `\u001b`, which JSON understands too. Those in
/// `kept` stay.
#[must_use]
pub fn without_controls(text: &str, kept: &[char]) -> String {
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() && !kept.contains(&c) {
            let _ = write!(plain, "\\u{:04x}", u32::from(c));
        } else {
            plain.push(c);
        }
    }
    plain
}

/// Returns the words of an I/O error, with advice where the machine is at its limit.
fn words_of(error: &std::io::Error) -> String {
    if is_out_of_files(error) {
        return format!(
            "{error}; not a fault of the file: allow more open files (ulimit -n 4096) and run again"
        );
    }
    if has_code(error, &[IS_FOLDER]) {
        return "is a folder; expected a file".to_owned();
    }
    error.to_string()
}

/// Returns true if the process or the machine has too many open files.
fn is_out_of_files(error: &std::io::Error) -> bool {
    // tempfile gives no access to the code, only to its words.
    has_code(error, &OUT_OF_FILES) || out_of_files(&error.to_string()).is_some()
}

/// Returns true if the error of the system is one of these. Crates wrap it.
fn has_code(error: &std::io::Error, known: &[i32]) -> bool {
    let mut cause: Option<&(dyn std::error::Error + 'static)> = Some(error);
    while let Some(error) = cause {
        let code = error.downcast_ref().and_then(std::io::Error::raw_os_error);
        if code.is_some_and(|code| known.contains(&code)) {
            return true;
        }
        cause = error.source();
    }
    false
}

/// Returns the error of too many open files if these words of a crate mean it.
#[must_use]
pub fn out_of_files(words: &str) -> Option<std::io::Error> {
    let meant = OUT_OF_FILES
        .into_iter()
        .find(|code| words.contains(&format!("(os error {code})")));
    meant.map(std::io::Error::from_raw_os_error)
}

/// Result of this crate.
pub type Result<T> = std::result::Result<T, Error>;
