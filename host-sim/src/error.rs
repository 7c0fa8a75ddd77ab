//! What can go wrong with an input, told so that it can be mended.

use std::path::{Path, PathBuf};

/// An input that cannot be used. The message names the file, the line where there is one, and
/// what was expected.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be opened or read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// One line of a text file is wrong.
    #[error("{}:{line}: {problem}; expected {expected}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Line number from 1.
        line: u64,
        /// What was found.
        problem: String,
        /// What would do.
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
    /// The content as a whole cannot serve.
    #[error("{}: {problem}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is missing or impossible, and what would do.
        problem: String,
    },
    /// The command line asks for something that does not go together.
    #[error("{0}")]
    Usage(String),
}

impl Error {
    /// An I/O error of `path`.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        |source| Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    /// A wrong line.
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

    /// A file that cannot serve as a whole.
    pub fn content(path: &Path, problem: impl Into<String>) -> Self {
        Self::Content {
            path: path.to_owned(),
            problem: problem.into(),
        }
    }
}

/// Short for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;
