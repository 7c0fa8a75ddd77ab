//! What is expected where an object is sent.

use super::address::ObjectUrl;
use super::problem::{changed, problem_of};
use crate::error::Result;
use object_store::aws::AmazonS3;
use object_store::{ObjectStoreExt, PutMode, UpdateVersion};

/// What may be at an address when an object is sent there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Expected {
    /// It does not matter.
    Anything,
    /// Nothing.
    Absent,
    /// The object with this tag.
    Tag(String),
}

impl Expected {
    /// Returns what an object is expected to be that was found with this tag, if it had one.
    pub(super) fn found(e_tag: Option<String>) -> Self {
        e_tag.map_or(Self::Anything, Self::Tag)
    }

    /// Returns the condition on which a server takes an object.
    pub(super) fn mode(&self) -> PutMode {
        match self {
            Self::Anything => PutMode::Overwrite,
            Self::Absent => PutMode::Create,
            Self::Tag(tag) => PutMode::Update(UpdateVersion {
                e_tag: Some(tag.clone()),
                version: None,
            }),
        }
    }

    /// Looks whether it is so, where a server does not: another program may come between.
    ///
    /// # Errors
    /// Returns an error if something else is there, or the server cannot be asked.
    pub(super) async fn look(&self, store: &AmazonS3, url: &ObjectUrl) -> Result<()> {
        if *self == Self::Anything {
            return Ok(());
        }
        let found = match store.head(&url.key).await {
            Ok(found) => Self::found(found.e_tag),
            Err(object_store::Error::NotFound { .. }) => Self::Absent,
            Err(error) => return Err(problem_of(url, &error)),
        };
        if found == *self {
            Ok(())
        } else {
            Err(changed(url))
        }
    }
}
