//! Addresses of objects.

use crate::error::{Error, Result};
use object_store::path::Path as Key;
use std::fmt;

/// What an address begins with.
const SCHEME: &str = "s3://";

/// The address of an object, or of a folder of objects: those whose keys begin with it and a `/`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ObjectUrl {
    pub(super) bucket: String,
    /// Without a slash at its end; empty for the whole bucket.
    pub(super) key: Key,
    is_folder: bool,
}

impl ObjectUrl {
    /// Parses an address; `None` for a path of a file.
    ///
    /// # Errors
    /// Returns an error if it has no bucket, or if a part of its key cannot be the name of a file.
    pub fn parse(text: &str) -> Result<Option<Self>> {
        let Some(rest) = text.strip_prefix(SCHEME) else {
            return Ok(None);
        };
        let refuse = |problem: &str| Error::Storage {
            url: text.to_owned(),
            problem: problem.to_owned(),
        };
        let (bucket, key) = rest.split_once('/').unwrap_or((rest, ""));
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        if !bucket.starts_with(|c: char| c.is_ascii_alphanumeric()) || !bucket.chars().all(is_plain)
        {
            return Err(refuse("has no bucket; expected s3://BUCKET/KEY"));
        }
        let parsed = Key::parse(key).ok().filter(|_| !key.starts_with('/'));
        let expected = "has a key that no file can have; expected names with one / between them, none of them . or ..";
        Ok(Some(Self {
            bucket: bucket.to_owned(),
            key: parsed.ok_or_else(|| refuse(expected))?,
            is_folder: key.is_empty() || key.ends_with('/'),
        }))
    }

    /// Returns whether it ends in a slash, or is a whole bucket.
    #[must_use]
    pub const fn is_folder(&self) -> bool {
        self.is_folder
    }

    /// Returns the address of an object of this bucket.
    pub(super) fn of_bucket(bucket: &str, key: Key) -> Self {
        Self {
            bucket: bucket.to_owned(),
            key,
            is_folder: false,
        }
    }

    /// Returns the error of this address.
    pub(super) fn error(&self, problem: impl Into<String>) -> Error {
        Error::Storage {
            url: self.to_string(),
            problem: problem.into(),
        }
    }
}

impl fmt::Display for ObjectUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { bucket, key, .. } = self;
        let slash = if self.is_folder && !key.as_ref().is_empty() {
            "/"
        } else {
            ""
        };
        write!(f, "{SCHEME}{bucket}/{key}{slash}")
    }
}
