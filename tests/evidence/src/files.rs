//! Files of the repository, and errors that name them.

use serde::de::DeserializeOwned;
use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

/// A result whose error is a message that names a file.
pub type Result<T> = std::result::Result<T, String>;

/// Returns the root of this repository.
#[must_use]
pub fn root() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().nth(2).unwrap_or(package).to_owned()
}

/// Makes an error of a file.
pub fn problem(path: &Path, why: impl Display) -> String {
    format!("{}: {why}", path.display())
}

/// Reads a text file.
///
/// # Errors
/// It cannot be read.
pub fn text(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(|error| problem(path, error))
}

/// Reads a file of the root by its path from there.
///
/// # Errors
/// It cannot be read.
pub fn source(path: &str) -> Result<String> {
    text(&root().join(path))
}

/// Reads a TOML file of the evidence.
///
/// # Errors
/// It cannot be read, or has other content.
pub fn evidence<T: DeserializeOwned>(name: &str) -> Result<T> {
    let path = root().join("docs/evidence").join(name);
    toml::from_str(&text(&path)?).map_err(|error| problem(&path, error))
}
