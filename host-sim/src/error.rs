//! Errors of inputs, with what was expected.

use std::path::{Path, PathBuf};

/// An error of an input. The message names the file, the line if there is one, and what was
/// expected.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be opened or read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A line of a text file is wrong.
    #[error("{}:{line}: {problem}; expected {expected}", path.display())]
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
    #[error("{}: {problem}", path.display())]
    Key {
        /// The file.
        path: PathBuf,
        /// What is wrong, with the key's name and what was expected.
        problem: String,
    },
    /// The content of the file as a whole cannot be used.
    #[error("{}: {problem}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is missing or wrong, and what was expected.
        problem: String,
    },
    /// Options of the command line contradict each other.
    #[error("{0}")]
    Usage(String),
}

impl Error {
    /// Returns a function that makes an I/O error of `path`.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        |source| Self::Io {
            path: path.to_owned(),
            source,
        }
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

/// Result of this crate.
pub type Result<T> = std::result::Result<T, Error>;
