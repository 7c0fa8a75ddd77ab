//! Object storage where a program has none: every address is refused.

use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// The address of an object.
#[derive(Clone, Debug)]
pub enum ObjectUrl {}

/// What an address stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// One object.
    Object,
    /// One object that need not exist, to be replaced.
    ToReplace,
    /// Objects below it whose names end so.
    Below(&'static [&'static str]),
}

/// An object that was found.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Object {
    /// Its size, bytes.
    pub size: u64,
}

/// Shows how much of a large object has been sent.
pub type Progress = fn(u64) -> Box<dyn Fn(u64)>;

/// Object storage.
#[derive(Debug)]
pub enum ObjectStorage {}

impl ObjectUrl {
    /// Refuses an address; `None` for a path of a file.
    ///
    /// # Errors
    /// Returns an error for an address of an object.
    pub fn parse(text: &str) -> Result<Option<Self>> {
        if !text.starts_with("s3://") {
            return Ok(None);
        }
        let problem = "this program is built without object storage (--features full has it); expected a file";
        Err(Error::Storage {
            url: text.to_owned(),
            problem: problem.to_owned(),
        })
    }

    /// Never called.
    #[must_use]
    pub const fn is_folder(&self) -> bool {
        match *self {}
    }
}

impl ObjectStorage {
    /// Opens nothing.
    ///
    /// # Errors
    /// Returns an error always.
    pub fn open(_progress: Progress) -> Result<Self> {
        let problem = "this program is built without it".to_owned();
        let url = "object storage".to_owned();
        Err(Error::Storage { url, problem })
    }

    /// Never called.
    #[must_use]
    pub const fn folder(&self) -> &Path {
        match *self {}
    }

    /// Never called.
    #[must_use]
    pub const fn path_of(&self, _url: &ObjectUrl) -> PathBuf {
        match *self {}
    }

    /// Never called.
    ///
    /// # Errors
    /// Returns no error.
    pub const fn find(&self, _url: &ObjectUrl, _wanted: Wanted) -> Result<Vec<Object>> {
        match *self {}
    }

    /// Never called.
    ///
    /// # Errors
    /// Returns no error.
    pub const fn fetch(&self, _objects: &[Object], _progress: &dyn Fn(u64)) -> Result<()> {
        match *self {}
    }
}

/// Does nothing: no file stands for an object.
///
/// # Errors
/// Returns no error.
pub const fn send(_path: &Path) -> Result<()> {
    Ok(())
}

/// Does nothing: no file stands for an object.
///
/// # Errors
/// Returns no error.
pub const fn bring(_path: &Path) -> Result<()> {
    Ok(())
}
